//! The sparse form, for scenes whose particles crowd in a small part of a large domain. Particles
//! are sorted by layer, row and cell; no array over cells exists.
//!
//! Particles are sorted once. Each layer is then swept against itself and the next one as in the
//! dense form, but cursors that advance through the sorted layers find the ranges of each occupied
//! cell. Cursors never move back, so together they pass over a layer a few times. The form uses one
//! thread. Its cost is N for each digit of the sort and N for the rest, whatever the number of
//! cells.

use super::bounds::Bounds;
use super::dense::grow;
use super::grid::{Grid, SPARSE_FRACTION as FRACTION};
use super::kernel::{Scratch, Sweep};
use super::lists::Size;
use super::output::Output;
use super::ranges::{Find, Ranges};
use super::slab::Slab;
use super::{Deliver, NAME, PairSink, Run};
use contactbench_ground::contact::Particles;
use contactbench_ground::detect::within;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::limits::refusal::at_least;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::radix::{DIGIT, part};
use contactbench_ground::scene::Real;
use contactbench_ground::wide::Level;

/// Number of steps after which x wraps around in a slab: 256 cells. All smaller x are exact in f32.
const STEPS: u64 = 1 << 24;
/// The value of `STEPS` for the kernel.
pub(super) const TURN: Option<f32> = Some(STEPS as f32);

#[derive(Clone, Copy)]
struct Place<R> {
    /// Number of the layer in the upper 32 bits, number of the row in the lower 32 bits.
    row: u64,
    x: u64,
    /// Fraction bits of the coordinates across rows and across layers.
    fractions: [u16; 2],
    id: u32,
    radius: R,
}

/// A layer of particles as a slab, and the cell key of each particle.
struct Layer<const D: usize> {
    slab: Slab<D>,
    keys: Vec<u64>,
}

pub(super) struct Sparse<const D: usize, R> {
    places: Vec<Place<R>>,
    layers: [Layer<D>; 2],
    ranges: Vec<Ranges>,
    /// One once it is needed: empty buffers are small, because they are moved.
    scratch: Vec<Scratch>,
}

impl<const D: usize, R> Default for Sparse<D, R> {
    fn default() -> Self {
        let layer = || Layer { slab: Slab::default(), keys: Vec::new() };
        Sparse {
            places: Vec::new(),
            layers: [layer(), layer()],
            ranges: Vec::new(),
            scratch: Vec::new(),
        }
    }
}

/// The ranges of each occupied cell, and the cell of each particle.
#[derive(Clone, Copy)]
struct Listed<'a> {
    cells: &'a [u32],
    ranges: &'a [Ranges],
}

impl Find for Listed<'_> {
    const TURN: Option<f32> = TURN;
    const FLAT: bool = false;

    #[inline(always)]
    fn ranges<const D: usize>(&self, at: usize) -> Ranges {
        let mut ranges = self.ranges[self.cells[at] as usize];
        // The first range begins after the particle and ends with the first range of its cell.
        let own = at as u32 + 1;
        ranges[0] = (own, ranges[0].1 - own);
        ranges
    }
}

impl<P: Probe, const D: usize> Run<'_, P, D> {
    pub fn sparse<S: Sink, R: Size, const EACH: bool>(
        &mut self,
        sparse: &mut Sparse<D, R>,
        fill: &dyn Fn(&mut Sparse<D, R>),
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        const { assert!(R::EACH == EACH) };
        let n = self.n;
        let shape = || format!("{n} particles, by occupied cells");
        let places = Sparse::<D, R>::bytes(n);
        within(self.options, NAME, places, shape)?;
        fill(sparse);
        let most = sparse.sort(&self.grid, probe);
        *self.formula = places + Sparse::<D, R>::bytes_of_layers(most);
        within(self.options, NAME, *self.formula, shape)?;
        let mut deliver = Deliver::new(self.touch, probe, sink);
        sparse.sweep::<EACH>(self.level, self.bounds, most, &mut deliver);
        deliver.finish();
        Ok(())
    }
}

impl<const D: usize, R: Size> Sparse<D, R> {
    pub fn bytes(n: usize) -> u64 {
        (n * size_of::<Place<R>>()) as u64
    }

    pub fn bytes_of_layers(most: usize) -> u64 {
        2 * (Slab::<D>::bytes(most, 0, R::EACH) + 8 * most as u64)
            + (size_of::<Ranges>() * most + size_of::<Scratch>()) as u64
    }

    pub fn fill<T: Real>(&mut self, particles: &impl Particles<T, D>, grid: &Grid<D>) {
        let n = particles.len();
        self.places.clear();
        if n > self.places.capacity() {
            self.places = Vec::new();
            contactbench_ground::limits::refusal::must_reserve(&mut self.places, n);
        }
        let fraction = |q: u64| (q & ((1 << FRACTION) - 1)) as u16;
        self.places.extend((0..n as u32).map(|id| {
            let steps = grid.steps(particles.position(id));
            let (layer, row) = (steps[D - 1], if D == 2 { 0 } else { steps[1] });
            let radius = if R::EACH {
                R::new(grid.length(particles.radius(id)) as f32)
            } else {
                R::default()
            };
            let cells = layer >> FRACTION << 32 | row >> FRACTION;
            Place {
                row: cells,
                x: steps[0],
                fractions: [fraction(row), fraction(layer)],
                id,
                radius,
            }
        }));
    }

    /// Sorts all particles and returns the number of particles in the fullest layer.
    pub fn sort(&mut self, grid: &Grid<D>, probe: &mut impl Probe) -> usize {
        probe.add(Op::Integerise, (D * self.places.len()) as u64);
        let bits = |k: usize| u64::BITS - grid.count[k].leading_zeros();
        let (rows, xs) = (if D == 2 { 0 } else { bits(1) }, bits(0));
        let all = bits(D - 1) + rows + xs;
        // Cell numbers of more than 64 bits are sorted by comparison, not digit by digit.
        let all = if all <= u64::BITS { all } else { 0 };
        let cell = |place: &Place<R>| {
            let (layer, row) = (place.row >> 32, place.row & u64::from(u32::MAX));
            (layer << rows | row) << xs | place.x >> FRACTION
        };
        sort(&mut self.places, all, &cell, probe);
        layers(&self.places).map(<[_]>::len).max().unwrap_or(0)
    }

    pub fn sweep<const EACH: bool>(
        &mut self,
        level: Level,
        bounds: Bounds,
        most: usize,
        sink: &mut dyn PairSink,
    ) {
        let [this, next] = &mut self.layers;
        grow(&mut self.scratch, 1);
        for layer in [&mut *this, &mut *next] {
            layer.slab.prepare(most, 0, EACH);
            at_least(&mut layer.keys, most, 0);
        }
        if most > self.ranges.capacity() {
            self.ranges = Vec::new();
            contactbench_ground::limits::refusal::must_reserve(&mut self.ranges, most);
        }
        let mut layers = layers(&self.places).peekable();
        let mut filled = None;
        while let Some(places) = layers.next() {
            let number = layer_of(&places[0]);
            if filled != Some(number) {
                fill(this, places, sink);
            }
            let beside = layers.peek().filter(|places| layer_of(&places[0]) == number + 1);
            fill(next, beside.copied().unwrap_or_default(), sink);
            filled = Some(number + 1);
            find(this, next, &mut self.ranges, sink);
            let (slab, next_slab) = (&this.slab, &next.slab);
            let find = Listed { cells: &slab.cells, ranges: &self.ranges };
            let Scratch { pairs, work } = &mut self.scratch[0];
            Sweep::<_, D, EACH> {
                slab,
                next: next_slab,
                places: 0..slab.len,
                find,
                bounds,
                work,
                output: Output::new(pairs, &mut *sink),
            }
            .on(level);
            std::mem::swap(this, next);
        }
    }
}

/// A separate function, so that it is not compiled for each `cell` of [`sort`].
fn sort_few<R>(places: &mut [Place<R>], probe: &mut impl Probe) {
    probe.add(Op::Move, places.len() as u64);
    places.sort_unstable_by(|a, b| {
        probe.count(Op::KeyCompare);
        (a.row, a.x).cmp(&(b.row, b.x))
    });
}

/// Sorts places by their cells. Cell numbers differ at most in the lowest `bits` bits; if `bits` is
/// 0, they may differ in any bit.
fn sort<R>(
    places: &mut [Place<R>],
    bits: u32,
    cell: &impl Fn(&Place<R>) -> u64,
    probe: &mut impl Probe,
) {
    const FEW: usize = 64;
    if places.len() <= FEW || bits == 0 {
        return sort_few(places, probe);
    }
    // Each part holds a few particles on average.
    let digit = (places.len() / 4).ilog2().min(bits).min(DIGIT);
    let (shift, last) = (bits - digit, (1 << digit) - 1);
    probe.add(Op::Move, places.len() as u64);
    let ends = part(places, digit, |place| (cell(place) >> shift) as usize & last);
    let mut begin = 0;
    for &end in &ends[..1 << digit] {
        // The order within a cell does not matter.
        if end > begin && shift > 0 {
            sort(&mut places[begin..end], shift, cell, probe);
        }
        begin = end;
    }
}

fn layers<R>(places: &[Place<R>]) -> impl Iterator<Item = &[Place<R>]> {
    places.chunk_by(|a, b| layer_of(a) == layer_of(b))
}

fn layer_of<R>(place: &Place<R>) -> u64 {
    place.row >> 32
}

fn fill<const D: usize, R: Size>(
    layer: &mut Layer<D>,
    places: &[Place<R>],
    sink: &mut dyn PairSink,
) {
    sink.count(Op::Move, places.len() as u64);
    layer.slab.len = places.len();
    let (mut cell, mut last) = (0, None);
    for (at, place) in places.iter().enumerate() {
        // Cells count from 1, so that a key minus 1 does not underflow.
        let key = ((place.row & u64::from(u32::MAX)) + 1) << 32 | ((place.x >> FRACTION) + 1);
        cell += u32::from(last.is_some_and(|last| last != key));
        last = Some(key);
        layer.keys[at] = key;
        let slab = &mut layer.slab;
        slab.lanes[0][at] = (place.x % STEPS) as f32;
        for k in 1..D {
            slab.lanes[k][at] = f32::from(place.fractions[if k == D - 1 { 1 } else { 0 }]);
        }
        if R::EACH {
            slab.radii[at] = place.radius.get();
        }
        slab.ids[at] = place.id;
        slab.cells[at] = cell;
    }
}

fn find<const D: usize>(
    layer: &Layer<D>,
    next: &Layer<D>,
    ranges: &mut Vec<Ranges>,
    sink: &mut dyn PairSink,
) {
    const ROW: u64 = 1 << 32;
    let (own, next) = (&layer.keys[..layer.slab.len], &next.keys[..next.slab.len]);
    let (mut cursors, mut compared) = ([[0usize; 2]; 5], 0);
    let mut to = |keys: &[u64], cursor: &mut usize, key: u64| {
        let from = *cursor;
        while *cursor < keys.len() && keys[*cursor] < key {
            *cursor += 1;
        }
        compared += (*cursor - from) as u64 + 1;
    };
    ranges.clear();
    let mut last = None;
    for &key in own {
        if last == Some(key) {
            continue;
        }
        last = Some(key);
        // The first range ends after the next cell of the row; the others span three cells.
        to(own, &mut cursors[0][1], key + 2);
        let others: &[(&[u64], u64)] = if D == 2 {
            &[(next, key)]
        } else {
            &[(own, key + ROW), (next, key - ROW), (next, key), (next, key + ROW)]
        };
        let mut all = [(0, cursors[0][1] as u32), (0, 0), (0, 0), (0, 0), (0, 0)];
        for (r, &(keys, middle)) in others.iter().enumerate() {
            let [begin, end] = &mut cursors[r + 1];
            to(keys, begin, middle - 1);
            *end = (*end).max(*begin);
            to(keys, end, middle + 2);
            all[r + 1] = (*begin as u32, (*end - *begin) as u32);
        }
        ranges.push(all);
    }
    sink.count(Op::KeyCompare, compared);
}
