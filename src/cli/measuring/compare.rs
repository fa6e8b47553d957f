use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, bail, ensure};
use serde_json::{Map, Value, json};

use crate::cli::shared::ci::{Case, Outcome, Outputs};
use crate::cli::shared::terminal;
use contactbench_record::cells::cells;
use contactbench_record::findings::compare::{
    Builds, Compared, Judgement, Options as How, Summary, Timing, compare as cell_by_cell, control,
    floors, pooled, records,
};
use contactbench_record::findings::trust::conditions::Conditions;
use contactbench_record::record::merge::Part;
use contactbench_record::stats::interval::Interval;
use contactbench_report::document::indented;
use contactbench_report::sections::compare as words;
use contactbench_report::sections::trust::conditions as doubtful;
use contactbench_terms::number::plural;

#[derive(clap::Args)]
pub struct Compare {
    /// Result folder: before, or the first machine; or of run --against
    a: PathBuf,
    /// Result folder: after, or the second machine
    b: Option<PathBuf>,
    /// Detector as unit of time [default: one with a twin]
    #[arg(long, value_name = "DETECTOR", requires = "b")]
    against: Option<String>,
    /// Ignored time difference, in percent
    #[arg(long, value_name = "PERCENT", default_value_t = 5.0, allow_negative_numbers = true)]
    band: f64,
    /// Both are of one machine, although its name differs
    #[arg(long, requires = "b")]
    same_machine: bool,
    /// Judge times of two machines, in units of a control
    #[arg(long, requires = "b", conflicts_with = "gate_time")]
    across_machines: bool,
    /// Fail if more cells are slower than chance explains
    #[arg(long)]
    gate_time: bool,
    /// Fail if a cell is in one folder only
    #[arg(long)]
    strict: bool,
    /// Print all cells [default: those that differ]
    #[arg(long)]
    all: bool,
    /// Print JSON
    #[arg(long, conflicts_with = "annotations")]
    json: bool,
    #[command(flatten)]
    ci: Outputs,
}

struct Comparison<'a> {
    options: &'a Compare,
    parts: &'a [Part],
    how: &'a How,
    cells: &'a [Compared],
    summary: Summary,
    failed: usize,
}

/// Compares two records; exit code 1 if a cell fails the comparison.
pub fn compare(options: &Compare) -> anyhow::Result<ExitCode> {
    ensure!(
        (0.0..=1000.0).contains(&options.band),
        "--band {}: give a percentage from 0 to 1000",
        options.band
    );
    let folders = [Some(&options.a), options.b.as_ref()].into_iter().flatten();
    let parts = folders.map(|folder| Part::read(folder)).collect::<anyhow::Result<Vec<_>>>()?;
    for part in &parts {
        let folder = part.folder.display();
        ensure!(!part.rows.is_empty(), "the record in {folder} has no rows");
        if let Some(name) = &options.against {
            let known = records::detectors(part);
            ensure!(
                known.contains(name),
                "--against {name}: {folder} has no rows of this detector; it has {}",
                list(known)
            );
        }
        part.warnings.iter().for_each(|warning| say!("{warning}"));
    }
    let (how, cells) = match &*parts {
        [both] => builds(both, options)?,
        parts => folders_apart(parts, options)?,
    };
    let summary = Summary::new(&cells);
    ensure!(
        summary.absent < summary.cells,
        "nothing to compare: each of the {} cells has results on one side only",
        cells.len()
    );
    if let Some(why) = words::ungated(&summary, &how).filter(|_| options.gate_time) {
        bail!("--gate-time: {why}");
    }
    let slower = options.gate_time && summary.is_slower();
    let cases: Vec<Case> = cells.iter().map(|cell| case(cell, options, slower)).collect();
    let failed = cases.iter().filter(|case| matches!(case.result, Outcome::Failed(_))).count();
    let (parts, how, cells) = (&parts, &how, &*cells);
    let found = Comparison { options, parts, how, cells, summary, failed };
    let mut out = terminal::out();
    if options.json {
        terminal::json(&found.json())?;
    } else {
        found.print(&mut out)?;
    }
    options.ci.write("compare", &cases)?;
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn builds(part: &Part, options: &Compare) -> anyhow::Result<(How, Vec<Compared>)> {
    let found = Builds::new(&part.rows).with_context(|| {
        format!(
            "the record in {} has one build; name a second folder, or time another build with \
             contactbench run --against PROGRAM",
            part.folder.display()
        )
    })?;
    let floors = floors(&cells(&part.rows));
    let how = How { band: options.band / 100.0, side_by_side: Some(floors), ..How::default() };
    let cells = cell_by_cell(&found.base, &found.this, &how);
    Ok((how, cells))
}

fn folders_apart(parts: &[Part], options: &Compare) -> anyhow::Result<(How, Vec<Compared>)> {
    let [a, b] = parts else { bail!("compare takes one folder or two") };
    let both = [a, b];
    let [a, b] = records::common(both)?;
    let how = How {
        band: options.band / 100.0,
        side_by_side: None,
        against: control(&a, &b, options.against.as_deref()),
        machines: records::two_machines(both).filter(|_| !options.same_machine),
        across: options.across_machines,
        builds: records::two_builds(both),
    };
    let cells = cell_by_cell(&a, &b, &how);
    ensure!(
        cells.iter().any(|cell| cell.in_both),
        "{} and {} have no cell in common; name results of the same experiment",
        both[0].folder.display(),
        both[1].folder.display()
    );
    Ok((how, cells))
}

fn list(names: BTreeSet<String>) -> String {
    names.into_iter().collect::<Vec<_>>().join(", ")
}

/// Returns the case of a cell; with `gated_time` a slower cell fails.
fn case(cell: &Compared, options: &Compare, gated_time: bool) -> Case {
    let slower = cell.timing.as_ref().filter(|timing| timing.judgement == Judgement::Slower);
    let gated = |gate: bool, why: String, else_: fn(String) -> Outcome| {
        if gate { Outcome::Failed(why) } else { else_(why) }
    };
    let result = if !cell.changes.is_empty() {
        let changes: Vec<String> = cell.changes.iter().map(words::change).collect();
        Outcome::Failed(format!("changed: {}", changes.join("; ")))
    } else if let Some(absent) = &cell.absent {
        gated(options.strict, absent.clone(), Outcome::Skipped)
    } else if !cell.lacks.is_empty() {
        gated(options.strict, cell.lacks.join("; "), Outcome::Noted)
    } else if let Some(timing) = slower {
        let why = format!("{}: B / A = {}", timing.judgement.name(), words::ratio(timing));
        gated(gated_time, why, Outcome::Noted)
    } else {
        Outcome::Passed
    };
    let class = format!("{}.{}", cell.id.experiment, cell.id.scene);
    Case { class, name: cell.place.clone(), result }
}

impl Comparison<'_> {
    fn print(&self, out: &mut impl Write) -> anyhow::Result<()> {
        let Comparison { options, parts, how, cells, .. } = *self;
        let measured = |part: &Part| {
            format!("{}, measured on {}", part.folder.display(), processors(part).join(", "))
        };
        let width = terminal::width();
        let mut say = |head: &str, text: &str| write!(out, "{}", indented(head, text, width));
        if let Some(two) = &how.machines {
            say("NOTE: ", &words::machines(two))?;
        }
        if let [a, b] = parts
            && !options.same_machine
            && records::caches_of_one([a, b])
        {
            say("NOTE: ", "only one record states cache sizes; taken to be one machine")?;
        }
        let names: &[&str] =
            if parts.len() == 1 { &["A: the base, B: this build, in"] } else { &["A:", "B:"] };
        for (name, part) in names.iter().zip(parts) {
            say(&format!("{name} "), &measured(part))?;
            if let Some(said) = doubtful::sentence(&conditions(part)) {
                say("   ", &said)?;
            }
        }
        say("times: ", &words::pairing(how))?;
        for (experiment, noise) in how.side_by_side.iter().flatten() {
            say("floor: ", &words::floor(experiment, noise))?;
        }
        writeln!(out)?;
        for cell in cells.iter().filter(|cell| !cell.changes.is_empty()) {
            writeln!(out, "CHANGED  {}", cell.place)?;
            for change in &cell.changes {
                writeln!(out, "         {}", words::change(change))?;
            }
        }
        for cell in cells {
            if let Some(absent) = cell.absent.as_ref().filter(|_| options.all || options.strict) {
                writeln!(out, "absent   {}: {}", cell.place, absent)?;
            }
            if !cell.lacks.is_empty() {
                writeln!(out, "lacking  {}: {}", cell.place, cell.lacks.join("; "))?;
            }
        }
        let times = words::times(cells, how, options.all);
        if !times.rows.is_empty() {
            writeln!(out, "{}", times.plain(terminal::width()))?;
        }
        let mut say = |head: &str, text: &str| write!(out, "{}", indented(head, text, width));
        for one in &pooled(cells) {
            say("pooled: ", &words::pooled(one))?;
        }
        if how.side_by_side.is_some() {
            say("NOTE: ", &words::placement())?;
        }
        if let Some((name, factor)) = &self.summary.moved {
            say("NOTE: ", &words::moved(name, *factor))?;
        }
        for line in words::summary(&self.summary, options.band, options.gate_time) {
            writeln!(out, "{line}")?;
        }
        match self.failed {
            0 => writeln!(out, "compare: passed")?,
            failed => writeln!(out, "compare: FAILED in {}", plural(failed, "cell"))?,
        }
        Ok(())
    }

    fn json(&self) -> Value {
        let Comparison { options, parts, how, cells, summary, failed } = self;
        let judged = summary.judged.iter();
        let judged: Map<String, Value> = judged
            .map(|(verdict, count)| (verdict.name().replace(' ', "-"), (*count).into()))
            .collect();
        json!({
            "a": parts.first().map(side),
            "b": parts.last().map(side),
            "band_percent": options.band,
            "against": how.against.as_ref().map(|control| &control.detector),
            "drift": how.against.as_ref().and_then(|control| control.drift),
            "floor": how.side_by_side.as_ref().map(|floors| {
                let floors = floors.iter().map(|(name, noise)| (name.clone(), noise.floor.into()));
                floors.collect::<Map<String, Value>>()
            }),
            "times": words::pairing(how),
            "gate_time": options.gate_time,
            "strict": options.strict,
            "summary": {
                "cells": summary.cells,
                "changed": summary.changed,
                "absent": summary.absent,
                "times": judged,
                "slower_by_chance": summary.by_chance,
                "failed": failed,
            },
            "moved_twin": summary.moved.as_ref().map(|(name, factor)| {
                json!({"twin": name, "factor": factor})
            }),
            "pooled": pooled(cells).iter().map(pooled_json).collect::<Vec<_>>(),
            "passed": *failed == 0,
            "cells": cells.iter().map(|cell| as_json(cell, how)).collect::<Vec<_>>(),
        })
    }
}

fn processors(part: &Part) -> Vec<String> {
    records::machines(part).iter().map(|name| words::machine(&part.machine(name))).collect()
}

fn pooled_json((name, ratio): &(String, Interval)) -> Value {
    let Interval { median, low, high, coverage, count } = ratio;
    json!({"detector": name, "ratio": median, "low": low, "high": high, "coverage": coverage,
           "cells": count})
}

fn side(part: &Part) -> Value {
    json!({
        "folder": part.folder.display().to_string(),
        "machines": records::machines(part),
        "processors": processors(part),
        "revision": records::field(part, "revision"),
        "profile": records::field(part, "profile"),
        "doubts": conditions(part).doubts,
    })
}

fn conditions(part: &Part) -> Conditions {
    Conditions::new(part.provenances(), &part.ledger, &part.rows)
}

fn as_json(cell: &Compared, how: &How) -> Value {
    let time = cell.timing.as_ref().map(|timing| {
        let Timing { a_ns, b_ns, multiples, ratio, judgement, least, .. } = timing;
        json!({
            "a_ns": a_ns,
            "b_ns": b_ns,
            "a_of_control": multiples.map(|[a, _]| a),
            "b_of_control": multiples.map(|[_, b]| b),
            "ratio": ratio.median,
            "low": ratio.low,
            "high": ratio.high,
            "coverage": ratio.coverage,
            "blocks": ratio.count,
            "verdict": judgement,
            "excludes_1": ratio.excludes(1.0),
            "least": least,
            "note": words::note(timing, how),
        })
    });
    let names = cell.id.names().filter_map(|name| cell.id.axis(&name).map(|v| (name, v)));
    let key: Map<String, Value> = names.map(|(name, value)| (name, Value::from(value))).collect();
    json!({
        "cell": cell.place,
        "key": key,
        "changes": cell.changes,
        "absent": cell.absent,
        "lacks": cell.lacks,
        "time": time,
    })
}
