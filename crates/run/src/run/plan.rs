//! Checks before a run whether it can succeed.

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use serde_json::Value;

use crate::plan::specs;
use crate::run::machine::disk;
use crate::run::subject::subjects;
use contactbench_record::experiment::Experiment;
use contactbench_record::experiment::shard::Shard;
use contactbench_scenes::generate;
use contactbench_scenes::spec::Spec;

/// Maximum number of particles of scenes that are tried before a run, in some milliseconds.
const TRIED: u64 = 1000;
/// Assumed size of a row in bytes; the reference runs have 1.0 to 1.7 kB.
const ROW_BYTES: u64 = 2000;
const REPORT_BYTES: u64 = 8 << 20;

pub(crate) struct Job {
    pub quick: bool,
    pub program: PathBuf,
    pub against: Option<PathBuf>,
    pub machine: String,
}

pub(crate) type Planned<'a> = (&'a Experiment, Spec);

pub(crate) fn plan<'a>(
    experiments: impl Iterator<Item = &'a Experiment>,
    quick: bool,
    shard: Option<Shard>,
) -> anyhow::Result<Vec<Planned<'a>>> {
    let mut scenes = Vec::new();
    for experiment in experiments {
        let plan = specs(experiment, quick)
            .with_context(|| format!("in experiment {}", experiment.name))?;
        scenes.extend(plan.into_iter().map(|spec| (experiment, spec)));
    }
    if let Some(shard) = shard {
        let sizes: Vec<u64> = scenes.iter().map(|(_, spec)| spec.n).collect();
        let mut taken = shard.takes(&sizes).into_iter();
        scenes.retain(|_| taken.next() == Some(true));
    }
    for scene in &scenes {
        can_be_made(&scene.1).with_context(|| place(scene))?;
    }
    Ok(scenes)
}

pub(crate) fn place((experiment, spec): &Planned<'_>) -> String {
    format!("in experiment {}, scene {}", experiment.name, describe(experiment, spec))
}

/// Describes a scene with all parameters that differ from their defaults.
pub fn describe(experiment: &Experiment, spec: &Spec) -> String {
    let generator = generate::table::find(&spec.name);
    let defaults = generator.map(|found| found.defaults(spec.dim)).unwrap_or_default();
    described(experiment, spec, |name, value| defaults.get(name) != Some(value))
}

/// Text that seeds the order within blocks. A changed text would change the order of old runs.
pub(crate) fn seeding(experiment: &Experiment, spec: &Spec) -> String {
    let named = |name: &str| matches!(name, "s" | "path" | "case" | "offset" | "diameter");
    described(experiment, spec, |name, _| named(name))
}

fn described(experiment: &Experiment, spec: &Spec, shown: impl Fn(&str, &Value) -> bool) -> String {
    let n = if spec.n == 0 { String::new() } else { format!(" N={}", spec.n) };
    // The dimension of a file is not known before the file is read.
    let is_file = spec.params.contains_key("path");
    let dim = if is_file { String::new() } else { format!(" {}D", spec.dim) };
    let swept = spec
        .params
        .iter()
        .filter(|(name, value)| shown(name, value))
        .map(|(name, value)| format!(" {name}={value}"));
    let course = spec.course.iter().map(|course| format!(" {}", course.motion));
    let swept: String = swept.chain(course).collect();
    format!("{}: {}{dim}{n}{swept}", experiment.name, spec.name)
}

fn can_be_made(spec: &Spec) -> anyhow::Result<()> {
    if generate::table::find(&spec.name)?.own_n {
        let Some(path) = spec.params.get("path").and_then(|path| path.as_str()) else {
            return Ok(());
        };
        std::fs::File::open(path).with_context(|| format!("cannot read {path}"))?;
        return Ok(());
    }
    let few = Spec { n: spec.n.min(TRIED), ..spec.clone() };
    few.frames(&few.given()?).map(drop)
}

/// Checks that files can be written to `folder` and `temporary`, and that there is space for the
/// rows in one (`done` exist already) and for the largest scene in the other.
pub(crate) fn room(
    job: &Job,
    scenes: &[Planned<'_>],
    done: usize,
    folder: &Path,
    temporary: &Path,
) -> anyhow::Result<()> {
    let rows = |(experiment, _): &Planned<'_>| -> u64 {
        let blocks = u64::from(experiment.enough_blocks(job.quick));
        let passes = |copies: bool| 2 + blocks * if copies { 2 } else { 1 };
        subjects(experiment, &job.program, job.against.as_deref())
            .iter()
            .map(|subject| passes(subject.copy.is_some()))
            .sum()
    };
    let rows = scenes.iter().map(rows).fold(0u64, u64::saturating_add);
    let rows = rows.saturating_sub(done as u64);
    let needed = rows.saturating_mul(ROW_BYTES).saturating_add(REPORT_BYTES);
    disk::ensure(
        folder,
        needed,
        "the record and the report",
        "free some space, or choose another folder with --out",
    )?;
    // Coordinates and radii of each frame in f64, and six pairs per particle of a wrong answer.
    let bytes = |(_, spec): &Planned<'_>| {
        let frames = spec.course.map_or(1, |course| course.frames);
        let frame = spec.n.saturating_mul(u64::from(spec.dim) * 8 + 8);
        frame.saturating_mul(frames).saturating_add(spec.n.saturating_mul(6 * 8))
    };
    let largest = scenes.iter().map(bytes).max().unwrap_or(0);
    disk::ensure(
        temporary,
        largest,
        "the largest scene",
        "free some space, or set TMPDIR to a place with more",
    )
}

/// Fails if the scene is not the one in the record, because its file or generator has changed.
pub(crate) fn same_scene(now: &str, before: Option<&str>) -> anyhow::Result<()> {
    let before = before.unwrap_or(now);
    ensure!(
        before == now,
        "the scene is not the one in the record (fingerprint {now}, there {before}): its file or \
         the program has changed since; begin a new record with --out"
    );
    Ok(())
}
