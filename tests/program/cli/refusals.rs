//! Files, options and scenes that `detect` refuses.

use super::{DETECTORS, detected, refused};
use crate::common::{file, npy, run};

#[test]
fn bad_files_are_refused_with_place_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, text, words) in [
        (
            "nan.csv",
            "x,y,r\n0,0,1\n1,NaN,1\n",
            ["nan.csv:3", "column 'y'", "'NaN' is not a finite number; mend or remove the line"],
        ),
        (
            "inf.csv",
            "x,y,r\n0,0,1\n-inf,0,1\n",
            ["inf.csv:3", "column 'x'", "'-inf' is not a finite number; mend or remove"],
        ),
        (
            "huge.csv",
            "x,y,r\n0,0,1\n1e999,0,1\n",
            ["huge.csv:3", "column 'x'", "'1e999' is not a finite number; mend or remove"],
        ),
        (
            "negative.csv",
            "x,y,r\n0,0,1\n0,0,-2\n",
            ["negative.csv:3", "column 'r'", "'-2' is negative; mend or remove the line"],
        ),
        (
            "word.csv",
            "x,y,r\n0,0,1\n0,left,1\n",
            ["word.csv:3", "column 'y'", "'left' is not a number; mend or remove the line"],
        ),
        ("empty.csv", "", ["empty.csv", "is empty", "a header such as x,y,r"]),
        ("blank.csv", "\n\n", ["blank.csv", "is empty", "a header such as x,y,r"]),
        (
            "ragged.csv",
            "x,y,r\n0,0,1\n1,0\n",
            ["ragged.csv:3", "2 columns where 3 are expected", "mend or remove the line"],
        ),
        (
            "bare.csv",
            "x,y\n0,0\n",
            [
                "bare.csv",
                "holds no radii",
                "add a column named r, or give --radius R (half the diameter; in an experiment",
            ],
        ),
        ("fake.npy", "x,y,r\n0,0,1\n", ["fake.npy", "is not a NumPy file", "numpy.save"]),
        ("short.xyz", "3\n\nA 0 0 0\n", ["short.xyz", "3", ""]),
    ] {
        file(folder, name, text);
        refused(folder, &[name], &words);
    }
    file(folder, "nan.npy", npy(&[vec![0.0, 0.0, 0.0], vec![1.0, f64::NAN, 0.0]]));
    refused(
        folder,
        &["nan.npy", "--radius", "1"],
        &["nan.npy", "particle 1 (from 0)", "y is NaN", "mend or remove the row"],
    );
    file(folder, "negative.npy", npy(&[vec![0.0, 0.0, 0.0, 1.0], vec![1.0, 0.0, 0.0, -1.0]]));
    refused(
        folder,
        &["negative.npy"],
        &[
            "negative.npy",
            "particle 1 (from 0)",
            "the radius -1 is negative",
            "mend or remove the row",
        ],
    );
    refused(folder, &["missing.csv"], &["cannot read missing.csv", "No such file"]);
    refused(folder, &["."], &["cannot read ."]);
}

#[test]
fn bad_options_are_refused_with_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "a.csv", "x,y\n0,0\n1,0\n");
    file(folder, "r.csv", "x,y,r\n0,0,1\n");
    let names = DETECTORS.join(", ");
    refused(
        folder,
        &["a.csv", "--radius", "1", "--detector", "nsb"],
        &["there is no detector 'nsb'", &names],
    );
    refused(
        folder,
        &["a.csv", "--radius", "1", "-o", "pairs.txt"],
        &["pairs.txt", "must be .csv, .npy or .vtk"],
    );
    refused(
        folder,
        &["a.csv", "--radius", "1", "-o", "no/such/pairs.csv"],
        &["cannot write no/such/pairs.csv"],
    );
    refused(
        folder,
        &["a.csv", "--radius=-1"],
        &["the radius given is -1; it must be finite and not negative"],
    );
    refused(folder, &["a.csv", "--radius", "nan"], &["the radius given is NaN; it must be finite"]);
    refused(
        folder,
        &["a.csv", "--radius", "1", "--dim", "4"],
        &["the dimension given is 4; it must be 2 or 3"],
    );
    refused(folder, &["a.csv", "--radius", "1", "--threads", "0"], &["--threads 0"]);
    refused(
        folder,
        &["a.csv", "--radius", "1", "--detector", "nbs", "--threads", "2"],
        &["nbs is sequential", "leave out --threads, or use one of direct, streamed-nbs"],
    );
    // Too large for f32.
    refused(
        folder,
        &["a.csv", "--radius", "1e39", "--arithmetic", "f32"],
        &["a.csv: in f32", "radius"],
    );
    // clap's own messages have several lines.
    let unknown = run(folder, &["detect", "a.csv", "--raduis", "1"]);
    assert_eq!(unknown.code, Some(2));
    assert!(
        unknown.stderr.contains("--radius"),
        "the nearest option is proposed: {}",
        unknown.stderr
    );
}

#[test]
fn scenes_that_no_grid_can_hold_are_refused_with_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "far.csv", "x,y,r\n0,0,1\n1e12,0,1\n");
    for detector in ["binary-tree", "screening", "sorting", "nbs", "cell-grid", "hash-grid"] {
        refused(
            folder,
            &["far.csv", "--detector", detector],
            &[
                "5.000e11 cells",
                "along x (0e0 to 1e12)",
                "2^31",
                "remove far-away particles, or use kd-tree",
            ],
        );
    }
    for detector in ["direct", "hgrid", "sweep", "kd-tree", "bvh"] {
        assert_eq!(detected(folder, &["far.csv", "--detector", detector]).stdout, "i,j\n");
    }
    // 999,999 cells per axis (of a little more than a diameter, and two at the borders), and two
    // particles, 4 bytes each.
    file(folder, "loose.csv", "x,y,r\n0,0,0.5\n1e6,1e6,0.5\n");
    let words = [
        "screening needs 3999992000012 bytes",
        "999999 x 999999 cells",
        "the limit is 268435456",
        "raise the memory limit",
    ];
    refused(folder, &["loose.csv", "--detector", "screening"], &words);
    refused(
        folder,
        &["loose.csv", "--memory-limit", "1000"],
        &["nbs needs", "the limit is 1000", "raise the memory limit"],
    );
    assert_eq!(detected(folder, &["loose.csv"]).stdout, "i,j\n");
}
