//! Exact contacts of a scene in its box, the pairs that nearly touch, and the nearest image of a
//! pair. Open space is a box that repeats along no vector.

use contactbench_core::contact::Arithmetic;
use contactbench_core::crowd;
use contactbench_core::detect::{Options, table};
use contactbench_core::periodic::{self, ImagePair, Periodic, depth};
use contactbench_core::scene::{AnyScene, Lattice, Radii, Real, Scene, array};
use contactbench_core::with_scene;
use contactbench_io::Given;

/// The scene in its box, or in one that repeats along no vector.
///
/// # Errors
/// A box of discs that leaves their plane; a scene that f64 cannot store.
pub fn in_any_box(given: &Given) -> anyhow::Result<Periodic<'static>> {
    match given.periodic()? {
        Some(periodic) => Ok(periodic),
        None => in_open_space(&given.scene),
    }
}

/// The scene in a box that repeats along no vector.
///
/// # Errors
/// A scene that f64 cannot store.
pub fn in_open_space(scene: &AnyScene<'_>) -> anyhow::Result<Periodic<'static>> {
    Ok(Periodic::new(scene.stored(Arithmetic::F64)?, Lattice::OPEN)?)
}

/// Centre and radius of a particle; in the plane the third coordinate is 0.
pub fn particle(scene: &AnyScene<'_>, k: u32) -> ([f64; 3], f64) {
    let k = k as usize;
    with_scene!(scene, scene => {
        let centre = array(&scene.centres()[k]);
        let along = |axis: usize| centre.get(axis).map_or(0.0, |x| x.wide());
        (std::array::from_fn(along), scene.radius(k).wide())
    })
}

/// Finds all contacts in exact arithmetic, with a detector that copes with any sizes and positions.
/// The contact list and the periodic images may take `limit` bytes each.
///
/// # Errors
/// A scene with more contacts than the limit allows, before they are looked for; what the detector
/// refuses.
pub fn contacts(periodic: &Periodic<'_>, limit: u64) -> anyhow::Result<Vec<ImagePair>> {
    crowd::within(periodic.scene(), limit)?;
    let options = Options { memory_limit: limit, ..Options::default() };
    Ok(periodic::contacts(periodic, &mut *table::robust(options), Arithmetic::Exact, limit)?)
}

/// The gap between the particles of a pair, in the units of the scene; negative where they overlap.
pub fn gap(periodic: &Periodic<'_>, pair: ImagePair) -> f64 {
    let [a, b] = [pair.i, pair.j].map(|k| particle(periodic.scene(), k).1);
    -depth(periodic, pair) * 0.5 * (a + b)
}

/// The image of j nearest to i, but for very skewed boxes; of a particle itself another one.
pub fn nearest(periodic: &Periodic<'_>, [i, j]: [u32; 2]) -> ImagePair {
    let ([a, b], lattice) = ([i, j].map(|k| particle(periodic.scene(), k).0), periodic.lattice());
    let axes = lattice.periodic();
    let about: [i32; 3] = std::array::from_fn(|v| {
        let dual = lattice.dual(v);
        let at: f64 = (0..3).map(|k| (a[k] - b[k]) * dual[k]).sum();
        if axes[v] { at.round().clamp(-1e9, 1e9) as i32 } else { 0 }
    });
    let steps = |v: usize| if axes[v] { -1..=1 } else { 0..=0 };
    let mut best = (f64::NEG_INFINITY, ImagePair::new(i, j, about));
    for x in steps(0) {
        for y in steps(1) {
            for z in steps(2) {
                let pair = ImagePair::new(i, j, [about[0] + x, about[1] + y, about[2] + z]);
                let depth = depth(periodic, pair);
                if depth > best.0 && !(i == j && pair.image == [0; 3]) {
                    best = (depth, pair);
                }
            }
        }
    }
    best.1
}

/// The pairs that do not touch, with a gap under `part` mean radii, in order; none where they
/// cannot be found.
pub fn nearly(periodic: &Periodic<'_>, part: f64, limit: u64) -> Vec<ImagePair> {
    let Ok(swollen) = resized(periodic, |r| r * (1.0 + part)) else { return Vec::new() };
    let mut near = contacts(&swollen, limit).unwrap_or_default();
    near.retain(|&pair| (-part..0.0).contains(&depth(periodic, pair)));
    near
}

/// The same scene with other radii.
///
/// # Errors
/// A radius that is negative or not finite.
pub fn resized(
    periodic: &Periodic<'_>,
    radius: impl Fn(f64) -> f64,
) -> anyhow::Result<Periodic<'static>> {
    fn of<const D: usize>(
        scene: &Scene<'_, f64, D>,
        radius: impl Fn(f64) -> f64,
    ) -> anyhow::Result<Scene<'static, f64, D>> {
        let radii = match scene.radii() {
            Radii::Uniform(r) => Radii::Uniform(radius(*r)),
            Radii::Each(radii) => Radii::Each(radii.iter().map(|&r| radius(r)).collect()),
        };
        Ok(Scene::new(scene.centres().to_vec(), radii)?)
    }
    let scene: AnyScene<'static> = match periodic.scene() {
        AnyScene::Plane(scene) => of(&scene.widened(), radius)?.into(),
        AnyScene::Space(scene) => of(&scene.widened(), radius)?.into(),
    };
    Ok(Periodic::new(scene, *periodic.lattice())?)
}
