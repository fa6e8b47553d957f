//! Scenes for the relations: tangent and decimal lattices, clouds, clusters and lines, with
//! particles moved by one bit, of very different sizes, or far away.

use contactbench::scene::{AnyScene, Radii, Real, Scene, array};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::with_scene;
use proptest::prelude::*;

use super::Flat;

/// Changes centres and radii one by one; returns `None` if the result is not a valid scene.
pub fn map<const D: usize>(
    scene: &Flat<D>,
    centre: impl Fn([f64; D]) -> [f64; D],
    radius: impl Fn(f64) -> f64,
) -> Option<Flat<D>> {
    let rows = scene.centres().iter().map(|at| centre(*array(at)));
    Scene::at(rows, scene.radii().map(radius)).ok()
}

pub fn any_scene<const D: usize>(scene: &Flat<D>) -> AnyScene<'static> {
    AnyScene::at(scene.centres().iter().map(|at| *array(at)), scene.radii().clone()).unwrap()
}

/// Returns the scene as `arithmetic` stores it, converted to f64; `None` if it cannot be stored.
pub fn kept<const D: usize>(scene: &Flat<D>, arithmetic: Arithmetic) -> Option<Flat<D>> {
    with_scene!(any_scene(scene).stored(arithmetic).ok()?, scene => {
        let row = |k: usize| std::array::from_fn(|axis| array(&scene.centres()[k])[axis].wide());
        Scene::at((0..scene.len()).map(row), scene.radii().map(|r| r.wide())).ok()
    })
}

/// How the integer sites of particles become coordinates.
#[derive(Clone, Copy, Debug)]
enum Shape {
    Lattice,
    Cloud,
    Clusters,
    Line,
}

/// A particle before its site and size are scaled to coordinates and a radius.
#[derive(Clone, Debug)]
struct Seed<const D: usize> {
    site: [i8; D],
    noise: [f64; D],
    size: f64,
    nudge: i8,
}

fn seed<const D: usize>() -> impl Strategy<Value = Seed<D>> {
    // Relative radii: 0, or from 1/100 to 10.
    let size = prop_oneof![12 => Just(1.0), 2 => Just(0.5), 2 => 0.3..1.0, 2 => Just(0.01), 1 => Just(0.0), 1 => Just(10.0)];
    // Random offsets are multiples of 2^-30, so that no difference of coordinates is tiny.
    let noise = (-(1i32 << 29)..1 << 29).prop_map(|k| f64::from(k) / f64::from(1 << 30));
    let nudge = prop_oneof![8 => Just(0i8), 1 => Just(1), 1 => Just(-1)];
    (prop::array::uniform::<_, D>(-2i8..4), prop::array::uniform::<_, D>(noise), size, nudge)
        .prop_map(|(site, noise, size, nudge)| Seed { site, noise, size, nudge })
}

pub fn scenes<const D: usize>() -> impl Strategy<Value = Flat<D>> {
    let shape = prop_oneof![3 => Just(Shape::Lattice), 2 => Just(Shape::Cloud), 1 => Just(Shape::Clusters), 1 => Just(Shape::Line)];
    let spacing = prop_oneof![3 => Just(1.0), 2 => Just(0.25), 2 => Just(0.1), 1 => Just(0.3), 1 => Just(1.0 / 3.0), 1 => Just(3e3)];
    // Radii in units of the spacing: particles touch at an offset of 1, 2, 3 or (3, 4) sites, miss
    // tangency by one bit, or are apart.
    let (above, below) = (0.5f64.next_up(), 0.5f64.next_down());
    let shares = [0.5, 0.5, 0.5, 1.0, 1.5, 2.5, 0.7, 0.3, above, below, 0.0];
    let share = prop::sample::select(shares.to_vec());
    let offset = prop::sample::select(vec![0.0, 0.0, 0.5, -7.0, 0.1, 1e6, -1e6 / 3.0]);
    let far = prop::sample::select(vec![0.0, 0.0, 0.0, 0.0, 300.0, 3e4, 1e12]);
    let particles = prop_oneof![1 => prop::collection::vec(seed::<D>(), 0..4), 6 => prop::collection::vec(seed::<D>(), 4..60)];
    (shape, spacing, share, offset, any::<bool>(), far, particles).prop_map(
        |(shape, spacing, share, offset, mixed, far, particles)| {
            let place = |seed: &Seed<D>| -> [f64; D] {
                std::array::from_fn(|k| {
                    let (site, noise) = (f64::from(seed.site[k]), seed.noise[k]);
                    let x = match shape {
                        Shape::Lattice => site,
                        Shape::Cloud => site + noise,
                        Shape::Clusters => (site / 3.0).floor() * 16.0 + noise,
                        Shape::Line => 4.0 * if k == 0 { site + noise } else { 0.0 },
                    };
                    nudged((x + offset) * spacing, seed.nudge)
                })
            };
            let mut centres: Vec<[f64; D]> = particles.iter().map(place).collect();
            if let (Some(last), true) = (centres.last_mut(), far > 0.0) {
                last[D - 1] = far * spacing;
            }
            let r = share * spacing;
            let radii = match mixed {
                true => Radii::Each(particles.iter().map(|seed| seed.size * r).collect()),
                false => Radii::Uniform(r),
            };
            Scene::at(centres, radii).unwrap()
        },
    )
}

/// Returns the next number up or down; for zero, the zero of the other sign.
fn nudged(x: f64, nudge: i8) -> f64 {
    match nudge {
        0 => x,
        _ if x == 0.0 => -x,
        1 => x.next_up(),
        _ => x.next_down(),
    }
}
