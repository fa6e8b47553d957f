//! Why a claim holds, fails or was not shown: the numbers behind a verdict, and their words.

use std::collections::BTreeMap;
use std::fmt;

use crate::findings::coverage::Uncovered;
use crate::record::row::Outcome;
use crate::stats::growth::{Doubt, LIMIT, Model, Slope, Tail};
use crate::stats::interval::Interval;
use contactbench_terms::number::{number, percent, plural, times, with_interval};

/// What was found of a claim, and what it was found without.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
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
    pub of: usize,
}

/// A value, and the place of its cell among the cells of the claim.
#[derive(Clone, Debug, PartialEq)]
pub struct At {
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
    NoCell,
    /// None of the cells has a value.
    NoValue,
    /// None has both values that are to be compared.
    NoSides,
    /// It cannot be checked as it is written: why.
    Unusable(String),
    Wrong {
        cells: usize,
        first: String,
    },
    /// A detector of this program crashed.
    Crashed {
        first: String,
    },
    /// The only value of something that should be constant.
    Single(f64),
    /// The extremes of something that should be constant.
    Constant {
        low: At,
        high: At,
        /// Largest over smallest, less one; none where the smallest is not positive.
        spread: Option<f64>,
        within: f64,
        over: String,
    },
    /// Values against what they should be.
    Compared {
        /// True where they should be equal, false where they should be at most that.
        equal: bool,
        cells: usize,
        /// So many that are not as claimed.
        bad: usize,
        /// The value that is worst or nearest to it.
        worst: At,
        limit: f64,
        gap: f64,
        over: String,
    },
    Growth {
        law: Model,
        /// The series that it fits.
        fitting: Option<Fitting>,
        /// Those that it does not, the decisive ones first.
        others: Vec<Series>,
    },
    /// Times over those of another detector.
    Faster {
        than: String,
        /// How many times as fast is claimed.
        by: f64,
        cells: usize,
        /// The smallest median ratio.
        low: f64,
        high: f64,
        /// Cells in which it is slower than that.
        slower: usize,
        /// Cells in which that is open.
        open: usize,
        /// The ratio that reaches highest.
        worst: Interval,
        place: String,
    },
    /// There are no times of both.
    NoTimes {
        than: String,
    },
}

/// Series that a law fits.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitting {
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
    pub slope: Option<Slope>,
    /// The law that fits, or why none does.
    pub law: Result<Model, Doubt>,
    /// Its exponent over the last octaves, where that is not the claimed law's.
    pub off: Option<Tail>,
}

/// Series that do not grow as claimed, said one by one.
const SERIES: usize = 3;

/// The numbers in a line.
impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&words(self))
    }
}

fn words(found: &Found) -> String {
    match found {
        Found::NoRows => "no rows of this experiment".into(),
        Found::NoCell => "no cell matches".into(),
        Found::NoValue => "no cell has a value".into(),
        Found::NoSides => "no cell has both sides".into(),
        Found::Unusable(why) => format!("cannot be checked: {why}"),
        Found::Wrong { cells, first } => {
            format!("wrong answers in {}, first at {first}", plural(*cells, "cell"))
        }
        Found::Crashed { first } => format!("a detector of this program crashed, first at {first}"),
        Found::Single(value) => {
            format!("{} in the only cell; a constant needs two", number(*value))
        }
        Found::Constant { low, high, spread, within, over } => {
            let range = format!("{} to {} over {over}", number(low.value), number(high.value));
            match spread {
                None => format!("{range}; the smallest is not positive"),
                Some(spread) if spread <= within => {
                    format!("{range} ({})", apart(*spread, *within))
                }
                Some(spread) => format!(
                    "{range} ({}, allowed {}); lowest at {}, highest at {}",
                    apart(*spread, *within),
                    apart(*within, *within),
                    low.place,
                    high.place
                ),
            }
        }
        Found::Compared { equal, cells, bad, worst, limit, gap, over } => {
            let (count, at) = (plural(*cells, "cell"), &worst.place);
            let (value, limit) = (number(worst.value), number(*limit));
            match (*bad, equal) {
                (0, true) if *gap == 0.0 => format!("exactly, in {count} over {over}"),
                (0, true) => format!("within {} in {count} over {over}", percent(*gap)),
                (0, false) => {
                    format!("in {count} over {over}; nearest: {value} against {limit} at {at}")
                }
                (bad, _) => {
                    let sign = if *equal { "differs from" } else { "exceeds" };
                    let by = match gap.is_finite() {
                        true => format!(" by {}", percent(*gap)),
                        false => String::new(),
                    };
                    format!("in {bad} of {count}; worst: {value} {sign} {limit}{by} at {at}")
                }
            }
        }
        Found::Growth { law, fitting, others } => {
            let mut parts: Vec<String> = Vec::new();
            if let Some(fitting) = fitting {
                let [low, high] = fitting.exponents;
                let range =
                    if low < high { format!("{low:.3} to {high:.3}") } else { format!("{low:.3}") };
                parts.push(format!(
                    "{} fits {} series: exponent {range}, ΔAICc {:.0} or more to the next law",
                    law.name(),
                    fitting.series,
                    fitting.delta
                ));
            }
            parts.extend(others.iter().take(SERIES).map(|other| series(other, law.name())));
            if others.len() > SERIES {
                parts.push(format!("and {} more series", others.len() - SERIES));
            }
            parts.join("; ")
        }
        Found::Faster { than, by, cells, low, high, slower, open, worst, place } => {
            let goal = if *by == 1.0 { "faster".into() } else { format!("{by} times as fast") };
            let tell = match (slower, open) {
                (0, 0) => "nearest to the limit".into(),
                (0, open) => format!("not shown in {open} of them, where noise hides it; worst"),
                (slower, 0) => format!("not {goal} in {slower} of them; worst"),
                (slower, open) => {
                    format!("not {goal} in {slower} of them, not shown in {open} more; worst")
                }
            };
            let cells = plural(*cells, "cell");
            format!(
                "{} to {} times the time of {than} in {cells}; {tell} {} at {place}",
                times(*low),
                times(*high),
                with_interval(worst)
            )
        }
        Found::NoTimes { than } => format!("no cell has times of both it and {than}"),
    }
}

/// How far a value is above another: in percent, or as a factor where that is allowed to be large.
fn apart(spread: f64, within: f64) -> String {
    match within >= 1.0 || spread >= 1.0 {
        true => format!("a factor of {}", number(1.0 + spread)),
        false => percent(spread),
    }
}

fn series(series: &Series, wanted: &str) -> String {
    let place = if series.place.is_empty() { String::new() } else { format!("{}: ", series.place) };
    let exponent = series.slope.map_or_else(String::new, |slope| {
        format!("exponent {:.3} [{:.3}, {:.3}], ", slope.exponent, slope.low, slope.high)
    });
    let law = match (series.law, series.off) {
        (Ok(law), _) if law.name() != wanted => format!("{} fits, not {wanted}", law.name()),
        (_, Some(Tail { sizes: [first, last], found, law })) => format!(
            "{found:.3} over n = {first}..{last}, where {wanted} has {law:.3}: {:.3} off, {LIMIT} \
             allowed",
            (found - law).abs()
        ),
        (Ok(_), None) => format!("{wanted} fits"),
        (Err(doubt), None) => format!("undecided: {doubt}"),
    };
    format!("{place}{exponent}{law}")
}
