//! Tables of a report: each detector at the largest N, what did not end well and why, and the noise floor.

use std::collections::{BTreeMap, BTreeSet};

use super::interval::{Interval, ratio};
use super::keyed::MACHINE;
use super::value::{Cell, Key};
use super::{fit, place, text};
use crate::detect::table::{self, Role};
use crate::harness::record::Pass;
use crate::probe::Op;

/// A heading and a Markdown table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The heading.
    pub title: String,
    /// The table, in Markdown.
    pub markdown: String,
}

/// The detector that `name` is the twin of. Records of other builds may hold twins that the table does not know: the name tells.
pub fn twin_of(name: &str) -> Option<&str> {
    match table::find(name).map(|entry| entry.role) {
        Some(Role::Twin(base)) => Some(base),
        Some(_) => None,
        None => name.strip_suffix("-twin"),
    }
}

/// True for controls: the detector that does nothing, and twins.
pub fn is_control(name: &str) -> bool {
    twin_of(name).is_some() || table::find(name).is_some_and(|entry| entry.role == Role::Nothing)
}

/// Some of all detectors: `all`, `all but direct`, or the names.
pub fn group(names: &[&str], all: &[&str]) -> String {
    let others: Vec<&str> = all.iter().filter(|name| !names.contains(name)).copied().collect();
    match others.len() {
        0 => "all".into(),
        1 if names.len() > 2 => format!("all but {}", others[0]),
        _ => names.join(", "),
    }
}

/// `packed, 2D, N = 1000, s = 20`: of the parameters those that are swept; other fields where they are not the usual ones.
pub fn title(key: &Key, swept: &[String]) -> String {
    // Those of the scene's name are said by it.
    let params = key.params.iter().filter(|(name, _)| swept.contains(name) && !["path", MACHINE].contains(&name.as_str()));
    let params: String = params.map(|(name, value)| format!(", {name} = {value}")).collect();
    let order = if key.order == "shuffled" { String::new() } else { format!(", {}", key.order) };
    format!("{}, {}D, N = {}{params}{order}", place::scene(key), key.dim, key.n)
}

/// One table per scene and dimension, at its largest N (and the last parameters and the first seed there).
pub fn largest(cells: &[&Cell]) -> Vec<Table> {
    let mut scenes: BTreeMap<_, Vec<&Cell>> = BTreeMap::new();
    for cell in cells {
        scenes.entry(place::family(&cell.key)).or_default().push(cell);
    }
    scenes.values().filter_map(|cells| at_largest(cells)).collect()
}

/// Who won where: per scene and dimension, at its largest N, the fastest detector and by how much; undecided where the interval holds 1 or
/// the ratio is within the noise floor. `None` without times.
pub fn winners(cells: &[&Cell]) -> Option<String> {
    let mut scenes: BTreeMap<_, Vec<&Cell>> = BTreeMap::new();
    for cell in cells.iter().filter(|cell| !is_control(&cell.key.detector) && cell.time().is_some()) {
        scenes.entry(place::family(&cell.key)).or_default().push(cell);
    }
    let (floor, mut rows) = (floor(cells), Vec::new());
    for cells in scenes.values() {
        let swept = place::swept(cells);
        let Some((key, mut cells)) = last_scene(cells) else { continue };
        let median = |cell: &Cell| cell.time().map_or(f64::INFINITY, |time| time.median);
        cells.sort_by(|a, b| median(a).total_cmp(&median(b)));
        let (first, second) = (cells[0], cells.get(1));
        let margin = second.and_then(|second| ratio(&second.times, &first.times).map(|ratio| (named(second), ratio)));
        let margin = margin.map_or("alone".into(), |(name, ratio)| {
            let undecided = if ratio.excludes(1.0) && ratio.median > floor { "" } else { ": undecided" };
            format!("{name} takes {} times as long{undecided}", with_interval(&ratio))
        });
        rows.push(vec![title(&key, &swept), named(first), text::number(median(first) / key.n.max(1) as f64), margin]);
    }
    (!rows.is_empty()).then(|| text::markdown_table(&["scene", "fastest", ">ns / N", "next"], &rows))
}

/// `nbs (exact)`, and its threads where they are not one.
fn named(cell: &Cell) -> String {
    let threads = if cell.key.threads > 1 { format!(", {} threads", cell.key.threads) } else { String::new() };
    format!("{} ({}{threads})", cell.key.detector, cell.key.arithmetic)
}

/// The cells of the largest N, and among those of the last parameters and the first seed.
pub(crate) fn last_scene<'a>(cells: &[&'a Cell]) -> Option<(Key, Vec<&'a Cell>)> {
    let scene = |key: &Key| (key.n, key.params.clone(), key.order.clone(), std::cmp::Reverse(key.seed));
    let last = cells.iter().map(|cell| scene(&cell.key)).max()?;
    let cells: Vec<&Cell> = cells.iter().copied().filter(|cell| scene(&cell.key) == last).collect();
    Some((cells.first()?.key.clone(), cells))
}

fn at_largest(cells: &[&Cell]) -> Option<Table> {
    let swept = place::swept(cells);
    let (key, mut cells) = last_scene(cells)?;
    let median = |cell: &Cell| cell.time().map_or(f64::INFINITY, |time| time.median);
    cells.sort_by(|a, b| median(a).total_cmp(&median(b)));
    let fastest = cells.iter().find(|cell| !is_control(&cell.key.detector) && median(cell).is_finite()).copied();
    let several = |field: &str| cells.iter().map(|cell| cell.key.field(field)).collect::<BTreeSet<_>>().len() > 1;
    let (arithmetic, threads, n) = (several("arithmetic"), several("threads"), key.n.max(1) as f64);
    let per = |value: Option<f64>| value.map_or("–".into(), |value| text::number(value / n));
    let row = |cell: &&Cell| {
        let mut name = cell.key.detector.clone();
        if arithmetic {
            name += &format!(" {}", cell.key.arithmetic);
        }
        if threads {
            name += &format!(" ({})", text::plural(cell.key.threads as usize, "thread"));
        }
        let versus = match (fastest, cell.time()) {
            (Some(fastest), Some(_)) if fastest.key == cell.key => "1".into(),
            (Some(fastest), Some(_)) => ratio(&cell.times, &fastest.times).map_or("–".into(), |ratio| with_interval(&ratio)),
            _ => "–".into(),
        };
        let sum = |names: [&str; 3]| names.iter().map(|name| cell.variable(name, None)).sum::<Option<f64>>();
        let (outcome, _) = cell.overall();
        // In brackets: of a wrong answer.
        let time = match cell.wrong_time() {
            Some(time) => format!("({})", per(Some(time))),
            None => per(cell.time().map(|time| time.median)),
        };
        vec![
            name,
            time,
            cell.times.len().to_string(),
            versus,
            per(cell.variable("contact_test", None)),
            per(sum(["list_push", "list_step", "list_reset"])),
            per(cell.variable("peak_bytes", None)),
            per(cell.variable("formula_bytes", None)),
            outcome.name().into(),
        ]
    };
    let heads = [
        "detector",
        ">ns / N",
        ">blocks",
        ">time / fastest",
        ">contact tests / N",
        ">list ops / N",
        ">peak bytes / N",
        ">by formula / N",
        "outcome",
    ];
    Some(Table { title: title(&key, &swept), markdown: text::markdown_table(&heads, &cells.iter().map(row).collect::<Vec<_>>()) })
}

/// `1.25 (1.20 to 1.31)`.
pub fn with_interval(ratio: &Interval) -> String {
    let digits = if ratio.median < 10.0 { 2 } else { 1 };
    format!("{:.digits$} ({:.digits$} to {:.digits$})", ratio.median, ratio.low, ratio.high)
}

/// How the operations of each detector grow with N: exponent and law, fitted to exact counts. `None` with fewer than two N.
pub fn growth(cells: &[&Cell]) -> Option<String> {
    let mut series: BTreeMap<Key, Vec<(f64, f64)>> = BTreeMap::new();
    // Operations are counted with one thread whatever the times are taken with.
    let again = |cell: &Cell| cells.iter().any(|other| cell.key.threads > 1 && other.key == Key { threads: 1, ..cell.key.clone() });
    let counted = |cell: &&&Cell| !is_control(&cell.key.detector) && cell.outcome(&[Pass::Count]).0.is_good() && !again(cell);
    for cell in cells.iter().filter(counted) {
        let operations = Op::ALL.into_iter().map(|op| cell.variable(op.name(), None)).sum::<Option<f64>>();
        if let Some(operations) = operations.filter(|&operations| operations > 0.0) {
            series.entry(cell.key.clone().without("n").without("seed")).or_default().push((cell.key.n as f64, operations));
        }
    }
    series.retain(|_, points| points.iter().any(|point| point.0 != points[0].0));
    let more = place::varying(cells).into_iter().filter(|name| !["scene", "dim", "n", "seed", "detector"].contains(&name.as_str()));
    let fields: Vec<String> = ["scene".to_string(), "dim".to_string()].into_iter().chain(more).collect();
    let row = |(key, points): (&Key, &Vec<(f64, f64)>)| {
        let choice = fit::choose(points);
        let exponent = choice.slope.map_or("–".into(), |s| format!("{:.3} ({:.3} to {:.3})", s.exponent, s.low, s.high));
        let law = choice.model.map_or_else(|| format!("cannot tell: {}", choice.why), |model| model.name().into());
        let delta = choice.delta().map_or("–".into(), |delta| format!("{delta:.0}"));
        vec![place::place(key, &fields), key.detector.clone(), exponent, law, delta]
    };
    let rows: Vec<Vec<String>> = series.iter().map(row).collect();
    (!rows.is_empty()).then(|| text::markdown_table(&["scene", "detector", ">exponent", "law", ">ΔAICc to the next"], &rows))
}

/// Every cell that did not end well: one line per detector, scene and outcome, with the N and the first reason.
pub fn not_ok(cells: &[&Cell]) -> Option<String> {
    // detector, scene, outcome: N and reason
    type Group<'a> = (String, String, &'a str);
    let mut groups: BTreeMap<Group, Vec<(u64, &str)>> = BTreeMap::new();
    for cell in cells {
        let (outcome, reason) = cell.overall();
        if !outcome.is_good() {
            let scene = format!("{} {}D", place::scene(&cell.key), cell.key.dim);
            groups.entry((named(cell), scene, outcome.name())).or_default().push((cell.key.n, reason));
        }
    }
    let row = |((detector, scene, outcome), found): (&Group, &Vec<(u64, &str)>)| {
        let sizes: BTreeSet<u64> = found.iter().map(|(n, _)| *n).collect();
        let reasons: BTreeSet<&str> = found.iter().map(|(_, reason)| *reason).collect();
        let mut reason = found.first().map_or("", |first| first.1).to_string();
        if reasons.len() > 1 {
            reason += &format!(" (and {} like it)", text::plural(reasons.len() - 1, "reason"));
        }
        let sizes: Vec<String> = sizes.iter().map(u64::to_string).collect();
        vec![detector.clone(), scene.clone(), sizes.join(", "), (*outcome).into(), reason]
    };
    let rows: Vec<Vec<String>> = groups.iter().map(row).collect();
    (!rows.is_empty()).then(|| text::markdown_table(&["detector", "scene", ">N", "outcome", "reason"], &rows))
}

/// Twins with their originals, and the ratios of their times in all cells.
fn twins<'a>(cells: &[&'a Cell]) -> BTreeMap<(&'a str, &'static str), Vec<Interval>> {
    let by_key: BTreeMap<&Key, &Cell> = cells.iter().map(|cell| (&cell.key, *cell)).collect();
    let mut found: BTreeMap<_, Vec<Interval>> = BTreeMap::new();
    for &cell in cells {
        let Some(Role::Twin(base)) = table::find(&cell.key.detector).map(|entry| entry.role) else { continue };
        let original = by_key.get(&Key { detector: base.into(), ..cell.key.clone() });
        let good = |cell: &Cell| cell.outcome(&[Pass::Time]).0.is_good();
        if let Some(original) = original.filter(|original| good(original) && good(cell)) {
            found.entry((cell.key.detector.as_str(), base)).or_default().extend(ratio(&cell.times, &original.times));
        }
    }
    found
}

/// The noise floor: nine in ten cells of a twin are within this factor of the original; 1 without twins.
pub fn floor(cells: &[&Cell]) -> f64 {
    let mut apart: Vec<f64> = twins(cells).into_values().flatten().map(|ratio| ratio.median.ln().abs()).collect();
    apart.sort_by(f64::total_cmp);
    apart.get((apart.len() * 9 / 10).min(apart.len().saturating_sub(1))).map_or(1.0, |log| log.exp())
}

/// What two measurements of the same code differ by: every twin against its original, cell by cell, in one sentence per twin.
pub fn noise(cells: &[&Cell]) -> Vec<String> {
    let found = twins(cells);
    let sentence = |((twin, base), ratios): (&(&str, &str), &Vec<Interval>)| {
        let worst = ratios.iter().max_by(|a, b| a.median.ln().abs().total_cmp(&b.median.ln().abs()))?;
        let typical = super::interval::median(&ratios.iter().map(|ratio| ratio.median.ln().abs()).collect::<Vec<_>>())?;
        let outside = ratios.iter().filter(|ratio| ratio.excludes(1.0)).count();
        let expected = 100.0 * ratios.iter().map(|ratio| 1.0 - ratio.coverage).sum::<f64>() / ratios.len() as f64;
        Some(format!(
            "{twin} against {base}, the same code measured twice, in {}: typically {} apart, at worst a ratio of {}; {outside} of {} \
             intervals exclude 1 (about {expected:.1}% would by chance). Nine in ten cells are within a factor of {:.2}: a smaller \
             difference between detectors is called undecided.",
            text::plural(ratios.len(), "cell"),
            text::percent(typical.exp_m1()),
            with_interval(worst),
            ratios.len(),
            floor(cells)
        ))
    };
    found.iter().filter_map(sentence).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{csv, errors, fake::Lab, value};
    use super::*;
    use crate::harness::record::{Errors, Outcome};

    #[test]
    fn tables_show_ratio_noise_errors_and_what_failed() {
        let mut lab = Lab::new("e", "packed");
        lab.n(1000).detector("nbs").time(&[1000; 15]).count(&[("contact_test", 6000), ("list_push", 2000)]).memory(20_000, 21_000);
        lab.detector("nbs-twin").time(&[1010; 15]);
        lab.detector("sorting").time(&[2500; 15]).edit(|row| row.errors = Some(Errors { missed: 3, ..Errors::default() }));
        lab.detector("direct").fail(Pass::Time, Outcome::Timeout, "30 s, the limit");
        lab.n(10).detector("direct").time(&[5]);
        let cells = value::cells(&lab.rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let tables = largest(&all);
        assert_eq!(tables.len(), 1);
        assert_eq!(tables[0].title, "packed, 2D, N = 1000");
        let lines: Vec<&str> = tables[0].markdown.lines().collect();
        assert_eq!(lines[2], "| nbs | 1 | 15 | 1 | 6 | 2 | 20 | 21 | ok |");
        assert!(lines[4].starts_with("| sorting | 2.500 | 15 | 2.50 (2.50 to 2.50) | – |"), "{}", lines[4]);
        assert!(lines[5].ends_with("| timeout |"));
        assert!(not_ok(&all).is_some_and(|table| table.contains("| direct (exact) | packed 2D | 1000 | timeout | 30 s, the limit |")));
        let noise = noise(&all);
        assert!(noise[0].contains("typically 1.0% apart") && noise[0].contains("1 of 1 intervals exclude 1"), "{noise:?}");
        let errors = errors::table(&all).unwrap();
        assert!(errors.contains("| all | exact | packed 2D | 2500 | – | – | – | 3 / 0 | 0.1% | 0 r | – |  |"), "{errors}");
        let csv = csv::csv(&cells);
        assert_eq!(csv.lines().count(), 6);
        assert!(csv.contains("\"30 s, the limit\""), "{csv}");
    }
}
