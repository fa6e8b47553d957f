use std::collections::BTreeMap;

use serde::Deserialize;

pub type Params = BTreeMap<String, Vec<toml::Value>>;

/// A generator with its parameters; each may be a list of values to sweep over.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct SceneSweep {
    /// The generator. `hard` without a `case` means all cases.
    pub name: String,
    pub dim: Vec<u32>,
    /// Numbers of particles; not allowed for `file` and `hard`, whose particles are given.
    pub n: Option<Vec<u64>>,
    pub seed: Vec<u64>,
    pub order: Vec<String>,
    pub quick: Quick,
    /// All other keys are parameters of the generator.
    #[serde(flatten)]
    pub params: Params,
    #[serde(skip)]
    pub line: usize,
}

impl Default for SceneSweep {
    fn default() -> SceneSweep {
        SceneSweep {
            name: String::new(),
            dim: vec![2],
            n: None,
            seed: vec![1],
            order: vec!["shuffled".into()],
            quick: Quick::default(),
            params: Params::new(),
            line: 0,
        }
    }
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Quick {
    pub dim: Option<Vec<u32>>,
    pub n: Option<Vec<u64>>,
    pub seed: Option<Vec<u64>>,
    pub order: Option<Vec<String>>,
    #[serde(flatten)]
    pub params: Params,
}

impl SceneSweep {
    pub fn quickened(&self) -> SceneSweep {
        let mut sweep = self.clone();
        let quick = self.quick.clone();
        sweep.n = quick.n.or(sweep.n);
        sweep.dim = quick.dim.unwrap_or(sweep.dim);
        sweep.seed = quick.seed.unwrap_or(sweep.seed);
        sweep.order = quick.order.unwrap_or(sweep.order);
        sweep.params.extend(quick.params);
        sweep
    }
}
