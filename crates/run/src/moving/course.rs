//! Frames with their contacts, one after the other.

use super::between::{self, Moved};
use super::names::Names;
use super::through::Through;
use contactbench_core::periodic::{ImagePair, Periodic, without_shift};
use contactbench_core::scene::{AnyScene, Lattice};

/// Finds what a motion is like.
#[derive(Default)]
pub struct Course {
    /// So far.
    pub moved: Moved,
    /// Names of contacts in the last frame.
    pub names: Names,
    /// Contacts of the last frame, by their names in all frames.
    last: Vec<ImagePair>,
}

impl Course {
    /// Takes one more frame in open space, and its contacts in ascending order.
    pub fn open(&mut self, scene: AnyScene<'static>, pairs: &[[u32; 2]], memory_limit: u64) {
        let contacts: Vec<_> = without_shift(pairs).collect();
        // Frames are made in f64, and open space suits every scene.
        if let Ok(frame) = Periodic::new(scene, Lattice::OPEN) {
            self.in_box(&frame, &contacts, memory_limit);
        }
    }

    /// Takes one more frame in a periodic box, and its contacts.
    pub fn in_box(&mut self, frame: &Periodic<'static>, contacts: &[ImagePair], memory_limit: u64) {
        let step = self.names.next(frame);
        let mut named: Vec<_> = contacts.iter().map(|&pair| self.names.name(pair)).collect();
        named.sort_unstable();
        let last =
            step.as_ref().map(|(last, onward)| (Through::new(last, frame, onward), &self.last[..]));
        between::add(&mut self.moved, last, frame, &named, memory_limit);
        self.last = named;
    }
}
