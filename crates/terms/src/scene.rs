//! Statistics of a scene.

use serde::{Deserialize, Serialize};

/// Statistics of one scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stats {
    /// Volume of the particles over the volume of the box; overlaps count twice. The box is the
    /// periodic box if all axes are periodic, otherwise the bounding box of the particles.
    pub packing_fraction: f64,
    /// Contacts per particle: twice the number of touching pairs over the number of particles, in
    /// exact arithmetic.
    pub coordination: f64,
    /// Largest over smallest radius; `None` if the smallest is zero.
    pub radius_ratio: Option<f64>,
    /// Edges of the box around the centres, in units of the largest diameter; along periodic axes,
    /// the lengths of the box vectors. `None` if the largest diameter is zero.
    pub box_diameters: Option<Vec<f64>>,
    /// Fingerprint of exact coordinates and radii in input order: `0x` and 16 hexadecimal digits.
    pub scene_hash: String,
}

impl Stats {
    /// Number of touching pairs in exact arithmetic, in a scene of `n` particles.
    pub fn true_contacts(&self, n: u64) -> f64 {
        (self.coordination * n as f64 / 2.0).round()
    }
}
