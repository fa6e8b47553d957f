//! The ratio of two sets of times from different runs.
//!
//! All quotients of a time of one set and a time of the other are formed. The ratio is their median
//! (Hodges and Lehmann, 1963, on logarithms). The number of quotients below the true ratio is the
//! statistic of Mann and Whitney (1947). Its distribution is exact for any distribution of times,
//! if the two sets differ only by a factor and values are independent. So two of the sorted
//! quotients form an interval of known coverage.
//!
//! The interval covers the scatter within the two runs, but not differences between the runs, such
//! as clock speed or other load.

use crate::stats::interval::{COVERAGE, Interval, median, widest};

/// Largest number of quotients whose exact distribution is used, not a normal one.
const EXACT: usize = 10_000;

/// The ratio of a value of `b` to one of `a`, with its interval; values that are not positive are
/// left out. If there are too few values for [`COVERAGE`], the interval is the whole range, with
/// its actual coverage.
pub fn ratio(a: &[f64], b: &[f64]) -> Option<Interval> {
    let logs = |values: &[f64]| {
        values.iter().filter(|v| v.is_finite() && **v > 0.0).map(|v| v.ln()).collect::<Vec<f64>>()
    };
    let (a, b) = (logs(a), logs(b));
    let mut quotients: Vec<f64> = b.iter().flat_map(|b| a.iter().map(move |a| b - a)).collect();
    quotients.sort_by(f64::total_cmp);
    let (below, coverage) = tail(a.len(), b.len())?;
    Some(Interval {
        median: median(&quotients)?.exp(),
        low: quotients.get(below)?.exp(),
        high: quotients.get(quotients.len().checked_sub(below + 1)?)?.exp(),
        coverage,
        count: a.len().min(b.len()),
    })
}

/// Returns how many of the n·m sorted quotients can be left out at either end while coverage stays
/// at least [`COVERAGE`], and the coverage.
fn tail(n: usize, m: usize) -> Option<(usize, f64)> {
    if n == 0 || m == 0 {
        return None;
    }
    if n.checked_mul(m)? > EXACT {
        return Some(normal_tail(n as f64, m as f64));
    }
    let frequencies = mann_whitney(n, m);
    let all: f64 = frequencies.iter().sum();
    widest(frequencies.iter().map(|frequency| frequency / all), COVERAGE)
}

/// Mean nm/2, variance nm(n + m + 1)/12; 1.96 deviations, rounded outwards.
fn normal_tail(n: f64, m: f64) -> (usize, f64) {
    let deviation = (n * m * (n + m + 1.0) / 12.0).sqrt();
    ((n * m / 2.0 - 1.96 * deviation - 1.0).max(0.0) as usize, COVERAGE)
}

/// The number of orders of n and m values with a statistic of 0, 1, ..., nm. The statistic is the
/// sum of n positions chosen out of n + m, minus the smallest possible sum.
fn mann_whitney(n: usize, m: usize) -> Vec<f64> {
    let top = n * m;
    // ways[k][s]: k values chosen so far, s above the smallest sum. f64 is exact up to 2^53, and
    // close enough beyond.
    let mut ways = vec![vec![0.0; top + 1]; n + 1];
    ways[0][0] = 1.0;
    for place in 0..n + m {
        for k in (1..=n.min(place + 1)).rev() {
            // The k-th chosen value is at `place`, at least at k - 1.
            let above = place + 1 - k;
            if above <= m {
                for s in (above..=top).rev() {
                    ways[k][s] += ways[k - 1][s - above];
                }
            }
        }
    }
    ways.swap_remove(n)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn tails_are_those_of_the_printed_tables() {
        // Critical values of U for two-sided 5%: 4 and 4: 0; 5 and 5: 2; 8 and 8: 13; 10 and 10:
        // 23; 15 and 15: 64; 20 and 20: 127; 6 and 15: 19.
        for (n, m, critical) in [
            (4, 4, 0),
            (5, 5, 2),
            (8, 8, 13),
            (10, 10, 23),
            (15, 15, 64),
            (20, 20, 127),
            (6, 15, 19),
            (15, 6, 19),
        ] {
            let (below, coverage) = tail(n, m).unwrap();
            assert_eq!(below, critical, "{n} and {m}");
            assert!((COVERAGE..0.98).contains(&coverage), "{n} and {m}: {coverage}");
        }
        // By hand: 2 of the 20 orders of 3 and 3 values lie outside.
        let (below, coverage) = tail(3, 3).unwrap();
        assert!(below == 0 && (coverage - 0.9).abs() < 1e-12, "{below} {coverage}");
        assert_eq!(mann_whitney(2, 2), [1.0, 1.0, 2.0, 1.0, 1.0]);
        assert_eq!(tail(0, 5), None);
        let (exact, normal) = (tail(100, 100).unwrap().0, normal_tail(100.0, 100.0).0);
        assert!(normal <= exact && exact - normal < 20, "{exact} {normal}");
    }

    #[test]
    fn a_factor_is_found_and_covered() {
        let a: Vec<f64> = (0..15).map(|k| 100.0 + f64::from(k)).collect();
        let b: Vec<f64> = a.iter().map(|a| 1.5 * a).collect();
        let found = ratio(&a, &b).unwrap();
        assert!((found.median - 1.5).abs() < 1e-9 && found.count == 15, "{found:?}");
        assert!(1.4 < found.low && found.low < 1.5 && 1.5 < found.high && found.high < 1.6);
        assert_eq!(ratio(&[], &b), None);
        assert_eq!(ratio(&[0.0, f64::NAN], &b), None);
        // Skewed times (a minimum and rare delays), 15 and 12 values. 95% of 2000 intervals must
        // cover the true ratio.
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let mut time = || 100.0 * (1.0 - random.random::<f64>()).powf(-0.3);
        let covered = (0..2000).filter(|_| {
            let (a, b): (Vec<f64>, Vec<f64>) =
                ((0..15).map(|_| time()).collect(), (0..12).map(|_| 1.25 * time()).collect());
            let found = ratio(&a, &b).unwrap();
            found.low <= 1.25 && 1.25 <= found.high
        });
        assert!((1870..=1950).contains(&covered.count()));
    }
}
