//! How much rounding changes the contact test. Filters must allow for that.
//!
//! Here u = 2^-53. Positions and radii convert to f64 without error from f32
//! ([`Real::wide`]).
//!
//! **Reach.** The true distance of a pair that the test accepts is at most its *reach* R:
//!
//! * Exact test: R = ri + rj <= 2·rmax. Doubling is exact, or overflows to infinity, which is a
//!   bound, too.
//! * Rounded test in a precision with unit v = [`Real::UNIT`]: differences have a relative error of
//!   at most v, squares and sums v each. Products may underflow by η, half the smallest subnormal.
//!   A pair is accepted only if d²(1-v)^7 - 4η <= s²(1+v)^3 + η, hence d <= s(1 + 5v + O(v²)) +
//!   3√η, which is below s(1 + 5.5v) + 3√η. [`Slack::reach`] returns 2·rmax(1 + 8v) + 4√η; the
//!   difference covers its own rounding. If (2·rmax)² overflowed, the rounded test would accept
//!   everything: such scenes are refused
//!   ([`Refusal::Overflow`](crate::limits::refusal::Refusal::Overflow)).
//!
//! If |xi - xj| > R along any axis, the pair does not touch.
//!
//! **Reach by class.** For a pair with radii of at most a and b the same holds with s <= a + b
//! instead of 2·rmax. Only the sum is new: fl(a + b) may be half an ulp below a + b; the next
//! double is not below. (If a = b, doubling is exact.) So [`Slack::reach`] bounds the true distance
//! of all pairs of two size classes by their largest radii, in every arithmetic. The reach of the
//! scene is that of its largest radius with itself. The textbook's filters take a + b itself,
//! whatever the test accepts.
//!
//! **Acceptance.** A rounded test accepts if d²(1+v)^7 + 4η <= s²(1-v)^3 - η. For this, d <= s(1 -
//! 8v) - 4√η is enough: with a = s(1 - 5.2v) >= d + 3√η, d² <= (a - 3√η)² = a² - 6a√η + 9η <= a² -
//! 9η. The bounds for reach and acceptance together are the test's [`Slack`].
//!
//! **Rounded positions.** If each position is off by at most E, the exact test has a slack of 2E in
//! this sense, with distances between the rounded positions: see `contactbench_lists::periodic`,
//! which also bounds what remains after all roundings.

use crate::scene::Real;

/// Largest deviation of a contact test from the exact one. Particles with sum of radii s are
/// accepted if their true distance is at most s(1 - relative) - absolute, and refused beyond s(1 +
/// relative) + absolute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slack {
    /// Part of the deviation relative to the sum of the radii.
    pub relative: f64,
    /// Part of the deviation that does not depend on the radii, as a length.
    pub absolute: f64,
}

impl Slack {
    /// Slack of the exact test, which has no deviation.
    pub const NONE: Slack = Slack { relative: 0.0, absolute: 0.0 };

    /// Returns the slack of the test rounded in `T`.
    pub fn rounded<T: Real>() -> Slack {
        Slack { relative: 8.0 * T::UNIT, absolute: T::UNDERFLOW }
    }

    /// Returns an upper bound for the true distance of two accepted particles with radii of at most
    /// `a` and `b`.
    #[inline]
    pub fn reach(self, a: f64, b: f64) -> f64 {
        let sum = if a == b { a + b } else { (a + b).next_up() };
        sum * (1.0 + self.relative) + self.absolute
    }
}
