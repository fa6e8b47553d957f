//! The number format in which a scene is stored, and how contacts are decided in it.

use serde::{Deserialize, Serialize};

crate::named! {
    /// How contacts are decided, and in which number format the scene is stored; from the least to
    /// the most accurate.
    #[derive(
        Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
    )]
    #[serde(rename_all = "kebab-case")]
    pub enum Arithmetic {
        /// The scene is rounded to f32; |xi - xj|² <= (ri + rj)² is evaluated in f32.
        F32 = "f32",
        /// Stored as f64 and decided in f64, with the filters as printed in the book. These have no
        /// safety margin, so contacts may be missed.
        Textbook = "textbook",
        /// Stored as f64; |xi - xj|² <= (ri + rj)² is evaluated in f64.
        F64 = "f64",
        /// Like [`Arithmetic::Exact`] with the open rule: pairs at exactly ri + rj do not touch.
        ExactOpen = "exact-open",
        /// Stored as f64 and decided by the exact sign of |xi - xj|² - (ri + rj)².
        #[default]
        Exact = "exact",
    }
}

impl Arithmetic {
    /// The arithmetics in which every detector must find exactly the pairs that the contact test
    /// accepts; all but [`Arithmetic::Textbook`].
    pub const SAFE: [Arithmetic; 4] =
        [Arithmetic::F32, Arithmetic::F64, Arithmetic::ExactOpen, Arithmetic::Exact];

    /// Summary, storage and contact test of each, in the order of `ALL`.
    const TABLE: [(&str, Storage, Test); 5] = [
        ("scene stored in f32, contacts decided in f32", Storage::F32, Test::Rounded),
        (
            "f64, with the book's filters as printed: may lose contacts to rounding",
            Storage::F64,
            Test::Textbook,
        ),
        ("scene stored and contacts decided in f64", Storage::F64, Test::Rounded),
        (
            "like exact, but pairs at exactly the distance ri + rj do not touch",
            Storage::F64,
            Test::Open,
        ),
        ("scene stored in f64, contacts decided exactly (the default)", Storage::F64, Test::Exact),
    ];

    /// Description in one phrase, for help and reports.
    pub fn summary(self) -> &'static str {
        Arithmetic::TABLE[self as usize].0
    }

    /// All names, separated by commas, for messages.
    pub fn names() -> String {
        Arithmetic::ALL.map(Arithmetic::name).join(", ")
    }

    /// How a scene stored for this arithmetic is tested for contacts.
    pub const fn test(self) -> Test {
        Arithmetic::TABLE[self as usize].2
    }

    /// The number format in which a scene is stored for this arithmetic.
    pub const fn storage(self) -> Storage {
        Arithmetic::TABLE[self as usize].1
    }

    /// The exact arithmetic with the same rule for pairs at exactly ri + rj: it states the truth.
    pub const fn exact(self) -> Arithmetic {
        match self {
            Arithmetic::ExactOpen => Arithmetic::ExactOpen,
            _ => Arithmetic::Exact,
        }
    }

    /// Whether contacts are decided without rounding.
    pub fn is_exact(self) -> bool {
        self == self.exact()
    }

    /// Whether this is one of [`Arithmetic::SAFE`].
    pub fn is_safe(self) -> bool {
        Arithmetic::SAFE.contains(&self)
    }
}

/// The number format in which centres and radii are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// Centres and radii rounded to f32.
    F32,
    /// Centres and radii as given, in f64.
    F64,
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

/// The error for an unknown name of an arithmetic.
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
    /// No pair of particles in contact is lost.
    Safe,
    /// The filters are those printed in the book, with cells of edge d that are found by i = Int((x
    /// - xmin) / d). Rounding may put two touching particles too many cells apart.
    Textbook,
}

/// How a stored scene is tested for contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Test {
    /// A rounded test, in the number format of the stored scene.
    Rounded,
    /// A rounded test, with filters that have no safety margin.
    Textbook,
    /// The exact sign of |xi - xj|² - (ri + rj)² for the stored numbers; particles touch if it is
    /// negative or 0.
    Exact,
    /// Like `Exact`, but particles touch only if the sign is negative, as in most neighbour lists.
    Open,
}

impl Test {
    /// The margin that filters need for this test; `None` for the exact test.
    pub fn margin(self) -> Option<Margin> {
        match self {
            Test::Rounded => Some(Margin::Safe),
            Test::Textbook => Some(Margin::Textbook),
            Test::Exact | Test::Open => None,
        }
    }

    /// Whether contacts are decided without rounding.
    pub fn is_exact(self) -> bool {
        self.margin().is_none()
    }

    /// The same contact test, but with filters that lose no pair. It judges answers.
    pub fn safe(self) -> Test {
        if self == Test::Textbook { Test::Rounded } else { self }
    }
}
