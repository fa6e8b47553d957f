//! Frames with their contacts, one after the other.

use super::between::{Moved, Steps};
use super::names::Names;
use super::through::Through;
use crate::periodic::{ImagePair, Periodic};
use crate::scene::AnyScene;

/// Finds what a motion is like.
#[derive(Default)]
pub(crate) struct Course {
    /// So far.
    pub moved: Moved,
    /// Of contacts in the last frame, where that was in a box.
    pub names: Names,
    last: Last,
}

/// The last frame.
#[derive(Default)]
enum Last {
    #[default]
    None,
    Open(AnyScene<'static>, Vec<[u32; 2]>),
    /// Contacts by their names in all frames.
    InBox(Vec<ImagePair>),
}

impl Course {
    /// One more frame in open space, and its contacts in ascending order.
    pub fn open(&mut self, scene: AnyScene<'static>, pairs: &[[u32; 2]], memory_limit: u64) {
        let last = match &self.last {
            Last::Open(scene, pairs) => Some((scene, &pairs[..])),
            _ => None,
        };
        self.moved.take(last, &scene, pairs, memory_limit);
        self.last = Last::Open(scene, pairs.to_vec());
        self.names = Names::default();
    }

    /// One more frame in a box, and its contacts.
    pub fn in_box(&mut self, frame: &Periodic<'static>, contacts: &[ImagePair], memory_limit: u64) {
        let step = self.names.next(frame);
        let mut named: Vec<_> = contacts.iter().map(|&pair| self.names.name(pair)).collect();
        named.sort_unstable();
        let last = match (&step, &self.last) {
            (Some((last, onward)), Last::InBox(before)) => {
                Some((Through::new(last, frame, onward), &before[..]))
            }
            _ => None,
        };
        self.moved.take_in_box(last, frame, &named, memory_limit);
        self.last = Last::InBox(named);
    }
}
