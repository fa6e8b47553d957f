//! Every detector finds the truth in every arithmetic, whatever scene it searched before.

use contactbench_detectors::table;
use contactbench_ground::contact::{Particles, any_particles};
use contactbench_ground::probe::Silent;
use contactbench_ground::scene::array;
use contactbench_ground::wide::Level;
use contactbench_ground::with_scene;
use contactbench_lists::periodic::frame::ReducedBox;
use contactbench_lists::periodic::images::Images;

use super::*;

#[derive(Debug, Default)]
struct Seen {
    answers: usize,
    contacts: usize,
    own_images: usize,
    /// Number of contacts with an image beyond the nearest images.
    far_images: usize,
    refused: usize,
}

fn agree<const D: usize>(seeds: std::ops::Range<u64>, seen: &mut Seen) {
    let mut detectors: Vec<_> = detectors()
        .flat_map(|entry| {
            let threads = if entry.threads { 1..3 } else { 1..2 };
            threads.map(|threads| Options { threads, ..OPTIONS }).map(move |options| {
                (entry.name, entry.make(options), Finder::new(LIMIT), ContactList::default())
            })
        })
        .collect();
    for seed in seeds {
        let bag = random::<D>(seed, [Numbers::Real, Numbers::Dyadic][seed as usize / 4 % 2]);
        let periodic = bag.periodic();
        for arithmetic in Arithmetic::SAFE {
            let truth = truth(&periodic, arithmetic, LIMIT).unwrap();
            for (name, detector, finder, contacts) in &mut detectors {
                contacts.clear();
                match finder.list(&periodic, &mut **detector, arithmetic, contacts) {
                    Ok(()) => {
                        assert!(contacts.shifted.iter().all(|pair| pair.image != [0; 3]));
                        let found = contacts.sorted(1000, u64::MAX).unwrap();
                        assert_eq!(found, truth.pairs, "{name} in {arithmetic}: {bag:?}");
                        let counted = count(&mut **detector, &periodic, arithmetic).0;
                        assert_eq!(counted, truth.digest, "{name} in {arithmetic}: {bag:?}");
                    }
                    Err(refusal) => {
                        let expected = matches!(refusal, Refusal::Domain { .. });
                        assert!(expected, "{name} in {arithmetic}: {refusal}\n{bag:?}");
                        seen.refused += 1;
                    }
                }
                seen.answers += 1;
            }
            seen.contacts += truth.pairs.len();
            for pair in &truth.pairs {
                seen.own_images += usize::from(pair.i == pair.j);
                seen.far_images += usize::from(pair.image.iter().any(|s| s.abs() > 1));
            }
        }
    }
}

#[test]
fn detectors_find_the_truth_in_the_plane() {
    let mut seen = Seen::default();
    agree::<2>(0..200, &mut seen);
    assert!(seen.answers > 8000 && seen.contacts > 5000 && seen.refused == 0, "{seen:?}");
    assert!(seen.own_images > 100 && seen.far_images > 500, "{seen:?}");
}

#[test]
fn detectors_find_the_truth_in_space() {
    let mut seen = Seen::default();
    agree::<3>(0..100, &mut seen);
    assert!(seen.answers > 4000 && seen.contacts > 5000 && seen.refused == 0, "{seen:?}");
    assert!(seen.own_images > 100 && seen.far_images > 500, "{seen:?}");
}

/// The truth in a rounded arithmetic comes from the images that [`Images`] makes. The test makes
/// many more images and finds no further contacts.
#[test]
fn no_further_image_touches_in_a_rounded_arithmetic() {
    fn with_more<const D: usize>(bag: &Bag<D>, arithmetic: Arithmetic) -> usize {
        let periodic = bag.periodic();
        let frame = ReducedBox::<D>::new(periodic.lattice()).unwrap();
        let n = bag.centres.len();
        let scene = bag.scene();
        let (mut centres, mut radii, mut names) = (Vec::new(), Vec::new(), Vec::new());
        let mut images = Images::default();
        let Ok(made) = images.make(&scene, periodic.lattice(), arithmetic, LIMIT) else {
            panic!("{bag:?}")
        };
        let wraps: Vec<_> = (0..n as u32).map(|k| made.image(k)).collect();
        let reach = 2.2 * scene.largest_radius() + 0.1;
        let most: [i32; 3] = std::array::from_fn(|v| (frame.lengths[v] * reach).ceil() as i32 + 1);
        let most: [i32; 3] = std::array::from_fn(|v| if bag.periodic[v] { most[v] } else { 0 });
        let mut add = |k: usize, t: [i32; 3]| {
            let t = frame.given(t).unwrap();
            let image = std::array::from_fn(|v| wraps[k][v] + t[v]);
            centres.push(frame.place(array(&scene.centres()[k]), image));
            radii.push(scene.radius(k));
            names.push((k as u32, image));
        };
        (0..n).for_each(|k| add(k, [0; 3]));
        for k in 0..n {
            for (x, y) in (0..=most[0]).flat_map(|x| (-most[1]..=most[1]).map(move |y| (x, y))) {
                let images = (-most[2]..=most[2]).map(|z| [x, y, z]);
                images.filter(|&image| image > [0; 3]).for_each(|image| add(k, image));
            }
        }
        let open = AnyScene::at(centres, radii).unwrap();
        let Ok(open) = open.stored(arithmetic) else { return 0 };
        let mut found = Vec::new();
        let pair = |a: u32, b: u32| {
            let ((i, from), (j, to)) = (names[a as usize], names[b as usize]);
            ImagePair::new(i, j, std::array::from_fn(|v| to[v] - from[v]))
        };
        with_scene!(&open, scene => {
            let particles = any_particles(scene, arithmetic.test()).unwrap();
            for a in 0..n as u32 {
                let others = a + 1..particles.len() as u32;
                let touching = others.filter(|&b| particles.touch(a, b, &mut Silent));
                found.extend(touching.map(|b| pair(a, b)));
            }
        });
        found.sort_unstable();
        let truth = truth(&periodic, arithmetic, LIMIT).unwrap().pairs;
        assert_eq!(truth, found, "{arithmetic}: {bag:?}");
        truth.len()
    }
    let mut contacts = 0;
    for seed in 0..150 {
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            contacts += with_more(&random::<2>(seed, Numbers::Real), arithmetic);
            contacts += with_more(&random::<3>(seed, Numbers::Real), arithmetic);
        }
    }
    assert!(contacts > 5000, "{contacts}");
    // Pairs across a face that only rounding decides, near and far from the origin.
    let random = &mut ChaCha8Rng::seed_from_u64(9);
    let mut touching = 0;
    for turn in 0..3000 {
        let offset = [0.0, 100.0, 3000.0][turn % 3];
        let edge = 2.0 + random.random::<f64>();
        let mut at = || [offset + 0.1 + random.random::<f64>(), offset + 0.01];
        let (a, mut b) = (at(), at());
        let apart = (1.0 + 3e-7 * (1.0 + offset) * (random.random::<f64>() - 0.5)) * 0.5;
        (b[0], b[1]) = (a[0], a[1] + edge - apart);
        let bag = Bag {
            centres: vec![a, b],
            radii: Radii::Uniform(0.25),
            vectors: [[edge, 0.0, 0.0], [0.0, edge, 0.0], [0.0; 3]],
            periodic: [true, true, false],
            origin: [offset; 3],
        };
        touching += with_more(&bag, Arithmetic::F32);
    }
    assert!((1500..3000).contains(&touching), "{touching}");
}

/// Cells hold many particles and images, so that candidates are copied side by side, at most 1,024
/// at a time; some cells hold only images. Lists have more pairs than are sorted at a time. In half
/// of the scenes particles are outside the box.
#[test]
fn full_boxes_on_all_levels() {
    let names: Vec<_> = Level::all().iter().map(|level| level.name()).collect();
    let single = names.iter().map(|name| format!("streamed-nbs:level={name}"));
    let all: Vec<_> = single.chain(["sorting".into(), "cell-grid".into()]).collect();
    let random = &mut ChaCha8Rng::seed_from_u64(11);
    let mut contacts = 0;
    for turn in 0..8 {
        let (n, r) = [(300, 0.2), (500, 0.12), (800, 0.28), (1500, 0.07)][turn % 4];
        let moved = (turn + turn / 4) % 2 == 1;
        let mut at = |_| {
            let outside = moved && random.random::<f64>() < 0.3;
            [0; 3].map(|_| random.random::<f64>() + f64::from(u8::from(outside)))
        };
        let centres: Vec<[f64; 3]> = (0..n).map(&mut at).collect();
        let radii = match turn / 4 {
            0 => Radii::Uniform(r),
            _ => Radii::Each((0..n).map(|k| r * (1.0 - 0.1 * (k % 3) as f64)).collect()),
        };
        let bag = Bag {
            centres,
            radii,
            vectors: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.0, 1.0]],
            periodic: [true, true, turn % 3 > 0],
            origin: [0.0; 3],
        };
        let truth = truth(&bag.periodic(), Arithmetic::Exact, LIMIT).unwrap();
        for name in &all {
            let mut detector = table::parse(name).unwrap().make(OPTIONS);
            let found = ask(&mut *detector, &bag.periodic(), Arithmetic::Exact).unwrap();
            assert_eq!(found, truth.pairs, "{name}, scene {turn}");
        }
        contacts += truth.pairs.len();
    }
    assert!(contacts > 100_000, "{contacts}");
}
