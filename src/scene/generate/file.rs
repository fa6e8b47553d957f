//! `file`: particles that somebody else made.
//!
//! ```text
//!   x,y,r
//!   0,0,0.5        ->   o o
//!   1,0,0.5
//! ```
//!
//! The formats and their rules are those of [`crate::io`]. The file decides the number of
//! particles and the dimension: n = 0 takes what there is, another n must be the file's. `file-dim`
//! says what an array with three columns means; see [`crate::io::Options`].

use std::path::Path;

use anyhow::ensure;

use crate::io;
use crate::scene::generate::table::{Generator, Kind, Parameter, Preset, no_history, optional};

/// The name under which the program knows files.
pub const NAME: &str = "file";

pub const GENERATOR: Generator = Generator {
    name: NAME,
    dims: &[2, 3],
    summary: "a particle file: CSV, XYZ, LAMMPS, MercuryDPM, YADE, NumPy, VTK or PLY",
    own_n: true,
    params: &[&[
        Parameter {
            name: "path",
            kind: Kind::Text,
            default: [Preset::Required; 2],
            meaning: "the file's name",
        },
        optional("radius", Kind::NotNegative, "radius of all particles, for files that hold none"),
        optional(
            "file-dim",
            Kind::Dim,
            "2 or 3, where the file leaves it open: three columns without names, or z = 0",
        ),
        optional(
            "frame",
            Kind::Text,
            "which frame, of a file that has several: a number from 0, or last",
        ),
        optional("format", Kind::Text, "the format, where content and ending do not tell"),
        optional("columns", Kind::Text, "which column of a text holds what, as in x=3,y=4,z=5,r=6"),
        optional(
            "box",
            Kind::Text,
            "the box, in the place of the file's: LX,LY,LZ, with a tilt LX,LY,LZ,XY,XZ,YZ",
        ),
        optional(
            "periodic",
            Kind::Axes,
            "the box repeats along these axes, whatever the file says: true, x, xy and so \
                      on, none",
        ),
        optional("open", Kind::Yes, "true: boundaries are open, also where the file's box repeats"),
    ]],
    make: |inputs| {
        let path = Path::new(inputs.text("path")?);
        let options = io::Options {
            radius: inputs.number("radius").ok(),
            dim: inputs.whole("file-dim").ok().map(|dim| dim as u32),
            frame: inputs.parsed("frame")?.unwrap_or_default(),
            format: inputs.parsed("format")?,
            columns: inputs.parsed("columns")?,
            boundaries: io::Boundaries {
                edges: inputs.parsed("box")?,
                periodic: inputs.parsed("periodic")?,
                open: inputs.text("open").is_ok_and(|text| text == "true"),
            },
            ..io::Options::NONE
        };
        let given = io::given(path, options)?;
        let (n, found) = (inputs.n, given.scene.len());
        ensure!(
            n == 0 || n == found as u64,
            "{} holds {found} particles, but n = {n} was asked for; leave n out",
            path.display()
        );
        Ok(given)
    },
    history: no_history,
};
