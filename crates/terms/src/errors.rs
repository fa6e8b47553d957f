//! The errors of an answer, and their causes.

use serde::{Deserialize, Serialize};

/// How a set of pairs differs from another that is taken for true.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Touching pairs not reported.
    pub missed: u64,
    /// Reported pairs, of two particles, that do not touch.
    pub spurious: u64,
    /// Pairs reported again.
    pub duplicate: u64,
    /// Particles reported as touching themselves.
    #[serde(default)]
    pub self_pairs: u64,
    /// Of the pairs missed, the largest overlap, in mean radii of the couple; 0 where all missed
    /// pairs are exactly tangent.
    #[serde(default)]
    pub deepest_miss: f64,
    /// Of the spurious pairs, the widest gap, in mean radii of the couple.
    #[serde(default)]
    pub widest_false: f64,
}

impl std::fmt::Display for Errors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} missed, {} spurious, {} duplicate",
            self.missed, self.spurious, self.duplicate
        )?;
        if self.self_pairs > 0 {
            write!(f, ", {} with itself", self.self_pairs)?;
        }
        if self.deepest_miss > 0.0 {
            write!(f, ", deepest miss {:.1e} r", self.deepest_miss)?;
        }
        if self.widest_false > 0.0 {
            write!(f, ", widest gap {:.1e} r", self.widest_false)?;
        }
        Ok(())
    }
}

impl Errors {
    /// Those of another answer as well: sums, and the deepest and widest of both.
    pub fn add(&mut self, other: &Errors) {
        self.missed = self.missed.saturating_add(other.missed);
        self.spurious = self.spurious.saturating_add(other.spurious);
        self.duplicate = self.duplicate.saturating_add(other.duplicate);
        self.self_pairs = self.self_pairs.saturating_add(other.self_pairs);
        self.deepest_miss = self.deepest_miss.max(other.deepest_miss);
        self.widest_false = self.widest_false.max(other.widest_false);
    }

    /// Pairs that are there and should not be, or should be and are not.
    pub fn wrong(&self) -> u64 {
        let others = self.duplicate.saturating_add(self.self_pairs);
        self.missed.saturating_add(self.spurious).saturating_add(others)
    }
}

/// The three causes of error (representation, predicate, search), each against the step before it.
/// The aliases are the names in older records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Causes {
    /// Representation: exact decisions on the scene as stored, against exact decisions on the
    /// scene as given.
    #[serde(alias = "input")]
    pub representation: Errors,
    /// Predicate: the arithmetic's own contact test on all pairs, against exact decisions, both on
    /// the scene as stored.
    #[serde(alias = "arithmetic")]
    pub predicate: Errors,
    /// Search: the detector's pairs, against the arithmetic's own contact test on all pairs.
    #[serde(alias = "algorithm")]
    pub search: Errors,
    /// Predicate and search together, which may cancel: the detector's pairs, against exact
    /// decisions on the scene as stored.
    pub stored: Errors,
}

impl Causes {
    /// Those of another answer as well.
    pub fn add(&mut self, other: &Causes) {
        self.representation.add(&other.representation);
        self.predicate.add(&other.predicate);
        self.search.add(&other.search);
        self.stored.add(&other.stored);
    }
}
