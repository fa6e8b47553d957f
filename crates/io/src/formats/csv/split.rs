//! Rows of several times in one table: a column of frames, steps or times splits them into frames.
//!
//! The column is chosen (`--columns frame=NAME`), or the first that is called like a frame, else a
//! step, else a time. Its values rise or fall from frame to frame, so a frame cannot come back, and
//! no list of those that were there is kept.

use std::cmp::Ordering;

use anyhow::{bail, ensure};

use crate::lines::{Lines, among, number, short, shown, step_of};
use crate::particles::{Column, Columns};
use crate::units;
use crate::{Notice, Options};

/// Names of the columns that split a table, in lower case and without signs.
const NAMES: [(Kind, &str); 3] = [
    (Kind::Frame, "frame frames frameno framenumber frameid frameindex iframe snapshot snap"),
    (Kind::Step, "timestep step steps stepno timestepindex iteration iter tstep"),
    (Kind::Time, "time t times"),
];
/// Parts of other names that may split the particles into frames.
const LIKE: [&str; 6] = ["frame", "time", "step", "slice", "cycle", "snapshot"];
/// Header names that are read as ids if there is no column id.
const IDS: &str = "particle particleid pid trackid atomid bodyid";

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Frame,
    Step,
    Time,
}

/// A name in lower case without a unit, blanks and signs.
fn plain(name: &str) -> String {
    let name = units::split(name).0.to_ascii_lowercase();
    name.chars().filter(|c| !" _-.:#".contains(*c)).collect()
}

fn kind(name: &str) -> Option<Kind> {
    let name = plain(name);
    NAMES.iter().find(|(_, names)| among(names, &name)).map(|(kind, _)| *kind)
}

/// Returns a notice if an unused column or array may tell frames apart, judging by its name. In a
/// `table`, the names in [`NAMES`] cause no notice.
pub(crate) fn maybe_frames(unused: &[String], table: bool) -> Option<Notice> {
    let like = |name: &&String| {
        let lower = name.to_lowercase();
        LIKE.iter().any(|part| lower.contains(part)) && !(table && kind(name).is_some())
    };
    let name = short(unused.iter().find(like)?);
    let remedy = match table {
        true => format!("--columns frame={name} splits the rows"),
        false => "save one array of shape (frames, N, 3), or a table with that column".into(),
    };
    Some(Notice::Assumed(format!(
        "'{name}' is not used, and all particles are taken as of one time; if it tells times \
         apart, {remedy}"
    )))
}

/// Whether a comment begins with the name of a frame, a step or a time, and has a number, as in
/// `t = 0.5`. Other comments among rows are doubted, not refused.
pub(crate) fn names_a_frame(comment: &str) -> bool {
    let is_between = |c: char| !c.is_ascii_alphanumeric() && !"._+-".contains(c);
    let parts = || comment.split(is_between).filter(|part| !part.is_empty());
    parts().next().is_some_and(|part| kind(part).is_some())
        && parts().any(|part| number(part.as_bytes()).is_some())
}

/// Blank lines and comments among the rows of a table that no column splits: they may begin frames.
#[derive(Default)]
pub(super) struct Blocks {
    rows: u64,
    /// Number of blocks of rows after the first block.
    more: u64,
    /// A blank line or a comment stands behind the last row.
    ended: bool,
    /// The comment there that names a frame, and its place.
    named: Option<(String, String)>,
}

impl Blocks {
    /// A blank line, or a comment that is no row.
    pub fn end(&mut self, lines: &Lines<'_>) {
        self.ended = self.rows > 0;
        let comment = lines.text();
        if self.ended && names_a_frame(&comment) {
            self.named = Some((comment, lines.place()));
        }
    }

    pub fn row(&mut self) -> anyhow::Result<()> {
        if let Some((comment, place)) = &self.named {
            bail!(
                "{place}: the comment '{}' among the rows may begin another frame; write the \
                 frame as a column, or say --columns frame=none if all rows are of one time",
                short(comment)
            );
        }
        self.more += u64::from(std::mem::take(&mut self.ended));
        self.rows += 1;
        Ok(())
    }

    /// The doubt about blocks of several rows.
    pub fn notice(&self) -> Option<Notice> {
        (self.more > 0 && self.rows > self.more + 1).then(|| {
            Notice::Assumed(format!(
                "blank lines or comments divide the rows into {} blocks, and all are taken as of \
                 one time; if each block is a frame, write the frame as a column",
                self.more + 1
            ))
        })
    }
}

/// The first column of a kind that is not used for something else.
fn place(columns: &Columns, of: Kind) -> Option<usize> {
    let mut all = columns.names.iter().zip(&columns.meaning);
    all.position(|(name, meaning)| *meaning == Column::Other && kind(name) == Some(of))
}

/// The column that splits the rows, by its name.
pub(super) fn by_name(columns: &Columns) -> Option<usize> {
    [Kind::Frame, Kind::Step, Kind::Time].into_iter().find_map(|kind| place(columns, kind))
}

/// The splitting column, and what it has shown so far.
pub(super) struct Split {
    pub column: usize,
    name: String,
    kind: Kind,
    /// Whether the column is named t or time and was not chosen: each row may have a value of its
    /// own.
    doubtful: bool,
    value: Vec<u8>,
    rows: u64,
    /// The direction from the first frame to the second.
    order: Option<Ordering>,
    /// Columns of steps and times beside, with the values of the frame; none if they differ.
    beside: [Option<(usize, Option<Vec<u8>>)>; 2],
}

impl Split {
    /// Also takes a column of ids, if there is none of that name.
    pub fn new(column: usize, columns: &mut Columns, options: Options) -> anyhow::Result<Split> {
        let name = columns.names[column].clone();
        ensure!(
            columns.meaning[column] == Column::Other,
            "the column '{}' holds something else already, and cannot split the rows into frames",
            short(&name)
        );
        let chosen = options.columns.is_some_and(|chosen| chosen.by_frame());
        let kind = kind(&name).unwrap_or(Kind::Frame);
        let beside = [Kind::Step, Kind::Time]
            .map(|it| place(columns, it).filter(|&k| k != column).map(|k| (k, None)));
        if !columns.meaning.contains(&Column::Id) && !options.columns.is_some_and(|it| it.axes()) {
            let is_id = |name: &String| among(IDS, &plain(name));
            let ids = columns.names.iter().zip(&mut columns.meaning);
            let mut ids = ids.filter(|(name, it)| **it == Column::Other && is_id(name));
            if let Some((_, meaning)) = ids.next() {
                *meaning = Column::Id;
            }
        }
        let doubtful = kind == Kind::Time && !chosen;
        let (value, rows, order) = (Vec::new(), 0, None);
        Ok(Split { column, name, kind, doubtful, value, rows, order, beside })
    }

    /// Looks at a row. True if it is of the next frame, and not the `first` of one.
    pub fn is_next<'a>(
        &mut self,
        cells: &mut (impl Iterator<Item = &'a [u8]> + Clone),
        first: bool,
        place: impl Fn() -> String,
    ) -> anyhow::Result<bool> {
        let cell = cells.clone().nth(self.column).unwrap_or_default();
        if first {
            let value = number(cell);
            ensure!(
                !cell.is_empty() && value.is_none_or(f64::is_finite),
                "{}: column '{}': '{}' is no frame, step or time; mend or remove the line, or say \
                 --columns frame=none",
                place(),
                short(&self.name),
                shown(cell)
            );
            (self.value, self.rows) = (cell.to_vec(), 1);
            for (k, value) in self.beside.iter_mut().flatten() {
                *value = cells.clone().nth(*k).map(<[u8]>::to_vec);
            }
            return Ok(false);
        }
        let order = compared(&self.value, cell);
        if order == Ordering::Equal {
            self.rows += 1;
            for (k, value) in self.beside.iter_mut().flatten() {
                let same = |value: &Vec<u8>| cells.clone().nth(*k) == Some(value);
                *value = value.take().filter(same);
            }
            return Ok(false);
        }
        let name = short(&self.name);
        if *self.order.get_or_insert(order) != order {
            bail!(
                "{}: the rows are not sorted by '{name}', which splits them into frames: '{}' \
                 comes \
                 after '{}'; sort them by that column (sort -s -g -k {}, for commas with -t , or \
                 sort_values in pandas), or say --columns frame=none if it splits nothing",
                place(),
                shown(cell),
                shown(&self.value),
                self.column + 1
            );
        }
        // Looked at once, in the first frame.
        ensure!(
            !std::mem::take(&mut self.doubtful) || self.rows > 1,
            "{}: the first rows differ in '{name}': say --columns frame={name} if each is a frame, \
             and --columns frame=none if it is no time of frames",
            place(),
        );
        Ok(true)
    }

    pub fn step(&self) -> Option<i64> {
        let beside = self.beside[0].as_ref().and_then(|(_, value)| value.as_deref());
        match self.kind {
            Kind::Time => beside.and_then(step_of),
            Kind::Step => step_of(&self.value),
            Kind::Frame => step_of(beside.unwrap_or(&self.value)),
        }
    }

    pub fn time(&self) -> Option<f64> {
        let beside = self.beside[1].as_ref().and_then(|(_, value)| value.as_deref());
        match self.kind {
            Kind::Time => number(&self.value),
            _ => beside.and_then(number),
        }
        .filter(|time| time.is_finite())
    }

    /// What is to be said of the frame with this number.
    pub fn notices(&self, index: u64) -> Option<Notice> {
        let value = step_of(&self.value).filter(|_| self.kind == Kind::Frame)?;
        let other = u64::try_from(value).ok() != Some(index);
        other.then(|| {
            Notice::Assumed(format!(
                "frames are numbered from 0, so frame {index} is that with {value} in '{}'",
                short(&self.name)
            ))
        })
    }
}

/// The order of two values: as numbers if both are, else as texts.
fn compared(a: &[u8], b: &[u8]) -> Ordering {
    if a == b {
        return Ordering::Equal;
    }
    let whole = step_of(a).zip(step_of(b)).map(|(a, b)| a.cmp(&b));
    let real = || number(a).zip(number(b)).and_then(|(a, b)| a.partial_cmp(&b));
    whole.or_else(real).unwrap_or_else(|| a.cmp(b))
}
