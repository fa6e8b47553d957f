//! Trajectories for runners: the same particles in all frames, one file per frame, with one box for
//! all frames or one for each. A scene at rest is a trajectory of one frame.

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};

use crate::run::machine::interrupt;
use contactbench_ground::scene::Lattice;
use contactbench_io::{Given, exchange};
use contactbench_scenes::motion::Frames;

/// The files of a trajectory. A runner keeps only one frame in memory.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trajectory {
    /// One npy file per frame, in order; a file may occur several times. Little-endian f64, C
    /// order: `n` rows of `dim` coordinates, and the radius as one more column if `radius` is null.
    pub frames: Vec<PathBuf>,
    pub dim: u32,
    pub n: u64,
    pub radius: Option<f64>,
    /// The box of all frames; absent in open space, or if frames have different boxes.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub in_box: Option<BoxMessage>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub boxes: Vec<BoxMessage>,
    /// A field that runners must ignore; `check` tests this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remark: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoxMessage {
    pub vectors: Vec<Vec<f64>>,
    /// Whether the box is periodic along each vector.
    pub periodic: Vec<bool>,
    pub origin: Vec<f64>,
}

impl BoxMessage {
    fn new(lattice: &Lattice, dim: usize) -> BoxMessage {
        let vectors = &lattice.vectors()[..dim];
        BoxMessage {
            vectors: vectors.iter().map(|vector| vector[..dim].to_vec()).collect(),
            periodic: lattice.periodic()[..dim].to_vec(),
            origin: lattice.origin()[..dim].to_vec(),
        }
    }

    fn lattice(&self, dim: usize) -> anyhow::Result<Lattice> {
        let BoxMessage { vectors, periodic, origin } = self;
        let all = vectors.iter().chain([origin]).all(|numbers| numbers.len() == dim);
        ensure!(
            all && vectors.len() == dim && periodic.len() == dim,
            "the box must have {dim} vectors of {dim} numbers, {dim} flags and an origin of {dim} \
             numbers"
        );
        let of = |numbers: &[f64]| std::array::from_fn(|k| numbers.get(k).copied().unwrap_or(0.0));
        let none = [0.0; 3];
        let vectors = std::array::from_fn(|k| vectors.get(k).map_or(none, |vector| of(vector)));
        let periodic = std::array::from_fn(|k| periodic.get(k).copied().unwrap_or(false));
        Ok(Lattice::new(vectors, periodic, of(origin))?)
    }
}

impl Trajectory {
    pub fn write_at_rest(path: &Path, given: &Given) -> anyhow::Result<Trajectory> {
        let Given { scene, lattice, .. } = given;
        let radius = exchange::write_scene(path, scene)?;
        Ok(Trajectory {
            frames: vec![path.to_path_buf()],
            dim: scene.dim() as u32,
            n: scene.len() as u64,
            radius,
            in_box: lattice.as_ref().map(|lattice| BoxMessage::new(lattice, scene.dim())),
            ..Trajectory::default()
        })
    }

    /// Writes the first `count` frames of a motion. Fails if only some frames have a box.
    pub fn write_moving(
        folder: &Path,
        frames: &mut Frames,
        count: u64,
    ) -> anyhow::Result<Trajectory> {
        let (mut all, mut boxes) = (None::<Trajectory>, Vec::new());
        for k in 0..count {
            interrupt::check()?;
            let path = folder.join(format!("frame-{k}.npy"));
            let next = Trajectory::write_at_rest(&path, &frames.at(k)?)?;
            boxes.extend(next.in_box.clone());
            match &mut all {
                Some(all) => all.frames.extend(next.frames),
                None => all = Some(next),
            }
        }
        let mut all = all.context("a trajectory has at least one frame")?;
        ensure!(
            boxes.is_empty() || boxes.len() == all.frames.len(),
            "some frames have a box, others none; take the frames before (--frames)"
        );
        if boxes.iter().any(|one| *one != boxes[0]) {
            (all.in_box, all.boxes) = (None, boxes);
        }
        Ok(all)
    }

    pub fn at_rest(&self, k: usize) -> Trajectory {
        let Trajectory { dim, n, radius, .. } = *self;
        let frames = self.frames.get(k).cloned().into_iter().collect();
        let in_box = self.boxes.get(k).or(self.in_box.as_ref()).cloned();
        Trajectory { frames, dim, n, radius, in_box, ..Trajectory::default() }
    }

    /// Returns the dimension of the box, if there is one; contacts then have images.
    pub fn box_dim(&self) -> Option<usize> {
        (self.in_box.is_some() || !self.boxes.is_empty()).then_some(self.dim as usize)
    }

    /// Reads a frame from its file. Fails if the number of boxes differs from that of frames.
    pub fn read_frame(&self, k: usize) -> anyhow::Result<Given> {
        let path = self.frames.get(k).with_context(|| {
            format!("there is no frame {k}; the trajectory has {}", self.frames.len())
        })?;
        let scene = exchange::read_scene(path, self.dim, self.n, self.radius)?;
        let in_box = match self.boxes.len() {
            0 => self.in_box.as_ref(),
            boxes => {
                ensure!(
                    boxes == self.frames.len() && self.in_box.is_none(),
                    "the trajectory has {boxes} boxes for {} frames{}; give a box for each frame, \
                     or one for all",
                    self.frames.len(),
                    if self.in_box.is_some() { " and one for all" } else { "" }
                );
                self.boxes.get(k)
            }
        };
        match in_box {
            None => Ok(scene.into()),
            Some(in_box) => Given::in_box(scene, in_box.lattice(self.dim as usize)?),
        }
    }
}
