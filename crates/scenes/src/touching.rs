//! Particles of a scene in its box, and their gaps. Open space is treated as a box without periodic
//! vectors.

use contactbench_ground::contact::Arithmetic;
use contactbench_ground::periodic::{ImagePair, Periodic, depth};
use contactbench_ground::scene::{AnyScene, Lattice, Real, array};
use contactbench_ground::with_scene;
use contactbench_io::Given;

/// Returns the scene in its periodic box, or in one without periodic vectors.
///
/// # Errors
/// Fails if the box of a 2D scene leaves the plane, or f64 cannot store the scene.
pub fn in_any_box(given: &Given) -> anyhow::Result<Periodic<'static>> {
    match given.periodic()? {
        Some(periodic) => Ok(periodic),
        None => in_open_space(&given.scene),
    }
}

/// Returns the scene in a box without periodic vectors; fails if f64 cannot store the scene.
pub fn in_open_space(scene: &AnyScene<'_>) -> anyhow::Result<Periodic<'static>> {
    Ok(Periodic::new(scene.stored(Arithmetic::F64)?, Lattice::OPEN)?)
}

/// Returns the centre and radius of particle `k`; in 2D the third coordinate is 0.
pub fn particle(scene: &AnyScene<'_>, k: u32) -> ([f64; 3], f64) {
    let k = k as usize;
    with_scene!(scene, scene => {
        let centre = array(&scene.centres()[k]);
        let along = |axis: usize| centre.get(axis).map_or(0.0, |x| x.wide());
        (std::array::from_fn(along), scene.radius(k).wide())
    })
}

/// Returns the gap between the particles of a pair, in the units of the scene; negative if they
/// overlap.
pub fn gap(periodic: &Periodic<'_>, pair: ImagePair) -> f64 {
    let [a, b] = [pair.i, pair.j].map(|k| particle(periodic.scene(), k).1);
    -depth(periodic, pair) * 0.5 * (a + b)
}
