//! LAMMPS and LIGGGHTS dumps: frames of `ITEM:` sections. `ITEM: ATOMS` names the columns, in any
//! order.
//!
//! * Coordinates are `x y z`, else unwrapped `xu yu zu`, else scaled `xs ys zs` or `xsu ysu zsu`.
//!   Scaled ones become lengths as lo + s (hi - lo), rounded three times. In a tilted (triclinic)
//!   box they become lo + xs a + ys b + zs c, rounded at every step.
//! * The size is a column `radius` or `diameter` (or `r`, `d`). Particles keep the order of the
//!   file, not of their ids.
//! * In the header of the box, `pp ff ff` gives the periodic axes; dumps before 2010 lack it. `xy
//!   xz yz` announces a tilted box, whose bounds are those of its bounding box. `abc origin`
//!   announces three free vectors and the corner.
//!
//! Format: <https://docs.lammps.org/dump.html>, <https://docs.lammps.org/Howto_triclinic.html>.

use anyhow::{Context, bail, ensure};

use crate::boxes::{bound, in_order};
use crate::columns::{Column, Columns};
use crate::frames::Framed;
use crate::options::{Opened, Options};
use crate::particles::{Loaded, Particles};
use crate::raw::lines::{Lines, Separator, Source, number, short, step_of};
use crate::rows::Rows;
use crate::types::{About, Declared, Notice};

pub fn frames(source: Source<'_>, options: Options) -> Opened<'_> {
    Box::new(Dump { lines: Lines::new(source), options, header: Header::default(), any: false })
}

struct Dump<'a> {
    lines: Lines<'a>,
    options: Options,
    header: Header,
    any: bool,
}

#[derive(Default)]
struct Header {
    n: Option<u64>,
    names: String,
    bounds: Option<Declared>,
    step: Option<i64>,
    time: Option<f64>,
}

impl Framed for Dump<'_> {
    fn begin(&mut self) -> anyhow::Result<Option<String>> {
        let lines = &mut self.lines;
        self.header = Header::default();
        let mut open = false;
        while lines.advance_over_blanks()? {
            open = true;
            let text = lines.text();
            let Some(item) = text.strip_prefix("ITEM:").map(str::trim) else {
                bail!(
                    "{}: '{}' stands where a line 'ITEM: ...' is expected; mend the file",
                    lines.place(),
                    short(&text)
                );
            };
            if let Some(names) = item.strip_prefix("ATOMS") {
                let place = lines.place();
                ensure!(
                    self.header.n.is_some(),
                    "{place}: no 'ITEM: NUMBER OF ATOMS' stands before the atoms"
                );
                self.header.names = names.into();
                self.any = true;
                return Ok(Some(place));
            }
            self.header.take(item, lines, self.options)?;
        }
        let name = lines.source.name;
        ensure!(self.any, "{name} ends before a section 'ITEM: ATOMS'; write it again");
        ensure!(
            !open,
            "{name} ends in the header of a frame: it is cut off, or still being written"
        );
        Ok(None)
    }

    fn frame(&mut self, keep: bool) -> anyhow::Result<Option<Loaded>> {
        let (place, lines) = (self.lines.place(), &mut self.lines);
        let Header { n, names, bounds, step, time } = std::mem::take(&mut self.header);
        let n = n.unwrap_or_default();
        let of = "atoms that its header announces: it is cut off, or still being written";
        let atoms = keep.then(|| Atoms::new(&names, bounds, &place, self.options)).transpose()?;
        let Some(mut atoms) = atoms else {
            return (0..n).try_for_each(|k| lines.row(k, n, of)).map(|()| None);
        };
        for k in 0..n {
            lines.row(k, n, of)?;
            let line = lines.line();
            ensure!(
                !line.starts_with(b"ITEM:"),
                "{}: a new section begins after {k} of the {n} atoms announced; mend the number",
                lines.place()
            );
            atoms.rows.push(line, lines)?;
            if let (true, Some(bounds)) = (atoms.scaled, &atoms.bounds) {
                scale_last(bounds, &mut atoms.rows.particles);
            }
        }
        atoms.finite(lines.source.name)?;
        let (particles, about) = atoms.rows.read("LAMMPS dump");
        Ok(Some((particles, About { declared: atoms.bounds, step, time, ..about })))
    }

    fn end(&self) -> Option<(u64, bool)> {
        Some(self.lines.end())
    }
}

impl Header {
    fn take(&mut self, item: &str, lines: &mut Lines<'_>, options: Options) -> anyhow::Result<()> {
        if let Some(kind) = item.strip_prefix("BOX BOUNDS") {
            self.bounds = Some(bounds(lines, kind, options)?);
            return Ok(());
        }
        ensure!(
            !item.starts_with("ENTRIES") && !item.starts_with("NUMBER OF ENTRIES"),
            "{}: this is a dump of pairs or bonds, not of atoms; give it to verify --pairs",
            lines.place()
        );
        ensure!(
            !item.starts_with("GRID ") && item != "DIMENSION",
            "{}: this is a dump of grid cells, not of atoms; write one of style custom",
            lines.place()
        );
        next(lines)?;
        match item {
            "NUMBER OF ATOMS" => self.n = Some(lines.count(lines.line(), "the number of atoms")?),
            "TIMESTEP" => self.step = step_of(lines.line()),
            "TIME" => self.time = number(lines.line()),
            _ => {}
        }
        Ok(())
    }
}

fn next(lines: &mut Lines<'_>) -> anyhow::Result<()> {
    ensure!(
        lines.advance()?,
        "{} ends in the header of a frame: it is cut off, or still being written",
        lines.source.name
    );
    Ok(())
}

struct Atoms {
    rows: Rows,
    scaled: bool,
    bounds: Option<Declared>,
}

impl Atoms {
    fn new(
        names: &str,
        bounds: Option<Declared>,
        place: &str,
        options: Options,
    ) -> anyhow::Result<Atoms> {
        ensure!(
            !names.trim().is_empty(),
            "{place}: the line names no columns, as old versions of LAMMPS wrote it; put their \
             names behind it, as in 'ITEM: ATOMS id type xs ys zs' (scaled by the box) or 'ITEM: \
             ATOMS id type x y z'"
        );
        let mut columns =
            Columns::named(names.split_whitespace()).chosen(place, options.columns)?;
        let has = |name: &str| columns.names.iter().any(|other| other == name);
        // A chosen column `xs` holds scaled coordinates, too.
        let chosen = |name: &str| {
            let k = columns.names.iter().position(|other| other == name);
            k.is_some_and(|k| columns.meaning[k] == Column::Axis(0))
        };
        let given = options.columns.is_some_and(|chosen| chosen.axes());
        let kind = ["", "u", "s", "su"]
            .into_iter()
            .map(|kind| (kind, format!("x{kind}")))
            .find(|(_, name)| if given { chosen(name) } else { has(name) })
            .map_or("", |(kind, _)| kind);
        let axes = ["x", "y", "z"].map(|axis| format!("{axis}{kind}"));
        let of_another_kind =
            ["z", "zu", "zs", "zsu"].into_iter().find(|z| !given && has(z) && !has(&axes[2]));
        if let Some(z) = of_another_kind {
            bail!(
                "{place}: the columns are '{}' and '{z}', which are not of one kind; write x y z",
                axes[0]
            );
        }
        for (meaning, name) in columns.meaning.iter_mut().zip(&columns.names).filter(|_| !given) {
            match axes.iter().position(|axis| axis == name) {
                Some(k) => *meaning = Column::Axis(k),
                None if matches!(meaning, Column::Axis(_)) => *meaning = Column::Other,
                None => {}
            }
        }
        let particles = columns.particles(place, options)?;
        let mut rows = Rows { columns, particles };
        let scaled = kind.starts_with('s');
        if scaled {
            ensure!(
                bounds.is_some(),
                "{place}: the coordinates are scaled by the box (xs), but there is no 'ITEM: BOX \
                 BOUNDS'; write x y z"
            );
            rows.particles.notices.push(Notice::Assumed(
                "coordinates scaled by the box (xs): turned into lengths, which are rounded".into(),
            ));
        }
        if rows.columns.names.iter().any(|name| name == "shapex") {
            rows.particles.notices.push(Notice::Assumed(
                "the particles have shapes (shapex) and may be no spheres: they are read as \
                 spheres of their radius or diameter"
                    .into(),
            ));
        }
        if kind.ends_with('u') {
            rows.particles.notices.push(Notice::Assumed(
                "unwrapped coordinates: particles may be outside the box, and contacts across open \
                 boundaries are left out"
                    .into(),
            ));
        }
        Ok(Atoms { rows, scaled, bounds })
    }

    fn finite(&self, name: &str) -> anyhow::Result<()> {
        if self.scaled {
            let particles = &self.rows.particles;
            let bad =
                (0..particles.len()).find(|&k| particles.centre(k).iter().any(|x| !x.is_finite()));
            ensure!(
                bad.is_none(),
                "{name}: atom {} (from 0) is not finite once it is scaled by the box",
                bad.unwrap_or_default()
            );
        }
        Ok(())
    }
}

fn bounds(lines: &mut Lines<'_>, kind: &str, options: Options) -> anyhow::Result<Declared> {
    let words: Vec<&str> = kind.split_whitespace().collect();
    let (columns, flags) = match words[..] {
        ["xy", "xz", "yz", ref flags @ ..] => (3, flags),
        ["abc", "origin", ref flags @ ..] => (4, flags),
        ref flags => (2, flags),
    };
    let overruled = options.boundaries.overrule();
    let periodic = match letters(flags) {
        Ok(periodic) => Some(periodic),
        Err(_) if flags.is_empty() || overruled => None,
        Err(why) => bail!(
            "{}: the boundaries of the box are '{}': {why}; mend the line, or give --periodic \
             or --open",
            lines.place(),
            short(&flags.join(" "))
        ),
    };
    let mut rows = [[0.0; 4]; 3];
    for row in &mut rows {
        next(lines)?;
        let cells: Vec<&[u8]> = Separator::Blanks.cells(lines.line()).collect();
        for (k, &cell) in cells.iter().take(columns).enumerate() {
            row[k] = bound(cell, k, lines)?;
        }
        let expected = match columns {
            2 => "two bounds of the box are expected, lo and hi",
            3 => "three numbers of the tilted box are expected: lo, hi and tilt",
            _ => "four numbers of the box are expected: a vector, and one of its corner",
        };
        ensure!(cells.len() >= columns, "{}: {expected}", lines.place());
        ensure!(
            cells.len() == columns || overruled,
            "{}: {} numbers of the box, and its header announces {columns}; a tilted box has \
             'xy xz yz' there: mend it, or give --open",
            lines.place(),
            cells.len()
        );
    }
    let pairs = rows.map(|row| [row[0], row[1]]);
    let third = rows.map(|row| row[2]);
    Ok(match columns {
        2 => {
            in_order(&pairs, options.boundaries).with_context(|| lines.place())?;
            Declared::between(&pairs, periodic)
        }
        3 => Declared::enclosed(pairs, third, periodic, options.boundaries)
            .with_context(|| lines.place())?,
        _ => Declared {
            vectors: Some(rows.map(|row| [row[0], row[1], row[2]])),
            origin: rows.map(|row| row[3]),
            periodic,
            ..Declared::default()
        },
    })
}

fn scale_last(bounds: &Declared, particles: &mut Particles) {
    let Declared { vectors: Some(vectors), origin, .. } = bounds else { return };
    let Some(last) = particles.len().checked_sub(1) else { return };
    let scaled = particles.centre(last);
    for axis in 0..3 {
        // Terms of 0 are left out to avoid rounding, and NaN from 0 times infinity.
        let terms = scaled.iter().zip(vectors).filter(|(_, vector)| vector[axis] != 0.0);
        let length = terms.fold(origin[axis], |sum, (s, vector)| sum + s * vector[axis]);
        particles.set(last, axis, length);
    }
}

/// Parses boundary letters such as `pp ff sm` into periodic axes; `pp` is periodic.
fn letters(flags: &[&str]) -> Result<[bool; 3], &'static str> {
    let mut periodic = [false; 3];
    if flags.len() != 3 {
        return Err("two letters for each of the three axes are expected, as in pp pp ff");
    }
    for (periodic, flag) in periodic.iter_mut().zip(flags) {
        match flag.as_bytes() {
            b"pp" => *periodic = true,
            [b'p', _] | [_, b'p'] => return Err("a box repeats at both ends of an axis, pp"),
            [b'f' | b's' | b'm', b'f' | b's' | b'm'] => {}
            _ => return Err("the letters are p, f, s and m, two for each axis, as in pp pp ff"),
        }
    }
    Ok(periodic)
}
