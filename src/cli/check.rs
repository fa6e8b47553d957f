//! `contactbench check`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Context, ensure};

use crate::check::{self, Failure, Wrong};
use crate::contact::Arithmetic;
use crate::detect::table::TABLE;

/// Options of `check`.
#[derive(clap::Args)]
pub struct Check {
    /// Only this detector (may be given several times; default: all)
    #[arg(long)]
    detector: Vec<String>,
    /// Only this arithmetic (may be given several times); textbook filters lose contacts, as is to be expected
    #[arg(long, value_enum, default_values_t = [Arithmetic::Exact])]
    arithmetic: Vec<Arithmetic>,
    /// Seeds to try at most
    #[arg(long, default_value_t = 1000)]
    seeds: u64,
    /// No new scene is begun after this many seconds (the first seed is always completed)
    #[arg(long, default_value_t = 6.0)]
    seconds: f64,
    /// Where failing scenes are written
    #[arg(long, default_value = ".")]
    out: PathBuf,
}

/// Runs the checks; exit code 1 if a detector disagrees with the truth.
pub fn check(options: &Check) -> anyhow::Result<ExitCode> {
    let seconds = options.seconds;
    ensure!((0.0..1e9).contains(&seconds), "--seconds {seconds}: give a number from 0 to 10^9");
    ensure!(options.seeds >= 1, "--seeds 0: at least one is needed");
    let chosen = options.detector.iter().map(|name| super::detector(name)).collect::<anyhow::Result<Vec<_>>>()?;
    let chosen = if chosen.is_empty() { TABLE.iter().filter(|entry| entry.must_be_right()).collect() } else { chosen };
    // A detector that panics is reported like any other that is wrong, and shrinking makes it panic often.
    std::panic::set_hook(Box::new(|_| ()));
    let report = check::check(&chosen, &options.arithmetic, options.seeds, Duration::from_secs_f64(seconds))?;
    let mut out = std::io::stdout().lock();
    for failure in &report.failures {
        describe(failure, options, &mut out)?;
    }
    for (reason, times) in &report.refused {
        writeln!(out, "refused {times} times: {reason}")?;
    }
    let verdict = if report.failures.is_empty() { "all agree with all pairs tested" } else { "WRONG" };
    let names: Vec<&str> = chosen.iter().map(|entry| entry.name).collect();
    writeln!(out, "check: {} detections by {}: {verdict}", report.cases, names.join(", "))?;
    Ok(if report.failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn describe(failure: &Failure, options: &Check, out: &mut impl Write) -> anyhow::Result<()> {
    let path = options.out.join(format!("failing-{}-{}.csv", failure.detector, failure.arithmetic.name()));
    let scene = check::as_csv(&failure.smallest);
    std::fs::write(&path, &scene).with_context(|| format!("cannot write {}; choose another place with --out", path.display()))?;
    writeln!(out, "WRONG: {} with {} arithmetic, on {}", failure.detector, failure.arithmetic.name(), failure.found_on)?;
    let how = match &failure.wrong {
        Some(Wrong::Pairs(errors)) => {
            format!("{} missed, {} spurious, {} duplicate pairs", errors.missed, errors.spurious, errors.duplicate)
        }
        Some(Wrong::Panics) => "it panics".into(),
        None => "only after earlier scenes: something is left in its buffers".into(),
    };
    writeln!(out, "  smallest failing scene: {} elements, {how}: {}", failure.smallest.len(), path.display())?;
    for line in scene.lines().take(12) {
        writeln!(out, "    {line}")?;
    }
    let arithmetic = failure.arithmetic.name();
    writeln!(out, "  see it: contactbench detect {} --detector {} --arithmetic {arithmetic}", path.display(), failure.detector)?;
    writeln!(out, "  truth:  contactbench detect {} --detector direct --arithmetic {arithmetic}", path.display())?;
    Ok(())
}
