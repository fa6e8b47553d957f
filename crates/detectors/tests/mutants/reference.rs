//! A small correct detector that can be made wrong in one way at a time: a grid with half the mask
//! or, for other mistakes, a spatial hash or a sweep.

use std::cmp::Ordering;
use std::collections::{BTreeMap, HashSet};

use contactbench_detectors::book::mask;
use contactbench_ground::contact::{Margin, Particles, exact};
use contactbench_ground::detect::Detector;
use contactbench_ground::filter::{Cells, beyond};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::Probe;
use contactbench_ground::scene::Real;
use contactbench_terms::mix::splitmix64;

use super::ways::Way;

type Cell<const D: usize> = [i64; D];

/// The reference detector. Fields other than `way` and `radii` hold results of earlier calls, which
/// only mutants read.
pub struct Reference<const D: usize> {
    way: Way,
    /// Radii of the scene, for wrong contact tests.
    pub radii: Vec<f64>,
    lists: BTreeMap<Cell<D>, Vec<u32>>,
    numbers: Vec<Cell<D>>,
    grid: Option<Grid<D>>,
    found: Vec<[u32; 2]>,
}

/// Origin and edge of cells; `cells` is set if the library computes cell numbers.
#[derive(Clone, Copy, PartialEq)]
struct Grid<const D: usize> {
    low: [f64; D],
    reach: f64,
    cells: Option<Cells<D>>,
}

impl<T: Real, const D: usize> Detector<T, D> for Reference<D> {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let pairs = match self.way.algorithm() {
            Way::Sweep => self.sweep(&particles, probe),
            Way::Hash => self.hash(&particles, probe)?,
            _ => self.cells(&particles, probe)?,
        };
        pairs.into_iter().for_each(|[i, j]| sink.contact(i, j));
        Ok(())
    }
}

impl<const D: usize> Reference<D> {
    pub fn new(way: Way) -> Reference<D> {
        let (radii, lists, numbers, found) = Default::default();
        Reference { way, radii, lists, numbers, grid: None, found }
    }

    /// Lists particles by cell; tests each cell against itself and the mask.
    fn cells<T: Real, P: Probe>(
        &mut self,
        particles: &impl Particles<T, D>,
        probe: &mut P,
    ) -> Result<Vec<[u32; 2]>, Refusal> {
        let same_n = self.numbers.len() == particles.len();
        let grid = self.make_grid(particles)?;
        if self.way == Way::StalePairs && same_n && self.grid == Some(grid) {
            return Ok(self.found.clone());
        }
        self.number(particles, grid, same_n, probe);
        if self.way != Way::StaleLists {
            self.lists.clear();
        }
        for i in self.particles() {
            let key = self.key(self.numbers[i as usize]);
            let list = self.lists.entry(key).or_default();
            if !matches!(self.way, Way::Capacity(most) if list.len() >= most) {
                list.push(if self.way == Way::ByteElements { i & 0xff } else { i });
            }
        }
        let mask = self.mask();
        let mut pairs = Pairs { way: self.way, found: vec![], of: vec![0; particles.len()] };
        let mut done = HashSet::new();
        for list in self.lists.values() {
            let list = self.counted(list);
            let central = self.numbers.get(list[0] as usize).copied().unwrap_or([0; D]);
            if self.unvisited(central, &mut done) {
                continue;
            }
            for (a, &i) in list.iter().enumerate() {
                let from = match self.way {
                    Way::BothOrders => 0,
                    way => a + usize::from(way != Way::SelfPairs),
                };
                for &j in list[from..].iter().filter(|&&j| i != j || self.way == Way::SelfPairs) {
                    self.test(particles, i, j, &mut pairs, probe);
                }
            }
            for &offset in &mask {
                let Some(others) = self.neighbour(central, offset) else { continue };
                let across =
                    list.iter().flat_map(|&i| self.counted(others).iter().map(move |&j| [i, j]));
                for [i, j] in across.filter(|[i, j]| self.way != Way::OrderedAcross || i < j) {
                    self.test(particles, i, j, &mut pairs, probe);
                }
            }
        }
        let last = pairs.found.last().copied();
        match self.way {
            Way::DropsLastPair => drop(pairs.found.pop()),
            Way::RepeatsLastPair => pairs.found.extend(last),
            _ => {}
        }
        self.found.clone_from(&pairs.found);
        Ok(pairs.found)
    }

    fn make_grid<T: Real>(&self, particles: &impl Particles<T, D>) -> Result<Grid<D>, Refusal> {
        let (n, radii) = (self.radii.len(), &self.radii);
        let positions = || (0..particles.len() as u32).map(|i| particles.position(i));
        let corner = |of: fn(f64, f64) -> f64, begin: f64| {
            positions().fold([begin; D], |most, p| std::array::from_fn(|k| of(most[k], p[k])))
        };
        let (low, high) = (corner(f64::min, f64::INFINITY), corner(f64::max, f64::NEG_INFINITY));
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let reach = match self.way {
            Way::EdgeOfFirst if n > 0 => 2.0 * radii[0],
            Way::EdgeOfLast if n > 0 => 2.0 * radii[n - 1],
            Way::EdgeOfMean if n > 0 => 2.0 * radii.iter().sum::<f64>() / n as f64,
            Way::EdgeHalved => largest,
            Way::EdgeWithoutSlack => 2.0 * largest,
            Way::StaleReach => self.grid.map_or(particles.reach(), |grid| grid.reach),
            _ => particles.reach(),
        };
        let margin = if self.way == Way::NoMargin { Margin::Textbook } else { Margin::Safe };
        // Without a changed reach or margin, the library chooses the cells.
        let cells = match () {
            () if n == 0 || reach == particles.reach() && margin == Margin::Safe => {
                Cells::new(particles)
            }
            () => Cells::spanning(low, high, reach, margin),
        };
        match cells {
            Ok(cells) => Ok(Grid { low, reach, cells: Some(cells) }),
            Err(_) if self.way == Way::NeverRefuses => Ok(Grid { low, reach, cells: None }),
            Err(refusal) => Err(refusal),
        }
    }

    fn number<T: Real, P: Probe>(
        &mut self,
        particles: &impl Particles<T, D>,
        grid: Grid<D>,
        same_n: bool,
        probe: &mut P,
    ) {
        let grid = self.grid.filter(|_| self.way == Way::StaleGrid && same_n).unwrap_or(grid);
        if !(self.way == Way::StaleNumbers && same_n) {
            self.numbers = (0..particles.len() as u32)
                .map(|i| self.cell(particles.position(i), grid, probe))
                .collect();
        }
        self.grid = Some(grid);
    }

    fn cell<P: Probe>(&self, p: [f64; D], grid: Grid<D>, probe: &mut P) -> Cell<D> {
        let scale = (1.0 - 1.0 / (1u64 << 18) as f64) / grid.reach;
        std::array::from_fn(|k| {
            let (x, from_low) = (p[k], p[k] - grid.low[k]);
            match self.way {
                Way::Unsigned => i64::from((x * scale) as i64 as u32),
                Way::SinglePrecisionCells => (from_low as f32 * scale as f32) as i64,
                Way::SinglePrecisionFromZero => (x as f32 * scale as f32).floor() as i64,
                Way::ZerosDiffer => (x * scale).floor().to_bits() as i64,
                // If the grid does not fit the scene, numbers have any size and sign.
                Way::StaleGrid | Way::NeverRefuses => (from_low * scale).floor() as i64,
                way => {
                    let number = i64::from(grid.cells.map_or(0, |cells| cells.index(x, k, probe)));
                    match way {
                        Way::Bits(bits) => number % (1 << bits),
                        Way::Clamped(most) => number.min(most),
                        _ => number,
                    }
                }
            }
        })
    }

    fn particles(&self) -> Vec<u32> {
        let n = self.numbers.len() as u32;
        let from = u32::from(self.way == Way::DropsFirstElement);
        let to = if self.way == Way::DropsLastElement { n.saturating_sub(1) } else { n };
        let kept = |i: &u32| self.way != Way::DropsPoints || self.radii[*i as usize] > 0.0;
        (from..to).filter(kept).collect()
    }

    /// Returns the key of a cell's list.
    fn key(&self, cell: Cell<D>) -> Cell<D> {
        match self.way {
            Way::Torus(bits) => cell.map(|c| c.rem_euclid(1 << bits)),
            _ => cell,
        }
    }

    /// Returns the part of a list that the mutant tests.
    fn counted<'a>(&self, list: &'a [u32]) -> &'a [u32] {
        if self.way == Way::ByteCount { &list[..(list.len() % 256).max(1)] } else { list }
    }

    fn unvisited(&self, central: Cell<D>, done: &mut HashSet<Cell<D>>) -> bool {
        match self.way {
            Way::LastUnvisited(axis) => {
                let axis = axis * (D - 1);
                self.numbers.iter().all(|cell| cell[axis] <= central[axis])
            }
            Way::DoneByBits(bits) => !done.insert(central.map(|c| c % (1 << bits))),
            _ => false,
        }
    }

    fn mask(&self) -> Vec<[i32; D]> {
        let mut mask: Vec<[i32; D]> = match D {
            2 => mask::PLANE.iter().map(|o| std::array::from_fn(|k| o[k])).collect(),
            _ => mask::SPACE.iter().map(|o| std::array::from_fn(|k| o[k])).collect(),
        };
        match self.way {
            Way::FullMask => mask.extend(mask.clone().iter().map(|o| o.map(|d| -d))),
            Way::MaskWithout([dim, k]) if dim == D => drop(mask.remove(k)),
            Way::MaskRepeats([dim, k]) if dim == D => {
                mask[k] = mask[(k + 1) % mask.len()].map(|d| -d)
            }
            Way::Mirrored([dim, k]) if dim == D => mask[k] = mask[k].map(|d| -d),
            _ => {}
        }
        mask
    }

    fn neighbour(&self, central: Cell<D>, offset: [i32; D]) -> Option<&Vec<u32>> {
        let cell: Cell<D> = std::array::from_fn(|k| match self.way {
            Way::ZerosDiffer => {
                (f64::from_bits(central[k] as u64) + f64::from(offset[k])).to_bits() as i64
            }
            _ => central[k].wrapping_add(i64::from(offset[k])),
        });
        // Cells are numbered from 1.
        let unseen = matches!(self.way, Way::FirstUnseen(axis) if cell[axis * (D - 1)] <= 1);
        self.lists.get(&self.key(cell)).filter(|_| !unseen)
    }

    fn test<T: Real, P: Probe>(
        &self,
        particles: &impl Particles<T, D>,
        i: u32,
        j: u32,
        pairs: &mut Pairs,
        probe: &mut P,
    ) {
        // Stale lists have numbers of earlier particles.
        let n = particles.len() as u32;
        if i < n && j < n && !pairs.full(i, j) && self.touch(particles, i, j, probe) {
            pairs.push(i, j);
        }
    }

    fn touch<T: Real, P: Probe>(
        &self,
        particles: &impl Particles<T, D>,
        i: u32,
        j: u32,
        probe: &mut P,
    ) -> bool {
        let (p, q) = (particles.position(i), particles.position(j));
        let (ri, rj) = (self.radii[i as usize], self.radii[j as usize]);
        let square = |p: &[f64; D], q: &[f64; D]| -> f64 {
            (0..D).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum()
        };
        let dot = |p: &[f64; D], q: &[f64; D]| -> f64 { (0..D).map(|k| p[k] * q[k]).sum() };
        let s = ri + rj;
        match self.way {
            Way::Untested => true,
            Way::Strict => {
                particles.touch(i, j, probe) && exact::compare(&p, &q, ri, rj) != Ordering::Equal
            }
            Way::RoundedRoot => square(&p, &q).sqrt() <= s,
            Way::ExpandedForm => dot(&p, &p) + dot(&q, &q) - 2.0 * dot(&p, &q) <= s * s,
            Way::SinglePrecisionTest => {
                square(&p.map(|x| f64::from(x as f32)), &q.map(|x| f64::from(x as f32))) <= s * s
            }
            Way::RelativeTolerance => square(&p, &q) <= s * s * (1.0 + 1e-12),
            Way::AbsoluteTolerance => square(&p, &q).sqrt() <= s + 1e-9,
            Way::SumOfSquares => square(&p, &q) <= ri * ri + rj * rj,
            Way::LargestRadius => square(&p, &q) <= particles.reach() * particles.reach(),
            Way::SkipsCoincident => p != q && particles.touch(i, j, probe),
            _ => particles.touch(i, j, probe),
        }
    }

    /// Hashes particles by cell; tests each against the buckets of all neighbouring cells.
    fn hash<T: Real, P: Probe>(
        &mut self,
        particles: &impl Particles<T, D>,
        probe: &mut P,
    ) -> Result<Vec<[u32; 2]>, Refusal> {
        let grid = self.make_grid(particles)?;
        self.number(particles, grid, false, probe);
        let buckets = particles.len().next_power_of_two();
        let bucket = |cell: Cell<D>| {
            cell.iter().fold(0, |h, &c| splitmix64(h ^ c as u64)) as usize % buckets
        };
        let mut table: Vec<Vec<u32>> = vec![Vec::new(); buckets];
        for i in self.particles() {
            let cell = self.numbers[i as usize];
            let list = &mut table[bucket(cell)];
            let free = list.first().is_none_or(|&first| self.numbers[first as usize] == cell);
            if free || self.way != Way::BucketsOfOneCell {
                list.push(i);
            }
        }
        let (half, mut pairs) = (self.mask(), Vec::new());
        let mirrored = half.iter().map(|o| o.map(|d| -d));
        let around: Vec<[i32; D]> = half.iter().copied().chain(mirrored).chain([[0; D]]).collect();
        for i in self.particles() {
            for offset in &around {
                let cell =
                    std::array::from_fn(|k| self.numbers[i as usize][k] + i64::from(offset[k]));
                let uncompared = self.way == Way::BucketsUncompared;
                let in_cell =
                    |&&j: &&u32| i < j && (uncompared || self.numbers[j as usize] == cell);
                for &j in table[bucket(cell)].iter().filter(in_cell) {
                    if particles.touch(i, j, probe) {
                        pairs.push([i, j]);
                    }
                }
            }
        }
        Ok(pairs)
    }

    /// Sorts particles by x; tests each against those that follow within reach.
    fn sweep<T: Real, P: Probe>(
        &mut self,
        particles: &impl Particles<T, D>,
        probe: &mut P,
    ) -> Vec<[u32; 2]> {
        let [x, y] = [0, 1].map(|axis| move |i: u32| particles.position(i)[axis]);
        let reach = particles.reach();
        let mut order: Vec<u32> = (0..particles.len() as u32).collect();
        let single = self.way == Way::SinglePrecisionOrder;
        let key = |i: u32| if single { f64::from(x(i) as f32) } else { x(i) };
        order.sort_by(|&i, &j| key(i).total_cmp(&key(j)));
        let mut pairs = Vec::new();
        for (a, &i) in order.iter().enumerate() {
            for (after, &j) in order[a + 1..].iter().enumerate() {
                let stop = match self.way {
                    Way::BreakOnWrongAxis => beyond(y(i), y(j), reach),
                    Way::BreakAtReach => x(j) - x(i) >= reach,
                    Way::Window(most) => after >= most,
                    Way::SinglePrecisionBreak => x(j) as f32 - x(i) as f32 > reach as f32,
                    _ => beyond(x(i), x(j), reach),
                };
                if stop {
                    break;
                }
                if particles.touch(i, j, probe) {
                    pairs.push([i, j]);
                }
            }
        }
        pairs
    }
}

/// Pairs that were found, and the number of contacts of each particle.
struct Pairs {
    way: Way,
    found: Vec<[u32; 2]>,
    of: Vec<usize>,
}

impl Pairs {
    fn full(&self, i: u32, j: u32) -> bool {
        let most = match self.way {
            Way::OneContactEach => 1,
            Way::ContactsEach(most) => most,
            _ => return false,
        };
        self.of[i as usize] >= most || self.of[j as usize] >= most
    }

    fn push(&mut self, i: u32, j: u32) {
        self.found.push([i, j]);
        self.of[i as usize] += 1;
        self.of[j as usize] += 1;
    }
}
