//! Statistics of a scene ([`Stats`]) and its fingerprint.
//!
//! Numbers are finite or absent for every valid scene: lengths are relative to the box, and
//! coordinates are halved before they are subtracted, so that the largest doubles do not overflow.
//! If all lengths are below 10^-300, the box may underflow to zero.

pub use contactbench_terms::scene::Stats;

use contactbench_ground::scene::{Lattice, Radii, Real, Scene, array};
use contactbench_ground::with_scene;
use contactbench_io::Given;
use contactbench_terms::mix::splitmix64;

/// Returns a fingerprint of the scene and its box, as `0x` and 16 hexadecimal digits.
///
/// It is the chain h = splitmix64(h xor v), from h = 0, over these v: the dimension; the number of
/// particles; the bits of all coordinates as doubles (x, y(, z) of particle 0, then 1, ...); 0 or 1
/// for one radius or one per particle; and the bits of the radius or radii. An f32 scene has the
/// fingerprint of the equal f64 scene; 0.0 and -0.0 differ. For a box, the chain continues over its
/// vectors and corner (bits of doubles) and its three periodic flags (0 or 1).
pub fn hash(given: &Given) -> String {
    fn chained<T: Real, const D: usize>(scene: &Scene<'_, T, D>, chain: &mut impl FnMut(u64)) {
        chain(D as u64);
        chain(scene.len() as u64);
        scene.centres().iter().flat_map(array).for_each(|x| chain(x.wide().to_bits()));
        let (each, radii) = match scene.radii() {
            Radii::Uniform(r) => (0, std::slice::from_ref(r)),
            Radii::Each(radii) => (1, &radii[..]),
        };
        chain(each);
        radii.iter().for_each(|r| chain(r.wide().to_bits()));
    }
    let mut hash = 0;
    let mut chain = |value: u64| hash = splitmix64(hash ^ value);
    with_scene!(&given.scene, scene => chained(scene, &mut chain));
    if let Some(lattice) = &given.lattice {
        let origin = lattice.origin();
        let numbers = lattice.vectors().as_flattened().iter().chain(&origin);
        let flags = lattice.periodic().map(u64::from);
        numbers.map(|x| x.to_bits()).chain(flags).for_each(chain);
    }
    format!("{hash:#018x}")
}

pub fn stats(given: &Given, contacts: u64) -> Stats {
    let Given { scene, lattice, .. } = given;
    let (n, lattice) = (scene.len(), lattice.as_ref());
    let (packing_fraction, box_diameters) = with_scene!(scene, scene => {
        (packing_fraction(scene, lattice), box_diameters(scene, lattice))
    });
    Stats {
        packing_fraction,
        coordination: coordination(n as u64, contacts),
        radius_ratio: with_scene!(scene, scene => radius_ratio(scene)),
        box_diameters,
        scene_hash: hash(given),
    }
}

/// Returns the mean number of contacts per particle; 0 without particles.
pub fn coordination(particles: u64, contacts: u64) -> f64 {
    if particles == 0 { 0.0 } else { 2.0 * contacts as f64 / particles as f64 }
}

/// Returns the volume of the particles over that of the box, or 0 if the box has no volume.
fn packing_fraction<T: Real, const D: usize>(
    scene: &Scene<'_, T, D>,
    lattice: Option<&Lattice>,
) -> f64 {
    // A fully periodic box is replaced by a rectangular one of equal volume.
    let repeats = lattice.and_then(|lattice| half_volume(lattice, D));
    let half = match repeats {
        Some(half) => std::array::from_fn(|k| half[k]),
        None => half_edges(scene, |k| scene.radius(k).wide()),
    };
    let most = half.iter().fold(0.0, |a: f64, &b| a.max(b));
    let shape = if D == 2 { std::f64::consts::PI } else { std::f64::consts::PI * 4.0 / 3.0 };
    let volume: f64 = (0..scene.len())
        .map(|k| [0.5 * scene.radius(k).wide() / most; D].iter().product::<f64>())
        .sum();
    let fraction = volume * shape / half.iter().map(|edge| edge / most).product::<f64>();
    if fraction.is_finite() { fraction } else { 0.0 }
}

/// Returns half the edges of a rectangular box with the volume of the lattice (Gram-Schmidt), or
/// `None` if the lattice is not periodic along all of its vectors.
fn half_volume(lattice: &Lattice, dim: usize) -> Option<[f64; 3]> {
    let vectors = *lattice.vectors();
    lattice.periodic()[..dim].iter().all(|&repeats| repeats).then(|| {
        let (mut half, mut before) = ([0.0; 3], Vec::<[f64; 3]>::new());
        for k in 0..dim {
            let mut left = vectors[k].map(|x| 0.5 * x);
            for direction in &before {
                let part: f64 = left.iter().zip(direction).map(|(x, d)| x * d).sum();
                left = std::array::from_fn(|k| left[k] - part * direction[k]);
            }
            half[k] = length(left);
            before.push(left.map(|x| x / half[k]));
        }
        half
    })
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    libm::hypot(libm::hypot(x, y), z)
}

/// Returns the edges of the box around the centres, and the lengths of periodic vectors, in units
/// of the largest diameter. `None` if the diameter is zero or the quotient overflows.
fn box_diameters<T: Real, const D: usize>(
    scene: &Scene<'_, T, D>,
    lattice: Option<&Lattice>,
) -> Option<Vec<f64>> {
    let radius = scene.largest_radius().wide();
    let mut half = half_edges(scene, |_| 0.0);
    if let Some(lattice) = lattice {
        for k in (0..D).filter(|&k| lattice.periodic()[k]) {
            half[k] = 0.5 * length(lattice.vectors()[k]);
        }
    }
    let edges: Vec<f64> = half.iter().map(|half| half / radius).collect();
    (radius > 0.0 && edges.iter().all(|edge| edge.is_finite())).then_some(edges)
}

/// Returns the largest over the smallest radius; `None` if the smallest is zero or the quotient
/// overflows.
fn radius_ratio<T: Real, const D: usize>(scene: &Scene<'_, T, D>) -> Option<f64> {
    match scene.radii() {
        Radii::Each(radii) if !radii.is_empty() => {
            let least = radii.iter().fold(f64::INFINITY, |least, r| least.min(r.wide()));
            let ratio = scene.largest_radius().wide() / least;
            (least > 0.0 && ratio.is_finite()).then_some(ratio)
        }
        Radii::Each(_) => Some(1.0),
        Radii::Uniform(r) => (r.wide() > 0.0).then_some(1.0),
    }
}

/// Returns half the edges of the smallest box that holds all centres, each extended by `extent` to
/// every side; zero without particles.
fn half_edges<T: Real, const D: usize>(
    scene: &Scene<'_, T, D>,
    extent: impl Fn(usize) -> f64,
) -> [f64; D] {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; D];
    for (k, centre) in scene.centres().iter().enumerate() {
        for ([low, high], x) in bounds.iter_mut().zip(array(centre)) {
            // Coordinates are quartered, so that no end and no half difference can overflow.
            (*low, *high) = (
                low.min(0.25 * x.wide() - 0.25 * extent(k)),
                high.max(0.25 * x.wide() + 0.25 * extent(k)),
            );
        }
    }
    bounds.map(|[low, high]| if low <= high { (2.0 * (high - low)).min(f64::MAX) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_ground::scene::AnyScene;

    fn plane(points: &[[f64; 2]], radii: impl Into<Radii<'static, f64>>) -> AnyScene<'static> {
        AnyScene::at(points.iter().copied(), radii).unwrap()
    }

    #[test]
    fn two_discs_side_by_side_and_a_ball_in_its_cube_by_hand() {
        let ball = AnyScene::at([[1.0, 2.0, 3.0]], 0.5);
        let pair = |x, radii: Radii<'static, f64>| plane(&[[0.0, 0.0], [x, 0.0]], radii);
        for (scene, contacts, coordination, parts_of_pi, ratio, edges) in [
            (pair(2.0, 1.0.into()), 1, 1.0, 1.0 / 4.0, 1.0, vec![1.0, 0.0]),
            (pair(3.0, vec![1.0, 2.0].into()), 1, 1.0, 5.0 / 24.0, 2.0, vec![0.75, 0.0]),
            (ball.unwrap(), 0, 0.0, 1.0 / 6.0, 1.0, vec![0.0; 3]),
        ] {
            let stats = stats(&scene.into(), contacts);
            let fraction = stats.packing_fraction;
            assert!((fraction - parts_of_pi * std::f64::consts::PI).abs() < 1e-15, "{fraction}");
            assert_eq!((stats.coordination, stats.radius_ratio), (coordination, Some(ratio)));
            assert_eq!(stats.box_diameters, Some(edges));
        }
    }

    #[test]
    fn every_number_is_finite_in_extreme_scenes() {
        let max = f64::MAX;
        let tiny = f64::from_bits(1);
        for (points, radii) in [
            (vec![], Radii::Uniform(0.5)),
            (vec![], Radii::Each(vec![].into())),
            (vec![[1.0, 2.0]], Radii::Uniform(0.0)),
            (vec![[max, -max], [-max, max]], Radii::Uniform(max)),
            (vec![[max, -max], [-max, max]], Radii::Each(vec![tiny, max].into())),
            (vec![[max, -max], [-max, max]], Radii::Uniform(tiny)),
            (vec![[tiny, 0.0], [0.0, tiny]], Radii::Uniform(tiny)),
            (vec![[0.0, 0.0], [1.0, 0.0]], Radii::Each(vec![0.0, 1.0].into())),
        ] {
            let stats = stats(&plane(&points, radii).into(), 3);
            let edges = stats.box_diameters.clone().unwrap_or_default();
            let others = [stats.packing_fraction, stats.coordination];
            let mut all = edges.into_iter().chain(stats.radius_ratio).chain(others);
            assert!(all.all(f64::is_finite), "{stats:?}");
            let text = serde_json::to_string(&stats).unwrap();
            assert_eq!(serde_json::from_str::<Stats>(&text).unwrap(), stats);
        }
    }

    #[test]
    fn the_hash_sees_bits_order_and_radii_but_not_the_precision() {
        let points = [[0.0, 1.0], [2.0, 3.0]];
        let scene = plane(&points, Radii::Uniform(0.5));
        let f32 = scene.stored(contactbench_ground::contact::Arithmetic::F32).unwrap();
        let hash_of = |scene: AnyScene<'static>| hash(&scene.into());
        let hash = hash_of(scene.clone());
        assert_eq!((hash.len(), &hash[..2]), (18, "0x"));
        assert_eq!(hash, hash_of(f32));
        for other in [
            plane(&[[-0.0, 1.0], [2.0, 3.0]], Radii::Uniform(0.5)),
            plane(&[[2.0, 3.0], [0.0, 1.0]], Radii::Uniform(0.5)),
            plane(&points, Radii::Uniform(0.25)),
            plane(&points, Radii::Each(vec![0.5, 0.5].into())),
        ] {
            assert_ne!(hash, hash_of(other));
        }
    }
}
