//! `sweep`: sort and sweep along one axis (Baraff 1992, "Dynamic Simulation of Non-Penetrating
//! Rigid Particles", section 3.4; Ericson 2005, section 7.5).
//!
//! 1. Every particle has an interval on each axis. Copies are sorted by the lower end on the axis
//!    along which the scene is longest.
//! 2. Each particle is compared with those after it whose intervals begin before its own ends. If
//!    they overlap along a second axis, too, the pair is tested.
//!
//! * Cost: N log N key comparisons for N particles, and one comparison on the second axis for every
//!   pair that overlaps on the first: N^(2 - 1/D) in a box of equal particles, too many in 3D for
//!   large N. The sweep has no cells: far-away particles cost nothing, a giant only its own
//!   comparisons.
//! * Memory: `32N` bytes in 2D, `40N` in 3D.
//! * Refuses scenes over the memory limit.
//! * Deviations from the sources: the sort is the standard library's (pattern-defeating), which
//!   does less on nearly sorted input, and nothing is kept between detections. The axis has the
//!   longest extent, not the largest variance. Intervals along the second axis are stored in f32
//!   relative to the lower end of the scene: rounding is monotone, so overlapping intervals still
//!   overlap ([`contactbench_ground::filter`], section 2).

use contactbench_ground::contact::Particles;
use contactbench_ground::detect::bounds::Bounds;
use contactbench_ground::detect::copies::{Each, Judge, Nearness, One, PairBuffer, Record, room};
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::filter;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;

/// The `sweep` detector, in `D` dimensions.
pub struct Sweep<const D: usize> {
    options: Options,
    /// Copies of the particles, sorted by the lower end of their intervals on the first axis.
    pub(crate) records: Vec<Record<D>>,
    /// Lower ends of the records' intervals on the second axis.
    lows: Vec<f32>,
    /// Upper ends of the records' intervals on the second axis.
    highs: Vec<f32>,
}

impl<const D: usize> Declare for Sweep<D> {
    const DECIDES_FROM_COPIES: bool = true;

    fn with(options: Options) -> Sweep<D> {
        Sweep { options, records: Vec::new(), lows: Vec::new(), highs: Vec::new() }
    }

    fn formula_bytes(&self) -> u64 {
        bytes::<D>(self.records.len())
    }
}

fn bytes<const D: usize>(n: usize) -> u64 {
    (Record::<D>::BYTES + 8) * n as u64
}

impl<T: Real, const D: usize> Detector<T, D> for Sweep<D> {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        self.take(&particles, "sweep")?;
        let bounds = Bounds::around(&self.records);
        let (slack, touch) =
            (particles.slack(), |i, j, probe: &mut P| particles.touch(i, j, probe));
        match particles.uniform() {
            Some(r) => self.run(Judge::new(&touch, One::new(r, slack)), bounds, probe, sink),
            None => self.run(Judge::new(&touch, Each::new(slack)), bounds, probe, sink),
        }
        Ok(())
    }
}

/// Returns the interval of a particle on an axis.
#[inline(always)]
pub(crate) fn interval<const D: usize>(
    record: &Record<D>,
    axis: usize,
    nearness: impl Nearness,
) -> [f64; 2] {
    filter::interval(record.position[axis], nearness.half(record.radius))
}

/// Number of intervals on the second axis that are compared together.
const STRIDE: usize = 16;

impl<const D: usize> Sweep<D> {
    fn run<P: Probe>(
        &mut self,
        judge: Judge<'_, P, impl Nearness>,
        bounds: Bounds<D>,
        probe: &mut P,
        sink: &mut impl Sink,
    ) {
        let axes = bounds.longest();
        self.sort(axes[0], judge.nearness, probe);
        self.search(judge, axes, bounds, probe, sink);
    }

    /// Copies the particles in stored order; `name` is the detector's name in refusals.
    pub(crate) fn take<T: Real>(
        &mut self,
        particles: &impl Particles<T, D>,
        name: &'static str,
    ) -> Result<(), Refusal> {
        let n = particles.len();
        within(&self.options, name, bytes::<D>(n), || format!("{n} particles"))?;
        room(&mut self.records, n, Record::NONE);
        for (id, record) in (0..).zip(&mut self.records) {
            *record = Record::new(particles, id);
        }
        Ok(())
    }

    pub(crate) fn sort<P: Probe>(&mut self, axis: usize, nearness: impl Nearness, probe: &mut P) {
        self.records.sort_unstable_by(|a, b| {
            probe.count(Op::KeyCompare);
            interval(a, axis, nearness)[0].total_cmp(&interval(b, axis, nearness)[0])
        });
    }

    /// Finds the pairs of copies, which must be sorted along the first of the two axes.
    pub(crate) fn search<P: Probe>(
        &mut self,
        judge: Judge<'_, P, impl Nearness>,
        [first, second]: [usize; 2],
        bounds: Bounds<D>,
        probe: &mut P,
        sink: &mut impl Sink,
    ) {
        let interval = |record: &Record<D>, axis: usize| interval(record, axis, judge.nearness);
        let n = self.records.len();
        room(&mut self.lows, n, 0.0);
        room(&mut self.highs, n, 0.0);
        let ends = self.lows.iter_mut().zip(&mut self.highs);
        for (record, (low, high)) in self.records.iter().zip(ends) {
            [*low, *high] = interval(record, second).map(|end| (end - bounds.low[second]) as f32);
        }
        let mut found = PairBuffer::none();
        for (i, a) in self.records.iter().enumerate() {
            let end = interval(a, first)[1];
            let after = &self.records[i + 1..];
            let within = after.partition_point(|b| {
                probe.count(Op::KeyCompare);
                interval(b, first)[0] <= end
            });
            let (low, high) = (self.lows[i], self.highs[i]);
            let (lows, highs) = (&self.lows[i + 1..][..within], &self.highs[i + 1..][..within]);
            probe.add(Op::BoundTest, within as u64);
            let overlaps = |l: f32, h: f32| (l <= high) & (h >= low);
            let mut test = |place: usize| {
                judge.against(a, std::slice::from_ref(&after[place]), &mut found, probe, sink)
            };
            let ((lows, last_lows), (highs, last_highs)) =
                (lows.as_chunks::<STRIDE>(), highs.as_chunks::<STRIDE>());
            for (k, (lows, highs)) in lows.iter().zip(highs).enumerate() {
                // Most groups have no overlap, and a few instructions are enough to detect that.
                if (0..STRIDE).fold(false, |any, j| any | overlaps(lows[j], highs[j])) {
                    (0..STRIDE)
                        .filter(|&j| overlaps(lows[j], highs[j]))
                        .for_each(|j| test(k * STRIDE + j));
                }
            }
            for (j, (l, h)) in last_lows.iter().zip(last_highs).enumerate() {
                if overlaps(*l, *h) {
                    test(lows.len() * STRIDE + j);
                }
            }
        }
        found.flush(sink);
    }
}
