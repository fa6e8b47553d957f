//! A scene as it is named on a command line: a file, or a generator with parameters.

use std::path::PathBuf;

use crate::spec::Spec;
use contactbench_io as io;
use contactbench_io::Given;

/// Where a scene comes from.
#[derive(Clone, Debug)]
pub enum Origin {
    /// A file of particles.
    File(PathBuf, Box<io::Options>),
    /// A generator.
    Made(Spec),
}

impl Origin {
    /// All of it.
    ///
    /// # Errors
    /// What cannot be read or made.
    pub fn whole(&self) -> anyhow::Result<Given> {
        match self {
            Origin::Made(spec) => spec.given(),
            Origin::File(path, options) => io::given(path, **options),
        }
    }
}
