mod failing;
mod group;
mod verdicts;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};
use failing::{describe, refusals};
use group::{Group, detectors, runners};
use verdicts::{as_json, verdicts};

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::ci::Outputs;
use crate::cli::shared::input::{Input, OPTIONS};
use crate::cli::shared::{terminal, values};
use contactbench_ground::contact::Arithmetic;
use contactbench_io::Given;
use contactbench_run::check::{self, Limits, Report, Verdict, Wrong};
use contactbench_run::run::machine::interrupt;

#[derive(clap::Args)]
pub struct Check {
    /// Detector to check, repeatable [default: all]
    #[arg(long, value_name = "NAME", value_parser = values::DETECTORS, hide_possible_values = true)]
    detector: Vec<String>,
    /// Command of a runner; {arithmetic} is replaced
    #[arg(long, value_name = "COMMAND", conflicts_with = "detector")]
    runner: Option<String>,
    /// Arithmetic, repeatable (see: list) [default: exact]
    #[arg(long, value_name = "NAME", value_parser = arithmetic())]
    #[arg(hide_possible_values = true)]
    arithmetic: Vec<Arithmetic>,
    /// File or scene, repeatable [default: many scenes]
    #[arg(long, value_name = "FILE|SCENE")]
    #[arg(value_hint = clap::ValueHint::FilePath)]
    scene: Vec<String>,
    #[command(flatten)]
    input: Input,
    /// Most seeds
    #[arg(long, value_name = "COUNT", value_parser = values::whole::<u64>)]
    #[arg(default_value_t = Limits::default().seeds)]
    seeds: u64,
    /// Time for new scenes, in seconds
    #[arg(
        long,
        value_name = "TIME",
        default_value_t = Limits::default().time.as_secs_f64(),
        allow_negative_numbers = true
    )]
    seconds: f64,
    /// Longest detection, in seconds
    #[arg(long, value_name = "TIME", default_value_t = DEADLINE_S, allow_negative_numbers = true)]
    deadline: f64,
    /// Memory for a detector [default and most: 256MiB]
    #[arg(long, value_name = "SIZE", value_parser = values::bytes)]
    memory_limit: Option<u64>,
    /// Folder for failing scenes [default: temporary]
    #[arg(short, long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Print JSON
    #[arg(long, conflicts_with = "annotations")]
    json: bool,
    #[command(flatten)]
    ci: Outputs,
}

/// Default of --deadline, so that a hang is reported within 10 seconds.
const DEADLINE_S: f64 = 5.0;

/// Result of checking a group of detectors on a given scene, or on all generated scenes.
struct Checked<'a> {
    group: &'a Group,
    report: Report,
    path: Option<&'a str>,
}

/// Runs the checks; exit code 1 if a detector is wrong, 2 if all detectors refused all generated
/// scenes, or all refused a scene named by an option.
pub fn check(options: &Check) -> anyhow::Result<ExitCode> {
    let started = Instant::now();
    let limits = limits(options)?;
    let mut out: Box<dyn Write> =
        if options.json { Box::new(std::io::sink()) } else { Box::new(terminal::out()) };
    let read = |path: &String| {
        let given = options.input.given(path)?;
        ensure!(!given.scene.is_empty(), "{path} has no particles: there is nothing to compare");
        Ok((path.clone(), given))
    };
    let scenes = options.scene.iter().map(read).collect::<anyhow::Result<Vec<_>>>()?;
    let mut broken = Vec::new();
    interrupt::end_runners_too().context("cannot listen to Ctrl-C")?;
    let groups = match &options.runner {
        None => vec![detectors(options)?],
        Some(command) => runners(command, options, &limits, &mut broken, &mut out)?,
    };
    let reports = reports(&groups, &scenes, &limits)?;
    for checked in &reports {
        print(checked, options, started, &mut out)?;
    }
    let mut names: Vec<&str> = groups.iter().flat_map(Group::names).collect();
    // The name of a runner repeats, because it has one group for each arithmetic.
    names.dedup();
    let cases: u64 = reports.iter().map(|checked| checked.report.cases).sum();
    let verdict = overall(&reports, &broken);
    let words = match verdict {
        Verdict::Right => "all answers are right".into(),
        Verdict::Wrong => "WRONG".into(),
        Verdict::Nothing => nothing_compared(&reports),
    };
    match names.join(", ") {
        none if none.is_empty() => writeln!(out, "check: {words}: the runner did not start")?,
        names => writeln!(out, "check: {cases} detections by {names}: {words}")?,
    }
    if options.json {
        let value = as_json(&reports, &broken, verdict == Verdict::Right, options);
        terminal::json(&value)?;
    }
    options.ci.write("check", &verdicts(&reports, &broken, options))?;
    Ok(match verdict {
        Verdict::Right => ExitCode::SUCCESS,
        Verdict::Wrong => ExitCode::from(1),
        Verdict::Nothing => ExitCode::from(2),
    })
}

/// Checks each group on the scenes or, without any, on generated ones.
fn reports<'a>(
    groups: &'a [Group],
    scenes: &'a [(String, Given)],
    limits: &Limits,
) -> anyhow::Result<Vec<Checked<'a>>> {
    let mut reports = Vec::new();
    for group in groups {
        let Group { subjects, arithmetics } = group;
        for (path, given) in scenes {
            let report = check::check_scene(given, path, subjects, arithmetics, limits)?;
            reports.push(Checked { group, report, path: Some(path) });
        }
        if scenes.is_empty() {
            let report = check::battery(subjects, arithmetics, limits)?;
            reports.push(Checked { group, report, path: None });
        }
    }
    Ok(reports)
}

/// Returns the limits that the options give, or why they are impossible.
fn limits(options: &Check) -> anyhow::Result<Limits> {
    let (seconds, deadline) = (options.seconds, options.deadline);
    ensure!((0.0..1e9).contains(&seconds), "--seconds {seconds}: give a number from 0 to 10^9");
    ensure!(
        (1e-3..1e9).contains(&deadline),
        "--deadline {deadline}: give a number from 0.001 to 10^9"
    );
    ensure!(options.seeds >= 1, "--seeds 0: give at least 1");
    ensure!(
        !options.scene.is_empty() || !options.input.is_said(),
        "{OPTIONS} need a particle file; name one with --scene"
    );
    let mut limits = Limits { seeds: options.seeds, ..Limits::default() };
    [limits.time, limits.deadline] = [seconds, deadline].map(Duration::from_secs_f64);
    limits.options.memory_limit = options.memory_limit.unwrap_or(limits.options.memory_limit);
    Ok(limits)
}

/// Prints failures, refusals and, for generated scenes, what was tried.
fn print(
    Checked { report, path, .. }: &Checked<'_>,
    options: &Check,
    started: Instant,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    for failure in &report.failures {
        describe(failure, *path, options, out)?;
    }
    refusals(report, out)?;
    if path.is_none() {
        let count = |(source, count): (&_, &_)| format!("{source} {count}");
        let scenes: Vec<String> = report.scenes.iter().map(count).collect();
        let cut = match report.cut && report.failures.is_empty() {
            true => "; not all scenes were tried in this time (--seconds)",
            false => "",
        };
        let (scenes, time) = (scenes.join(", "), started.elapsed().as_secs_f64());
        writeln!(out, "scenes: {scenes}, in {time:.1} s{cut}")?;
    }
    Ok(())
}

/// Returns `Wrong` if any check failed, else `Nothing` if any compared nothing, else `Right`.
fn overall(reports: &[Checked<'_>], broken: &[Wrong]) -> Verdict {
    let any = |wanted| reports.iter().any(|checked| checked.report.verdict() == wanted);
    if !broken.is_empty() || any(Verdict::Wrong) {
        Verdict::Wrong
    } else if reports.is_empty() || any(Verdict::Nothing) {
        Verdict::Nothing
    } else {
        Verdict::Right
    }
}

fn nothing_compared(reports: &[Checked<'_>]) -> String {
    let nothing = |checked: &&Checked<'_>| checked.report.verdict() == Verdict::Nothing;
    let scenes: Vec<&str> =
        reports.iter().filter(nothing).filter_map(|checked| checked.path).collect();
    let place = if scenes.is_empty() { "".into() } else { format!(" of {}", scenes.join(", ")) };
    format!("nothing was compared{place}, because every detector refused")
}
