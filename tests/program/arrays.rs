//! Files of named arrays as other programs write them (VTK 9.5, NumPy 2), and several files as one
//! trajectory, from the command line.

use std::path::Path;

use crate::common::{file, good, run};

fn data() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/arrays"))
}

/// The pairs that `detect` prints.
fn pairs(arguments: &[&str]) -> Vec<String> {
    let ended = good(data(), &[&["detect"], arguments].concat());
    ended.stdout.lines().skip(1).map(String::from).collect()
}

fn refused(arguments: &[&str], words: &[&str]) {
    let ended = run(data(), &[&["detect"], arguments].concat());
    assert_eq!(ended.code, Some(2), "{arguments:?}: {}{}", ended.stdout, ended.stderr);
    for word in words {
        assert!(ended.stderr.contains(word), "{arguments:?}: no '{word}' in {}", ended.stderr);
    }
}

#[test]
fn arrays_of_other_programs_are_read_or_refused_with_the_remedy() {
    let none: [&str; 0] = [];
    assert_eq!(pairs(&["boxed.npz"]), none);
    let said = good(data(), &["detect", "boxed.npz"]).stderr;
    assert!(said.contains("'box' is taken as") && said.contains("--periodic"), "{said}");
    assert_eq!(pairs(&["boxed.npz", "--periodic", "xyz"]).len(), 1);
    for name in ["scalar.npz", "structured.npy"] {
        assert_eq!(pairs(&[name]), none, "{name}");
        assert_eq!(pairs(&[name, "--box", "10,10,10"]).len(), 1, "{name}");
    }
    good(data(), &["detect", "frames.npz", "--frame", "all"]);
    for name in ["particle_radius.vtp", "cellradius.vtk", "both.vtp", "ascii-lz4-attribute.vtp"] {
        let of = ["--columns", "r=particle_radius"];
        let of = if name.starts_with("particle") { &of[..] } else { &[] };
        assert_eq!(pairs(&[&[name], of].concat()), ["0,2"], "{name}");
    }
    refused(&["particle_radius.vtp"], &["particle_radius", "--columns r=particle_radius"]);
    refused(&["glyph.vtp"], &["the corners of 48 polygons", "Glyph"]);
    for name in ["pieces.vtu", "parallel.pvtu", "series.pvd"] {
        assert_eq!(pairs(&[name]), ["0,1"], "{name}");
    }
}

#[test]
fn several_files_are_one_trajectory_in_all_verbs_of_frames() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (k, x) in [(9, "0.5"), (10, "1.5"), (100, "0.75")] {
        file(folder, &format!("run_{k}.csv"), format!("id,x,y,r\n1,0,0,0.5\n2,{x},0,0.5\n"));
    }
    let all = good(folder, &["detect", "run_*.csv", "--frame", "all"]);
    let rows: Vec<&str> = all.stdout.lines().skip(1).collect();
    assert_eq!(rows, ["0,1,2", "2,1,2"], "by id");
    assert!(all.stderr.contains("run_9.csv to run_100.csv"), "{}", all.stderr);
    let last = good(folder, &["detect", "run_*.csv"]);
    assert!(last.stdout.lines().count() == 2 && last.stderr.contains("frame 2"), "{}", last.stderr);
    good(folder, &["track", "run_*.csv", "--tracker", "every-step(nbs)"]);
    let about = good(folder, &["inspect", "run_*.csv", "--json"]).stdout;
    assert!(about.contains("\"frames\": 3"), "{about}");
    file(folder, "list.csv", "frame,i,j\n0,0,1\n2,0,1\n");
    good(folder, &["verify", "run_*.csv", "--pairs", "list.csv", "--frame", "all"]);
    let expanded = run(folder, &["track", "run_9.csv", "run_10.csv"]);
    assert!(expanded.code == Some(2) && expanded.stderr.contains("'run_*.vtp'"));
    let none = run(folder, &["detect", "walk_*.csv"]);
    assert_eq!(none.code, Some(2), "{}", none.stdout);
}
