//! What is known about a file: its frame, its box, the source of its radii, and the assumptions
//! made while reading it. Every command that reads particles prints the assumptions.

use crate::raw::lines::short;

#[derive(Clone, Debug, Default, PartialEq)]
pub enum RadiusSource {
    Column(String),
    /// Name of the column or array of diameters, whose values were halved.
    Halved(String),
    Given,
    #[default]
    Missing,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    pub format: &'static str,
    pub gzip: bool,
    pub radius: RadiusSource,
    pub frames: u64,
    pub frame: u64,
    pub step: Option<i64>,
    pub time: Option<f64>,
    /// The box in the file, and whether it is periodic.
    pub declared: Option<Declared>,
    pub file: Option<String>,
}

impl About {
    pub fn which(&self) -> String {
        match self.step {
            Some(step) => format!("frame {} (step {step})", self.frame),
            None => format!("frame {}", self.frame),
        }
    }
}

/// The box in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Declared {
    /// Vectors of the box, one per row; `None` if the file only states that particles are periodic.
    pub vectors: Option<[[f64; 3]; 3]>,
    pub origin: [f64; 3],
    /// Vectors along which the file declares the box periodic; `None` if it does not state them.
    pub periodic: Option<[bool; 3]>,
    /// Whether the vectors were rounded when they were computed from the numbers in the file.
    pub rounded: bool,
    /// Least and largest coordinate along each axis, if the edges of the box are parallel to the
    /// axes and the file states these coordinates.
    pub ranges: Option<Vec<[f64; 2]>>,
}

/// A choice among the frames of a file, which are numbered from 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrameChoice {
    /// The only frame; a file with several frames is refused.
    #[default]
    Only,
    Number(u64),
    Last,
    All,
}

impl std::str::FromStr for FrameChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<FrameChoice, String> {
        match text {
            "last" => Ok(FrameChoice::Last),
            "first" => Ok(FrameChoice::Number(0)),
            "all" => Ok(FrameChoice::All),
            _ => match text.parse() {
                Ok(k) => Ok(FrameChoice::Number(k)),
                Err(_) => Err("it must be a number from 0, or last, or all".into()),
            },
        }
    }
}

/// An assumption about a file, or a doubt that affects which contacts are found.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// The file does not state whether its box is periodic, so boundaries are open.
    Boundaries,
    /// All z are 0.
    Flat,
    /// Contacts per particle, if hard particles cannot have as many.
    Crowded(f64, RadiusSource),
    /// Another assumption, as a sentence with the option that changes it.
    Assumed(String),
}

impl Notice {
    /// Whether the other notice is the same, apart from numbers that change from frame to frame.
    pub fn is_like(&self, other: &Notice) -> bool {
        match (self, other) {
            (Notice::Assumed(a), Notice::Assumed(b)) => a == b,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
}

impl std::fmt::Display for Notice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Notice::Assumed(words) => f.write_str(words),
            Notice::Flat => f.write_str(
                "z is 0 for all particles; if they are discs, give --dim 2 (in a scene, file-dim)",
            ),
            Notice::Crowded(each, source) => {
                let sizes = match source {
                    RadiusSource::Column(name) => format!("'{}'", short(name)),
                    RadiusSource::Halved(name) => format!("half of '{}'", short(name)),
                    RadiusSource::Given | RadiusSource::Missing => "--radius".into(),
                };
                write!(
                    f,
                    "{each:.1} contacts per particle are more than a packing of hard particles \
                     has; check that {sizes} is a radius, in the unit of the coordinates"
                )
            }
            Notice::Boundaries => f.write_str(
                "the file does not define whether its box repeats, so boundaries are taken as \
                 open; give --periodic xyz if it repeats, and --open if not",
            ),
        }
    }
}

/// An assumption in words.
macro_rules! assumed {
    ($($words:tt)*) => { $crate::types::Notice::Assumed(format!($($words)*)) };
}
pub(crate) use assumed;
