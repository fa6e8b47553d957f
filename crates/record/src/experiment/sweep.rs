use std::collections::BTreeMap;

use serde::Deserialize;

use crate::experiment::List;

pub type Params = BTreeMap<String, List<toml::Value>>;

/// A generator with its parameters; each may be a list of values to sweep over.
#[derive(Clone, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SceneSweep {
    /// The generator. `hard` without a `case` means all cases.
    pub name: String,
    pub dim: List<u32>,
    /// Numbers of particles; not allowed for `file` and `hard`, whose particles are given.
    pub n: Option<List<u64>>,
    pub seed: List<u64>,
    pub order: List<String>,
    pub quick: Quick,
    pub params: Params,
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
            order: String::from("shuffled").into(),
            quick: Quick::default(),
            params: Params::new(),
            line: 0,
        }
    }
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Quick {
    pub dim: Option<List<u32>>,
    pub n: Option<List<u64>>,
    pub seed: Option<List<u64>>,
    pub order: Option<List<String>>,
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
