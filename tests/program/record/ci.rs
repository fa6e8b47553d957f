//! Tests the output for continuous integration.

use std::path::Path;
use std::process::Command;

use super::junit;
use crate::common::{PROGRAM, Place};

/// Runs the action as the example workflow does, on a baseline made by this program.
#[cfg(unix)]
#[test]
fn the_example_workflow_passes() {
    use std::os::unix::fs::PermissionsExt;
    let sources = Path::new(env!("CARGO_MANIFEST_DIR"));
    let at = Place::new();
    for name in ["ci", "bin"] {
        std::fs::create_dir(at.path(name)).unwrap();
    }
    let read = |name: &str| std::fs::read_to_string(sources.join(name)).unwrap();
    let experiment = read("docs/ci/contacts.toml");
    assert!(experiment.contains("blocks = 6") && experiment.contains("n = [100, 1000]"));
    let small = experiment.replace("blocks = 6", "blocks = 1").replace("n = [100, 1000]", "n = 99");
    at.file("ci/contacts.toml", small);
    let (workflow, action) = (read("docs/ci/github.yml"), read("action.yml"));
    let make = workflow.lines().find_map(|line| line.strip_prefix("#   contactbench ")).unwrap();
    at.good(make);
    // Returns an input of the action: the workflow's value, or the action's default.
    let input = |name: &str| {
        let said = workflow.lines().find_map(|line| line.trim().strip_prefix(name));
        let declared = action.split(&format!("\n  {name}:\n")).nth(1).unwrap();
        let default = declared.lines().find_map(|line| line.trim().strip_prefix("default: "));
        said.and_then(|said| said.strip_prefix(": "))
            .unwrap_or_else(|| default.unwrap().trim_matches('"'))
            .to_string()
    };
    // The program checks one scene only, because the whole check takes long.
    let script = format!(
        "#!/bin/sh\nif [ $1 = check ]; then set -- \"$@\" --scene packed:n=20; fi\nexec {PROGRAM} \
         \"$@\"\n"
    );
    let program = at.file("bin/contactbench", script);
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = std::env::var("PATH").unwrap();
    let act = || {
        let mut command = Command::new(sources.join(".ci/action"));
        command.current_dir(at.root());
        command.env("PATH", format!("{}:{path}", at.path("bin").display()));
        command.env("GITHUB_STEP_SUMMARY", at.path("summary.md"));
        for name in ["check", "detector", "runner", "experiment", "baseline", "out"] {
            let value = format!("{}: ${{{{ inputs.{name} }}}}", name.to_uppercase());
            assert!(action.contains(&value), "action.yml does not hand on {name}");
            let value = if name == "detector" { "nbs".into() } else { input(name) };
            command.env(name.to_uppercase(), value);
        }
        command.output().unwrap()
    };
    assert_eq!((input("check").as_str(), input("out").as_str()), ("yes", "results"));
    let ended = act();
    assert!(ended.status.success(), "{ended:?}");
    for file in ["check.xml", "run.xml", "compare.xml"] {
        assert_eq!(junit(&at.path("results").join(file)).1, 0, "{file}");
    }
    let summary = at.read("summary.md");
    let heads: Vec<&str> = summary.lines().filter(|line| line.starts_with("###")).collect();
    assert_eq!(heads.len(), 3, "{summary}");
    for (head, verb) in heads.iter().zip(["check", "run", "compare"]) {
        assert!(head.starts_with(&format!("### contactbench {verb}: ")), "{summary}");
        assert!(!head.contains("failed"), "{summary}");
    }
    // The gate fails if a count has changed.
    let text = at.read("ci/baseline/samples.jsonl");
    let text = text.replacen("\"digest\":\"0x", "\"digest\":\"0xf", 1);
    at.file("ci/baseline/samples.jsonl", text);
    at.remove("results");
    assert_eq!(act().status.code(), Some(1));
}
