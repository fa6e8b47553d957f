//! Contact lists in a LAMMPS dump local: `ITEM: ENTRIES`.

use anyhow::{Context, bail, ensure};

use super::columns::Columns;
use super::list::List;
use crate::frames::{Choice, Reader, Step};
use crate::raw::lines::{Lines, listed, short, step_of, words};

pub(super) struct Dump<'a> {
    lines: Lines<'a>,
    chosen: &'a [&'a str],
}

impl<'a> Dump<'a> {
    pub fn new(lines: Lines<'a>, chosen: &'a [&'a str]) -> Dump<'a> {
        Dump { lines, chosen }
    }
}

impl Reader<List> for Dump<'_> {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<List>> {
        let Dump { lines, chosen } = self;
        let (mut n, mut at, mut open) = (None, None, false);
        while lines.advance_over_blanks()? {
            let (text, place) = (lines.text(), lines.place());
            let Some(item) = text.strip_prefix("ITEM:").map(str::trim) else {
                bail!(
                    "{place}: '{}' stands where a line 'ITEM: ...' is expected; mend the file",
                    short(&text)
                );
            };
            open = !item.starts_with("ENTRIES");
            if item.starts_with("NUMBER OF") {
                ensure!(
                    lines.advance()?,
                    "{} is cut off in a header; write it again",
                    lines.source.name
                );
                n = Some(lines.count(lines.line(), "the number of entries")?);
            } else if item.starts_with("BOX BOUNDS") {
                for _ in 0..3 {
                    lines.advance()?;
                }
            } else if let Some(names) = item.strip_prefix("ENTRIES") {
                let names: Vec<String> = names.split_whitespace().map(str::to_string).collect();
                let named = Columns::named(&names, chosen, || place.clone())?;
                let mut columns = named.with_context(|| {
                    format!(
                        "{place}: which columns hold the ids of a pair? Name them with \
                         --pairs-columns I,J; there are {}",
                        listed(&names)
                    )
                })?;
                let n = n.take().with_context(|| {
                    format!("{place}: no 'ITEM: NUMBER OF ENTRIES' stands before the entries")
                })?;
                let (index, step) = (choice.seen, at.take());
                let wanted = choice.begin(|| lines.place())?;
                if wanted == Step::Stop {
                    return Ok(None);
                }
                let (format, ids, frame) = ("LAMMPS dump local", true, Some(index));
                let mut list = List { format, ids, frame, step, ..List::default() };
                for k in 0..n {
                    ensure!(
                        lines.advance()?,
                        "{} ends after {k} of the {n} entries that its header announces",
                        lines.source.name
                    );
                    if wanted == Step::Keep {
                        let cells: Vec<&[u8]> = words(lines.line()).collect();
                        columns.push(lines, &cells, &mut list)?;
                    }
                }
                if wanted == Step::Keep {
                    columns.end(&mut list);
                    return Ok(Some(list));
                }
            } else {
                ensure!(
                    !item.starts_with("ATOMS"),
                    "{place}: this is a dump of atoms, not of pairs; write pairs with dump local"
                );
                lines.advance()?;
                if item == "TIMESTEP" {
                    at = step_of(lines.line());
                }
            }
        }
        let name = lines.source.name;
        ensure!(choice.seen > 0, "{name} ends before a section 'ITEM: ENTRIES'; write it again");
        ensure!(
            !open,
            "{name} is cut off in the header of a frame; write it again, or take an earlier \
             --pairs-frame"
        );
        Ok(None)
    }
}
