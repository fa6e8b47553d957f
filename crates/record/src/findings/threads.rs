//! Speed-up by threads, compared with what the machine allows.
//!
//! All values are ratios within a block. The speed-up is the time with one thread over that with k
//! threads. The ceiling is k times the time of one copy alone over the time of k single-threaded
//! copies at once. The fraction of the ceiling is the time of the copies over k times the time with
//! k threads. It can exceed 1, because k threads share their caches on one scene, and k copies
//! share nothing.

use std::collections::BTreeMap;

use crate::cells::series::{Line, Seeds};
use crate::cells::{Cell, series};
use crate::record::row::Outcome;
use crate::stats::interval::{Interval, median};

#[derive(Clone, Debug, PartialEq)]
pub struct Threads {
    pub typical: Vec<Typical>,
    pub gains: Vec<Gain>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Typical {
    pub name: String,
    pub scenes: usize,
    pub speedup: f64,
    pub least: f64,
    pub most: f64,
    pub fraction: Option<f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Gain {
    pub experiment: String,
    pub scene: String,
    pub n: u64,
    pub line: Line,
    pub name: String,
    pub speedup: Interval,
    pub ceiling: Option<Interval>,
    pub fraction: Option<Interval>,
    pub failure: Option<(Outcome, String)>,
}

impl Threads {
    pub fn new(cells: &[&Cell]) -> Option<Threads> {
        let (label, mut gains) = (series::labels(cells), Vec::new());
        for group in series::groups(cells) {
            for n in group.sizes() {
                for line in group.lines.keys().filter(|line| line.threads > 1) {
                    let alone = Line { threads: 1, ..line.clone() };
                    let both = group.at(line, n).zip(group.at(&alone, n));
                    let gain = both.and_then(|(many, one)| {
                        gain(&group.title, n, line, label(&alone), one, many)
                    });
                    gains.extend(gain);
                }
            }
        }
        let mut by_line: BTreeMap<&Line, Vec<&Gain>> = BTreeMap::new();
        gains.iter().for_each(|gain| by_line.entry(&gain.line).or_default().push(gain));
        let typical =
            by_line.into_iter().filter_map(|(line, gains)| typical(label(line), &gains)).collect();
        (!gains.is_empty()).then_some(Threads { typical, gains })
    }
}

/// Returns the gain by threads; `None` unless all cells ended well.
fn gain(
    scene: &str,
    n: u64,
    line: &Line,
    name: String,
    one: &Seeds<'_>,
    many: &Seeds<'_>,
) -> Option<Gain> {
    series::time(many).and(series::time(one))?;
    let k = f64::from(line.threads);
    Some(Gain {
        experiment: many.first()?.id.experiment.clone(),
        scene: scene.to_string(),
        n,
        line: line.clone(),
        name,
        speedup: series::ratio(one, many)?,
        ceiling: series::ratio_of(many, |cell| &cell.alone_ns, many, |cell| &cell.copies_ns)
            .map(|ratio| ratio.scaled(k)),
        fraction: series::ratio_of(many, |cell| &cell.copies_ns, many, |cell| &cell.times)
            .map(|ratio| ratio.scaled(1.0 / k)),
        failure: many.iter().find_map(|cell| cell.copies_failure.clone()),
    })
}

fn typical(name: String, gains: &[&Gain]) -> Option<Typical> {
    let speedups: Vec<f64> = gains.iter().map(|gain| gain.speedup.median).collect();
    let fractions: Vec<f64> = gains.iter().filter_map(|gain| Some(gain.fraction?.median)).collect();
    Some(Typical {
        name,
        scenes: speedups.len(),
        speedup: median(&speedups)?,
        least: speedups.iter().copied().fold(f64::INFINITY, f64::min),
        most: speedups.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        fraction: median(&fractions),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::testing::Lab;
    use crate::record::row::Pass;

    #[test]
    fn speedup_ceiling_and_fraction_are_paired() {
        let mut lab = Lab::new("e", "packed");
        // The machine slows down from block to block; ratios stay the same.
        let times = |unit: u64| (1..=15).map(|block| unit * (100 + block)).collect::<Vec<u64>>();
        lab.detector("direct").time(&times(12)).count(&[]);
        assert_eq!(lab.find(Threads::new), None);
        lab.threads(2).time(&times(8)).copies(&times(12), &times(15));
        lab.threads(4).time(&times(6)).fail(Pass::Ceiling, Outcome::OutOfMemory, "no room for 4");
        lab.threads(1).detector("nbs").time(&times(1));
        let good = lab.find(|cells| cells.iter().all(|cell| cell.overall().0 == Outcome::Ok));
        assert!(good, "failed copies are not the detector's failure");
        let found = lab.find(Threads::new).unwrap();
        let is = |found: Interval, value: f64| {
            let ends = [found.low, found.median, found.high];
            assert!(
                found.count == 15 && ends.iter().all(|v| (v - value).abs() < 1e-9),
                "{found:?}"
            );
        };
        let [two, four] = &*found.gains else { panic!("{found:?}") };
        assert_eq!((&*two.scene, &*two.name, two.line.threads), ("packed, 2D", "direct", 2));
        is(two.speedup, 12.0 / 8.0);
        is(two.ceiling.unwrap(), 2.0 * 12.0 / 15.0);
        is(two.fraction.unwrap(), 15.0 / (2.0 * 8.0));
        is(four.speedup, 2.0);
        assert_eq!((four.ceiling, four.fraction, &two.failure), (None, None, &None));
        assert_eq!(four.failure, Some((Outcome::OutOfMemory, "no room for 4".into())));
        let first = &found.typical[0];
        assert_eq!((&*first.name, first.scenes), ("direct (2 threads)", 1));
        for (value, expected) in
            [(first.speedup, 1.5), (first.most, 1.5), (first.fraction.unwrap(), 15.0 / 16.0)]
        {
            assert!((value - expected).abs() < 1e-9, "{first:?}");
        }
    }
}
