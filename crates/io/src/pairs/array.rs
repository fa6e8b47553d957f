//! npy: rows of two numbers, the pair; with images in a box of four (discs) or five (spheres).
//! Where all frames are wanted, of three, five or six, and the first is the frame. Fortran order
//! and arrays whose rows are i and j (shape (2, pairs)) hold one number of all pairs after the
//! other: they are read whole.

use anyhow::{bail, ensure};

use super::list::List;
use super::{ascends, image, push};
use crate::formats::npy::{self, Header};
use crate::frames::{Choice, Reader, Step};
use crate::lines::Source;
use crate::notice::Notice;
use crate::room::room;

/// Rows that are read at once.
const ROWS: u64 = 4096;

pub(super) struct Array<'a> {
    source: Source<'a>,
    header: Option<Header>,
    begun: bool,
    shape: Shape,
    notices: Vec<Notice>,
    rows: Vec<[i64; 6]>,
    /// The next of them.
    at: usize,
    /// Rows before them.
    before: u64,
    last: Option<i64>,
    ended: bool,
}

/// What the numbers of an array are.
#[derive(Clone, Copy, Default)]
struct Shape {
    pairs: u64,
    /// Numbers of each pair.
    columns: usize,
    /// Whether each row begins with its frame.
    framed: bool,
    /// One number of all pairs stands after the other.
    by_column: bool,
}

impl Shape {
    /// With a notice where the array could be read another way; none where it holds no pairs.
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
            // Nothing has no columns.
            None | Some(0) if rows == 0 || header.columns.is_some() => return Some(none()),
            None => return None,
            Some(columns) => columns as u64,
        };
        if fits(columns) {
            let either = rows == 2 && !header.fortran;
            let notice = either.then(|| {
                Notice::Assumed(format!(
                    "the shape ({}) is taken as 2 pairs, one a row; write the transpose, \
                     numpy.array([i, j]).T, if the rows are i and j",
                    header.shape
                ))
            });
            return Some((shape(rows, columns, header.fortran), notice));
        }
        fits(rows).then(|| (shape(columns, rows, !header.fortran), None))
    }
}

/// No pairs.
fn none() -> (Shape, Option<Notice>) {
    (Shape { columns: 2, ..Shape::default() }, None)
}

impl Shape {
    /// The place of the first number in a row of frame, pair and image.
    fn first(&self) -> usize {
        usize::from(!self.framed)
    }

    /// A whole number, of the pair `k`.
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
        Array {
            source,
            header: None,
            begun: false,
            shape: Shape::default(),
            notices: Vec::new(),
            rows: Vec::new(),
            at: 0,
            before: 0,
            last: None,
            ended: false,
        }
    }

    /// The array behind a header that was read.
    pub fn behind(source: Source<'a>, header: Header) -> Array<'a> {
        Array { header: Some(header), ..Array::new(source) }
    }

    fn begin(&mut self, choice: &mut Choice) -> anyhow::Result<()> {
        self.begun = true;
        let header = match self.header.take() {
            Some(header) => header,
            None => npy::header(&mut self.source)?,
        };
        let Some((shape, notice)) = Shape::of(&header, choice.is_all()) else {
            bail!(
                "{}: the shape is ({}); pairs have the shape (pairs, 2) or (2, pairs), with images \
                 in a box (pairs, 4) for discs and (pairs, 5) for spheres; with --frame all one \
                 column more, the frame, may stand before these",
                self.source.name,
                header.shape
            )
        };
        choice.sparse = shape.framed;
        self.notices.extend(notice);
        self.shape = shape;
        self.header = Some(header);
        if shape.by_column { self.by_column() } else { Ok(()) }
    }

    /// Reads one number of all pairs after the other.
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

    /// The next row, and its number; none at the end.
    fn row(&mut self) -> anyhow::Result<Option<([i64; 6], u64)>> {
        let Array { source, header: Some(header), rows, at, before, shape, .. } = self else {
            return Ok(None);
        };
        if *at == rows.len() {
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
        if !self.begun {
            self.begin(choice)?;
        }
        let framed = self.shape.framed;
        let images = self.shape.columns.saturating_sub(2 + usize::from(framed));
        while !self.ended {
            let mut list = List { format: "npy", flat: images == 2, ..List::default() };
            list.images = (images > 0).then(Vec::new);
            list.notices = std::mem::take(&mut self.notices);
            let mut step = Step::Keep;
            let mut empty = true;
            loop {
                let Some((row, k)) = self.row()? else {
                    self.ended = true;
                    break;
                };
                let place = || format!("{}: pair {k}", self.source.name);
                if framed && (empty || self.last != Some(row[0])) {
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
            if step == Step::Keep && !(framed && empty) {
                return Ok(Some(list));
            }
        }
        Ok(None)
    }
}
