//! Scenes of an experiment: a generator, and lists of values to sweep over.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::experiment::List;

pub type Params = BTreeMap<String, List<toml::Value>>;

/// A generator and the values of its parameters; any of them may be a list.
#[derive(Clone, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SceneSweep {
    /// The generator: packed, loose, clustered, pack-a ... pack-d; file; or hard, which without a
    /// `case` means all cases.
    pub name: String,
    pub dim: List<u32>,
    /// Numbers of particles; not for `file` and `hard`, which bring their own.
    pub n: Option<List<u64>>,
    pub seed: List<u64>,
    pub order: List<String>,
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
