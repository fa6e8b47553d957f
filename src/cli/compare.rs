//! `contactbench compare`.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::ensure;
use serde_json::{Map, Value, json};

use crate::cli::shared::ci::{Case, Outcome, Outputs};
use crate::cli::shared::terminal;
use crate::findings::compare::{
    Absent, Compared, Judgement, Options, Summary, Timing, compare as cell_by_cell, records,
};
use crate::number::plural;
use crate::present::sections::compare as words;
use crate::record::merge::Part;

/// Options of `compare`.
#[derive(clap::Args)]
pub struct Compare {
    /// A result folder: before, or the first machine
    a: PathBuf,
    /// Another: after, or the second machine
    b: PathBuf,
    /// Compare times as multiples of this detector's in the same block: for two machines, or where
    /// the machine's speed drifts
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

/// What there is to print.
struct Comparison<'a> {
    options: &'a Compare,
    parts: &'a [Part; 2],
    how: &'a Options,
    cells: &'a [Compared],
    summary: Summary,
    /// Cells in which something differs that is gated.
    failed: usize,
}

/// Both records compared; exit code 1 if something differs that is gated.
pub fn compare(options: &Compare) -> anyhow::Result<ExitCode> {
    ensure!(
        (0.0..=1000.0).contains(&options.band),
        "--band {}: give percent from 0 to 1000",
        options.band
    );
    let parts = [Part::read(&options.a)?, Part::read(&options.b)?];
    for part in &parts {
        let folder = part.folder.display();
        ensure!(!part.rows.is_empty(), "the record in {folder} holds no rows");
        if let Some(name) = &options.against {
            let known = records::detectors(part);
            ensure!(
                known.contains(name),
                "--against {name}: {folder} has no rows of this detector; its detectors are: {}",
                list(known)
            );
        }
        part.warnings.iter().for_each(|warning| eprintln!("{warning}"));
    }
    let how = Options {
        band: options.band / 100.0,
        against: options.against.clone(),
        machines: records::two_machines(&parts).filter(|_| !options.same_machine),
        builds: records::two_builds(&parts),
    };
    let [a, b] = records::common(&parts)?;
    let cells = cell_by_cell(&a, &b, &how);
    ensure!(
        cells.iter().any(|cell| !matches!(cell.absent, Some(Absent::OnlyIn(_)))),
        "{} and {} have no cell in common: they are results of different experiments or scenes",
        options.a.display(),
        options.b.display()
    );
    let mut timings = cells.iter().filter_map(|cell| cell.timing.as_ref());
    ensure!(
        !options.gate_time || timings.any(Timing::is_decidable),
        "--gate-time: no time could be judged ({}; an interval needs four blocks on either side); \
         leave it out, or measure what can be compared",
        words::pairing(&how)
    );
    let cases: Vec<Case> = cells.iter().map(|cell| case(cell, options)).collect();
    let failed = cases.iter().filter(|case| matches!(case.result, Outcome::Failed(_))).count();
    let summary = Summary::new(&cells);
    let (parts, how, cells) = (&parts, &how, &*cells);
    let found = Comparison { options, parts, how, cells, summary, failed };
    let mut out = std::io::stdout().lock();
    if options.json {
        writeln!(out, "{:#}", found.json())?;
    } else {
        found.print(&mut out)?;
    }
    options.ci.write("compare", &cases, &mut out)?;
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn list(names: BTreeSet<String>) -> String {
    names.into_iter().collect::<Vec<_>>().join(", ")
}

/// What continuous integration is told of a cell.
fn case(cell: &Compared, options: &Compare) -> Case {
    let slower = cell.timing.as_ref().filter(|timing| timing.judgement == Judgement::Slower);
    let gated = |gate: bool, why: String, else_: fn(String) -> Outcome| {
        if gate { Outcome::Failed(why) } else { else_(why) }
    };
    let result = if !cell.changes.is_empty() {
        let changes: Vec<String> = cell.changes.iter().map(words::change).collect();
        Outcome::Failed(format!("changed: {}", changes.join("; ")))
    } else if let Some(absent) = &cell.absent {
        gated(options.strict, words::absent(absent), Outcome::Skipped)
    } else if !cell.lacks.is_empty() {
        gated(options.strict, lacks(cell), Outcome::Noted)
    } else if let Some(timing) = slower {
        let why = format!("{}: B / A = {}", timing.judgement.name(), words::ratio(timing));
        gated(options.gate_time, why, Outcome::Noted)
    } else {
        Outcome::Passed
    };
    let class = format!("{}.{}", cell.id.experiment, cell.id.scene);
    Case { class, name: cell.place.clone(), result }
}

fn lacks(cell: &Compared) -> String {
    cell.lacks.iter().map(words::lack).collect::<Vec<_>>().join("; ")
}

impl Comparison<'_> {
    fn print(&self, out: &mut impl Write) -> anyhow::Result<()> {
        let Comparison { options, parts, how, cells, .. } = *self;
        for (name, part) in ["A", "B"].into_iter().zip(parts) {
            let machines = list(records::machines(part));
            writeln!(out, "{name}: {}, measured on {machines}", part.folder.display())?;
        }
        writeln!(out, "times: {}\n", words::pairing(how))?;
        for cell in cells.iter().filter(|cell| !cell.changes.is_empty()) {
            writeln!(out, "CHANGED  {}", cell.place)?;
            for change in &cell.changes {
                writeln!(out, "         {}", words::change(change))?;
            }
        }
        for cell in cells.iter().filter(|_| options.all || options.strict) {
            if let Some(absent) = &cell.absent {
                writeln!(out, "absent   {}: {}", cell.place, words::absent(absent))?;
            }
            if !cell.lacks.is_empty() {
                writeln!(out, "lacking  {}: {}", cell.place, lacks(cell))?;
            }
        }
        let times = words::times(cells, how, options.all);
        if !times.rows.is_empty() {
            writeln!(out, "{}", times.plain(terminal::width()))?;
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
            "a": side(&parts[0], &options.a),
            "b": side(&parts[1], &options.b),
            "band_percent": options.band,
            "against": how.against,
            "times": words::pairing(how),
            "gate_time": options.gate_time,
            "strict": options.strict,
            "summary": {
                "cells": summary.cells,
                "changed": summary.changed,
                "absent": summary.absent,
                "times": judged,
                "failed": failed,
            },
            "passed": *failed == 0,
            "cells": cells.iter().map(|cell| as_json(cell, how)).collect::<Vec<_>>(),
        })
    }
}

fn side(part: &Part, folder: &Path) -> Value {
    json!({
        "folder": folder.display().to_string(),
        "machines": records::machines(part),
        "revision": records::field(part, "revision"),
        "profile": records::field(part, "profile"),
    })
}

fn as_json(cell: &Compared, how: &Options) -> Value {
    let time = cell.timing.as_ref().map(|timing| {
        let Timing { a_ns, b_ns, ratio, judgement, .. } = timing;
        json!({
            "a_ns": a_ns,
            "b_ns": b_ns,
            "ratio": ratio.median,
            "low": ratio.low,
            "high": ratio.high,
            "coverage": ratio.coverage,
            "blocks": ratio.count,
            "verdict": judgement,
            "note": words::note(timing, how),
        })
    });
    let names = cell.id.names().filter_map(|name| cell.id.axis(&name).map(|v| (name, v)));
    let key: Map<String, Value> = names.map(|(name, value)| (name, Value::from(&value))).collect();
    json!({
        "cell": cell.place,
        "key": key,
        "changes": cell.changes,
        "absent": cell.absent.as_ref().map(words::absent),
        "lacks": cell.lacks.iter().map(words::lack).collect::<Vec<_>>(),
        "time": time,
    })
}
