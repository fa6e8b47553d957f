//! Checks before a run whether it can succeed.

use std::path::PathBuf;

use anyhow::{Context, ensure};
use serde_json::Value;

use crate::plan::specs;
use contactbench_record::experiment::Experiment;
use contactbench_record::experiment::shard::Shard;
use contactbench_scenes::generate;
use contactbench_scenes::spec::Spec;

/// Maximum number of particles of scenes that are tried before a run, in some milliseconds.
const TRIED: u64 = 1000;

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
    let trajectory = spec.trajectory.iter().map(|trajectory| format!(" {}", trajectory.motion));
    let swept: String = swept.chain(trajectory).collect();
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
