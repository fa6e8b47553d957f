use super::*;
use crate::tracking::nearest;
use contactbench_detectors::oracle::boxes::BRUTE_FORCE;
use contactbench_detectors::table;
use contactbench_ground::detect::Options;
use contactbench_ground::periodic::depth;
use contactbench_ground::scene::{AnyScene, Lattice};
use contactbench_lists::periodic;
use contactbench_scenes::spec::Spec;
use contactbench_scenes::touching::{in_open_space, particle};

const GIVEN: Allowed = Allowed { both_sides: false, skin: 0.0 };
const BOTH: Allowed = Allowed { both_sides: true, skin: 0.0 };

fn skin(skin: f64) -> Allowed {
    Allowed { skin, ..GIVEN }
}

/// Returns unit discs at 0, 1, 3, 10 and 20. Discs 0 and 1 overlap by one radius, 1 and 2 are
/// tangent, 0 and 2 have a gap of 1.
fn row() -> AnyScene<'static> {
    AnyScene::at([0.0, 1.0, 3.0, 10.0, 20.0].map(|x| [x, 0.0]), 1.0).unwrap()
}

fn discs(centres: &[[f64; 2]], radius: f64, edges: [f64; 2]) -> Periodic<'static> {
    let scene = AnyScene::at(centres.iter().copied(), radius).unwrap();
    let lattice = Lattice::along_axes([edges[0], edges[1], 0.0], [true, true, false]).unwrap();
    Periodic::new(scene, lattice).unwrap()
}

fn ask(
    space: &Periodic<'_>,
    list: Listed<'_>,
    naming: &Naming,
    others: &[Naming],
    allowed: Allowed,
) -> (Verification, Option<Reading>) {
    let (arithmetic, memory_limit) = (Arithmetic::Exact, 1 << 30);
    let terms = Terms { arithmetic, allowed, memory_limit, kept: WORST, without: None };
    let job = Job { space, list, naming, others, terms };
    let found = verify(&job).unwrap();
    let reading = explain(&job, &found).unwrap();
    (found, reading)
}

fn of_row(pairs: &[NamedPair], naming: &Naming, allowed: Allowed) -> Verification {
    ask(&in_open_space(&row()).unwrap(), Listed { pairs, images: None }, naming, &[], allowed).0
}

fn in_box(
    periodic: &Periodic<'_>,
    pairs: &[NamedPair],
    images: Option<&[[i32; 3]]>,
    allowed: Allowed,
) -> (Verification, Option<Reading>) {
    let others = [Naming::Base(1)];
    ask(periodic, Listed { pairs, images }, &Naming::Base(0), &others, allowed)
}

fn counts(found: &Verification) -> [u64; 4] {
    let Errors { missed, spurious, duplicate, self_pairs, .. } = found.errors;
    [missed, spurious, duplicate, self_pairs]
}

#[test]
fn every_kind_of_difference_is_found() {
    let list = [[2, 1], [1, 2], [3, 3], [2, 3], [0, 4], [1, 9]];
    let found = of_row(&list, &Naming::Base(0), GIVEN);
    assert_eq!((counts(&found), found.truth.len()), ([1, 2, 1, 1], 2));
    assert_eq!((found.unknown.as_slice(), found.is_same()), (&[[1, 9]][..], false));
    let pair = |i, j| ImagePair::new(i, j, [0; 3]);
    assert_eq!(found.missed, [(pair(0, 1), 1.0)]);
    assert_eq!(found.spurious, [(pair(0, 4), -18.0), (pair(2, 3), -5.0)]);
    assert_eq!([found.errors.deepest_miss, found.errors.widest_false], [1.0, 18.0]);
    assert!(of_row(&[[0, 1], [2, 1]], &Naming::Base(0), GIVEN).is_same());
    let twice = Naming::by_id(&[7, 8, 7]).unwrap_err().to_string();
    assert!(twice.contains("the id 7 stands twice in the file, at particles 0 and 2"), "{twice}");
}

#[test]
fn both_sides_and_skins_are_allowed_where_asked_for() {
    let ids = Naming::by_id(&[7, 8, 9, 10, 11]).unwrap();
    for (naming, [a, b, c]) in [(&Naming::Base(0), [0, 1, 2]), (&ids, [7, 8, 9])] {
        let both = |list: &[NamedPair]| of_row(list, naming, BOTH);
        assert!(both(&[[a, b], [c, b], [b, a], [b, c]]).is_same());
        let found = both(&[[a, b], [c, b], [b, a]]);
        assert_eq!((found.one_sided, found.errors), (vec![[c, b]], Errors::default()));
        let list = [[a, b], [b, c], [a, c]];
        let found = of_row(&list, naming, skin(1.0));
        assert_eq!((found.is_same(), found.within_skin), (true, 1));
        assert_eq!(of_row(&list, naming, skin(0.9)).errors.spurious, 1);
    }
}

/// Returns the pairs of a packing whose centres are less than `reach` apart.
fn apart(scene: &AnyScene<'_>, reach: f64) -> Vec<NamedPair> {
    let n = scene.len() as u32;
    let near = |i: u32, j: u32| {
        let (a, b) = (particle(scene, i).0, particle(scene, j).0);
        let square: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum();
        square <= reach * reach
    };
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j]));
    pairs.filter(|&[i, j]| near(i, j)).map(|pair| pair.map(i64::from)).collect()
}

#[test]
fn each_common_mistake_is_recognised() {
    let pack = Spec::parse("packed:dim=3,n=216,lattice=cubic").unwrap().make().unwrap();
    let ids = Naming::by_id(&(0..216).map(|k| 3 * k + 7).collect::<Vec<_>>()).unwrap();
    let right = apart(&pack, 1.0);
    let map = |name: fn(i64) -> i64| -> Vec<NamedPair> {
        right.iter().map(|pair| pair.map(name)).collect()
    };
    let others = [Naming::Base(1), ids];
    let read = |scene: &AnyScene<'_>, pairs: &[NamedPair]| {
        let list = Listed { pairs, images: None };
        ask(&in_open_space(scene).unwrap(), list, &Naming::Base(0), &others, GIVEN).1
    };
    // Radii are 0.5, so diameters taken for radii list centres up to 2 apart.
    for (scene, list, mistake) in [
        (&pack, map(|i| i + 1), Mistake::Numbers(Meaning::Base(1))),
        (&pack, map(|i| 3 * i + 7), Mistake::Numbers(Meaning::Ids)),
        (&pack, right.iter().flat_map(|&[i, j]| [[i, j], [j, i]]).collect(), Mistake::BothSides),
        (&row(), vec![[0, 1]], Mistake::Ties { missed: true }),
        (&pack, apart(&pack, 2.0), Mistake::Diameters),
    ] {
        let reading = read(scene, &list).expect("it is explained");
        assert_eq!((reading.mistake, reading.wrong), (mistake, 0));
    }
    let reading = read(&pack, &apart(&pack, 1.2)).unwrap();
    let Mistake::Skin(skin) = reading.mistake else { panic!("{reading:?}") };
    assert!(skin <= 0.2 && skin > 0.05 && reading.wrong == 0, "{skin}");
    let mut wrong = right.clone();
    wrong.extend((0..200).map(|k| [k, (7 * k + 5) % 216]).filter(|[i, j]| i != j));
    assert_eq!(read(&pack, &wrong), None);
}

#[test]
fn pairs_without_images_are_counted_once_or_as_often_as_they_touch() {
    // In a box of 2 by 9, discs 0 and 1 are tangent on both sides, discs 1 and 2 on one side.
    let row = discs(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], 0.5, [2.0, 9.0]);
    let each = [[0, 1], [1, 2], [1, 0]];
    for (list, taken, expected) in [
        (&each[..], Taken::Each, [0; 4]),
        (&each[..2], Taken::Once, [0; 4]),
        (&each[1..2], Taken::Once, [1, 0, 0, 0]),
        (&[], Taken::Once, [2, 0, 0, 0]),
        (&[[0, 1], [1, 2], [1, 0], [0, 1]], Taken::Each, [0, 0, 1, 0]),
        (&[[0, 1], [1, 0]], Taken::Each, [1, 0, 0, 0]),
        (&[[0, 1], [1, 2], [2, 1]], Taken::Once, [0, 0, 1, 0]),
        (&[[0, 1], [1, 2], [0, 2]], Taken::Once, [0, 1, 0, 0]),
        (&[[0, 1], [1, 2], [0, 2], [2, 0]], Taken::Once, [0, 1, 1, 0]),
        (&[[0, 1], [1, 2], [2, 2]], Taken::Once, [0, 0, 0, 1]),
    ] {
        let (found, _) = in_box(&row, list, None, GIVEN);
        assert_eq!((found.taken, counts(&found)), (taken, expected), "{list:?}");
        assert_eq!((found.truth.len(), found.is_same()), (3, expected == [0; 4]), "{list:?}");
    }
    // Spurious pairs get their nearest image: discs 0 and 2 are sqrt 2 apart on both sides.
    let (found, _) = in_box(&row, &[[0, 1], [1, 2], [0, 2]], None, GIVEN);
    let (pair, depth) = found.spurious[0];
    assert_eq!((pair.i, pair.j), (0, 2));
    assert!((depth + 2.0 * (2f64.sqrt() - 1.0)).abs() < 1e-15, "{depth}");
    let twice = [[0, 1], [1, 0], [0, 1], [1, 0], [1, 2], [2, 1]];
    assert!(in_box(&row, &twice, None, BOTH).0.is_same());
    let (found, _) = in_box(&row, &twice[..5], None, BOTH);
    assert_eq!((counts(&found), found.one_sided), ([0; 4], vec![[1, 2]]));
}

#[test]
fn particles_touch_their_own_images() {
    // A disc in a square of its diameter touches itself twice, or four times in both directions.
    let one = discs(&[[0.3, 7.0]], 0.5, [1.0, 1.0]);
    for (rows, allowed, taken, expected) in [
        (1, GIVEN, Taken::Once, [0; 4]),
        (2, GIVEN, Taken::Each, [0; 4]),
        (4, GIVEN, Taken::Each, [0, 0, 2, 0]),
        (4, BOTH, Taken::Each, [0; 4]),
    ] {
        let (found, _) = in_box(&one, &vec![[0, 0]; rows], None, allowed);
        assert_eq!((found.taken, counts(&found)), (taken, expected), "{rows}");
    }
    let images = [[1, 0, 0], [0, -1, 0], [-1, 0, 0], [0, 1, 0], [0, 0, 0]];
    let of = |images: &[[i32; 3]], allowed| {
        let (found, _) = in_box(&one, &vec![[0, 0]; images.len()], Some(images), allowed);
        (counts(&found), found.one_sided.len())
    };
    assert_eq!(of(&images[..2], GIVEN), ([0; 4], 0));
    assert_eq!(of(&images[..4], GIVEN), ([0, 0, 2, 0], 0));
    assert_eq!(of(&images[..4], BOTH), ([0; 4], 0));
    assert_eq!(of(&images[..3], BOTH), ([0; 4], 1));
    assert_eq!(of(&images[1..2], GIVEN), ([1, 0, 0, 0], 0));
    assert_eq!(of(&images[3..], GIVEN), ([1, 0, 0, 1], 0));
    assert_eq!(of(&[[1, 0, 0], [0, 1, 0], [1, 1, 0]], GIVEN), ([0, 1, 0, 0], 0));
}

#[test]
fn pairs_within_a_skin_may_be_there_through_each_image() {
    let row = discs(&[[0.0, 0.0], [1.5, 0.0]], 0.5, [3.0, 9.0]);
    let ask = |pairs: &[NamedPair], images, allowed| in_box(&row, pairs, images, allowed).0;
    let images: Vec<[i32; 3]> = vec![[0; 3], [-1, 0, 0]];
    let found = ask(&[[0, 1]; 2], Some(&images), skin(0.5));
    assert_eq!((found.is_same(), found.within_skin), (true, 2));
    let found = ask(&[[0, 1]; 2], Some(&images), skin(0.49));
    assert_eq!((found.is_same(), counts(&found)), (false, [0, 2, 0, 0]));
    assert!(ask(&[[0, 1]], None, skin(0.5)).is_same());
    assert!(ask(&[], None, skin(0.5)).is_same());
    assert_eq!(counts(&ask(&[[0, 1]], None, skin(0.4))), [0, 1, 0, 0]);
    let far = discs(&[[0.0, 0.0], [1.5 + 1e-10, 0.0]], 0.5, [9.0, 9.0]);
    assert_eq!(counts(&in_box(&far, &[[0, 1]], None, skin(0.5)).0), [0, 1, 0, 0]);
    // The two discs touch through one image, and have a gap of 0.75 through another.
    let mixed = discs(&[[0.0, 0.0], [1.0, 0.0]], 0.5, [2.75, 9.0]);
    let ask = |pairs: &[NamedPair]| in_box(&mixed, pairs, None, skin(0.8)).0;
    let found = ask(&[[0, 1]; 2]);
    assert_eq!((found.is_same(), found.within_skin), (true, 1));
    assert_eq!(counts(&ask(&[[0, 1]; 3])), [0, 0, 1, 0]);
    assert_eq!(counts(&ask(&[])), [1, 0, 0, 0]);
    let reading = in_box(&row, &[[0, 1]; 2], Some(&images), GIVEN).1.unwrap();
    assert_eq!((reading.mistake, reading.wrong), (Mistake::Skin(0.5), 0));
}

#[test]
fn the_nearest_image_is_found() {
    let scene = AnyScene::at([[100.25, -3.0, 0.0], [0.0, 0.0, 0.5]], 0.5);
    let vectors = [[4.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 0.0, 9.0]];
    let lattice = Lattice::new(vectors, [true, true, false], [0.0; 3]).unwrap();
    let periodic = Periodic::new(scene.unwrap(), lattice).unwrap();
    // After subtracting -3 second and 27 first vectors, (1.25, 0) is left. After -4 and 28, (0.25,
    // 1) is left, which is shorter, although the fractions of the difference are 27.3125 and -3.
    let pair = nearest(&periodic, [0, 1]);
    assert_eq!((pair.i, pair.j, pair.image), (0, 1, [28, -4, 0]));
    let distance = (0.0625f64 + 1.0 + 0.25).sqrt();
    assert!((depth(&periodic, pair) + 2.0 * (distance - 1.0)).abs() < 1e-14);
    assert!((gap(&periodic, pair) - (distance - 1.0)).abs() < 1e-14);
}

/// The scene has too many particles for testing all pairs; one list ignores the box.
#[test]
fn many_particles_are_compared_with_what_two_detectors_say() {
    let pack = Spec::parse("packed:dim=3,n=3375,lattice=cubic").unwrap().make().unwrap();
    assert!(pack.len() > BRUTE_FORCE);
    let edges = [0, 1, 2].map(|axis| {
        let along = (0..pack.len() as u32)
            .map(|k| particle(&pack, k).0[axis])
            .fold([f64::INFINITY, 0.0f64], |[low, high], x| [low.min(x), high.max(x)]);
        along[1] - along[0] + 0.75
    });
    let cube = Lattice::along_axes(edges, [true; 3]).unwrap();
    let periodic = Periodic::new(pack, cube).unwrap();
    let mut other = table::find("kd-tree").unwrap().make(Options::default());
    let truth = periodic::contacts(&periodic, &mut *other, Arithmetic::Exact, 1 << 28).unwrap();
    let listed = |pairs: &[ImagePair]| -> (Vec<NamedPair>, Vec<[i32; 3]>) {
        let names = pairs.iter().map(|pair| [pair.i, pair.j].map(i64::from));
        (names.collect(), pairs.iter().map(|pair| pair.image).collect())
    };
    let (pairs, images) = listed(&truth);
    assert!(images.iter().any(|image| *image != [0; 3]));
    assert!(in_box(&periodic, &pairs, Some(&images), GIVEN).0.is_same());
    assert!(in_box(&periodic, &pairs, None, GIVEN).0.is_same());
    let open: Vec<ImagePair> = truth.iter().copied().filter(|p| p.image == [0; 3]).collect();
    let (found, _) = in_box(&periodic, &listed(&open).0, None, GIVEN);
    assert_eq!(counts(&found), [(truth.len() - open.len()) as u64, 0, 0, 0]);
}

/// A pair that is listed once stands for its deepest image.
#[test]
fn a_pair_listed_once_is_its_deepest_image() {
    for (second, inside) in [([1.0, 0.5], true), ([3.5, 0.5], false)] {
        let space = discs(&[[0.5, 0.5], second], 3.0, [4.0, 4.0]);
        let (found, _) = in_box(&space, &[[0, 0], [0, 1], [1, 1]], None, GIVEN);
        assert_eq!((found.taken, counts(&found)), (Taken::Once, [0; 4]), "{second:?}");
        let touching = found.truth.of([0, 1]);
        let deepest = touching.max_by(|&a, &b| depth(&space, a).total_cmp(&depth(&space, b)));
        assert_eq!(deepest.unwrap().image == [0; 3], inside);
        assert!(found.truth.len() > 10, "{}", found.truth.len());
    }
}
