//! What continuous integration is told.

use std::path::Path;

use serde_json::Value;

use super::junit;
use crate::common::{good, run};

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

/// The commands of the example workflow, on a baseline made by this very program.
#[test]
fn the_example_workflow_passes() {
    let ci = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/ci");
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("ci")).unwrap();
    std::fs::copy(ci.join("contacts.toml"), folder.join("ci/contacts.toml")).unwrap();
    let workflow = std::fs::read_to_string(ci.join("github.yml")).unwrap();
    let make = workflow.lines().find_map(|line| line.strip_prefix("#   contactbench ")).unwrap();
    good(folder, &make.split_whitespace().collect::<Vec<_>>());
    let commands: Vec<&str> = workflow
        .lines()
        .filter_map(|line| line.trim().strip_prefix("- run: contactbench "))
        .collect();
    assert_eq!(commands.len(), 3, "{commands:?}");
    for command in &commands {
        good(folder, &command.split_whitespace().collect::<Vec<_>>());
    }
    for file in ["check.xml", "run.xml", "compare.xml"] {
        assert_eq!(junit(&folder.join(file)).1, 0, "{file}");
    }
    // The gate closes.
    let record = folder.join("ci/baseline/samples.jsonl");
    let text = std::fs::read_to_string(&record).unwrap().replacen(
        "\"digest\":\"0x",
        "\"digest\":\"0xf",
        1,
    );
    std::fs::write(&record, text).unwrap();
    assert_eq!(run(folder, &commands[2].split_whitespace().collect::<Vec<_>>()).code, Some(1));
}
