//! Statistics of a motion from frame to frame.

use serde::{Deserialize, Serialize};

/// What happens from one frame to the next, summed up or the most of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moved {
    /// Particles.
    pub particles: u64,
    /// Frames.
    pub frames: u64,
    /// Contacts, summed over the frames.
    pub contacts: u64,
    /// Contacts of a frame that were not there in the frame before.
    pub born: u64,
    /// Contacts of a frame that are not there in the next.
    pub ended: u64,
    /// Pairs that touch at some time between two frames and in neither of them, if bodies go
    /// straight from one to the other: exactly, for the numbers as given, in a box with images
    /// rounded to f64.
    pub tunnelled: u64,
    /// Why they were not counted between some frames.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncounted: Option<String>,
    /// How far particles go in a frame.
    pub way: Way,
}

/// Ways of particles from one frame to the next, in diameters of the largest body; in a box to the
/// nearest image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Way {
    /// The longest.
    pub longest: f64,
    /// All together.
    pub sum: f64,
    /// Particles that stayed exactly where they were, summed over the frames.
    pub at_rest: u64,
}

impl Moved {
    /// Steps from one frame to the next.
    pub fn steps(&self) -> u64 {
        self.frames.saturating_sub(1)
    }

    /// The mean way of a particle in a frame, in diameters of the largest body.
    pub fn mean_way(&self) -> f64 {
        match self.steps() * self.particles {
            0 => 0.0,
            steps => self.way.sum / steps as f64,
        }
    }

    /// The share of particles that stay exactly where they are from one frame to the next.
    pub fn share_at_rest(&self) -> f64 {
        match self.steps() * self.particles {
            0 => 1.0,
            steps => self.way.at_rest as f64 / steps as f64,
        }
    }
}
