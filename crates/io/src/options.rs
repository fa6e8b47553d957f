//! Options for reading a file, and their names on the command line and in scenes.

use std::fmt::Display;
use std::str::FromStr;

use anyhow::ensure;

use crate::{Boundaries, Chosen, Format, Frame, Without};
use contactbench_terms::number;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// The radius of all particles; it replaces sizes in the file.
    pub radius: Option<f64>,
    /// Dimension, 2 or 3, if the file allows both; `None` takes the dimension of the file.
    pub dim: Option<u32>,
    pub frame: Frame,
    /// The format; `None` detects it.
    pub format: Option<&'static Format>,
    /// Whether to keep the file's own numbers of the particles.
    pub ids: bool,
    /// Whether to read to the end of the file, to count its frames.
    pub survey: bool,
    /// The chosen columns or arrays; `None` finds them by name.
    pub columns: Option<Chosen>,
    pub boundaries: Boundaries,
    pub without: Option<Without>,
    /// Part of the particles to read: its index from 0, and the number of parts. Formats that
    /// cannot read parts ignore this; see [`Particles::first`](crate::Particles).
    pub part: Option<[u64; 2]>,
}

pub struct FileOption {
    /// Name on the command line and in scenes; only `dim` is called `file-dim` in scenes.
    pub name: &'static str,
    /// Placeholder of the value in the help; empty for a flag.
    pub value: &'static str,
    pub meaning: &'static str,
    set: fn(&mut Options, &str) -> Result<(), String>,
}

pub const OPTIONS: [FileOption; 8] = [
    FileOption {
        name: "radius",
        value: "RADIUS",
        meaning: "Radius of all particles, if the file has none",
        set: |options, text| {
            options.radius = Some(real(text)?);
            Ok(())
        },
    },
    FileOption {
        name: "dim",
        value: "DIM",
        meaning: "2 or 3 dimensions, if the file leaves it open",
        set: |options, text| {
            let dim = number::whole(text).and_then(|dim| u32::try_from(dim).ok());
            options.dim = Some(dim.ok_or("it must be a whole number: 2 or 3")?);
            Ok(())
        },
    },
    FileOption {
        name: "frame",
        value: "FRAME",
        meaning: "From 0, last, or (some verbs) all [default: last]",
        set: |options, text| {
            options.frame = text.parse()?;
            Ok(())
        },
    },
    FileOption {
        name: "columns",
        value: "COLUMNS",
        meaning: "x y z r d id frame by name or number: x=3,y=4",
        set: |options, text| parsed(text, &mut options.columns),
    },
    FileOption {
        name: "format",
        value: "FORMAT",
        meaning: "File format [default: by content and name]",
        set: |options, text| parsed(text, &mut options.format),
    },
    FileOption {
        name: "box",
        value: "NUMBERS",
        meaning: "Box: LX,LY[,LZ[,XY,XZ,YZ]], or its 2 or 3 vectors",
        set: |options, text| parsed(text, &mut options.boundaries.edges),
    },
    FileOption {
        name: "periodic",
        value: "AXES",
        meaning: "Axes along which the box repeats, as in xy, or none",
        set: |options, text| parsed(text, &mut options.boundaries.periodic),
    },
    FileOption {
        name: "open",
        value: "",
        meaning: "Open boundaries: no contacts across the box",
        set: |options, text| {
            options.boundaries.open = text.parse().map_err(|_| "it must be true or false")?;
            Ok(())
        },
    },
];

/// Parses a number with a decimal point; a decimal comma is refused.
fn real(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "it must be a number with a decimal point, such as 0.5".into())
}

fn parsed<T: FromStr<Err: Display>>(text: &str, value: &mut Option<T>) -> Result<(), String> {
    *value = Some(text.parse().map_err(|error: T::Err| error.to_string())?);
    Ok(())
}

impl FileOption {
    pub fn set(&self, options: &mut Options, text: &str) -> Result<(), String> {
        (self.set)(options, text)
    }

    pub fn check(&self, text: &str) -> Result<String, String> {
        self.set(&mut Options::default(), text).map(|()| text.to_string())
    }
}

impl Options {
    pub const NONE: Options = Options {
        radius: None,
        dim: None,
        frame: Frame::Only,
        format: None,
        ids: false,
        survey: false,
        columns: None,
        boundaries: Boundaries::AS_DECLARED,
        without: None,
        part: None,
    };

    pub(super) fn check(&self) -> anyhow::Result<()> {
        if let Some(radius) = self.radius {
            ensure!(
                radius.is_finite() && radius >= 0.0,
                "the radius given is {radius}; it must be finite and not negative"
            );
        }
        if let Some(dim) = self.dim {
            ensure!(dim == 2 || dim == 3, "the dimension given is {dim}; it must be 2 or 3");
        }
        ensure!(
            self.radius.is_none() || !self.columns.is_some_and(|chosen| chosen.sizes()),
            "the radius is given, and a column of sizes is chosen, too; leave one out"
        );
        self.boundaries.check()
    }
}
