//! LAMMPS data files: a header with the number of atoms and the box, then sections. The section
//! `Atoms` holds the particles.
//!
//! The atom style determines the columns; it follows the section name, as in `Atoms # sphere`.
//! Styles of spheres have a *diameter*, which is halved; other styles need a radius from the
//! options. Without a style, the number of columns must be unambiguous, or the options must choose
//! the columns, as for a hybrid style.
//!
//! The box is given by `xlo xhi` and so on, with `xy xz yz` if it is tilted, or by the vectors
//! `avec`, `bvec`, `cvec` with `abc origin`. A data file does not state which axes are periodic.
//!
//! Format: <https://docs.lammps.org/read_data.html>.

use anyhow::{Context, bail, ensure};

use crate::boxes::{bound, in_order};
use crate::columns::Columns;
use crate::columns::advice::unclear;
use crate::options::Options;
use crate::particles::Loaded;
use crate::raw::lines::{Lines, Source, short, shown, whole, words};
use crate::rows::Rows;
use crate::types::{About, Declared, assumed};

/// Columns of each style; image flags may follow.
const STYLES: [(&str, &str); 16] = [
    ("sphere", "id type diameter density x y z"),
    ("granular", "id type diameter density x y z"),
    ("bpm/sphere", "id mol type diameter density x y z"),
    ("atomic", "id type x y z"),
    ("charge", "id type q x y z"),
    ("bond", "id mol type x y z"),
    ("angle", "id mol type x y z"),
    ("molecular", "id mol type x y z"),
    ("full", "id mol type q x y z"),
    ("dipole", "id type q x y z mux muy muz"),
    ("ellipsoid", "id type flag density x y z"),
    ("line", "id mol type flag density x y z"),
    ("tri", "id mol type flag density x y z"),
    ("body", "id type flag mass x y z"),
    ("dpd", "id type theta x y z"),
    ("sph", "id type rho e cv x y z"),
];

pub fn tells(head: &[u8]) -> bool {
    head.split(|&b| b == b'\n').take(40).any(|line| is_count(line).is_some())
}

fn is_count(line: &[u8]) -> Option<&[u8]> {
    let mut words = words(line.split(|&b| b == b'#').next().unwrap_or_default());
    let (n, atoms) = (words.next()?, words.next()?);
    (atoms == b"atoms" && words.next().is_none() && n.iter().all(u8::is_ascii_digit)).then_some(n)
}

pub fn read(source: Source<'_>, options: Options) -> anyhow::Result<Loaded> {
    let mut lines = Lines::new(source);
    let (mut n, mut header) = (None, Header::default());
    lines.advance()?;
    while lines.advance_over_blanks()? {
        let line = lines.line();
        if let Some(count) = is_count(line) {
            n = Some(lines.count(count, "the number of atoms")?);
        } else if header.take(&lines, options)? {
            continue;
        } else if words(line).next() == Some(b"Atoms") {
            let n =
                n.with_context(|| format!("{lines}: no line '100 atoms' after line 1, the title"))?;
            let text = lines.text();
            let style = text.split_once('#').map(|(_, style)| style.trim());
            let style = style.filter(|style| !style.is_empty());
            let mut rows = atoms(&mut lines, n, style, options)?;
            let Rows { columns, particles } = &mut rows;
            if style.is_none() && n > 0 && options.columns.is_none() {
                particles.notices.push(assumed!(
                    "the atom style does not name the columns; they are read as {}; --columns \
                     changes this",
                    columns.names.join(" ")
                ));
            }
            let (particles, about) = rows.read("LAMMPS data");
            return Ok((particles, About { declared: header.declared(), ..about }));
        }
    }
    bail!("{} has no section Atoms; is it a LAMMPS data file?", lines.source.name)
}

#[derive(Default)]
struct Header {
    ranges: [Option<[f64; 2]>; 3],
    tilt: Option<[f64; 3]>,
    vectors: [Option<[f64; 3]>; 3],
    origin: [f64; 3],
}

impl Header {
    fn take(&mut self, lines: &Lines<'_>, options: Options) -> anyhow::Result<bool> {
        let line = lines.line().split(|&b| b == b'#').next().unwrap_or_default();
        let words: Vec<&[u8]> = words(line).collect();
        let numbers = |cells: &[&[u8]]| -> anyhow::Result<[f64; 3]> {
            let mut values = [0.0; 3];
            for (k, (value, cell)) in values.iter_mut().zip(cells).enumerate() {
                *value = bound(cell, k, lines)?;
            }
            Ok(values)
        };
        match words[..] {
            [lo, hi, axis @ (b"xlo" | b"ylo" | b"zlo"), ..] => {
                let [lo, hi, _] = numbers(&[lo, hi])?;
                in_order(&[[lo, hi]], options.boundaries).with_context(|| lines.place())?;
                self.ranges[usize::from(axis[0] - b'x')] = Some([lo, hi]);
            }
            [xy, xz, yz, b"xy", b"xz", b"yz"] => self.tilt = Some(numbers(&[xy, xz, yz])?),
            [x, y, z, vector @ (b"avec" | b"bvec" | b"cvec")] => {
                self.vectors[usize::from(vector[0] - b'a')] = Some(numbers(&[x, y, z])?);
            }
            [x, y, z, b"abc", b"origin"] => self.origin = numbers(&[x, y, z])?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn declared(self) -> Option<Declared> {
        if let [Some(a), Some(b), Some(c)] = self.vectors {
            let vectors = Some([a, b, c]);
            return Some(Declared { vectors, origin: self.origin, ..Declared::default() });
        }
        let [Some(x), Some(y), Some(z)] = self.ranges else { return None };
        let declared = Declared::between(&[x, y, z], None);
        Some(self.tilt.map_or(declared.clone(), |tilt| declared.tilted(tilt)))
    }
}

fn atoms(
    lines: &mut Lines<'_>,
    n: u64,
    style: Option<&str>,
    options: Options,
) -> anyhow::Result<Rows> {
    let place = lines.place();
    let chosen = options.axes_chosen();
    let styled = style.map(styled);
    let mut rows = match styled {
        Some(Ok(columns)) => Some(columns.rows(&place, options)?),
        // An unknown style does not matter if the options choose the columns.
        Some(Err(error)) if !chosen => return Err(error.context(place)),
        _ => None,
    };
    for k in 0..n {
        let (more, name) = (lines.advance_over_blanks()?, lines.source.name);
        ensure!(more, "{name} ends after {k} of the {n} atoms that its header announces");
        let line = lines.line().split(|&b| b == b'#').next().unwrap_or_default();
        if rows.is_none() {
            let count = words(line).count();
            let unstyled = match chosen {
                true => Columns::numbered(count),
                false => unstyled(count).with_context(|| lines.place())?,
            };
            rows = Some(unstyled.rows(&lines.place(), options)?);
        }
        let Some(rows) = &mut rows else { continue };
        if style.is_none() && !chosen && rows.columns.names.len() == 6 {
            let kind = words(line).nth(2).unwrap_or_default();
            if whole(kind).is_none() {
                let kind = shown(kind);
                return Err(unclear!("{lines}: column 3 holds '{kind}', a charge or a coordinate"));
            }
        }
        rows.push(line, lines)?;
    }
    Ok(rows.unwrap_or_else(|| Rows::none("x y z")))
}

fn styled(style: &str) -> anyhow::Result<Columns> {
    let found = STYLES.iter().find(|(name, _)| *name == style);
    let (_, names) =
        found.ok_or_else(|| unclear!("the atom style '{}' is not supported", short(style)))?;
    Ok(Columns { or_more: true, ..Columns::of(names) })
}

fn unstyled(count: usize) -> anyhow::Result<Columns> {
    let names = match count {
        5 => "id type x y z",
        6 => "id other type x y z",
        _ => return Err(unclear!("{count} columns, and no style as in 'Atoms # sphere'")),
    };
    Ok(Columns { or_more: true, ..Columns::of(names) })
}
