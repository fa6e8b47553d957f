//! Tests of one particle against sixteen: which may touch it, and which certainly do.

use super::unchecked::Source;
use crate::wide::Wide;

/// 1.5·2^23: adding and subtracting it rounds a small number to the nearest integer.
pub(super) const WHOLE: f32 = 12_582_912.0;
/// Margin in squared steps: with it, an inner limit of zero accepts no pair as certain.
pub(super) const SPARE: f32 = 0.5;

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
        let mut d = w.sub(source.load(w, k), query.at[k]);
        if let (0, Some(turn)) = (k, turn) {
            let whole = w.all(WHOLE);
            let turns = w.sub(w.add(w.mul(d, w.all(1.0 / turn)), whole), whole);
            d = w.sub(d, w.mul(turns, w.all(turn)));
        }
        square = if k == 0 { w.mul(d, d) } else { w.mul_add(d, d, square) };
    }
    let limits =
        if EACH { Limits::new(w, w.add(query.radius, source.load(w, D)), grow) } else { limits };
    let near = w.at_most(square, limits.near) & valid;
    (near, w.at_most(square, limits.sure) & near)
}
