//! Finds several scenes in one table, whatever its columns are called: the numbers of particles
//! begin again where another column changes.
//!
//! Only numbers that rise within a scene are found. A column that fixes a coordinate, such as the
//! row of a lattice, divides no scenes.

use anyhow::bail;

use crate::columns::{Column, Columns};
use crate::raw::lines::{number, short};

/// Further columns are not compared.
const MOST_COLUMNS: usize = 12;

pub(super) struct Repeats {
    columns: Vec<usize>,
    axes: Vec<usize>,
    /// Columns that may divide the scenes, each with those that may number the particles.
    pairs: Vec<Pair>,
    first: Vec<Vec<u8>>,
    last: Vec<Vec<u8>>,
}

struct Pair {
    divides: usize,
    numbers: usize,
    /// Whether a later scene began with the number of the first row.
    again: bool,
    /// Whether each axis varied within scenes, and from scene to scene.
    axes: [[bool; 2]; 3],
}

impl Repeats {
    /// `None` if no two columns could show it.
    pub fn new(columns: &Columns) -> Option<Repeats> {
        let which = |is_it: fn(&Column) -> bool| {
            let all = columns.meaning.iter().enumerate();
            all.filter(move |(_, it)| is_it(it)).map(|(k, _)| k)
        };
        let unused = which(|it| matches!(it, Column::Other | Column::Id));
        let unused: Vec<usize> = unused.take(MOST_COLUMNS).collect();
        let axes = which(|it| matches!(it, Column::Axis(_))).take(3).collect();
        let pair = |&divides: &usize, &numbers: &usize| {
            let pair = Pair { divides, numbers, again: false, axes: [[false; 2]; 3] };
            (divides != numbers).then_some(pair)
        };
        let pairs = unused.iter().flat_map(|a| unused.iter().filter_map(move |b| pair(a, b)));
        let pairs: Vec<Pair> = pairs.collect();
        let (first, last) = (Vec::new(), Vec::new());
        (!pairs.is_empty()).then_some(Repeats { columns: unused, axes, pairs, first, last })
    }

    pub fn row<'a>(&mut self, cells: impl Iterator<Item = &'a [u8]>) {
        if self.pairs.is_empty() {
            return;
        }
        let cells: Vec<&[u8]> = cells.collect();
        let at = |k: usize| cells.get(k).copied().unwrap_or_default();
        if self.first.is_empty() {
            self.first = cells.iter().map(|cell| cell.to_vec()).collect();
            self.last = self.first.clone();
            let whole = |k: usize| number(at(k)).is_some_and(|it| it.fract() == 0.0);
            self.pairs.retain(|pair| whole(pair.numbers));
            return;
        }
        let Repeats { axes, pairs, first, last, .. } = self;
        let before = |k: usize| last.get(k).map_or(&[][..], |it| it);
        pairs.retain_mut(|pair| {
            let begins = at(pair.divides) != before(pair.divides);
            let values = number(at(pair.numbers)).zip(number(before(pair.numbers)));
            pair.again |=
                begins && first.get(pair.numbers).is_some_and(|it| it == at(pair.numbers));
            for (varies, &axis) in pair.axes.iter_mut().zip(&*axes) {
                varies[usize::from(begins)] |= at(axis) != before(axis);
            }
            values.is_some_and(|(now, before)| (now > before) != begins)
        });
        for &k in self.columns.iter().chain(&self.axes) {
            if let Some(last) = self.last.get_mut(k) {
                last.clear();
                last.extend_from_slice(at(k));
            }
        }
    }

    /// Fails if the rows seem to be several scenes.
    pub fn end(&self, columns: &Columns) -> anyhow::Result<()> {
        let fixes = |[within, between]: &[bool; 2]| !within && *between;
        let found = self.pairs.iter().find(|it| it.again && !it.axes.iter().any(fixes));
        let Some(Pair { divides, numbers, .. }) = found else { return Ok(()) };
        let (divides, numbers) = (&columns.names[*divides], &columns.names[*numbers]);
        let (by, of) = (short(divides), short(numbers));
        match Column::named(divides) {
            Column::Id => bail!(
                "the values of '{of}' begin again with each '{by}': sort the rows by '{of}' and \
                 give --columns frame={of}, or give --columns frame=none for one scene"
            ),
            _ => bail!(
                "the numbers in '{of}' begin again where '{by}' changes: give --columns \
                 frame={by} if it divides scenes, or frame=none for one scene"
            ),
        }
    }
}
