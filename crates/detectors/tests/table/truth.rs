use contactbench_detectors::oracle;
use contactbench_detectors::oracle::boxes;
use contactbench_detectors::oracle::{Errors, compare, truth};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::pairs::normalise::normalise;
use contactbench_ground::periodic::Periodic;
use contactbench_ground::scene::{AnyScene, Lattice};
use contactbench_terms::mix::splitmix64;

/// The contacts of chosen particles are those of the whole truth that involve them.
#[test]
fn chosen_particles_are_tested_against_all_others() {
    for periodic in [[false; 3], [true; 3], [true, false, true]] {
        for ratio in [1.0, 50.0] {
            let n = 1200;
            let draw = |k: u64| splitmix64(k) as f64 / u64::MAX as f64;
            let at = |k: u64| [0, 1, 2].map(|a| 9.0 * draw(3 * k + a) - 3.0);
            let radius =
                |k: u64| if k == 7 { 0.2 * ratio } else { 0.2 + 0.2 * draw(k + (1 << 40)) };
            let radii: Vec<f64> = (0..n).map(radius).collect();
            let scene = AnyScene::at((0..n).map(at), radii).unwrap();
            let vectors = [[9.0, 0.0, 0.0], [4.0, 9.0, 0.0], [0.0, -3.0, 9.0]];
            let lattice = Lattice::new(vectors, periodic, [0.0; 3]).unwrap();
            let space = Periodic::new(scene, lattice).unwrap();
            for arithmetic in [Arithmetic::Exact, Arithmetic::ExactOpen, Arithmetic::F32] {
                let chosen = oracle::random(n as usize, 100, 5);
                let found = boxes::touching(&space, arithmetic, &chosen, 1 << 30).unwrap();
                let mut truth = boxes::truth(&space, arithmetic, 1 << 30).unwrap().pairs;
                truth.retain(|it| chosen[it.i as usize] || chosen[it.j as usize]);
                assert!(found == truth && found.len() > 50, "{periodic:?} {ratio} {arithmetic:?}");
            }
        }
    }
}

#[test]
fn errors_are_counted_apart() {
    let row = [0.0, 1.5, 2.0, 3.5, 4.0, 5.5, 6.5].map(|x| [x, 0.0]);
    let scene = AnyScene::at(row, 1.0).unwrap();
    let truth = truth(&scene, Arithmetic::Exact).unwrap().pairs;
    assert_eq!(
        truth,
        [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3], [2, 4], [3, 4], [3, 5], [4, 5], [5, 6]]
    );
    assert_eq!(compare(&truth, &truth, &scene), Errors::default());
    let mut reported = [
        [2, 0],
        [0, 2],
        [2, 1],
        [3, 1],
        [3, 2],
        [4, 2],
        [4, 3],
        [6, 4],
        [4, 5],
        [0, 0],
        [6, 3],
        [6, 5],
    ];
    let errors = Errors {
        missed: 2,
        spurious: 2,
        duplicate: 1,
        self_pairs: 1,
        deepest_miss: 0.5,
        widest_false: 1.0,
    };
    normalise(&mut reported);
    assert_eq!(compare(&reported, &truth, &scene), errors);
    // A missed tangent pair has depth 0.
    let without: Vec<[u32; 2]> =
        truth.iter().copied().filter(|&pair| pair != [0, 2] && pair != [2, 4]).collect();
    assert_eq!(compare(&without, &truth, &scene), Errors { missed: 2, ..Errors::default() });
}
