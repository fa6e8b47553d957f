//! Exact contacts of a scene in its box, pairs that nearly touch, and nearest images. Open space is
//! treated as a box without periodic vectors.

use contactbench_core::contact::Arithmetic;
use contactbench_core::crowd;
use contactbench_core::detect::{Options, table};
use contactbench_core::periodic::{self, ImagePair, Periodic, depth};
use contactbench_core::scene::{AnyScene, Lattice, Real, Scene, array};
use contactbench_core::with_scene;
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

/// Finds all contacts in exact arithmetic, with a detector for any sizes and positions. The contact
/// list and the periodic images may take `limit` bytes each.
///
/// # Errors
/// Fails before the search if the estimated contacts exceed the limit, or if the detector refuses.
pub fn contacts(periodic: &Periodic<'_>, limit: u64) -> anyhow::Result<Vec<ImagePair>> {
    crowd::within(periodic.scene(), limit)?;
    let options = Options { memory_limit: limit, ..Options::default() };
    Ok(periodic::contacts(periodic, &mut *table::robust(options), Arithmetic::Exact, limit)?)
}

/// Returns the gap between the particles of a pair, in the units of the scene; negative if they
/// overlap.
pub fn gap(periodic: &Periodic<'_>, pair: ImagePair) -> f64 {
    let [a, b] = [pair.i, pair.j].map(|k| particle(periodic.scene(), k).1);
    -depth(periodic, pair) * 0.5 * (a + b)
}

/// Returns the image of j nearest to i. For i = j it is the nearest other image. In very skewed
/// boxes a nearer image may exist.
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

/// Returns the pairs with a positive gap of at most `part` mean radii, in order. Empty if they
/// cannot be found.
pub fn nearly(periodic: &Periodic<'_>, part: f64, limit: u64) -> Vec<ImagePair> {
    let Ok(swollen) = resized(periodic, |r| r * (1.0 + part)) else { return Vec::new() };
    let mut near = contacts(&swollen, limit).unwrap_or_default();
    near.retain(|&pair| (-part..0.0).contains(&depth(periodic, pair)));
    near
}

/// Returns the same scene with other radii; fails if a radius is negative or not finite.
pub fn resized(
    periodic: &Periodic<'_>,
    radius: impl Fn(f64) -> f64,
) -> anyhow::Result<Periodic<'static>> {
    fn of<const D: usize>(
        scene: &Scene<'_, f64, D>,
        radius: impl Fn(f64) -> f64,
    ) -> anyhow::Result<Scene<'static, f64, D>> {
        Ok(Scene::new(scene.centres().to_vec(), scene.radii().map(radius))?)
    }
    let scene: AnyScene<'static> = match periodic.scene() {
        AnyScene::Plane(scene) => of(&scene.widened(), radius)?.into(),
        AnyScene::Space(scene) => of(&scene.widened(), radius)?.into(),
    };
    Ok(Periodic::new(scene, *periodic.lattice())?)
}
