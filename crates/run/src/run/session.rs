//! A run and its result folder, new or resumed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use serde_json::Value;

use crate::plan::{builtin, detectors};
use crate::run::machine::{interrupt, temporary};
use crate::run::origins::{Origins, fingerprint};
use crate::run::plan::{self, Job, Planned, describe};
use crate::run::stage::{Log, Progress, Stage};
use crate::run::subject::is_build;
use contactbench_io::write;
use contactbench_record::experiment::Experiment;
use contactbench_record::experiment::shard::Shard;
use contactbench_record::record::faults;
use contactbench_record::record::folder::done::{Index, TooSlow};
use contactbench_record::record::folder::ledger::{self, Ledger};
use contactbench_record::record::folder::{self, copies};
use contactbench_record::record::origin::{machines, provenance};
use contactbench_record::record::row::{self, Record, Row, Writer};

pub struct Asked {
    pub experiments: Vec<(Experiment, String)>,
    pub quick: bool,
    /// Whether to continue if the folder has rows of the same run.
    pub resume: bool,
    pub against: Option<PathBuf>,
    pub shard: Option<Shard>,
}

/// The error of a run that can be resumed after its cause is removed.
#[derive(Debug, thiserror::Error)]
#[error("{0:#}")]
pub struct Stopped(pub anyhow::Error);

pub fn find(names: &[String]) -> anyhow::Result<Vec<(Experiment, String)>> {
    let found = names.iter().map(|name| builtin::find(name)).collect::<anyhow::Result<Vec<_>>>()?;
    for (k, (experiment, _)) in found.iter().enumerate() {
        let name = &experiment.name;
        ensure!(
            found[..k].iter().all(|(other, _)| other.name != *name),
            "there are two experiments named '{name}'; run them one by one"
        );
    }
    Ok(found)
}

/// Returns the result folder: a new one, named after date, machine and shard, so that jobs of an
/// array do not share it; with `resume`, the last one with this name and shard.
pub fn folder(name: &str, shard: Option<Shard>, resume: bool) -> anyhow::Result<PathBuf> {
    let results = Path::new("results").join(name);
    let suffix = shard.map_or(String::new(), |shard| format!("-shard-{}", shard.file_name()));
    if !resume {
        let name = format!("{}-{}{suffix}", provenance::date(), provenance::machine());
        return Ok(results.join(name));
    }
    let nothing = || format!("there is nothing to resume in {}", results.display());
    let folders = std::fs::read_dir(&results).with_context(nothing)?;
    let mine = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if suffix.is_empty() { !name.contains("-shard-") } else { name.ends_with(&suffix) }
    };
    let last = folders
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(mine)
        .filter(|path| path.join(row::FILE).exists())
        .max();
    last.with_context(nothing)
}

/// Runs the experiments into `folder`. `note` receives sentences about existing rows. Returns the
/// number of scenes, which may be 0 for a shard.
///
/// # Errors
/// Errors that can be foreseen are returned before anything is measured.
pub fn run(
    asked: &Asked,
    folder: &Path,
    progress: &mut dyn Progress,
    note: &mut dyn FnMut(String),
) -> anyhow::Result<usize> {
    let path = folder.join(row::FILE);
    let label = machines::label_here(folder);
    let against = asked.against.as_deref().map(other_build).transpose()?;
    let done = previous(&path, asked.resume, &label, note)?;
    let base = against.as_deref().map(fingerprint).transpose().context("cannot read --against")?;
    if !done.rows.is_empty() {
        Begun::new(folder).fits(asked, folder, &done.rows, base.as_deref().unwrap_or_default())?;
    }
    let program =
        std::env::current_exe().context("cannot find this program to start it as runner")?;
    let job = Job { quick: asked.quick, program, against, machine: label.clone() };
    let experiments = asked.experiments.iter().map(|(experiment, _)| experiment);
    if let Some(fault) = faults::clock() {
        bail!(fault);
    }
    let scenes = plan::plan(experiments, asked.quick, asked.shard)?;
    ensure!(
        !scenes.is_empty() || asked.shard.is_some(),
        "there is no scene to run: a list such as n = [] is empty; give it a value"
    );
    let scenes_folder = temporary()?;
    std::fs::create_dir_all(folder.join(folder::EXPERIMENTS)).with_context(|| {
        format!("cannot make the result folder {}; choose another with --out", folder.display())
    })?;
    let (record, mut origins) = opened(folder, done.rows.len())?;
    for span in faults::shortened(&done.rows, &Ledger::read(folder)) {
        origins.span(span)?;
    }
    interrupt::install().context("cannot listen to Ctrl-C")?;
    write_origin(asked, folder, &label, base, done.rows.is_empty())?;
    let (too_slow, noted) = (TooSlow::new(&done.rows), BTreeSet::new());
    let log = Log { record, origins, progress, too_slow, noted, span: None, latest: Vec::new() };
    measure(&job, &scenes, &done.rows, scenes_folder.path(), log).map_err(|error| {
        let of_disk = |cause: &(dyn std::error::Error + 'static)| cause.is::<std::io::Error>();
        if error.chain().any(of_disk) { Stopped(error).into() } else { error }
    })?;
    Ok(scenes.len())
}

fn measure(
    job: &Job,
    scenes: &[Planned<'_>],
    done: &[Row],
    folder: &Path,
    mut log: Log<'_>,
) -> anyhow::Result<()> {
    let index = &Index::new(done);
    for (k, scene) in scenes.iter().enumerate() {
        let (experiment, spec) = (scene.0, &scene.1);
        log.progress.scene(k, scenes.len(), &describe(experiment, spec));
        let mut stage = Stage { job, experiment, spec, index, folder, log: &mut log };
        stage.run().with_context(|| plan::place(scene))?;
    }
    log.progress.scene(scenes.len(), scenes.len(), "done");
    Ok(())
}

fn opened(folder: &Path, rows: usize) -> anyhow::Result<(Writer, Origins)> {
    let path = folder.join(row::FILE);
    let record = Writer::append(&path).with_context(|| {
        format!("cannot write {}; choose another folder with --out", path.display())
    })?;
    ensure!(
        record.rows() == rows as u64,
        "{} has grown while this run began: another writes to it",
        path.display()
    );
    let origins = Origins::append(folder)
        .with_context(|| format!("cannot write {}", folder.join(ledger::FILE).display()))?;
    Ok((record, origins))
}

fn write_origin(
    asked: &Asked,
    folder: &Path,
    label: &str,
    base: Option<String>,
    first: bool,
) -> anyhow::Result<()> {
    let full = |(experiment, text): &(Experiment, String)| {
        (experiment.name.clone(), detectors::in_full(text))
    };
    let texts: Vec<(String, String)> = asked.experiments.iter().map(full).collect();
    for (name, text) in &texts {
        save(&copy(folder, name), text.as_bytes())?;
    }
    let file = if first || !folder.join(provenance::FILE).exists() {
        provenance::FILE.into()
    } else {
        format!("provenance-resumed-{}.json", provenance::date())
    };
    let names: Vec<String> = texts.iter().map(|it| it.0.clone()).collect();
    let shard = asked.shard.map(|shard| shard.to_string());
    let mut provenance = provenance::gather(&names, asked.quick, shard, label);
    provenance[copies::FIELD] = copies::field(texts.iter().map(|(name, text)| (&**name, &**text)));
    if let Some(base) = base {
        provenance[BASE] = base.into();
    }
    save(&folder.join(file), provenance::text(&provenance)?.as_bytes())
}

fn other_build(path: &Path) -> anyhow::Result<PathBuf> {
    let named = path.display();
    let program = std::fs::canonicalize(path).with_context(|| {
        format!("--against {named}: there is no such program; give the path of one")
    })?;
    is_build(&program).map_err(|failure| {
        anyhow::anyhow!("--against {named} is not a build of contactbench: {}", failure.reason)
    })?;
    Ok(program)
}

const BASE: &str = "against_sha256";

/// How the record in a folder was begun, from its provenance.
struct Begun(Value);

impl Begun {
    fn new(folder: &Path) -> Begun {
        Begun(provenance::of_folder(folder).unwrap_or_default())
    }

    fn text(&self, key: &str) -> Option<&str> {
        self.0[key].as_str()
    }

    /// Fails if a run with these options would continue another run.
    fn fits(&self, asked: &Asked, folder: &Path, rows: &[Row], base: &str) -> anyhow::Result<()> {
        let place = folder.display();
        let remedy = "choose another folder with --out";
        let quick = self.0["quick"].as_bool().unwrap_or(asked.quick);
        let beside = rows.iter().any(|row| row.role.base_of().is_some());
        let options = [(quick, asked.quick, "--quick"), (beside, !base.is_empty(), "--against")];
        for (was, is, option) in options {
            let with = if was { "with" } else { "without" };
            ensure!(was == is, "{place} was begun {with} {option}; continue it so, or {remedy}");
        }
        let sha256 = self.text(BASE).unwrap_or(base);
        ensure!(
            !beside || sha256 == base,
            "{place} was begun beside another build (SHA-256 {sha256}) than that of --against \
             ({base}); {remedy}"
        );
        for (experiment, text) in &asked.experiments {
            let (name, copy) = (&experiment.name, copy(folder, &experiment.name));
            ensure!(copy.exists(), "{place} holds another experiment than {name}; {remedy}");
            let before = std::fs::read_to_string(copy).unwrap_or_else(|_| text.clone());
            ensure!(
                detectors::in_full(&before) == detectors::in_full(text),
                "{name} differs from the experiment that this record was begun with; {remedy}"
            );
        }
        Ok(())
    }
}

fn copy(folder: &Path, name: &str) -> PathBuf {
    folder.join(folder::EXPERIMENTS).join(format!("{name}.toml"))
}

fn previous(
    path: &Path,
    resume: bool,
    here: &str,
    note: &mut dyn FnMut(String),
) -> anyhow::Result<Record> {
    row::unpacked(path)?;
    if !path.exists() {
        return Ok(Record::default());
    }
    ensure!(
        resume,
        "{} holds a record already; continue it with --resume, or choose another folder with --out",
        path.display()
    );
    let of = path.parent().unwrap_or(Path::new("."));
    let record = row::read(path)?;
    // A run killed before its first row may have left copies without provenance; both are written
    // again.
    if !record.rows.is_empty() {
        folder::sound(of)?;
    }
    record.warnings.iter().for_each(|warning| note(warning.clone()));
    note(format!("resuming: {} rows are there already", record.rows.len()));
    let other = |row: &Row| row.id.machine.clone().filter(|machine| machine != here);
    if let Some(other) = record.rows.iter().find_map(other) {
        note(format!(
            "note: the record was begun on {other}, this is {here}: times of the two are kept \
             apart in the report"
        ));
    }
    if let (Some(begun), Some(now)) = (Begun::new(of).text("revision"), provenance::revision())
        && begun != now
    {
        note(format!(
            "note: the record was begun with revision {begun}, this is {now}: counts and times of \
             the two may differ"
        ));
    }
    Ok(record)
}

fn save(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    write::whole(path, |out| out.write_all(bytes))
        .with_context(|| format!("cannot write {}", path.display()))
}
