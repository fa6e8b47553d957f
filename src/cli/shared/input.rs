//! What the verbs that read files ask about them.

use std::path::Path;

use crate::io;
use crate::io::{Format, Frame};
use crate::scene::AnyScene;
use crate::scene::spec::Spec;

/// What a file does not say.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Input {
    /// The radius of all particles, for files without radii
    #[arg(long, allow_negative_numbers = true)]
    pub radius: Option<f64>,
    /// 2 or 3, where the file leaves it open (an npy array of three columns, or z = 0)
    #[arg(long)]
    pub dim: Option<u32>,
    /// Which frame of a file that has several: a number from 0, or last
    #[arg(long)]
    pub frame: Option<Frame>,
    /// The file's format (default: told by its content, then by its ending)
    #[arg(long, value_enum, hide_possible_values = true)]
    pub format: Option<Format>,
}

impl Input {
    /// The same for the readers.
    pub fn options(&self) -> io::Options {
        let frame = self.frame.unwrap_or_default();
        io::Options {
            radius: self.radius,
            dim: self.dim,
            frame,
            format: self.format,
            ..io::Options::NONE
        }
    }

    /// Was anything said?
    pub fn given(&self) -> bool {
        self.radius.is_some() || self.dim.is_some() || self.frame.is_some() || self.format.is_some()
    }

    /// The scene of a file, or of a generator such as `packed:dim=3,n=1000`. What is there as a
    /// file is a file.
    pub fn scene(&self, text: &str) -> anyhow::Result<AnyScene<'static>> {
        let generated =
            text.split_once(':').is_some_and(|(name, _)| is_generator(name)) || is_generator(text);
        if generated && !Path::new(text).exists() {
            anyhow::ensure!(
                !self.given(),
                "--radius, --dim, --frame and --format belong to files; write dim=3 and the like \
                 into the scene: {text}"
            );
            return Spec::parse(text)?.make();
        }
        io::scene(Path::new(text), self.options())
    }
}

fn is_generator(name: &str) -> bool {
    crate::scene::spec::GENERATORS.iter().any(|generator| generator.name == name.trim())
}
