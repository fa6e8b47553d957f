//! Pairs in every form of output.

use std::path::Path;
use std::process::{Command, Stdio};

use super::{DETECTORS, csv, detected, layer, refused};
use crate::common::{PROGRAM, ended, file, npy, pairs};

#[test]
fn a_detector_takes_the_parameters_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "a.csv", "x,y\n0,0\n1,0\n");
    let with = |detector: &'static str| ["a.csv", "--radius", "0.5", "--detector", detector];
    let allowed = "it is one of best, portable, avx2, avx512";
    refused(folder, &with("streamed-nbs:level=sse2"), &["level cannot be 'sse2'", allowed]);
    refused(folder, &with("sorting:level=portable"), &["no parameter 'level'", "sorting takes no"]);
    let ended = detected(folder, &with("streamed-nbs:level=portable,form=auto"));
    assert!(ended.stdout.contains("0,1"), "{}", ended.stdout);
    assert!(ended.stderr.contains(" streamed-nbs:level=portable, exact"), "{}", ended.stderr);
}

#[test]
fn no_one_and_two_particles_work() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (dim, header, rows) in
        [(2, "x,y,r\n", ["0,0,1\n", "2,0,1\n"]), (3, "x,y,z,r\n", ["0,0,0,1\n", "0,2,0,1\n"])]
    {
        for n in 0..=2 {
            file(folder, "few.csv", format!("{header}{}", rows[..n].concat()));
            for detector in DETECTORS {
                for arithmetic in ["f32", "f64", "exact"] {
                    let ended = detected(
                        folder,
                        &["few.csv", "--detector", detector, "--arithmetic", arithmetic],
                    );
                    // The two touch exactly.
                    assert_eq!(
                        ended.stdout,
                        if n == 2 { "i,j\n0,1\n" } else { "i,j\n" },
                        "{detector} {arithmetic}"
                    );
                    let pairs = if n == 2 { "1 pair" } else { "0 pairs" };
                    let summary = format!("few.csv: N = {n}, {dim}D, {pairs}, ");
                    // Doubts may stand before it: z is 0 for all, or nothing touches.
                    let last = ended.stderr.lines().last().unwrap_or_default();
                    assert!(last.starts_with(&summary), "{}", ended.stderr);
                    assert!(
                        ended.stderr.ends_with(&format!(", {detector}, {arithmetic} arithmetic\n")),
                        "{}",
                        ended.stderr
                    );
                }
            }
        }
    }
}

#[test]
fn every_form_of_output_holds_the_same_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let particles = layer();
    file(folder, "layer.csv", csv(&particles));
    let touch = |[ax, ay, ar]: [f64; 3], [bx, by, br]: [f64; 3]| {
        (ax - bx).powi(2) + (ay - by).powi(2) <= (ar + br).powi(2)
    };
    let all = (0..144u32).flat_map(|i| (i + 1..144).map(move |j| [i, j]));
    let truth: Vec<[u32; 2]> =
        all.filter(|[i, j]| touch(particles[*i as usize], particles[*j as usize])).collect();
    assert!(truth.len() > particles.len(), "a dense layer: {} pairs", truth.len());
    let text = truth.iter().fold("i,j\n".to_string(), |text, [i, j]| format!("{text}{i},{j}\n"));
    for detector in DETECTORS {
        // No two of these discs touch exactly, so that all arithmetics agree.
        assert_eq!(
            detected(folder, &["layer.csv", "--detector", detector]).stdout,
            text,
            "{detector}"
        );
        let written = detected(folder, &["layer.csv", "--detector", detector, "-o", "pairs.csv"]);
        assert_eq!(
            (&*written.stdout, std::fs::read_to_string(folder.join("pairs.csv")).unwrap()),
            ("", text.clone())
        );
        detected(folder, &["layer.csv", "--detector", detector, "--output", "pairs.npy"]);
        assert_eq!(pairs(&folder.join("pairs.npy")), truth);
    }
    for detector in ["direct", "cell-grid"] {
        let by = |threads| {
            detected(folder, &["layer.csv", "--detector", detector, "--threads", threads]).stdout
        };
        assert_eq!(by("1"), by("2"), "{detector}");
    }
    // The same particles as npy: three columns are x, y, radius where two dimensions are asked for.
    file(
        folder,
        "layer.npy",
        npy(&particles.iter().map(|particle| particle.to_vec()).collect::<Vec<_>>()),
    );
    assert_eq!(detected(folder, &["layer.npy", "--dim", "2"]).stdout, text);
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error_and_a_full_disc_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // 400 discs in one place: 79,800 pairs, more than any pipe holds.
    file(folder, "heap.csv", (0..400).fold("x,y,r\n".to_string(), |text, _| text + "0,0,1\n"));
    let script = format!("{{ {PROGRAM} detect heap.csv; echo $? > code; }} | head -1");
    let first = ended(
        Command::new("sh")
            .args(["-c", &script])
            .current_dir(folder)
            .stdin(Stdio::null())
            .output()
            .unwrap(),
    );
    assert_eq!(first.stdout, "i,j\n");
    assert!(!first.stderr.contains("contactbench: "), "{}", first.stderr);
    assert_eq!(std::fs::read_to_string(folder.join("code")).unwrap(), "0\n");
    if Path::new("/dev/full").exists() {
        for name in ["heap.csv", "two.csv"] {
            // Two pairs of lines wait in a buffer until the end.
            file(folder, "two.csv", "x,y,r\n0,0,1\n0,0,1\n");
            let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
            let output = crate::common::program(folder, &["detect", name])
                .stdout(full)
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            let ended = ended(output.wait_with_output().unwrap());
            assert_eq!(ended.code, Some(2), "{name}");
            assert!(
                ended.stderr.contains("cannot write the pairs to standard output: No space left"),
                "{}",
                ended.stderr
            );
        }
    }
}
