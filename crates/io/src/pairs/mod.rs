//! Reads contact lists of other programs: CSV, npy, npz, LAMMPS dump local.
//!
//! A list names particles by numbers, which the caller interprets: indices from 0 or 1, or ids. A
//! file may hold one list per frame: sections of a dump, or rows in the order of a
//! column `frame` (from 0) or `step`. In npy, the first of three, five or six columns is the frame,
//! if all frames are read.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use anyhow::{Context, bail, ensure};

use crate::formats::{npy, unread};
use crate::frames::{Choice, Once, Reader, Step, Stream};
use crate::load::{series, unpacked};
use crate::raw::lines::{Lines, Source};
use crate::raw::room::room;
use crate::types::{FrameChoice, Notice};

mod archive;
mod array;
mod columns;
mod csv;
mod dump;
mod list;
pub use list::{List, columns_of};

/// The contact lists of a file.
pub type Lists<'a> = Stream<'a, List>;

impl Lists<'_> {
    /// Whether rows contain their frame; then a frame without rows has no pairs.
    pub fn is_sparse(&self) -> bool {
        self.choice.sparse
    }

    /// Returns the list of the chosen frame.
    pub fn chosen(mut self) -> anyhow::Result<List> {
        let (kept, frame) = self.one()?;
        let frame = Some(frame).filter(|_| self.choice.seen > 0);
        let none = || List { format: "CSV", frame, sparse: true, ..List::default() };
        Ok(kept.unwrap_or_else(none))
    }
}

/// Reads a contact list. `columns` chooses columns of a LAMMPS dump or CSV file: none, the two
/// particles, or these and the two or three of the image.
pub fn read(path: &Path, columns: &[&str], frame: FrameChoice) -> anyhow::Result<List> {
    lists(path, columns, frame, |lists| lists.chosen())
}

pub fn lists<T>(
    path: &Path,
    columns: &[&str],
    frame: FrameChoice,
    body: impl FnOnce(Lists<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let name = path.display().to_string();
    let mut is_first = true;
    let read = move |file: &Path, index, notice: &Option<Notice>| {
        let mut list = read(file, columns, FrameChoice::Only)?;
        list.notices.extend(notice.clone().filter(|_| std::mem::take(&mut is_first)));
        Ok(List { frame: Some(index), sparse: false, ..list })
    };
    if let Some(series) = series::of(path, read)? {
        let choice = Choice::new(frame, false);
        return body(Lists::new(Box::new(series), choice, &name));
    }
    let file = File::open(path).with_context(|| format!("cannot read {name}"))?;
    lists_from(file, &name, columns, frame, body)
}

pub fn lists_from<T>(
    reader: impl Read,
    name: &str,
    columns: &[&str],
    frame: FrameChoice,
    body: impl FnOnce(Lists<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let count = columns.iter().filter(|label| !label.contains('=')).count();
    ensure!(
        matches!(count, 0 | 2 | 4 | 5),
        "--pairs-columns takes I,J for the particles, or I,J,SX,SY[,SZ] with the image, and \
         COLUMN=VALUE to read only rows with this value"
    );
    unpacked(reader, name, |input, unpacking, head, _| {
        let reader = open(Source { input, name, unpacking }, head, columns)?;
        body(Lists::new(reader, Choice::new(frame, false), name))
    })
}

fn open<'a>(
    source: Source<'a>,
    head: &[u8],
    columns: &'a [&'a str],
) -> anyhow::Result<Box<dyn Reader<List> + 'a>> {
    let name = source.name;
    let (is_npy, is_npz) = (head.starts_with(npy::MAGIC), head.starts_with(b"PK\x03\x04"));
    let limits = columns.iter().any(|label| label.contains('='));
    ensure!(
        !(is_npy && !columns.is_empty() || is_npz && limits),
        "{name}: --pairs-columns is for tables, and this is an array; write its pairs as CSV, or \
         the columns that hold them as an array: numpy.save('pairs.npy', a[:, :2])"
    );
    if is_npy {
        return Ok(Box::new(RowReader::new(array::Array::new(source))));
    }
    unread::refuse(head, name)?;
    if is_npz {
        return Ok(Box::new(Once::new(move || archive::read(source, columns))));
    }
    let is_text = !head.contains(&0);
    ensure!(is_text, "{name} is binary, and no npy or npz; write CSV with a header i,j");
    let lines = Lines::new(source);
    if head.starts_with(b"ITEM:") {
        return Ok(Box::new(dump::Dump::new(lines, columns)));
    }
    Ok(Box::new(RowReader::new(csv::Csv::new(lines, columns))))
}

/// What to do with a matrix of neighbours.
const MATRIX: &str = "write the pairs: i, k = numpy.nonzero(numpy.arange(m.shape[1]) < c[:, \
                      None]); numpy.save('pairs.npy', numpy.stack([i, m[i, k]], 1)), where m is the \
                      array and c has the numbers of neighbours";

/// Rows of pairs, each of which may contain its frame.
trait Rows {
    /// Reads what precedes the rows; sets [`Choice::sparse`] if rows contain their frame.
    fn begin(&mut self, choice: &mut Choice) -> anyhow::Result<()>;

    /// Reads the next row. Returns its frame or step, 0 if it has neither, or `None` at the end.
    fn advance(&mut self) -> anyhow::Result<Option<i64>>;

    fn place(&self) -> String;

    fn take(&mut self, list: &mut List) -> anyhow::Result<()>;

    fn list(&mut self) -> List;

    fn end(&mut self, list: &mut List);
}

struct RowReader<R> {
    rows: R,
    begun: bool,
    /// Frame or step of the current row, until the row is added to a list.
    ahead: Option<i64>,
    last: Option<i64>,
}

impl<R> RowReader<R> {
    fn new(rows: R) -> RowReader<R> {
        RowReader { rows, begun: false, ahead: None, last: None }
    }
}

impl<R: Rows> Reader<List> for RowReader<R> {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<List>> {
        let RowReader { rows, ahead, last, begun } = self;
        let is_first = !std::mem::replace(begun, true);
        if is_first {
            rows.begin(choice)?;
            *ahead = rows.advance()?;
        }
        // A file without a column of frames is one list, even if it has no rows.
        let mut one = (is_first && !choice.sparse).then_some(0);
        while let Some(label) = ahead.or(one.take()) {
            let mut list = List { sparse: choice.sparse, ..rows.list() };
            let mut step = Step::Keep;
            if choice.sparse {
                let what = if choice.by_step { "step" } else { "frame" };
                let after = last.replace(label).filter(|&last| last > label);
                if let Some(last) = after {
                    bail!("{}: {what} {label} stands after {last}; sort the rows", rows.place());
                }
                let index = if choice.by_step { choice.seen } else { label as u64 };
                list.frame = Some(index);
                list.step = choice.by_step.then_some(label);
                step = choice.begin_at(index, || rows.place())?;
            }
            if step == Step::Stop {
                return Ok(None);
            }
            while *ahead == Some(label) {
                if step == Step::Keep {
                    rows.take(&mut list)?;
                }
                *ahead = rows.advance()?;
            }
            if step == Step::Keep {
                rows.end(&mut list);
                return Ok(Some(list));
            }
        }
        Ok(None)
    }
}

/// Adds a pair with its image, if there is one; image numbers must fit in 32 bits.
fn push(
    list: &mut List,
    pair: [i64; 2],
    image: Option<[i64; 3]>,
    place: impl Fn() -> String,
) -> anyhow::Result<()> {
    if let Some(numbers) = image {
        let mut image = [0; 3];
        for (image, number) in image.iter_mut().zip(numbers) {
            *image = i32::try_from(number).ok().with_context(|| {
                format!("{}: {number} is not the number of an image: below 2^31", place())
            })?;
        }
        let images = list.images.get_or_insert_default();
        room(images)?;
        images.push(image);
    }
    room(&mut list.pairs)?;
    list.pairs.push(pair);
    Ok(())
}
