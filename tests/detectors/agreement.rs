//! All detectors find the same pairs as brute force: on every generator, on hard cases, with used
//! buffers, in every arithmetic.

use std::time::Duration;

use contactbench::check::subject::CheckedSubject;
use contactbench::check::{self, Limits};
use contactbench::scene::hard::{Expect, cases};
use contactbench::scene::{AnyScene, Radii, Scene, Stored};
use contactbench_detectors::oracle;
use contactbench_detectors::table::{Entry, TABLE, parse};
use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::detect::Options;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::pairs::sink::{Digest, Visit};

use crate::make;

fn detectors() -> Vec<&'static Entry> {
    TABLE.iter().filter(|entry| entry.must_be_right()).collect()
}

fn of<const D: usize>(points: &[[f64; D]], r: f64) -> AnyScene<'static> {
    AnyScene::at(points.iter().copied(), r).unwrap()
}

/// Compares a detector with brute force in every arithmetic that can store the scene. Returns the
/// numbers of answers and refusals; a detector that refuses must not report pairs.
fn agree(detector: &mut dyn AnyDetector, scene: &AnyScene<'static>, what: &str) -> [u32; 2] {
    let mut seen = [0; 2];
    for arithmetic in Arithmetic::SAFE {
        let Ok(truth) = oracle::truth(scene, arithmetic) else { continue };
        let (stored, mut found) = (scene.stored(arithmetic).unwrap(), Digest::default());
        let taken = detector.visit(&stored, arithmetic.test(), &mut found).is_ok();
        let expected = if taken { truth.digest } else { Digest::default() };
        assert_eq!(found, expected, "{what}, {}D in {}", scene.dim(), arithmetic.name());
        seen[usize::from(!taken)] += 1;
    }
    seen
}

/// Returns the number of contacts, on which all detectors must agree; `direct` must not refuse.
fn contacts(name: &str, scene: &AnyScene<'static>) -> u64 {
    for entry in detectors() {
        let what = format!("{} on {name}", entry.name);
        let [_, refused] = agree(&mut *entry.make(Options::default()), scene, &what);
        assert!(refused == 0 || entry.name != "direct", "{what}");
    }
    oracle::truth(scene, Arithmetic::Exact).unwrap().digest.contacts
}

#[test]
fn every_generator_with_seeds() {
    let limits = Limits { time: Duration::ZERO, ..Limits::default() };
    let subjects: Vec<_> = detectors().into_iter().map(CheckedSubject::from).collect();
    let report = check::battery(&subjects, &Arithmetic::SAFE, &limits).unwrap();
    for failure in &report.failures {
        let (what, scene) = (&failure.detector, check::as_csv(&failure.smallest.scene));
        println!("{what} {:?} on {}:\n{scene}", failure.arithmetic, failure.found_on);
    }
    assert!(report.failures.is_empty() && report.cases > 2_500, "{} cases", report.cases);
}

/// Scenes with known contacts that are not in the catalogue of hard cases.
#[test]
fn known_scenes() {
    let row = |from: f64| (0..2000).map(|k| [from + f64::from(k), 0.0]).collect::<Vec<_>>();
    let decimal: Vec<_> = (0..500).map(|k| [-1e6 + 0.1 * f64::from(k), 0.0, -3.0]).collect();
    let square: Vec<_> = (0..400).map(|k| [f64::from(k % 20), f64::from(k / 20)]).collect();
    let cubic = (0..1000).map(|k| [k % 10, k / 10 % 10, k / 100]);
    let cubic: Vec<_> = cubic.map(|at| at.map(|x| -7.0 + 0.25 * f64::from(x))).collect();
    let column: Vec<_> = (0..50).map(|k| [3.0, f64::from(k), 0.0]).collect();
    let tiny = f64::from_bits(1);
    for (name, scene, expected) in [
        // If cells of edge 1 were numbered by floor(x), the middle disc would be in cell 0, the
        // right one in cell 2.
        ("three", of(&[[0.0, 0.0], [1f64.next_down(), 0.0], [2.0, 0.0]], 0.5), Some(1)),
        ("row from -1", of(&row(-1.0), 0.5), Some(1999)),
        // In this row of discs, rounding decides which neighbours touch.
        ("decimal row", of(&decimal, 0.05), None),
        ("square", of(&square, 0.5), Some(2 * 20 * 19)),
        ("cubic", of(&cubic, 0.125), Some(3 * 100 * 9)),
        ("none", of::<2>(&[], 1.0), Some(0)),
        ("one", of(&[[1e300, -1e-300, 0.0]], 1.0), Some(0)),
        ("two in one place", of(&[[5.0; 3]; 2], 0.0), Some(1)),
        ("points apart", of(&[[0.0, 0.0], [0.0, tiny]], 0.0), Some(0)),
        ("a clique", of(&[[0.25, 0.5]; 60], 1.0), Some(60 * 59 / 2)),
        ("zeros", of(&[[0.0, -0.0], [-0.0, 0.0], [-5e-17, 0.0]], 0.5), Some(3)),
        ("all on one x", of(&column, 0.5), Some(49)),
        ("subnormal", of(&[[0.0, 0.0], [4e-320, 0.0], [9e-320, 0.0]], 2e-320), Some(1)),
        ("10^12 apart", of(&[[0.0, 0.0], [1e12, 0.0], [1e12, 1.0]], 0.5), Some(1)),
        ("10^9 apart", of(&[[0.0; 3], [1e9; 3], [1e9, 1e9, 1e9 + 1.0]], 0.5), Some(1)),
        ("the largest", of(&[[f64::MAX, 0.0], [-f64::MAX, 0.0]], f64::MAX), Some(1)),
        ("large offset", of(&[[1e15; 3], [1e15 + 1.0, 1e15, 1e15]], 0.5), Some(1)),
    ] {
        let found = contacts(name, &scene);
        assert_eq!(found, expected.unwrap_or(found), "{name}");
    }
    for s in ["a:n=100", "b:n=100,s=1", "c:n=100,s=1", "d:n=100,s=1"] {
        let scene = make(&format!("pack-{s}"));
        let expected = if s.starts_with('c') { 180 } else { 90 };
        assert_eq!(contacts(s, &scene), expected, "pack-{s}");
    }
}

/// Our detectors accept any number of points (particles of radius 0).
#[test]
fn points_are_taken() {
    let AnyScene::Plane(Stored::F64(loose)) = make("loose:n=300") else { unreachable!() };
    let points = Scene::new(loose.centres().to_vec(), Radii::Uniform(0.0)).unwrap().into();
    for entry in detectors() {
        let seen = agree(&mut *entry.make(Options::default()), &points, entry.name);
        assert_eq!(seen, [Arithmetic::SAFE.len() as u32, 0], "{}", entry.name);
    }
    assert_eq!(oracle::truth(&points, Arithmetic::Exact).unwrap().pairs, [[0; 2]; 0]);
}

/// Detectors that split particles by size are right on all hard cases, with used buffers.
#[test]
fn ways_to_part_sizes_are_right_on_hard_cases() {
    for spec in ["hgrid:ratio=1.25", "hgrid:ratio=8", "hgrid:ratio=one-level"] {
        let mut detector = parse(spec).unwrap().make(Options::default());
        let (mut answers, mut refusals) = (0, 0);
        for case in cases().filter(|case| case.expect != Expect::Invalid) {
            let steps = case.dims.iter().flat_map(|&dim| case.steps(dim).unwrap());
            // Scenes in boxes are skipped, because there all detectors get the same images.
            for scene in steps.filter(|step| step.lattice.is_none()).map(|step| step.scene) {
                let seen = agree(&mut *detector, &scene, &format!("{spec} on {}", case.name));
                [answers, refusals] = [answers + seen[0], refusals + seen[1]];
            }
        }
        assert!(answers > 800 && refusals * 10 < answers, "{spec}: {answers}, {refusals}");
    }
}

/// A detector still works after it has refused a scene.
#[test]
fn a_refusal_leaves_no_trace() {
    let (small, sparse) = (make("packed:n=300"), make("pack-c:n=6000,s=100"));
    let truth = oracle::truth(&small, Arithmetic::Exact).unwrap().digest;
    for entry in detectors() {
        let mut detector = entry.make(Options { memory_limit: 60_000, threads: 1 });
        let mut reported = 0;
        let mut sink = Visit(|_, _| reported += 1);
        let refused = detector.visit(&sparse, Test::Exact, &mut sink).is_err();
        let may_take = entry.name == "direct";
        assert!(refused && reported == 0 || !refused && may_take, "{}", entry.name);
        let mut digest = Digest::default();
        detector.visit(&small, Test::Exact, &mut digest).unwrap();
        assert_eq!(digest, truth, "{}", entry.name);
    }
}
