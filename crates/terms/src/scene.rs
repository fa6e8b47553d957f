//! Statistics of a scene.

use serde::{Deserialize, Serialize};

/// What the scene turned out to be.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stats {
    /// Volume of the bodies over the volume of the box in which the scene repeats along all axes,
    /// or else of the box around the bodies; overlaps count twice.
    pub packing_fraction: f64,
    /// Contacts per particle: twice the number of touching pairs over the number of particles.
    /// Exact arithmetic.
    pub coordination: f64,
    /// Largest over smallest radius; 1 when all are equal, absent when the smallest is zero.
    pub radius_ratio: Option<f64>,
    /// Edges of the box around the centres, and where the scene repeats lengths of its vectors, in
    /// units of the largest diameter; absent when that is zero.
    pub box_diameters: Option<Vec<f64>>,
    /// Fingerprint of the exact coordinates and radii, in order: `0x` and 16 hexadecimal digits.
    pub scene_hash: String,
}

impl Stats {
    /// Pairs that touch in exact arithmetic, in a scene of so many particles.
    pub fn true_contacts(&self, n: u64) -> f64 {
        (self.coordination * n as f64 / 2.0).round()
    }
}
