//! The times of a cell in two records, and the verdict on them.

use super::{Options, Record};
use crate::cells::Cell;
use crate::stats::interval::{Blocks, COVERAGE, Interval, median};
use crate::stats::unpaired;

contactbench_terms::named! {
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Judgement {
        /// B takes longer: the interval excludes 1, and the ratio exceeds the noise of equal code.
        Slower = "slower",
        Faster = "faster",
        Undecided = "undecided",
        /// The whole interval lies within the band; it may exclude 1.
        #[serde(rename = "within-the-band")]
        WithinBand = "within the band",
        /// Times of different machines or kinds of builds, or a reference without times.
        NotJudged = "not judged",
    }
}

#[derive(Clone, Debug, serde::Serialize)]
pub struct Timing {
    pub a_ns: f64,
    pub b_ns: f64,
    /// Times divided by the reference's time in the same block: medians in A and in B. `None`
    /// without a reference.
    pub multiples: Option<[f64; 2]>,
    /// Time in B over time in A; with a reference, the ratio of the quotients in `multiples`.
    pub ratio: Interval,
    #[serde(rename = "verdict")]
    pub judgement: Judgement,
    /// Why this cell is undecided or not judged, if the reason is not that of all cells.
    pub note: String,
    /// A slowdown by this factor would nearly always have been detected.
    pub least: f64,
}

/// Lowest noise floor between two builds. Equal sources, built twice, differed by up to this factor
/// in 5 of 36 cells on a quiet machine, because the linker places code differently
/// (docs/COMPARE.md). Twins in one binary do not show this.
pub const PLACEMENT: f64 = 1.07;

impl Timing {
    pub fn is_small(&self) -> bool {
        self.judgement == Judgement::WithinBand && self.ratio.excludes(1.0)
    }

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
    let (mut multiples, mut doubt) = (None, None);
    let (ratio, floor, beyond);
    if let Some(floors) = &options.side_by_side {
        let (noise, n) = (floors.get(&in_a.id.experiment)?, in_a.id.n);
        ratio = in_b.ratio(in_a)?;
        floor = noise.floor_at(n).max(PLACEMENT);
        beyond = ratio.median.ln().abs() > PLACEMENT.ln() && noise.decides(&ratio, n);
    } else {
        let plain = |cell: &Cell| cell.times.values().map(|&t| t as f64).collect::<Vec<_>>();
        let mut times = [plain(in_a), plain(in_b)];
        doubt = (!options.judges()).then(String::new);
        let against = options.against.as_ref();
        if let Some(name) = against.map(|control| &control.detector) {
            match (a.reference(&in_a.id, name), b.reference(&in_b.id, name)) {
                _ if *name == in_a.id.subject() => doubt = Some("it is the reference".into()),
                (Some(to_a), Some(to_b)) if to_a.id == to_b.id => {
                    times =
                        [quotients(&in_a.times, &to_a.times), quotients(&in_b.times, &to_b.times)];
                    multiples = Some([median(&times[0])?, median(&times[1])?]);
                }
                _ => doubt = Some(format!("{name} has no times on this scene in both")),
            }
        }
        ratio = unpaired::ratio(&times[0], &times[1])?;
        floor = against.and_then(|control| control.drift).unwrap_or(1.0);
        beyond = ratio.excludes(1.0) && ratio.median.ln().abs() > floor.ln();
    }
    let judgement = match doubt {
        Some(_) => Judgement::NotJudged,
        None => judge(&ratio, options.band, beyond),
    };
    let few = (ratio.coverage < COVERAGE).then(|| format!("too few blocks: {}", ratio.count));
    let (note, least) = (doubt.or(few).unwrap_or_default(), least(&ratio, floor));
    Some(Timing { a_ns, b_ns, multiples, ratio, judgement, note, least })
}

/// Divides times of the same block, because these saw the same state of the machine.
fn quotients(times: &Blocks, to: &Blocks) -> Vec<f64> {
    let to = |block| to.get(block).filter(|&&to| to > 0);
    times.iter().filter_map(|(block, &time)| Some(time as f64 / *to(block)? as f64)).collect()
}

/// Returns the slowdown that about 97 of 100 runs would detect. A median at the low end of this
/// interval must still exceed `floor`, and its own interval must exclude 1. (A slowdown by median /
/// low is detected in every second run.)
fn least(ratio: &Interval, floor: f64) -> f64 {
    let luck = ratio.high / ratio.median;
    luck * (ratio.median / ratio.low).max(floor)
}

/// Judges by the whole interval. `beyond` means that the interval excludes 1, and that the ratio
/// exceeds the noise of equal code.
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
