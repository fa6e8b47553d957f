//! The contact test: in which number format a scene is stored, and how |xi - xj| <= ri + rj is
//! decided.
//!
//! **One predicate.** Two bodies touch when |xi - xj| <= ri + rj: the test is closed (BOOK: "touch
//! or overlap"). Every detector decides through [`Bodies::touch`], which counts itself. There are
//! two ways to evaluate it:
//!
//! * *rounded*: |xi - xj|² <= (ri + rj)² as floating point gives it, in the scene's own precision;
//! * *exact*: the sign of |xi - xj|² - (ri + rj)² for the given binary numbers, whatever they are.
//!   A filter in f64 decides nearly all pairs, [`exact::compare`] the rest.
//!
//! **The exact test's filter.** Let u = 2^-53, d2 and s2 the computed |xi - xj|² and (ri + rj)²,
//! and d², s² the true ones. A difference or sum of two doubles has relative error at most u (it
//! never underflows), a product u plus an absolute 2^-1075. So d2 = d²(1 + e) + t with |e| <=
//! (1+u)^5 - 1 < 6u for up to three dimensions and |t| <= 4·2^-1075, and s2 = s²(1 + e') + t' with
//! |e'| < 4u. If d2 > s2(1 + 16u) + 2^-960 as computed (two more roundings), then d² > s²: apart.
//! If d2 <= s2(1 - 16u) - 2^-960, then d² < s²: overlap. If d2 overflows, d² >= 2^1024(1 - 7u); a
//! threshold s2(1 + 16u) + 2^-960 that does not overflow means s² < 2^1024(1 - 9u): apart, too. An
//! overflowing s2 never decides. Everything between is left to exact arithmetic. NaN cannot arise
//! from finite input.
//!
//! How far apart two accepted bodies can be at most is derived in [`slack`], what cells, boxes and
//! keys must add to that in [`crate::filter`].
//!
//! **Images.** In a periodic box the second centre is shifted by whole numbers of the box's
//! vectors. The exact test takes the shift as further terms of the difference, not a rounded
//! centre: [`image`]. What detectors see are rounded places, and a [`Slack`] that says so:
//! [`Imaged`], made by [`crate::periodic`].
//!
//! **Steps.** Whether two bodies that move touch between two frames is decided as exactly:
//! [`swept`].

pub mod bodies;
pub mod depth;
pub mod exact;
pub mod image;
pub mod rule;
pub mod slack;
pub mod swept;

pub use bodies::{
    AnyBodies, Bodies, Corners, Decided, Imaged, SceneBodies, WithBodies, any_bodies, with_bodies,
    with_stored,
};
pub use contactbench_terms::arithmetic::{Arithmetic, Margin, Test, UnknownArithmetic};
pub use rule::{
    AnyRule, Asked, Decide, ExactEach, ExactUniform, RoundedEach, RoundedUniform, Rule,
};
pub use slack::Slack;

#[cfg(test)]
mod tests;
