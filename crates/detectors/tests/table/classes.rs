//! Tests on scenes that `streamed-nbs` divides into size classes.

use contactbench_detectors::oracle;
use contactbench_detectors::table;
use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::detect::Options;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::probe::{Op, Tally};
use contactbench_ground::scene::{AnyScene, Scene};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::sizes::{FORMS, compared};

/// Compares the answers of all forms with the truth; returns the number of contacts.
fn assert_right(scene: &AnyScene<'_>, what: &str) -> u64 {
    let forms = FORMS.map(|form| (format!("streamed-nbs:{form}"), 1));
    let threads = ("streamed-nbs".to_string(), 2);
    compared(scene, &[&forms[..], &[threads]].concat(), what)[0]
}

/// Returns balls of all sizes up to this ratio, with smaller particles (dust) on their surfaces.
/// The gaps are so small that neither f32 nor f64 arithmetic can decide whether the dust touches.
fn dust_on_surfaces<const D: usize>(ratio: f64, seed: u64) -> Scene<'static, f64, D> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut centres, mut radii) = (Vec::new(), Vec::new());
    for ball in 0..40 {
        let radius = ratio.powf(f64::from(ball) / 40.0);
        let centre: [f64; D] = std::array::from_fn(|_| 3.0 * ratio * random.random::<f64>());
        centres.push(centre);
        radii.push(radius);
        for k in 0..60 {
            let dust = 1.0 - 0.3 * random.random::<f64>();
            let mut direction: [f64; D] = std::array::from_fn(|_| random.random::<f64>() - 0.5);
            if k % 3 == 0 {
                direction = [0.0; D];
                direction[k / 3 % D] = 1.0;
            }
            let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            // Overlaps or gaps of at most a few units in the last place.
            let far = (radius + dust) * (1.0 + f64::from(k as i32 % 7 - 3) * 1e-16) / length;
            centres.push(std::array::from_fn(|k| centre[k] + direction[k] * far));
            radii.push(dust);
        }
    }
    Scene::at(centres, radii).unwrap()
}

#[test]
fn surfaces_are_met_to_the_last_bit() {
    let mut contacts = 0;
    for (seed, ratio) in [(1, 3.0), (3, 300.0), (6, 1e12)] {
        contacts += assert_right(&dust_on_surfaces::<2>(ratio, seed).into(), "surfaces, 2D");
        contacts += assert_right(&dust_on_surfaces::<3>(ratio, seed).into(), "surfaces, 3D");
    }
    assert!(contacts > 90_000, "{contacts}");
}

/// Scenes with dust so small beside a ball, or numbers so large or small, that squares of distances
/// overflow in f32 or f64.
#[test]
fn extreme_sizes_lose_and_add_nothing() {
    for (dust, space, ball, x) in [
        (1e80, 1e82, 1e110, 1e110),
        (1e98, 1e100, 1e125, 1e125),
        (1e-45, 1e-43, 1e110, 0.5e110),
        (1e-203, 1e-200, 1e110, 0.5e110),
        (1e-5, 1e-3, 1e20, 1e20),
    ] {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let near = |_| [(); 3].map(|()| space * (2.0 * random.random::<f64>() - 1.0));
        let centres = (0..200).map(near).chain([[x, 0.0, 0.0]]);
        let radii: Vec<f64> = (0..200).map(|_| dust).chain([ball]).collect();
        let scene = Scene::at(centres, radii).unwrap();
        assert!(assert_right(&scene.into(), &format!("dust {dust:e}, ball {ball:e}")) > 0);
    }
}

#[test]
fn doubles_of_any_exponent_are_decided() {
    let mut contacts = 0;
    for seed in 0..12 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let span = f64::from(random.random_range(1..300));
        let mut any = || 10f64.powf(span * (2.0 * random.random::<f64>() - 1.0));
        let radii: Vec<f64> = (0..120).map(|_| any()).collect();
        let scene = Scene::at((0..120).map(|_| [any(), -any(), any()]), radii).unwrap();
        contacts += assert_right(&scene.into(), &format!("seed {seed}"));
    }
    assert!(contacts > 2_000, "{contacts}");
}

fn streamed(scene: &AnyScene<'_>) -> (Tally, Digest, u64) {
    let (mut tally, mut digest) = (Tally::default(), Digest::default());
    let mut detector = table::find("streamed-nbs").unwrap().make(Options::default());
    detector.count(scene, Test::Exact, &mut tally, &mut digest).unwrap();
    (tally, digest, detector.formula_bytes())
}

/// A class that is flat along the longest axis of the scene gets cells for its own shape.
#[test]
fn dust_on_the_floor_of_a_tall_hall_takes_no_more_memory() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let on_floor = |_| [100.0 * random.random::<f64>(), 100.0 * random.random::<f64>(), 0.0];
    let balls = [[50.0, 50.0, 30.0], [20.0, 70.0, 190.0]];
    let radii: Vec<f64> = (0..5000).map(|_| 0.01).chain([30.0; 2]).collect();
    let scene = AnyScene::at((0..5000).map(on_floor).chain(balls), radii).unwrap();
    let (_, digest, bytes) = streamed(&scene);
    assert!(bytes < 200 * 5002, "{bytes}");
    assert_eq!(digest, oracle::truth(&scene, Arithmetic::Exact).unwrap().digest);
}

/// The model takes a heap of dust among balls for evenly spread dust. The dust crowds in few cells,
/// so `hgrid` detects the scene instead.
#[test]
fn a_heap_of_dust_is_not_tested_against_itself() {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut within = |edge: f64| [(); 3].map(|()| edge * random.random::<f64>());
    let mut centres: Vec<_> = (0..6000).map(|_| within(2.0)).collect();
    centres.extend((0..200).map(|_| within(80.0)));
    let radii: Vec<f64> = (0..6200).map(|k| if k < 6000 { 0.01 } else { 1.0 }).collect();
    let scene = AnyScene::at(centres, radii).unwrap();
    let (tally, digest, _) = streamed(&scene);
    assert!(tally.get(Op::ContactTest) < 100 * 6200, "{}", tally.get(Op::ContactTest));
    assert_eq!(digest, oracle::truth(&scene, Arithmetic::Exact).unwrap().digest);
}
