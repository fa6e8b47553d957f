//! `contactbench check`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Context, ensure};
use serde_json::{Value, json};

use super::ci::{Case, Outcome, Outputs};
use crate::check::{self, Failure, Limits, Report, Wrong, regression, subject};
use crate::contact::Arithmetic;
use crate::detect::table::TABLE;
use crate::read;

/// Options of `check`.
#[derive(clap::Args)]
pub struct Check {
    /// Only this detector (may be given several times; default: all)
    #[arg(long)]
    detector: Vec<String>,
    /// Only this arithmetic (may be given several times); textbook filters lose contacts, as is to be expected
    #[arg(long, value_enum, default_values_t = [Arithmetic::Exact])]
    arithmetic: Vec<Arithmetic>,
    /// Check this particle file with radii (may be given several times) instead of generated scenes
    #[arg(long)]
    scene: Vec<PathBuf>,
    /// Seeds to try at most
    #[arg(long, default_value_t = Limits::default().seeds)]
    seeds: u64,
    /// No new scene is generated after this many seconds (the first seed is always completed)
    #[arg(long, default_value_t = Limits::default().time.as_secs_f64(), allow_negative_numbers = true)]
    seconds: f64,
    /// A detection that takes more seconds than this hangs
    #[arg(long, default_value_t = Limits::default().deadline.as_secs_f64(), allow_negative_numbers = true)]
    deadline: f64,
    /// Where failing scenes are written
    #[arg(long, default_value = ".")]
    out: PathBuf,
    /// Print JSON instead of text
    #[arg(long, conflicts_with = "annotations")]
    json: bool,
    #[command(flatten)]
    ci: Outputs,
}

/// Runs the checks; exit code 1 if a detector disagrees with the truth.
pub fn check(options: &Check) -> anyhow::Result<ExitCode> {
    let (seconds, deadline) = (options.seconds, options.deadline);
    ensure!((0.0..1e9).contains(&seconds), "--seconds {seconds}: give a number from 0 to 10^9");
    ensure!((1e-3..1e9).contains(&deadline), "--deadline {deadline}: give a number from 0.001 to 10^9");
    ensure!(options.seeds >= 1, "--seeds 0: at least one is needed");
    let chosen = options.detector.iter().map(|name| super::detector(name)).collect::<anyhow::Result<Vec<_>>>()?;
    let chosen = if chosen.is_empty() { TABLE.iter().filter(|entry| entry.must_be_right()).collect() } else { chosen };
    let limits = Limits {
        seeds: options.seeds,
        time: Duration::from_secs_f64(seconds),
        deadline: Duration::from_secs_f64(deadline),
        ..Limits::default()
    };
    quiet_panics();
    let mut reports: Vec<(Report, Option<&Path>)> = Vec::new();
    for path in &options.scene {
        let scene = read::scene(path, read::Options::default())?;
        reports.push((check::check_scene(&scene, &path.display().to_string(), &chosen, &options.arithmetic, &limits)?, Some(path)));
    }
    if options.scene.is_empty() {
        reports.push((check::check(&chosen, &options.arithmetic, &limits)?, None));
    }
    let mut out: Box<dyn Write> = if options.json { Box::new(std::io::sink()) } else { Box::new(std::io::stdout().lock()) };
    for (report, path) in &reports {
        for failure in &report.failures {
            describe(failure, *path, options, &mut out)?;
        }
        for (reason, times) in &report.refused {
            writeln!(out, "refused {times} times: {reason}")?;
        }
    }
    let right = reports.iter().all(|(report, _)| report.failures.is_empty());
    let cases: u64 = reports.iter().map(|(report, _)| report.cases).sum();
    let names: Vec<&str> = chosen.iter().map(|entry| entry.name).collect();
    let verdict = if right { "all agree with all pairs tested" } else { "WRONG" };
    writeln!(out, "check: {cases} detections by {}: {verdict}", names.join(", "))?;
    if options.json {
        let text = serde_json::to_string_pretty(&as_json(&reports, &names, options, right))?;
        writeln!(std::io::stdout(), "{text}")?;
    }
    options.ci.write("check", &verdicts(&reports, &names, options), &mut out)?;
    Ok(if right { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The file that a failing scene is written to.
fn regression_file(failure: &Failure, given: Option<&Path>, options: &Check) -> PathBuf {
    let stem = given.and_then(Path::file_stem).map(|stem| format!("-{}", stem.to_string_lossy())).unwrap_or_default();
    options.out.join(format!("failing-{}-{}{stem}.csv", failure.detector, failure.arithmetic.name()))
}

/// Every detector in every arithmetic, on every given scene or on the generated ones, for continuous integration.
fn verdicts(reports: &[(Report, Option<&Path>)], names: &[&str], options: &Check) -> Vec<Case> {
    let mut cases = Vec::new();
    for (report, path) in reports {
        let class = path.map_or("generated".into(), |path| path.display().to_string());
        for arithmetic in &options.arithmetic {
            for name in names {
                let wrong = report.failures.iter().find(|failure| failure.detector == *name && failure.arithmetic == *arithmetic);
                let why = |failure: &Failure| {
                    let file = regression_file(failure, *path, options);
                    format!("on {}: {}; smallest failing scene: {}", failure.found_on, failure.found, file.display())
                };
                let result = wrong.map_or(Outcome::Passed, |failure| Outcome::Failed(why(failure)));
                cases.push(Case { class: class.clone(), name: format!("{name}, {} arithmetic", arithmetic.name()), result });
            }
        }
    }
    cases
}

fn as_json(reports: &[(Report, Option<&Path>)], names: &[&str], options: &Check, right: bool) -> Value {
    let failure = |failure: &Failure, path: &Option<&Path>| {
        json!({
            "detector": failure.detector,
            "arithmetic": failure.arithmetic.name(),
            "found_on": failure.found_on,
            "found": failure.found.to_string(),
            "smallest": failure.wrong.as_ref().map(|wrong| wrong.to_string()),
            "elements": failure.smallest.len(),
            "file": regression_file(failure, *path, options).display().to_string(),
        })
    };
    let of = |(report, path): &(Report, Option<&Path>)| {
        json!({
            "scene": path.map_or("generated".into(), |path| path.display().to_string()),
            "detections": report.cases,
            "refused": report.refused,
            "failures": report.failures.iter().map(|found| failure(found, path)).collect::<Vec<_>>(),
        })
    };
    let arithmetics: Vec<&str> = options.arithmetic.iter().map(|arithmetic| arithmetic.name()).collect();
    json!({"passed": right, "detectors": names, "arithmetics": arithmetics, "checks": reports.iter().map(of).collect::<Vec<_>>()})
}

/// A detector that panics is reported like any other that is wrong, and shrinking makes it panic often.
fn quiet_panics() {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if std::thread::current().name() != Some(subject::THREAD) {
            hook(panic);
        }
    }));
}

fn describe(failure: &Failure, given: Option<&Path>, options: &Check, out: &mut dyn Write) -> anyhow::Result<()> {
    let Failure { detector, arithmetic, found_on, found, smallest, wrong } = failure;
    let arithmetic = arithmetic.name();
    writeln!(out, "WRONG: {detector} with {arithmetic} arithmetic, on {found_on}: {found}")?;
    let path = regression_file(failure, given, options);
    let scene = regression::file(failure, &path);
    std::fs::write(&path, &scene).with_context(|| format!("cannot write {}; choose another place with --out", path.display()))?;
    let (n, place) = (smallest.len(), path.display());
    match wrong {
        Some(Wrong::Hangs(_)) => writeln!(out, "  the scene, not made smaller: {n} elements: {place}")?,
        Some(wrong) => writeln!(out, "  smallest failing scene: {n} elements, {wrong}: {place}")?,
        None => writeln!(out, "  only after earlier scenes: something is left in its buffers; the scene: {n} elements: {place}")?,
    }
    for line in scene.lines().filter(|line| !line.starts_with('#')).take(12) {
        writeln!(out, "    {line}")?;
    }
    writeln!(out, "  again:  contactbench check --scene {place} --detector {detector} --arithmetic {arithmetic}")?;
    writeln!(out, "  see it: contactbench detect {place} --detector {detector} --arithmetic {arithmetic}")?;
    writeln!(out, "  truth:  contactbench detect {place} --detector direct --arithmetic {arithmetic}")?;
    Ok(())
}
