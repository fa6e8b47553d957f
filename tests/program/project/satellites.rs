//! Tests verbs that are separate programs.
#![cfg(unix)]

use std::os::unix::fs::PermissionsExt;
use std::process::Command;

use crate::common::{PROGRAM, Place, ended};

#[test]
fn a_satellite_is_found_beside_the_program_then_on_path_and_else_named() {
    let [own, path] = [(); 2].map(|()| Place::new());
    let program = own.path("contactbench");
    std::fs::copy(PROGRAM, &program).unwrap();
    let ranks = || {
        let mut command = Command::new(&program);
        command.args(["ranks", "--help", "-x", "a b"]).env("PATH", path.root());
        let ended = ended(command.output().unwrap());
        (ended.code, ended.stdout, ended.stderr)
    };
    let (code, _, stderr) = ranks();
    assert_eq!((code, stderr.lines().count()), (Some(2), 1), "{stderr}");
    assert!(stderr.contains("cargo build --release -p contactbench-ranks"), "{stderr}");
    for (folder, code) in [(&path, 7), (&own, 8)] {
        let script = format!("#!/bin/sh\necho \"$#: $3\"\nexit {code}\n");
        let file = folder.file("contactbench-ranks", script);
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o755)).unwrap();
        assert_eq!(ranks(), (Some(code), "3: a b\n".into(), String::new()));
    }
}
