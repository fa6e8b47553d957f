//! Everybody's time as a multiple of one detector's: paired within blocks, per scene and N, and whether that detector is near the best.

use std::fmt::Write as _;

use super::grid::{self, Group, Line};
use super::interval::Interval;
use super::summary::{Table, is_control, with_interval};
use super::text;
use super::value::Cell;
use crate::contact::Arithmetic;
use crate::harness::record::Outcome;

/// A detector that takes at most so many times the time of the fastest is near it.
pub const NEAR: f64 = 1.2;

/// The columns of `ratios.csv`.
const HEAD: &str = "experiment,scene,n,detector,arithmetic,threads,outcome,time_ns_median,ratio,low,high,blocks,reference,\
    reference_arithmetic,reason\n";

/// The comparison with one detector.
pub struct Ratios {
    /// One sentence: where the reference is near the best.
    pub headline: String,
    /// One line per scene and N: who is the fastest, and whether the reference is near it. Markdown.
    pub fastest: String,
    /// A table per scene.
    pub tables: Vec<Table>,
    /// Who has no answer, and why.
    pub missing: Vec<String>,
    /// All of it, one line per contender, scene and N, without a head.
    pub lines: String,
}

/// `ratios.csv` of these lines.
pub fn csv(lines: &str) -> String {
    HEAD.to_string() + lines
}

/// Is the reference near the fastest?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Near {
    Fastest,
    Yes,
    No,
    Unknown,
    Absent,
}

/// Compares; none if the reference has no time anywhere. It is taken with its fewest threads, in the arithmetic of the one that it is
/// compared with, or else in exact arithmetic.
pub fn of(cells: &[&Cell], reference: &str) -> Option<Ratios> {
    let groups = grid::groups(cells);
    let label = |line: &Line| grid::label(line, cells);
    let (mut rows, mut tables, mut lines, mut near) = (Vec::new(), Vec::new(), String::new(), Vec::new());
    for group in &groups {
        tables.extend(group.table(&[], label, |line, n| entry(group, line, n, reference)));
        for n in group.sizes() {
            let Some((first, time)) = group.fastest(n) else { continue };
            let (how, ratio) = distance(group, first, n, reference);
            near.push((how, ratio, format!("{}, N = {n}", group.title)));
            let word = match how {
                Near::Fastest => "it is the fastest".into(),
                Near::Yes => "yes".into(),
                Near::No => "**no**".into(),
                Near::Unknown => "cannot tell".into(),
                Near::Absent => outcome_of(group, n, reference).to_string(),
            };
            let ratio = ratio.map_or("–".into(), |ratio| with_interval(&ratio));
            rows.push(vec![group.title.clone(), n.to_string(), label(first), text::number(time / n.max(1) as f64), ratio, word]);
        }
        csv_lines(&mut lines, group, reference);
    }
    if near.iter().all(|(how, ..)| *how == Near::Absent) {
        return None;
    }
    let heads = ["scene", ">N", "fastest", ">ns / N", &format!(">{reference} / fastest"), &format!("within {NEAR}?")];
    // The verdicts are words of ours: their stars are meant.
    let fastest = text::markdown_table(&heads, &rows).replace("\\*\\*no\\*\\*", "**no**");
    Some(Ratios { headline: headline(reference, &near), fastest, tables, missing: grid::missing(cells), lines })
}

fn headline(reference: &str, near: &[(Near, Option<Interval>, String)]) -> String {
    let count = |wanted: &[Near]| near.iter().filter(|(how, ..)| wanted.contains(how)).count();
    let mut out = format!(
        "**{reference} is within {NEAR} times the time of the fastest detector in {} of {}** (one thread; itself the fastest in {})",
        count(&[Near::Fastest, Near::Yes]),
        text::plural(near.len(), "scene"),
        count(&[Near::Fastest])
    );
    for (how, words) in [(Near::No, "not in"), (Near::Unknown, "undecided in"), (Near::Absent, "without an answer in")] {
        if count(&[how]) > 0 {
            let _ = write!(out, ", {words} {}", count(&[how]));
        }
    }
    let ratios = near.iter().filter_map(|(_, ratio, at)| Some((ratio.as_ref()?, at)));
    if let Some((worst, at)) = ratios.max_by(|a, b| a.0.median.total_cmp(&b.0.median)) {
        let _ = write!(out, "; at worst {} on {}", with_interval(worst), text::escape(at));
    }
    out + "."
}

/// The line that `line` is compared with in its group: as few threads as there are, and the same arithmetic if there is one.
fn base<'a>(group: &'a Group<'_>, line: &Line, reference: &str) -> Option<&'a Line> {
    let known = group.lines.keys().filter(|known| known.detector == reference);
    known.min_by_key(|known| (known.arithmetic != line.arithmetic, known.arithmetic != Arithmetic::Exact.name(), known.threads))
}

/// The ratio of a line to its base, whatever the line's outcome; none unless the base is right.
fn against(group: &Group<'_>, line: &Line, n: u64, reference: &str) -> Option<Interval> {
    let base = group.at(base(group, line, reference)?, n)?;
    grid::time(base)?;
    grid::ratio(group.at(line, n)?, base)
}

/// The text in a table, and the value to sort by.
fn entry(group: &Group<'_>, line: &Line, n: u64, reference: &str) -> Option<(String, Option<f64>)> {
    let cells = group.at(line, n)?;
    let (outcome, _) = grid::outcome(cells);
    let ratio = against(group, line, n, reference);
    Some(match (outcome, ratio) {
        (Outcome::Wrong, Some(ratio)) => (format!("wrong [{:.2}]", ratio.median), None),
        (outcome, _) if !outcome.is_good() => (outcome.name().into(), None),
        (_, Some(_)) if base(group, line, reference) == Some(line) => {
            (format!("1 = {} ns / N", text::number(grid::time(cells)? / n.max(1) as f64)), Some(1.0))
        }
        (Outcome::Lossy, Some(ratio)) => (format!("{} lossy", with_interval(&ratio)), Some(ratio.median)),
        (_, Some(ratio)) => (with_interval(&ratio), Some(ratio.median)),
        // It has a time, but nothing to compare it with.
        (_, None) => (format!("{} ns / N", text::number(grid::time(cells)? / n.max(1) as f64)), None),
    })
}

/// How far the reference is from the fastest.
fn distance(group: &Group<'_>, first: &Line, n: u64, reference: &str) -> (Near, Option<Interval>) {
    let able = |line: &&Line| line.detector == reference && group.at(line, n).is_some_and(|cells| grid::time(cells).is_some());
    let line = group.lines.keys().filter(able).min_by_key(|line| (line.threads, line.arithmetic != first.arithmetic));
    let Some(line) = line else { return (Near::Absent, None) };
    if line == first {
        return (Near::Fastest, None);
    }
    let ratio = group.at(line, n).zip(group.at(first, n)).and_then(|(a, b)| grid::ratio(a, b));
    let near = match ratio {
        Some(ratio) if ratio.count > 1 && ratio.high <= NEAR => Near::Yes,
        Some(ratio) if ratio.count > 1 && ratio.low > NEAR => Near::No,
        _ => Near::Unknown,
    };
    (near, ratio)
}

fn outcome_of<'a>(group: &Group<'_>, n: u64, reference: &str) -> &'a str {
    let line = group.lines.keys().find(|line| line.detector == reference && group.at(line, n).is_some());
    line.and_then(|line| group.at(line, n)).map_or("not measured", |cells| grid::outcome(cells).0.name())
}

fn csv_lines(out: &mut String, group: &Group<'_>, reference: &str) {
    for (line, sizes) in &group.lines {
        for (n, cells) in sizes {
            let (outcome, reason) = grid::outcome(cells);
            let ratio = against(group, line, *n, reference);
            let number = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
            let short = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:.4}"));
            let base = base(group, line, reference);
            let role = if is_control(&line.detector) { "control" } else { outcome.name() };
            let fields = [
                cells.first().map_or(String::new(), |cell| cell.key.experiment.clone()),
                group.title.clone(),
                n.to_string(),
                line.detector.clone(),
                line.arithmetic.clone(),
                line.threads.to_string(),
                if outcome.is_good() { role.into() } else { outcome.name().to_string() },
                number(grid::time(cells)),
                short(ratio.map(|ratio| ratio.median)),
                short(ratio.map(|ratio| ratio.low)),
                short(ratio.map(|ratio| ratio.high)),
                number(ratio.map(|ratio| ratio.count as f64)),
                reference.to_string(),
                base.map_or(String::new(), |base| base.arithmetic.clone()),
                reason.to_string(),
            ];
            *out += &fields.map(|field| text::quote(&field)).join(",");
            out.push('\n');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{fake::Lab, value};
    use super::*;
    use crate::harness::record::Pass;

    fn lab() -> Lab {
        let mut lab = Lab::new("e", "packed");
        for (n, screening, sorting) in [(100, 125, 300), (1000, 110, 250)] {
            lab.n(n).arithmetic("exact");
            lab.detector("nbs").time(&[100 * n; 15]).detector("nbs-twin").time(&[101 * n; 15]);
            lab.detector("screening").time(&[screening * n; 15]).detector("sorting").time(&[sorting * n; 15]);
            lab.detector("nothing").time(&[1; 15]).edit(|row| row.outcome = Outcome::Control);
            // The fastest of all, but wrong; and a peer that is not there, in an arithmetic of its own.
            lab.detector("direct").time(&[50 * n; 15]).edit(|row| row.outcome = Outcome::Wrong);
            lab.arithmetic("f64").detector("peer").fail(Pass::Time, Outcome::Unavailable, &format!("get it, {n}"));
            lab.detector("other").time(&[80 * n; 15]);
        }
        lab
    }

    #[test]
    fn ratios_are_paired_sorted_and_without_wrong_winners() {
        let cells = value::cells(&lab().rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let found = of(&all, "nbs").unwrap();
        assert_eq!(found.tables.len(), 1);
        let lines: Vec<&str> = found.tables[0].markdown.lines().skip(2).collect();
        assert_eq!(lines[0], "| other (f64) | 0.80 (0.80 to 0.80) | 0.80 (0.80 to 0.80) |");
        assert_eq!(lines[1], "| nbs (exact) | 1 = 100 ns / N | 1 = 100 ns / N |");
        assert_eq!(lines[3], "| screening (exact) | 1.25 (1.25 to 1.25) | 1.10 (1.10 to 1.10) |");
        assert!(lines.contains(&"| direct (exact) | wrong \\[0.50\\] | wrong \\[0.50\\] |"), "{lines:?}");
        assert!(lines.contains(&"| peer (f64) | unavailable | unavailable |") && lines.len() == 7, "{lines:?}");
        assert_eq!(found.missing[1], "peer (f64): unavailable in 2 cells: get it, 100");
        assert!(found.fastest.contains("| packed, 2D | 1000 | other (f64) | 80 | 1.25 (1.25 to 1.25) | **no** |"), "{}", found.fastest);
        assert!(found.headline.contains("in 0 of 2 scenes** (one thread; itself the fastest in 0), not in 2"), "{}", found.headline);
        let csv = csv(&found.lines);
        assert_eq!(csv.lines().count(), 1 + 2 * 7);
        assert!(csv.contains("e,\"packed, 2D\",100,direct,exact,1,wrong,,0.5000,0.5000,0.5000,15,nbs,exact,\n"), "{csv}");
    }

    #[test]
    fn near_is_decided_by_the_interval() {
        let mut lab = Lab::new("e", "packed");
        for (n, other) in [(10, [100; 15]), (20, [90; 15]), (30, [50; 15]), (40, [0; 15].map(|_| 84))] {
            lab.n(n).detector("nbs").time(&[100; 15]).detector("screening").time(&other);
        }
        // Half the blocks here, half there.
        let spread: Vec<u64> = (0..15).map(|k| if k % 2 == 0 { 60 } else { 95 }).collect();
        lab.n(50).detector("nbs").time(&[100; 15]).detector("screening").time(&spread);
        lab.n(60).detector("nbs").fail(Pass::Time, Outcome::Timeout, "30 s").detector("screening").time(&[5; 15]);
        lab.n(5).detector("nbs").time(&[100; 15]).detector("screening").time(&[101; 15]);
        let cells = value::cells(&lab.rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let found = of(&all, "nbs").unwrap();
        let verdicts: Vec<&str> = found.fastest.lines().skip(2).filter_map(|line| line.split(" | ").last()).collect();
        assert_eq!(verdicts[0], "it is the fastest |");
        assert_eq!(verdicts[2..], ["yes |", "**no** |", "yes |", "cannot tell |", "timeout |"]);
        assert!(found.headline.contains("not in 1, undecided in 1, without an answer in 1; at worst 2.00"), "{}", found.headline);
        assert!(of(&all, "sorting").is_none());
    }

    #[test]
    fn seeds_are_compared_with_their_own_and_threads_with_one() {
        let mut lab = Lab::new("e", "packed");
        for (seed, scale) in [(1, 1), (2, 10), (3, 100)] {
            lab.seed(seed).detector("nbs").time(&[100 * scale; 15]);
            lab.detector("direct").time(&[200 * scale; 15]);
            lab.detector("nbs").time(&[60 * scale; 15]);
        }
        let mut rows = lab.rows();
        rows.iter_mut().filter(|row| row.time_ns.is_some_and(|time| [60, 600, 6000].contains(&time))).for_each(|row| row.threads = 2);
        let cells = value::cells(&rows);
        let all: Vec<&Cell> = cells.iter().collect();
        let table = &of(&all, "nbs").unwrap().tables[0].markdown;
        assert!(table.contains("| direct | 2.00 (2.00 to 2.00) |"), "{table}");
        assert!(table.contains("| nbs (2 threads) | 0.60 (0.60 to 0.60) |") && table.contains("| nbs | 1 = 10 ns / N |"), "{table}");
    }
}
