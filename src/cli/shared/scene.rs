//! A scene as named on the command line: a file, or a generator with its parameters.

use std::path::Path;

use anyhow::ensure;

use crate::cli::shared::input::{Input, OPTIONS};
use crate::cli::shared::values;
use contactbench_core::scene::AnyScene;
use contactbench_io as io;
use contactbench_io::Given;

/// Particles and their ids.
pub type WithIds = (Given, Option<Vec<i64>>);

/// Where a scene comes from.
#[derive(clap::Args)]
pub struct Source {
    /// A particle file, or a scene such as packed:n=200,seed=2 (see: contactbench list scenes)
    #[arg(value_parser = values::SCENE, hide_possible_values = true)]
    pub scene: Option<String>,
    /// What the file does not say
    #[command(flatten)]
    pub input: Input,
}

impl Source {
    /// Reads or makes it; its name and the scene, or none if none was named. A file goes before a
    /// generator of the same name.
    pub fn get(&self) -> anyhow::Result<Option<(String, AnyScene<'static>)>> {
        self.named(|text| self.input.scene(text))
    }

    /// The same with the box in which it repeats, for those who know what to do with one.
    pub fn given(&self) -> anyhow::Result<Option<(String, Given)>> {
        self.named(|text| self.input.given(text))
    }

    /// The same with the ids of the particles, if they are wanted and there.
    pub fn with_ids(&self, ids: bool) -> anyhow::Result<Option<(String, WithIds)>> {
        self.named(|text| self.input.with_ids(text, ids))
    }

    fn named<T>(
        &self,
        make: impl FnOnce(&str) -> anyhow::Result<T>,
    ) -> anyhow::Result<Option<(String, T)>> {
        let Some(text) = &self.scene else {
            ensure!(
                !self.input.is_said(),
                "{OPTIONS} belong to a particle file, and none is named"
            );
            return Ok(None);
        };
        let scene = make(text)?;
        // A file goes by its name without folders.
        let file = Path::new(text).file_name().filter(|_| io::exists(Path::new(text)));
        Ok(Some((
            file.map_or_else(|| text.clone(), |name| name.to_string_lossy().into_owned()),
            scene,
        )))
    }
}
