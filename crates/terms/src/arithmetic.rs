//! The axis of accuracy: in which number format a scene is stored and how contacts are decided.

/// How contacts are decided, and in which precision the scene is stored: the axis of accuracy.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Default,
    serde::Serialize,
    serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Arithmetic {
    /// Scene rounded to f32, |xi - xj|² <= (ri + rj)² evaluated in f32.
    F32,
    /// As f32, but coordinates are stored as a cell number and an offset from the cell's origin in
    /// f32.
    F32Cell,
    /// f64 with the filters as the book prints them, without a safety margin: may lose contacts.
    Textbook,
    /// |xi - xj|² <= (ri + rj)² evaluated in f64.
    F64,
    /// The exact sign for the given f64 numbers.
    #[default]
    Exact,
}

impl Arithmetic {
    /// All arithmetics, from the least to the most accurate.
    pub const ALL: [Arithmetic; 5] = [
        Arithmetic::F32,
        Arithmetic::F32Cell,
        Arithmetic::Textbook,
        Arithmetic::F64,
        Arithmetic::Exact,
    ];

    /// Those in which every detector must find exactly the pairs that the contact test accepts.
    /// Textbook filters promise no such thing.
    pub const SAFE: [Arithmetic; 4] =
        [Arithmetic::F32, Arithmetic::F32Cell, Arithmetic::F64, Arithmetic::Exact];

    /// Its name, what it means, and how scenes are stored and tested.
    const fn entry(self) -> (&'static str, &'static str, Storage, Test) {
        match self {
            Arithmetic::F32 => {
                let words = "scene stored in f32, contacts decided in f32";
                ("f32", words, Storage::F32, Test::Rounded)
            }
            Arithmetic::F32Cell => {
                let words = "coordinates as cell number and f32 offset from the cell's origin, \
                             contacts decided in f32";
                ("f32-cell", words, Storage::Cell, Test::Rounded)
            }
            Arithmetic::Textbook => {
                let words =
                    "f64, with the book's filters as printed: may lose contacts to rounding";
                ("textbook", words, Storage::F64, Test::Textbook)
            }
            Arithmetic::F64 => {
                let words = "scene stored and contacts decided in f64";
                ("f64", words, Storage::F64, Test::Rounded)
            }
            Arithmetic::Exact => {
                let words = "scene stored in f64, contacts decided exactly (the default)";
                ("exact", words, Storage::F64, Test::Exact)
            }
        }
    }

    /// The name used in records and on the command line.
    pub const fn name(self) -> &'static str {
        self.entry().0
    }

    /// The meaning, in a phrase.
    pub fn summary(self) -> &'static str {
        self.entry().1
    }

    /// All names, for messages.
    pub fn names() -> String {
        Arithmetic::ALL.map(Arithmetic::name).join(", ")
    }

    /// How a scene that is stored for this arithmetic is tested.
    pub const fn test(self) -> Test {
        self.entry().3
    }

    /// In which number format it stores a scene.
    pub const fn storage(self) -> Storage {
        self.entry().2
    }

    /// One of [`Arithmetic::SAFE`]?
    pub fn is_safe(self) -> bool {
        Arithmetic::SAFE.contains(&self)
    }
}

/// In which number format centres and radii are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// Rounded to f32.
    F32,
    /// As given.
    F64,
    /// By cells: a cell number, and an offset from the cell's origin in f32.
    Cell,
}

impl From<Arithmetic> for Storage {
    fn from(arithmetic: Arithmetic) -> Storage {
        arithmetic.storage()
    }
}

impl std::fmt::Display for Arithmetic {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// A name that no arithmetic has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no arithmetic '{0}'; the arithmetics are: {names}", names = Arithmetic::names())]
pub struct UnknownArithmetic(pub String);

impl std::str::FromStr for Arithmetic {
    type Err = UnknownArithmetic;

    fn from_str(name: &str) -> Result<Arithmetic, UnknownArithmetic> {
        Arithmetic::ALL
            .into_iter()
            .find(|arithmetic| arithmetic.name() == name)
            .ok_or_else(|| UnknownArithmetic(name.into()))
    }
}

/// Whether the filters of a detection may lose pairs to rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Margin {
    /// They lose none.
    Safe,
    /// As printed in the book: cells of edge d, found by i = Int((x - xmin) / d), where rounding
    /// may separate a touching pair.
    Textbook,
}

/// How a stored scene is tested for contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Test {
    /// Rounded in the scene's own precision.
    Rounded,
    /// Rounded, with filters that have no safety margin.
    Textbook,
    /// The exact sign for the stored numbers.
    Exact,
}

impl Test {
    /// What a rounded test asks of filters; `None` for the exact test.
    pub fn margin(self) -> Option<Margin> {
        match self {
            Test::Rounded => Some(Margin::Safe),
            Test::Textbook => Some(Margin::Textbook),
            Test::Exact => None,
        }
    }

    /// The same contact test with filters that lose nothing, by which answers are judged.
    pub fn safe(self) -> Test {
        if self == Test::Textbook { Test::Rounded } else { self }
    }
}
