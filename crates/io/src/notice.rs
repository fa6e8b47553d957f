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
    /// Number of particles with the same centre as another, and the first of them.
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
            Notice::Flat => format!("z is 0 for all: these may be discs; then give {plane}"),
            Notice::Points => "there are radii of 0: points".into(),
            Notice::Apart => "nothing touches: are the radii in the units of the coordinates, and \
                              not too small by a half?"
                .into(),
            Notice::Crowded { each, other_unit, source } => {
                let what = match source {
                    _ if *other_unit => {
                        "the radii may be in another unit than the coordinates".into()
                    }
                    RadiusSource::Column(name) => {
                        format!("'{}' may hold diameters: name the column d then", short(name))
                    }
                    RadiusSource::Given => "--radius may have been given a diameter".into(),
                    _ => "the sizes may be too large, or in other units".into(),
                };
                format!(
                    "{each:.1} contacts per particle are more than a packing of hard bodies has; \
                     {what}"
                )
            }
            Notice::Deep(overlap) => format!(
                "contacts overlap by {overlap:.2} mean radii in the mean, and those of hard bodies \
                 hardly do; unless bodies may overlap, the sizes may be diameters, or in another \
                 unit"
            ),
            Notice::Nested(pairs, [i, j]) => format!(
                "{} nearly concentric, such as particles {i} and {j} (from 0): was something \
                 written twice, or is a radius too large?",
                if *pairs == 1 { "1 pair is".into() } else { format!("{pairs} pairs are") }
            ),
            Notice::Coincident(count, first) => format!(
                "{} or more with the centre of another, such as particle {first} (from 0): was \
                 something written twice?",
                if *count == 1 { "1 particle".into() } else { format!("{count} particles") }
            ),
            Notice::Scaled => "all coordinates are from 0 to 1, and fill that range: are they \
                               scaled by a box?"
                .into(),
            Notice::Far(spacing) => format!(
                "the scene is so far from the origin that f32 places bodies only to {spacing:.1e} \
                 radii: shift it, or use f64"
            ),
            Notice::Digits(digits) => format!(
                "coordinates have {digits} significant digits at most, so what nearly touches is \
                 decided by the digits that were cut off; write all 17 (LAMMPS: dump_modify ID \
                 format float %.17g)"
            ),
            Notice::Boundaries => format!(
                "the file does not say whether its box repeats: boundaries are taken as open; say \
                 {periodic} if it does, and {open} if not"
            ),
            Notice::Plane => format!(
                "z is 0 for all, and the box repeats along z: if these are discs, give {plane}"
            ),
        }
    }
}
