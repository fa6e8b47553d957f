//! CSV: one particle per line, columns named by a header. YADE's text files are of this kind, too.
//!
//! * The header names the columns: `x,y[,z][,r]`, with `r`, `radius`, `d` or `diameter`, in any
//!   order and any case; other columns are skipped. Names and numbers may stand in quotes; a quoted
//!   text may not hold the separator.
//! * The separator is that of the first line: semicolon, else comma, else tab, else any run of
//!   blanks.
//! * Blank lines and lines that begin with `#` are skipped. A `#` line is the header where the data
//!   begin without one and it names as many columns as the data have (`# x y z r`, as many programs
//!   write).
//! * YADE's `#format x_y_z_r` names the columns likewise; `#format x_y_z_r_attrs` has any number of
//!   others behind them.
//! * Without a header, columns that are all numbers are taken as x,y (two), x,y,z,r (four), and
//!   x,y,z (three, where the options give a radius or three dimensions) or x,y,r (three, where they
//!   give two dimensions). Anything else is refused, also a first or last column that counts
//!   the particles.

use anyhow::{bail, ensure};

use crate::io::counted::Counted;
use crate::io::lines::{Lines, Separator, Source, number, words};
use crate::io::particles::{Columns, DECIMAL_COMMAS, Particles, is_decimal_comma, loaded};
use crate::io::{About, Notice, Options};

pub(crate) fn read(source: Source<'_>, options: Options) -> anyhow::Result<(Particles, About)> {
    let mut lines = Lines::new(source);
    let (mut commented, mut yade): (Option<Columns>, bool) = (None, false);
    loop {
        if !lines.advance_over_blanks()? {
            // A comment that names columns is the header of a file without particles.
            let Some(mut columns) = commented else {
                bail!(
                    "{} is empty; a particle file has at least a header such as x,y,r",
                    lines.source.name
                )
            };
            return Ok(loaded(
                "CSV",
                columns.particles(lines.source.name, options)?,
                columns.radius(),
            ));
        }
        if !lines.line().starts_with(b"#") {
            break;
        }
        let text = lines.text();
        let text = text.trim_start_matches('#').trim();
        let columns = match text.strip_prefix("format ") {
            Some(format) => {
                yade = true;
                let names: Vec<&str> =
                    format.trim().split('_').take_while(|name| *name != "attrs").collect();
                Columns { or_more: format.ends_with("attrs"), ..Columns::named(names) }
            }
            None => named(text.as_bytes()),
        };
        let chosen = columns.chosen("", options);
        if let Some(columns) = chosen.ok().filter(Columns::has_places)
            && !(yade && commented.is_some())
        {
            commented = Some(columns);
        }
    }
    let separator = Separator::guess(lines.line());
    let count = separator.cells(lines.line()).count();
    let numeric = separator.cells(lines.line()).all(|cell| number(cell).is_some());
    let of_comment = commented.filter(|columns| {
        columns.meaning.len() == count || columns.or_more && columns.meaning.len() < count
    });
    let (mut columns, is_header, assumed) = match of_comment {
        // Beside the numbers, YADE writes names of materials and the like.
        Some(columns) if numeric || yade => (columns, false, false),
        _ if numeric => {
            let columns = unnamed(count, options, &lines.place())?;
            (columns, false, options.columns.is_none())
        }
        _ => {
            let mut cells = Separator::Blanks.cells(lines.line());
            ensure!(
                separator == Separator::Blanks || !cells.all(is_decimal_comma),
                "{}: the numbers have decimal commas, which are not read: write points",
                lines.place()
            );
            (named(lines.line()).chosen(&lines.place(), options)?, true, false)
        }
    };
    let mut particles = columns.particles(&lines.place(), options)?;
    let mut more = !is_header || lines.advance()?;
    let between = || format!(", separated by {}; mend or remove the line", separator.name());
    while more {
        let line = lines.line();
        if !line.is_empty() && !line.starts_with(b"#") {
            columns.push(&mut particles, separator.cells(line), || lines.place(), between)?;
        }
        more = lines.advance()?;
    }
    if let Some(which) = particles.counted().filter(|_| assumed) {
        let (all, first) = (columns.names.len(), which == Counted::First);
        let chosen = |names: &[&str]| -> String {
            let at = names.iter().zip(1..).map(|(name, k)| format!("{name}={k}"));
            at.collect::<Vec<_>>().join(",")
        };
        let taken: Vec<&str> = columns.names.iter().map(String::as_str).collect();
        let meant = if first {
            [&["id"], &taken[..all - 1]].concat()
        } else {
            [&taken[..all - 1], &["id"]].concat()
        };
        bail!(
            "{}: the {} of {all} columns without names counts the particles, and is taken for \
             '{}'; say which column is which: --columns {}, or --columns {} if it is that",
            lines.source.name,
            if first { "first" } else { "last" },
            taken[if first { 0 } else { all - 1 }],
            chosen(&meant),
            chosen(&taken)
        );
    }
    let radius = columns.radius();
    let names = columns.names.join(", ");
    let (mut particles, about) = loaded(if yade { "YADE text" } else { "CSV" }, particles, radius);
    if assumed {
        let words = format!(
            "the columns have no names, and are read as {names}; --columns says which is which"
        );
        particles.notices.push(Notice::Assumed(words));
    }
    Ok((particles, about))
}

fn named(header: &[u8]) -> Columns {
    Columns::named(
        Separator::guess(header)
            .cells(header)
            .map(|cell| String::from_utf8_lossy(cell).into_owned()),
    )
}

/// The columns of numbers that no header names.
fn unnamed(count: usize, options: Options, place: &str) -> anyhow::Result<Columns> {
    if options.columns.is_some() {
        let names = (1..=count).map(|k| format!("column {k}"));
        return Columns::named(names).chosen(place, options);
    }
    let names = match (count, options) {
        (2, _) => "x y",
        (3, Options { dim: Some(2), .. }) => "x y r",
        (3, Options { dim: Some(3), .. } | Options { radius: Some(_), .. }) => "x y z",
        (4, _) => "x y z r",
        (3, _) => bail!(
            "{place}: three columns without a header may be x,y,z or x,y,r; put a header line \
             before them"
        ),
        _ => bail!(
            "{place}: {count} columns without a header; put a header line such as x,y,z,r before \
             them, or say which is which with --columns x=1,y=2 and so on{}",
            if count.is_multiple_of(2) { DECIMAL_COMMAS } else { "" }
        ),
    };
    Ok(Columns::named(
        words(names.as_bytes()).map(|word| String::from_utf8_lossy(word).into_owned()),
    ))
}
