//! A scene as named on a command line: a file, or a generator with parameters.

use std::path::PathBuf;

use crate::spec::Spec;
use contactbench_io as io;
use contactbench_io::Given;

#[derive(Clone, Debug)]
pub enum Origin {
    File(PathBuf, Box<io::Options>),
    Made(Spec),
}

impl Origin {
    pub fn whole(&self) -> anyhow::Result<Given> {
        match self {
            Origin::Made(spec) => spec.given(),
            Origin::File(path, options) => io::given(path, **options),
        }
    }
}
