//! Finds several scenes in one table, whatever its columns are called. The numbers of particles
//! restart when another column changes, and the scenes overlap.
//!
//! Numbers must rise within a scene, and a later scene must begin with the first number. Particles
//! of molecules and of lattice rows are numbered in this way, too, but rows and molecules do not
//! overlap.

use anyhow::bail;

use super::split;
use crate::columns::{Column, Columns};
use crate::raw::lines::{number, short};

/// Maximum number of compared columns.
const MOST_COLUMNS: usize = 12;

pub(super) struct Repeats {
    columns: Vec<Seen>,
    axes: Vec<usize>,
    /// `None` before the first row.
    pairs: Option<Vec<Pair>>,
    ids: Vec<usize>,
}

/// A column of neither coordinates nor sizes.
#[derive(Default)]
struct Seen {
    column: usize,
    first: Vec<u8>,
    last: Vec<u8>,
    value: Option<f64>,
    /// Whether the cell differs from the one before.
    changes: bool,
    /// Whether its number is higher than the one before.
    rises: bool,
    /// Whether it equals the first cell.
    again: bool,
}

/// A column that may divide the scenes, and one that may number the particles of each.
struct Pair {
    divides: usize,
    numbers: usize,
    /// Whether the divided rows are the places of one particle, which may stand apart.
    tracks: bool,
    again: bool,
    /// Whether some scene has two rows.
    rose: bool,
    /// Range of the coordinates of this scene, and of the one before.
    range: Range,
    before: Option<Range>,
}

type Range = [[f64; 2]; 3];

impl Repeats {
    /// `None` if fewer than two columns can be compared.
    pub fn new(columns: &Columns) -> Option<Repeats> {
        let which = |is_it: fn(&Column) -> bool| {
            let all = columns.meaning.iter().enumerate();
            all.filter(move |(_, it)| is_it(it)).map(|(k, _)| k)
        };
        let unused = which(|it| matches!(it, Column::Other | Column::Id)).take(MOST_COLUMNS);
        let seen: Vec<Seen> = unused.map(|column| Seen { column, ..Seen::default() }).collect();
        let axes = which(|it| matches!(it, Column::Axis(_))).take(3).collect();
        let is_id =
            |&k: &usize| columns.meaning[k] == Column::Id || split::is_id(&columns.names[k]);
        let ids = seen.iter().map(|it| it.column).filter(is_id).collect();
        (seen.len() > 1).then_some(Repeats { columns: seen, axes, pairs: None, ids })
    }

    pub fn row<'a>(&mut self, cells: impl Iterator<Item = &'a [u8]>) {
        let Repeats { columns, axes, pairs, ids } = self;
        let is_first = pairs.is_none();
        if pairs.as_ref().is_some_and(Vec::is_empty) {
            return;
        }
        let cells: Vec<&[u8]> = cells.collect();
        let at = |k: usize| cells.get(k).copied().unwrap_or_default();
        for seen in &mut *columns {
            seen.take(at(seen.column), is_first);
        }
        let x = |axis: usize| axes.get(axis).map_or(0.0, |&k| number(at(k)).unwrap_or(f64::NAN));
        let point: Range = [0, 1, 2].map(|axis| [x(axis); 2]);
        let Some(pairs) = pairs else {
            let whole = |seen: &Seen| seen.value.is_some_and(|it| it.fract() == 0.0);
            let all = (0..columns.len()).flat_map(|a| (0..columns.len()).map(move |b| (a, b)));
            let all = all.filter(|&(a, b)| a != b && whole(&columns[b]));
            let pair = |(divides, numbers): (usize, usize)| {
                let tracks = ids.contains(&columns[divides].column);
                let (again, rose, range, before) = (false, false, point, None);
                Pair { divides, numbers, tracks, again, rose, range, before }
            };
            *pairs = Some(all.map(pair).collect());
            return;
        };
        pairs.retain_mut(|pair| {
            let (begins, numbers) = (columns[pair.divides].changes, &columns[pair.numbers]);
            let goes_on = numbers.rises != begins && (!begins || pair.overlaps());
            if begins {
                pair.again |= numbers.again;
                pair.before = Some(std::mem::replace(&mut pair.range, point));
            } else {
                pair.rose = true;
                for ([low, high], [x, _]) in pair.range.iter_mut().zip(point) {
                    (*low, *high) = (low.min(x), high.max(x));
                }
            }
            goes_on
        });
    }

    /// Fails if the rows seem to be several scenes.
    pub fn end(&self, columns: &Columns) -> anyhow::Result<()> {
        let found = self.pairs.iter().flatten().find(|it| it.again && it.rose && it.overlaps());
        let Some(Pair { divides, numbers, tracks, .. }) = found else { return Ok(()) };
        let [by, of] = [divides, numbers].map(|&k| self.columns[k].column);
        let [divides, numbers] = [by, of].map(|k| short(&columns.names[k]));
        if *tracks {
            bail!(
                "'{numbers}' restarts with each '{divides}': sort the rows by '{numbers}' and \
                 give frame={} in --columns, or frame=none for one scene",
                of + 1
            );
        }
        bail!(
            "'{numbers}' restarts when '{divides}' changes: give frame={} in --columns if '{divides}' \
             divides scenes, otherwise frame=none",
            by + 1
        );
    }
}

impl Seen {
    fn take(&mut self, cell: &[u8], is_first: bool) {
        if is_first {
            self.first = cell.to_vec();
        }
        self.changes = self.last != cell;
        if self.changes || is_first {
            let value = number(cell);
            self.rises = value.zip(self.value).is_some_and(|(now, before)| now > before);
            (self.value, self.again) = (value, self.first == cell);
            self.last.clear();
            self.last.extend_from_slice(cell);
        } else {
            self.rises = false;
        }
    }
}

impl Pair {
    /// Whether this scene overlaps the one before. Places of one particle need not overlap.
    fn overlaps(&self) -> bool {
        let apart = |([a, b], [c, d]): (&[f64; 2], &[f64; 2])| b < c || d < a;
        self.tracks || self.before.is_none_or(|before| !self.range.iter().zip(&before).any(apart))
    }
}
