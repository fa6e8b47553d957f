//! All detectors give the same pairs as brute force: on every generator, on the cases that break
//! textbook filters, after any history, in every arithmetic. One body per property, looping over
//! the table.

use std::time::Duration;

use contactbench::check::{self, Limits};
use contactbench::contact::{Arithmetic, Test};
use contactbench::detect::Options;
use contactbench::detect::table::{Entry, TABLE, parse};
use contactbench::oracle;
use contactbench::scene::hard::{Expect, cases};
use contactbench::scene::spec::Spec;
use contactbench::scene::{AnyScene, Radii, Scene, Stored};
use contactbench::sink::{Digest, Visit};
use nalgebra::Point;

fn detectors() -> Vec<&'static Entry> {
    TABLE.iter().filter(|entry| entry.must_be_right()).collect()
}

fn plane(points: &[[f64; 2]], r: f64) -> AnyScene<'static> {
    Scene::new(points.iter().copied().map(Point::from).collect::<Vec<_>>(), Radii::Uniform(r))
        .unwrap()
        .into()
}

fn space(points: &[[f64; 3]], r: f64) -> AnyScene<'static> {
    Scene::new(points.iter().copied().map(Point::from).collect::<Vec<_>>(), Radii::Uniform(r))
        .unwrap()
        .into()
}

/// The number of contacts, which all detectors must agree on with brute force, in every arithmetic
/// that takes the scene.
fn contacts(name: &str, scene: &AnyScene<'static>) -> u64 {
    for arithmetic in Arithmetic::SAFE {
        let Ok(truth) = oracle::truth(scene, arithmetic) else { continue };
        let stored = scene.stored(arithmetic).unwrap();
        for entry in detectors() {
            let mut digest = Digest::default();
            let mut detector = entry.make(Options::default());
            if let Err(refusal) = detector.visit(&stored, arithmetic.test(), &mut digest) {
                assert_eq!(
                    digest,
                    Digest::default(),
                    "{name}: {} refused after reporting",
                    entry.name
                );
                assert!(
                    entry.name != "direct",
                    "{name}: direct refuses nothing here, but: {refusal}"
                );
                continue;
            }
            assert_eq!(digest, truth.digest, "{name}: {} in {}", entry.name, arithmetic.name());
        }
    }
    oracle::truth(scene, Arithmetic::Exact).unwrap().digest.contacts
}

#[test]
fn every_generator_with_seeds() {
    let report = check::check(
        &detectors(),
        &Arithmetic::SAFE,
        &Limits { seeds: 3, time: Duration::from_secs(60), ..Limits::default() },
    )
    .unwrap();
    for failure in &report.failures {
        println!(
            "{} {:?} on {}:\n{}",
            failure.detector,
            failure.arithmetic,
            failure.found_on,
            check::as_csv(&failure.smallest.scene)
        );
    }
    assert!(report.failures.is_empty() && report.cases > 8_000, "{} cases", report.cases);
}

#[test]
fn couples_that_a_textbook_grid_loses() {
    // With cells of edge 1 and i = floor(x), the middle disc is in cell 0 and the right one in cell
    // 2.
    assert_eq!(
        contacts("three discs", &plane(&[[0.0, 0.0], [1.0f64.next_down(), 0.0], [2.0, 0.0]], 0.5)),
        1
    );
    let row: Vec<[f64; 2]> = (0..2000).map(|k| [-1.0 + f64::from(k), 0.0]).collect();
    assert_eq!(contacts("row from -1", &plane(&row, 0.5)), 1999);
    // Decimal coordinates far from the origin: which neighbours touch is decided by rounding;
    // exactness by brute force.
    let row: Vec<[f64; 3]> = (0..500).map(|k| [-1e6 + 0.1 * f64::from(k), 0.0, -3.0]).collect();
    contacts("decimal row", &space(&row, 0.05));
}

#[test]
fn lattices_exactly_in_touch() {
    let square: Vec<[f64; 2]> = (0..400).map(|k| [f64::from(k % 20), f64::from(k / 20)]).collect();
    assert_eq!(contacts("square", &plane(&square, 0.5)), 2 * 20 * 19);
    let cubic: Vec<[f64; 3]> = (0..1000)
        .map(|k| {
            [f64::from(k % 10), f64::from(k / 10 % 10), f64::from(k / 100)].map(|x| -7.0 + 0.25 * x)
        })
        .collect();
    assert_eq!(contacts("cubic", &space(&cubic, 0.125)), 3 * 100 * 9);
    for s in ["a:n=100", "b:n=100,s=1", "c:n=100,s=1", "d:n=100,s=1"] {
        let scene = Spec::parse(&format!("pack-{s}")).unwrap().make().unwrap();
        let expected = if s.starts_with('c') { 180 } else { 90 };
        assert_eq!(contacts(s, &scene), expected, "pack-{s}");
    }
}

#[test]
fn small_and_degenerate() {
    assert_eq!(contacts("none", &plane(&[], 1.0)), 0);
    assert_eq!(contacts("one", &space(&[[1e300, -1e-300, 0.0]], 1.0)), 0);
    assert_eq!(contacts("two in one place", &space(&[[5.0; 3]; 2], 0.0)), 1);
    assert_eq!(contacts("points apart", &plane(&[[0.0, 0.0], [0.0, f64::from_bits(1)]], 0.0)), 0);
    let points = Spec::parse("loose:n=300").unwrap().make().unwrap();
    let AnyScene::Plane(Stored::F64(points)) = points else { unreachable!() };
    let points =
        AnyScene::from(Scene::new(points.centres().to_vec(), Radii::Uniform(0.0)).unwrap());
    assert_eq!(contacts("many points", &points), 0);
    for arithmetic in Arithmetic::SAFE {
        for entry in detectors() {
            let taken = entry.make(Options::default()).visit(
                &points.stored(arithmetic).unwrap(),
                arithmetic.test(),
                &mut Digest::default(),
            );
            assert!(taken.is_ok() || !entry.is_ours(), "{}: {taken:?}", entry.name);
        }
    }
    assert_eq!(contacts("a clique", &plane(&[[0.25, 0.5]; 60], 1.0)), 60 * 59 / 2);
    assert_eq!(
        contacts("zeros of both signs", &plane(&[[0.0, -0.0], [-0.0, 0.0], [-5e-17, 0.0]], 0.5)),
        3
    );
    assert_eq!(
        contacts(
            "all on one x",
            &space(&std::array::from_fn::<_, 50, _>(|k| [3.0, k as f64, 0.0]), 0.5)
        ),
        49
    );
    assert_eq!(
        contacts("subnormal", &plane(&[[0.0, 0.0], [4e-320, 0.0], [9e-320, 0.0]], 2e-320)),
        1
    );
}

#[test]
fn far_away_and_huge() {
    // Beyond 2^31 cells all but direct refuse; below it heads would not fit the limit, but sorting
    // and the tree work.
    assert_eq!(contacts("10^12 apart", &plane(&[[0.0, 0.0], [1e12, 0.0], [1e12, 1.0]], 0.5)), 1);
    assert_eq!(
        contacts("10^9 apart", &space(&[[0.0; 3], [1e9; 3], [1e9, 1e9, 1e9 + 1.0]], 0.5)),
        1
    );
    assert_eq!(
        contacts("the largest numbers", &plane(&[[f64::MAX, 0.0], [-f64::MAX, 0.0]], f64::MAX)),
        1
    );
    assert_eq!(contacts("large offset", &space(&[[1e15; 3], [1e15 + 1.0, 1e15, 1e15]], 0.5)), 1);
    let ratio: Vec<Point<f64, 2>> = (0..300)
        .map(|k| Point::from([f64::from(k % 20) * 0.01, f64::from(k / 20) * 0.01]))
        .collect();
    let radii: Vec<f64> = (0..300).map(|k| if k == 17 { 100.0 } else { 0.004 }).collect();
    let giant = Scene::new(ratio, Radii::Each(radii.into())).unwrap();
    assert_eq!(contacts("one giant in dust", &giant.into()), 299);
}

/// Shrink, grow, move, change dimension and arithmetic: what a call leaves behind never changes the
/// next.
#[test]
fn history_does_not_matter() {
    let scenes: Vec<AnyScene<'static>> = [
        "packed:n=500",
        "loose:dim=3,n=40",
        "pack-c:n=100,s=40",
        "clustered:dim=3,n=700,size-ratio=3",
        "packed:dim=3,n=2",
        "loose:n=0",
        "packed:dim=3,n=600,diameter=0.001",
        "pack-c:n=400,s=3",
        "packed:n=500",
    ]
    .iter()
    .map(|text| Spec::parse(text).unwrap().make().unwrap())
    .collect();
    for entry in detectors() {
        let mut detector = entry.make(Options::default());
        for (k, scene) in scenes.iter().chain(scenes.iter().rev()).enumerate() {
            let arithmetic = Arithmetic::SAFE[k % 4];
            let mut digest = Digest::default();
            detector
                .visit(&scene.stored(arithmetic).unwrap(), arithmetic.test(), &mut digest)
                .unwrap();
            assert_eq!(
                digest,
                oracle::truth(scene, arithmetic).unwrap().digest,
                "{} at step {k}",
                entry.name
            );
        }
    }
}

/// Ways to part bodies by size, which are parameters: on every hard case, one after the other, so
/// that each is also the history of the next.
#[test]
fn ways_to_part_sizes_are_right_on_hard_cases() {
    for spec in ["nbs:levels=auto", "hgrid:levels=optimal", "hgrid:levels=1e-3/0.25/1"] {
        let mut detector = parse(spec).unwrap().make(Options::default());
        let (mut answers, mut refusals) = (0, 0);
        for case in cases().filter(|case| case.expect != Expect::Invalid) {
            let steps = case.dims.iter().flat_map(|&dim| case.steps(dim).unwrap());
            // In a box it is images that differ, which all detectors are given alike.
            for scene in steps.filter(|step| step.lattice.is_none()).map(|step| step.scene) {
                for arithmetic in Arithmetic::SAFE {
                    let Ok(truth) = oracle::truth(&scene, arithmetic) else { continue };
                    let (stored, mut found) =
                        (scene.stored(arithmetic).unwrap(), Digest::default());
                    match detector.visit(&stored, arithmetic.test(), &mut found) {
                        Ok(()) => {
                            let what = (case.name, scene.dim(), arithmetic);
                            assert_eq!(found, truth.digest, "{spec} on {what:?}");
                            answers += 1;
                        }
                        Err(_) => {
                            assert_eq!(found, Digest::default(), "{spec} on {}", case.name);
                            refusals += 1;
                        }
                    }
                }
            }
        }
        assert!(answers > 800 && refusals * 10 < answers, "{spec}: {answers}, {refusals}");
    }
}

/// After a refusal the detector is as good as new.
#[test]
fn a_refusal_leaves_no_trace() {
    let small = Spec::parse("packed:n=300").unwrap().make().unwrap();
    let sparse = Spec::parse("pack-c:n=2800,s=100").unwrap().make().unwrap();
    let truth = oracle::truth(&small, Arithmetic::Exact).unwrap().digest;
    for entry in detectors() {
        let mut detector = entry.make(Options { memory_limit: 32_000, threads: 1 });
        let mut reported = 0;
        let refused =
            detector.visit(&sparse, Test::Exact, &mut Visit(|_, _| reported += 1)).is_err();
        // A library knows of no limit.
        assert!(
            refused || entry.name == "direct" || !entry.is_ours(),
            "{} took a scene over its limit",
            entry.name
        );
        assert!(reported == 0 || !refused);
        let mut digest = Digest::default();
        detector.visit(&small, Test::Exact, &mut digest).unwrap();
        assert_eq!(digest, truth, "{}", entry.name);
    }
}

/// Order of the particles, and the names they carry, do not matter.
#[test]
fn permutation_changes_nothing_but_names() {
    for text in ["packed:n=300", "clustered:dim=3,n=300,size-ratio=5"] {
        let scene = Spec::parse(text).unwrap().make().unwrap();
        let order: Vec<u32> = (0..300).map(|k| k * 7 % 300).collect(); // 7 and 300 have no common factor
        let permuted = scene.reordered(&order);
        for entry in detectors() {
            let mut digest = Digest::default();
            let mut renamed = Visit(|i: u32, j: u32| {
                contactbench::sink::Sink::contact(&mut digest, order[i as usize], order[j as usize])
            });
            entry.make(Options::default()).visit(&permuted, Test::Exact, &mut renamed).unwrap();
            assert_eq!(
                digest,
                oracle::truth(&scene, Arithmetic::Exact).unwrap().digest,
                "{} {text}",
                entry.name
            );
        }
    }
}
