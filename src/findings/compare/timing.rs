//! The times of a cell in two records, and the verdict on them.

use super::{Options, Record};
use crate::cells::Cell;
use crate::stats::interval::{Blocks, COVERAGE, Interval};
use crate::stats::unpaired;

/// What came of the times of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Judgement {
    /// B takes more: the whole interval lies beyond the band.
    Slower,
    /// B takes less.
    Faster,
    /// The interval is neither within the band nor beyond it; or there are too few blocks.
    Undecided,
    /// The whole interval lies within the band.
    Equal,
    /// Not of one machine, or not of one kind of build; or the detector that it is taken against
    /// has no times.
    NotJudged,
}

impl Judgement {
    /// The word in tables.
    pub fn name(self) -> &'static str {
        match self {
            Judgement::Slower => "slower",
            Judgement::Faster => "faster",
            Judgement::Undecided => "undecided",
            Judgement::Equal => "equal",
            Judgement::NotJudged => "not judged",
        }
    }
}

/// The times of a cell on both sides.
#[derive(Clone, Debug)]
pub struct Timing {
    /// Median nanoseconds per detection in A.
    pub a_ns: f64,
    /// The same in B.
    pub b_ns: f64,
    /// B over A; with a reference, each first divided by the reference's time in the same block.
    pub ratio: Interval,
    /// The verdict.
    pub judgement: Judgement,
    /// Why nothing else can be said, if so.
    pub note: Option<Note>,
}

/// Why times are not judged, or undecided.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// They are of two kinds of builds.
    Builds,
    /// They are of two machines.
    Machines,
    /// The cell is of the reference itself.
    Reference,
    /// The reference of this name has no times on this scene in both.
    NoReference(String),
    /// So many blocks in A and in B are too few for an interval.
    FewBlocks(usize, usize),
}

impl Timing {
    /// Could these times have been judged, whatever the verdict?
    pub fn is_decidable(&self) -> bool {
        self.judgement != Judgement::NotJudged && self.ratio.coverage >= COVERAGE
    }
}

/// The verdict on a cell; none without times in both.
pub(super) fn timing(
    (a, in_a): (&Record, &Cell),
    (b, in_b): (&Record, &Cell),
    options: &Options,
) -> Option<Timing> {
    let (a_ns, b_ns) = (in_a.time()?.median, in_b.time()?.median);
    let plain = |cell: &Cell| cell.times.values().map(|&t| t as f64).collect::<Vec<_>>();
    let mut times = (plain(in_a), plain(in_b));
    let doubt = match &options.against {
        Some(name) if *name == in_a.id.contender() => Some(Note::Reference),
        Some(name) => match (a.reference(&in_a.id, name), b.reference(&in_b.id, name)) {
            (Some(to_a), Some(to_b)) if to_a.id == to_b.id => {
                times = (quotients(&in_a.times, &to_a.times), quotients(&in_b.times, &to_b.times));
                None
            }
            _ => Some(Note::NoReference(name.clone())),
        },
        None => options.machines.as_ref().map(|_| Note::Machines),
    };
    let doubt = options.builds.as_ref().map(|_| Note::Builds).or(doubt);
    let ratio = unpaired::ratio(&times.0, &times.1)?;
    let judgement =
        if doubt.is_some() { Judgement::NotJudged } else { judge(&ratio, options.band) };
    let few = Note::FewBlocks(times.0.len(), times.1.len());
    let note = doubt.or((ratio.coverage < COVERAGE).then_some(few));
    Some(Timing { a_ns, b_ns, ratio, judgement, note })
}

/// Within a block both met the same state of the machine.
fn quotients(times: &Blocks, to: &Blocks) -> Vec<f64> {
    times
        .iter()
        .filter_map(|(block, &time)| {
            Some(time as f64 / to.get(block).filter(|&&to| to > 0).copied()? as f64)
        })
        .collect()
}

/// The whole interval decides, or nothing does.
fn judge(ratio: &Interval, band: f64) -> Judgement {
    let (low, high) = (1.0 / (1.0 + band), 1.0 + band);
    if ratio.coverage < COVERAGE {
        Judgement::Undecided
    } else if low <= ratio.low && ratio.high <= high {
        Judgement::Equal
    } else if ratio.low > high {
        Judgement::Slower
    } else if ratio.high < low {
        Judgement::Faster
    } else {
        Judgement::Undecided
    }
}
