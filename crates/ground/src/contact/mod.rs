//! The contact test: how a scene is stored, and how |xi - xj| <= ri + rj is decided.
//!
//! **One predicate.** Two particles touch when |xi - xj| <= ri + rj. This *closed* rule is that of
//! Munjiza's book ("touch or overlap"). Neighbour lists use an *open* rule: |xi - xj| < cutoff. All
//! radii are then half the cutoff, so that ri + rj is exactly the cutoff. Every detector decides
//! through [`Particles::touch`], which counts its calls. There are two ways to evaluate it:
//!
//! * *rounded*: |xi - xj|² <= (ri + rj)² in the floating-point arithmetic of the scene's own
//!   precision;
//! * *exact*: the sign of |xi - xj|² - (ri + rj)² for the given binary numbers. A filter in f64
//!   decides nearly all pairs, [`exact::compare`] the rest.
//!
//! **The exact test's filter.** Let u = 2^-53. Let d2 and s2 be the computed values of |xi - xj|²
//! and (ri + rj)², and d², s² the true ones. A difference or sum of two doubles has a relative
//! error of at most u (it never underflows); a product has u plus an absolute 2^-1075. So
//! d2 = d²(1 + e) + t with |e| <= (1+u)^5 - 1 < 6u for up to three dimensions and |t| <= 4·2^-1075,
//! and s2 = s²(1 + e') + t' with |e'| < 4u.
//!
//! * If d2 > s2(1 + 16u) + 2^-960 as computed (two more roundings), then d² > s²: apart.
//! * If d2 <= s2(1 - 16u) - 2^-960, then d² < s²: overlap.
//! * If d2 overflows, then d² >= 2^1024(1 - 7u). A threshold s2(1 + 16u) + 2^-960 that does not
//!   overflow means s² < 2^1024(1 - 9u): apart.
//! * An overflowing s2 never decides.
//!
//! Exact arithmetic decides all other pairs. Finite input never yields NaN. All limits above are
//! strict: the filter accepts only d² < s² and refuses only d² > s². So only the exact comparison
//! sees ties, d² = s². There the rule is one bit ([`Test::Open`]), and filters cost the same.
//!
//! [`slack`] derives the largest distance of two accepted particles. [`crate::filter`] derives what
//! cells, boxes and keys must add to that distance.
//!
//! **Images.** In a periodic box the second centre is shifted by integer multiples of the box's
//! vectors. The exact test adds the shift as further terms of the difference and never rounds a
//! shifted centre: [`image`]. Detectors work on rounded positions with a [`Slack`] that covers the
//! rounding: [`Imaged`], made by `contactbench_lists::periodic`.

pub mod depth;
pub mod exact;
pub mod image;
pub mod particles;
pub mod rule;
pub mod slack;
mod stored;

pub use contactbench_terms::arithmetic::{Arithmetic, Margin, Test, UnknownArithmetic};
pub use particles::{
    AnyParticles, Corners, Decided, Imaged, Particles, SceneParticles, WithParticles,
    any_particles, with_particles, with_stored,
};
pub use rule::{
    AnyRule, Asked, Decide, ExactEach, ExactUniform, RoundedEach, RoundedUniform, Rule,
};
pub use slack::Slack;
pub use stored::StoredParticles;

#[cfg(test)]
mod tests;
