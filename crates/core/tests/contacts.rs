use contactbench_core::scene::SceneError;
use contactbench_core::{Contacts, Error, contacts};

#[test]
fn one_radius_holds_for_all_and_buffers_are_cleared() {
    let mut plane = Contacts::<2>::default();
    let row: Vec<[f64; 2]> = (0..5).map(|k| [f64::from(k), 0.0]).collect();
    let mut expected: Vec<[u32; 2]> = (0..4).map(|k| [k, k + 1]).collect();
    let sorted = |pairs: &[[u32; 2]]| {
        let mut pairs = pairs.to_vec();
        pairs.sort_unstable();
        pairs
    };
    assert_eq!(sorted(plane.find(&row, &[0.5]).unwrap()), expected);
    assert_eq!(sorted(plane.find(&row, &[0.5; 5]).unwrap()), expected);
    expected.truncate(1);
    assert_eq!(sorted(plane.find(&row[..2], &[0.25, 0.75]).unwrap()), expected);
    assert!(plane.find(&[], &[]).unwrap().is_empty());
    let space = contacts(&[[0.0, 0.0, 0.0], [2.0, 3.0, 6.0], [9.0, 9.0, 9.0]], &[3.5]);
    assert_eq!(space.unwrap(), [[0, 1]]);
}

#[test]
fn invalid_scenes_are_errors() {
    let scene = |centres: &[[f64; 2]], radii: &[f64]| contacts(centres, radii).unwrap_err();
    let two = [[0.0, 0.0], [1.0, f64::NAN]];
    assert!(matches!(scene(&two, &[1.0]), Error::Scene(SceneError::Coordinate { .. })));
    assert!(matches!(scene(&two[..1], &[-1.0]), Error::Scene(SceneError::UniformRadius { .. })));
    assert!(matches!(scene(&two[..1], &[1.0, 1.0]), Error::Scene(SceneError::Lengths { .. })));
}
