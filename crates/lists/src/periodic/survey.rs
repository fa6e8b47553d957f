//! One pass over a scene: its extreme fractions, and the particles that may have images.

use nalgebra::Point;

use super::frame::ReducedBox;
use contactbench_ground::contact::Corners;
use contactbench_ground::scene::array;
use contactbench_ground::wide::{Kernel, Level, Wide, fill};

/// A factor of 1 + 2^-40, which covers the roundings of a margin.
pub(super) const GROW: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;

#[derive(Clone, Copy, Debug)]
pub struct Survey<const D: usize> {
    pub corners: Corners<D>,
    /// Least fractions of all particles; `high` holds the largest ones.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    pub candidates: usize,
}

/// Fractions may differ by 1 plus this before particles are moved into the box. Particles that
/// leave a box between two rebuilds of a simulation must not cause a copy.
const WIDER: f64 = 1.0 / 64.0;
/// Particles are moved into the box if one is more than this many boxes away, because its fractions
/// would have few digits left.
const FAR: f64 = (1u64 << 20) as f64;

impl<const D: usize> Survey<D> {
    pub fn most(&self) -> [f64; D] {
        fill(|k| self.corners.0[k].abs().max(self.corners.1[k].abs()))
    }

    /// Returns whether all particles fit in one box, at any corner that is not too far away.
    pub fn fit(&self, frame: &ReducedBox<D>) -> bool {
        (0..3).filter(|&a| frame.periodic[a]).all(|a| {
            let away = [self.low[a], self.high[a]].map(|f| (f - frame.corner(a)).abs());
            self.high[a] - self.low[a] <= 1.0 + WIDER && away.iter().all(|&away| away < FAR)
        })
    }
}

/// A particle that may have images, and its position. The position is stored because in a scene in
/// random order it would no longer be in cache.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<const D: usize> {
    pub place: [f64; D],
    pub owner: u32,
}

/// Makes one pass over a non-empty scene. It lists particles with a fraction of at most `below`,
/// and perhaps some more, until the list is full.
pub fn survey<const D: usize>(
    centres: &[Point<f64, D>],
    frame: &ReducedBox<D>,
    below: [f64; 3],
    list: &mut Vec<Candidate<D>>,
) -> Survey<D> {
    if frame.is_along_axes() {
        // The limit is widened because the quotient is rounded; along an open axis no particle is
        // listed. Underflow loses less than 2^-40, which a valid bound has to spare (`Near::new`).
        let below: [f64; D] = fill(|k| {
            let below = below[k] / frame.scale(k);
            if frame.periodic[k] { below + (GROW - 1.0) * below.abs() } else { f64::NEG_INFINITY }
        });
        let (corners, candidates) =
            Level::best().run(GoOver { centres, numbers: |x: &[f64; D]| *x, below, list });
        // Rounding is monotone, so the particle with the least coordinate has the least fraction.
        let fractions = |x: [f64; D]| fill(|a| if a < D { x[a] * frame.scale(a) } else { 0.0 });
        let (low, high) = (fractions(corners.0), fractions(corners.1));
        return Survey { corners, low, high, candidates };
    }
    let both = |x: &[f64; D]| -> [f64; 6] {
        fill(|k| if k < 3 { frame.fraction(k, x) } else { x[(k - 3).min(D - 1)] })
    };
    let below = [0, 1, 2, 3, 4, 5].map(|k| below.get(k).copied().unwrap_or(f64::NEG_INFINITY));
    let ((low, high), candidates) =
        Level::best().run(GoOver { centres, numbers: both, below, list });
    let corner = |of: [f64; 6]| fill(|k| of[3 + k]);
    let part = |of: [f64; 6]| fill(|a| of[a]);
    let corners = (corner(low), corner(high));
    Survey { corners, low: part(low), high: part(high), candidates }
}

/// Finds the least and the largest of each of C numbers per particle. Counts the particles with a
/// number of at most `below`, and lists these particles until the list is full.
struct GoOver<'a, N, const D: usize, const C: usize> {
    centres: &'a [Point<f64, D>],
    numbers: N,
    below: [f64; C],
    list: &'a mut Vec<Candidate<D>>,
}

impl<N, const D: usize, const C: usize> Kernel for GoOver<'_, N, D, C>
where
    N: Fn(&[f64; D]) -> [f64; C],
{
    type Output = (([f64; C], [f64; C]), usize);

    #[inline(always)]
    fn run<W: Wide>(self, _: W) -> Self::Output {
        let GoOver { centres, numbers, below, list } = self;
        let is_near = |numbers: &[f64; C]| {
            numbers.iter().zip(&below).fold(false, |near, (number, below)| near | (number <= below))
        };
        // Four sets of extremes are updated in turn, so that no comparison waits for the one
        // before.
        const TURNS: usize = 4;
        let (mut low, mut high) = ([[f64::INFINITY; C]; TURNS], [[f64::NEG_INFINITY; C]; TURNS]);
        let mut widen = |numbers: &[f64; C], turn: usize| {
            for (k, &x) in numbers.iter().enumerate() {
                low[turn][k] = if x < low[turn][k] { x } else { low[turn][k] };
                high[turn][k] = if x > high[turn][k] { x } else { high[turn][k] };
            }
        };
        let mut count = 0;
        list.clear();
        let mut look = |x: &[f64; D], numbers: &[f64; C], index: usize| {
            if is_near(numbers) {
                count += 1;
                if list.len() < list.capacity() {
                    list.push(Candidate { place: *x, owner: index as u32 });
                }
            }
        };
        let (groups, rest) = centres.as_chunks::<TURNS>();
        for (group, some) in groups.iter().enumerate() {
            let all = some.each_ref().map(|x| numbers(array(x)));
            all.iter().zip(0..).for_each(|(numbers, turn)| widen(numbers, turn));
            // Most groups have no particle that must be listed.
            if all.iter().fold(false, |any, numbers| any | is_near(numbers)) {
                (0..TURNS).for_each(|k| look(array(&some[k]), &all[k], group * TURNS + k));
            }
        }
        for (x, index) in rest.iter().map(array).zip(groups.len() * TURNS..) {
            let numbers = numbers(x);
            widen(&numbers, 0);
            look(x, &numbers, index);
        }
        for turn in 1..TURNS {
            for k in 0..C {
                low[0][k] = low[0][k].min(low[turn][k]);
                high[0][k] = high[0][k].max(high[turn][k]);
            }
        }
        ((low[0], high[0]), count)
    }
}
