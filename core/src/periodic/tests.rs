use super::*;
use crate::contact::Arithmetic;
use crate::detect::Options;
use crate::detect::table::TABLE;
use crate::scene::{Radii, Scene};

const LIMIT: u64 = 1 << 28;

/// One body in a cube: how many neighbours it has.
fn neighbours(cutoff: f64, periodic: [bool; 3]) -> usize {
    let centre = nalgebra::Point::from([0.25, 0.5, 0.875]);
    let scene = Scene::new(vec![centre], Radii::Uniform(cutoff / 2.0)).unwrap();
    let lattice = Lattice::along_axes([1.0; 3], periodic).unwrap();
    let scene = Periodic::new(scene.into(), lattice).unwrap();
    let truth = truth(&scene, Arithmetic::Exact, LIMIT).unwrap();
    for entry in TABLE.iter().filter(|entry| entry.must_be_right()) {
        let mut detector = entry.make(Options::default());
        let found = contacts(&scene, &mut *detector, Arithmetic::Exact, LIMIT).unwrap();
        assert_eq!(found, truth.pairs, "{}", entry.name);
    }
    2 * truth.pairs.len()
}

#[test]
fn a_cube_has_the_neighbours_that_it_is_known_to_have() {
    for (cutoff, expected) in [(1.1, 6), (1.5, 18), (1.8, 26), (2.0, 32), (2.0f64.next_down(), 26)]
    {
        assert_eq!(neighbours(cutoff, [true; 3]), expected, "{cutoff}");
    }
    assert_eq!(neighbours(1.1, [true, false, false]), 2);
    assert_eq!(neighbours(1.1, [true, false, true]), 4);
    assert_eq!(neighbours(1.1, [false; 3]), 0);
}
