//! One particle against sixteen: which are near enough to ask, and which touch for sure.

use super::unchecked::Source;
use crate::wide::Wide;

/// What a particle is compared with in one range.
pub(super) struct Query<W: Wide, const D: usize> {
    pub at: [W::Floats; D],
    /// With [`Bounds::grow`], where each particle has its own.
    pub radius: W::Floats,
}

/// Squares of distances up to which particles are near enough to ask, and touch for sure.
#[derive(Clone, Copy)]
pub(super) struct Limits<W: Wide> {
    near: W::Floats,
    sure: W::Floats,
}

impl<W: Wide> Limits<W> {
    /// For this sum of radii and [`Bounds::grow`].
    #[inline(always)]
    pub fn new(w: W, outer: W::Floats, grow: f32) -> Limits<W> {
        let inner = w.max(w.sub(outer, w.all(2.0 * grow)), w.all(0.0));
        // Half a step less, so that an inner bound of nothing holds nobody.
        Limits { near: w.mul(outer, outer), sure: w.mul_add(inner, inner, w.all(-0.5)) }
    }
}

/// Masks of those of sixteen particles that are `valid`: those near enough to ask, and those that
/// touch. Where each has its own radius, `limits` are made of the query's and theirs.
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
            // The nearest whole number of turns: 1.5·2^23 leaves no fraction.
            let whole = w.all(12_582_912.0);
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
