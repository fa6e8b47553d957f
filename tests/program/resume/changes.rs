//! What has changed since, and what is refused.

use contactbench::record::{provenance, row};

use super::{WHOLE, experiment, start, steady, undisturbed};
use crate::common::{fake, file, refused, run, runner, say};

#[test]
fn what_cannot_work_is_said_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = experiment();
    file(folder, "t.toml", &text);
    refused(
        folder,
        &["run", "t.toml", "--out", "/proc/self/task"],
        &["cannot make the result folder /proc/self/task", "--out"],
    );
    file(folder, "huge.toml", text.replace("blocks = 2", "blocks = 4000000000"));
    refused(
        folder,
        &["run", "huge.toml", "--out", "huge"],
        &["huge has ", " free, and the record and the report may need ", "make room, or choose"],
    );
    file(folder, "beyond.toml", text.replace("s = [2, 3000]", "s = [2, 1e308]"));
    refused(
        folder,
        &["run", "beyond.toml", "--out", "beyond"],
        &[
            "in experiment t, scene t: pack-c 2D N=100 diameter=1.0 s=1e+308: ",
            "leave the range of f64; take parameters nearer to 1",
        ],
    );
    assert!(!folder.join("beyond").exists(), "nothing was begun");
    let (head, runners) = text.split_once("[[scene]]").unwrap();
    let runners = runners.split_once("[[runner]]").unwrap().1;
    file(
        folder,
        "file.toml",
        format!("{head}[[scene]]\nname = \"file\"\npath = \"gone.csv\"\n[[runner]]{runners}"),
    );
    refused(
        folder,
        &["run", "file.toml", "--out", "file"],
        &["cannot read ", "gone.csv", "No such file"],
    );
    file(folder, "typo.toml", text.replace("blocks = 2", "blocks = two"));
    refused(folder, &["run", "typo.toml"], &["typo.toml: line 5, column 10: "]);
}

#[test]
fn a_resumed_run_notices_that_a_file_has_changed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
                2\ndetectors = [\"nbs\", \"sweep\"]\n[[scene]]\nname = \"file\"\npath = \
                \"discs.csv\"\n";
    file(folder, "t.toml", text);
    let discs = "x,y,r\n0,0,1\n1,0,1\n5,0,1\n";
    file(folder, "discs.csv", discs);
    assert_eq!(start(folder, &[]).code, Some(0));
    let path = folder.join("result/samples.jsonl");
    let whole = std::fs::read_to_string(&path).unwrap();
    let first: String = whole.split_inclusive('\n').take(3).collect();
    for rows in [&whole, &first] {
        for changed in [discs.replace("5,0,1", "5,0,2"), format!("{discs}9,0,1\n")] {
            std::fs::write(&path, rows).unwrap();
            file(folder, "discs.csv", changed);
            let ended = start(folder, &["--resume"]);
            assert_eq!(ended.code, Some(2), "{}", ended.stderr);
            let last = ended.stderr.lines().last().unwrap();
            assert!(
                last.contains("the scene is not the one in the record")
                    && last.contains("begin a new record with --out"),
                "{last}"
            );
            assert_eq!(&std::fs::read_to_string(&path).unwrap(), rows, "nothing was added");
        }
    }
    file(folder, "discs.csv", discs);
    assert_eq!(start(folder, &["--resume"]).code, Some(0));
    file(folder, "t.toml", text.replace("blocks = 2", "blocks = 3"));
    let ended = start(folder, &["--resume"]);
    assert_eq!(ended.code, Some(2));
    assert!(
        ended.stderr.contains("t differs from the experiment that this record was begun with"),
        "{}",
        ended.stderr
    );
}

#[test]
fn records_of_later_schemas_are_refused() {
    let (folder, ..) = undisturbed();
    let path = folder.path().join("result/samples.jsonl");
    let whole = std::fs::read_to_string(&path).unwrap();
    assert!(
        whole.lines().all(|line| line.starts_with("{\"schema\":4,\"")),
        "every line says its schema"
    );
    std::fs::write(&path, whole.replacen("{\"schema\":4,", "{\"schema\":5,", 2)).unwrap();
    for verb in [
        &["report", "result"][..],
        &["run", "t.toml", "--resume", "--out", "result"],
        &["compare", "result", "result"],
    ] {
        let ended = run(folder.path(), verb);
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
        assert!(
            ended
                .stderr
                .contains("samples.jsonl: line 1 has record schema 5, and this contactbench ("),
            "{}",
            ended.stderr
        );
        assert!(
            ended
                .stderr
                .contains("reads schemas 3 to 4: take the version that wrote it, or a later one"),
            "{}",
            ended.stderr
        );
    }
}

#[test]
fn a_resumed_run_remembers_which_detector_was_too_slow() {
    let loaded = say(r#"{"reply":"loaded"}"#);
    let hangs = fake(&[("load", &loaded), ("count", "exec sleep 60")]);
    let text = experiment()
        .split("[[scene]]")
        .next()
        .unwrap()
        .replace("memory-limit-mib = 1\n", "time-limit-s = 0.5\n");
    let folder = tempfile::tempdir().unwrap();
    file(
        folder.path(),
        "t.toml",
        format!(
            "{text}[[scene]]\nname = \"packed\"\nn = [10, 20]\n{}",
            runner("hangs", "sh", &hangs)
        ),
    );
    assert_eq!(start(folder.path(), &[]).code, Some(0));
    let expected = steady(folder.path());
    let path = folder.path().join("result/samples.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let first: Vec<&str> =
        text.split_inclusive('\n').filter(|line| line.contains("\"n\":10,")).collect();
    assert!(first.iter().any(|line| line.contains("timeout")) && first.len() < expected.len());
    std::fs::write(&path, first.concat()).unwrap();
    assert_eq!(start(folder.path(), &["--resume"]).code, Some(0));
    assert_eq!(steady(folder.path()), expected, "the reason says that it was not tried");
}

/// Two virtual machines of one name on two kinds of processors.
#[test]
fn a_run_resumed_on_other_hardware_of_the_same_name_is_of_another_machine() {
    let (folder, ..) = undisturbed();
    let result = folder.path().join("result");
    let text = std::fs::read_to_string(result.join("samples.jsonl")).unwrap();
    let half: String = text.split_inclusive('\n').take(text.lines().count() / 2).collect();
    let begun = std::fs::read_to_string(result.join("provenance.json")).unwrap();
    let mut fields: serde_json::Value = serde_json::from_str(&begun).unwrap();
    let here = fields["machine"].as_str().unwrap().to_string();
    assert!(fields["cpu_features"].is_array() || !cfg!(target_arch = "x86_64"), "{fields}");
    fields["caches"]["L3"] = "300M".into();
    std::fs::write(result.join("provenance.json"), provenance::text(&fields).unwrap()).unwrap();
    for resumed in 1..=2 {
        // The second time it is known already.
        let rows: String =
            text.split_inclusive('\n').take(half.lines().count() + resumed).collect();
        std::fs::write(result.join("samples.jsonl"), if resumed == 1 { &half } else { &rows })
            .unwrap();
        let ended = start(folder.path(), &["--resume"]);
        assert_eq!(ended.code, WHOLE, "{}", ended.stderr);
        let note = format!("the record was begun on {here}, this is {here}-2");
        assert!(ended.stderr.contains(&note), "{}", ended.stderr);
        let record = row::read(&result.join("samples.jsonl")).unwrap();
        let machines: Vec<_> =
            record.rows.iter().map(|row| row.id.machine.clone().unwrap()).collect();
        assert!(
            machines.contains(&here) && machines.contains(&format!("{here}-2")),
            "{machines:?}"
        );
        assert_eq!(machines.iter().collect::<std::collections::BTreeSet<_>>().len(), 2);
    }
}

#[test]
fn a_result_is_never_written_over() {
    let (folder, ..) = undisturbed();
    let files = || {
        let all = ["samples.jsonl", "provenance.json", "experiments/t.toml"]
            .map(|name| std::fs::read(folder.path().join("result").join(name)));
        all.map(Result::unwrap)
    };
    let before = files();
    file(folder.path(), "t.toml", experiment().replace("blocks = 2", "blocks = 1"));
    let ended = start(folder.path(), &[]);
    assert_eq!(ended.code, Some(2));
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    assert!(
        ended.stderr.contains("--resume") && ended.stderr.contains("--out"),
        "{}",
        ended.stderr
    );
    assert!(before == files());
    // Anything but a torn last line is not repaired.
    let path = folder.path().join("result/samples.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, format!("not a row\n{text}")).unwrap();
    let ended = start(folder.path(), &["--resume"]);
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains("samples.jsonl:1: it is not a row"), "{}", ended.stderr);
}
