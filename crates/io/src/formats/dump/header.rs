//! The headers of LAMMPS dumps, of atoms (`ITEM: ATOMS`) and of pairs (`ITEM: ENTRIES`).

use anyhow::{Context, bail, ensure};

use crate::boxes::{Boundaries, bound, in_order};
use crate::raw::lines::{Lines, number, short, step_of, words};
use crate::types::Declared;

/// A dump whose frames end with the rows of `section`.
pub struct Headers<'a> {
    pub lines: Lines<'a>,
    section: &'static str,
    any: bool,
}

/// The header of a frame: the lines before its rows.
#[derive(Default)]
pub struct Header {
    pub n: u64,
    pub names: String,
    pub place: String,
    pub bounds: Option<Declared>,
    pub step: Option<i64>,
    pub time: Option<f64>,
}

impl<'a> Headers<'a> {
    pub fn new(lines: Lines<'a>, section: &'static str) -> Headers<'a> {
        Headers { lines, section, any: false }
    }

    /// Reads to the rows of the next frame, or returns `None` at the end.
    pub fn next(&mut self, boundaries: Boundaries) -> anyhow::Result<Option<Header>> {
        let Headers { lines, section, any } = self;
        let (mut n, mut header, mut open) = (None, Header::default(), false);
        while lines.advance_over_blanks()? {
            open = true;
            let (text, place) = (lines.text(), lines.place());
            let item = text.strip_prefix("ITEM:").map(str::trim).with_context(|| {
                format!("{place}: '{}' stands where a line 'ITEM: ...' is expected", short(&text))
            })?;
            if let Some(names) = item.strip_prefix(*section) {
                header.n = n.with_context(|| format!("{place}: no 'ITEM: NUMBER OF {section}'"))?;
                (header.names, header.place, *any) = (names.into(), place, true);
                return Ok(Some(header));
            }
            if let Some(kind) = item.strip_prefix("BOX BOUNDS") {
                header.bounds = Some(bounds(lines, kind, boundaries)?);
                continue;
            }
            let of = item.strip_prefix("NUMBER OF ").unwrap_or(item);
            match of.split(' ').next() {
                Some(other @ ("ENTRIES" | "GRID" | "DIMENSION" | "ATOMS")) if other != *section => {
                    bail!(
                        "{place}: this is a dump of {other}, not of {section}; pairs go to verify --pairs"
                    )
                }
                _ => next(lines)?,
            }
            match item {
                "TIMESTEP" => header.step = step_of(lines.line()),
                "TIME" => header.time = number(lines.line()),
                _ if item.starts_with("NUMBER OF") && of == *section => {
                    n = Some(lines.count(lines.line(), "the number of rows")?);
                }
                _ => {}
            }
        }
        let name = lines.source.name;
        ensure!(*any, "{name} ends before a section 'ITEM: {section}'; write it again");
        ensure!(!open, "{name} ends in the header of a frame: {TORN}");
        Ok(None)
    }
}

const TORN: &str = "it is cut off, or still being written";

fn next(lines: &mut Lines<'_>) -> anyhow::Result<()> {
    let (more, name) = (lines.advance()?, lines.source.name);
    ensure!(more, "{name} ends in the header of a frame: {TORN}");
    Ok(())
}

fn bounds(lines: &mut Lines<'_>, kind: &str, boundaries: Boundaries) -> anyhow::Result<Declared> {
    let letters: Vec<&str> = kind.split_whitespace().collect();
    let (columns, what, flags) = match letters[..] {
        ["xy", "xz", "yz", ref flags @ ..] => (3, "lo, hi and tilt", flags),
        ["abc", "origin", ref flags @ ..] => (4, "a vector, and one of the corner", flags),
        ref flags => (2, "lo and hi", flags),
    };
    let overruled = boundaries.overrule();
    let periodic = periodic(flags);
    let sound = periodic.is_some() || flags.is_empty() || overruled;
    let flags = short(&flags.join(" "));
    ensure!(
        sound,
        "{lines}: the boundaries are '{flags}', not pp, ff, ...; give --periodic or --open"
    );
    let mut rows = [[0.0; 4]; 3];
    for row in &mut rows {
        next(lines)?;
        let (place, cells) = (lines.place(), words(lines.line()).collect::<Vec<_>>());
        let count = cells.len();
        ensure!(
            count == columns || overruled && count > columns,
            "{place}: the line of the box has {count} numbers, and {columns} are expected ({what}); fix the line, or give --open"
        );
        for (k, (value, cell)) in row.iter_mut().zip(&cells[..columns]).enumerate() {
            *value = bound(cell, k, lines)?;
        }
    }
    let pairs = rows.map(|row| [row[0], row[1]]);
    let third = rows.map(|row| row[2]);
    Ok(match columns {
        2 => {
            in_order(&pairs, boundaries).with_context(|| lines.place())?;
            Declared::between(&pairs, periodic)
        }
        3 => {
            Declared::enclosed(pairs, third, periodic, boundaries).with_context(|| lines.place())?
        }
        _ => Declared {
            vectors: Some(rows.map(|row| [row[0], row[1], row[2]])),
            origin: rows.map(|row| row[3]),
            periodic,
            ..Declared::default()
        },
    })
}

/// Parses boundary letters such as `pp ff sm` into periodic axes; `pp` is periodic.
fn periodic(flags: &[&str]) -> Option<[bool; 3]> {
    let flags: [&str; 3] = flags.try_into().ok()?;
    let open = |flag: &str| flag.len() == 2 && flag.chars().all(|c| "fsm".contains(c));
    let sound = flags.iter().all(|flag| *flag == "pp" || open(flag));
    sound.then(|| flags.map(|flag| flag == "pp"))
}
