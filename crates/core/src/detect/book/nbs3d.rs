//! `nbs` in 3D: the Munjiza-NBS algorithm in space (Munjiza 2004, sections 3.10 and 3.11).
//!
//! 1. Every particle is put on the z-list of its layer; a loop over particles finds each layer
//!    once.
//! 2. The particles of the central layer, and those of the layer below, are put on two sets of
//!    y-lists: one list per row.
//! 3. A loop over the central layer finds each of its rows once. The row's particles go on x-lists,
//!    one per cell; those of the four neighbouring rows (one behind in the layer, three in the
//!    layer below) go together on a second set of x-lists.
//! 4. A loop over the central row finds each of its cells once and checks it against itself, the
//!    cell to the left, and the three merged lists left, here and right: the 13 cells of the
//!    contact mask.
//! 5. All lists are emptied by walking over particles. No loop over cells anywhere.
//!
//! * Cost: proportional to N, independent of the packing density; each particle is pushed at most 8
//!   times (1 z-list, 2 y-lists, 5 x-lists).
//! * Memory: `4(nz + 2ny + 2nx + 3N)` bytes (BOOK 3.80) for N particles and nx, ny, nz cells per
//!   axis, two empty border cells per axis included. Nothing is cached: integerised coordinates are
//!   computed again where they are needed.
//! * Refuses scenes whose nz + 2ny + 2nx exceeds the memory limit, and more than 2^31 - 1
//!   particles.
//! * Deviations from the book: as for [`super::nbs2d`]; layers and rows are both taken upwards from
//!   where they are found.

use super::list::{EMPTY, Heads, Links, numbered};
use crate::contact::Bodies;
use crate::detect::{Declare, Detector, Options, Refusal, within};
use crate::filter::Cells;
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

/// Kinds of lists.
const Z: usize = 0;
const Y: usize = 1;
const X: usize = 2;

/// Munjiza-NBS for spheres. The fields carry the book's names.
pub struct Nbs3d {
    options: Options,
    /// C: heads of the z-lists.
    c: Heads,
    /// Z, Y and X: links of the z-lists, y-lists and x-lists, side by side.
    links: Links<3>,
    /// B: heads of the y-lists, of the central layer and of the layer below.
    b: [Heads; 2],
    /// A: heads of the x-lists, of the central row and of its four neighbouring rows together.
    a: [Heads; 2],
    formula: u64,
}

impl Declare for Nbs3d {
    fn with(options: Options) -> Nbs3d {
        Nbs3d {
            options,
            c: Heads::default(),
            links: Links::default(),
            b: Default::default(),
            a: Default::default(),
            formula: 0,
        }
    }

    fn formula_bytes(&self) -> u64 {
        self.formula
    }
}

impl<T: Real> Detector<T, 3> for Nbs3d {
    fn detect<B: Bodies<T, 3>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let cells = Cells::new(&bodies)?;
        self.prepare(&cells, bodies.len())?;
        let n = bodies.len() as u32;
        self.push_layers(&bodies, &cells, probe);
        for k in 0..n {
            let mut layer = cells.index(bodies.position(k)[2], 2, probe);
            while let Some(first) = self.c.take_new(layer, probe) {
                self.layer(&bodies, &cells, first, layer, probe, sink);
                layer += 1;
            }
        }
        for k in 0..n {
            self.c.reset(cells.index(bodies.position(k)[2], 2, probe), probe);
        }
        Ok(())
    }
}

impl Nbs3d {
    /// What all arrays take.
    pub(crate) fn bytes(cells: &Cells<3>, n: usize) -> u64 {
        let [nx, ny, nz] = cells.count;
        4 * (u64::from(nz) + 2 * u64::from(ny) + 2 * u64::from(nx) + 3 * n as u64)
    }

    pub(crate) fn prepare(&mut self, cells: &Cells<3>, n: usize) -> Result<(), Refusal> {
        numbered("nbs", n)?;
        let ([nx, ny, nz], needed) = (cells.count, Nbs3d::bytes(cells, n));
        within(&self.options, "nbs", needed, || {
            format!("{n} particles, {nx} x {ny} x {nz} cells")
        })?;
        self.formula = needed;
        self.c.prepare(nz as usize);
        self.links.prepare(n);
        self.b.iter_mut().for_each(|heads| heads.prepare(ny as usize));
        self.a.iter_mut().for_each(|heads| heads.prepare(nx as usize));
        Ok(())
    }

    fn push_layers<T: Real, P: Probe>(
        &mut self,
        bodies: &impl Bodies<T, 3>,
        cells: &Cells<3>,
        probe: &mut P,
    ) {
        for k in 0..bodies.len() as u32 {
            self.c.push(cells.index(bodies.position(k)[2], 2, probe), k, &mut self.links, Z, probe);
        }
    }

    /// The z-lists, which are of kind 0.
    pub(crate) fn lists(&mut self) -> (&mut Heads, &mut Links<3>) {
        (&mut self.c, &mut self.links)
    }

    /// Checks the central layer, which begins with `first`, against itself and the layer below.
    pub(crate) fn layer<T: Real, P: Probe, S: Sink>(
        &mut self,
        bodies: &impl Bodies<T, 3>,
        cells: &Cells<3>,
        first: u32,
        layer: u32,
        probe: &mut P,
        sink: &mut S,
    ) {
        let row_of = |k: u32, probe: &mut P| cells.index(bodies.position(k)[1], 1, probe);
        let below = self.c.first(layer - 1, probe);
        for (set, first) in [first, below].into_iter().enumerate() {
            each(&mut self.links, Z, first, probe, |k, links, probe| {
                self.b[set].push(row_of(k, probe), k, links, Y, probe)
            });
        }
        let mut k = first;
        while k != EMPTY {
            let mut row = row_of(k, probe);
            while let Some(first) = self.b[0].take_new(row, probe) {
                self.row(bodies, cells, first, row, probe, sink);
                row += 1;
            }
            k = self.links.next(k, Z, probe);
        }
        for (set, first) in [first, below].into_iter().enumerate() {
            each(&mut self.links, Z, first, probe, |k, _, probe| {
                self.b[set].reset(row_of(k, probe), probe)
            });
        }
    }

    /// Checks the central row, which begins with `first`, against itself and its four neighbouring
    /// rows.
    fn row<T: Real, P: Probe, S: Sink>(
        &mut self,
        bodies: &impl Bodies<T, 3>,
        cells: &Cells<3>,
        first: u32,
        row: u32,
        probe: &mut P,
        sink: &mut S,
    ) {
        let column_of = |k: u32, probe: &mut P| cells.index(bodies.position(k)[0], 0, probe);
        let neighbours = [
            self.b[0].first(row - 1, probe),
            self.b[1].first(row - 1, probe),
            self.b[1].first(row, probe),
            self.b[1].first(row + 1, probe),
        ];
        each(&mut self.links, Y, first, probe, |k, links, probe| {
            self.a[0].push(column_of(k, probe), k, links, X, probe)
        });
        for first in neighbours {
            each(&mut self.links, Y, first, probe, |k, links, probe| {
                self.a[1].push(column_of(k, probe), k, links, X, probe)
            });
        }
        let mut k = first;
        while k != EMPTY {
            let column = column_of(k, probe);
            if let Some(central) = self.a[0].take_new(column, probe) {
                let mask = [
                    self.a[0].first(column - 1, probe),
                    self.a[1].first(column - 1, probe),
                    self.a[1].first(column, probe),
                    self.a[1].first(column + 1, probe),
                ];
                self.links.check(X, bodies, central, mask, probe, sink);
            }
            k = self.links.next(k, Y, probe);
        }
        each(&mut self.links, Y, first, probe, |k, _, probe| {
            self.a[0].reset(column_of(k, probe), probe)
        });
        for first in neighbours {
            each(&mut self.links, Y, first, probe, |k, _, probe| {
                self.a[1].reset(column_of(k, probe), probe)
            });
        }
    }
}

/// Calls `then` with every particle of the list that begins with `first`.
#[inline(always)]
fn each<P: Probe>(
    links: &mut Links<3>,
    kind: usize,
    first: u32,
    probe: &mut P,
    mut then: impl FnMut(u32, &mut Links<3>, &mut P),
) {
    let mut k = first;
    while k != EMPTY {
        then(k, links, probe);
        k = links.next(k, kind, probe);
    }
}

#[cfg(test)]
mod tests {
    use super::super::golden::InCells;
    use super::super::list::as_printed;
    use super::*;
    use crate::probe::Silent;

    /// G6: nine particles in layers 7 8 6 7 5 6 7 6 6 (p122) on the real arrays.
    #[test]
    fn the_books_nine_particles() {
        let places = [7, 8, 6, 7, 5, 6, 7, 6, 6].map(|z| [1, 1, z]);
        let scene = InCells(&places);
        let cells = scene.grid();
        let mut nbs = Nbs3d::with(Options::default());
        nbs.prepare(&cells, places.len()).unwrap();
        nbs.push_layers(&scene, &cells, &mut Silent);
        assert_eq!(as_printed(&nbs.c.raw()[1..=10]), [-1, -1, -1, -1, 5, 9, 7, 2, -1, -1]);
        assert_eq!(as_printed(&nbs.links.raw(Z)), [-1, -1, -1, 1, -1, 3, 4, 6, 8]);
        let mut nbs = Nbs3d::with(Options::default());
        let mut pairs = Vec::new();
        nbs.detect(scene, &mut Silent, &mut pairs).unwrap();
        let heads = [&nbs.c, &nbs.b[0], &nbs.b[1], &nbs.a[0], &nbs.a[1]];
        assert!(heads.iter().all(|heads| heads.raw().iter().all(|&head| head == EMPTY)));
    }
}
