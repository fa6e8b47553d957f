//! What a tracker missed, over the frames.

use std::collections::HashMap;
use std::hash::Hash;

use crate::contact::depth::depth;
use crate::scene::{AnyScene, Real, array};
use crate::with_scene;

/// Contacts that were not reported in the frame in which they were there.
///
/// A *missed pair-step* is a pair that touches in a frame and is not reported in it. A contact is
/// missed from one frame on, until it is reported, or until it has ended and nobody knew of it.
/// Pairs go by their places, or by other names that are the same in all frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Late<P: Eq + Hash = [u32; 2]> {
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

impl Late {
    /// Compares what was reported in frame `k` with the truth, both in the order of
    /// [`normalise`](crate::sink::normalise). Tells how many pairs were reported that do not touch,
    /// or twice.
    pub(crate) fn take(
        &mut self,
        k: u64,
        frame: &AnyScene<'_>,
        reported: &[[u32; 2]],
        truth: &[[u32; 2]],
    ) -> u64 {
        if self.open.is_empty() && reported == truth {
            return 0;
        }
        let (mut spurious, mut missed) = (0, Vec::new());
        let mut reports = reported.iter().copied().peekable();
        for &pair in truth {
            while reports.next_if(|&report| report < pair).is_some() {
                spurious += 1;
            }
            if reports.next_if_eq(&pair).is_none() {
                missed.push(pair);
            }
        }
        spurious += reports.count() as u64;
        let depth =
            |pair: &[u32; 2]| truth.binary_search(pair).is_ok().then(|| depth_of(frame, *pair));
        self.note(k, &missed, depth);
        spurious
    }
}

impl<P: Copy + Eq + Hash> Late<P> {
    /// These were missed in frame `k`, each once; `depth` is that of a contact which is there, and
    /// none of one that has ended.
    pub(crate) fn note(&mut self, k: u64, missed: &[P], depth: impl Fn(&P) -> Option<f64>) {
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
    pub(crate) fn end(&mut self) {
        self.never += self.open.len() as u64;
        self.open.clear();
    }
}

fn depth_of(frame: &AnyScene<'_>, [i, j]: [u32; 2]) -> f64 {
    with_scene!(frame, scene => {
        let at = |k: u32| array(&scene.centres()[k as usize]).map(Real::wide);
        let radius = |k: u32| scene.radius(k as usize).wide();
        depth(&at(i), &at(j), radius(i), radius(j))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Radii, Scene};

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
