//! Contact lists in npy arrays, one pair per row.
//!
//! | columns | content |
//! |---|---|
//! | 2 | i, j |
//! | 4 or 5 | i, j, and the image of j in 2D or 3D |
//! | 3, 5 or 6 | the frame before these, if all frames are read |
//!
//! Arrays in Fortran order, or of shape (2, pairs), are read whole.

use anyhow::{bail, ensure};

use super::list::List;
use super::{Rows, push};
use crate::formats::npy::{self, Header};
use crate::frames::Choice;
use crate::raw::lines::Source;
use crate::raw::room::room;
use crate::types::Notice;

const ROWS: u64 = 4096;

pub(super) struct Array<'a> {
    source: Source<'a>,
    header: Option<Header>,
    shape: Shape,
    notices: Vec<Notice>,
    /// Frame, pair and image of the rows read last.
    rows: Vec<[i64; 6]>,
    at: usize,
    before: u64,
}

#[derive(Clone, Copy, Default)]
struct Shape {
    pairs: u64,
    columns: usize,
    framed: bool,
    by_column: bool,
}

impl Shape {
    /// Returns how the array stores pairs, with a notice if it is ambiguous; `None` if it holds no
    /// pairs.
    fn of(header: &Header, all: bool) -> Option<(Shape, Option<Notice>)> {
        let fits = |columns: u64| matches!(columns, 2 | 4 | 5) || all && matches!(columns, 3 | 6);
        let framed = |columns: u64| all && matches!(columns, 3 | 5 | 6);
        let shape = |pairs, columns: u64, by_column| Shape {
            pairs,
            columns: columns as usize,
            framed: framed(columns),
            by_column,
        };
        let rows = header.rows;
        let columns = match header.columns {
            // An empty array has no columns to check.
            None | Some(0) if rows == 0 || header.columns.is_some() => {
                return Some((Shape { columns: 2, ..Shape::default() }, None));
            }
            None => return None,
            Some(columns) => columns as u64,
        };
        if fits(columns) {
            let either = rows == 2 && !header.fortran;
            let notice = either.then(|| {
                Notice::Assumed(format!(
                    "the shape {} is taken as 2 pairs, one a row; write the transpose, \
                     numpy.array([i, j]).T, if the rows are i and j",
                    npy::shape(&header.sizes)
                ))
            });
            return Some((shape(rows, columns, header.fortran), notice));
        }
        fits(rows).then(|| (shape(columns, rows, !header.fortran), None))
    }

    fn first(&self) -> usize {
        usize::from(!self.framed)
    }

    fn checked(&self, name: &str, k: u64, column: usize, value: f64) -> anyhow::Result<i64> {
        ensure!(
            value.fract() == 0.0 && value.abs() < 9e15,
            "{name}: pair {k}: {value} is not the number of {}",
            ["a frame", "a particle", "a particle", "an image"][column.min(3)]
        );
        Ok(value as i64)
    }
}

impl<'a> Array<'a> {
    pub fn new(source: Source<'a>) -> Array<'a> {
        let (shape, notices, rows) = (Shape::default(), Vec::new(), Vec::new());
        Array { source, header: None, shape, notices, rows, at: 0, before: 0 }
    }

    pub fn behind(source: Source<'a>, header: Header) -> Array<'a> {
        Array { header: Some(header), ..Array::new(source) }
    }

    fn by_column(&mut self) -> anyhow::Result<()> {
        let Array { source, header: Some(header), rows, shape, .. } = self else { return Ok(()) };
        let (name, first) = (source.name, shape.first());
        for column in first..first + shape.columns {
            header.values(source, shape.pairs, |k, value| {
                let value = shape.checked(name, k, column, value)?;
                if column == first {
                    room(rows)?;
                    rows.push([0; 6]);
                }
                rows[k as usize][column] = value;
                Ok(())
            })?;
        }
        Ok(())
    }

    fn more(&mut self) -> anyhow::Result<()> {
        let Array { source, header: Some(header), rows, at, before, shape, .. } = self else {
            return Ok(());
        };
        *before += rows.len() as u64;
        rows.clear();
        *at = 0;
        let (name, columns, first) = (source.name, shape.columns, shape.first());
        let more = (shape.pairs - *before).min(ROWS);
        let mut row = [0; 6];
        header.values(source, more * columns as u64, |k, value| {
            let (pair, column) = (*before + k / columns as u64, (k % columns as u64) as usize);
            row[column + first] = shape.checked(name, pair, column + first, value)?;
            if column + 1 == columns {
                room(rows)?;
                rows.push(row);
            }
            Ok(())
        })?;
        if rows.is_empty() { source.end(header) } else { Ok(()) }
    }

    fn images(&self) -> usize {
        self.shape.columns.saturating_sub(2 + usize::from(self.shape.framed))
    }
}

impl Rows for Array<'_> {
    fn begin(&mut self, choice: &mut Choice) -> anyhow::Result<()> {
        let header = match self.header.take() {
            Some(header) => header,
            None => npy::header(&mut self.source)?,
        };
        let Some((shape, notice)) = Shape::of(&header, choice.is_all()) else {
            bail!(
                "{}: the shape is {}; pairs have the shape (pairs, 2) or (2, pairs), with images \
                 in a box (pairs, 4) for discs and (pairs, 5) for spheres; with --frame all one \
                 column more, the frame, may stand before these",
                self.source.name,
                npy::shape(&header.sizes)
            )
        };
        choice.sparse = shape.framed;
        self.notices.extend(notice);
        self.shape = shape;
        self.header = Some(header);
        if shape.by_column { self.by_column() } else { Ok(()) }
    }

    fn advance(&mut self) -> anyhow::Result<Option<i64>> {
        if self.at == self.rows.len() {
            self.more()?;
        }
        let Some(row) = self.rows.get(self.at) else { return Ok(None) };
        self.at += 1;
        ensure!(row[0] >= 0, "{}: {} is not the number of a frame", self.place(), row[0]);
        Ok(Some(row[0]))
    }

    fn place(&self) -> String {
        format!("{}: pair {}", self.source.name, self.before + self.at as u64 - 1)
    }

    fn take(&mut self, list: &mut List) -> anyhow::Result<()> {
        let [_, i, j, image @ ..] = self.rows[self.at - 1];
        push(list, [i, j], (self.images() > 0).then_some(image), || self.place())
    }

    fn list(&mut self) -> List {
        let (images, notices) = (self.images(), std::mem::take(&mut self.notices));
        let (flat, images) = (images == 2, (images > 0).then(Vec::new));
        List { format: "npy", flat, images, notices, ..List::default() }
    }

    fn end(&mut self, _: &mut List) {}
}
