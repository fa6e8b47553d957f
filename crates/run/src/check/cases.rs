//! The generated scenes of the check: every generator, in 2D and 3D, small, with parameters that
//! make it hard.

use std::collections::BTreeMap;

use contactbench_scenes::spec::{Order, Spec};

/// A scene of the check: a generator with parameters.
pub(super) struct Case {
    generator: &'static str,
    pub(super) dims: &'static [u32],
    params: &'static [(&'static str, f64)],
    lattice: [&'static str; 2],
    periodic: bool,
}

const fn case(
    generator: &'static str,
    dims: &'static [u32],
    params: &'static [(&'static str, f64)],
) -> Case {
    Case { generator, dims, params, lattice: [""; 2], periodic: false }
}

/// Lattices at spacing 1 without jitter have neighbours exactly one diameter apart, or as near to
/// it as rounding allows.
pub(super) const CASES: &[Case] = &[
    case("packed", &[2, 3], &[]),
    case("packed", &[2, 3], &[("spacing", 1.0), ("jitter", 0.0)]),
    Case {
        lattice: ["square", "cubic"],
        ..case("packed", &[2, 3], &[("spacing", 1.0), ("jitter", 0.0)])
    },
    Case {
        lattice: ["square", "cubic"],
        ..case("packed", &[2, 3], &[("spacing", 1.0), ("jitter", 0.0), ("diameter", 0.1)])
    },
    case("packed", &[2, 3], &[("size-ratio", 3.0)]),
    case("loose", &[2, 3], &[]),
    case("loose", &[2, 3], &[("fraction", 0.6), ("size-ratio", 20.0)]),
    case("clustered", &[2, 3], &[("per-cluster", 20.0)]),
    case("clustered", &[2, 3], &[("per-cluster", 50.0), ("width", 0.5), ("fraction", 0.0001)]),
    case("couples", &[2, 3], &[("diameter", 0.1), ("offset", -1000.0)]),
    case("pack-a", &[2], &[]),
    case("pack-b", &[2], &[("s", 1.0)]),
    case("pack-c", &[2], &[("s", 1.0), ("diameter", 0.3)]),
    case("pack-d", &[2], &[("s", 3.0)]),
    Case {
        lattice: ["square", "cubic"],
        periodic: true,
        ..case("packed", &[2, 3], &[("spacing", 1.0), ("jitter", 0.0)])
    },
    // With few particles, boxes are smaller than the reach.
    Case { periodic: true, ..case("loose", &[2, 3], &[("fraction", 0.9), ("tilt", -0.375)]) },
    Case {
        periodic: true,
        ..case("clustered", &[2, 3], &[("per-cluster", 20.0), ("size-ratio", 5.0)])
    },
];

/// Small numbers of particles, the smallest included.
pub(super) const SIZES: &[u64] = &[0, 1, 2, 3, 17, 100, 300];

impl Case {
    pub(super) fn spec(&self, dim: u32, n: u64, seed: u64) -> anyhow::Result<Spec> {
        let mut params: BTreeMap<String, toml::Value> = BTreeMap::new();
        for &(name, value) in self.params {
            let whole = name == "per-cluster";
            params.insert(
                name.into(),
                if whole { toml::Value::Integer(value as i64) } else { toml::Value::Float(value) },
            );
        }
        if self.periodic {
            params.insert("periodic".into(), true.into());
        }
        let lattice = self.lattice[dim as usize - 2];
        if !lattice.is_empty() {
            params.insert("lattice".into(), lattice.into());
        }
        Spec::new(self.generator, dim, n, seed, Order::Shuffled, &params)
    }
}
