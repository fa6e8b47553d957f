//! Verbs that are programs of their own.

use std::process::Command;

use crate::common::PROGRAM;

/// Beside this program, on PATH, or nowhere.
#[cfg(unix)]
#[test]
fn a_satellite_is_found_beside_the_program_then_on_path_and_else_named() {
    use std::os::unix::fs::PermissionsExt;

    let [own, path] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let program = own.path().join("contactbench");
    std::fs::copy(PROGRAM, &program).unwrap();
    let ranks = || {
        let mut command = Command::new(&program);
        command.args(["ranks", "--help", "-x", "a b"]).env("PATH", path.path());
        let output = command.output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (output.status.code(), text(output.stdout), text(output.stderr))
    };
    let (code, _, stderr) = ranks();
    assert_eq!((code, stderr.lines().count()), (Some(2), 1), "{stderr}");
    assert!(stderr.contains("cargo build --release -p contactbench-ranks"), "{stderr}");
    for (folder, code) in [(&path, 7), (&own, 8)] {
        let file = folder.path().join("contactbench-ranks");
        std::fs::write(&file, format!("#!/bin/sh\necho \"$#: $3\"\nexit {code}\n")).unwrap();
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o755)).unwrap();
        assert_eq!(ranks(), (Some(code), "3: a b\n".into(), String::new()));
    }
}
