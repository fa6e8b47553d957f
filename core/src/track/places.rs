//! Particles side by side in memory as they are side by side in space.
//!
//! Where a particle is, is kept in f32: half of the memory, and a look at a list of near pairs
//! waits for memory most of the time. Lengths are in a unit u, the power of two with
//! u <= diameter < 2u, from an origin amid the particles. With x' for a coordinate as kept, M the
//! largest |x'| and v = 2^-24:
//!
//! * x' is off by at most M(v + 4v²) + 2^-150, since the difference in f64 and its rounding to f32
//!   are; so a distance of two centres as kept is off by at most √D · 2 · M · 1.01v < 2^-22 M, and
//!   2^-148.
//! * The computed square of that distance is off by at most 6v of itself, and 2^-147 where squares
//!   are too small for f32.
//!
//! So what the contact test says of the distance d it says of the root of the computed square, with
//! a [`Slack`] larger by 2^-20 relative and 2^-22 M + 2^-60 absolute, in the unit u. What lies
//! between is left to the test. Where numbers overflow M is infinite, and all is left to it.

use nalgebra::Point;

use crate::contact::{Corners, Slack};
use crate::filter::Near;
use crate::scene::array;

/// A particle in its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<const D: usize> {
    /// Where it is, in the unit and from the origin of [`Unit`].
    at: [f32; D],
    /// Its number in the scene.
    pub particle: u32,
}

impl<const D: usize> Place<D> {
    /// Of a particle that is not known yet.
    pub const NONE: Place<D> = Place { at: [0.0; D], particle: 0 };

    /// The computed square of the distance.
    #[inline(always)]
    pub fn square(&self, other: &Place<D>) -> f64 {
        let square = (0..D).fold(0.0, |sum, k| {
            let d = self.at[k] - other.at[k];
            sum + d * d
        });
        f64::from(square)
    }
}

/// In what places are given.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unit<const D: usize> {
    origin: [f64; D],
    /// Of one length, in units.
    scale: f64,
    /// The largest coordinate along each axis, in size.
    most: [f32; D],
}

impl<const D: usize> Default for Unit<D> {
    fn default() -> Unit<D> {
        Unit { origin: [0.0; D], scale: 1.0, most: [0.0; D] }
    }
}

impl<const D: usize> Unit<D> {
    /// For bodies of up to this diameter within this box.
    pub fn new((low, high): Corners<D>, diameter: f64) -> Unit<D> {
        // Within the numbers of f64, whatever the diameter.
        const FEWEST: u64 = 1023 - 1000;
        let exponent = (diameter.to_bits() >> 52).clamp(FEWEST, 2 * 1023 - FEWEST);
        let origin = std::array::from_fn(|k| 0.5 * low[k] + 0.5 * high[k]);
        Unit { origin, scale: f64::from_bits((2 * 1023 - exponent) << 52), most: [0.0; D] }
    }

    /// The same for another frame, in which no particle has its place yet.
    pub fn begun(&self) -> Unit<D> {
        Unit { most: [0.0; D], ..*self }
    }

    /// Puts a particle where it is in this frame.
    #[inline(always)]
    pub fn put(&mut self, place: &mut Place<D>, at: &Point<f64, D>) {
        for (k, &x) in array(at).iter().enumerate() {
            let x = ((x - self.origin[k]) * self.scale) as f32;
            self.most[k] = if x.abs() > self.most[k] { x.abs() } else { self.most[k] };
            place.at[k] = x;
        }
    }

    /// What a test with this slack says of computed squares, for radii with a given sum.
    pub fn near(&self, slack: Slack) -> impl Fn(f64) -> Near {
        const RELATIVE: f64 = 1.0 / (1u64 << 20) as f64;
        const ROUNDING: f64 = 1.0 / (1u64 << 22) as f64;
        const LEAST: f64 = 1.0 / (1u64 << 60) as f64;
        let most = self.most.into_iter().fold(0.0, f32::max);
        let absolute = f64::from(most) * ROUNDING + LEAST;
        let (scale, slack) = (
            self.scale,
            Slack {
                relative: slack.relative + RELATIVE,
                absolute: slack.absolute * self.scale + absolute,
            },
        );
        move |sum| Near::new(sum * scale, slack)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::exact::{Label, label};

    /// Couples of points at all scales, near the origin and far from it, and sums of radii that are
    /// nearly, or exactly, their distance: what copies decide is what is true.
    #[test]
    fn what_places_decide_is_true() {
        let mut state = 7u64;
        let mut draw = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let (mut decided, mut open) = (0, 0);
        for scale in [1.0, 3.7e-5, 1e-150, 1e-300, 5e-324, 2.5e200, 1e307] {
            for far in [0.0, 1.0, 1e3, 1e9] {
                for _ in 0..500 {
                    let a: [f64; 3] = std::array::from_fn(|_| scale * draw());
                    let b: [f64; 3] = std::array::from_fn(|_| scale * draw());
                    let shift = [far * scale, 0.0, -far * scale]
                        .map(|x| if x.is_finite() { x } else { 0.0 });
                    let [a, b] =
                        [a, b].map(|p| Point::from(std::array::from_fn(|k| p[k] + shift[k])));
                    let distance = (0..3).fold(0.0f64, |sum, k| sum.hypot(a[k] - b[k]));
                    let corners = if far == 1e3 {
                        ([-far * scale; 3], [far * scale; 3])
                    } else {
                        let corner =
                            |of: fn(f64, f64) -> f64| std::array::from_fn(|k| of(a[k], b[k]));
                        (corner(f64::min), corner(f64::max))
                    };
                    let near = 1.0
                        + draw() * [1e-16, 1e-8, 1e-7, 1e-6, 0.3][(draw().abs() * 5.0) as usize];
                    let (r, q) = (0.75 * distance * near, 0.25 * distance * near);
                    let mut unit = Unit::new(corners, 2.0 * r);
                    let mut places = [Place::NONE; 2];
                    for (place, at) in places.iter_mut().zip([&a, &b]) {
                        unit.put(place, at);
                    }
                    let near = unit.near(Slack::NONE)(r + q);
                    let touch = label(array(&a), array(&b), r, q) != Label::Apart;
                    match near.verdict(places[0].square(&places[1])) {
                        Some(verdict) => {
                            assert_eq!(verdict, touch, "{a:?} {b:?} {r:e} {q:e}");
                            decided += 1;
                        }
                        None => open += 1,
                    }
                }
            }
        }
        assert!(decided > 2000 && open > 3000, "{decided} {open}");
    }
}
