//! Medians with exact intervals, and paired ratios of times.
//!
//! The interval of a median runs from one order statistic to another. Its coverage is exact for any
//! distribution, because the number of values below the median is binomial with p = 1/2. For 15
//! values, the 4th to the 12th cover the median in 96.5% of samples. (The percentile bootstrap is
//! too narrow at such sizes.) Ratios of two detectors are taken within a block, where the machine
//! is in the same state, which cancels slow drift. Their logarithms are summarised.

use std::collections::BTreeMap;

pub use contactbench_terms::interval::Interval;

/// Desired coverage. If there are too few values, the interval is the whole range, with its actual
/// coverage.
pub const COVERAGE: f64 = 0.95;

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut values: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The median of the finite values; for an even number, the mean of the middle two.
pub fn median(values: &[f64]) -> Option<f64> {
    middle(&sorted(values))
}

fn middle(sorted: &[f64]) -> Option<f64> {
    let half = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => sorted.get(half).copied(),
        _ => Some(sorted.get(half - 1)? / 2.0 + sorted.get(half)? / 2.0),
    }
}

/// The smallest value, the median, and the largest.
pub fn spread(values: &[f64]) -> Option<[f64; 3]> {
    let sorted = sorted(values);
    Some([*sorted.first()?, middle(&sorted)?, *sorted.last()?])
}

/// Median absolute deviation from the median, not scaled to a standard deviation.
pub fn mad(values: &[f64]) -> Option<f64> {
    let centre = median(values)?;
    median(&values.iter().map(|v| (v - centre).abs()).collect::<Vec<_>>())
}

pub fn interval(values: &[f64]) -> Option<Interval> {
    interval_at(values, COVERAGE)
}

fn interval_at(values: &[f64], wanted: f64) -> Option<Interval> {
    let values = sorted(values);
    let (rank, coverage) = rank(values.len(), wanted)?;
    Some(Interval {
        median: middle(&values)?,
        low: *values.get(rank - 1)?,
        high: *values.get(values.len() - rank)?,
        coverage,
        count: values.len(),
    })
}

/// The largest k such that the k-th smallest to the k-th largest of n values cover the median with
/// at least the wanted coverage, and the actual one. If the whole range covers less, k = 1.
fn rank(n: usize, wanted: f64) -> Option<(usize, f64)> {
    // Logarithms are used because 2^-n underflows for large n.
    let tails = (0..n.div_ceil(2)).scan(-(n as f64) * std::f64::consts::LN_2, |log, below| {
        let term = log.exp();
        *log += ((n - below) as f64 / (below + 1) as f64).ln();
        Some(term)
    });
    widest(tails, wanted).map(|(below, coverage)| (below + 1, coverage))
}

/// The number of values that can be left out at either end while coverage stays at least the
/// wanted one, and the coverage. `tails` are the probabilities that exactly 0, 1, ... values are
/// below the true one.
pub(super) fn widest(tails: impl Iterator<Item = f64>, wanted: f64) -> Option<(usize, f64)> {
    let (mut best, mut tail) = (None, 0.0);
    for (below, probability) in tails.enumerate() {
        tail += probability;
        let coverage = (1.0 - 2.0 * tail).max(0.0);
        if best.is_some() && coverage < wanted {
            break;
        }
        best = Some((below, coverage));
    }
    best
}

/// A block of a run, in which all subjects are timed once. A block that was interrupted and then
/// resumed counts as two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Block {
    /// Number of the block, from 1.
    pub number: u32,
    /// The span in which the block was timed; 0 if unknown.
    pub span: u32,
}

impl From<u32> for Block {
    fn from(number: u32) -> Block {
        Block { number, span: 0 }
    }
}

pub fn at_least(successes: usize, trials: usize, p: f64) -> f64 {
    let mut term = (1.0 - p).powi(trials as i32);
    let mut below = 0.0;
    for k in 0..successes.min(trials + 1) {
        below += term;
        term *= (trials - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
    }
    (1.0 - below).max(0.0)
}

pub type Blocks = BTreeMap<Block, u64>;

/// The ratio a / b of two detectors' times: the median over blocks, with its interval. Only blocks
/// with both times count.
pub fn ratio(a: &Blocks, b: &Blocks) -> Option<Interval> {
    typical_ratio(&[(a, b)])
}

/// Like [`ratio`], for several pairs (a, b). Pairs measured in one span share its blocks, and the
/// median of a block counts once. Scenes of several seeds have their own spans, so all ratios count.
pub fn typical_ratio(pairs: &[(&Blocks, &Blocks)]) -> Option<Interval> {
    typical_ratio_at(pairs, COVERAGE)
}

pub fn typical_ratio_at(pairs: &[(&Blocks, &Blocks)], coverage: f64) -> Option<Interval> {
    let mut blocks: BTreeMap<Block, Vec<f64>> = BTreeMap::new();
    for (a, b) in pairs {
        for (block, &a) in a.iter() {
            if let Some(&b) = b.get(block).filter(|&&b| a > 0 && b > 0) {
                blocks.entry(*block).or_default().push((a as f64).ln() - (b as f64).ln());
            }
        }
    }
    let logs: Vec<f64> = blocks.values().filter_map(|logs| median(logs)).collect();
    Some(interval_at(&logs, coverage)?.exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_those_of_the_binomial_table() {
        // n, k, and coverage in %, by hand from Pascal's triangle. For n = 15, it is
        // 1 - 2 (1 + 15 + 105 + 455) / 2^15.
        for (n, k, coverage) in [
            (1, 1, 0.0),
            (2, 1, 50.0),
            (3, 1, 75.0),
            (5, 1, 93.75),
            (6, 1, 96.875),
            (8, 1, 99.21875),
            (9, 2, 96.09375),
            (15, 4, 96.484375),
            (20, 6, 95.8610534667969),
        ] {
            let (rank, covered) = rank(n, COVERAGE).unwrap();
            assert_eq!(rank, k, "n = {n}");
            assert!((100.0 * covered - coverage).abs() < 1e-9, "n = {n}: {covered}");
        }
        assert_eq!(rank(0, COVERAGE), None);
        let (k, covered) = rank(5000, COVERAGE).unwrap();
        assert!((2400..2500).contains(&k) && (0.95..0.96).contains(&covered));
    }

    #[test]
    fn tails_are_those_of_the_binomial() {
        // By hand: (4 + 1) / 16 for three or four heads of four coins; 12.5% for 0 of 82 at 2.5%.
        assert!((at_least(3, 4, 0.5) - 5.0 / 16.0).abs() < 1e-12);
        assert!((at_least(1, 82, 0.025) - 0.8745).abs() < 1e-3);
        assert_eq!((at_least(0, 5, 0.1), at_least(6, 5, 0.1).abs() < 1e-12), (1.0, true));
    }

    #[test]
    fn fifteen_values_give_the_fourth_to_the_twelfth() {
        let values = [8, 3, 15, 1, 12, 5, 10, 2, 14, 7, 4, 13, 6, 11, 9].map(f64::from);
        let found = interval(&values).unwrap();
        assert_eq!((found.low, found.median, found.high, found.count), (4.0, 8.0, 12.0, 15));
        assert!(found.excludes(3.9) && !found.excludes(12.0));
        let double = found.scaled(2.0);
        assert_eq!((double.low, double.median, double.high), (8.0, 16.0, 24.0));
        assert_eq!((mad(&values), median(&[1.0, 4.0])), (Some(4.0), Some(2.5)));
        assert_eq!((median(&[f64::NAN]), interval(&[])), (None, None));
    }

    fn times(of: impl Fn(u64) -> u64) -> Blocks {
        (1..=15).map(|k: u32| (k.into(), of(k.into()))).collect()
    }

    #[test]
    fn a_ratio_is_paired_within_blocks() {
        let is = |found: Interval, value: f64| {
            [found.low, found.high].iter().all(|it| (it - value).abs() < 1e-12) && found.count == 15
        };
        // The machine slows down tenfold; b stays at 1.25 times a in every block.
        let (a, mut b) = (times(|k| 400 * k), times(|k| 500 * k));
        b.insert(99.into(), 7);
        assert!(is(ratio(&b, &a).unwrap(), 1.25));
        // Blocks of another span are not paired, even with equal numbers.
        let again = a.iter().map(|(block, &t)| (Block { span: 7, ..*block }, t)).collect();
        assert_eq!((ratio(&a, &again), ratio(&a, &Blocks::new())), (None, None));
        // The typical ratio is that of the median pair in each block.
        let [one, double, six] = [1, 2, 6].map(|factor| times(|k| factor * (100 + k)));
        assert!(is(typical_ratio(&[(&double, &one), (&one, &one), (&six, &one)]).unwrap(), 2.0));
        assert_eq!(typical_ratio(&[]), None);
    }
}
