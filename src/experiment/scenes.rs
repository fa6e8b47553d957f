//! Scenes of an experiment: a generator, and lists of values to sweep over.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use anyhow::{Context, bail, ensure};
use serde::Deserialize;

use crate::experiment::{Experiment, List};
use crate::scene::spec::{Course, Order, Spec};
use crate::scene::{generate, hard};

/// Parameters of a generator, by name.
pub type Params = BTreeMap<String, List<toml::Value>>;

/// A generator and the values of its parameters; any of them may be a list.
#[derive(Clone, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SceneSweep {
    /// The generator: packed, loose, clustered, pack-a ... pack-d; file; or hard, which without a
    /// `case` means all cases.
    pub name: String,
    /// Dimensions.
    pub dim: List<u32>,
    /// Numbers of particles; not for `file` and `hard`, which bring their own.
    pub n: Option<List<u64>>,
    /// Seeds.
    pub seed: List<u64>,
    /// Orders of the particles.
    pub order: List<Order>,
    /// What a quick run takes instead.
    pub quick: Quick,
    /// The generator's parameters: in a file, all other keys.
    pub params: Params,
    /// The line in the file, for messages.
    #[serde(skip)]
    pub line: usize,
}

impl Default for SceneSweep {
    fn default() -> SceneSweep {
        SceneSweep {
            name: String::new(),
            dim: 2.into(),
            n: None,
            seed: 1.into(),
            order: Order::Shuffled.into(),
            quick: Quick::default(),
            params: Params::new(),
            line: 0,
        }
    }
}

/// Values that replace those of a sweep in a quick run.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Quick {
    /// Dimensions.
    pub dim: Option<List<u32>>,
    /// Numbers of particles.
    pub n: Option<List<u64>>,
    /// Seeds.
    pub seed: Option<List<u64>>,
    /// Orders of the particles.
    pub order: Option<List<Order>>,
    /// The generator's parameters.
    pub params: Params,
}

/// Scenes of an experiment, at most: a plan holds all of them.
const MOST_SCENES: u64 = 100_000;
/// Scenes times detectors, arithmetics and numbers of threads, at most.
const MOST_CELLS: u64 = 1_000_000;

impl Experiment {
    /// All scenes of the experiment, in the order run. Too many are refused before one is made.
    pub fn plan(&self, quick: bool) -> anyhow::Result<Vec<Spec>> {
        let of_run = |sweep: &SceneSweep| if quick { sweep.quickened() } else { sweep.clone() };
        let sweeps: Vec<SceneSweep> = self.scenes.iter().map(of_run).collect();
        self.bounded(&sweeps)?;
        let mut specs = Specs::default();
        for sweep in &sweeps {
            sweep.add(&mut specs).with_context(|| format!("line {}", sweep.line))?;
        }
        Ok(specs.all)
    }

    /// An error if there are more scenes, or more cells, than can be planned.
    fn bounded(&self, sweeps: &[SceneSweep]) -> anyhow::Result<()> {
        let mut scenes = 0u64;
        for sweep in sweeps {
            let factors = sweep.factors();
            let product = factors.iter().fold(1, |all, (_, count)| count.saturating_mul(all));
            scenes = scenes.saturating_add(product);
            if scenes > MOST_SCENES {
                let factors: Vec<String> = factors
                    .into_iter()
                    .filter(|(_, count)| *count > 1)
                    .map(|(name, count)| format!("{count} values of {name}"))
                    .collect();
                let sum = if scenes > product { " with those above" } else { "" };
                let of =
                    if factors.is_empty() { String::new() } else { factors.join(" x ") + ": " };
                bail!(
                    "line {}: scene {}: {of}{scenes} scenes{sum}, and an experiment has at most \
                     {MOST_SCENES}; shorten a list",
                    sweep.line,
                    sweep.name
                );
            }
        }
        let names = self.detectors.len().saturating_mul(self.arithmetics.len());
        let most = names.saturating_add(self.runners.len()).saturating_mul(self.threads.len());
        let entrants = if most as u64 > MOST_CELLS { most } else { self.entrants().len() };
        let cells = scenes.saturating_mul(entrants as u64);
        ensure!(
            cells <= MOST_CELLS,
            "{scenes} scenes x {entrants} detectors (with arithmetics and threads): {cells} cells, \
             and an experiment has at most {MOST_CELLS}; shorten a list"
        );
        Ok(())
    }
}

/// The scenes planned so far, each once.
#[derive(Default)]
struct Specs {
    all: Vec<Spec>,
    known: HashSet<String>,
}

impl SceneSweep {
    fn quickened(&self) -> SceneSweep {
        let mut sweep = self.clone();
        let quick = self.quick.clone();
        sweep.n = quick.n.or(sweep.n);
        sweep.dim = quick.dim.unwrap_or(sweep.dim);
        sweep.seed = quick.seed.unwrap_or(sweep.seed);
        sweep.order = quick.order.unwrap_or(sweep.order);
        sweep.params.extend(quick.params);
        sweep
    }

    /// Takes relative paths of files from this folder.
    pub(super) fn relative_to(&mut self, folder: &Path) -> anyhow::Result<()> {
        for params in [&mut self.params, &mut self.quick.params] {
            match params.get_mut("path").map(|list| list.0.as_mut_slice()) {
                None => {}
                Some([toml::Value::String(path)]) => {
                    *path = folder.join(&*path).display().to_string();
                }
                Some(_) => bail!("path must be one string"),
            }
            for curve in params.get_mut("grading").map_or(&mut [][..], |list| &mut list.0) {
                if let toml::Value::String(path) = curve
                    && !generate::grading::is_points(path)
                {
                    *path = folder.join(&*path).display().to_string();
                }
            }
        }
        Ok(())
    }

    /// The lists whose product the scenes are, with their lengths.
    fn factors(&self) -> Vec<(&str, u64)> {
        let len = |list: &[toml::Value]| list.len() as u64;
        let all_cases = self.name == generate::hard::NAME && !self.params.contains_key("case");
        let own = [
            ("n", self.n.as_ref().map_or(1, |list| list.len() as u64)),
            ("dim", self.dim.len() as u64),
            ("seed", self.seed.len() as u64),
            ("order", self.order.len() as u64),
            ("case", if all_cases { hard::cases().count() as u64 } else { 1 }),
        ];
        let params = self.params.iter().map(|(name, list)| (name.as_str(), len(list)));
        own.into_iter().chain(params).collect()
    }

    fn add(&self, specs: &mut Specs) -> anyhow::Result<()> {
        let generator = generate::table::find(&self.name)?;
        let numbers = match &self.n {
            Some(numbers) => numbers.to_vec(),
            None if generator.own_n => vec![0],
            None => bail!(
                "scene {}: n is missing; give the numbers of particles, as in n = [100, 1000]",
                self.name
            ),
        };
        for &dim in self.dim.iter() {
            let mut axes: Vec<(&str, Vec<toml::Value>)> =
                self.params.iter().map(|(name, list)| (name.as_str(), list.to_vec())).collect();
            if self.name == generate::hard::NAME && !self.params.contains_key("case") {
                let cases = hard::cases().filter(|case| case.dims.contains(&dim));
                axes.push(("case", cases.map(|case| case.name.into()).collect()));
            }
            for &order in self.order.iter() {
                for mut combination in product(&axes) {
                    let course = Course::take(&mut combination)?;
                    ensure!(
                        course.is_none() || self.name != generate::hard::NAME,
                        "scene {}: hard cases stay where they are; leave out motion",
                        self.name
                    );
                    for &n in &numbers {
                        for &seed in self.seed.iter() {
                            let spec = Spec::new(&self.name, dim, n, seed, order, &combination)?;
                            let spec = Spec { course, ..spec };
                            ensure!(
                                specs.known.insert(format!("{spec:?}")),
                                "scene {} stands there twice with the same parameters; leave one \
                                 out",
                                spec.name
                            );
                            specs.all.push(spec);
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// All combinations of one value per axis.
fn product(axes: &[(&str, Vec<toml::Value>)]) -> Vec<BTreeMap<String, toml::Value>> {
    let mut all = vec![BTreeMap::new()];
    for (name, values) in axes {
        all = all
            .into_iter()
            .flat_map(|head| {
                values.iter().map(move |value| {
                    let mut head = head.clone();
                    head.insert((*name).to_string(), value.clone());
                    head
                })
            })
            .collect();
    }
    all
}
