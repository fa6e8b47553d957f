//! Copies of the particles in a detector's own order, and decisions from these copies.
//!
//! In copies, candidates are adjacent in memory, even if the scene is in random order. [`Record`]
//! is the copy: the centre in f64, the number, and the radius in f32, together 24 bytes in 2D and
//! 32 in 3D. [`Judge`] decides from records what [`Near`] decides, without a branch for each pair,
//! and leaves nearly tangent pairs to [`Particles::touch`].
//!
//! **Radii in f32.** Equal radii are not read from records. Others are stored as r' = r(1 + e) + t,
//! |e| <= 2^-24, |t| <= 2^-150. For the sum s of two radii and the sum s' of the stored ones, s <=
//! s'(1 + 2^-23) + 2^-148 and s >= s'(1 - 2^-23) - 2^-148. The test's own [`Slack`] has relative <=
//! 2^-21, so s(1 + relative) + absolute is at most s'(1 + relative + 2^-22) + absolute + 2^-147,
//! and likewise below: the widened slack of [`Each`]. Radii that overflow are infinite, and then
//! nothing is decided here. Radii below 2^-126 lose digits, so little is decided.

use crate::contact::{Particles, Slack};
use crate::filter::Near;
use crate::pairs::sink::Sink;
use crate::probe::{Op, Probe};
use crate::scene::Real;

/// A copy of one particle.
#[derive(Clone, Copy, Debug)]
pub struct Record<const D: usize> {
    pub position: [f64; D],
    /// Radius, rounded to f32.
    pub radius: f32,
    pub id: u32,
}

impl<const D: usize> Record<D> {
    pub const NONE: Record<D> = Record { position: [0.0; D], radius: 0.0, id: 0 };
    pub const BYTES: u64 = size_of::<Record<D>>() as u64;

    #[inline(always)]
    pub fn new<T: Real>(particles: &impl Particles<T, D>, id: u32) -> Record<D> {
        Record { position: particles.position(id), radius: particles.radius(id) as f32, id }
    }

    #[inline(always)]
    fn square(&self, other: &Record<D>) -> f64 {
        let mut sum = 0.0;
        for k in 0..D {
            let d = self.position[k] - other.position[k];
            sum += d * d;
        }
        sum
    }
}

/// Resizes a buffer to `count` values, which the caller overwrites. If it must grow, old and new
/// buffer do not coexist and nothing is copied.
pub fn room<X: Clone>(buffer: &mut Vec<X>, count: usize, filling: X) {
    if count > buffer.capacity() {
        *buffer = Vec::new();
        crate::limits::refusal::must_reserve(buffer, count);
    }
    buffer.resize(count, filling);
}

/// Limits on the squared distance of two records that decide whether they touch.
pub trait Nearness: Copy + Sync {
    fn near(&self, a: f32, b: f32) -> Near;
    /// Returns a half-reach: two particles that touch are at most the sum of their half-reaches
    /// apart.
    fn half(&self, radius: f32) -> f64;
    /// Returns an upper bound for the distance at which this particle touches one with a radius of
    /// at most `largest`.
    fn reach(&self, radius: f32, largest: f64) -> f64;
}

/// Limits for particles of one radius, computed once.
#[derive(Clone, Copy, Debug)]
pub struct One {
    near: Near,
    half: f64,
}

impl One {
    pub fn new(radius: f64, slack: Slack) -> One {
        One { near: Near::new(2.0 * radius, slack), half: half(radius, slack) }
    }
}

impl Nearness for One {
    #[inline(always)]
    fn near(&self, _: f32, _: f32) -> Near {
        self.near
    }

    #[inline(always)]
    fn half(&self, _: f32) -> f64 {
        self.half
    }

    #[inline(always)]
    fn reach(&self, _: f32, _: f64) -> f64 {
        2.0 * self.half
    }
}

/// Limits for particles with individual radii, computed for each pair.
#[derive(Clone, Copy, Debug)]
pub struct Each(Slack);

impl Each {
    pub fn new(slack: Slack) -> Each {
        const RELATIVE: f64 = 1.0 / (1u64 << 22) as f64;
        const ABSOLUTE: f64 = f64::from_bits((1023 - 147) << 52);
        Each(Slack { relative: slack.relative + RELATIVE, absolute: slack.absolute + ABSOLUTE })
    }
}

impl Nearness for Each {
    #[inline(always)]
    fn near(&self, a: f32, b: f32) -> Near {
        Near::new(f64::from(a) + f64::from(b), self.0)
    }

    #[inline(always)]
    fn half(&self, radius: f32) -> f64 {
        half(f64::from(radius), self.0)
    }

    /// The widened slack also covers sums in which only one radius was rounded to f32.
    #[inline(always)]
    fn reach(&self, radius: f32, largest: f64) -> f64 {
        self.0.reach(f64::from(radius), largest)
    }
}

/// The relative rounding here is at most 3u, which is covered: the reach is below s(1 + 5.5v) +
/// 3√η, the slack is 8v and 4√η, v >= u ([`crate::filter`], section 1). No slack, no rounding.
#[inline(always)]
fn half(radius: f64, slack: Slack) -> f64 {
    radius * (1.0 + slack.relative) + 0.5 * slack.absolute
}

/// The contact test [`Particles::touch`] behind a reference. It is called for nearly tangent pairs
/// only, so that the search among records is compiled only once.
pub type Touch<'a, P> = &'a (dyn Fn(u32, u32, &mut P) -> bool + Sync);

pub struct Judge<'a, P, N> {
    touch: Touch<'a, P>,
    pub nearness: N,
}

/// Buffer of pairs that were found and are not yet passed on.
pub struct PairBuffer {
    pairs: [[u32; 2]; PairBuffer::ROOM],
    count: usize,
}

/// Number of records tested between two checks for free space and for undecided pairs.
pub const STRIDE: usize = 64;

impl PairBuffer {
    const ROOM: usize = 256;

    pub fn none() -> PairBuffer {
        PairBuffer { pairs: [[0; 2]; PairBuffer::ROOM], count: 0 }
    }

    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    pub fn has_room(&self) -> bool {
        self.count <= PairBuffer::ROOM - STRIDE
    }

    /// Replaces the marks from index `start` on by the pairs that `pair` makes of them, in place.
    #[inline(always)]
    pub fn settle(&mut self, start: usize, mut pair: impl FnMut([u32; 2]) -> Option<[u32; 2]>) {
        let marks = start..self.count;
        self.count = start;
        for k in marks {
            if let Some(pair) = pair(self.pairs[k % PairBuffer::ROOM]) {
                self.pairs[self.count % PairBuffer::ROOM] = pair;
                self.count += 1;
            }
        }
    }

    pub fn flush(&mut self, sink: &mut impl Sink) {
        sink.contacts(&self.pairs[..self.count]);
        self.count = 0;
    }
}

impl<'a, P: Probe, N: Nearness> Judge<'a, P, N> {
    pub fn new(touch: Touch<'a, P>, nearness: N) -> Judge<'a, P, N> {
        Judge { touch, nearness }
    }

    #[inline(always)]
    pub fn against<const D: usize>(
        &self,
        a: &Record<D>,
        others: &[Record<D>],
        found: &mut PairBuffer,
        probe: &mut P,
        sink: &mut impl Sink,
    ) {
        for others in others.chunks(STRIDE) {
            if !found.has_room() {
                found.flush(sink);
            }
            self.stride(a, others, |_, b| [a.id, b.id], |_, _| true, found, probe);
        }
    }

    /// Tests `a` against at most [`STRIDE`] others and stores a mark for each contact; there must
    /// be space for all of them. Nearly tangent pairs that are not `wanted` may be skipped.
    #[inline(always)]
    pub fn stride<const D: usize>(
        &self,
        a: &Record<D>,
        others: &[Record<D>],
        mark: impl Fn(usize, &Record<D>) -> [u32; 2],
        wanted: impl Fn(&Record<D>, &mut P) -> bool,
        found: &mut PairBuffer,
        probe: &mut P,
    ) {
        let (mut end, mut unsure) = (found.count, false);
        for (place, b) in others.iter().enumerate() {
            let (near, square) = (self.nearness.near(a.radius, b.radius), a.square(b));
            // Always written; the mark is kept only if the count is incremented.
            found.pairs[end % PairBuffer::ROOM] = mark(place, b);
            end += usize::from(square <= near.outer);
            unsure |= (square > near.inner) & (square <= near.outer);
        }
        if unsure {
            return self.carefully(a, others, mark, wanted, found, probe);
        }
        probe.add(Op::ContactTest, others.len() as u64);
        found.count = end;
    }

    #[inline(never)]
    fn carefully<const D: usize>(
        &self,
        a: &Record<D>,
        others: &[Record<D>],
        mark: impl Fn(usize, &Record<D>) -> [u32; 2],
        wanted: impl Fn(&Record<D>, &mut P) -> bool,
        found: &mut PairBuffer,
        probe: &mut P,
    ) {
        for (place, b) in others.iter().enumerate() {
            let contact = match self.nearness.near(a.radius, b.radius).verdict(a.square(b)) {
                Some(contact) => {
                    probe.count(Op::ContactTest);
                    contact
                }
                None => wanted(b, probe) && (self.touch)(a.id, b.id, probe),
            };
            if contact {
                found.pairs[found.count % PairBuffer::ROOM] = mark(place, b);
                found.count += 1;
            }
        }
    }
}

/// Maximum number of particles for [`all_pairs`].
pub const FEW: usize = 48;

/// Tests all pairs of at most [`FEW`] particles, which takes less time than to make a grid.
pub fn all_pairs<T: Real, P: Probe, const D: usize>(
    particles: &impl Particles<T, D>,
    probe: &mut P,
    sink: &mut impl Sink,
) {
    let mut records = [Record::NONE; FEW];
    let records = &mut records[..particles.len()];
    for (id, record) in (0..).zip(&mut *records) {
        *record = Record::new(particles, id);
    }
    let touch = |i, j, probe: &mut P| particles.touch(i, j, probe);
    match particles.uniform() {
        Some(r) => pairs(records, &Judge::new(&touch, One::new(r, particles.slack())), probe, sink),
        None => pairs(records, &Judge::new(&touch, Each::new(particles.slack())), probe, sink),
    }
}

fn pairs<P: Probe, const D: usize>(
    records: &[Record<D>],
    judge: &Judge<'_, P, impl Nearness>,
    probe: &mut P,
    sink: &mut impl Sink,
) {
    let mut found = PairBuffer::none();
    for (k, a) in records.iter().enumerate() {
        judge.against(a, &records[k + 1..], &mut found, probe, sink);
    }
    found.flush(sink);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Arithmetic, WithParticles, with_stored};
    use crate::filter;
    use crate::limits::refusal::Refusal;
    use crate::probe::Tally;
    use crate::scene::AnyScene;

    /// Compares the decisions from records with the contact test, for all pairs of a scene. Also
    /// checks that the boxes of pairs that touch overlap.
    struct Pairs(u64);
    impl<T: Real, const D: usize> WithParticles<T, D> for &mut Pairs {
        type Output = Result<(), Refusal>;
        fn call<B: Particles<T, D>>(self, particles: B) -> Self::Output {
            let nearness = Each::new(particles.slack());
            let touch = |i, j, probe: &mut Tally| particles.touch(i, j, probe);
            let judge = Judge::new(&touch, nearness);
            let records: Vec<Record<D>> =
                (0..particles.len() as u32).map(|id| Record::new(&particles, id)).collect();
            for (i, a) in records.iter().enumerate() {
                let (mut found, mut probe, mut pairs, mut expected) =
                    (PairBuffer::none(), Tally::default(), Vec::new(), Vec::new());
                judge.against(a, &records[i + 1..], &mut found, &mut probe, &mut pairs);
                found.flush(&mut pairs);
                for b in &records[i + 1..] {
                    if particles.touch(a.id, b.id, &mut probe) {
                        expected.push([a.id, b.id]);
                        let interval = |record: &Record<D>, k: usize| {
                            filter::interval(record.position[k], nearness.half(record.radius))
                        };
                        let meet = |k| {
                            interval(a, k)[0] <= interval(b, k)[1]
                                && interval(b, k)[0] <= interval(a, k)[1]
                        };
                        assert!((0..D).all(meet), "{a:?} {b:?}");
                    }
                }
                assert_eq!(pairs, expected);
                // Each pair counts as two contact tests: one from records, one in the loop above.
                assert_eq!(probe.get(Op::ContactTest), 2 * (records.len() - i - 1) as u64);
                self.0 += pairs.len() as u64;
            }
            Ok(())
        }
    }

    /// Tests particles on a line, each within a few ulps of touching the previous one. Their radii
    /// are not exact in f32, at scales at which f32 overflows or underflows.
    #[test]
    fn records_decide_as_the_test_does() {
        for arithmetic in Arithmetic::ALL {
            let mut pairs = Pairs(0);
            for scale in [1.0, 1e-3, 1e-30, 1e-44, 1e-60, 1e30, 1e50] {
                let radii: Vec<f64> =
                    (0..200).map(|k| scale * (0.1 + f64::from(k % 13) / 7.0)).collect();
                let mut x = 0.0;
                let mut centres = vec![[0.0, 0.0]];
                for k in 1..radii.len() {
                    let distance = (radii[k - 1] + radii[k])
                        * (1.0 + [0.0, 1e-16, -1e-16, 1e-8, -1e-8, 1e-7, -1e-7][k % 7]);
                    x += distance * if k % 3 == 0 { 0.75 } else { 1.0 };
                    centres.push([x, 0.0]);
                }
                let scene = AnyScene::at(centres, radii).unwrap();
                let Ok(scene) = scene.stored(arithmetic) else { continue };
                let AnyScene::Plane(scene) = scene else { panic!("made in the plane") };
                let _ = with_stored(&scene, arithmetic.test(), &mut pairs);
            }
            assert!(pairs.0 > 200, "{arithmetic:?}: {}", pairs.0);
        }
    }
}
