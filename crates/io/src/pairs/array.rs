//! Contact lists in npy arrays, one pair per row.
//!
//! | columns | content |
//! |---|---|
//! | 2 | i, j |
//! | 4 or 5 | i, j, and the image of j in 2D or 3D |
//! | 3, 5 or 6 | the frame before these, if all frames are read |
//!
//! Arrays in Fortran order, or of shape (2, pairs), are read whole.

use anyhow::{Context, bail, ensure};

use super::list::List;
use super::{MATRIX, Rows, push};
use crate::formats::npy::{self, Header};
use crate::frames::Choice;
use crate::raw::lines::{Source, exact};
use crate::raw::room::room;
use crate::types::{Notice, assumed};

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
    columns: u64,
    framed: bool,
    /// Whether the array has one column for each pair.
    turned: bool,
}

impl Shape {
    /// Returns how the array stores pairs; `None` if it holds none.
    fn of(header: &Header, all: bool) -> Option<Shape> {
        let framed = |columns: u64| all && matches!(columns, 3 | 5 | 6);
        let fits = |columns: u64| matches!(columns, 2 | 4 | 5) || framed(columns);
        let (rows, columns) = (header.rows, header.columns.unwrap_or(0) as u64);
        let (pairs, columns, turned) = match columns {
            // An empty array has no columns to check.
            0 if rows == 0 || header.columns.is_some() => (0, 2, false),
            _ if fits(columns) => (rows, columns, false),
            1.. if fits(rows) => (columns, rows, true),
            _ => return None,
        };
        Some(Shape { pairs, columns, framed: framed(columns), turned })
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

    fn more(&mut self) -> anyhow::Result<()> {
        let Array { source, header: Some(header), rows, at, before, shape, .. } = self else {
            return Ok(());
        };
        *before += rows.len() as u64;
        rows.clear();
        *at = 0;
        let Shape { pairs, columns, framed, .. } = *shape;
        let (name, first) = (source.name, usize::from(!framed));
        let count = (pairs - *before).min(ROWS);
        header.values(source, count.saturating_mul(columns), |k, value| {
            let (row, column) = ((k / columns) as usize, (k % columns) as usize + first);
            if row == rows.len() {
                room(rows)?;
                rows.push([0; 6]);
            }
            rows[row][column] = exact(value).with_context(|| {
                let what = ["a frame", "a particle", "a particle", "an image"][column.min(3)];
                format!(
                    "{name}: pair {}: {value} is not the number of {what}",
                    *before + row as u64
                )
            })?;
            Ok(())
        })?;
        if rows.is_empty() { source.end(header) } else { Ok(()) }
    }

    fn images(&self) -> u64 {
        self.shape.columns.saturating_sub(2 + u64::from(self.shape.framed))
    }
}

impl Rows for Array<'_> {
    fn begin(&mut self, choice: &mut Choice) -> anyhow::Result<()> {
        let mut header = match self.header.take() {
            Some(header) => header,
            None => npy::header(&mut self.source)?,
        };
        let Some(shape) = Shape::of(&header, choice.is_all()) else {
            let (name, shape) = (self.source.name, npy::shape(&header.sizes));
            bail!(
                "{name}: the shape is {shape}, not (pairs, 2) or (2, pairs), or (pairs, 4 or 5); if \
                 each row has the neighbours of one particle, {MATRIX}"
            )
        };
        choice.sparse = shape.framed;
        if shape.turned {
            header.transpose();
        } else if shape.pairs == 2 && !header.fortran {
            self.notices.push(assumed!(
                "the shape {} is taken as 2 pairs, one a row; write the transpose, \
                 numpy.array([i, j]).T, if the rows are i and j",
                npy::shape(&header.sizes)
            ));
        }
        (self.shape, self.header) = (shape, Some(header));
        Ok(())
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
