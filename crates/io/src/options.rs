//! Options for reading a file, and their names on the command line and in scenes.

use anyhow::ensure;

use crate::boxes::Boundaries;
use crate::columns::chosen::Chosen;
use crate::columns::without::Without;
use crate::frames::{Once, Reader};
use crate::particles::Loaded;
use crate::raw::lines::Source;
use crate::types::FrameChoice;
use contactbench_terms::number;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// The radius of all particles; it replaces sizes in the file.
    pub radius: Option<f64>,
    /// Dimension, 2 or 3, if the file allows both; `None` takes the dimension of the file.
    pub dim: Option<u32>,
    pub frame: FrameChoice,
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

/// A file format; see [`FORMATS`](crate::FORMATS).
pub struct Format {
    pub key: &'static str,
    /// Contents of a file in this format, for the help.
    pub help: &'static str,
    pub name: &'static str,
    pub endings: &'static [&'static str],
    /// The start of every such file, for messages; empty if files may start with anything.
    pub begins: &'static str,
    pub(crate) tells: fn(&[u8]) -> bool,
    pub(crate) read: Read,
}

pub(crate) enum Read {
    Whole(fn(Source<'_>, Options) -> anyhow::Result<Loaded>),
    Frames(fn(Source<'_>, Options) -> Opened<'_>),
}

pub(crate) type Opened<'a> = Box<dyn Reader<Loaded> + 'a>;

impl Format {
    pub(crate) fn open<'a>(&self, source: Source<'a>, options: Options) -> Opened<'a> {
        match self.read {
            Read::Whole(read) => Box::new(Once::new(move || read(source, options))),
            Read::Frames(open) => open(source, options),
        }
    }
}

impl PartialEq for Format {
    fn eq(&self, other: &Format) -> bool {
        self.key == other.key
    }
}

impl std::fmt::Debug for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.key)
    }
}

pub struct FileOption {
    /// Name on the command line and in scenes; only `dim` is called `file-dim` in scenes.
    pub name: &'static str,
    /// Placeholder of the value in the help; empty for a flag.
    pub value: &'static str,
    pub meaning: &'static str,
}

const fn option(name: &'static str, value: &'static str, meaning: &'static str) -> FileOption {
    FileOption { name, value, meaning }
}

pub const OPTIONS: [FileOption; 8] = [
    option("radius", "RADIUS", "Radius of all particles, if the file has none"),
    option("dim", "DIM", "2 or 3 dimensions, if the file leaves it open"),
    option("frame", "FRAME", "From 0, last, or (some verbs) all [default: last]"),
    option("columns", "COLUMNS", "x y z r d id points frame by name or number: x=3,y=4"),
    option("format", "FORMAT", "File format [default: by content and name]"),
    option("box", "NUMBERS", "Box: LX,LY[,LZ[,XY,XZ,YZ]], or its 2 or 3 vectors"),
    option("periodic", "AXES", "Axes along which the box repeats, as in xy, or none"),
    option("open", "", "Open boundaries: no contacts across the box"),
];

impl FileOption {
    pub fn set(&self, options: &mut Options, text: &str) -> Result<(), String> {
        let dim = || number::whole(text).and_then(|dim| u32::try_from(dim).ok());
        let real = || text.parse().ok();
        match self.name {
            "radius" => {
                let radius =
                    real().ok_or("it must be a number with a decimal point, such as 0.5")?;
                options.radius = Some(radius);
            }
            "dim" => options.dim = Some(dim().ok_or("it must be a whole number: 2 or 3")?),
            "frame" => options.frame = text.parse()?,
            "columns" => options.columns = Some(text.parse()?),
            "format" => options.format = Some(text.parse()?),
            "box" => options.boundaries.edges = Some(text.parse()?),
            "periodic" => options.boundaries.periodic = Some(text.parse()?),
            _ => {
                options.boundaries.open = text.parse().map_err(|_| "it must be true or false")?;
            }
        }
        Ok(())
    }

    pub fn check(&self, text: &str) -> Result<String, String> {
        self.set(&mut Options::default(), text).map(|()| text.to_string())
    }
}

impl Options {
    pub const NONE: Options = Options {
        radius: None,
        dim: None,
        frame: FrameChoice::Only,
        format: None,
        ids: false,
        survey: false,
        columns: None,
        boundaries: Boundaries::AS_DECLARED,
        without: None,
        part: None,
    };

    /// Whether the columns of the coordinates are chosen.
    pub(crate) fn axes_chosen(&self) -> bool {
        self.columns.is_some_and(|chosen| chosen.axes())
    }

    pub(crate) fn sizes_chosen(&self) -> bool {
        self.columns.is_some_and(|chosen| chosen.sizes())
    }

    pub(super) fn check(&self) -> anyhow::Result<()> {
        let (radius, dim) = (self.radius.unwrap_or(0.0), self.dim.unwrap_or(2));
        let sound = radius.is_finite() && radius >= 0.0;
        ensure!(sound, "the radius given is {radius}; it must be finite and not negative");
        ensure!(dim == 2 || dim == 3, "the dimension given is {dim}; it must be 2 or 3");
        let twice = self.radius.is_some() && self.sizes_chosen();
        ensure!(!twice, "the radius is given, and a column of sizes is chosen, too; leave one out");
        self.boundaries.check()
    }
}
