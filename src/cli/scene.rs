//! A scene as named on the command line: a file, or a generator with its parameters.

use std::path::{Path, PathBuf};

use anyhow::ensure;

use crate::read;
use crate::scene::AnyScene;
use crate::scene::spec::{GENERATORS, Spec};

/// Where a scene comes from.
#[derive(clap::Args)]
pub struct Source {
    /// A particle file, or a scene such as packed:n=200,seed=2 (see: contactbench list scenes)
    pub scene: Option<String>,
    /// The radius of all particles, for files without radii
    #[arg(long, allow_negative_numbers = true)]
    pub radius: Option<f64>,
    /// 2 or 3, where the file leaves it open (an npy array of three columns)
    #[arg(long)]
    pub dim: Option<u32>,
}

impl Source {
    /// Reads or makes it; its name and the scene, or none if none was named. A file goes before a generator of the same name.
    pub fn get(&self) -> anyhow::Result<Option<(String, AnyScene<'static>)>> {
        let options = read::Options { radius: self.radius, dim: self.dim };
        let Some(text) = &self.scene else {
            ensure!(options == read::Options::default(), "--radius and --dim belong to a particle file, and none is named");
            return Ok(None);
        };
        let generator = text.split(':').next().unwrap_or_default().trim();
        if !Path::new(text).exists() && GENERATORS.iter().any(|known| known.name == generator) {
            ensure!(options == read::Options::default(), "--radius and --dim belong to files; write them into the scene: {text}");
            return Ok(Some((text.clone(), Spec::parse(text)?.make()?)));
        }
        let path = PathBuf::from(text);
        let scene = read::scene(&path, options)?;
        let name = path.file_name().map_or_else(|| text.clone(), |name| name.to_string_lossy().into_owned());
        Ok(Some((name, scene)))
    }
}
