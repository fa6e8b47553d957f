//! Tests of detectors' parameters, and of the ranks of detectors that establish the truth.

use contactbench_detectors::oracle::truth;
use contactbench_detectors::table::{Parameter, Role, TABLE, judges, parse};
use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::detect::Options;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::normalise::normalise;
use contactbench_ground::scene::AnyScene;

use crate::sizes;

fn lattice() -> AnyScene<'static> {
    let centre = |k: u32| [f64::from(k % 40), f64::from(k / 40)];
    AnyScene::at((0..1600).map(centre), 0.5).unwrap()
}

/// A lattice whose neighbours touch, and spheres at random places, equal and not.
#[test]
fn parameters_change_no_contact() {
    let unequal = (0..800).map(|k| 0.3 + 0.3 * f64::from(k % 2)).collect();
    let [equal, unequal] = [vec![0.5; 800], unequal].map(|radii| sizes::scene::<3>(radii, 8.0, 5));
    let scenes =
        [lattice(), equal, unequal].map(|scene| (truth(&scene, Arithmetic::Exact).unwrap(), scene));
    assert_eq!(scenes[0].0.pairs.len(), 2 * 40 * 39);
    let mut detected = 0;
    for entry in TABLE.iter().filter(|entry| entry.must_be_right()) {
        for Parameter { name, values, .. } in entry.parameters {
            for value in *values {
                let spec = parse(&format!("{}:{name}={value}", entry.name)).unwrap();
                for (truth, scene) in &scenes {
                    let mut pairs = Vec::new();
                    match spec.make(Options::default()).list(scene, Test::Exact, &mut pairs) {
                        Err(Refusal::Instructions { .. }) if *name == "level" => continue,
                        result => result.unwrap(),
                    }
                    normalise(&mut pairs);
                    assert!(pairs == truth.pairs, "{spec}: {} contacts", pairs.len());
                    detected += 1;
                }
            }
        }
    }
    assert!(detected >= 15, "three forms, and at least best and portable");
}

#[test]
fn ranks_of_judges_are_distinct() {
    let judges = judges();
    assert!(judges.iter().all(|entry| entry.role == Role::Detector));
    let places: Vec<u8> = judges.iter().map(|entry| entry.judge).collect();
    assert_eq!(places, [1, 2, 3, 4]);
}
