//! Speed-up by threads, compared with what the machine allows.
//!
//! All values are ratios within a block. The speed-up is the time with one thread over that with k
//! threads. The ceiling is k times the time of one copy alone over the time of k single-threaded
//! copies at once. The fraction of the ceiling is the time of the copies over k times the time with
//! k threads. It can exceed 1, because k threads share their caches on one scene, and k copies
//! share nothing.

use crate::cells::series::{Group, Line};
use crate::cells::{Cell, series};
use crate::record::row::Outcome;
use crate::stats::interval::Interval;

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

pub fn gains(cells: &[&Cell]) -> Vec<Gain> {
    let (label, mut gains) = (series::labels(cells), Vec::new());
    for group in series::groups(cells) {
        for n in group.sizes() {
            for line in group.lines.keys().filter(|line| line.threads > 1) {
                gains.extend(gain(&group, n, line, label));
            }
        }
    }
    gains
}

/// Returns the gain by threads; `None` unless all cells ended well.
fn gain(group: &Group<'_>, n: u64, line: &Line, label: impl Fn(&Line) -> String) -> Option<Gain> {
    let alone = Line { threads: 1, ..line.clone() };
    let (many, one) = (group.at(line, n)?, group.at(&alone, n)?);
    series::time(many).and(series::time(one))?;
    let k = f64::from(line.threads);
    Some(Gain {
        experiment: many.first()?.id.experiment.clone(),
        scene: group.title.clone(),
        n,
        line: line.clone(),
        name: label(&alone),
        speedup: series::ratio(one, many)?,
        ceiling: series::ratio_of(many, |cell| &cell.alone_ns, many, |cell| &cell.copies_ns)
            .map(|ratio| ratio.scaled(k)),
        fraction: series::ratio_of(many, |cell| &cell.copies_ns, many, |cell| &cell.times)
            .map(|ratio| ratio.scaled(1.0 / k)),
        failure: many.iter().find_map(|cell| cell.copies_failure.clone()),
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
        assert_eq!(lab.find(gains), []);
        lab.threads(2).time(&times(8)).copies(&times(12), &times(15));
        lab.threads(4).time(&times(6)).fail(Pass::Ceiling, Outcome::OutOfMemory, "no room for 4");
        lab.threads(1).detector("nbs").time(&times(1));
        let good = lab.find(|cells| cells.iter().all(|cell| cell.overall().0 == Outcome::Ok));
        assert!(good, "failed copies are not the detector's failure");
        let found = lab.find(gains);
        let is = |found: Interval, value: f64| {
            let ends = [found.low, found.median, found.high];
            assert!(
                found.count == 15 && ends.iter().all(|v| (v - value).abs() < 1e-9),
                "{found:?}"
            );
        };
        let [two, four] = &*found else { panic!("{found:?}") };
        assert_eq!((&*two.scene, &*two.name, two.line.threads), ("packed, 2D", "direct", 2));
        is(two.speedup, 12.0 / 8.0);
        is(two.ceiling.unwrap(), 2.0 * 12.0 / 15.0);
        is(two.fraction.unwrap(), 15.0 / (2.0 * 8.0));
        is(four.speedup, 2.0);
        assert_eq!((four.ceiling, four.fraction, &two.failure), (None, None, &None));
        assert_eq!(four.failure, Some((Outcome::OutOfMemory, "no room for 4".into())));
    }
}
