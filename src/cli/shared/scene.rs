//! A scene named on the command line: a file, or a generator with its parameters.

use std::path::Path;

use anyhow::{Context, ensure};

use crate::cli::shared::input::{Input, OPTIONS};
use crate::cli::shared::values;
use contactbench_ground::scene::AnyScene;
use contactbench_io as io;
use contactbench_io::Given;

const NONE: &str =
    "name a particle file, or a scene such as packed:n=1000 (contactbench list scenes)";

pub type WithIds = (Given, Option<Vec<i64>>);

#[derive(clap::Args)]
pub struct Source {
    /// Particle file, or a scene such as packed:n=200 (list scenes)
    #[arg(value_name = "FILE|SCENE", value_parser = values::SCENE, hide_possible_values = true)]
    pub scene: Option<String>,
    #[command(flatten)]
    pub input: Input,
}

impl Source {
    /// Reads or makes the scene; returns its name and the scene, or `None` if none was named. A
    /// file has precedence over a generator of the same name. A periodic box is an error.
    pub fn get(&self) -> anyhow::Result<Option<(String, AnyScene<'static>)>> {
        self.named(|text| self.input.scene(text))
    }

    /// Like [`Source::get`], with a periodic box if the scene has one. A scene must be named.
    pub fn given(&self) -> anyhow::Result<(String, Given)> {
        self.named(|text| self.input.given(text))?.context(NONE)
    }

    /// Like [`Source::given`], with the ids of the particles if wanted and present.
    pub fn with_ids(&self, ids: bool) -> anyhow::Result<(String, WithIds)> {
        self.named(|text| self.input.with_ids(text, ids))?.context(NONE)
    }

    fn named<T>(
        &self,
        make: impl FnOnce(&str) -> anyhow::Result<T>,
    ) -> anyhow::Result<Option<(String, T)>> {
        let Some(text) = &self.scene else {
            ensure!(!self.input.is_said(), "{OPTIONS} need a particle file; name one");
            return Ok(None);
        };
        let scene = make(text)?;
        // The name of a file is printed without its folders.
        let file = Path::new(text).file_name().filter(|_| io::exists(Path::new(text)));
        Ok(Some((
            file.map_or_else(|| text.clone(), |name| name.to_string_lossy().into_owned()),
            scene,
        )))
    }
}
