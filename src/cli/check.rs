//! `contactbench check`.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Context, bail, ensure};
use serde_json::{Value, json};

use crate::check::contender::Contender;
use crate::check::process::{Foreign, Met};
use crate::check::{
    self, Differences, Failure, Limits, Report, Wrong, contender, conversation, regression,
};
use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::ci::{Case, Outcome, Outputs};
use crate::contact::Arithmetic;
use crate::detect::table::{self, TABLE};
use crate::present::draw;
use crate::present::draw::{Highlighted, Look};
use crate::run::interrupt;
use crate::{io, oracle};

/// Options of `check`.
#[derive(clap::Args)]
pub struct Check {
    /// Only this detector, with parameters as in streamed-nbs:level=avx2 (may be given several
    /// times; default: all)
    #[arg(long)]
    detector: Vec<String>,
    /// A detector in another language: the command that starts its runner (docs/PROTOCOL.md);
    /// {arithmetic} in it stands for each --arithmetic
    #[arg(long, value_name = "COMMAND", conflicts_with = "detector")]
    runner: Option<String>,
    /// Only this arithmetic (may be given several times; default: exact; a runner says its own);
    /// textbook filters lose contacts, as is to be expected
    #[arg(long, value_parser = arithmetic())]
    arithmetic: Vec<Arithmetic>,
    /// Check this particle file with radii (may be given several times) instead of the scenes of
    /// the check
    #[arg(long)]
    scene: Vec<PathBuf>,
    /// Seeds to try at most
    #[arg(long, default_value_t = Limits::default().seeds)]
    seeds: u64,
    /// No new scene is begun after this many seconds (generated scenes of the first seed are always
    /// completed)
    #[arg(
        long,
        default_value_t = Limits::default().time.as_secs_f64(),
        allow_negative_numbers = true
    )]
    seconds: f64,
    /// A detection that takes more seconds than this hangs
    #[arg(long, default_value_t = DEADLINE_S, allow_negative_numbers = true)]
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

/// A hang, too, is to be told within 10 seconds; scenes are small.
const DEADLINE_S: f64 = 5.0;
/// So many kinds of refusals are shown.
const KINDS: usize = 6;

/// Who is checked together, and how contacts are decided.
struct Group {
    contenders: Vec<Contender>,
    arithmetics: Vec<Arithmetic>,
}

impl Group {
    fn names(&self) -> impl Iterator<Item = &str> {
        self.contenders.iter().map(Contender::name)
    }
}

/// What came of a group on a given scene, or on those of the battery.
struct Checked<'a> {
    group: &'a Group,
    report: Report,
    path: Option<&'a Path>,
}

/// Runs the checks; exit code 1 if a detector disagrees with the truth.
pub fn check(options: &Check) -> anyhow::Result<ExitCode> {
    let started = Instant::now();
    let (seconds, deadline) = (options.seconds, options.deadline);
    ensure!((0.0..1e9).contains(&seconds), "--seconds {seconds}: give a number from 0 to 10^9");
    ensure!(
        (1e-3..1e9).contains(&deadline),
        "--deadline {deadline}: give a number from 0.001 to 10^9"
    );
    ensure!(options.seeds >= 1, "--seeds 0: at least one is needed");
    let limits = Limits {
        seeds: options.seeds,
        time: Duration::from_secs_f64(seconds),
        deadline: Duration::from_secs_f64(deadline),
        ..Limits::default()
    };
    quiet_panics();
    let mut out: Box<dyn Write> =
        if options.json { Box::new(std::io::sink()) } else { Box::new(std::io::stdout().lock()) };
    let mut broken = Vec::new();
    let groups = match &options.runner {
        None => vec![detectors(options)?],
        Some(command) => {
            interrupt::end_runners_too().context("cannot listen to Ctrl-C")?;
            runners(command, options, &limits, &mut broken, &mut out)?
        }
    };
    let mut reports: Vec<Checked<'_>> = Vec::new();
    for group in &groups {
        let Group { contenders, arithmetics } = group;
        for path in &options.scene {
            let scene = io::scene(path, io::Options::default())?;
            let report = check::one_scene(
                &scene,
                &path.display().to_string(),
                contenders,
                arithmetics,
                &limits,
            )?;
            reports.push(Checked { group, report, path: Some(path) });
        }
        if options.scene.is_empty() {
            reports.push(Checked {
                group,
                report: check::battery(contenders, arithmetics, &limits)?,
                path: None,
            });
        }
    }
    for Checked { report, path, .. } in &reports {
        for failure in &report.failures {
            describe(failure, *path, options, &mut out)?;
        }
        refusals(report, &mut out)?;
        if path.is_none() {
            let scenes: Vec<String> =
                report.scenes.iter().map(|(source, count)| format!("{source} {count}")).collect();
            let cut = if report.cut && report.failures.is_empty() {
                "; the time was over before all were tried (--seconds)"
            } else {
                ""
            };
            writeln!(
                out,
                "scenes: {}, in {:.1} s{cut}",
                scenes.join(", "),
                started.elapsed().as_secs_f64()
            )?;
        }
    }
    let mut names: Vec<&str> = groups.iter().flat_map(Group::names).collect();
    // A runner in several arithmetics.
    names.dedup();
    let cases: u64 = reports.iter().map(|checked| checked.report.cases).sum();
    let right =
        broken.is_empty() && reports.iter().all(|checked| checked.report.failures.is_empty());
    // Whoever refuses everything has shown nothing.
    let silent = cases == 0 && options.runner.is_some() && !names.is_empty();
    let verdict = match (right, silent) {
        (true, false) => "all agree with all pairs tested",
        (_, true) => "WRONG: it has refused all of them",
        _ => "WRONG",
    };
    writeln!(
        out,
        "check: {cases} detections by {}: {verdict}",
        if names.is_empty() { "nobody".into() } else { names.join(", ") }
    )?;
    let right = right && !silent;
    if options.json {
        let value = as_json(&reports, &broken, right, options);
        writeln!(std::io::stdout(), "{}", serde_json::to_string_pretty(&value)?)?;
    }
    options.ci.write("check", &verdicts(&reports, &broken, silent, options), &mut out)?;
    Ok(if right { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The file that a failing scene is written to.
fn regression_file(failure: &Failure, given: Option<&Path>, options: &Check) -> PathBuf {
    let stem = given
        .and_then(Path::file_stem)
        .map(|stem| format!("-{}", stem.to_string_lossy()))
        .unwrap_or_default();
    options.out.join(format!(
        "failing-{}-{}{stem}.csv",
        failure.detector.replace([':', '=', ','], "-"),
        failure.arithmetic.name()
    ))
}

/// Every detector in every arithmetic, on every given scene or on those of the battery, for
/// continuous integration.
fn verdicts(reports: &[Checked<'_>], broken: &[Wrong], silent: bool, options: &Check) -> Vec<Case> {
    let case = |wrong: &Wrong| Case {
        class: "protocol".into(),
        name: "conversation".into(),
        result: Outcome::Failed(wrong.to_string()),
    };
    let mut cases: Vec<Case> = broken.iter().map(case).collect();
    for Checked { group, report, path } in reports {
        let class = path.map_or("generated".into(), |path| path.display().to_string());
        for arithmetic in &group.arithmetics {
            for name in group.names() {
                let wrong = report
                    .failures
                    .iter()
                    .find(|failure| failure.detector == name && failure.arithmetic == *arithmetic);
                let why = |failure: &Failure| {
                    let file = regression_file(failure, *path, options);
                    format!(
                        "on {}: {}; smallest failing scene: {}",
                        failure.found_on,
                        failure.found,
                        file.display()
                    )
                };
                let elsewhere = report.failures.iter().find(|failure| failure.detector == name);
                let result = match (wrong, elsewhere) {
                    (Some(failure), _) => Outcome::Failed(why(failure)),
                    (None, Some(other)) => Outcome::Skipped(format!(
                        "not asked to the end: it is wrong in {}",
                        other.arithmetic.name()
                    )),
                    (None, None) if silent => Outcome::Failed("it has refused all scenes".into()),
                    (None, None) => Outcome::Passed,
                };
                cases.push(Case {
                    class: class.clone(),
                    name: format!("{name}, {} arithmetic", arithmetic.name()),
                    result,
                });
            }
        }
    }
    cases
}

fn as_json(reports: &[Checked<'_>], broken: &[Wrong], right: bool, options: &Check) -> Value {
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
    let of = |Checked { group, report, path }: &Checked<'_>| {
        let arithmetics: Vec<&str> = group.arithmetics.iter().map(|known| known.name()).collect();
        let failures: Vec<Value> =
            report.failures.iter().map(|found| failure(found, path)).collect();
        json!({
            "scene": path.map_or("generated".into(), |path| path.display().to_string()),
            "detectors": group.names().collect::<Vec<_>>(),
            "arithmetics": arithmetics,
            "scenes": report.scenes,
            "detections": report.cases,
            "refused": report.refused,
            "failures": failures,
        })
    };
    // Each name once, in the order of the check.
    fn union<'a>(of: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
        let mut names = Vec::new();
        of.for_each(|name| {
            if !names.contains(&name) {
                names.push(name)
            }
        });
        names
    }
    let detectors = union(reports.iter().flat_map(|checked| checked.group.names()));
    let arithmetics =
        union(reports.iter().flat_map(|checked| {
            checked.group.arithmetics.iter().map(|arithmetic| arithmetic.name())
        }));
    let protocol: Vec<String> = broken.iter().map(Wrong::to_string).collect();
    let checks: Vec<Value> = reports.iter().map(of).collect();
    json!({
        "passed": right,
        "detectors": detectors,
        "arithmetics": arithmetics,
        "protocol": protocol,
        "checks": checks,
    })
}

/// Detectors of the table.
fn detectors(options: &Check) -> anyhow::Result<Group> {
    let chosen = options
        .detector
        .iter()
        .map(|name| Ok(Contender::from(table::parse(name)?)))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let chosen = if chosen.is_empty() {
        TABLE.iter().filter(|entry| entry.must_be_right()).map(Contender::from).collect()
    } else {
        chosen
    };
    let arithmetics = if options.arithmetic.is_empty() {
        vec![Arithmetic::Exact]
    } else {
        options.arithmetic.clone()
    };
    Ok(Group { contenders: chosen, arithmetics })
}

/// What stands for an arithmetic in a command.
const ARITHMETIC: &str = "{arithmetic}";

/// Starts a runner in each arithmetic, talks with it, and says what it offers.
fn runners(
    command: &str,
    options: &Check,
    limits: &Limits,
    broken: &mut Vec<Wrong>,
    out: &mut dyn Write,
) -> anyhow::Result<Vec<Group>> {
    let words = match shlex::split(command) {
        Some(words) if !words.is_empty() => words,
        Some(_) => bail!(
            "--runner is empty: give the command that starts the runner, as in --runner \"python3 \
             my_detector.py\""
        ),
        None => bail!("--runner '{command}': a quote is not closed"),
    };
    let asks = words.iter().any(|word| word.contains(ARITHMETIC));
    ensure!(
        asks || options.arithmetic.is_empty(),
        "--arithmetic: a runner says its own in its first line; if its command takes one, write \
         {ARITHMETIC} there, as in --runner \"my-detector --arithmetic {ARITHMETIC}\""
    );
    let asked: Vec<Option<Arithmetic>> = match (asks, options.arithmetic.is_empty()) {
        (false, _) => vec![None],
        (true, true) => Arithmetic::SAFE.map(Some).into(),
        (true, false) => options.arithmetic.iter().copied().map(Some).collect(),
    };
    let mut groups = Vec::new();
    for arithmetic in asked {
        let name = arithmetic.map_or("", Arithmetic::name);
        let words = words.iter().map(|word| word.replace(ARITHMETIC, name)).collect();
        let met = match Foreign::meet(words)? {
            Met::Runner(foreign) if arithmetic.is_some_and(|asked| asked != foreign.arithmetic) => {
                let said = foreign.arithmetic.name();
                Met::Wrong(Wrong::Breaks(format!(
                    "started with {name} as its arithmetic, it says {said} in its first line"
                )))
            }
            met => met,
        };
        let foreign = match met {
            Met::Runner(foreign) => foreign,
            Met::Wrong(wrong) => {
                wrongs(std::slice::from_ref(&wrong), out)?;
                broken.push(wrong);
                continue;
            }
        };
        let manners = conversation::hold(&foreign, limits.deadline)?;
        let Foreign { name, version, arithmetic, .. } = &foreign;
        let version = if version.is_empty() { String::new() } else { format!(" {version}") };
        let lacks: Vec<&str> = ["count", "memory", "pairs"]
            .into_iter()
            .filter(|ability| !manners.abilities.contains(ability))
            .collect();
        let lacks = if lacks.is_empty() {
            "has all requests".into()
        } else {
            format!("without {}", lacks.join(" and "))
        };
        writeln!(out, "runner: {name}{version}, {} arithmetic, {lacks}", arithmetic.name())?;
        wrongs(&manners.broken, out)?;
        broken.extend(manners.broken);
        groups.push(Group {
            arithmetics: vec![*arithmetic],
            contenders: vec![Contender::Runner(foreign)],
        });
    }
    Ok(groups)
}

/// What is wrong with a runner whatever the scene.
fn wrongs(wrongs: &[Wrong], out: &mut dyn Write) -> anyhow::Result<()> {
    for wrong in wrongs {
        writeln!(out, "WRONG: {wrong}")?;
        last_words(wrong, out)?;
    }
    Ok(())
}

/// What a runner said on its standard error before it died.
fn last_words(wrong: &Wrong, out: &mut dyn Write) -> anyhow::Result<()> {
    if let Wrong::Dies { errors, .. } = wrong
        && errors.lines().count() > 1
    {
        writeln!(out, "  the last lines of its standard error:")?;
        for line in errors.lines() {
            writeln!(out, "    {line}")?;
        }
    }
    Ok(())
}

/// Refusals of a kind differ in numbers only.
fn refusals(report: &Report, out: &mut dyn Write) -> anyhow::Result<()> {
    let mut kinds: BTreeMap<String, (&str, u64)> = BTreeMap::new();
    for (reason, times) in &report.refused {
        let kind = reason
            .chars()
            .map(|c| if c.is_ascii_digit() { '0' } else { c })
            .filter(|c| !"0.-+e".contains(*c))
            .collect();
        kinds.entry(kind).or_insert((reason, 0)).1 += times;
    }
    let mut kinds: Vec<(&str, u64)> = kinds.into_values().collect();
    kinds.sort_by_key(|&(_, times)| std::cmp::Reverse(times));
    for (reason, times) in kinds.iter().take(KINDS) {
        writeln!(out, "refused {times} times: {reason}")?;
    }
    if kinds.len() > KINDS {
        let rest: u64 = kinds[KINDS..].iter().map(|(_, times)| times).sum();
        writeln!(out, "refused {rest} times for {} other reasons", kinds.len() - KINDS)?;
    }
    Ok(())
}

/// A detector that panics is reported like any other that is wrong, and shrinking makes it panic
/// often.
fn quiet_panics() {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if std::thread::current().name() != Some(contender::THREAD) {
            hook(panic);
        }
    }));
}

/// The scene with its contacts, and what is wrong with the pairs. None where nobody could draw it.
fn picture(failure: &Failure) -> Option<String> {
    let Failure { detector, arithmetic, found, smallest, wrong, .. } = failure;
    let mut contacts = oracle::truth(smallest, *arithmetic).ok()?.pairs;
    let wrong = wrong.as_ref().unwrap_or(found);
    let Differences { missed, spurious, selves, duplicate } = match wrong {
        Wrong::Pairs(differences) => differences.clone(),
        _ => Differences::default(),
    };
    contacts.retain(|pair| missed.binary_search(pair).is_err());
    let near = Highlighted::of(smallest).ok()?.near;
    let pairs = Highlighted {
        contacts,
        near,
        missed,
        spurious: [spurious, selves].concat(),
        duplicates: duplicate,
    };
    let title = format!("{detector}, {}: {wrong}", arithmetic.name());
    draw::svg(smallest, &pairs, &Look::titled(title)).ok()
}

fn describe(
    failure: &Failure,
    given: Option<&Path>,
    options: &Check,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let Failure { detector, arithmetic, found_on, found, smallest, wrong } = failure;
    let arithmetic = arithmetic.name();
    writeln!(out, "WRONG: {detector} with {arithmetic} arithmetic, on {found_on}: {found}")?;
    last_words(wrong.as_ref().unwrap_or(found), out)?;
    let path = regression_file(failure, given, options);
    let who = match &options.runner {
        None => format!("--detector {detector} --arithmetic {arithmetic}"),
        Some(command) => format!("--runner {}", shlex::try_quote(command).unwrap_or_default()),
    };
    let scene = regression::file(failure, &path, &who);
    std::fs::write(&path, &scene).with_context(|| {
        format!("cannot write {}; choose another place with --out", path.display())
    })?;
    let (n, place) = (smallest.len(), path.display());
    match wrong {
        Some(Wrong::Hangs(_)) => {
            writeln!(out, "  the scene, not made smaller: {n} elements: {place}")?
        }
        Some(wrong) => writeln!(out, "  smallest failing scene: {n} elements, {wrong}: {place}")?,
        None => writeln!(
            out,
            "  only after earlier scenes: something is left in its buffers; the scene: {n} \
             elements: {place}"
        )?,
    }
    if let Some(picture) = picture(failure) {
        let path = path.with_extension("svg");
        std::fs::write(&path, picture).with_context(|| {
            format!("cannot write {}; choose another place with --out", path.display())
        })?;
        writeln!(
            out,
            "  drawn, missed pairs red and dashed, spurious ones orange: {}",
            path.display()
        )?;
    }
    for line in scene.lines().filter(|line| !line.starts_with('#')).take(12) {
        writeln!(out, "    {line}")?;
    }
    writeln!(out, "  again:  contactbench check --scene {place} {who}")?;
    if options.runner.is_none() {
        writeln!(
            out,
            "  see it: contactbench detect {place} --detector {detector} --arithmetic {arithmetic}"
        )?;
    }
    writeln!(
        out,
        "  truth:  contactbench detect {place} --detector direct --arithmetic {arithmetic}"
    )?;
    Ok(())
}
