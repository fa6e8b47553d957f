//! Extreme scenes and boxes: each gets a correct result or a clear refusal.

use contactbench_ground::periodic::{IMAGE_PAIR_BYTES, PeriodicError, depth};
use contactbench_ground::scene::LatticeError;

use super::*;

fn of(centres: &[[f64; 3]], radius: f64, vectors: [[f64; 3]; 3]) -> Bag<3> {
    let radii = Radii::Uniform(radius);
    Bag { centres: centres.to_vec(), radii, vectors, periodic: [true; 3], origin: [0.0; 3] }
}

fn cube(edge: f64) -> [[f64; 3]; 3] {
    [[edge, 0.0, 0.0], [0.0, edge, 0.0], [0.0, 0.0, edge]]
}

fn refusal(bag: &Bag<3>, limit: u64) -> Refusal {
    let mut detector = TABLE[4].make(OPTIONS);
    let found = contacts(&bag.periodic(), &mut *detector, Arithmetic::Exact, limit);
    found.expect_err("it is refused")
}

#[test]
fn impossible_boxes_are_refused() {
    let radii_in_another_unit = of(&[[0.5; 3]; 10], 300.0, cube(1.0));
    let said = refusal(&radii_in_another_unit, LIMIT);
    assert!(matches!(said, Refusal::Images { .. }) && said.is_of_scene(), "{said}");
    assert!(said.to_string().contains("is the box in another unit than the radii?"), "{said}");
    let said = truth(&radii_in_another_unit.periodic(), Arithmetic::Exact, LIMIT).err();
    assert!(said.is_some_and(|said| said.to_string().contains("another unit")));
    // The radius gives more images than can be numbered.
    let said = refusal(&of(&[[0.5; 3]], 1e12, cube(1.0)), u64::MAX);
    assert!(
        matches!(said, Refusal::Images { images, .. } if (1e37..1e39).contains(&images)),
        "{said}"
    );
    assert!(matches!(refusal(&of(&[[0.0; 3]], 1.0, cube(1e-140)), LIMIT), Refusal::Images { .. }));
    let away = of(&[[0.5; 3], [0.5, 1e12, 0.5]], 0.25, cube(1.0));
    let said = refusal(&away, LIMIT);
    assert!(matches!(said, Refusal::Away { particle: 1, vector: 1, .. }), "{said}");
    assert!(said.to_string().contains("particle 1 is 1e12 boxes away"), "{said}");
    assert!(matches!(refusal(&of(&[[0.0; 3]], f64::MAX, cube(1.0)), LIMIT), Refusal::Range));
    // The box is nearly flat, but its shortest vectors separate the images.
    let skewed = [[1.0, 0.0, 0.0], [1.0, 2e-9, 0.0], [1.0, 1e-9, 2e-18]];
    let flat = Lattice::new(skewed.map(|[x, y, z]| [x, y, 0.0 * z]), [true; 3], [0.0; 3]);
    assert!(matches!(flat, Err(LatticeError::Flat { .. })), "{flat:?}");
    all_find(&of(&[[0.0; 3]], 1e-19, skewed), &[]);
    // The images fit in the memory limit, the list of contacts does not.
    let crowd = of(&[[0.5; 3]; 40], 0.5, cube(1.0));
    let found = truth(&crowd.periodic(), Arithmetic::Exact, LIMIT).unwrap().pairs.len() as u64;
    let enough = found * IMAGE_PAIR_BYTES;
    let mut detector = TABLE[0].make(OPTIONS);
    let mut ask = |limit| contacts(&crowd.periodic(), &mut *detector, Arithmetic::Exact, limit);
    assert_eq!(ask(enough).map(|pairs| pairs.len() as u64), Ok(found));
    assert!(matches!(ask(enough - 1), Err(Refusal::Pairs { found: f, .. }) if f == found));
    assert!(matches!(refusal(&crowd, 1000), Refusal::Images { .. }));
}

/// Rounding to f32 may move particles this far away by thousands of boxes. The images, up to 10^15,
/// must be refused by estimate: a visit of each would take from seconds to years.
#[test]
fn rounded_arithmetic_far_from_the_origin_is_refused_at_once() {
    let tilted = [[4.0, 0.0, 0.0], [1.0, 4.0, 0.0], [0.0, 1.0, 4.0]];
    let (all, slab) = ([true; 3], [true, true, false]);
    for (away, periodic) in [(32, all), (36, all), (40, all), (40, slab)] {
        let at = f64::from(away).exp2();
        let centres = [[at + 0.5, 1.1, 1.2], [at + 3.5, 1.1, 1.2]];
        let bag = Bag { periodic, origin: [at, 0.0, 0.0], ..of(&centres, 0.5, tilted) };
        let mut detector = TABLE[4].make(OPTIONS);
        let found = contacts(&bag.periodic(), &mut *detector, Arithmetic::F32, LIMIT);
        assert!(matches!(found, Err(Refusal::Images { .. })), "2^{away}, {periodic:?}");
        let exact = contacts(&bag.periodic(), &mut *detector, Arithmetic::Exact, LIMIT);
        assert_eq!(exact.map(|pairs| pairs.len()), Ok(1));
    }
}

#[test]
fn invalid_periodic_scenes_are_errors() {
    let bag = of(&[[0.5; 3]], 0.25, cube(1.0));
    let scene = bag.periodic().scene().stored(Arithmetic::F32).unwrap();
    assert_eq!(Periodic::new(scene, bag.lattice()), Err(PeriodicError::Storage));
    let discs = Scene::at([[0.0, 0.0]], 1.0).unwrap();
    let leaves = [[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let leaves = Lattice::new(leaves, [true; 3], [0.0; 3]).unwrap();
    let refused = Periodic::new(discs.clone().into(), leaves);
    assert!(matches!(refused, Err(PeriodicError::Lattice(LatticeError::Plane { .. }))));
    let flat = Periodic::new(discs.into(), bag.lattice()).unwrap();
    assert_eq!(flat.lattice().periodic(), [true, true, false]);
    assert_eq!(flat.into_parts().1.periodic(), [true, true, false]);
}

/// Points touch only if they coincide, also through images; grids accept points.
#[test]
fn points_touch_where_they_coincide() {
    let points = of(&[[0.25; 3], [1.25, 0.25, -2.75], [0.25, 0.25, 0.5]], 0.0, cube(1.0));
    all_find(&points, &[ImagePair { i: 0, j: 1, image: [-1, 0, 3] }]);
    all_find(&of(&[], 1.0, cube(1.0)), &[]);
    all_find(&of(&[], 0.0, cube(1.0)), &[]);
    let each = Bag { radii: Radii::Each(vec![0.0, 1e-300, 0.0].into()), ..points };
    let truth = each.truth();
    assert_eq!(truth, [ImagePair { i: 0, j: 1, image: [-1, 0, 3] }]);
}

#[test]
fn depths_and_digests_are_those_of_images() {
    let bag = of(&[[0.5; 3], [0.75, 0.5, 0.5]], 0.5, cube(1.0));
    let (periodic, truth) = (bag.periodic(), bag.truth());
    assert_eq!(depth(&periodic, ImagePair { i: 1, j: 1, image: [0, 0, 3] }), -4.0);
    assert_eq!(depth(&periodic, ImagePair { i: 0, j: 1, image: [0; 3] }), 1.5);
    assert_eq!(depth(&periodic, ImagePair { i: 0, j: 9, image: [0; 3] }), 0.0);
    let mut digest = Digest::default();
    truth.iter().for_each(|pair| digest.image(pair.j, pair.i, pair.image.map(|s| -s)));
    let mut detector = TABLE[3].make(OPTIONS);
    let counted = count(&mut *detector, &periodic, Arithmetic::Exact);
    assert!(counted.0 == digest && counted.1 != Tally::default());
}

/// Boxes and scenes of arbitrary doubles: no detector finds contacts beyond the truth, nothing
/// panics, and all detectors that do not refuse agree.
#[test]
fn arbitrary_doubles_never_panic() {
    let random = &mut ChaCha8Rng::seed_from_u64(5);
    let (mut answers, mut refusals, mut boxes) = (0, 0, 0);
    for turn in 0..4_000 {
        let mut any = |wild: bool| loop {
            let x = if wild {
                f64::from_bits(random.random())
            } else {
                let power = 2f64.powi(random.random_range(-60..60));
                power * (random.random::<f64>() - 0.5)
            };
            if x.is_finite() {
                break x;
            }
        };
        let wild = turn % 3 == 0;
        let mut vectors: [[f64; 3]; 3] =
            std::array::from_fn(|_| std::array::from_fn(|_| any(wild)));
        if turn % 2 == 0 {
            (vectors[0][1], vectors[0][2], vectors[1][2]) = (0.0, 0.0, 0.0);
        }
        let periodic = std::array::from_fn(|v| turn >> v & 4 == 0);
        let origin = std::array::from_fn(|_| any(wild));
        let Ok(lattice) = Lattice::new(vectors, periodic, origin) else { continue };
        boxes += 1;
        let rows: Vec<_> = (0..turn % 4).map(|_| [(); 3].map(|()| any(wild))).collect();
        let scene = Scene::at(rows, any(wild).abs()).unwrap();
        let scene = Periodic::new(scene.into(), lattice).unwrap();
        let limit = 1 << 13;
        for arithmetic in [Arithmetic::Exact, Arithmetic::F32] {
            let truth = truth(&scene, arithmetic, limit).ok();
            for entry in detectors().skip(turn % 3).step_by(3) {
                let options = Options { memory_limit: 1 << 20, ..OPTIONS };
                match contacts(&scene, &mut *entry.make(options), arithmetic, limit) {
                    Ok(found) => {
                        answers += 1;
                        let Some(truth) = &truth else { continue };
                        assert_eq!(found, truth.pairs, "{} in {arithmetic}: {scene:?}", entry.name);
                    }
                    Err(_) => refusals += 1,
                }
            }
        }
    }
    assert!(boxes > 500 && answers > 500 && refusals > 500, "{boxes} {answers} {refusals}");
}
