//! `draw` and `trace`, completions, colours.

use crate::common::{file, program, run};

#[test]
fn the_verbs_write_what_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    file(at, "a<b>.csv", "x,y,r\n0,0,0.5\n1,0,0.5\n5,5,0.5\n");
    file(at, "pairs.csv", "i,j\n0,2\n");
    let ended = run(at, &["draw", "a<b>.csv", "--pairs", "pairs.csv"]);
    assert_eq!((ended.code, &*ended.stdout), (Some(0), ""), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("N = 3, 2D, 1 contact, 1 missed, 1 spurious, 0 repeated; scene.svg"),
        "{}",
        ended.stderr
    );
    assert!(std::fs::read_to_string(at.join("scene.svg")).unwrap().contains("a&lt;b&gt;.csv"));
    assert_eq!(
        run(at, &["draw", "packed:dim=3,n=100", "--slice", "y=1", "-o", "s.svg"]).code,
        Some(0)
    );
    assert!(std::fs::read(at.join("s.svg")).unwrap().starts_with(b"<svg"));
    let ended = run(at, &["trace", "nbs", "a<b>.csv", "-o", "t"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let files = std::fs::read_dir(at.join("t")).unwrap().count();
    let page = std::fs::read_to_string(at.join("t/nbs.html")).unwrap();
    assert!(
        page.contains("a&lt;b&gt;.csv") && page.contains(&format!("max=\"{}\"", files - 2)),
        "{files} files"
    );
    for (arguments, words) in [
        (&["draw", "packed:n=9", "--slice", "z=0"][..], "scene is of discs; leave out --slice"),
        (&["draw", "packed:n=9", "-o", "a.jpg"], "a.jpg: the ending of a picture must be .svg,"),
        (&["draw", "packed:dim=3,n=9", "--slice", "w=0"], "it must be x, y or z"),
        (&["draw", "none.csv"], "cannot read none.csv"),
        (&["draw"], "name a particle file, or a scene such as"),
        (
            &["draw", "packed:n=2", "--pairs", "pairs.csv"],
            "the pair 0,2: the scene has 2 particles",
        ),
        (
            &["draw", "packed:n=2", "-o", "nowhere/a.svg"],
            "cannot write nowhere/a.svg; choose another place",
        ),
        (
            &["draw", "packed:n=2", "--radius", "1"],
            "--columns, --format, --box, --periodic and --open belong to files",
        ),
        (&["trace", "nbs", "packed:n=100"], "100 particles; the steps of at most 60"),
        (&["trace", "nbs", "-o", "a<b>.csv/t"], "cannot write to a<b>.csv/t"),
        (&["trace", "kd-tree"], "nbs"),
    ] {
        let ended = run(at, arguments);
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{arguments:?}: {}", ended.stderr);
    }
}

const VERBS: [&str; 9] =
    ["run", "report", "list", "check", "detect", "draw", "trace", "completions", "runner"];

#[test]
fn shells_know_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let ended = run(folder.path(), &["completions", shell]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        for verb in VERBS {
            assert!(ended.stdout.contains(verb), "{shell}: {verb}");
        }
        assert!(ended.stdout.contains("slice"), "{shell}");
    }
}

/// Pipes and files get no colours, and with NO_COLOR nobody does.
#[test]
fn colours_are_for_terminals() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["--help"][..],
        &["detect", "--help"],
        &["dtect"],
        &["detect", "none.csv"],
        &["list", "detectors"],
    ] {
        for no_color in [None, Some("1")] {
            let mut command = program(folder.path(), arguments);
            command.env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
            if let Some(value) = no_color {
                command.env("NO_COLOR", value);
            }
            let output = command.output().unwrap();
            let escapes = |bytes: &[u8]| bytes.contains(&0x1b);
            assert!(!escapes(&output.stdout) && !escapes(&output.stderr), "{arguments:?}");
        }
    }
}

/// On a terminal, which `script` of util-linux makes, help has styles, and with NO_COLOR it has
/// none. Without `script` nothing is tested.
#[test]
fn no_color_is_honoured_on_terminals() {
    let folder = tempfile::tempdir().unwrap();
    let on_terminal = |no_color: Option<&str>| {
        let mut command = std::process::Command::new("script");
        command
            .args(["-qec", &format!("{} dtect", crate::common::PROGRAM), "/dev/null"])
            .env("TERM", "xterm-256color");
        command
            .env_remove("NO_COLOR")
            .env_remove("CLICOLOR")
            .env_remove("CI")
            .current_dir(folder.path())
            .stdin(std::process::Stdio::null());
        if let Some(value) = no_color {
            command.env("NO_COLOR", value);
        }
        command.output().ok().map(|output| output.stdout)
    };
    let (Some(plain), Some(styled)) = (on_terminal(Some("1")), on_terminal(None)) else { return };
    assert!(String::from_utf8_lossy(&plain).contains("dtect"), "script ran the program");
    assert!(!plain.contains(&0x1b), "{}", String::from_utf8_lossy(&plain));
    assert!(
        styled.contains(&0x1b),
        "this test must be able to see a style: {}",
        String::from_utf8_lossy(&styled)
    );
}
