//! Assumptions made while reading a file. Every command that reads particles prints them.

use crate::{RadiusSource, short};

/// An assumption or a doubt about a file that affects which contacts are found.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// The file does not state whether its box is periodic, so boundaries are open.
    Boundaries,
    /// All z are 0, and the box is periodic along z.
    Plane,
    /// Coordinates were rounded to this many significant digits before they were written.
    Digits(u32),
    Flat,
    Points,
    Apart,
    /// More contacts per particle than hard particles can have.
    Crowded {
        each: f64,
        /// Whether there are at least five times too many, which suggests a wrong unit.
        other_unit: bool,
        source: RadiusSource,
    },
    /// Mean overlap of contacts, in mean radii, if larger than hard particles have.
    Deep(f64),
    /// Number of nearly concentric pairs, and the first of them.
    Nested(u64, [u32; 2]),
    Coincident(u64, u32),
    /// Coordinates lie between 0 and 1, and the contacts do not look like a packing.
    Scaled,
    /// Resolution of f32 coordinates, in mean radii.
    Far(f64),
    /// Another assumption, as a sentence with the option that changes it.
    Assumed(String),
}

/// The place where the file is named, which determines how options are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Argument,
    /// A scene text such as `file:path=p.dump`.
    Spec,
    Experiment,
}

impl Notice {
    /// Whether the other notice is the same, apart from numbers that change from frame to frame.
    pub fn is_like(&self, other: &Notice) -> bool {
        match (self, other) {
            (Notice::Assumed(a), Notice::Assumed(b)) => a == b,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }

    pub fn words(&self, place: Place) -> String {
        let [periodic, open, plane] = match place {
            Place::Argument => ["--periodic xyz", "--open", "--dim 2"],
            Place::Spec => ["periodic=xyz", "open=true", "dim=2"],
            Place::Experiment => {
                ["periodic = \"xyz\" in the experiment", "open = true", "file-dim = 2"]
            }
        };
        match self {
            Notice::Assumed(words) => words.clone(),
            Notice::Flat => format!("z is 0 for all particles; if they are discs, give {plane}"),
            Notice::Points => "some radii are 0: these particles are points".into(),
            Notice::Apart => "nothing touches; check that the radii are in the unit of the \
                              coordinates, and not half too small"
                .into(),
            Notice::Crowded { each, other_unit, source } => {
                let what = match source {
                    _ if *other_unit => {
                        "the radii may be in another unit than the coordinates".into()
                    }
                    RadiusSource::Column(name) => {
                        format!("'{}' may hold diameters; if so, name the column d", short(name))
                    }
                    RadiusSource::Given => "--radius may be a diameter".into(),
                    _ => "the sizes may be too large, or in another unit".into(),
                };
                format!(
                    "{each:.1} contacts per particle are more than a packing of hard particles \
                     has; \
                     {what}"
                )
            }
            Notice::Deep(overlap) => format!(
                "contacts overlap by {overlap:.2} mean radii in the mean, much more than those of \
                 hard particles; the sizes may be diameters, or in another unit"
            ),
            Notice::Nested(pairs, [i, j]) => format!(
                "{} nearly concentric, such as particles {i} and {j} (from 0); check for particles \
                 written twice, and for too large radii",
                if *pairs == 1 { "1 pair is".into() } else { format!("{pairs} pairs are") }
            ),
            Notice::Coincident(count, first) => format!(
                "{} or more with the centre of another, such as particle {first} (from 0); check \
                 for particles written twice",
                if *count == 1 { "1 particle".into() } else { format!("{count} particles") }
            ),
            Notice::Scaled => "all coordinates fill the range from 0 to 1; check whether they are \
                               scaled by a box"
                .into(),
            Notice::Far(spacing) => format!(
                "the scene is so far from the origin that f32 resolves only {spacing:.1e} radii; \
                 shift it, or use f64"
            ),
            Notice::Digits(digits) => format!(
                "coordinates have {digits} significant digits at most, so rounding decides which \
                 near pairs touch; write all 17 digits (LAMMPS: dump_modify ID format float \
                 %.17g)"
            ),
            Notice::Boundaries => format!(
                "the file does not define whether its box repeats, so boundaries are taken as \
                 open; give {periodic} if it repeats, and {open} if not"
            ),
            Notice::Plane => format!(
                "z is 0 for all particles, and the box repeats along z; if they are discs, give \
                 {plane}"
            ),
        }
    }
}
