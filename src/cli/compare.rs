//! `contactbench compare`.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::ensure;
use serde_json::{Value, json};

use super::ci::{Case, Outcome, Outputs};
use crate::analyse::compare::{self, Compared, Judgement, Options};
use crate::analyse::interval::COVERAGE;
use crate::analyse::text;
use crate::harness::merge::Part;
use crate::harness::record::Row;

/// Options of `compare`.
#[derive(clap::Args)]
pub struct Compare {
    /// A result folder: before, or the first machine
    a: PathBuf,
    /// Another: after, or the second machine
    b: PathBuf,
    /// Compare times as multiples of this detector's in the same block: for two machines, or where the machine's speed drifts
    #[arg(long, value_name = "DETECTOR")]
    against: Option<String>,
    /// Percent by which times may differ and still be equal
    #[arg(long, value_name = "PERCENT", default_value_t = 5.0, allow_negative_numbers = true)]
    band: f64,
    /// The two are of one machine, though its name differs (containers often have new names)
    #[arg(long)]
    same_machine: bool,
    /// A cell that is slower is a failure
    #[arg(long)]
    gate_time: bool,
    /// A cell that is in one folder only, or not available in one, is a failure
    #[arg(long)]
    strict: bool,
    /// Show all cells, not only those that differ
    #[arg(long)]
    all: bool,
    /// Print JSON instead of tables
    #[arg(long, conflicts_with = "annotations")]
    json: bool,
    #[command(flatten)]
    ci: Outputs,
}

/// Both records compared; exit code 1 if something differs that is gated.
pub fn compare(options: &Compare) -> anyhow::Result<ExitCode> {
    ensure!((0.0..=1000.0).contains(&options.band), "--band {}: give percent from 0 to 1000", options.band);
    let parts = (Part::read(&options.a)?, Part::read(&options.b)?);
    for part in [&parts.0, &parts.1] {
        ensure!(!part.rows.is_empty(), "the record in {} holds no rows", part.folder.display());
        if let Some(name) = &options.against {
            ensure!(
                part.rows.iter().any(|row| row.detector == *name),
                "--against {name}: {} has no rows of this detector; its detectors are: {}",
                part.folder.display(),
                detectors(part)
            );
        }
        part.warnings.iter().for_each(|warning| eprintln!("{warning}"));
    }
    let machines = [machines(&parts.0), machines(&parts.1)];
    let how = Options {
        band: options.band / 100.0,
        against: options.against.clone(),
        machines: two_machines(&parts, &machines).filter(|_| !options.same_machine),
        builds: two_builds(&parts),
    };
    let (a, b) = common(&parts, &machines)?;
    let cells = compare::compare(&a, &b, &how);
    ensure!(
        cells.iter().any(|cell| cell.absent.as_ref().is_none_or(|why| !why.starts_with("only in"))),
        "{} and {} have no cell in common: they are results of different experiments or scenes",
        options.a.display(),
        options.b.display()
    );
    let judged = |timing: &compare::Timing| timing.judgement != Judgement::NotJudged && timing.ratio.coverage >= COVERAGE;
    ensure!(
        !options.gate_time || cells.iter().filter_map(|cell| cell.timing.as_ref()).any(judged),
        "--gate-time: no time could be judged ({}; an interval needs four blocks on either side); leave it out, or measure what can be compared",
        pairing(&how)
    );
    let cases: Vec<Case> = cells.iter().map(|cell| case(cell, options)).collect();
    let failed = cases.iter().filter(|case| matches!(case.result, Outcome::Failed(_))).count();
    let mut out = std::io::stdout().lock();
    if options.json {
        let text = serde_json::to_string_pretty(&as_json(options, &parts, &how, &cells, failed))?;
        writeln!(out, "{text}")?;
    } else {
        print(options, &machines, &how, &cells, failed, &mut out)?;
    }
    options.ci.write("compare", &cases, &mut out)?;
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn detectors(part: &Part) -> String {
    let names: BTreeSet<&str> = part.rows.iter().map(|row| row.detector.as_str()).collect();
    names.into_iter().collect::<Vec<_>>().join(", ")
}

fn machines(part: &Part) -> BTreeSet<String> {
    part.rows.iter().map(|row| row.machine.clone()).collect()
}

/// The rows to compare: where a record is of several machines, those of the machines that both have.
fn common(parts: &(Part, Part), machines: &[BTreeSet<String>; 2]) -> anyhow::Result<(Vec<Row>, Vec<Row>)> {
    if machines.iter().all(|names| names.len() == 1) {
        return Ok((parts.0.rows.clone(), parts.1.rows.clone()));
    }
    let both: BTreeSet<&String> = machines[0].intersection(&machines[1]).collect();
    let list = |names: &BTreeSet<String>| names.iter().cloned().collect::<Vec<_>>().join(", ");
    ensure!(
        !both.is_empty(),
        "{} is of the machines {}, {} of {}: compare folders of one machine each, or of the same",
        parts.0.folder.display(),
        list(&machines[0]),
        parts.1.folder.display(),
        list(&machines[1])
    );
    let of = |part: &Part| part.rows.iter().filter(|row| both.contains(&row.machine)).cloned().collect();
    Ok((of(&parts.0), of(&parts.1)))
}

/// Why times are of different machines, if they are. Machines are told apart by name, processor and number of cores.
fn two_machines(parts: &(Part, Part), machines: &[BTreeSet<String>; 2]) -> Option<String> {
    let describe = |part: &Part, name: &str| {
        let machine = part.machine(name);
        let shown = if name.is_empty() { "an unnamed machine" } else { name };
        match (&machine.cpu, machine.cores) {
            (Some(cpu), Some(cores)) => format!("{shown} ({cpu}, {})", text::plural(cores as usize, "core")),
            (Some(cpu), None) => format!("{shown} ({cpu})"),
            _ => shown.to_string(),
        }
    };
    let alone = machines.iter().all(|names| names.len() == 1);
    let (a, b) = (machines[0].first()?, machines[1].first()?);
    let differ = |a: &str, b: &str| !parts.0.machine(a).may_be(&parts.1.machine(b));
    if alone && differ(a, b) {
        return Some(format!("two machines: {} and {}", describe(&parts.0, a), describe(&parts.1, b)));
    }
    let shared = machines[0].intersection(&machines[1]).find(|name| differ(name, name));
    shared.filter(|_| !alone).map(|name| format!("two machines: {} and {}", describe(&parts.0, name), describe(&parts.1, name)))
}

/// Why times are of different builds, if they are.
fn two_builds(parts: &(Part, Part)) -> Option<String> {
    let profile = |part: &Part| Some(part.provenance.as_ref()?.get("profile")?.as_str()?.to_string());
    let (a, b) = (profile(&parts.0)?, profile(&parts.1)?);
    (a != b).then(|| format!("A is a {a} build, B a {b} build"))
}

/// What continuous integration is told of a cell.
fn case(cell: &Compared, options: &Compare) -> Case {
    let timing = cell.timing.as_ref();
    let slower = timing.filter(|timing| timing.judgement == Judgement::Slower);
    let words = |timing: &compare::Timing| format!("{}: B / A = {}", timing.judgement.name(), ratio(timing));
    let result = if !cell.changes.is_empty() {
        let changes: Vec<String> = cell.changes.iter().map(change).collect();
        Outcome::Failed(format!("changed: {}", changes.join("; ")))
    } else if let Some(why) = &cell.absent {
        if options.strict { Outcome::Failed(why.clone()) } else { Outcome::Skipped(why.clone()) }
    } else if !cell.lacks.is_empty() {
        let why = cell.lacks.join("; ");
        if options.strict { Outcome::Failed(why) } else { Outcome::Noted(why) }
    } else if let Some(timing) = slower {
        if options.gate_time { Outcome::Failed(words(timing)) } else { Outcome::Noted(words(timing)) }
    } else {
        Outcome::Passed
    };
    Case { class: format!("{}.{}", cell.key.experiment, cell.key.scene), name: cell.place.clone(), result }
}

fn change(change: &compare::Change) -> String {
    format!("{} {} -> {}", change.what, change.a, change.b)
}

fn ratio(timing: &compare::Timing) -> String {
    let ratio = &timing.ratio;
    format!("{:.3} ({:.3} to {:.3})", ratio.median, ratio.low, ratio.high)
}

/// How often each thing came of the cells.
fn counts(cells: &[Compared]) -> (usize, usize, BTreeMap<Judgement, usize>) {
    let mut judged = BTreeMap::new();
    cells.iter().filter_map(|cell| cell.timing.as_ref()).for_each(|timing| *judged.entry(timing.judgement).or_default() += 1);
    let changed = cells.iter().filter(|cell| !cell.changes.is_empty()).count();
    (changed, cells.iter().filter(|cell| cell.absent.is_some()).count(), judged)
}

/// In which way times were compared, in a sentence.
fn pairing(how: &Options) -> String {
    match (&how.against, &how.builds, &how.machines) {
        (_, Some(builds), _) => format!("{builds}: shown, not judged"),
        (Some(name), ..) => format!(
            "each a multiple of {name}'s in the same block; the multiples of the two folders are not paired. What changed {name} itself is hidden"
        ),
        (None, _, Some(machines)) => format!("{machines}: shown, not judged; --against DETECTOR compares multiples of its time"),
        (None, None, None) => {
            "not paired, because the folders were measured at different times: what else ran then is in the difference; --against DETECTOR takes most of it out"
                .into()
        }
    }
}

fn print(
    options: &Compare,
    machines: &[BTreeSet<String>; 2],
    how: &Options,
    cells: &[Compared],
    failed: usize,
    out: &mut impl Write,
) -> anyhow::Result<()> {
    for (name, folder, machines) in [("A", &options.a, &machines[0]), ("B", &options.b, &machines[1])] {
        writeln!(out, "{name}: {}, measured on {}", folder.display(), machines.iter().cloned().collect::<Vec<_>>().join(", "))?;
    }
    writeln!(out, "times: {}\n", pairing(how))?;
    for cell in cells.iter().filter(|cell| !cell.changes.is_empty()) {
        writeln!(out, "CHANGED  {}", cell.place)?;
        for found in &cell.changes {
            writeln!(out, "         {}", change(found))?;
        }
    }
    for cell in cells.iter().filter(|_| options.all || options.strict) {
        if let Some(why) = &cell.absent {
            writeln!(out, "absent   {}: {why}", cell.place)?;
        }
        if !cell.lacks.is_empty() {
            writeln!(out, "lacking  {}: {}", cell.place, cell.lacks.join("; "))?;
        }
    }
    let shown = |judgement| options.all || matches!(judgement, Judgement::Slower | Judgement::Faster);
    let mut rows = vec![["", "B / A", "A ns", "B ns", "cell"].map(String::from).to_vec()];
    let mut timed: Vec<(&compare::Timing, &str)> =
        cells.iter().filter_map(|cell| Some((cell.timing.as_ref()?, cell.place.as_str()))).filter(|(t, _)| shown(t.judgement)).collect();
    timed.sort_by(|a, b| a.0.judgement.cmp(&b.0.judgement).then(b.0.ratio.median.total_cmp(&a.0.ratio.median)));
    for (timing, place) in &timed {
        let place = if timing.note.is_empty() || how.builds.is_some() { place.to_string() } else { format!("{place}: {}", timing.note) };
        rows.push(vec![timing.judgement.name().into(), ratio(timing), text::number(timing.a_ns), text::number(timing.b_ns), place]);
    }
    if !timed.is_empty() {
        let widths: Vec<usize> = (0..5).map(|k| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0)).collect();
        writeln!(out, "{}", text::plain_table(&widths, &rows))?;
    }
    let (changed, absent, judged) = counts(cells);
    let verdict = if changed == 0 { "the same everywhere".into() } else { format!("CHANGED in {}", text::plural(changed, "cell")) };
    let lacking = cells.iter().filter(|cell| !cell.lacks.is_empty()).count();
    let lacking = if lacking == 0 { String::new() } else { format!(", {lacking} measured in part in one: see --all") };
    writeln!(
        out,
        "pairs, counts, bytes, outcomes: {verdict} ({} compared, {absent} in one only{lacking})",
        text::plural(cells.len() - absent, "cell")
    )?;
    let judged: Vec<String> = judged.iter().map(|(judgement, count)| format!("{count} {}", judgement.name())).collect();
    let gate = if options.gate_time { "gated" } else { "not gated" };
    let judged = if judged.is_empty() { "none".into() } else { judged.join(", ") };
    writeln!(out, "times ({gate}, equal within {} %): {judged}", options.band)?;
    writeln!(out, "compare: {}", if failed == 0 { "passed".into() } else { format!("FAILED in {}", text::plural(failed, "cell")) })?;
    Ok(())
}

fn as_json(options: &Compare, parts: &(Part, Part), how: &Options, cells: &[Compared], failed: usize) -> Value {
    let side = |part: &Part, folder: &Path| {
        let of = |name: &str| part.provenance.as_ref().and_then(|fields| fields.get(name)).cloned().unwrap_or(Value::Null);
        json!({"folder": folder.display().to_string(), "machines": machines(part), "revision": of("revision"), "profile": of("profile")})
    };
    let cell = |cell: &Compared| {
        let timing = cell.timing.as_ref().map(|timing| {
            let compare::Timing { a_ns, b_ns, ratio, judgement, note } = timing;
            json!({"a_ns": a_ns, "b_ns": b_ns, "ratio": ratio.median, "low": ratio.low, "high": ratio.high, "coverage": ratio.coverage,
                "blocks": ratio.count, "verdict": judgement, "note": note})
        });
        let names = cell.key.names().filter_map(|name| Some((name, cell.key.field(name)?)));
        let key: serde_json::Map<String, Value> = names.map(|(name, value)| (name.to_string(), value.json())).collect();
        json!({"cell": cell.place, "key": key, "changes": cell.changes, "absent": cell.absent, "lacks": cell.lacks, "time": timing})
    };
    let (changed, absent, judged) = counts(cells);
    let judged: serde_json::Map<String, Value> =
        judged.into_iter().map(|(judgement, count)| (judgement.name().replace(' ', "-"), count.into())).collect();
    json!({
        "a": side(&parts.0, &options.a),
        "b": side(&parts.1, &options.b),
        "band_percent": options.band,
        "against": how.against,
        "times": pairing(how),
        "gate_time": options.gate_time,
        "strict": options.strict,
        "summary": {"cells": cells.len(), "changed": changed, "absent": absent, "times": judged, "failed": failed},
        "passed": failed == 0,
        "cells": cells.iter().map(cell).collect::<Vec<_>>(),
    })
}
