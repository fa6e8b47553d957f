//! Contact lists in a LAMMPS dump local: `ITEM: ENTRIES`.

use anyhow::Context;

use super::columns::Columns;
use super::list::List;
use crate::boxes::Boundaries;
use crate::formats::dump::Headers;
use crate::frames::{Choice, Reader, Step};
use crate::raw::lines::{Lines, listed, words};

pub(super) struct Dump<'a> {
    headers: Headers<'a>,
    chosen: &'a [&'a str],
}

impl<'a> Dump<'a> {
    pub fn new(lines: Lines<'a>, chosen: &'a [&'a str]) -> Dump<'a> {
        Dump { headers: Headers::new(lines, "ENTRIES"), chosen }
    }
}

impl Reader<List> for Dump<'_> {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<List>> {
        // The box of a list is not used, so its letters do not matter.
        let boundaries = Boundaries { open: true, ..Boundaries::default() };
        while let Some(header) = self.headers.next(boundaries)? {
            let (lines, place) = (&mut self.headers.lines, || header.place.clone());
            let names: Vec<String> = header.names.split_whitespace().map(String::from).collect();
            let named = Columns::named(&names, self.chosen, place)?;
            let mut columns = named.with_context(|| {
                let (place, names) = (&header.place, listed(&names));
                format!(
                    "{place}: which columns hold the pair? Give --pairs-columns I,J among {names}"
                )
            })?;
            let (frame, step) = (Some(choice.seen), header.step);
            let wanted = choice.begin(place)?;
            if wanted == Step::Stop {
                return Ok(None);
            }
            let format = "LAMMPS dump local";
            let mut list = List { format, ids: true, frame, step, ..List::default() };
            for k in 0..header.n {
                lines.row(k, header.n, "entries that its header announces")?;
                if wanted == Step::Keep {
                    let cells: Vec<&[u8]> = words(lines.line()).collect();
                    columns.push(lines, &cells, &mut list)?;
                }
            }
            if wanted == Step::Keep {
                columns.end(&mut list);
                return Ok(Some(list));
            }
        }
        Ok(None)
    }
}
