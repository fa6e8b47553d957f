use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{bail, ensure};

use crate::cli::shared::ci::{Case, Outcome, Outputs};
use crate::cli::shared::terminal;
use contactbench_record::findings::compare::comparison::{Comparison, Terms};
use contactbench_record::findings::compare::{Compared, Judgement};
use contactbench_report::sections::compare::{self as words, Page};

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

/// Compares two records; exit code 1 if a cell fails the comparison.
pub fn compare(options: &Compare) -> anyhow::Result<ExitCode> {
    let Compare { band, same_machine, across_machines, gate_time, strict, all, .. } = *options;
    ensure!((0.0..=1000.0).contains(&band), "--band {band}: give a percentage from 0 to 1000");
    let against = options.against.clone();
    let terms = Terms { against, band, same_machine, across_machines };
    let folders = [Some(&options.a), options.b.as_ref()].into_iter().flatten();
    let folders = folders.map(|folder| &**folder);
    let comparison = Comparison::read(folders, &terms, &mut |warning| say!("{warning}"))?;
    let real = |path: &PathBuf| std::fs::canonicalize(path).ok();
    if options.b.as_ref().is_some_and(|b| real(b) == real(&options.a)) {
        say!("{} is both folders, so nothing can differ", options.a.display());
    }
    let Comparison { how, cells, summary, .. } = &comparison;
    if let Some(why) = words::ungated(summary, how).filter(|_| gate_time) {
        bail!("--gate-time: {why}");
    }
    let slower = gate_time && summary.is_slower();
    let cases: Vec<Case> = cells.iter().map(|cell| case(cell, options, slower)).collect();
    let failed = cases.iter().filter(|case| case.outcome == Outcome::Failed).count();
    let page = Page { comparison: &comparison, terms: &terms, gate_time, strict, all, failed };
    if options.json {
        terminal::json(&page.json())?;
    } else {
        write!(terminal::out(), "{}", page.text(terminal::width()))?;
    }
    options.ci.write("compare", &cases)?;
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// Returns the case of a cell; with `gated_time` a slower cell fails.
fn case(cell: &Compared, options: &Compare, gated_time: bool) -> Case {
    let slower = cell.timing.as_ref().filter(|timing| timing.judgement == Judgement::Slower);
    let gated = |gate: bool, otherwise| if gate { Outcome::Failed } else { otherwise };
    let (outcome, why) = if !cell.changes.is_empty() {
        let changes: Vec<String> = cell.changes.iter().map(words::change).collect();
        (Outcome::Failed, format!("changed: {}", changes.join("; ")))
    } else if let Some(absent) = &cell.absent {
        (gated(options.strict, Outcome::Skipped), absent.clone())
    } else if !cell.lacks.is_empty() {
        (gated(options.strict, Outcome::Noted), cell.lacks.join("; "))
    } else if let Some(timing) = slower {
        let why = format!("{}: B / A = {}", timing.judgement.name(), words::ratio(timing));
        (gated(gated_time, Outcome::Noted), why)
    } else {
        (Outcome::Passed, String::new())
    };
    let class = format!("{}.{}", cell.id.experiment, cell.id.scene);
    Case { class, name: cell.place.clone(), outcome, why }
}
