use super::*;
use crate::check::listed::WORST;
use crate::check::reading::Deviation;
use crate::contact::Arithmetic;
use crate::detect::{Options, table};
use crate::periodic::BRUTE_FORCE;
use crate::scene::spec::Spec;
use crate::scene::{Lattice, Radii, Scene};

/// Discs in a box of these edges that repeats along both.
fn discs(centres: &[[f64; 2]], radius: f64, edges: [f64; 2]) -> Periodic<'static> {
    let centres: Vec<_> = centres.iter().copied().map(nalgebra::Point::from).collect();
    let scene = Scene::new(centres, Radii::Uniform(radius)).unwrap();
    let lattice = Lattice::along_axes([edges[0], edges[1], 0.0], [true, true, false]).unwrap();
    Periodic::new(scene.into(), lattice).unwrap()
}

const GIVEN: Allowed = Allowed { both_sides: false, skin: 0.0 };
const BOTH: Allowed = Allowed { both_sides: true, skin: 0.0 };

fn verify(
    periodic: &Periodic<'_>,
    pairs: &[[i64; 2]],
    images: Option<&[[i32; 3]]>,
    allowed: Allowed,
) -> Verification {
    let (arithmetic, memory_limit) = (Arithmetic::Exact, 1 << 28);
    let terms =
        Terms { arithmetic, allowed, memory_limit, kept: WORST, explain: true, without: None };
    let list = Listed { pairs, images };
    Verification::in_box(periodic, list, &Naming::Base(0), &[Naming::Base(1)], terms).unwrap()
}

/// Missed, spurious, repeated, and with itself.
fn counts(found: &Verification) -> [u64; 4] {
    let Errors { missed, spurious, duplicate, self_pairs, .. } = found.errors;
    [missed, spurious, duplicate, self_pairs]
}

#[test]
fn pairs_without_images_are_counted_once_or_as_often_as_they_touch() {
    // In a box of 2 by 9, 0 and 1 touch at both sides, exactly; 1 and 2 once.
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
        let found = verify(&row, list, None, GIVEN);
        assert_eq!((found.taken, counts(&found)), (taken, expected), "{list:?}");
        assert_eq!((found.contacts, found.is_same()), (3, expected == [0; 4]), "{list:?}");
    }
    // A spurious pair is shown by its nearest image: 0 and 2 are sqrt 2 apart at both sides.
    let found = verify(&row, &[[0, 1], [1, 2], [0, 2]], None, GIVEN);
    let (pair, depth) = found.spurious[0];
    assert_eq!((pair.i, pair.j), (0, 2));
    assert!((depth + 2.0 * (2f64.sqrt() - 1.0)).abs() < 1e-15, "{depth}");
    // From both sides.
    let twice = [[0, 1], [1, 0], [0, 1], [1, 0], [1, 2], [2, 1]];
    assert!(verify(&row, &twice, None, BOTH).is_same());
    let found = verify(&row, &twice[..5], None, BOTH);
    assert_eq!((counts(&found), found.one_sided), ([0; 4], vec![[1, 2]]));
}

#[test]
fn particles_touch_their_own_images() {
    // One disc in a square of its diameter: two contacts with itself, four neighbours.
    let one = discs(&[[0.3, 7.0]], 0.5, [1.0, 1.0]);
    for (rows, allowed, taken, expected) in [
        (1, GIVEN, Taken::Once, [0; 4]),
        (2, GIVEN, Taken::Each, [0; 4]),
        (4, GIVEN, Taken::Each, [0, 0, 2, 0]),
        (4, BOTH, Taken::Each, [0; 4]),
    ] {
        let found = verify(&one, &vec![[0, 0]; rows], None, allowed);
        assert_eq!((found.taken, counts(&found)), (taken, expected), "{rows}");
    }
    let images = [[1, 0, 0], [0, -1, 0], [-1, 0, 0], [0, 1, 0], [0, 0, 0]];
    let of = |images: &[[i32; 3]], allowed| {
        let found = verify(&one, &vec![[0, 0]; images.len()], Some(images), allowed);
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
    // 0.5 apart at both sides.
    let row = discs(&[[0.0, 0.0], [1.5, 0.0]], 0.5, [3.0, 9.0]);
    let skin = |skin| Allowed { both_sides: false, skin };
    let images: Vec<[i32; 3]> = vec![[0; 3], [-1, 0, 0]];
    let found = verify(&row, &[[0, 1]; 2], Some(&images), skin(0.5));
    assert_eq!((found.is_same(), found.within_skin), (true, 2));
    let found = verify(&row, &[[0, 1]; 2], Some(&images), skin(0.49));
    assert_eq!((found.is_same(), counts(&found)), (false, [0, 2, 0, 0]));
    assert!(verify(&row, &[[0, 1]], None, skin(0.5)).is_same());
    assert!(verify(&row, &[], None, skin(0.5)).is_same());
    assert_eq!(counts(&verify(&row, &[[0, 1]], None, skin(0.4))), [0, 1, 0, 0]);
    // A little farther is farther.
    let far = discs(&[[0.0, 0.0], [1.5 + 1e-10, 0.0]], 0.5, [9.0, 9.0]);
    assert_eq!(counts(&verify(&far, &[[0, 1]], None, skin(0.5))), [0, 1, 0, 0]);
    // They touch through one image, and are 0.75 apart through another.
    let mixed = discs(&[[0.0, 0.0], [1.0, 0.0]], 0.5, [2.75, 9.0]);
    let found = verify(&mixed, &[[0, 1]; 2], None, skin(0.8));
    assert_eq!((found.is_same(), found.within_skin), (true, 1));
    assert_eq!(counts(&verify(&mixed, &[[0, 1]; 3], None, skin(0.8))), [0, 0, 1, 0]);
    assert_eq!(counts(&verify(&mixed, &[], None, skin(0.8))), [1, 0, 0, 0]);
    let found = verify(&row, &[[0, 1]; 2], Some(&images), GIVEN);
    let reading = found.reading.unwrap();
    assert_eq!((reading.deviation, reading.wrong), (Some(Deviation::Skin(0.5)), 0));
}

/// The nearest image, from far away and in a box with a shear.
#[test]
fn the_nearest_image_is_found() {
    let scene = Scene::new(
        vec![nalgebra::Point::from([100.25, -3.0, 0.0]), nalgebra::Point::from([0.0, 0.0, 0.5])],
        Radii::Uniform(0.5),
    );
    let vectors = [[4.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 0.0, 9.0]];
    let lattice = Lattice::new(vectors, [true, true, false], [0.0; 3]).unwrap();
    let periodic = Periodic::new(scene.unwrap().into(), lattice).unwrap();
    // By -3 of the second vector and 27 of the first, (1.25, 0) are left; by -4 and 28, (0.25, 1),
    // which is shorter, though the fractions of the difference are 27.3125 and -3.
    let pair = nearest(&periodic, [0, 1]);
    assert_eq!((pair.i, pair.j, pair.image), (0, 1, [28, -4, 0]));
    let distance = (0.0625f64 + 1.0 + 0.25).sqrt();
    assert!((depth(&periodic, pair) + 2.0 * (distance - 1.0)).abs() < 1e-14);
    assert!((gap(&periodic, pair) - (distance - 1.0)).abs() < 1e-14);
}

/// Beyond what is tested by all pairs, and against the guess of a list that knows no box.
#[test]
fn many_particles_are_compared_with_what_two_detectors_say() {
    let pack = Spec::parse("packed:dim=3,n=3375,lattice=cubic").unwrap().make().unwrap();
    assert!(pack.len() > BRUTE_FORCE);
    let edges = [0, 1, 2].map(|axis| {
        let along = (0..pack.len() as u32)
            .map(|k| crate::check::listed::particle(&pack, k).0[axis])
            .fold([f64::INFINITY, 0.0f64], |[low, high], x| [low.min(x), high.max(x)]);
        along[1] - along[0] + 0.75
    });
    let cube = Lattice::along_axes(edges, [true; 3]).unwrap();
    let periodic = Periodic::new(pack, cube).unwrap();
    let mut other = table::find("kd-tree").unwrap().make(Options::default());
    let truth = periodic::contacts(&periodic, &mut *other, Arithmetic::Exact, 1 << 28).unwrap();
    let listed = |pairs: &[ImagePair]| -> (Vec<[i64; 2]>, Vec<[i32; 3]>) {
        let names = pairs.iter().map(|pair| [pair.i, pair.j].map(i64::from));
        (names.collect(), pairs.iter().map(|pair| pair.image).collect())
    };
    let (pairs, images) = listed(&truth);
    assert!(images.iter().any(|image| *image != [0; 3]));
    assert!(verify(&periodic, &pairs, Some(&images), GIVEN).is_same());
    assert!(verify(&periodic, &pairs, None, GIVEN).is_same());
    let open: Vec<ImagePair> = truth.iter().copied().filter(|p| p.image == [0; 3]).collect();
    let found = verify(&periodic, &listed(&open).0, None, GIVEN);
    assert_eq!(counts(&found), [(truth.len() - open.len()) as u64, 0, 0, 0]);
    let reading = found.reading.unwrap();
    assert_eq!((reading.taken, reading.wrong), (TakenBox::Open, 0));
}
