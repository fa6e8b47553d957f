//! Scenes with more pairs than there is memory: every verb says so in one sentence.

use std::io::Write;
use std::path::Path;

use contactbench::record::row::{self, Outcome, Pass};
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::common::{PROGRAM, ended, file, run};

/// 100,000 particles in one place, 5·10^9 pairs.
fn heap(folder: &Path) {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(b"x,y,r\n").unwrap();
    encoder.write_all("1,2,0.5\n".repeat(100_000).as_bytes()).unwrap();
    file(folder, "heap.csv.gz", encoder.finish().unwrap());
}

const CROWD: [&str; 3] = [
    "each of the 100000 particles touches about 99999 others, which makes some 5.0e9 pairs",
    "are the radii in another unit than the coordinates",
    "raise the memory limit",
];

#[test]
fn a_crowd_is_refused_by_every_verb_before_it_is_tried() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    heap(folder);
    file(folder, "pairs.csv", "i,j\n0,1\n");
    for (arguments, code) in [
        (&["detect", "heap.csv.gz"][..], 2),
        (&["detect", "heap.csv.gz", "--detector", "direct", "--threads", "2"], 2),
        (&["verify", "heap.csv.gz", "--pairs", "pairs.csv"], 2),
        (&["recommend", "heap.csv.gz", "--seconds", "1"], 2),
        (&["draw", "heap.csv.gz"], 2),
        (&["draw", "heap.csv.gz", "--pairs", "pairs.csv"], 2),
        // A refusal is not wrong, and a check in which all refuse is not passed.
        (&["check", "--scene", "heap.csv.gz"], 2),
    ] {
        let ended = run(folder, arguments);
        let said = ended.stdout + &ended.stderr;
        assert_eq!(ended.code, Some(code), "{arguments:?}: {said}");
        assert!(CROWD.iter().all(|words| said.contains(words)), "{arguments:?}: {said}");
    }
    let inspected = run(folder, &["inspect", "heap.csv.gz"]);
    assert_eq!(inspected.code, Some(0), "{}", inspected.stderr);
    assert!(inspected.stdout.contains("about 99999 per particle, too many to look for"));
}

#[test]
fn a_crowd_has_rows_that_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    heap(folder);
    file(
        folder,
        "t.toml",
        "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 2\ndetectors = \
         [\"nbs\", \"direct\"]\narithmetics = [\"exact\", \"f32\"]\n[[scene]]\nname = \
         \"file\"\npath = \"heap.csv.gz\"\n[[scene]]\nname = \"packed\"\nn = 50\n",
    );
    let ended = run(folder, &["run", "t.toml", "--out", "result"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let rows = row::read(&folder.join("result/samples.jsonl")).unwrap().rows;
    let (heap, pack): (Vec<_>, Vec<_>) = rows
        .iter()
        .filter(|row| !row.id.detector.ends_with("-twin"))
        .partition(|row| row.id.scene == "file");
    assert_eq!(heap.len(), 2 * 2 * 3);
    for row in heap {
        assert_eq!(row.outcome, Outcome::Refused, "{row:?}");
        assert!(CROWD.iter().all(|words| row.reason.contains(words)), "{row:?}");
    }
    assert_eq!(pack.iter().filter(|row| row.outcome == Outcome::Ok).count(), 2 * 2 * 4);
    assert!(pack.iter().any(|row| row.pass == Pass::Time));
}

/// 300 of 2,000 discs in one place: too few for a sample to be sure of.
#[test]
fn a_list_ends_at_the_memory_limit_with_the_number_of_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let place = |k: u32| if k < 300 { (0, 0) } else { (3 * (k % 50), 3 * (k / 50)) };
    let discs: String = (0..2000).map(place).map(|(x, y)| format!("{x},{y},1\n")).collect();
    file(folder, "clump.csv", format!("x,y,r\n{discs}"));
    file(folder, "pairs.csv", "i,j\n0,1\n");
    let limited = |arguments: &[&str]| {
        let ended = run(folder, &[arguments, &["--memory-limit", "200000"]].concat());
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}{}", ended.stdout, ended.stderr);
        assert!(
            ended.stderr.contains("2000 particles have 44850 touching pairs, 45 each")
                && ended.stderr.contains("more than 200000 bytes; are the radii in another unit"),
            "{arguments:?}: {}",
            ended.stderr
        );
    };
    limited(&["detect", "clump.csv"]);
    limited(&["detect", "clump.csv", "--detector", "sorting"]);
    limited(&["verify", "clump.csv", "--pairs", "pairs.csv"]);
    limited(&["recommend", "clump.csv", "--seconds", "1"]);
    limited(&["draw", "clump.csv"]);
    let ended = run(folder, &["detect", "clump.csv", "--memory-limit", "400000"]);
    assert_eq!((ended.code, ended.stdout.lines().count()), (Some(0), 44_851), "{}", ended.stderr);
}

/// Arrays for two particles far apart are refused, not filled; and drawings of too many lines.
#[test]
fn the_default_limit_fits_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "far.csv", "x,y,z,r\n0,0,0,1\n900,900,900,1\n");
    file(folder, "farther.csv", "x,y,z,r\n0,0,0,1\n1e8,1e8,1e8,1\n");
    for (name, detector) in
        [("far.csv", "screening"), ("far.csv", "cell-grid"), ("farther.csv", "nbs")]
    {
        let ended = run(folder, &["detect", name, "--detector", detector]);
        let words = ["the limit is 268435456 bytes; raise the memory limit", "another detector"];
        assert_eq!(ended.code, Some(2), "{detector}: {}", ended.stderr);
        assert!(words.iter().all(|words| ended.stderr.contains(words)), "{}", ended.stderr);
    }
    let raised = ["detect", "far.csv", "--detector", "screening", "--memory-limit", "1GiB"];
    assert_eq!(run(folder, &raised).code, Some(0));
    file(folder, "many.csv", format!("x,y,r\n{}", "0,0,1\n".repeat(2100)));
    let ended = run(folder, &["draw", "many.csv"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("2203950 pairs are too many to be seen"), "{}", ended.stderr);
}

/// The disk is full, or the process is ended, in the middle of a file.
#[cfg(unix)]
#[test]
fn no_part_of_a_file_is_left_under_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "discs.csv", format!("x,y,r\n{}", "0,0,1\n".repeat(300)));
    file(folder, "before.csv", "i,j\n7,9\n");
    let limited = |trap: &str, output: &str| {
        // Files may have 64 blocks of 512 or 1024 bytes.
        let script = format!("{trap} ulimit -f 64; exec {PROGRAM} detect discs.csv -o {output}");
        let mut command = std::process::Command::new("sh");
        ended(command.args(["-c", &script]).current_dir(folder).output().unwrap())
    };
    let names = || -> Vec<String> {
        let names = std::fs::read_dir(folder).unwrap();
        names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    };
    for output in ["pairs.vtk", "pairs.csv", "pairs.npy", "before.csv"] {
        // Told that the file is too large.
        let failed = limited("trap '' XFSZ;", output);
        assert_eq!(failed.code, Some(2), "{output}: {}", failed.stderr);
        assert!(failed.stderr.contains(&format!("cannot write {output}")), "{}", failed.stderr);
        assert_eq!(names().len(), 2, "{:?}", names());
        // The signal that goes with it does not end the program.
        let failed = limited("", output);
        assert_eq!(failed.code, Some(2), "{output}: {}", failed.stderr);
        assert_eq!(names().len(), 2, "{:?}", names());
    }
    let before = |path: &Path| std::fs::read_to_string(path).unwrap();
    assert_eq!(before(&folder.join("before.csv")), "i,j\n7,9\n");
    // A link stays one, a file keeps its mode, a device is written to.
    use std::os::unix::fs::{PermissionsExt, symlink};
    symlink("before.csv", folder.join("link.csv")).unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode() & 0o777;
    let other = std::fs::Permissions::from_mode(0o640);
    std::fs::set_permissions(folder.join("before.csv"), other).unwrap();
    file(folder, "two.csv", "x,y,r\n0,0,1\n1,0,1\n");
    for output in ["link.csv", "new.csv"] {
        assert_eq!(run(folder, &["detect", "two.csv", "-o", output]).code, Some(0));
    }
    assert_eq!(before(&folder.join("before.csv")), "i,j\n0,1\n");
    assert!(std::fs::symlink_metadata(folder.join("link.csv")).unwrap().is_symlink());
    assert_eq!(mode(&folder.join("before.csv")), 0o640);
    assert_eq!(mode(&folder.join("new.csv")), mode(&folder.join("two.csv")));
    symlink("/dev/null", folder.join("null.csv")).unwrap();
    assert_eq!(run(folder, &["detect", "two.csv", "-o", "null.csv"]).code, Some(0));
}
