use contactbench_core::contact::Arithmetic;
use contactbench_core::oracle::{Errors, compare, judges, truth};
use contactbench_core::scene::{AnyScene, Radii, Scene};
use contactbench_core::sink::normalise;

#[test]
fn scenes_of_one_large_body_are_judged_without_its_cells() {
    let with = |small: f64| {
        let centres = [0.0, 3.0].map(|x| nalgebra::Point::from([x, 0.0])).to_vec();
        let scene: AnyScene<'_> =
            Scene::new(centres, Radii::Each(vec![1.0, small].into())).unwrap().into();
        judges(&scene)[0]
    };
    let first = [1.0, 0.5, 0.499, 0.0].map(|part| with(part).name);
    assert_eq!(first, ["nbs", "nbs", "kd-tree", "kd-tree"]);
}

#[test]
fn errors_are_counted_apart() {
    let centres = [0.0, 1.5, 2.0, 3.5, 4.0, 5.5, 6.5].map(|x| nalgebra::Point::from([x, 0.0]));
    let scene: AnyScene<'_> = Scene::new(centres.to_vec(), Radii::Uniform(1.0)).unwrap().into();
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
