//! Tests on scenes that `streamed-nbs` divides into size classes.

use contactbench_core::contact::{Arithmetic, Test};
use contactbench_core::detect::{Options, Refusal, table};
use contactbench_core::oracle;
use contactbench_core::probe::{Op, Tally};
use contactbench_core::scene::{AnyScene, Radii, Scene};
use contactbench_core::sink::Digest;
use nalgebra::Point;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn scene<const D: usize>(radii: Vec<f64>, edge: f64) -> Scene<'static, f64, D> {
    let mut random = ChaCha8Rng::seed_from_u64(radii.len() as u64);
    let centre = |_| Point::from(std::array::from_fn(|_| edge * random.random::<f64>()));
    Scene::new((0..radii.len()).map(centre).collect::<Vec<_>>(), Radii::Each(radii.into())).unwrap()
}

/// Returns the radii of 2,000 small particles (dust), with those of giants inserted at random.
fn dusty(giants: &[f64], dust: impl Fn(u32) -> f64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(giants.len() as u64);
    let mut radii: Vec<f64> = (0..2000).map(dust).collect();
    for &giant in giants {
        radii.insert(random.random_range(0..=radii.len()), giant);
    }
    radii
}

fn assert_right(scene: &AnyScene<'_>, what: &str) -> u64 {
    let mut contacts = 0;
    for arithmetic in Arithmetic::SAFE {
        let Ok(truth) = oracle::truth(scene, arithmetic) else { continue };
        let stored = scene.stored(arithmetic).unwrap();
        for (form, threads) in [
            ("form=auto", 1),
            ("form=auto", 2),
            ("form=dense", 1),
            ("form=flat", 1),
            ("form=sparse", 1),
            ("form=dense,level=portable", 1),
        ] {
            let spec = table::parse(&format!("streamed-nbs:{form}")).unwrap();
            let mut pairs = Vec::new();
            let mut detector = spec.make(Options { threads, ..Options::default() });
            match detector.list(&stored, arithmetic.test(), &mut pairs) {
                Ok(()) => {}
                Err(Refusal::Extent { .. } | Refusal::Domain { .. }) => continue,
                Err(refusal) => panic!("{what} {spec} {arithmetic:?}: {refusal}"),
            }
            let found = Digest::from_pairs(&pairs);
            assert_eq!(found, truth.digest, "{what} {spec} {arithmetic:?}");
            contacts += found.contacts;
        }
    }
    contacts
}

/// Returns balls of all sizes up to this ratio, with smaller particles (dust) on their surfaces.
/// The gaps are so small that neither f32 nor f64 arithmetic can decide whether the dust touches.
fn dust_on_surfaces<const D: usize>(ratio: f64, seed: u64) -> Scene<'static, f64, D> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut centres, mut radii) = (Vec::new(), Vec::new());
    for ball in 0..40 {
        let radius = ratio.powf(f64::from(ball) / 40.0);
        let centre: [f64; D] = std::array::from_fn(|_| 3.0 * ratio * random.random::<f64>());
        centres.push(Point::from(centre));
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
            centres.push(Point::from(std::array::from_fn(|k| centre[k] + direction[k] * far)));
            radii.push(dust);
        }
    }
    Scene::new(centres, Radii::Each(radii.into())).unwrap()
}

#[test]
fn surfaces_are_met_to_the_last_bit() {
    let mut contacts = 0;
    for (seed, ratio) in [(1, 3.0), (3, 300.0), (5, 1e7), (6, 1e12)] {
        contacts += assert_right(&dust_on_surfaces::<2>(ratio, seed).into(), "surfaces, 2D");
        contacts += assert_right(&dust_on_surfaces::<3>(ratio, seed).into(), "surfaces, 3D");
    }
    assert!(contacts > 130_000, "{contacts}");
}

/// A giant is tested only against the finer class's particles in rows around it.
#[test]
fn a_giant_costs_only_its_neighbourhood() {
    let count = |giants: &[f64], op| {
        let scene: AnyScene<'_> = scene::<3>(dusty(giants, |_| 0.25), 10.0).into();
        let mut tally = Tally::default();
        // Requests cells: without giants the grid would have columns, but classes have cells.
        table::parse("streamed-nbs:form=dense")
            .unwrap()
            .make(Options::default())
            .count(&scene, Test::Exact, &mut tally, &mut Digest::default())
            .unwrap();
        tally.get(op) as f64
    };
    let without = count(&[], Op::ContactTest);
    assert_eq!(count(&[], Op::LevelProbe), 0.0);
    for giant in [1.5, 2.5, 300.0] {
        let more = count(&[giant], Op::ContactTest) - without;
        // Particles in the box around the giant, two cells wider on each side.
        let around = (2.0 * (giant + 4.0 * 0.25) / 10.0).min(1.0).powi(3) * 2000.0;
        assert!(more.abs() <= 1.3 * around + 0.1 * without, "{giant}: {more} of {around}");
        assert!(count(&[giant], Op::LevelProbe) > 0.0);
    }
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
        let near = |_| Point::from([(); 3].map(|()| space * (2.0 * random.random::<f64>() - 1.0)));
        let mut centres: Vec<Point<f64, 3>> = (0..200).map(near).collect();
        centres.push(Point::from([x, 0.0, 0.0]));
        let radii: Vec<f64> = (0..200).map(|_| dust).chain([ball]).collect();
        let scene = Scene::new(centres, Radii::Each(radii.into())).unwrap();
        assert!(assert_right(&scene.into(), &format!("dust {dust:e}, ball {ball:e}")) > 0);
    }
}

#[test]
fn doubles_of_any_exponent_are_decided() {
    let mut contacts = 0;
    for seed in 0..30 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let span = f64::from(random.random_range(1..300));
        let mut any = || 10f64.powf(span * (2.0 * random.random::<f64>() - 1.0));
        let radii: Vec<f64> = (0..120).map(|_| any()).collect();
        let centres: Vec<_> = (0..120).map(|_| Point::from([any(), -any(), any()])).collect();
        let scene = Scene::new(centres, Radii::Each(radii.into())).unwrap();
        contacts += assert_right(&scene.into(), &format!("seed {seed}"));
    }
    assert!(contacts > 5_000, "{contacts}");
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
    let mut on_floor =
        |_| Point::from([100.0 * random.random::<f64>(), 100.0 * random.random::<f64>(), 0.0]);
    let mut centres: Vec<_> = (0..5000).map(&mut on_floor).collect();
    centres.extend([[50.0, 50.0, 30.0], [20.0, 70.0, 190.0]].map(Point::from));
    let radii: Vec<f64> = (0..5000).map(|_| 0.01).chain([30.0; 2]).collect();
    let scene: AnyScene<'_> = Scene::new(centres, Radii::Each(radii.into())).unwrap().into();
    let (_, digest, bytes) = streamed(&scene);
    assert!(bytes < 200 * 5002, "{bytes}");
    assert_eq!(digest, oracle::truth(&scene, Arithmetic::Exact).unwrap().digest);
}

/// The model takes a heap of dust among balls for evenly spread dust. The dust crowds in few cells,
/// so `hgrid` detects the scene instead.
#[test]
fn a_heap_of_dust_is_not_tested_against_itself() {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut within = |edge: f64| Point::from([(); 3].map(|()| edge * random.random::<f64>()));
    let mut centres: Vec<_> = (0..6000).map(|_| within(2.0)).collect();
    centres.extend((0..200).map(|_| within(80.0)));
    let radii: Vec<f64> = (0..6200).map(|k| if k < 6000 { 0.01 } else { 1.0 }).collect();
    let scene: AnyScene<'_> = Scene::new(centres, Radii::Each(radii.into())).unwrap().into();
    let (tally, digest, _) = streamed(&scene);
    assert!(tally.get(Op::ContactTest) < 100 * 6200, "{}", tally.get(Op::ContactTest));
    assert_eq!(digest, oracle::truth(&scene, Arithmetic::Exact).unwrap().digest);
}
