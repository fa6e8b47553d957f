//! Errors of an answer, and their causes.

use serde::{Deserialize, Serialize};

/// The differences between a list of pairs and the true list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Touching pairs that were not reported.
    pub missed: u64,
    /// Reported pairs of two different particles that do not touch.
    pub spurious: u64,
    /// Repeated reports of a pair: each report after the first.
    pub duplicate: u64,
    /// Particles reported as touching themselves.
    #[serde(default)]
    pub self_pairs: u64,
    /// Largest overlap among the missed pairs, in mean radii of the pair; 0 if all are exactly
    /// tangent.
    #[serde(default)]
    pub deepest_miss: f64,
    /// Widest gap among the spurious pairs, in mean radii of the pair.
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
    /// Adds the errors of another answer: counts are summed, depths and gaps are maxima.
    pub fn add(&mut self, other: &Errors) {
        self.missed = self.missed.saturating_add(other.missed);
        self.spurious = self.spurious.saturating_add(other.spurious);
        self.duplicate = self.duplicate.saturating_add(other.duplicate);
        self.self_pairs = self.self_pairs.saturating_add(other.self_pairs);
        self.deepest_miss = self.deepest_miss.max(other.deepest_miss);
        self.widest_false = self.widest_false.max(other.widest_false);
    }

    /// Number of missed, spurious, duplicate and self pairs.
    pub fn wrong(&self) -> u64 {
        let others = self.duplicate.saturating_add(self.self_pairs);
        self.missed.saturating_add(self.spurious).saturating_add(others)
    }
}

/// Errors by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Causes {
    /// Errors of representation: exact contacts of the stored scene, compared with exact contacts
    /// of the given scene.
    pub representation: Errors,
    /// Errors of the predicate: pairs that the arithmetic's contact test accepts, compared with
    /// exact contacts, both of the stored scene.
    pub predicate: Errors,
    /// Errors of the search: the detector's pairs, compared with all pairs that the arithmetic's
    /// contact test accepts.
    pub search: Errors,
    /// Errors of predicate and search together, which may cancel: the detector's pairs, compared
    /// with exact contacts of the stored scene.
    pub stored: Errors,
}

impl Causes {
    /// Adds the errors of another answer to those with the same cause.
    pub fn add(&mut self, other: &Causes) {
        self.representation.add(&other.representation);
        self.predicate.add(&other.predicate);
        self.search.add(&other.search);
        self.stored.add(&other.stored);
    }
}
