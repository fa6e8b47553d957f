//! Tests writes that fail before the file is complete.

use crate::common::{PROGRAM, Place};

#[cfg(unix)]
#[test]
fn no_part_of_a_file_is_left_under_its_name() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let at = Place::new();
    at.file("discs.csv", format!("x,y,r\n{}", "0,0,1\n".repeat(300)));
    at.file("before.csv", "i,j\n7,9\n");
    for output in ["pairs.vtk", "pairs.csv", "pairs.npy", "before.csv"] {
        // The system reports a file over the limit by an error, or else by a signal.
        for trap in ["trap '' XFSZ;", ""] {
            // The limit is 64 blocks of 512 or 1024 bytes.
            let failed = at.shell(&format!(
                "{trap} ulimit -f 64; exec {PROGRAM} detect discs.csv -o {output}"
            ));
            assert_eq!(failed.code, Some(2), "{output}: {}", failed.stderr);
            assert!(failed.stderr.contains(&format!("cannot write {output}")), "{}", failed.stderr);
            assert_eq!(std::fs::read_dir(at.root()).unwrap().count(), 2, "{output}");
        }
    }
    assert_eq!(at.read("before.csv"), "i,j\n7,9\n");
    // Output keeps a link and the mode of an existing file, and can go to a device.
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

/// `RAYON_NUM_THREADS` is bounded as `--threads` is, and long messages are cut in the middle.
#[cfg(unix)]
#[test]
fn threads_and_messages_are_bounded() {
    let at = Place::new();
    let list = |threads: u64| {
        at.shell(&format!("RAYON_NUM_THREADS={threads} exec {PROGRAM} list arithmetics"))
    };
    assert_eq!(list(1024).code, Some(0));
    let refused = list(1025);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("RAYON_NUM_THREADS must be at most 1024"));
    at.file("t.toml", format!("blocks = \"{}\"\n", "(".repeat(100_000)));
    let long = at.ends(2, "run t.toml --out never", &["t.toml", "((( ... ((("]);
    assert!(long.stderr.len() < 5000, "{} bytes", long.stderr.len());
}
