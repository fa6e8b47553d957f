//! npy: rows of two numbers, the pair; with images in a box of four (discs) or five (spheres).
//! Where all frames are wanted, of three, five or six, and the first is the frame.

use anyhow::{bail, ensure};

use super::list::List;
use super::{ascends, image, push};
use crate::io::formats::npy::{self, Header};
use crate::io::frames::{Choice, Reader, Step};
use crate::io::lines::Source;
use crate::io::room::room;

/// Rows that are read at once.
const ROWS: u64 = 4096;

pub(super) struct Array<'a> {
    source: Source<'a>,
    header: Option<Header>,
    /// The first column is the frame.
    framed: bool,
    rows: Vec<[i64; 6]>,
    /// The next of them.
    at: usize,
    /// Rows before them.
    before: u64,
    last: Option<i64>,
    ended: bool,
}

impl<'a> Array<'a> {
    pub fn new(source: Source<'a>) -> Array<'a> {
        let (header, rows, last) = (None, Vec::new(), None);
        Array { source, header, framed: false, rows, at: 0, before: 0, last, ended: false }
    }

    fn begin(&mut self, choice: &mut Choice) -> anyhow::Result<()> {
        let header = npy::header(&mut self.source)?;
        let columns = header.columns.filter(|_| !header.fortran);
        self.framed = match columns {
            Some(3 | 5 | 6) if choice.is_all() => true,
            Some(2 | 4 | 5) => false,
            _ => bail!(
                "{}: the shape is ({}); pairs have the shape (pairs, 2), with images in a box \
                 (pairs, 4) for discs and (pairs, 5) for spheres, in C order; with --frame all \
                 one column more, the frame, may stand before these",
                self.source.name,
                header.shape
            ),
        };
        choice.sparse = self.framed;
        self.header = Some(header);
        Ok(())
    }

    /// The next row, and its number; none at the end.
    fn row(&mut self) -> anyhow::Result<Option<([i64; 6], u64)>> {
        let Array { source, header: Some(header), rows, at, before, .. } = self else {
            return Ok(None);
        };
        if *at == rows.len() {
            *before += rows.len() as u64;
            rows.clear();
            *at = 0;
            let name = source.name;
            let columns = header.columns.unwrap_or(1);
            let first = if self.framed { 0 } else { 1 };
            let more = (header.rows - *before).min(ROWS);
            let mut row = [0; 6];
            header.values(source, more * columns as u64, |k, value| {
                let column = (k % columns as u64) as usize;
                ensure!(
                    value.fract() == 0.0 && value.abs() < 9e15,
                    "{name}: pair {}: {value} is not the number of {}",
                    *before + k / columns as u64,
                    ["a frame", "a particle", "a particle", "an image"][(column + first).min(3)]
                );
                row[column + first] = value as i64;
                if column + 1 == columns {
                    room(rows)?;
                    rows.push(row);
                }
                Ok(())
            })?;
            if rows.is_empty() {
                source.end(header)?;
                return Ok(None);
            }
        }
        *at += 1;
        Ok(Some((rows[*at - 1], *before + *at as u64 - 1)))
    }

    /// The last row is read again.
    fn back(&mut self) {
        self.at -= 1;
    }
}

impl Reader<List> for Array<'_> {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<List>> {
        if self.header.is_none() {
            self.begin(choice)?;
        }
        let images = self.header.as_ref().and_then(|header| header.columns).unwrap_or(2)
            - usize::from(self.framed)
            - 2;
        while !self.ended {
            let mut list = List { format: "npy", flat: images == 2, ..List::default() };
            list.images = (images > 0).then(Vec::new);
            let mut step = Step::Keep;
            let mut empty = true;
            loop {
                let Some((row, k)) = self.row()? else {
                    self.ended = true;
                    break;
                };
                let place = || format!("{}: pair {k}", self.source.name);
                if self.framed && (empty || self.last != Some(row[0])) {
                    if !empty {
                        self.back();
                        break;
                    }
                    ensure!(row[0] >= 0, "{}: {} is not the number of a frame", place(), row[0]);
                    ascends(self.last.replace(row[0]), row[0], "frame", place)?;
                    list.frame = Some(row[0] as u64);
                    step = choice.begin_at(row[0] as u64, place)?;
                    if step == Step::Stop {
                        self.ended = true;
                        return Ok(None);
                    }
                }
                empty = false;
                if step == Step::Keep {
                    if let Some(images) = &mut list.images {
                        room(images)?;
                        images.push(image([row[3], row[4], row[5]], place)?);
                    }
                    push(&mut list, [row[1], row[2]])?;
                }
            }
            if step == Step::Keep && !(self.framed && empty) {
                return Ok(Some(list));
            }
        }
        Ok(None)
    }
}
