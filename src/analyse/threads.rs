//! What several threads gain, against what the machine lets them gain.
//!
//! Of each block: the speed-up is the time with one thread over that with k. The ceiling is the throughput of k copies with one thread
//! each, at work together, over that of one alone: k times the time alone over the time beside the others. Their quotient is the fraction
//! of the ceiling that was reached. A detector can pass the ceiling: k threads on one scene share their caches, k copies share nothing.

use std::fmt::Write as _;

use super::grid::{self, Line, Seeds};
use super::interval::{Interval, median};
use super::summary::with_interval;
use super::text;
use super::value::Cell;

/// The columns of `threads.csv`.
const HEAD: &str = "experiment,scene,n,detector,arithmetic,threads,speedup,speedup_low,speedup_high,ceiling,ceiling_low,ceiling_high,\
    fraction,fraction_low,fraction_high,blocks,reason\n";

/// What threads gain.
pub struct Threads {
    /// A sentence per detector and number of threads.
    pub sentences: Vec<String>,
    /// One line per scene, N and detector, in Markdown.
    pub table: String,
    /// The same as CSV, without a head.
    pub lines: String,
}

/// `threads.csv` of these lines.
pub fn csv(lines: &str) -> String {
    HEAD.to_string() + lines
}

/// Speed-up, ceiling and the fraction of it, of k threads against one.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// Time with one thread over time with k.
    pub speedup: Option<Interval>,
    /// The throughput of k copies over that of one.
    pub ceiling: Option<Interval>,
    /// The first over the second.
    pub fraction: Option<Interval>,
}

fn scaled(interval: Interval, by: f64) -> Interval {
    Interval { median: by * interval.median, low: by * interval.low, high: by * interval.high, ..interval }
}

impl Gain {
    /// Of the same detector with one thread and with k, all cells having ended well.
    pub fn of(one: &Seeds<'_>, many: &Seeds<'_>, k: u32) -> Gain {
        let k = f64::from(k);
        Gain {
            speedup: grid::ratio(one, many),
            ceiling: grid::ratio_of(one, |cell| &cell.times, many, |cell| &cell.beside).map(|ratio| scaled(ratio, k)),
            fraction: grid::ratio_of(many, |cell| &cell.beside, many, |cell| &cell.times).map(|ratio| scaled(ratio, 1.0 / k)),
        }
    }
}

/// Where a detector was timed with one thread and with several; none if nowhere.
pub fn of(cells: &[&Cell]) -> Option<Threads> {
    let (mut rows, mut lines) = (Vec::new(), String::new());
    let mut typical: std::collections::BTreeMap<Line, Vec<(f64, Option<f64>)>> = Default::default();
    for group in grid::groups(cells) {
        for n in group.sizes() {
            for (line, sizes) in group.lines.iter().filter(|(line, _)| line.threads > 1) {
                let alone = Line { threads: 1, ..line.clone() };
                let (Some(many), Some(one)) = (sizes.get(&n), group.at(&alone, n)) else { continue };
                if grid::time(many).is_none() || grid::time(one).is_none() {
                    continue;
                }
                let gain = Gain::of(one, many, line.threads);
                let Some(speedup) = gain.speedup else { continue };
                typical.entry(line.clone()).or_default().push((speedup.median, gain.fraction.map(|fraction| fraction.median)));
                let reason = many.iter().find_map(|cell| cell.alone.as_ref());
                let or_reason = |value: Option<Interval>| match (value, reason) {
                    (Some(value), _) => with_interval(&value),
                    (None, Some((outcome, _))) => outcome.name().into(),
                    (None, None) => "–".into(),
                };
                rows.push(vec![
                    group.title.clone(),
                    n.to_string(),
                    grid::label(&alone, cells),
                    line.threads.to_string(),
                    with_interval(&speedup),
                    or_reason(gain.ceiling),
                    gain.fraction.map_or("–".into(), |fraction| percents(&fraction)),
                ]);
                let three = |value: Option<Interval>| match value {
                    Some(value) => format!("{:.4},{:.4},{:.4}", value.median, value.low, value.high),
                    None => ",,".into(),
                };
                let experiment = many.first().map_or("", |cell| cell.key.experiment.as_str());
                let _ = writeln!(
                    lines,
                    "{},{},{n},{},{},{},{},{},{},{},{}",
                    text::quote(experiment),
                    text::quote(&group.title),
                    text::quote(&line.detector),
                    line.arithmetic,
                    line.threads,
                    three(gain.speedup),
                    three(gain.ceiling),
                    three(gain.fraction),
                    speedup.count,
                    text::quote(reason.map_or("", |reason| reason.1.as_str()))
                );
            }
        }
    }
    let sentences = typical.iter().filter_map(|(line, found)| sentence(line, found, cells)).collect();
    let heads = ["scene", ">N", "detector", ">threads", ">speed-up", ">ceiling", ">fraction of the ceiling"];
    (!rows.is_empty()).then(|| Threads { sentences, table: text::markdown_table(&heads, &rows), lines })
}

fn sentence(line: &Line, found: &[(f64, Option<f64>)], cells: &[&Cell]) -> Option<String> {
    let speedups: Vec<f64> = found.iter().map(|found| found.0).collect();
    let (low, high) = speedups.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    let mut out = format!("**{}: {:.2} times as fast as one thread**", text::escape(&grid::label(line, cells)), median(&speedups)?);
    let _ = write!(out, " (median of {}; {low:.2} to {high:.2})", text::plural(speedups.len(), "scene"));
    let fractions: Vec<f64> = found.iter().filter_map(|found| found.1).collect();
    if let Some(fraction) = median(&fractions) {
        let _ = write!(out, ", {} of what the machine lets as many copies gain", text::percent(fraction));
    }
    Some(out + ".")
}

/// `93% (91% to 96%)`.
pub fn percents(fraction: &Interval) -> String {
    format!("{} ({} to {})", text::percent(fraction.median), text::percent(fraction.low), text::percent(fraction.high))
}

#[cfg(test)]
mod tests {
    use super::super::{fake::Lab, value};
    use super::*;
    use crate::harness::record::{Outcome, Pass};

    #[test]
    fn speedup_ceiling_and_fraction_are_paired() {
        let mut lab = Lab::new("e", "packed");
        // The machine slows down from block to block; the ratios stay.
        let times = |unit: u64| (1..=15).map(|block| unit * (100 + block)).collect::<Vec<u64>>();
        lab.detector("direct").time(&times(12)).count(&[]);
        lab.threads(2).time(&times(8)).beside(&times(15));
        lab.threads(4).time(&times(6)).fail(Pass::Ceiling, Outcome::OutOfMemory, "no room for 4");
        lab.threads(1).detector("nbs").time(&times(1));
        let cells = value::cells(&lab.rows());
        assert!(cells.iter().all(|cell| cell.overall().0 == Outcome::Ok), "failed copies are not the detector's failure");
        let all: Vec<&Cell> = cells.iter().collect();
        let found = of(&all).unwrap();
        let lines: Vec<&str> = found.table.lines().skip(2).collect();
        // 12 / 8; 2 * 12 / 15; 15 / (2 * 8)
        assert_eq!(lines[0], "| packed, 2D | 100 | direct | 2 | 1.50 (1.50 to 1.50) | 1.60 (1.60 to 1.60) | 94% (94% to 94%) |");
        assert_eq!(lines[1], "| packed, 2D | 100 | direct | 4 | 2.00 (2.00 to 2.00) | out-of-memory | – |");
        assert_eq!(lines.len(), 2);
        assert!(found.sentences[0].starts_with("**direct (2 threads): 1.50 times as fast as one thread** (median of 1 scene"));
        assert!(found.sentences[0].ends_with("94% of what the machine lets as many copies gain."), "{:?}", found.sentences);
        assert!(csv(&found.lines).contains(",15,no room for 4\n"));
        let sequential: Vec<&Cell> = cells.iter().filter(|cell| cell.key.threads == 1).collect();
        assert!(of(&sequential).is_none());
    }
}
