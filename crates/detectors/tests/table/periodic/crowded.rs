//! Boxes smaller than the reach: work is linear in the number of contacts, excess is predicted.

use contactbench_ground::probe::Op;

use super::*;

/// Two discs in a box so tilted or flat that rows of images are `step` apart.
fn two(step: f64) -> Bag<2> {
    Bag {
        centres: vec![[0.0, 0.0], [1.0, 1.0]],
        radii: Radii::Uniform(0.5),
        vectors: [[1.0, 0.0, 0.0], [1.0, step, 0.0], [0.0; 3]],
        periodic: [true, true, false],
        origin: [0.0; 3],
    }
}

/// A detector that gets all images would also test pairs of two images: 8 million here, and a
/// hundred times as many for ten times the contacts.
#[test]
fn tests_are_linear_in_the_answer() {
    let mut each = Vec::new();
    for step in [1e-3, 1e-4, 1e-5] {
        let periodic = two(step).periodic();
        let mut detector = table("streamed-nbs");
        let (digest, tally) = count(&mut *detector, &periodic, Arithmetic::Exact);
        each.push(tally.get(Op::ContactTest) as f64 / digest.contacts as f64);
        assert!(digest.contacts as f64 > 3.9 / step, "{digest:?}");
    }
    assert!(each.iter().all(|&tests| tests < 8.0), "{each:?}");
}

#[test]
fn small_boxes_have_the_true_contacts() {
    let bag = two(1.0 / 1024.0);
    all_find(&bag, &bag.truth());
    // One sphere with thousands of touching images, and dust beside it.
    let cube = |centres: Vec<[f64; 3]>, radii| Bag {
        centres,
        radii,
        vectors: [[0.0625, 0.0, 0.0], [0.0, 0.0625, 0.0], [0.0, 0.0, 0.0625]],
        periodic: [true; 3],
        origin: [0.0; 3],
    };
    for bag in [
        cube(vec![[0.0; 3]], Radii::Uniform(0.5)),
        cube(vec![[0.0; 3], [0.03, 0.0, 5.0]], Radii::Each(vec![0.375, 0.01].into())),
    ] {
        let truth = bag.truth();
        assert!(truth.len() > 3000, "{}", truth.len());
        for name in ["streamed-nbs", "kd-tree", "cell-grid"] {
            let found = ask(&mut *table(name), &bag.periodic(), Arithmetic::Exact);
            assert!(found.as_deref() == Ok(&truth[..]), "{name}");
        }
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            let rounded =
                contactbench_detectors::oracle::boxes::truth(&bag.periodic(), arithmetic, LIMIT)
                    .unwrap();
            let found = ask(&mut *table("nbs"), &bag.periodic(), arithmetic).unwrap();
            assert!(found == rounded.pairs, "{arithmetic:?}");
        }
    }
}

/// Radii in another unit than the box: the images fit in memory, the list of contacts does not.
#[test]
fn too_many_contacts_are_foreseen_in_a_box() {
    let random = &mut ChaCha8Rng::seed_from_u64(3);
    let bag: Bag<3> = Bag {
        centres: (0..500).map(|_| std::array::from_fn(|_| random.random::<f64>())).collect(),
        radii: Radii::Uniform(3.0),
        vectors: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        periodic: [true; 3],
        origin: [0.0; 3],
    };
    let (mut contacts, mut tally) = (ContactList::default(), Tally::default());
    let mut detector = table("streamed-nbs");
    let mut finder = Finder::new(1 << 26);
    let periodic = bag.periodic();
    let (exact, counted) = (Arithmetic::Exact, Some(&mut tally));
    let refused = finder.find(&periodic, &mut *detector, exact, counted, &mut contacts);
    let Err(Refusal::Crowd { particles: 500, each, .. }) = refused else { panic!("{refused:?}") };
    // A ball of radius 6 contains about 905 images of each particle.
    assert!((700.0..1100.0).contains(&(each / 500.0)), "{each}");
    assert_eq!((tally.get(Op::ContactTest), contacts.len()), (0, 0));
}

fn table(name: &str) -> Box<dyn AnyDetector> {
    contactbench_detectors::table::find(name).unwrap().make(OPTIONS)
}
