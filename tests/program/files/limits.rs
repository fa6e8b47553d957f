//! Scenes with more pairs than there is memory: every verb refuses them in one sentence.

use std::io::Write;

use contactbench::record::row::{Outcome, Pass};
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::common::{PROGRAM, Place};

/// 100,000 particles in one place, 5·10^9 pairs.
fn heap() -> Place {
    let at = Place::new();
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(b"x,y,r\n").unwrap();
    encoder.write_all("1,2,0.5\n".repeat(100_000).as_bytes()).unwrap();
    at.file("heap.csv.gz", encoder.finish().unwrap());
    at.file("pairs.csv", "i,j\n0,1\n");
    at
}

const CROWD: [&str; 3] = ["each of the 100000 particles", "99999 others", "5.0e9 pairs"];

#[test]
fn a_crowd_is_refused_by_every_verb_before_it_is_tried() {
    let at = heap();
    for verb in [
        "detect",
        "detect --detector direct --threads 2",
        "verify --pairs pairs.csv",
        "recommend --seconds 0.1",
        "draw --pairs pairs.csv",
        // A refusal is not wrong, and a check in which all refuse is not passed.
        "check --scene",
    ] {
        at.ends(2, &format!("{verb} heap.csv.gz"), &CROWD);
    }
    at.ends(0, "inspect heap.csv.gz", &["about 99999 per particle"]);
}

#[test]
fn a_crowd_has_rows_with_the_reason() {
    let at = heap();
    let text = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
                1\ndetectors = [\"nbs\", \"direct\"]\narithmetics = [\"exact\", \"f32\"]\n\
                [[scene]]\nname = \"file\"\npath = \"heap.csv.gz\"\n[[scene]]\nname = \
                \"packed\"\nn = 50\n";
    at.file("t.toml", text);
    at.good("run t.toml --out result");
    let rows = at.rows("result").into_iter().filter(|row| !row.id.detector.ends_with("-twin"));
    let (heap, pack): (Vec<_>, Vec<_>) = rows.partition(|row| row.id.scene == "file");
    assert_eq!(heap.len(), 2 * 2 * 3);
    for row in heap {
        assert_eq!(row.outcome, Outcome::Refused, "{row:?}");
        assert!(CROWD.iter().all(|words| row.reason.contains(words)), "{row:?}");
    }
    assert_eq!(pack.iter().filter(|row| row.outcome == Outcome::Ok).count(), 2 * 2 * 3);
    assert!(pack.iter().any(|row| row.pass == Pass::Time));
}

/// 300 of 2,000 discs in one place: too few for a sample to be sure of. Arrays for two particles
/// far apart are refused, not filled; and drawings of too many lines.
#[test]
fn a_list_ends_at_the_memory_limit_with_the_number_of_pairs() {
    let at = Place::new();
    let place = |k: u32| if k < 300 { (0, 0) } else { (3 * (k % 50), 3 * (k / 50)) };
    let discs: String = (0..2000).map(place).map(|(x, y)| format!("{x},{y},1\n")).collect();
    at.file("clump.csv", format!("x,y,r\n{discs}"));
    at.file("pairs.csv", "i,j\n0,1\n");
    for verb in [
        "detect",
        "detect --detector sorting",
        "verify --pairs pairs.csv",
        "recommend --seconds 0.1",
        "draw",
    ] {
        let words = ["2000 particles have 44850 touching pairs", "more than 200000 bytes"];
        at.ends(2, &format!("{verb} clump.csv --memory-limit 200000"), &words);
    }
    let ended = at.good("detect clump.csv --memory-limit 400000");
    assert_eq!(ended.stdout.lines().count(), 44_851);
    at.file("far.csv", "x,y,z,r\n0,0,0,1\n900,900,900,1\n");
    at.file("farther.csv", "x,y,z,r\n0,0,0,1\n1e8,1e8,1e8,1\n");
    for line in [
        "far.csv --detector screening",
        "far.csv --detector cell-grid",
        "farther.csv --detector nbs",
    ] {
        at.ends(2, &format!("detect {line}"), &["268435456 bytes"]);
    }
    at.good("detect far.csv --detector screening --memory-limit 1GiB");
    at.file("many.csv", format!("x,y,r\n{}", "0,0,1\n".repeat(2100)));
    at.ends(2, "draw many.csv", &["2203950 pairs"]);
}

/// The disk is full, or the process is ended, in the middle of a file.
#[cfg(unix)]
#[test]
fn no_part_of_a_file_is_left_under_its_name() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let at = Place::new();
    at.file("discs.csv", format!("x,y,r\n{}", "0,0,1\n".repeat(300)));
    at.file("before.csv", "i,j\n7,9\n");
    for output in ["pairs.vtk", "pairs.csv", "pairs.npy", "before.csv"] {
        // Told that the file is too large, or by a signal, which does not end the program.
        for trap in ["trap '' XFSZ;", ""] {
            // Files may have 64 blocks of 512 or 1024 bytes.
            let failed = at.shell(&format!(
                "{trap} ulimit -f 64; exec {PROGRAM} detect discs.csv -o {output}"
            ));
            assert_eq!(failed.code, Some(2), "{output}: {}", failed.stderr);
            assert!(failed.stderr.contains(&format!("cannot write {output}")), "{}", failed.stderr);
            assert_eq!(std::fs::read_dir(at.root()).unwrap().count(), 2, "{output}");
        }
    }
    assert_eq!(at.read("before.csv"), "i,j\n7,9\n");
    // A link stays one, a file keeps its mode, a device is written to.
    symlink("before.csv", at.path("link.csv")).unwrap();
    symlink("/dev/null", at.path("null.csv")).unwrap();
    let mode = |name: &str| std::fs::metadata(at.path(name)).unwrap().permissions().mode() & 0o777;
    let other = std::fs::Permissions::from_mode(0o640);
    std::fs::set_permissions(at.path("before.csv"), other).unwrap();
    at.file("two.csv", "x,y,r\n0,0,1\n1,0,1\n");
    for output in ["link.csv", "new.csv", "null.csv"] {
        at.good(&format!("detect two.csv -o {output}"));
    }
    assert_eq!(at.read("before.csv"), "i,j\n0,1\n");
    assert!(std::fs::symlink_metadata(at.path("link.csv")).unwrap().is_symlink());
    assert_eq!((mode("before.csv"), mode("new.csv")), (0o640, mode("two.csv")));
}
