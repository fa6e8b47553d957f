//! What a runner loads: a trajectory, that is the same particles in frame after frame, each frame
//! in a file. A scene at rest is a trajectory of one frame.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::io::exchange;
use crate::scene::AnyScene;

/// The files of a trajectory. A runner opens one after the other: it never holds them all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trajectory {
    /// One NumPy npy file per frame, in order; a file may stand there more than once. Little-endian
    /// f64, C order: `n` rows of `dim` coordinates, and the radius as one more column if `radius`
    /// is null.
    pub frames: Vec<PathBuf>,
    /// 2 or 3.
    pub dim: u32,
    /// Particles, the same in all frames.
    pub n: u64,
    /// The radius of all particles, or null.
    pub radius: Option<f64>,
}

impl Trajectory {
    /// Writes a scene at rest to a file, the only frame.
    pub fn write_at_rest(path: &Path, scene: &AnyScene<'_>) -> anyhow::Result<Trajectory> {
        let radius = exchange::write_scene(path, scene)?;
        Ok(Trajectory {
            frames: vec![path.to_path_buf()],
            dim: scene.dim() as u32,
            n: scene.len() as u64,
            radius,
        })
    }

    /// Reads one of the files.
    pub fn read_frame(&self, path: &Path) -> anyhow::Result<AnyScene<'static>> {
        exchange::read_scene(path, self.dim, self.n, self.radius)
    }
}
