//! Tests of the finder with reused buffers: lists and counts, errors, memory, far-tilted boxes.

use contactbench_ground::contact::image::{Shift, compare};
use contactbench_ground::periodic::IMAGE_PAIR_BYTES;
use contactbench_ground::probe::Op;
use contactbench_ground::scene::Stored;
use contactbench_ground::scene::lattice::Numbers as Rows;
use contactbench_lists::periodic::images::Images;

use super::*;

fn thousand(vectors: [[f64; 3]; 3]) -> Bag<3> {
    let random = &mut ChaCha8Rng::seed_from_u64(8);
    let centres = (0..1000).map(|_| std::array::from_fn(|_| 16.0 * random.random::<f64>()));
    Bag {
        // Coordinates are on a grid, so that vectors can be added without error.
        centres: centres.map(|x: [f64; 3]| x.map(|x| (x * 1024.0).round() / 1024.0)).collect(),
        radii: Radii::Uniform(0.5),
        vectors,
        periodic: [true; 3],
        origin: [0.0; 3],
    }
}

const CUBE: [[f64; 3]; 3] = [[16.0, 0.0, 0.0], [0.0, 16.0, 0.0], [0.0, 0.0, 16.0]];

fn find(bag: &Bag<3>, finder: &mut Finder) -> ContactList {
    let (mut contacts, mut detector) = (ContactList::default(), TABLE[0].make(OPTIONS));
    finder.list(&bag.periodic(), &mut *detector, Arithmetic::Exact, &mut contacts).unwrap();
    contacts
}

/// Contacts of earlier calls are always kept; a refused call adds none.
#[test]
fn contacts_are_appended_or_left_as_they_were() {
    let bag = thousand(CUBE);
    let (truth, found) = (bag.truth(), find(&bag, &mut Finder::new(LIMIT)));
    let bytes = found.len() * IMAGE_PAIR_BYTES;
    assert!(found.sorted(1000, bytes).unwrap() == truth && !found.is_empty());
    let refused = Refusal::Pairs { found: found.len(), particles: 1000, room: bytes - 1 };
    assert_eq!(found.sorted(1000, bytes - 1), Err(refused));
    assert!(found.plain.len() > 200 && found.shifted.len() > 15);
    assert_eq!(
        found.digest(),
        contactbench_detectors::oracle::boxes::truth(&bag.periodic(), Arithmetic::Exact, LIMIT)
            .unwrap()
            .digest
    );
    let mut twice = found.clone();
    let (mut finder, mut detector) = (Finder::new(LIMIT), TABLE[1].make(OPTIONS));
    finder.list(&bag.periodic(), &mut *detector, Arithmetic::Exact, &mut twice).unwrap();
    assert_eq!(twice.len(), 2 * found.len());
    assert!(twice.plain.starts_with(&found.plain) && twice.shifted.starts_with(&found.shifted));
    twice.clear();
    assert!(twice.is_empty());
    // The images fit in the memory limit, one of the lists of contacts does not.
    let images = finder.formula_bytes();
    for radius in [0.7, 2.5] {
        let crowd = Bag { radii: Radii::Uniform(radius), ..bag.clone() };
        let all = find(&crowd, &mut finder).len();
        let limit = finder.formula_bytes();
        assert!(limit > images);
        for threads in [1, 2] {
            for entry in detectors().filter(|entry| threads == 1 || entry.threads) {
                let mut contacts = found.clone();
                let mut detector = entry.make(Options { threads, ..OPTIONS });
                let mut finder = Finder::new(limit);
                let periodic = crowd.periodic();
                let result =
                    finder.list(&periodic, &mut *detector, Arithmetic::Exact, &mut contacts);
                match result {
                    Err(Refusal::Pairs { found, .. }) => {
                        assert_eq!([found, finder.found()], [all; 2], "{}", entry.name);
                    }
                    Ok(()) if radius < 1.0 => continue,
                    other => panic!("{}: {other:?}", entry.name),
                }
                assert!(contacts.plain == found.plain && contacts.shifted == found.shifted);
            }
        }
    }
    let other_unit = Bag { radii: Radii::Uniform(4000.0), ..bag };
    let mut contacts = found.clone();
    let refused =
        finder.list(&other_unit.periodic(), &mut *detector, Arithmetic::F64, &mut contacts);
    assert!(matches!(refused, Err(Refusal::Images { .. })));
    assert!(contacts.sorted(1000, u64::MAX).unwrap() == truth);
}

/// A limit of the formula's bytes is enough in every storage, and one byte less is not.
#[test]
fn images_fit_in_the_formula_bytes() {
    let mut away = thousand(CUBE);
    away.centres[7][1] += 48.0;
    let mut each = thousand(CUBE);
    each.radii = Radii::Each((0..1000).map(|k| 0.25 + 0.001 * f64::from(k % 200)).collect());
    for (bag, wrapped, each) in [(thousand(CUBE), 0, 0), (away, 1000, 0), (each, 0, 1)] {
        for arithmetic in Arithmetic::SAFE {
            let (mut finder, mut detector) = (Finder::new(LIMIT), TABLE[0].make(OPTIONS));
            let periodic = bag.periodic();
            let mut list = |finder: &mut Finder| {
                finder.list(&periodic, &mut *detector, arithmetic, &mut ContactList::default())
            };
            list(&mut finder).unwrap();
            let (bytes, images) = (finder.formula_bytes(), finder.images());
            let stored = match arithmetic {
                Arithmetic::F32 => 4,
                _ => 0,
            };
            let particles = 1000 + images;
            let fixed = 40 * images + 37 * wrapped + each * 8 * particles;
            let candidates = bytes - fixed - stored * (3 + each) * particles;
            assert!(
                candidates % 32 == 0 && (100..350).contains(&(candidates / 32)),
                "{candidates}"
            );
            // The lists of contacts may need more bytes than the images.
            let enough = Finder::new(bytes.max(30_000));
            assert_eq!(list(&mut { enough }), Ok(()));
            let refused = list(&mut Finder::new(bytes - 1));
            assert!(matches!(refused, Err(Refusal::Images { .. })), "{refused:?}");
        }
    }
}

/// Adding large multiples of vectors to each other does not change the contacts, and hardly changes
/// the number of images.
#[test]
fn boxes_tilted_far_have_as_many_images() {
    let mut finder = Finder::new(LIMIT);
    let straight = find(&thousand(CUBE), &mut finder).sorted(1000, u64::MAX).unwrap();
    let images = finder.images();
    // Images are made for half of the layer of width 1 around the box, a fifth of its volume.
    assert!((150..250).contains(&images), "{images}");
    let (_, tally) =
        count(&mut *TABLE[5].make(OPTIONS), &thousand(CUBE).periodic(), Arithmetic::Exact);
    assert_eq!(tally.get(Op::GhostMade), images);
    // Coefficients of other vectors of the lattice in the cube's vectors, and the inverse matrix.
    let shears: [(Rows, Rows); 4] = [
        ([[1, 0, 0], [1, 1, 0], [0, 0, 1]], [[1, 0, 0], [-1, 1, 0], [0, 0, 1]]),
        ([[1, 0, 0], [-1000, 1, 0], [0, 0, 1]], [[1, 0, 0], [1000, 1, 0], [0, 0, 1]]),
        (
            [[1, 0, 0], [700, 1, 0], [-90_000, 3000, 1]],
            [[1, 0, 0], [-700, 1, 0], [2_190_000, -3000, 1]],
        ),
        (
            [[0, 1, 0], [0, 100_000, 1], [1, 0, 2000]],
            [[200_000_000, -2000, 1], [1, 0, 0], [-100_000, 1, 0]],
        ),
    ];
    for (rows, back) in shears {
        let times = |row: [i32; 3]| row.map(|number| 16.0 * f64::from(number));
        let tilted = thousand(rows.map(times));
        let found = find(&tilted, &mut finder);
        let mut expected: Vec<_> = straight
            .iter()
            .map(|&ImagePair { i, j, image }| {
                let image = std::array::from_fn(|b| (0..3).map(|a| image[a] * back[a][b]).sum());
                ImagePair::new(i, j, image)
            })
            .collect();
        expected.sort_unstable();
        assert!(found.sorted(1000, u64::MAX).unwrap() == expected, "{rows:?}");
        let ratio = finder.images() as f64 / images as f64;
        assert!((0.85..1.2).contains(&ratio), "{rows:?}: {ratio}");
        assert!(tilted.truth() == expected, "{rows:?}");
        assert_eq!(tilted.lattice().shortest(), 16.0);
    }
}

/// Particles in the upright box of a tilted one are not moved, and have few images.
#[test]
fn upright_particles_of_a_tilted_box_stay() {
    let mut finder = Finder::new(LIMIT);
    for ([yx, zx, zy], periodic) in [
        ([8.0, 0.0, 0.0], [true; 3]),
        ([-16.0, 0.0, 3.0], [true; 3]),
        ([5.0, -7.5, 16.0], [true; 3]),
        ([-4.0, 0.0, 0.0], [true, true, false]),
    ] {
        let vectors = [[16.0, 0.0, 0.0], [yx, 16.0, 0.0], [zx, zy, 16.0]];
        for radii in
            [Radii::Uniform(0.5), Radii::Each((0..1000).map(|k| 5e-4 * k as f64).collect())]
        {
            let bag = Bag { radii, periodic, ..thousand(vectors) };
            let found = find(&bag, &mut finder).sorted(1000, u64::MAX).unwrap();
            assert!(found == bag.truth() && found.len() > 100, "{vectors:?}");
            let (images, bytes) = (finder.images(), finder.formula_bytes());
            assert!(images < 280, "{images} images in {vectors:?}");
            assert!(bytes < 37 * 1000, "{bytes} bytes: particles were moved in {vectors:?}");
        }
    }
}

/// Returns the contacts found by testing all images one by one, with the given vectors; `None` if a
/// pair has more than about 3,000 images to test.
fn by_vectors_as_given(bag: &Bag<3>) -> Option<Vec<ImagePair>> {
    let (lattice, scene, mut pairs) = (bag.lattice(), bag.scene(), Vec::new());
    for (i, a) in bag.centres.iter().enumerate() {
        for (j, b) in bag.centres.iter().enumerate().skip(i) {
            let (ra, rb) = (scene.radius(i), scene.radius(j));
            let [x, y, z] = [0, 1, 2].map(|v| {
                let dual = lattice.dual(v);
                let middle: f64 = (0..3).map(|k| dual[k] * (a[k] - b[k])).sum();
                let within = (ra + rb) * dual.map(|x| x * x).iter().sum::<f64>().sqrt() + 1.0;
                let range = ((middle - within) as i32, (middle + within) as i32);
                if bag.periodic[v] { range } else { (0, 0) }
            });
            if [x, y, z].iter().map(|range| f64::from(range.1 - range.0)).product::<f64>() > 3e3 {
                return None;
            }
            let images = (x.0..=x.1).flat_map(|x| (y.0..=y.1).map(move |y| [x, y]));
            let images = images.flat_map(|[x, y]| (z.0..=z.1).map(move |z| [x, y, z]));
            for image in images.filter(|&image| i < j || image > [0; 3]) {
                let shift = Shift { image, vectors: lattice.vectors() };
                if compare(a, b, ra, rb, shift).is_le() {
                    pairs.push(ImagePair::new(i as u32, j as u32, image));
                }
            }
        }
    }
    pairs.sort_unstable();
    Some(pairs)
}

/// The truth, which uses reduced vectors, equals the contacts found with the given vectors.
#[test]
fn reduced_vectors_lose_nothing() {
    let (mut contacts, mut boxes) = (0, 0);
    for seed in 0..600 {
        let bag = random::<3>(seed, Numbers::Real);
        let Some(pairs) = by_vectors_as_given(&bag) else { continue };
        assert_eq!(bag.truth(), pairs, "{bag:?}");
        (contacts, boxes) = (contacts + pairs.len(), boxes + 1);
    }
    assert!(contacts > 3000 && boxes > 200, "{contacts} {boxes}");
}

/// Particles that left the box by less than a reach are not moved into it, distant ones are. In
/// both cases there are few images, wherever the box begins.
#[test]
fn images_are_few_wherever_particles_are() {
    let mut finder = Finder::new(LIMIT);
    find(&thousand(CUBE), &mut finder);
    let images = finder.images() as f64;
    let mut copied = 0;
    for by in [
        [0.0, 0.0, 0.0],
        [0.125, 0.0, -0.0625],
        [16.0, -32.0, 1600.0],
        [7.5, -3.0, 100.0],
        [-8.0; 3],
    ] {
        let mut moved = thousand(CUBE);
        for (k, x) in moved.centres.iter_mut().enumerate() {
            let only = if by[2] < 1000.0 || k % 2 == 0 { 1.0 } else { 0.0 };
            (0..3).for_each(|axis| x[axis] += only * by[axis]);
        }
        let periodic = moved.periodic();
        let AnyScene::Space(Stored::F64(scene)) = periodic.scene() else { panic!("in space") };
        let mut buffers = Images::default();
        let made = buffers.make(scene, periodic.lattice(), Arithmetic::Exact, LIMIT).unwrap();
        assert!((made.ghosts() as f64 / images - 1.0).abs() < 0.2, "{by:?}: {}", made.ghosts());
        // Few particles are examined, wherever the box begins.
        assert!(made.bytes() < 72 * 400 + if made.are_as_given() { 0 } else { 37_000 }, "{by:?}");
        copied += usize::from(!made.are_as_given());
        let found = ask(&mut *TABLE[5].make(OPTIONS), &periodic, Arithmetic::Exact).unwrap();
        assert!(found == moved.truth());
    }
    assert_eq!(copied, 1);
}

/// The scene has enough particles for a second thread in every detector but `direct`.
#[test]
fn several_threads_find_the_contacts_of_one() {
    let random = &mut ChaCha8Rng::seed_from_u64(9);
    let mut bag = thousand(CUBE);
    bag.vectors = CUBE.map(|vector| vector.map(|x| 3.0 * x));
    bag.centres =
        (0..31_000).map(|_| std::array::from_fn(|_| 48.0 * random.random::<f64>())).collect();
    let mut outside = bag.clone();
    outside.centres.iter_mut().step_by(3).for_each(|x| x[2] -= 48.0);
    for bag in [bag, outside] {
        let periodic = bag.periodic();
        let mut truth = None;
        for entry in detectors().filter(|entry| entry.threads && entry.name != "direct") {
            let mut finder = Finder::new(LIMIT);
            for arithmetic in [Arithmetic::Exact, Arithmetic::F64, Arithmetic::F32] {
                let mut digests = [1, 2].map(|threads| {
                    let mut contacts = ContactList::default();
                    let mut detector = entry.make(Options { threads, ..OPTIONS });
                    finder.list(&periodic, &mut *detector, arithmetic, &mut contacts).unwrap();
                    assert!(contacts.shifted.iter().all(|pair| pair.image != [0; 3]));
                    assert!(contacts.shifted.len() > 100 && contacts.plain.len() > 5000);
                    contacts.digest()
                });
                let counted = count(&mut *entry.make(OPTIONS), &periodic, arithmetic).0;
                assert_eq!(digests, [counted; 2], "{} in {arithmetic}", entry.name);
                if arithmetic == Arithmetic::Exact {
                    digests[0] = *truth.get_or_insert(digests[0]);
                    assert_eq!(digests[0], digests[1], "{}", entry.name);
                }
            }
        }
    }
}
