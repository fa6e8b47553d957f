//! The scenes of the check: small generated ones with difficult parameters, hard cases, committed
//! regressions, and random bytes.

use std::ops::Range;

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::check::bytes;
use crate::check::regression::KEPT;
use contactbench_io as io;
use contactbench_io::Given;
use contactbench_scenes::hard;
use contactbench_scenes::spec::Spec;

pub(super) struct Scene {
    pub source: &'static str,
    pub name: String,
    pub given: Given,
}

/// Specs of scenes, without dimension, n and seed. In 3D, a cubic lattice replaces the square one.
///
/// Lattices with spacing 1 and no jitter have neighbours exactly one diameter apart, up to
/// rounding.
const CASES: &[(&str, &[u32])] = &[
    ("packed:", &[2, 3]),
    ("packed:spacing=1.0,jitter=0.0", &[2, 3]),
    ("packed:spacing=1.0,jitter=0.0,lattice=square", &[2, 3]),
    ("packed:spacing=1.0,jitter=0.0,diameter=0.1,lattice=square", &[2, 3]),
    ("packed:size-ratio=3.0", &[2, 3]),
    ("loose:", &[2, 3]),
    ("loose:fraction=0.6,size-ratio=20.0", &[2, 3]),
    ("clustered:per-cluster=20", &[2, 3]),
    ("clustered:per-cluster=50,width=0.5,fraction=0.0001", &[2, 3]),
    ("couples:diameter=0.1,offset=-1000.0", &[2, 3]),
    ("pack-a:", &[2]),
    ("pack-b:s=1.0", &[2]),
    ("pack-c:s=1.0,diameter=0.3", &[2]),
    ("pack-d:s=3.0", &[2]),
    ("packed:spacing=1.0,jitter=0.0,periodic=true,lattice=square", &[2, 3]),
    // Boxes of few particles are smaller than the distance at which particles touch.
    ("loose:fraction=0.9,tilt=-0.375,periodic=true", &[2, 3]),
    ("clustered:per-cluster=20,size-ratio=5.0,periodic=true", &[2, 3]),
];

const SIZES: &[u64] = &[0, 1, 2, 3, 17, 100, 300];

/// Number of scenes of random bytes for each seed, and range of their lengths in bytes. In longer
/// ones, particles are too far apart for a grid of cells.
const RANDOM: u64 = 200;
const LENGTHS: Range<usize> = 4..64;

pub(super) fn generated(seed: u64) -> impl Iterator<Item = anyhow::Result<Scene>> {
    let sized = |(case, dim): (&'static str, u32)| SIZES.iter().map(move |&n| (case, dim, n));
    let cases = CASES.iter().flat_map(|(case, dims)| dims.iter().map(|&dim| (*case, dim)));
    cases.flat_map(sized).map(move |(case, dim, n)| {
        let case = if dim == 3 { case.replace("square", "cubic") } else { case.into() };
        let comma = if case.ends_with(':') { "" } else { "," };
        let spec = Spec::parse(&format!("{case}{comma}dim={dim},n={n},seed={seed}"))?;
        let params = spec.params.iter().map(|(name, value)| format!(" {name}={value}"));
        let params: String = params.collect();
        let name = format!("{} dim={dim} n={n} seed={seed}{params}", spec.name);
        Ok(Scene { source: "generated", name, given: spec.given()? })
    })
}

/// Returns every hard case with a valid scene, each after the scenes of its history.
pub(super) fn hard_cases() -> impl Iterator<Item = anyhow::Result<Scene>> {
    let valid = hard::cases().filter(|case| case.expect != hard::Expect::Invalid);
    let each = valid.flat_map(|case| case.dims.iter().map(move |&dim| (case, dim)));
    each.flat_map(|(case, dim)| {
        let steps = match case.steps(dim) {
            Ok(steps) => steps,
            Err(error) => return vec![Err(error)],
        };
        let count = steps.len();
        let named = |(k, given)| {
            let step = if count == 1 { String::new() } else { format!(", step {k} of {count}") };
            let name = format!("hard case {} in {dim}D{step}", case.name);
            Ok(Scene { source: "hard cases", name, given })
        };
        (1..).zip(steps).map(named).collect()
    })
}

pub(super) fn regressions() -> impl Iterator<Item = anyhow::Result<Scene>> {
    KEPT.iter().map(|&(name, text)| {
        let ending = name.rsplit('.').next().unwrap_or_default();
        let (particles, _) = io::load_from(text.as_bytes(), name, ending, io::Options::default())?;
        let given = particles.given(name, None)?;
        Ok(Scene { source: "regressions", name: format!("tests/regressions/{name}"), given })
    })
}

pub(super) fn random_bytes(seed: u64) -> impl Iterator<Item = anyhow::Result<Scene>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..RANDOM).filter_map(move |k| {
        let mut data = vec![0; random.random_range(LENGTHS)];
        random.fill_bytes(&mut data);
        let given = bytes::scene_from_bytes(&data)?.into();
        let name = format!("random bytes, seed {seed}, number {k}");
        Some(Ok(Scene { source: "random bytes", name, given }))
    })
}
