//! What continuous integration is told.

use std::path::Path;

use serde_json::Value;

use super::junit;
use crate::common::{PROGRAM, good, run};

#[test]
fn check_and_list_speak_to_machines() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let ended = good(
        folder,
        &["check", "--detector", "nbs", "--seeds", "1", "--json", "--junit", "good.xml"],
    );
    let json: Value = serde_json::from_str(&ended.stdout).unwrap();
    assert_eq!((&json["passed"], &json["detectors"][0]), (&true.into(), &"nbs".into()));
    assert!(json["checks"][0]["detections"].as_u64().unwrap() > 100);
    assert_eq!(junit(&folder.join("good.xml")), (1, 0));
    let bad = [
        "check",
        "--detector",
        "nothing",
        "--detector",
        "direct",
        "--seeds",
        "1",
        "--junit",
        "bad.xml",
    ];
    let ended = run(folder, &[&bad[..], &["--annotations"]].concat());
    assert_eq!(ended.code, Some(1));
    assert!(
        ended.stdout.contains(
            "::error title=contactbench check%3A generated%3A nothing%2C exact arithmetic::on "
        ),
        "{}",
        ended.stdout
    );
    assert_eq!(junit(&folder.join("bad.xml")), (2, 1));
    let ended = run(folder, &[&bad[..], &["--json"]].concat());
    let json: Value = serde_json::from_str(&ended.stdout).unwrap();
    let failure = &json["checks"][0]["failures"][0];
    assert_eq!((ended.code, &failure["detector"]), (Some(1), &"nothing".into()));
    assert!(folder.join(failure["file"].as_str().unwrap()).exists());
    let list = |what: &[&str]| -> Value {
        serde_json::from_str(&good(folder, &[&["list", "--json"], what].concat()).stdout).unwrap()
    };
    let all = list(&[]);
    for (table, least) in
        [("detectors", 11), ("arithmetics", 5), ("scenes", 8), ("experiments", 10)]
    {
        assert!(
            all[table]
                .as_array()
                .is_some_and(|rows| rows.len() >= least && rows[0]["name"].is_string()),
            "{table}"
        );
    }
    assert_eq!(list(&["detectors"]).as_object().unwrap().len(), 1);
    assert!(list(&["hard-cases"])["hard_cases"].as_array().is_some_and(|cases| cases.len() > 20));
}

/// The action, as the example workflow calls it, on a baseline made by this very program.
#[test]
fn the_example_workflow_passes() {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR"));
    let ci = sources.join("docs/ci");
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("ci")).unwrap();
    std::fs::copy(ci.join("contacts.toml"), folder.join("ci/contacts.toml")).unwrap();
    let read = |path: &Path| std::fs::read_to_string(path).unwrap();
    let (workflow, action) = (read(&ci.join("github.yml")), read(&sources.join("action.yml")));
    let make = workflow.lines().find_map(|line| line.strip_prefix("#   contactbench ")).unwrap();
    good(folder, &make.split_whitespace().collect::<Vec<_>>());
    // What the workflow says, and else what the action takes.
    let input = |name: &str| {
        let said = workflow.lines().find_map(|line| line.trim().strip_prefix(name));
        let declared = action.split(&format!("\n  {name}:\n")).nth(1).unwrap();
        let default = declared.lines().find_map(|line| line.trim().strip_prefix("default: "));
        said.and_then(|said| said.strip_prefix(": "))
            .unwrap_or_else(|| default.unwrap().trim_matches('"'))
            .to_string()
    };
    let names = ["check", "detector", "runner", "experiment", "baseline", "out"];
    let mut path = std::ffi::OsString::from(Path::new(PROGRAM).parent().unwrap());
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap());
    let act = || {
        let mut command = std::process::Command::new(sources.join(".ci/action"));
        command.current_dir(folder).env("PATH", &path);
        command.env("GITHUB_STEP_SUMMARY", folder.join("summary.md"));
        for name in names {
            let value = format!("{}: ${{{{ inputs.{name} }}}}", name.to_uppercase());
            assert!(action.contains(&value), "action.yml does not hand on {name}");
            // One detector: all of them are checked elsewhere, and take a minute.
            let value = if name == "detector" { "nbs".into() } else { input(name) };
            command.env(name.to_uppercase(), value);
        }
        command.output().unwrap()
    };
    assert_eq!((input("check").as_str(), input("out").as_str()), ("yes", "results"));
    let ended = act();
    assert!(ended.status.success(), "{ended:?}");
    for file in ["check.xml", "run.xml", "compare.xml"] {
        assert_eq!(junit(&folder.join("results").join(file)).1, 0, "{file}");
    }
    let summary = read(&folder.join("summary.md"));
    let heads: Vec<&str> = summary.lines().filter(|line| line.starts_with("###")).collect();
    assert_eq!(heads.len(), 3, "{summary}");
    for (head, verb) in heads.iter().zip(["check", "run", "compare"]) {
        assert!(head.starts_with(&format!("### contactbench {verb}: ")), "{summary}");
        assert!(!head.contains("failed"), "{summary}");
    }
    // The gate closes.
    let record = folder.join("ci/baseline/samples.jsonl");
    let text = read(&record).replacen("\"digest\":\"0x", "\"digest\":\"0xf", 1);
    std::fs::write(&record, text).unwrap();
    std::fs::remove_dir_all(folder.join("results")).unwrap();
    assert_eq!(act().status.code(), Some(1));
}
