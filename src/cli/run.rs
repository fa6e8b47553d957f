//! `contactbench run`, and `contactbench` alone.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, bail, ensure};

use crate::cli::report::finish;
use crate::cli::shared::ci::Outputs;
use crate::cli::shared::progress::Terminal;
use crate::cli::shared::{terminal, values};
use crate::experiment::shard::Part;
use crate::experiment::{Experiment, builtin, detectors};
use crate::record::row::{Record, Row, WriteError, Writer};
use crate::record::{copies, folder, ledger, machines, provenance, row};
use crate::run::contender::is_build;
use crate::run::interrupt::Interrupted;
use crate::run::origins::{Origins, fingerprint};
use crate::run::plan::Job;
use crate::run::{bandwidth, interrupt, job};

/// Options of `run`.
#[derive(clap::Args)]
pub struct Run {
    /// Names of experiments (see `contactbench list experiments`), or TOML files
    #[arg(required = true, value_parser = values::EXPERIMENT, hide_possible_values = true)]
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
    /// Time another build of this program side by side with this one: in each block both take
    /// turns in fresh processes on one processor; `contactbench compare FOLDER` says what differs
    #[arg(long, value_name = "PROGRAM", conflicts_with = "shard")]
    against: Option<PathBuf>,
    /// Only part k of n of the scenes, as in 2/8, or auto: the part that the job array (Slurm, PBS,
    /// Grid Engine, LSF) or MPI gives to this process, in a folder of its own below --out (auto/8
    /// where the array does not say how long it is); `contactbench merge` puts the parts together
    #[arg(long, value_name = "K/N")]
    shard: Option<Part>,
    #[command(flatten)]
    ci: Outputs,
}

/// Runs the standard reproduction; a quick one has small scenes and few blocks.
pub fn standard(quick: bool) -> anyhow::Result<ExitCode> {
    let names = builtin::all()?
        .into_iter()
        .filter(|experiment| experiment.standard)
        .map(|experiment| experiment.name)
        .collect();
    let time = if quick { "a quick look in seconds" } else { "about four minutes" };
    say!(
        "the standard reproduction: the book's scaling experiments, {time}; results go to a new \
         folder under results/standard"
    );
    let options = Run {
        experiments: names,
        quick,
        resume: false,
        out: None,
        against: None,
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
    let asked = found.iter().flat_map(|(experiment, _)| &experiment.detectors);
    detectors::not_built(asked).iter().for_each(|missing| say!("{missing}"));
    let folder = folder(options, name)?;
    let path = folder.join(row::FILE);
    let label = machines::label_here(&folder);
    let against = options.against.as_deref().map(other_build).transpose()?;
    let done = previous(&path, options.resume, &label)?;
    let base = against.as_deref().map(fingerprint).transpose().context("cannot read --against")?;
    same_base(&folder, &done.rows, base.as_deref())?;
    same_extent(&folder, &done.rows, options.quick)?;
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
            detectors::in_full(&before) == detectors::in_full(text),
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
        against,
        shard: options.shard.map(|part| part.shard),
        done: &done.rows,
        machine: label.clone(),
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
    let mut origins = Origins::append(&folder)
        .with_context(|| format!("cannot write {}", folder.join(ledger::FILE).display()))?;
    interrupt::install().context("cannot listen to Ctrl-C")?;
    let texts: Vec<String> = found.iter().map(|(_, text)| detectors::in_full(text)).collect();
    for ((experiment, _), text) in found.iter().zip(&texts) {
        write(&copy(&folder, experiment), text.as_bytes())?;
    }
    let names: Vec<String> = experiments.iter().map(|experiment| experiment.name.clone()).collect();
    // Also where what is resumed has not come so far.
    let first = !folder.join(provenance::FILE).exists();
    let bandwidth = if first { bandwidth::asked(&experiments) } else { Vec::new() };
    let provenance_file = if first {
        provenance::FILE.into()
    } else {
        format!("provenance-resumed-{}.json", provenance::date())
    };
    let shard = options.shard.map(|part| part.shard.to_string());
    let mut provenance = provenance::gather(&names, options.quick, shard, &bandwidth, &label);
    let copies = names.iter().map(String::as_str).zip(texts.iter().map(String::as_str));
    provenance[copies::FIELD] = copies::field(copies);
    if let Some(base) = base {
        provenance[BASE] = base.into();
    }
    write(&folder.join(provenance_file), provenance::text(&provenance)?.as_bytes())?;
    // Its bar is gone before anything else is printed.
    let outcome = ready.run(&mut record, &mut origins, &mut Terminal::default());
    match outcome {
        Ok(()) if ready.scenes() == 0 => {
            let mut out = terminal::out();
            writeln!(out, "there are more shards than scenes: nothing is to be run in this one")?;
            options.ci.write("run", &[])?;
            Ok(ExitCode::SUCCESS)
        }
        Ok(()) => finish(&folder, &options.ci),
        Err(error) if error.is::<Interrupted>() => {
            // A report of what there is; whether claims hold is not known yet.
            if let Err(error) = finish(&folder, &Outputs::default()) {
                say!("no report: {error:#}");
            }
            say!(
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

/// Another build of this program, by an absolute path.
fn other_build(path: &Path) -> anyhow::Result<PathBuf> {
    let named = path.display();
    let program = std::fs::canonicalize(path).with_context(|| {
        format!("--against {named}: there is no such program; give the path of one")
    })?;
    is_build(&program).map_err(|failure| {
        anyhow::anyhow!("--against {named} is no build of contactbench: {}", failure.reason)
    })?;
    Ok(program)
}

/// A record is of all that its experiments plan, or of a quick run.
fn same_extent(folder: &Path, rows: &[Row], quick: bool) -> anyhow::Result<()> {
    let begun = provenance::of_folder(folder).and_then(|all| all["quick"].as_bool());
    let (begun, other) = match begun.filter(|&begun| begun != quick && !rows.is_empty()) {
        None => return Ok(()),
        Some(true) => ("with --quick", "with it"),
        Some(false) => ("without --quick", "without it"),
    };
    bail!(
        "{} was begun {begun}; continue it {other}, or choose another folder with --out",
        folder.display()
    )
}

/// The field of the provenance with the fingerprint of the other build.
const BASE: &str = "against_sha256";

/// Rows of one build, and of it beside another, must not end in one record; nor rows beside two.
fn same_base(folder: &Path, rows: &[Row], now: Option<&str>) -> anyhow::Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    let beside = rows.iter().any(|row| row.role.base_of().is_some());
    let begun = provenance::of_folder(folder).and_then(|all| all[BASE].as_str().map(String::from));
    let folder = folder.display();
    match (now, begun) {
        (None, _) if beside => bail!(
            "{folder} was begun beside another build; continue it with --against and that build"
        ),
        (Some(_), _) if !beside => bail!(
            "{folder} was begun without another build; continue it without --against, or choose \
             another folder with --out"
        ),
        (Some(now), Some(begun)) if now != begun => bail!(
            "{folder} was begun beside another build than that of --against (SHA-256 {begun}, this \
             {now}); choose another folder with --out"
        ),
        _ => Ok(()),
    }
}

/// Where the experiment of a record is kept, with its groups of detectors written out.
fn copy(folder: &Path, experiment: &Experiment) -> PathBuf {
    folder.join("experiments").join(format!("{}.toml", experiment.name))
}

/// The command that continues a run.
fn again(options: &Run, folder: &Path) -> String {
    let mut words = vec!["contactbench".to_string(), "run".into()];
    words.extend(options.experiments.iter().cloned());
    words.extend(options.quick.then(|| "--quick".into()));
    words.extend(
        options.against.iter().flat_map(|path| ["--against".into(), path.display().to_string()]),
    );
    words.extend(options.shard.iter().flat_map(|part| ["--shard".into(), part.shard.to_string()]));
    words.extend(["--resume".into(), "--out".into(), folder.display().to_string()]);
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// A word as a shell reads it back.
pub(super) fn quoted(word: &str) -> String {
    let plain =
        !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || "-_./+=,:@%".contains(c));
    if plain { word.to_string() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

/// Where the results go: never over earlier ones. Jobs of an array may begin in the same second.
fn folder(options: &Run, name: &str) -> anyhow::Result<PathBuf> {
    let results = Path::new("results").join(name);
    let shard =
        options.shard.map_or(String::new(), |part| format!("-shard-{}", part.shard.file_name()));
    match (&options.out, options.shard) {
        (Some(folder), Some(Part { shard, told: true })) => Ok(folder.join(shard.file_name())),
        (Some(folder), _) => Ok(folder.clone()),
        (None, _) if options.resume => {
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
        (None, _) => {
            Ok(results.join(format!("{}-{}{shard}", provenance::date(), provenance::machine())))
        }
    }
}

fn previous(path: &Path, resume: bool, here: &str) -> anyhow::Result<Record> {
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
    let of = path.parent().unwrap_or(Path::new("."));
    folder::sound(of)?;
    let record = row::read(path)?;
    copies::unsealed(of, provenance::all(of).iter()).iter().for_each(|it| say!("note: {it}"));
    for warning in &record.warnings {
        say!("{warning}");
    }
    say!("resuming: {} rows are there already", record.rows.len());
    if let Some(row) = record
        .rows
        .iter()
        .find(|row| row.id.machine.as_ref().is_some_and(|machine| *machine != here))
    {
        say!(
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
        say!(
            "note: the record was begun with revision {begun}, this is {now}: counts and times of \
             the two may differ"
        );
    }
    Ok(record)
}

/// Writes a file as a whole: a killed run leaves none or all of it.
fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let part = path.with_extension("part");
    std::fs::write(&part, bytes)
        .and_then(|()| std::fs::rename(&part, path))
        .with_context(|| format!("cannot write {}", path.display()))
}
