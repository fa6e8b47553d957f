//! Statistics of a motion.

use serde::{Deserialize, Serialize};

/// Changes from frame to frame: their sum over the frames, or the largest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moved {
    /// Number of particles.
    pub particles: u64,
    /// Number of frames.
    pub frames: u64,
    /// Contacts, summed over the frames.
    pub contacts: u64,
    /// Contacts that the previous frame lacks, summed over the frames.
    pub born: u64,
    /// Contacts that the next frame lacks, summed over the frames.
    pub ended: u64,
    /// Displacements from frame to frame.
    #[serde(rename = "way")]
    pub displacements: Displacements,
}

/// Displacements of particles from one frame to the next, in diameters of the largest particle. In
/// a periodic box, displacements are to the nearest image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Displacements {
    /// Longest displacement.
    pub longest: f64,
    /// Sum of the displacements of all particles in all steps.
    pub sum: f64,
    /// Number of particles without any displacement, summed over the steps.
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
            steps => self.displacements.sum / steps as f64,
        }
    }

    /// Share of particles that do not move at all from one frame to the next.
    pub fn share_at_rest(&self) -> f64 {
        match self.steps() * self.particles {
            0 => 1.0,
            steps => self.displacements.at_rest as f64 / steps as f64,
        }
    }
}
