//! Splits the rows of a table into frames by a column of frames, steps or times.
//!
//! The column is chosen (`--columns frame=NAME`), or it is the first one named like a frame, else
//! like a step, else like a time. Its values must rise or fall from frame to frame. So a frame
//! cannot return, and earlier values need not be stored.

use std::cmp::Ordering;

use anyhow::{bail, ensure};

use crate::columns::{Column, Columns, units};
use crate::options::Options;
use crate::raw::lines::{among, number, short, shown, step_of};

/// Names of splitting columns, in lower case and without signs.
const NAMES: [(BlockKind, &str); 3] = [
    (BlockKind::Frame, "frame snapshot"),
    (BlockKind::Step, "step timestep iteration"),
    (BlockKind::Time, "time t"),
];
/// Names of columns that are read as ids if no column is named id.
const IDS: &str = "particle particleid pid trackid atomid bodyid";

#[derive(Clone, Copy, Debug, PartialEq)]
enum BlockKind {
    Frame,
    Step,
    Time,
}

fn plain(name: &str) -> String {
    let name = units::split(name).0.to_ascii_lowercase();
    name.chars().filter(|c| !" _-.:#".contains(*c)).collect()
}

fn kind(name: &str) -> Option<BlockKind> {
    let name = plain(name);
    NAMES.iter().find(|(_, names)| among(names, &name)).map(|(kind, _)| *kind)
}

pub(super) fn is_id(name: &str) -> bool {
    among(IDS, &plain(name))
}

fn place(columns: &Columns, of: BlockKind) -> Option<usize> {
    let mut all = columns.names.iter().zip(&columns.meaning);
    all.position(|(name, meaning)| *meaning == Column::Other && kind(name) == Some(of))
}

pub(super) fn by_name(columns: &Columns) -> Option<usize> {
    [BlockKind::Frame, BlockKind::Step, BlockKind::Time]
        .into_iter()
        .find_map(|kind| place(columns, kind))
}

pub(super) struct Split {
    pub column: usize,
    name: String,
    kind: BlockKind,
    /// Whether the column is named t or time and was not chosen. Such a column may hold a different
    /// value in each row.
    doubtful: bool,
    value: Vec<u8>,
    rows: u64,
    order: Option<Ordering>,
    /// Unused columns of steps and times, each with its value in this frame (`None` if rows
    /// differ).
    beside: [Option<(usize, Option<Vec<u8>>)>; 2],
}

impl Split {
    /// Splits by this column. If no column is named id, one in [`IDS`] is used as ids.
    pub fn new(column: usize, columns: &mut Columns, options: Options) -> anyhow::Result<Split> {
        let name = columns.names[column].clone();
        let is_free = columns.meaning[column] == Column::Other;
        ensure!(is_free, "the column '{}' cannot hold the frames, too", short(&name));
        let chosen = options.columns.is_some_and(|chosen| chosen.by_frame());
        let kind = kind(&name).unwrap_or(BlockKind::Frame);
        let beside = [BlockKind::Step, BlockKind::Time]
            .map(|it| place(columns, it).filter(|&k| k != column).map(|k| (k, None)));
        if !columns.meaning.contains(&Column::Id) && !options.axes_chosen() {
            let ids = columns.names.iter().zip(&mut columns.meaning);
            let mut ids = ids.filter(|(name, it)| **it == Column::Other && is_id(name));
            if let Some((_, meaning)) = ids.next() {
                *meaning = Column::Id;
            }
        }
        let doubtful = kind == BlockKind::Time && !chosen;
        let (value, rows, order) = (Vec::new(), 0, None);
        Ok(Split { column, name, kind, doubtful, value, rows, order, beside })
    }

    /// Whether a row begins the next frame. `first` marks the first row of a frame.
    pub fn is_next<'a>(
        &mut self,
        cells: &mut (impl Iterator<Item = &'a [u8]> + Clone),
        first: bool,
        place: impl Fn() -> String,
    ) -> anyhow::Result<bool> {
        let cell = cells.clone().nth(self.column).unwrap_or_default();
        if first {
            let (place, name, found) = (place(), short(&self.name), shown(cell));
            let sound = !cell.is_empty() && number(cell).is_none_or(f64::is_finite);
            ensure!(sound, "{place}: '{found}' is not a {name}; give --columns frame=none");
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
        let (place, name) = (place(), short(&self.name));
        if *self.order.get_or_insert(order) != order {
            let (after, before) = (shown(cell), shown(&self.value));
            bail!(
                "{place}: {name} {after} comes after {before}; sort, or give --columns frame=none"
            );
        }
        // The end of the first frame shows whether each row has its own value.
        let sure = !std::mem::take(&mut self.doubtful) || self.rows > 1;
        ensure!(
            sure,
            "{place}: the first rows differ in '{name}'; give --columns frame={name} or none"
        );
        Ok(true)
    }

    pub fn step(&self) -> Option<i64> {
        let beside = self.beside[0].as_ref().and_then(|(_, value)| value.as_deref());
        match self.kind {
            BlockKind::Time => beside.and_then(step_of),
            BlockKind::Step => step_of(&self.value),
            BlockKind::Frame => step_of(beside.unwrap_or(&self.value)),
        }
    }

    pub fn time(&self) -> Option<f64> {
        let beside = self.beside[1].as_ref().and_then(|(_, value)| value.as_deref());
        match self.kind {
            BlockKind::Time => number(&self.value),
            _ => beside.and_then(number),
        }
        .filter(|time| time.is_finite())
    }
}

fn compared(a: &[u8], b: &[u8]) -> Ordering {
    if a == b {
        return Ordering::Equal;
    }
    let whole = step_of(a).zip(step_of(b)).map(|(a, b)| a.cmp(&b));
    let real = || number(a).zip(number(b)).and_then(|(a, b)| a.partial_cmp(&b));
    whole.or_else(real).unwrap_or_else(|| a.cmp(b))
}
