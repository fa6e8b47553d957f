//! Generators: scenes made from a seed, the same bits on every machine.
//!
//! Each generator has a file with a picture of its scene, its parameters and its entry in
//! [`table::GENERATORS`]. It draws coordinates and radii for a largest diameter of 1. `assemble`
//! multiplies both by `diameter` and moves the scene by `offset`. Results have the same bits
//! everywhere, because generators use only + - * / and square roots, which IEEE 754 defines, and
//! the cube root and logarithm of the `libm` crate, never the system's mathematical library. All
//! scenes may contain overlaps.

pub mod book;
pub mod boxes;
pub mod clustered;
pub mod couples;
pub mod draw;
pub mod file;
pub mod grading;
pub mod hard;
pub mod loose;
pub mod packed;
pub mod settled;
pub mod sizes;
pub mod table;

use std::collections::BTreeMap;

use anyhow::{Context, ensure};
use nalgebra::Point;
use table::{Parameter, ParameterKind, parameter};

use contactbench_ground::scene::{Radii, Scene};
use contactbench_io::Given;

/// The inputs of a generator: everything in a [`crate::spec::Spec`] except the order.
pub struct Inputs<'a> {
    pub dim: u32,
    pub n: u64,
    pub seed: u64,
    pub params: &'a BTreeMap<String, serde_json::Value>,
}

impl Inputs<'_> {
    fn number(&self, name: &str) -> anyhow::Result<f64> {
        let value = self.params.get(name).and_then(|value| value.as_f64());
        value.with_context(|| format!("the number '{name}' is missing"))
    }

    fn whole(&self, name: &str) -> anyhow::Result<u64> {
        let value = self.params.get(name).and_then(|value| value.as_u64());
        value.with_context(|| format!("the whole number '{name}' is missing"))
    }

    /// Checks the number of particles of a scene that decides it; n = 0 accepts any.
    fn own_n(&self, given: Given) -> anyhow::Result<Given> {
        let (n, found) = (self.n, given.scene.len() as u64);
        ensure!(
            [0, found].contains(&n),
            "the scene has {found} particles, not n = {n}; leave n out"
        );
        Ok(given)
    }

    fn text(&self, name: &str) -> anyhow::Result<&str> {
        let value = self.params.get(name).and_then(|value| value.as_str());
        value.with_context(|| format!("the text '{name}' is missing"))
    }
}

const DIAMETER: Parameter =
    parameter("diameter", ParameterKind::POSITIVE, "1", "largest diameter, in units of length");

const OFFSET: Parameter = parameter(
    "offset",
    ParameterKind::FINITE,
    "0",
    "added to every coordinate, in largest diameters; the sums are rounded to f64",
);

const fn fraction(default: &'static str) -> Parameter {
    let meaning = "volume of the particles over the volume of the box";
    parameter("fraction", ParameterKind::POSITIVE, default, meaning)
}

const OF_PARTICLES: &[Parameter] = &[
    DIAMETER,
    OFFSET,
    sizes::SIZE_RATIO,
    sizes::SIZES,
    sizes::EXPONENT,
    sizes::SHARE,
    sizes::GIANTS,
    sizes::GRADING,
    boxes::PERIODIC,
    boxes::TILT,
    crate::neighbours::NEIGHBOURS,
];

/// Returns the edge, in diameters, of the square or cube that the particles fill to `fraction`.
fn box_edge<const D: usize>(n: u64, radii: Option<&[f64]>, fraction: f64) -> f64 {
    let power = |r: f64| if D == 2 { r * r } else { r * r * r };
    let sum = radii.map_or(n as f64 * power(0.5), |radii| radii.iter().map(|&r| power(r)).sum());
    let shape = if D == 2 { std::f64::consts::PI } else { std::f64::consts::PI * 4.0 / 3.0 };
    let volume = sum * shape / fraction;
    if D == 2 { volume.sqrt() } else { libm::cbrt(volume) }
}

/// Returns an empty list with room for `n`; fails if there is not enough memory.
fn room<T>(n: u64) -> anyhow::Result<Vec<T>> {
    let mut list = Vec::new();
    let n = usize::try_from(n)
        .context("more particles than this machine can address; make n smaller")?;
    list.try_reserve_exact(n)
        .with_context(|| format!("no memory for n = {n} particles; make n smaller"))?;
    Ok(list)
}

/// Makes the scene; centres and radii are given in diameters.
fn assemble<const D: usize>(
    inputs: &Inputs<'_>,
    centres: impl Iterator<Item = [f64; D]>,
    radii: Option<Vec<f64>>,
) -> anyhow::Result<Scene<'static, f64, D>> {
    let diameter = inputs.number("diameter")?;
    let offset = inputs.number("offset").unwrap_or(0.0) * diameter;
    let mut points = room(inputs.n)?;
    // An offset of 0 is not added, because adding 0.0 would turn -0.0 into 0.0.
    points.extend(centres.map(|centre| {
        Point::from(
            centre.map(|x| if offset == 0.0 { x * diameter } else { x * diameter + offset }),
        )
    }));
    let radii = match radii {
        None => Radii::Uniform(0.5 * diameter),
        Some(mut radii) => {
            radii.iter_mut().for_each(|r| *r *= diameter);
            Radii::Each(radii.into())
        }
    };
    // Generated coordinates are valid unless they overflow.
    Scene::new(points, radii).map_err(|_| beyond())
}

fn beyond() -> anyhow::Error {
    anyhow::anyhow!("coordinates or radii leave the range of f64; take parameters nearer to 1")
}

#[cfg(test)]
mod tests;
