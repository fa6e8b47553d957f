//! Statistics of a motion.

use serde::{Deserialize, Serialize};

/// Changes from frame to frame, summed over the frames or as the largest value.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moved {
    /// Number of particles.
    pub particles: u64,
    /// Number of frames.
    pub frames: u64,
    /// Contacts, summed over the frames.
    pub contacts: u64,
    /// Contacts that were not in the frame before, summed over the frames.
    pub born: u64,
    /// Contacts that are not in the next frame, summed over the frames.
    pub ended: u64,
    /// Pairs that touch between two frames but in neither of them, if particles move in straight
    /// lines. Exact for the given numbers; in a periodic box, images are rounded to f64.
    pub tunnelled: u64,
    /// Why `tunnelled` leaves out some steps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncounted: Option<String>,
    /// Displacements per frame.
    pub way: Way,
}

/// Displacements of particles from one frame to the next, in diameters of the largest particle; in
/// a periodic box, to the nearest image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Way {
    /// Longest displacement.
    pub longest: f64,
    /// Sum of all displacements.
    pub sum: f64,
    /// Number of particles that did not move at all, summed over the frames.
    pub at_rest: u64,
}

impl Moved {
    /// Number of steps from one frame to the next.
    pub fn steps(&self) -> u64 {
        self.frames.saturating_sub(1)
    }

    /// Mean displacement of a particle per frame, in diameters of the largest particle.
    pub fn mean_way(&self) -> f64 {
        match self.steps() * self.particles {
            0 => 0.0,
            steps => self.way.sum / steps as f64,
        }
    }

    /// Share of particles that do not move at all from one frame to the next.
    pub fn share_at_rest(&self) -> f64 {
        match self.steps() * self.particles {
            0 => 1.0,
            steps => self.way.at_rest as f64 / steps as f64,
        }
    }
}
