//! The times of a cell in two records, and the verdict on them.

use super::{Against, Options, Record};
use crate::cells::Cell;
use crate::stats::interval::{Blocks, COVERAGE, Interval, median};
use crate::stats::unpaired;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Judgement {
    /// B takes more: the interval excludes 1, and the ratio is beyond what equal code differs by.
    Slower,
    Faster,
    /// Neither is shown; or there are too few blocks.
    Undecided,
    /// The whole interval lies within the band. It may exclude 1.
    #[serde(rename = "within-the-band")]
    WithinBand,
    /// Not of one machine, or not of one kind of build; or the detector that it is taken against
    /// has no times.
    NotJudged,
}

impl Judgement {
    pub fn name(self) -> &'static str {
        match self {
            Judgement::Slower => "slower",
            Judgement::Faster => "faster",
            Judgement::Undecided => "undecided",
            Judgement::WithinBand => "within the band",
            Judgement::NotJudged => "not judged",
        }
    }
}

#[derive(Clone, Debug)]
pub struct Timing {
    pub a_ns: f64,
    pub b_ns: f64,
    /// With a reference: the medians, in A and in B, of the multiples of its time in the same
    /// block. The ratio is of these.
    pub multiples: Option<[f64; 2]>,
    /// B over A; with a reference, each first divided by the reference's time in the same block.
    pub ratio: Interval,
    pub judgement: Judgement,
    pub note: Option<Note>,
    /// A slowdown by this factor would have been found here, nearly always.
    pub least: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    Builds,
    Machines,
    Reference,
    /// The reference of this name has no times on this scene in both.
    NoReference(String),
    /// So many blocks in A and in B are too few for an interval.
    FewBlocks(usize, usize),
    /// Two runs without a control that both have.
    NoControl,
    /// This twin moved by this factor, though it is equal code.
    Twin(String, f64),
}

/// Equal sources of a detector, built twice, differ by up to this factor by where the linker puts
/// the code: in 5 of 36 cells, on a quiet machine (docs/COMPARE.md). A floor from one binary cannot
/// show that, so no floor between two builds is lower.
pub const PLACEMENT: f64 = 1.07;

impl Timing {
    /// A difference is shown, and it is smaller than what counts.
    pub fn is_small(&self) -> bool {
        self.judgement == Judgement::WithinBand && self.ratio.excludes(1.0)
    }

    /// Could these times have been judged, whatever the verdict?
    pub fn is_decidable(&self) -> bool {
        self.judgement != Judgement::NotJudged && self.ratio.coverage >= COVERAGE
    }
}

pub(super) fn timing(
    (a, in_a): (&Record, &Cell),
    (b, in_b): (&Record, &Cell),
    options: &Options,
) -> Option<Timing> {
    let (a_ns, b_ns) = (in_a.time()?.median, in_b.time()?.median);
    if let Some(floors) = &options.side_by_side {
        let ratio = in_b.ratio(in_a)?;
        let noise = floors.get(&in_a.id.experiment)?;
        let n = in_a.id.n;
        let beyond = ratio.median.ln().abs() > PLACEMENT.ln() && noise.decides(&ratio, n);
        let judgement = judge(&ratio, options.band, beyond);
        let few = Note::FewBlocks(in_a.times.len(), in_b.times.len());
        let note = (ratio.coverage < COVERAGE).then_some(few);
        let least = least(&ratio, noise.floor_at(n).max(PLACEMENT));
        let multiples = None;
        return Some(Timing { a_ns, b_ns, multiples, ratio, judgement, note, least });
    }
    let plain = |cell: &Cell| cell.times.values().map(|&t| t as f64).collect::<Vec<_>>();
    let mut times = (plain(in_a), plain(in_b));
    let mut multiples = None;
    let doubt = match &options.against {
        Some(Against { detector, .. }) if *detector == in_a.id.contender() => Some(Note::Reference),
        Some(Against { detector: name, .. }) => {
            match (a.reference(&in_a.id, name), b.reference(&in_b.id, name)) {
                (Some(to_a), Some(to_b)) if to_a.id == to_b.id => {
                    times =
                        (quotients(&in_a.times, &to_a.times), quotients(&in_b.times, &to_b.times));
                    multiples = Some([median(&times.0)?, median(&times.1)?]);
                    options.machines.as_ref().filter(|_| !options.across).map(|_| Note::Machines)
                }
                _ => Some(Note::NoReference(name.clone())),
            }
        }
        None => Some(options.machines.as_ref().map_or(Note::NoControl, |_| Note::Machines)),
    };
    let doubt = options.builds.as_ref().map(|_| Note::Builds).or(doubt);
    let ratio = unpaired::ratio(&times.0, &times.1)?;
    let drift = options.against.as_ref().and_then(|control| control.drift).unwrap_or(1.0);
    let beyond = ratio.excludes(1.0) && ratio.median.ln().abs() > drift.ln();
    let judgement =
        if doubt.is_some() { Judgement::NotJudged } else { judge(&ratio, options.band, beyond) };
    let few = Note::FewBlocks(times.0.len(), times.1.len());
    let note = doubt.or((ratio.coverage < COVERAGE).then_some(few));
    let least = least(&ratio, drift);
    Some(Timing { a_ns, b_ns, multiples, ratio, judgement, note, least })
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

/// A slowdown that would be found in about 97 of 100 runs: so much that its interval excludes 1
/// though its median is as low as this interval is (one by median / low is found in every other
/// run), and that such a median is beyond what equal code differs by.
fn least(ratio: &Interval, floor: f64) -> f64 {
    let luck = ratio.high / ratio.median;
    luck * (ratio.median / ratio.low).max(floor)
}

/// The whole interval decides, or nothing does. `beyond`: it excludes 1, and the ratio is larger
/// than what equal code differs by.
fn judge(ratio: &Interval, band: f64, beyond: bool) -> Judgement {
    if ratio.coverage < COVERAGE {
        Judgement::Undecided
    } else if 1.0 / (1.0 + band) <= ratio.low && ratio.high <= 1.0 + band {
        Judgement::WithinBand
    } else if beyond {
        if ratio.median > 1.0 { Judgement::Slower } else { Judgement::Faster }
    } else {
        Judgement::Undecided
    }
}
