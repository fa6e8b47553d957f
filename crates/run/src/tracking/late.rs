//! Missed contacts of a tracker, over all frames.

use std::collections::HashMap;
use std::hash::Hash;

use contactbench_detectors::oracle::loaded::{Difference, differences};
use contactbench_ground::periodic::ImagePair;

/// Contacts that were not reported in a frame in which they existed.
///
/// A *missed pair-step* is a touching pair that is not reported in one frame. A contact is missed
/// from one frame until it is reported or ends. Contacts are identified by their particles, whose
/// numbers or ids are the same in all frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Late<P: Eq + Hash = [u32; 2]> {
    pub missed: u64,
    pub worst: u64,
    pub first: Option<u64>,
    pub frames: u64,
    /// Number of missed contacts that ended, or lasted to the last frame, without being reported.
    pub never: u64,
    /// Largest number of frames by which a contact was reported late.
    pub latest: u64,
    /// Largest overlap of a late contact when it was first reported, in mean radii of the pair.
    pub deepest: f64,
    open: HashMap<P, u64>,
}

impl Late {
    /// Compares the contacts reported in frame `k` with the truth, both in ascending order, and
    /// returns the number of spurious and repeated contacts.
    pub fn take(
        &mut self,
        k: u64,
        depth: impl Fn(ImagePair) -> f64,
        reported: &[ImagePair],
        truth: &[ImagePair],
    ) -> u64 {
        if self.open.is_empty() && reported == truth {
            return 0;
        }
        let (mut spurious, mut missed) = (0, Vec::new());
        differences(reported, truth, |kind, pair| match kind {
            Difference::Missed => missed.push([pair.i, pair.j]),
            Difference::Added | Difference::Repeated => spurious += 1,
        });
        self.note(k, &missed, |&particles| {
            let start = truth.partition_point(|pair| [pair.i, pair.j] < particles);
            let images = truth[start..].iter().take_while(|pair| [pair.i, pair.j] == particles);
            images.map(|&pair| depth(pair)).reduce(f64::max)
        });
        spurious
    }
}

impl<P: Copy + Eq + Hash> Late<P> {
    /// Records the contacts missed in frame `k`. `depth` returns the overlap of a
    /// contact, or `None` if it has ended.
    pub fn note(&mut self, k: u64, missed: &[P], depth: impl Fn(&P) -> Option<f64>) {
        let before = std::mem::take(&mut self.open);
        for &pair in missed {
            self.open.insert(pair, before.get(&pair).copied().unwrap_or(k));
        }
        for (pair, since) in before.into_iter().filter(|(pair, _)| !self.open.contains_key(pair)) {
            match depth(&pair) {
                Some(depth) => {
                    self.latest = self.latest.max(k - since);
                    self.deepest = self.deepest.max(depth);
                }
                None => self.never += 1,
            }
        }
        let missed = missed.len() as u64;
        if missed > 0 {
            self.first.get_or_insert(k);
            self.frames += 1;
        }
        self.missed += missed;
        self.worst = self.worst.max(missed);
    }

    pub(crate) fn is_open(&self) -> bool {
        !self.open.is_empty()
    }

    pub fn end(&mut self) {
        self.never += self.open.len() as u64;
        self.open.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_is_late_until_it_is_reported_or_ends() {
        let [a, b, c, d] =
            [[0, 1], [1, 2], [2, 3], [0, 2]].map(|[i, j]| ImagePair::new(i, j, [0; 3]));
        let mut late = Late::default();
        let mut take = |k, reported: &[ImagePair], truth: &[ImagePair]| {
            let depth = |pair: ImagePair| f64::from(pair.i) + 0.5;
            let spurious = late.take(k, depth, reported, truth);
            (spurious, late.clone())
        };
        assert_eq!(take(0, &[a, b, c], &[a, b, c]), (0, Late::default()));
        // Contact a is missed in three frames and then reported; b is missed once and ends; c is
        // missed in the last frame.
        for (k, reported, truth) in [
            (1, &[b, c][..], &[a, b, c][..]),
            (2, &[c], &[a, b, c]),
            (3, &[c], &[a, c]),
            (4, &[a, c], &[a, c]),
            (5, &[a], &[a, c]),
        ] {
            let (spurious, late) = take(k, reported, truth);
            assert_eq!((spurious, late.never), (0, u64::from(k > 2)), "{k}");
        }
        assert_eq!(take(6, &[a, a, d, c], &[a]).0, 3);
        late.end();
        let truth = Late {
            missed: 5,
            worst: 2,
            first: Some(1),
            frames: 4,
            never: 2,
            latest: 3,
            deepest: 0.5,
            open: HashMap::new(),
        };
        assert_eq!(late, truth);
    }
}
