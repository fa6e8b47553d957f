//! CSV: one particle per line, columns named by a header.
//!
//! * The header names the columns: `x,y[,z][,r]`, with `r`, `radius`, `d` or `diameter`, in any order and any case; other columns are
//!   skipped. Names and numbers may stand in quotes; a quoted text may not hold the separator.
//! * The separator is that of the first line: semicolon, else comma, else tab, else any run of blanks.
//! * Blank lines and lines that begin with `#` are skipped. A `#` line is the header where the data begin without one and it names as
//!   many columns as the data have (`# x y z r`, as many programs write).
//! * Without a header, columns that are all numbers are taken as x,y (two), x,y,z,r (four), and x,y,z (three, where the options give a
//!   radius or three dimensions) or x,y,r (three, where they give two dimensions). Anything else is refused.

use std::io::BufRead;

use anyhow::{bail, ensure};

use super::{Column, Columns, Lines, Options, Particles};

pub(super) fn read(reader: impl BufRead, name: &str, options: Options) -> anyhow::Result<Particles> {
    let mut lines = Lines::new(reader, name);
    let mut commented = None;
    let (line, place) = loop {
        match lines.next()? {
            Some((line, place)) if line.trim_start().starts_with('#') => {
                let columns = named(line.trim_start().trim_start_matches('#').trim());
                if columns.particles(&place).is_ok() {
                    commented = Some(columns);
                }
            }
            Some((line, _)) if line.trim().is_empty() => {}
            Some(first) => break first,
            // A comment that names columns is the header of a file without particles.
            None => match commented {
                Some(columns) => return columns.particles(name),
                None => bail!("{name} is empty; a particle file has at least a header such as x,y,r"),
            },
        }
    };
    let separator = Separator::of(&line);
    let numeric = separator.split(&line).all(|cell| cell.parse::<f64>().is_ok());
    let columns = if numeric {
        let count = separator.split(&line).count();
        match commented.filter(|columns| columns.meaning.len() == count) {
            Some(columns) => columns,
            None => unnamed(count, options, &place)?,
        }
    } else {
        named(&line)
    };
    let mut particles = columns.particles(&place)?;
    let mut next = if numeric { Some((line, place)) } else { lines.next()? };
    while let Some((line, place)) = next {
        if !line.trim().is_empty() && !line.trim_start().starts_with('#') {
            let (count, wanted) = (separator.split(&line).count(), columns.meaning.len());
            ensure!(
                count == wanted,
                "{place}: {count} columns where {wanted} are expected, separated by {}; mend or remove the line",
                separator.name()
            );
            columns.push(&mut particles, separator.split(&line), &place)?;
        }
        next = lines.next()?;
    }
    Ok(particles)
}

fn named(header: &str) -> Columns {
    let names: Vec<String> = Separator::of(header).split(header).map(str::to_string).collect();
    Columns { meaning: names.iter().map(|name| meaning(name)).collect(), names }
}

/// What a column of that name holds.
pub(super) fn meaning(name: &str) -> Column {
    match name.to_ascii_lowercase().as_str() {
        "x" => Column::Axis(0),
        "y" => Column::Axis(1),
        "z" => Column::Axis(2),
        "r" | "radius" => Column::Radius,
        "d" | "diameter" => Column::Diameter,
        _ => Column::Other,
    }
}

/// The columns of numbers that no header names.
fn unnamed(count: usize, options: Options, place: &str) -> anyhow::Result<Columns> {
    let names = match (count, options) {
        (2, _) => "x y",
        (3, Options { dim: Some(2), .. }) => "x y r",
        (3, Options { dim: Some(3), .. } | Options { radius: Some(_), .. }) => "x y z",
        (4, _) => "x y z r",
        (3, _) => bail!("{place}: three columns without a header may be x,y,z or x,y,r; put a header line before them"),
        _ => bail!("{place}: {count} columns without a header; put a header line such as x,y,z,r before them"),
    };
    Ok(named(names))
}

#[derive(Clone, Copy)]
enum Separator {
    One(char),
    Blanks,
}

impl Separator {
    fn of(line: &str) -> Separator {
        [';', ',', '\t'].into_iter().find(|&c| line.contains(c)).map_or(Separator::Blanks, Separator::One)
    }

    fn split(self, line: &str) -> impl Iterator<Item = &str> {
        let (by_char, by_blanks) = match self {
            Separator::One(c) => (Some(line.split(c)), None),
            Separator::Blanks => (None, Some(line.split_whitespace())),
        };
        by_char.into_iter().flatten().chain(by_blanks.into_iter().flatten()).map(|cell| cell.trim().trim_matches('"').trim())
    }

    fn name(self) -> String {
        match self {
            Separator::One('\t') => "tabs".into(),
            Separator::One(c) => format!("'{c}'"),
            Separator::Blanks => "blanks".into(),
        }
    }
}
