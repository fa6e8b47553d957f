//! How far rounding moves the contact test: what filters must allow for.
//!
//! u = 2^-53; positions and radii are doubles without error, for every storage ([`Real::wide`]).
//!
//! **Reach.** The true distance of a pair that the test accepts is at most its *reach* R:
//!
//! * exact test: R = ri + rj <= 2·rmax, and doubling is exact, or overflows to infinity, which is a
//!   bound, too;
//! * rounded test in a precision with unit v = [`Real::UNIT`]: differences have relative error at
//!   most v (2v by cells: the difference of cell numbers is rounded, too), squares and sums v each,
//!   products may underflow by η = half the smallest subnormal. Acceptance means d²(1-v)^7 - 4η <=
//!   s²(1+v)^3 + η, hence d <= s(1 + 5v + O(v²)) + 3√η, below s(1 + 5.5v) + 3√η. [`Slack::reach`]
//!   takes 2·rmax(1 + 8v) + 4√η: the difference covers its own rounding. Where (2·rmax)² overflows,
//!   the rounded test would accept everything: such scenes are refused
//!   ([`Refusal::Overflow`](crate::Refusal::Overflow)).
//!
//! If |xi - xj| > R along any one axis, the pair does not touch.
//!
//! **Reach by class.** For a pair whose radii are at most a and b the same holds with s <= a + b in
//! place of 2·rmax. Only the sum is new: fl(a + b) may be below a + b, by half of its last bit, and
//! the next double is not. (a = b needs none: doubling is exact.) So [`Slack::reach`] bounds the
//! true distance of all pairs of two classes by their largest radii, in every arithmetic; the reach
//! of the scene is that of its largest radius with itself. The textbook's filters take a + b
//! itself, whatever the test accepts.
//!
//! The other way round, a rounded test accepts if d²(1+v)^7 + 4η <= s²(1-v)^3 - η, for which d <=
//! s(1 - 8v) - 4√η is enough: with a = s(1 - 5.2v) >= d + 3√η it is d² <= (a - 3√η)² = a² - 6a√η +
//! 9η <= a² - 9η. Both bounds together are the test's [`Slack`].
//!
//! **Rounded places.** The exact test of positions that are themselves off, each by at most E, has
//! a slack of 2E in the same sense, where distances are those of the positions:
//! [`crate::periodic`]. What is left of it after all roundings is said there, too.

use crate::scene::Real;

/// How far a contact test may be from the exact one: particles whose radii have the sum s are
/// accepted if their true distance is at most s(1 - relative) - absolute, and refused if it is more
/// than s(1 + relative) + absolute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slack {
    /// Relative to the sum of the radii.
    pub relative: f64,
    /// In units of length.
    pub absolute: f64,
}

impl Slack {
    /// That of the exact test.
    pub const NONE: Slack = Slack { relative: 0.0, absolute: 0.0 };

    /// That of a test rounded in `T`.
    pub fn rounded<T: Real>() -> Slack {
        Slack { relative: 8.0 * T::UNIT, absolute: T::UNDERFLOW }
    }

    /// An upper bound for the true distance of two particles that are accepted and whose radii are
    /// at most `a` and `b`.
    #[inline]
    pub fn reach(self, a: f64, b: f64) -> f64 {
        let sum = if a == b { a + b } else { (a + b).next_up() };
        sum * (1.0 + self.relative) + self.absolute
    }
}
