//! Why a claim holds, fails or was not shown: the numbers behind a verdict.

use std::collections::BTreeMap;

use crate::findings::coverage::Uncovered;
use crate::record::row::Outcome;
use crate::stats::growth::{Doubt, Model, Slope, Tail};
use crate::stats::interval::Interval;

/// What was found of a claim, and what it was found without.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// The numbers.
    pub found: Found,
    /// True where they are of one machine.
    pub of_machine: bool,
    /// The cells that the claim is about and that could not enter.
    pub without: Option<Without>,
    /// Planned cells of the claim that are not there.
    pub uncovered: Option<Uncovered>,
    /// Smallest and largest time in nanoseconds per particle, if counts or bytes of one detector
    /// are claimed and its cells have times.
    pub time: Option<[f64; 2]>,
}

/// Cells that could not enter.
#[derive(Clone, Debug, PartialEq)]
pub struct Without {
    /// So many, by outcome; none of those that ended well has a value.
    pub outcomes: BTreeMap<Option<Outcome>, usize>,
    /// Of so many.
    pub of: usize,
}

/// A value, and the place of its cell among the cells of the claim.
#[derive(Clone, Debug, PartialEq)]
pub struct At {
    /// The value.
    pub value: f64,
    /// `nbs, packed, n = 1000`.
    pub place: String,
}

/// The numbers behind a verdict. Values come with the cells (`over`) or the one cell that they are
/// of.
#[derive(Clone, Debug, PartialEq)]
pub enum Found {
    /// No row is of this experiment.
    NoRows,
    /// No cell is selected.
    NoCell,
    /// None of the cells has a value.
    NoValue,
    /// None has both values that are to be compared.
    NoSides,
    /// It cannot be checked as it is written: why.
    Unusable(String),
    /// Answers are wrong.
    Wrong {
        /// In so many cells.
        cells: usize,
        /// Where first.
        first: String,
    },
    /// A detector of this program crashed.
    Crashed {
        /// Where first.
        first: String,
    },
    /// The only value of something that should be constant.
    Single(f64),
    /// The extremes of something that should be constant.
    Constant {
        /// The smallest.
        low: At,
        /// The largest.
        high: At,
        /// Largest over smallest, less one; none where the smallest is not positive.
        spread: Option<f64>,
        /// What the claim allows.
        within: f64,
        /// Over which cells.
        over: String,
    },
    /// Values against what they should be.
    Compared {
        /// True where they should be equal, false where they should be at most that.
        equal: bool,
        /// So many cells.
        cells: usize,
        /// So many that are not as claimed.
        bad: usize,
        /// The value that is worst or nearest to it.
        worst: At,
        /// What that should be.
        limit: f64,
        /// The relative difference.
        gap: f64,
        /// Over which cells.
        over: String,
    },
    /// Laws of growth.
    Growth {
        /// The law claimed.
        law: Model,
        /// The series that it fits.
        fitting: Option<Fitting>,
        /// Those that it does not, the decisive ones first.
        others: Vec<Series>,
    },
    /// Times over those of another detector.
    Faster {
        /// The other.
        than: String,
        /// How many times as fast is claimed.
        by: f64,
        /// So many cells.
        cells: usize,
        /// The smallest median ratio.
        low: f64,
        /// The largest.
        high: f64,
        /// Cells in which it is slower than that.
        slower: usize,
        /// Cells in which that is open.
        open: usize,
        /// The ratio that reaches highest.
        worst: Interval,
        /// Where that is.
        place: String,
    },
    /// There are no times of both.
    NoTimes {
        /// The other detector.
        than: String,
    },
}

/// Series that a law fits.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitting {
    /// So many.
    pub series: usize,
    /// The smallest and the largest free exponent.
    pub exponents: [f64; 2],
    /// By how much AICc is worse for the next law, at least.
    pub delta: f64,
}

/// A series that does not grow as claimed, or may not.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Where; empty for the only one.
    pub place: String,
    /// Its free exponent.
    pub slope: Option<Slope>,
    /// The law that fits, or why none does.
    pub law: Result<Model, Doubt>,
    /// Its exponent over the last octaves, where that is not the claimed law's.
    pub off: Option<Tail>,
}
