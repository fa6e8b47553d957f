//! The open rule leaves out pairs at exactly the sum of the radii, and no others.

use contactbench_detectors::oracle;
use contactbench_detectors::oracle::boxes;
use contactbench_detectors::table::{Role, TABLE};
use contactbench_detectors::tracker;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::periodic::Searchable;
use contactbench_ground::periodic::{ContactList, Periodic};
use contactbench_ground::scene::{AnyScene, Lattice, Radii};
use contactbench_lists::periodic;

const LIMIT: u64 = 1 << 28;

/// Returns a lattice of 5 by 5 discs with spacing 1, in a box of 5 by 5.
fn lattice(radius: f64, each: bool) -> (AnyScene<'static>, Periodic<'static>) {
    let at = |k: u32| [f64::from(k % 5), f64::from(k / 5)];
    let radii = if each { Radii::from(vec![radius; 25]) } else { radius.into() };
    let scene = AnyScene::at((0..25).map(at), radii).unwrap();
    let vectors = [[5.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 5.0]];
    let cell = Lattice::new(vectors, [true, true, false], [0.0; 3]).unwrap();
    (scene.clone(), Periodic::new(scene, cell).unwrap())
}

#[test]
fn only_the_closed_rule_accepts_ties() {
    for each in [false, true] {
        for (radius, arithmetic, expected) in [
            (0.5, Arithmetic::Exact, [40, 50]),
            (0.5, Arithmetic::ExactOpen, [0, 0]),
            (0.5f64.next_up(), Arithmetic::ExactOpen, [40, 50]),
            (0.5f64.next_down(), Arithmetic::Exact, [0, 0]),
        ] {
            let (open, boxed) = lattice(radius, each);
            let told = format!("radius {radius:?}, {arithmetic}, each: {each}");
            let truths = [
                oracle::truth(&open, arithmetic).unwrap().pairs.len(),
                boxes::truth(&boxed, arithmetic, LIMIT).unwrap().pairs.len(),
            ];
            assert_eq!(truths, expected, "{told}");
            for entry in TABLE.iter().filter(|entry| entry.role == Role::Detector) {
                let (mut detector, mut pairs) = (entry.make(Options::default()), Vec::new());
                detector.list(&open, arithmetic.test(), &mut pairs).unwrap();
                let found = periodic::contacts(&boxed, &mut *detector, arithmetic, LIMIT).unwrap();
                assert_eq!([pairs.len(), found.len()], expected, "{}, {told}", entry.name);
            }
            let tracker = "verlet(nbs,skin=0.5)";
            let mut tracker = tracker::parse(tracker).unwrap().make(Options::default());
            for (frame, expected) in
                [Searchable::Open(&open, arithmetic.test()), Searchable::Boxed(&boxed, arithmetic)]
                    .into_iter()
                    .zip(expected)
            {
                for _ in 0..2 {
                    let mut contacts = ContactList::default();
                    tracker.find(frame, None, &mut contacts).unwrap();
                    assert_eq!(contacts.len(), expected as u64, "verlet, {told}");
                }
            }
        }
    }
}
