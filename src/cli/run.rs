//! `contactbench run`, `contactbench report`, and `contactbench` alone.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, bail, ensure};

use crate::cells;
use crate::cli::shared::ci::{Case, Outputs};
use crate::cli::shared::progress::Terminal;
use crate::cli::shared::{ci, terminal};
use crate::experiment::{Experiment, builtin};
use crate::findings::claim;
use crate::present::sections::claims::evidence;
use crate::present::{document, latex, report};
use crate::record::provenance::Bandwidth;
use crate::record::row::{Record, WriteError, Writer};
use crate::record::{provenance, row};
use crate::run::interrupt::Interrupted;
use crate::run::plan::Job;
use crate::run::shard::Shard;
use crate::run::{bandwidth, interrupt, job};

/// Options of `run`.
#[derive(clap::Args)]
pub struct Run {
    /// Names of experiments (see `contactbench list experiments`), or TOML files
    #[arg(required = true)]
    experiments: Vec<String>,
    /// Small scenes and few blocks: does everything work?
    #[arg(long)]
    quick: bool,
    /// Continue a killed run: what its record holds is not measured again
    #[arg(long)]
    resume: bool,
    /// The result folder (default: results/EXPERIMENT/DATE-MACHINE; with --resume the last one)
    #[arg(long)]
    out: Option<PathBuf>,
    /// Only part k of n of the scenes, as in 2/8: for the jobs of an array; `contactbench merge`
    /// puts the parts together
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    ci: Outputs,
}

/// Options of `report`.
#[derive(clap::Args)]
pub struct Report {
    /// A result folder
    folder: PathBuf,
    #[command(flatten)]
    ci: Outputs,
    /// Print the main results as a table for a paper or a README instead, and write nothing
    #[arg(long, value_enum, value_name = "FORMAT")]
    table: Option<latex::Format>,
}

/// The standard reproduction.
pub fn standard() -> anyhow::Result<ExitCode> {
    let names = builtin::all()?
        .into_iter()
        .filter(|experiment| experiment.standard)
        .map(|experiment| experiment.name)
        .collect();
    eprintln!(
        "the standard reproduction: the book's scaling experiments, about 3 minutes; results go \
         to a new folder under results/standard"
    );
    let options = Run {
        experiments: names,
        quick: false,
        resume: false,
        out: None,
        shard: None,
        ci: Outputs::default(),
    };
    run_named(&options, "standard")
}

/// Runs the experiments named.
pub fn run(options: &Run) -> anyhow::Result<ExitCode> {
    let stems = options
        .experiments
        .iter()
        .map(|name| Path::new(name).file_stem().unwrap_or_default().to_string_lossy().into_owned());
    run_named(options, &stems.collect::<Vec<_>>().join("+"))
}

fn run_named(options: &Run, name: &str) -> anyhow::Result<ExitCode> {
    let found = options
        .experiments
        .iter()
        .map(|name| builtin::find(name))
        .collect::<anyhow::Result<Vec<_>>>()?;
    for (k, (experiment, _)) in found.iter().enumerate() {
        let name = &experiment.name;
        ensure!(
            found[..k].iter().all(|(other, _)| other.name != *name),
            "there are two experiments named '{name}'; run them one by one"
        );
    }
    let folder = folder(options, name)?;
    let path = folder.join(row::FILE);
    let done = previous(&path, options.resume)?;
    for (experiment, text) in &found {
        // Rows of two different experiments must not end in one record.
        let begun = done.rows.is_empty() || copy(&folder, experiment).exists();
        ensure!(
            begun,
            "{} holds another experiment than {}; choose another folder with --out",
            path.display(),
            experiment.name
        );
        let before =
            std::fs::read_to_string(copy(&folder, experiment)).unwrap_or_else(|_| text.clone());
        ensure!(
            before == *text,
            "{} differs from the experiment that this record was begun with; choose another \
             folder with --out",
            experiment.name
        );
    }
    let experiments: Vec<Experiment> =
        found.iter().map(|(experiment, _)| experiment.clone()).collect();
    let program =
        std::env::current_exe().context("cannot find this program to start it as runner")?;
    let job = Job {
        experiments: &experiments,
        quick: options.quick,
        program,
        shard: options.shard,
        done: &done.rows,
    };
    let ready = job::prepare(&job)?;
    ensure!(
        ready.scenes() > 0 || options.shard.is_some(),
        "there is no scene to run: a list such as n = [] is empty; give it a value"
    );
    std::fs::create_dir_all(folder.join("experiments")).with_context(|| {
        format!("cannot make the result folder {}; choose another with --out", folder.display())
    })?;
    ready.room(&folder)?;
    let mut record = Writer::append(&path).with_context(|| {
        format!("cannot write {}; choose another folder with --out", path.display())
    })?;
    ensure!(
        record.rows() == done.rows.len() as u64,
        "{} has grown while this run began: another writes to it",
        path.display()
    );
    interrupt::install().context("cannot listen to Ctrl-C")?;
    for (experiment, text) in &found {
        write(&copy(&folder, experiment), text.as_bytes())?;
    }
    let names: Vec<String> = experiments.iter().map(|experiment| experiment.name.clone()).collect();
    // Also where what is resumed has not come so far.
    let first = !folder.join(provenance::FILE).exists();
    let bandwidth = if first { bandwidths(&experiments) } else { Vec::new() };
    let provenance_file = if first {
        provenance::FILE.into()
    } else {
        format!("provenance-resumed-{}.json", provenance::date())
    };
    let shard = options.shard.map(|shard| shard.to_string());
    let provenance = provenance::gather(&names, options.quick, shard, &bandwidth);
    write(&folder.join(provenance_file), serde_json::to_string_pretty(&provenance)?.as_bytes())?;
    match ready.run(&mut record, &mut Terminal::default()) {
        Ok(()) if ready.scenes() == 0 => {
            let mut out = std::io::stdout();
            writeln!(out, "there are more shards than scenes: nothing is to be run in this one")?;
            options.ci.write("run", &[], &mut out)?;
            Ok(ExitCode::SUCCESS)
        }
        Ok(()) => finish(&folder, &options.ci),
        Err(error) if error.is::<Interrupted>() => {
            // A report of what there is; whether claims hold is not known yet.
            if let Err(error) = finish(&folder, &Outputs::default()) {
                eprintln!("no report: {error:#}");
            }
            eprintln!(
                "interrupted: what was measured is in {}; continue with: {}",
                path.display(),
                again(options, &folder)
            );
            Ok(ExitCode::from(interrupt::exit_code()))
        }
        Err(error)
            if error.is::<WriteError>()
                || error.chain().any(|cause| cause.is::<std::io::Error>()) =>
        {
            Err(error.context(format!(
                "the run stopped; when this is mended, continue with: {}",
                again(options, &folder)
            )))
        }
        Err(error) => Err(error),
    }
}

/// Where the experiment of a record is kept.
fn copy(folder: &Path, experiment: &Experiment) -> PathBuf {
    folder.join("experiments").join(format!("{}.toml", experiment.name))
}

/// The command that continues a run.
fn again(options: &Run, folder: &Path) -> String {
    let mut words = vec!["contactbench".to_string(), "run".into()];
    words.extend(options.experiments.iter().cloned());
    words.extend(options.quick.then(|| "--quick".into()));
    words.extend(options.shard.iter().flat_map(|shard| ["--shard".into(), shard.to_string()]));
    words.extend(["--resume".into(), "--out".into(), folder.display().to_string()]);
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// A word as a shell reads it back.
fn quoted(word: &str) -> String {
    let plain =
        !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || "-_./+=,:@%".contains(c));
    if plain { word.to_string() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

/// The memory bandwidth with every number of threads for which an experiment asks for a bound.
fn bandwidths(experiments: &[Experiment]) -> Vec<Bandwidth> {
    let asked = experiments
        .iter()
        .filter(|experiment| experiment.bound)
        .flat_map(|experiment| experiment.threads.to_vec());
    let asked: BTreeSet<usize> = asked.collect();
    if !asked.is_empty() {
        eprintln!("measuring the memory bandwidth");
    }
    asked
        .into_iter()
        .filter_map(|threads| bandwidth::measure(threads, provenance::last_cache()))
        .collect()
}

/// Where the results go: never over earlier ones. Jobs of an array may begin in the same second.
fn folder(options: &Run, name: &str) -> anyhow::Result<PathBuf> {
    let results = Path::new("results").join(name);
    let shard = options.shard.map_or(String::new(), |shard| {
        format!("-shard-{}", shard.to_string().replace('/', "-of-"))
    });
    match &options.out {
        Some(folder) => Ok(folder.clone()),
        None if options.resume => {
            let folders = std::fs::read_dir(&results)
                .with_context(|| format!("there is nothing to resume in {}", results.display()))?;
            let name =
                |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let mine = |path: &PathBuf| {
                if shard.is_empty() {
                    !name(path).contains("-shard-")
                } else {
                    name(path).ends_with(&shard)
                }
            };
            let last = folders
                .filter_map(|entry| Some(entry.ok()?.path()))
                .filter(mine)
                .filter(|path| path.join(row::FILE).exists())
                .max();
            last.with_context(|| format!("there is nothing to resume in {}", results.display()))
        }
        None => {
            Ok(results.join(format!("{}-{}{shard}", provenance::date(), provenance::machine())))
        }
    }
}

fn previous(path: &Path, resume: bool) -> anyhow::Result<Record> {
    let nothing = Record { rows: Vec::new(), warnings: Vec::new() };
    if !path.exists() {
        return Ok(nothing);
    }
    if !resume {
        bail!(
            "{} holds a record already; continue it with --resume, or choose another folder with \
             --out",
            path.display()
        );
    }
    let record = row::read(path)?;
    for warning in &record.warnings {
        eprintln!("{warning}");
    }
    eprintln!("resuming: {} rows are there already", record.rows.len());
    let here = provenance::machine();
    if let Some(row) = record
        .rows
        .iter()
        .find(|row| row.id.machine.as_ref().is_some_and(|machine| *machine != here))
    {
        eprintln!(
            "note: the record was begun on {}, this is {here}: times of the two are kept apart in \
             the report",
            row.id.machine.as_deref().unwrap_or_default()
        );
    }
    let begun = provenance::of_folder(path.parent().unwrap_or(Path::new(".")))
        .and_then(|fields| fields.get("revision").cloned());
    if let (Some(serde_json::Value::String(begun)), Some(now)) = (begun, provenance::revision())
        && begun != now
    {
        eprintln!(
            "note: the record was begun with revision {begun}, this is {now}: counts and times of \
             the two may differ"
        );
    }
    Ok(record)
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    std::fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

/// Makes the report of a result folder again.
pub fn report(options: &Report) -> anyhow::Result<ExitCode> {
    let Some(format) = options.table else { return finish(&options.folder, &options.ci) };
    let (record, experiments) = read(&options.folder)?;
    let text = latex::tables(&experiments, &cells::cells(&record.rows), format);
    std::io::stdout().lock().write_all(text.as_bytes())?;
    Ok(ExitCode::SUCCESS)
}

/// The record of a result folder, and its experiments.
fn read(folder: &Path) -> anyhow::Result<(Record, Vec<Experiment>)> {
    let record = row::read(&folder.join(row::FILE))?;
    ensure!(
        !record.rows.is_empty(),
        "the record in {} holds no rows yet; run the experiment first",
        folder.display()
    );
    let mut names: Vec<&str> = Vec::new();
    for row in &record.rows {
        if !names.contains(&&*row.id.experiment) {
            names.push(&row.id.experiment);
        }
    }
    let read =
        |name: &&str| Experiment::read(&folder.join("experiments").join(format!("{name}.toml")));
    let experiments = names.iter().map(read).collect::<anyhow::Result<Vec<_>>>()?;
    Ok((record, experiments))
}

/// Everything right of the record: verdicts, figures, report.
pub(super) fn finish(folder: &Path, ci: &Outputs) -> anyhow::Result<ExitCode> {
    let (record, experiments) = read(folder)?;
    let again = || {
        format!(
            "the record is whole; when this is mended: contactbench report {}",
            quoted(&folder.display().to_string())
        )
    };
    let report =
        report::write(folder, &experiments, &record.rows, &record.warnings).with_context(again)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", document::plain(&report.terminal, terminal::width()))?;
    for warning in &report.warnings {
        writeln!(out, "note:    {warning}")?;
    }
    writeln!(out, "figures: {} in {}", report.figures.len(), folder.join("figures").display())?;
    writeln!(out, "report:  {}", report.path.display())?;
    writeln!(out, "page:    {}", report.page.display())?;
    let mut cases: Vec<Case> = report.verdicts.iter().map(case).collect();
    let wrong = record.rows.iter().filter(|row| row.outcome == row::Outcome::Wrong).count();
    if wrong > 0 {
        writeln!(out, "WRONG answers in {wrong} rows: see the report")?;
    }
    let ours = |row: &&row::Row| row.outcome == row::Outcome::Crashed && row.role.is_ours();
    let crashed = record.rows.iter().filter(ours).count();
    if crashed > 0 {
        writeln!(out, "CRASHED detectors in {crashed} rows: see the report")?;
    }
    for (name, rows) in [("every answer is right", wrong), ("no detector crashes", crashed)] {
        let why =
            || ci::Outcome::Failed(format!("not so in {rows} rows: see {}", report.path.display()));
        let result = if rows == 0 { ci::Outcome::Passed } else { why() };
        cases.push(Case { class: "record".into(), name: name.into(), result });
    }
    ci.write("run", &cases, &mut out)?;
    Ok(if wrong > 0 || crashed > 0 || claim::any_failed(&report.verdicts) {
        ExitCode::from(1)
    } else {
        ExitCode::SUCCESS
    })
}

/// A claim for continuous integration. Those about times gate nothing.
fn case(verdict: &claim::Verdict) -> Case {
    let why = || format!("{}: {}", verdict.status.name(), evidence(&verdict.evidence));
    let result = match verdict.status {
        claim::Status::Holds => ci::Outcome::Passed,
        claim::Status::Fails if verdict.machine_independent => ci::Outcome::Failed(why()),
        claim::Status::Fails => ci::Outcome::Noted(why()),
        claim::Status::NotShown => ci::Outcome::Skipped(why()),
    };
    Case { class: verdict.experiment.clone(), name: verdict.claim.clone(), result }
}
