//! Tests the output of pairs in every format.

use std::process::Stdio;

use contactbench_detectors::table::{Role, TABLE};

use crate::common::{PROGRAM, Place, ended, npy, pairs, program};

/// Returns a hexagonal layer of 12 x 12 slightly overlapping discs, shuffled, with three radii.
fn layer() -> Vec<[f64; 3]> {
    let place = |k: u32| {
        let (row, column) = (k / 12, k % 12);
        let x = 0.975 * (f64::from(column) + 0.5 * f64::from(row % 2));
        [x, 0.85 * f64::from(row), 0.5 - 0.01 * f64::from(k % 3)]
    };
    (0..144).map(|k| place(k * 7 % 144)).collect()
}

#[test]
fn every_form_of_output_holds_the_same_pairs() {
    let at = Place::new();
    let particles = layer();
    let rows: String = particles.iter().map(|[x, y, r]| format!("{x:?},{y:?},{r:?}\n")).collect();
    at.file("layer.csv", format!("x,y,r\n{rows}"));
    let touch = |[i, j]: &[u32; 2]| {
        let ([ax, ay, ar], [bx, by, br]) = (particles[*i as usize], particles[*j as usize]);
        (ax - bx).powi(2) + (ay - by).powi(2) <= (ar + br).powi(2)
    };
    let all = (0..144u32).flat_map(|i| (i + 1..144).map(move |j| [i, j]));
    let truth: Vec<[u32; 2]> = all.filter(touch).collect();
    assert!(truth.len() > particles.len(), "a dense layer: {} pairs", truth.len());
    let text: String = truth.iter().map(|[i, j]| format!("{i},{j}\n")).collect();
    let text = format!("i,j\n{text}");
    // No two of these discs are tangent, so all arithmetics agree.
    for entry in TABLE.iter().filter(|entry| entry.role == Role::Detector) {
        let line = format!("detect layer.csv --detector {}", entry.name);
        assert_eq!(at.good(&line).stdout, text, "{}", entry.name);
    }
    assert_eq!(at.good("detect layer.csv -o pairs.csv").stdout, "");
    assert_eq!(at.read("pairs.csv"), text);
    at.good("detect layer.csv --out pairs.npy");
    assert_eq!(pairs(&at.path("pairs.npy")), truth);
    for detector in ["direct", "cell-grid"] {
        let line = format!("detect layer.csv --detector {detector} --threads 2");
        assert_eq!(at.good(&line).stdout, text, "{detector}");
    }
    // In an npy file with three columns, --dim 2 makes them x, y and radius.
    at.file("layer.npy", npy(&particles.iter().map(|it| it.to_vec()).collect::<Vec<_>>()));
    assert_eq!(at.good("detect layer.npy --dim 2").stdout, text);
    at.file("nan.npy", npy(&[vec![0.0, 0.0, 0.0], vec![1.0, f64::NAN, 0.0]]));
    at.ends(2, "detect nan.npy --radius 1", &["nan.npy", "particle 1 (from 0)", "y NaN is not"]);
    at.file("negative.npy", npy(&[vec![0.0, 0.0, 0.0, 1.0], vec![1.0, 0.0, 0.0, -1.0]]));
    at.ends(2, "detect negative.npy", &["negative.npy", "particle 1 (from 0)", "-1"]);
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error_and_a_full_disk_is_one() {
    let at = Place::new();
    // 400 discs in one place: 79,800 pairs, more than a pipe holds.
    at.file("heap.csv", format!("x,y,r\n{}", "0,0,1\n".repeat(400)));
    // The program keeps these few lines in a buffer until its end.
    at.file("two.csv", "x,y,r\n0,0,1\n0,0,1\n");
    let first = at.shell(&format!("{{ {PROGRAM} detect heap.csv; echo $? > code; }} | head -1"));
    assert_eq!(first.stdout, "i,j\n");
    assert!(!first.stderr.contains("contactbench: "), "{}", first.stderr);
    assert_eq!(at.read("code"), "0\n");
    let Ok(_) = std::fs::metadata("/dev/full") else { return };
    for name in ["heap.csv", "two.csv"] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let mut program = program(at.root(), &["detect", name]);
        let child = program.stdout(full).stderr(Stdio::piped()).spawn().unwrap();
        let ended = ended(child.wait_with_output().unwrap());
        assert_eq!(ended.code, Some(2), "{name}");
        assert!(ended.stderr.contains("standard output"), "{}", ended.stderr);
    }
}
