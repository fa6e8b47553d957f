//! The scenes of an experiment: all combinations of the values in its lists.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;

use anyhow::{Context, anyhow, bail, ensure};

use contactbench_record::experiment::{Experiment, SceneSweep};
use contactbench_record::record::id::CellId;
use contactbench_scenes::spec::{Order, Spec, Trajectory};
use contactbench_scenes::{generate, hard};

/// Maximum number of scenes: a report compares all of them with the record, in seconds.
const MOST_SCENES: u64 = 10_000;
/// Maximum of the number of scenes times detectors, arithmetics and numbers of threads.
const MOST_CELLS: u64 = 100_000;

/// Returns all scenes in the order in which they run, or an error if there are too many.
pub fn specs(experiment: &Experiment, quick: bool) -> anyhow::Result<Vec<Spec>> {
    let of_run = |sweep: &SceneSweep| if quick { sweep.quickened() } else { sweep.clone() };
    let sweeps: Vec<SceneSweep> = experiment.scenes.iter().map(of_run).collect();
    bounded(experiment, &sweeps)?;
    let (mut all, mut known) = (Vec::new(), HashSet::new());
    for sweep in &sweeps {
        let line = || format!("line {}", sweep.line);
        for spec in product(sweep).with_context(line)? {
            ensure!(
                known.insert(format!("{spec:?}")),
                "{}: scene {} stands there twice with the same parameters; leave one out",
                line(),
                spec.name
            );
            all.push(spec);
        }
    }
    Ok(all)
}

pub fn id(experiment: &Experiment, spec: &Spec) -> CellId {
    CellId {
        experiment: experiment.name.clone(),
        scene: spec.name.clone(),
        dim: spec.dim,
        params: spec.axes().iter().map(|(name, it)| (name.clone(), it.clone().into())).collect(),
        order: spec.order.name().into(),
        n: spec.n,
        seed: spec.seed,
        ..CellId::default()
    }
}

pub(super) fn own_n(experiment: &Experiment) -> BTreeSet<String> {
    let sweeps = experiment.scenes.iter();
    let generators = sweeps.filter_map(|sweep| generate::table::find(&sweep.name).ok());
    let own = generators.filter(|generator| generator.own_n);
    own.map(|generator| generator.name.to_string()).collect()
}

fn bounded(experiment: &Experiment, sweeps: &[SceneSweep]) -> anyhow::Result<()> {
    let mut scenes = 0u64;
    for sweep in sweeps {
        scenes = scenes.saturating_add(product_len(sweep));
        ensure!(
            scenes <= MOST_SCENES,
            "line {}: scene {}: {scenes} scenes with those above, and an experiment has at most \
             {MOST_SCENES}; shorten a list",
            sweep.line,
            sweep.name
        );
    }
    let names = experiment.detectors.len().saturating_mul(experiment.arithmetics.len());
    let most =
        names.saturating_add(experiment.runners.len()).saturating_mul(experiment.threads.len());
    let subjects = if most as u64 > MOST_CELLS { most } else { super::subjects(experiment).len() };
    let cells = scenes.saturating_mul(subjects as u64);
    ensure!(
        cells <= MOST_CELLS,
        "{scenes} scenes x {subjects} detectors (with arithmetics and threads): {cells} cells, \
         and an experiment has at most {MOST_CELLS}; shorten a list"
    );
    Ok(())
}

pub(super) fn relative_to(sweep: &mut SceneSweep, folder: &Path) -> anyhow::Result<()> {
    for params in [&mut sweep.params, &mut sweep.quick.params] {
        match params.get_mut("path").map(Vec::as_mut_slice) {
            None => {}
            Some([toml::Value::String(path)]) => {
                *path = folder.join(&*path).display().to_string();
            }
            Some(_) => bail!("path must be one string"),
        }
        for curve in params.get_mut("grading").into_iter().flatten() {
            if let toml::Value::String(path) = curve
                && !generate::grading::is_points(path)
            {
                *path = folder.join(&*path).display().to_string();
            }
        }
    }
    Ok(())
}

fn product_len(sweep: &SceneSweep) -> u64 {
    let own = [
        sweep.n.as_ref().map_or(1, |list| list.len()),
        sweep.dim.len(),
        sweep.seed.len(),
        sweep.order.len(),
        if takes_all_cases(sweep) { hard::cases().count() } else { 1 },
    ];
    let lens = own.into_iter().chain(sweep.params.values().map(|list| list.len()));
    lens.fold(1, |all, len| all.saturating_mul(len as u64))
}

fn takes_all_cases(sweep: &SceneSweep) -> bool {
    sweep.name == generate::hard::NAME && !sweep.params.contains_key("case")
}

fn product(sweep: &SceneSweep) -> anyhow::Result<Vec<Spec>> {
    let own_n = generate::table::find(&sweep.name)?.own_n;
    let numbers = match &sweep.n {
        Some(numbers) => numbers.to_vec(),
        None if own_n => vec![0],
        None => bail!(
            "scene {}: n is missing; give the numbers of particles, as in n = [100, 1000]",
            sweep.name
        ),
    };
    let numbered = |&n: &u64| sweep.seed.iter().map(move |&seed| (n, seed));
    let numbered: Vec<(u64, u64)> = numbers.iter().flat_map(numbered).collect();
    let mut all = Vec::new();
    for (dim, order) in sweep.dim.iter().flat_map(|dim| sweep.order.iter().map(move |o| (dim, o))) {
        let order: Order =
            order.parse().map_err(|words| anyhow!("scene {}: {words}", sweep.name))?;
        for mut params in combinations(&axes(sweep, *dim)) {
            let trajectory = Trajectory::take(&mut params)?;
            ensure!(
                trajectory.is_none() || sweep.name != generate::hard::NAME,
                "scene {}: hard cases stay where they are; leave out motion",
                sweep.name
            );
            for &(n, seed) in &numbered {
                let spec = Spec::new(&sweep.name, *dim, n, seed, order, &params)?;
                all.push(Spec { trajectory, ..spec });
            }
        }
    }
    Ok(all)
}

fn axes(sweep: &SceneSweep, dim: u32) -> Vec<(&str, Vec<toml::Value>)> {
    let params = sweep.params.iter().map(|(name, list)| (name.as_str(), list.to_vec()));
    let mut axes: Vec<(&str, Vec<toml::Value>)> = params.collect();
    if takes_all_cases(sweep) {
        let cases = hard::cases().filter(|case| case.dims.contains(&dim));
        axes.push(("case", cases.map(|case| case.name.into()).collect()));
    }
    axes
}

fn combinations(axes: &[(&str, Vec<toml::Value>)]) -> Vec<BTreeMap<String, toml::Value>> {
    axes.iter().fold(vec![BTreeMap::new()], |all, (name, values)| {
        let with = |(head, value): (&BTreeMap<_, _>, &toml::Value)| {
            let mut head = head.clone();
            head.insert(name.to_string(), value.clone());
            head
        };
        let pairs = all.iter().flat_map(|head| values.iter().map(move |value| (head, value)));
        pairs.map(with).collect()
    })
}
