//! Assumptions that a reader made about a file. Every verb that reads particles prints them.

/// An assumption about a file, or a doubt, that decides which contacts are found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice {
    /// It has a box and does not say whether that repeats: boundaries are taken as open.
    Boundaries,
    /// All z are 0, and the box repeats along z.
    Plane,
    /// Coordinates are written with so many significant digits, and were cut to them.
    Digits(u32),
    /// Any other assumption: a whole sentence, with the option that says otherwise.
    Assumed(String),
}

/// Where the file is named, and so how its options are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// As an argument.
    Argument,
    /// In a scene, as in `file:path=p.dump`.
    Spec,
    /// In an experiment.
    Experiment,
}

impl Notice {
    /// The sentence, with the remedy.
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
