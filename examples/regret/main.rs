//! What does it cost to do as `recommend` says, on scenes that it was not made with?
//!
//! `cargo build --release && cargo run --release --example regret -- FOLDER packed:dim=3,n=20000`
//!
//! Of each scene `recommend` is asked as on the command line, with little time; a second race, with
//! more, is the judge: regret is the time of the recommended detector over that of the fastest
//! there, within its blocks. With `--model DIR`, a result folder whose experiment asks for a cost
//! model, a detector is also chosen without a clock: its operations are counted, and priced by that
//! model. A ~ marks a regret of single samples: the detector fell out of the race that judges.
//! Scenes are files (`FILE@R` gives them the radius R), folders of files, of which those
//! that are no particles or have no radii are left out, and generators with their parameters.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Context, ensure};
use clap::Parser;
use contactbench::cells::machine::Machine;
use contactbench::cells::{Cell, cells};
use contactbench::contact::Arithmetic;
use contactbench::findings::cost::Fit;
use contactbench::findings::crossover::CostModel;
use contactbench::io;
use contactbench::memory::default_limit;
use contactbench::recommend::counted::foretold;
use contactbench::recommend::race::{self, Question};
use contactbench::recommend::standing::{Race, fastest};
use contactbench::recommend::verdict::Verdict;
use contactbench::record::{provenance, row};
use contactbench::scene::Given;
use contactbench::scene::spec::Spec;
use contactbench::stats::interval::ratio;

/// What is held to be good: by `recommend`, and by counts alone.
const LIMITS: [f64; 2] = [1.2, 1.4];

#[derive(Parser)]
struct Arguments {
    /// Files, FILE@RADIUS, folders, or scenes such as packed:n=1000.
    #[arg(required = true)]
    scenes: Vec<String>,
    /// For `recommend`.
    #[arg(long, default_value_t = 3.0)]
    seconds: f64,
    /// For the race that judges it.
    #[arg(long, default_value_t = 12.0)]
    judge: f64,
    /// A result folder with a cost model.
    #[arg(long)]
    model: Option<PathBuf>,
    /// The program that is started as runner (default: beside this one's folder).
    #[arg(long)]
    program: Option<PathBuf>,
}

fn main() -> anyhow::Result<ExitCode> {
    let arguments = Arguments::parse();
    let program = match &arguments.program {
        Some(program) => program.clone(),
        None => beside().context("cannot find this program")?,
    };
    ensure!(
        program.exists(),
        "there is no {}; build it with cargo build --release, or name it with --program",
        program.display()
    );
    let fits = arguments.model.as_deref().map(fits).transpose()?.unwrap_or_default();
    let mut regrets: [Vec<f64>; 2] = Default::default();
    println!(
        "{:44} {:>8} {:14} {:>7} {:14} {:>7} fastest",
        "scene", "N", "told", "", "counted", ""
    );
    for scene in &arguments.scenes {
        for (name, given) in read(scene)? {
            let told = |seconds: f64| told(&given, seconds, &program);
            let (quick, judge) = (told(arguments.seconds)?, told(arguments.judge)?);
            let Some(best) = fastest(&judge.standings) else { continue };
            let verdict = Verdict::new(&quick);
            let choice = verdict.map(|verdict| quick.standings[verdict.choice].who.name.clone());
            let limit = default_limit();
            let counted = foretold(&given.scene, &fits, limit).into_iter().next().map(|it| it.0);
            let mut line = format!("{name:44} {:8}", given.scene.len());
            for (choice, all) in [choice, counted].iter().zip(&mut regrets) {
                let regret = choice.as_deref().map(|choice| regret(&judge, best, choice));
                let shown = regret.map_or(String::new(), |(it, paired)| {
                    format!("{}{it:.2}", if paired { "" } else { "~" })
                });
                line += &format!(" {:14} {shown:>7}", choice.as_deref().unwrap_or("-"));
                all.extend(regret.map(|it| it.0));
            }
            println!("{line} {}", judge.standings[best].who.name);
        }
    }
    for ((all, limit), who) in regrets.iter().zip(LIMITS).zip(["recommend", "counts alone"]) {
        let within = all.iter().filter(|regret| **regret <= limit).count();
        let worst = all.iter().copied().fold(1.0, f64::max);
        if !all.is_empty() {
            println!(
                "{who}: at most {limit} in {within} of {} scenes; worst {worst:.2}",
                all.len()
            );
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// The program itself: examples lie in a folder below it.
fn beside() -> std::io::Result<PathBuf> {
    let own = std::env::current_exe()?;
    let folder = own.parent().and_then(Path::parent).unwrap_or(Path::new("."));
    Ok(folder.join(format!("contactbench{}", std::env::consts::EXE_SUFFIX)))
}

/// The race of `recommend` on a scene.
fn told(given: &Given, seconds: f64, program: &Path) -> anyhow::Result<Race> {
    let question = Question {
        given,
        history: &[],
        arithmetic: Arithmetic::Exact,
        threads: 1,
        memory_limit: default_limit(),
        time: Duration::from_secs_f64(seconds),
        program: vec![program.display().to_string()],
    };
    race::run(&question, &mut |_| {})
}

/// The time of a detector over that of the fastest, and whether it is that within blocks: in the
/// probes if it was left behind there; infinite if it has none.
fn regret(judge: &Race, best: usize, name: &str) -> (f64, bool) {
    let best = &judge.standings[best];
    let Some(own) = judge.standings.iter().find(|it| it.who.name == name) else {
        return (f64::INFINITY, false);
    };
    let probes = || Some(own.probe_ns? as f64 / best.probe_ns?.max(1) as f64);
    match ratio(&own.times, &best.times) {
        Some(within) => (within.median, true),
        None => (probes().unwrap_or(f64::INFINITY), false),
    }
}

/// The costs that a record's times are explained by.
fn fits(folder: &Path) -> anyhow::Result<Vec<Fit>> {
    let record = row::read(&folder.join(row::FILE))?;
    let cells = cells(&record.rows);
    let machine = Machine::from_provenance(provenance::of_folder(folder).as_ref());
    let model = CostModel::new(&cells.iter().collect::<Vec<&Cell>>(), &machine.caches);
    let model = model.with_context(|| format!("{} makes no cost model", folder.display()))?;
    Ok(model.fits)
}

/// The scenes that an argument means, with their names.
fn read(scene: &str) -> anyhow::Result<Vec<(String, Given)>> {
    let (path, radius) = match scene.rsplit_once('@').map(|(path, r)| (path, r.parse().ok())) {
        Some((path, radius @ Some(_))) => (Path::new(path), radius),
        _ => (Path::new(scene), None),
    };
    let short = |path: &Path| {
        let mut parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
        parts.drain(..parts.len().saturating_sub(2));
        parts.join("/")
    };
    let options = io::Options { radius, ..io::Options::NONE };
    if path.is_dir() {
        let mut found = Vec::new();
        let mut entries: Vec<PathBuf> =
            std::fs::read_dir(path)?.filter_map(|entry| Some(entry.ok()?.path())).collect();
        entries.sort();
        for entry in entries {
            if entry.is_dir() {
                found.extend(read(&entry.display().to_string())?);
                continue;
            }
            match io::given(&entry, options) {
                Ok(given) => found.push((short(&entry), given)),
                Err(error) => eprintln!("left out: {error:#}"),
            }
        }
        return Ok(found);
    }
    if path.exists() {
        return Ok(vec![(short(path), io::given(path, options)?)]);
    }
    Ok(vec![(scene.into(), Spec::parse(scene)?.given()?)])
}
