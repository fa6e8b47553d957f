//! What a scene is asked to be: the generator, its parameters, the number of elements, the seed and the order.

use std::collections::BTreeMap;

use super::AnyScene;

/// The order of the elements in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// A seeded random permutation.
    #[default]
    Shuffled,
    /// As the generator makes them, or as they stand in the file.
    Generated,
    /// Along a Morton curve.
    Morton,
}

/// A scene to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// The generator's name.
    pub name: String,
    /// 2 or 3.
    pub dim: u32,
    /// Elements; for files 0 until read.
    pub n: u64,
    /// Seed of the generator and of the shuffle.
    pub seed: u64,
    /// Order of the elements.
    pub order: Order,
    /// All parameters with the values used, defaults included.
    pub params: BTreeMap<String, serde_json::Value>,
}

impl Spec {
    /// Checks the parameters and fills in the defaults.
    pub fn new(name: &str, dim: u32, n: u64, seed: u64, order: Order, params: &BTreeMap<String, toml::Value>) -> anyhow::Result<Spec> {
        let _ = (name, dim, n, seed, order, params);
        anyhow::bail!("stub")
    }

    /// Makes the scene.
    pub fn make(&self) -> anyhow::Result<AnyScene<'static>> {
        anyhow::bail!("stub")
    }
}
