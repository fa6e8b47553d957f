//! What a tracker missed, over the frames.

use std::collections::HashMap;
use std::hash::Hash;

use super::names::Names;
use contactbench_core::contact::depth::depth;
use contactbench_core::periodic::{self, ImagePair, Periodic};
use contactbench_core::scene::{AnyScene, Real, array};
use contactbench_core::with_scene;

/// A frame, and what contacts are called in it and in all frames.
pub trait Named {
    /// A contact as this frame calls it.
    type Contact: Copy + Ord;

    /// The name in all frames.
    fn name(&self, contact: Self::Contact) -> ImagePair;

    /// What has this name.
    fn called(&self, name: ImagePair) -> Self::Contact;

    /// How deep it is.
    fn depth(&self, contact: Self::Contact) -> f64;
}

/// In open space.
impl Named for AnyScene<'_> {
    type Contact = [u32; 2];

    fn name(&self, [i, j]: [u32; 2]) -> ImagePair {
        ImagePair::new(i, j, [0; 3])
    }

    fn called(&self, ImagePair { i, j, .. }: ImagePair) -> [u32; 2] {
        [i, j]
    }

    fn depth(&self, [i, j]: [u32; 2]) -> f64 {
        with_scene!(self, scene => {
            let at = |k: u32| array(&scene.centres()[k as usize]).map(Real::wide);
            let radius = |k: u32| scene.radius(k as usize).wide();
            depth(&at(i), &at(j), radius(i), radius(j))
        })
    }
}

/// In a box.
impl Named for (&Periodic<'_>, &Names) {
    type Contact = ImagePair;

    fn name(&self, contact: ImagePair) -> ImagePair {
        self.1.name(contact)
    }

    fn called(&self, name: ImagePair) -> ImagePair {
        self.1.called(name)
    }

    fn depth(&self, contact: ImagePair) -> f64 {
        periodic::depth(self.0, contact)
    }
}

/// Contacts that were not reported in the frame in which they were there.
///
/// A *missed pair-step* is a pair that touches in a frame and is not reported in it. A contact is
/// missed from one frame on, until it is reported, or until it has ended and nobody knew of it.
/// Pairs go by names that are the same in all frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Late<P: Eq + Hash = ImagePair> {
    /// Missed pair-steps.
    pub missed: u64,
    /// The most in one frame.
    pub worst: u64,
    /// The first frame with one.
    pub first: Option<u64>,
    /// Frames with one.
    pub frames: u64,
    /// Contacts that ended, or were there in the last frame, and were never reported.
    pub never: u64,
    /// Of those that were reported too late, the most frames.
    pub latest: u64,
    /// Of those, the largest overlap when they were first reported, in mean radii of the couple.
    pub deepest: f64,
    /// Missed so far, and since which frame.
    open: HashMap<P, u64>,
}

impl<P: Eq + Hash> Default for Late<P> {
    fn default() -> Late<P> {
        Late {
            missed: 0,
            worst: 0,
            first: None,
            frames: 0,
            never: 0,
            latest: 0,
            deepest: 0.0,
            open: HashMap::new(),
        }
    }
}

impl Late {
    /// Compares what was reported in frame `k` with the truth, both in ascending order. Tells how
    /// many contacts were reported that are none, or twice.
    pub fn take<F: Named>(
        &mut self,
        k: u64,
        frame: &F,
        reported: &[F::Contact],
        truth: &[F::Contact],
    ) -> u64 {
        if self.open.is_empty() && reported == truth {
            return 0;
        }
        let (mut spurious, mut missed) = (0, Vec::new());
        let mut reports = reported.iter().copied().peekable();
        for &contact in truth {
            while reports.next_if(|&report| report < contact).is_some() {
                spurious += 1;
            }
            if reports.next_if_eq(&contact).is_none() {
                missed.push(frame.name(contact));
            }
        }
        spurious += reports.count() as u64;
        let depth = |&name: &ImagePair| {
            let contact = frame.called(name);
            truth.binary_search(&contact).is_ok().then(|| frame.depth(contact))
        };
        self.note(k, &missed, depth);
        spurious
    }
}

impl<P: Copy + Eq + Hash> Late<P> {
    /// These were missed in frame `k`, each once; `depth` is that of a contact which is there, and
    /// none of one that has ended.
    pub fn note(&mut self, k: u64, missed: &[P], depth: impl Fn(&P) -> Option<f64>) {
        // What was missed before and is so no more was reported, or has ended.
        let mut before = std::mem::take(&mut self.open);
        for &pair in missed {
            self.open.insert(pair, before.remove(&pair).unwrap_or(k));
        }
        for (pair, since) in before {
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

    /// Is something missed that may still be reported?
    pub(crate) fn is_open(&self) -> bool {
        !self.open.is_empty()
    }

    /// There are no more frames.
    pub fn end(&mut self) {
        self.never += self.open.len() as u64;
        self.open.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_core::scene::{Radii, Scene};

    #[test]
    fn a_contact_is_late_until_it_is_reported_or_ends() {
        let centres = [0.0, 1.5, 3.0, 4.5].map(|x| nalgebra::Point::from([x, 0.0])).to_vec();
        let frame: AnyScene<'_> = Scene::new(centres, Radii::Uniform(1.0)).unwrap().into();
        let all = [[0, 1], [1, 2], [2, 3]];
        let mut late = Late::default();
        assert_eq!(late.take(0, &frame, &all, &all), 0);
        assert_eq!(late, Late::default());
        // 0-1 is missed in three frames and then reported; 1-2 is missed once and ends; 2-3 is
        // missed in the last.
        assert_eq!(late.take(1, &frame, &[[1, 2], [2, 3]], &all), 0);
        assert_eq!(late.take(2, &frame, &[[2, 3]], &all), 0);
        assert_eq!(late.take(3, &frame, &[[2, 3]], &[[0, 1], [2, 3]]), 0);
        assert_eq!((late.never, late.latest), (1, 0));
        assert_eq!(late.take(4, &frame, &[[0, 1], [2, 3]], &[[0, 1], [2, 3]]), 0);
        assert_eq!(late.take(5, &frame, &[[0, 1]], &[[0, 1], [2, 3]]), 0);
        late.end();
        let found = Late { open: HashMap::new(), ..late.clone() };
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
        assert_eq!(found, truth);
        // Pairs that do not touch, and one twice.
        assert_eq!(late.take(6, &frame, &[[0, 1], [0, 1], [0, 2], [2, 3]], &all[..1]), 3);
    }
}
