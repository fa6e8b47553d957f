//! The pairs of a picture: contacts, and the errors of a list.

use contactbench_ground::periodic::{ImagePair, Periodic, depth};

/// Pairs of particles by kind. Particles are numbered from 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pairs {
    /// Contacts, except missed ones.
    pub contacts: Vec<ImagePair>,
    pub missed: Vec<ImagePair>,
    /// Reported pairs that do not touch, or that join a particle with itself.
    pub spurious: Vec<ImagePair>,
    /// Repeated pairs of a list, once for each repetition.
    pub duplicates: Vec<ImagePair>,
}

impl Pairs {
    pub fn all(&self) -> impl Iterator<Item = &ImagePair> {
        let Pairs { contacts, missed, spurious, duplicates } = self;
        [contacts, missed, spurious, duplicates].into_iter().flatten()
    }

    /// Returns the worst error: the deepest missed pair, else the spurious pair with the widest
    /// gap, else a repeated pair.
    pub fn worst(&self, periodic: &Periodic<'_>) -> Option<ImagePair> {
        let depth = |pair: &ImagePair| depth(periodic, *pair).abs();
        let by_depth = |a: &&ImagePair, b: &&ImagePair| depth(a).total_cmp(&depth(b));
        let missed = self.missed.iter().max_by(by_depth);
        let worst = missed.or_else(|| self.spurious.iter().max_by(by_depth));
        worst.or(self.duplicates.first()).copied()
    }
}
