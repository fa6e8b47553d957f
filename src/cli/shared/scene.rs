//! A scene named on the command line: a file, or a generator with its parameters.

use std::path::Path;

use anyhow::{bail, ensure};

use crate::cli::shared::input::{Input, OPTIONS};
use contactbench_ground::scene::AnyScene;
use contactbench_io as io;
use contactbench_io::Given;
use contactbench_scenes::touching::particle;

/// Formats a particle as `7: 1.0 2.0 r 0.5`.
pub fn particle_line(scene: &AnyScene<'_>, k: u32) -> String {
    let (centre, radius) = particle(scene, k);
    let centre: Vec<String> = centre[..scene.dim()].iter().map(|x| format!("{x:?}")).collect();
    format!("{k}: {} r {radius:?}", centre.join(" "))
}

pub type WithIds = (Given, Option<Vec<i64>>);

#[derive(clap::Args)]
pub struct Source {
    /// Particle file, or a scene such as packed:n=200 (list scenes)
    #[arg(value_name = "FILE|SCENE", value_hint = clap::ValueHint::FilePath)]
    pub scene: Option<String>,
    #[command(flatten)]
    pub input: Input,
}

impl Source {
    /// Reads or makes the scene, with a periodic box if it has one, and returns it with its name.
    pub fn given(&self) -> anyhow::Result<(String, Given)> {
        let (name, (given, _)) = self.with_ids(false)?;
        Ok((name, given))
    }

    /// Like [`Source::given`], with the ids of the particles if wanted and present.
    pub fn with_ids(&self, ids: bool) -> anyhow::Result<(String, WithIds)> {
        let Some(text) = &self.scene else {
            ensure!(!self.input.is_said(), "{OPTIONS} need a particle file; name one");
            bail!(
                "name a particle file, or a scene such as packed:n=1000 (contactbench list scenes)"
            );
        };
        let scene = self.input.with_ids(text, ids)?;
        // The name of a file is printed without its folders.
        let file = Path::new(text).file_name().filter(|_| io::exists(Path::new(text)));
        let file = file.map(|name| name.to_string_lossy().into_owned());
        Ok((file.unwrap_or_else(|| text.clone()), scene))
    }
}
