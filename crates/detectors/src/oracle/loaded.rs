//! The true contacts of a scene, in its box if it has one, and how a list differs from them.

use super::boxes::{self, Truth};
use super::{NoTruth, depth_of, touching as touching_in_open, truth_as_stored};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::limits::refusal::reserve;
use contactbench_ground::periodic;
use contactbench_ground::periodic::Loaded;
use contactbench_ground::periodic::{ImagePair, without_shift};

/// Finds the true contacts, in ascending order; lists of them may use `limit` bytes.
///
/// # Errors
/// Fails if there is no truth, or no memory.
pub fn truth(scene: &Loaded<'_>, arithmetic: Arithmetic, limit: u64) -> Result<Truth, NoTruth> {
    match scene {
        Loaded::InBox(periodic) => boxes::truth(periodic, arithmetic, limit),
        Loaded::Open(stored) => {
            let found = truth_as_stored(stored, arithmetic.test(), limit)?;
            let mut pairs = Vec::new();
            reserve(&mut pairs, found.pairs.len())?;
            pairs.extend(without_shift(&found.pairs));
            Ok(Truth { pairs, digest: found.digest })
        }
    }
}

/// Finds the true contacts of the chosen particles, in ascending order.
///
/// # Errors
/// Fails if there is no truth, or no memory.
pub fn touching(
    scene: &Loaded<'_>,
    arithmetic: Arithmetic,
    chosen: &[bool],
    limit: u64,
) -> Result<Vec<ImagePair>, NoTruth> {
    match scene {
        Loaded::InBox(periodic) => boxes::touching(periodic, arithmetic, chosen, limit),
        Loaded::Open(stored) => {
            let pairs = touching_in_open(stored, arithmetic.test(), chosen, limit)?;
            Ok(without_shift(&pairs).collect())
        }
    }
}

/// Returns how deep a contact is, in mean radii; negative for a pair that is apart.
pub fn depth(scene: &Loaded<'_>, pair: ImagePair) -> f64 {
    match scene {
        Loaded::Open(scene) => depth_of(scene, [pair.i, pair.j]),
        Loaded::InBox(periodic) => periodic::depth(periodic, pair),
    }
}

/// How a list differs from the truth in one pair.
#[derive(Clone, Copy)]
pub enum Difference {
    /// A contact that is not listed.
    Missed,
    /// A listed pair that does not touch.
    Added,
    /// A listed pair that stands there before.
    Repeated,
}

/// Calls `each` for the pairs in which a sorted list differs from the sorted truth.
pub fn differences<C: Copy + Ord>(listed: &[C], truth: &[C], mut each: impl FnMut(Difference, C)) {
    let mut truth = truth.iter().copied().peekable();
    for same in listed.chunk_by(|a, b| a == b) {
        let pair = same[0];
        while let Some(missed) = truth.next_if(|&it| it < pair) {
            each(Difference::Missed, missed);
        }
        if truth.next_if_eq(&pair).is_none() {
            each(Difference::Added, pair);
        }
        same[1..].iter().for_each(|&pair| each(Difference::Repeated, pair));
    }
    truth.for_each(|pair| each(Difference::Missed, pair));
}
