//! Tests of one particle against sixteen: which may touch it, and which certainly do.

use super::unchecked::Source;
use crate::wide::Wide;

/// 1.5·2^23: adding and subtracting it rounds a small number to the nearest integer.
const WHOLE: f32 = 12_582_912.0;
/// Margin in squared steps: with it, an inner limit of zero accepts no pair as certain.
const SPARE: f32 = 0.5;

pub(super) struct Query<W: Wide, const D: usize> {
    pub at: [W::Floats; D],
    /// Radius, if radii differ, plus [`Bounds::grow`](super::kernel::Bounds).
    pub radius: W::Floats,
}

/// Squared distances up to which particles may touch (`near`) and certainly touch (`sure`).
#[derive(Clone, Copy)]
pub(super) struct Limits<W: Wide> {
    near: W::Floats,
    sure: W::Floats,
}

impl<W: Wide> Limits<W> {
    /// Computes the limits from the distance beyond which no pair touches, and from
    /// [`Bounds::grow`](super::kernel::Bounds).
    #[inline(always)]
    pub fn new(w: W, outer: W::Floats, grow: f32) -> Limits<W> {
        let inner = w.max(w.sub(outer, w.all(2.0 * grow)), w.all(0.0));
        Limits { near: w.mul(outer, outer), sure: w.mul_add(inner, inner, w.all(-SPARE)) }
    }
}

/// Returns masks of the `valid` ones of sixteen particles: which may touch, and which certainly do.
/// For individual radii the limits of each pair replace `limits`.
#[inline(always)]
pub(super) fn test<W: Wide, const D: usize, const EACH: bool>(
    w: W,
    source: impl Source<D>,
    valid: u32,
    query: &Query<W, D>,
    limits: Limits<W>,
    grow: f32,
    turn: Option<f32>,
) -> (u32, u32) {
    let mut square = w.all(0.0);
    for k in 0..D {
        let mut d = w.sub(source.load(w, |slab| &slab.lanes[k]), query.at[k]);
        if let (0, Some(turn)) = (k, turn) {
            let whole = w.all(WHOLE);
            let turns = w.sub(w.add(w.mul(d, w.all(1.0 / turn)), whole), whole);
            d = w.sub(d, w.mul(turns, w.all(turn)));
        }
        square = if k == 0 { w.mul(d, d) } else { w.mul_add(d, d, square) };
    }
    let limits = if EACH {
        Limits::new(w, w.add(query.radius, source.load(w, |slab| &slab.radii)), grow)
    } else {
        limits
    };
    let near = w.at_most(square, limits.near) & valid;
    (near, w.at_most(square, limits.sure) & near)
}

/// Computes the limits of one pair like [`Limits::new`].
#[inline(always)]
pub(super) fn limits(outer: f32, grow: f32) -> (f32, f32) {
    let inner = (outer - 2.0 * grow).max(0.0);
    (outer * outer, inner * inner - SPARE)
}

/// Returns the difference along x that is nearest to zero if coordinates wrap around after `turn`,
/// like [`test`].
#[inline(always)]
pub(super) fn nearest(d: f32, turn: f32) -> f32 {
    d - (d * (1.0 / turn) + WHOLE - WHOLE) * turn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wide::{Kernel, Level};

    /// Scalar and vector limits agree up to rounding.
    #[test]
    fn one_and_sixteen_have_the_same_limits() {
        struct Same(f32, f32);
        impl Kernel for Same {
            type Output = ();
            #[inline(always)]
            fn run<W: Wide>(self, w: W) {
                let Same(outer, grow) = self;
                let (near, sure) = limits(outer, grow);
                let all = Limits::new(w, w.all(outer), grow);
                for (one, all) in [(near, all.near), (sure, all.sure)] {
                    let within = |x: f32| w.at_most(w.all(x), all);
                    // A fused multiply-add may round differently.
                    let (below, above) = (one - 1e-6 * one.abs(), one + 1e-6 * one.abs());
                    assert_eq!(
                        [within(below), within(above.next_up())],
                        [0xffff, 0],
                        "{outer} {grow}"
                    );
                }
            }
        }
        for level in Level::all() {
            for outer in [0.25, 3.0, 17.5, 1e6] {
                for grow in [0.0, 0.1, 1.5, 40.0] {
                    level.run(Same(outer, grow));
                }
            }
        }
        assert_eq!(limits(3.0, 1.0), (9.0, 0.5));
        assert_eq!(limits(1.0, 1.0), (1.0, -0.5));
        for (d, expected) in [(3.0, 3.0), (509.0, -3.0), (-1021.0, 3.0), (0.0, 0.0)] {
            assert_eq!(nearest(d, 512.0), expected);
        }
    }
}
