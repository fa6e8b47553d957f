//! What new users type: slips of the pen, numbers as people write them, scenes for files.

use std::path::Path;

use crate::common::{Ended, fake, file, run, runner, say};

const HEAD: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 0\n";
const SCENE: &str = "[[scene]]\nname = \"packed\"\nn = 20\n";

fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let Ended { code, stderr, .. } = run(folder, arguments);
    assert_eq!(code, Some(2), "{arguments:?}: {stderr}");
    for word in words {
        assert!(stderr.contains(word), "{arguments:?}: no '{word}' in: {stderr}");
    }
}

#[test]
fn misspelt_names_get_the_nearest_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "packing.csv", "x,y,r\n0,0,1\n");
    for (arguments, words) in [
        (&["detect", "packing.csv", "--detector", "nsb"][..], "did you mean nbs?"),
        (&["detect", "packing.csv", "--detector", "kidoo"], "did you mean kiddo?"),
        (
            &["detect", "packing.csv", "--detector", "streamed-nbs:levle=avx2"],
            "did you mean level?",
        ),
        (&["detect", "packing.csv", "--detector", "streamed-nbs:level=axv2"], "did you mean avx2?"),
        (&["detect", "pakcing.csv"], "did you mean packing.csv?"),
        (&["inspect", "pakcing.csv"], "did you mean packing.csv?"),
        (&["verify", "packng.csv", "--pairs", "p.csv"], "cannot read p.csv"),
        (&["check", "--detector", "@bok"], "did you mean @book?"),
        (&["run", "scalling"], "did you mean scaling?"),
        (&["run", "packed:n=100"], "is a scene, not an experiment"),
        (&["run", "packing.csv"], "contactbench recommend packing.csv"),
        (&["draw", "packd:n=20"], "did you mean packed:n=20?"),
        (&["recommend", "clusterd"], "did you mean clustered?"),
        (&["scene", "packed:spacin=1"], "did you mean spacing?"),
        (&["scene", "packed:sed=1"], "did you mean seed?"),
        (&["inspect", "packed:n=100"], "contactbench scene packed:n=100 -o scene.csv"),
        (&["scaling"], "contactbench run scaling"),
        (&["packing.csv"], "contactbench inspect packing.csv"),
        (&["loose:n=20"], "contactbench draw loose:n=20"),
    ] {
        refused(folder, arguments, &[words]);
    }
}

#[test]
fn numbers_may_have_exponents_and_bytes_units() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let detect = |arguments: &[&str]| {
        let ended = run(folder, &[&["detect"], arguments].concat());
        assert_eq!(ended.code, Some(0), "{arguments:?}: {}", ended.stderr);
        ended
    };
    let plain = detect(&["packed:n=100"]);
    let short = detect(&["packed:n=1e2", "--memory-limit", "4GiB", "--threads", "1e0"]);
    assert_eq!(plain.stdout, short.stdout);
    // One answer to which detector to take.
    assert!(plain.stderr.contains("streamed-nbs, exact arithmetic"), "{}", plain.stderr);
    refused(folder, &["detect", "packed", "--memory-limit", "4 gibs"], &["such as", "4GiB"]);
    refused(folder, &["detect", "packed", "--threads", "two"], &["whole number, such as 1000"]);
    refused(folder, &["detect", "packed:n=100", "--memory-limit", "1kB"], &["1000"]);
}

#[test]
fn what_no_row_will_have_is_said_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let claim = |rest: &str| {
        format!("[[claim]]\nname = \"c\"\nkind = \"at-most\"\nvalue = \"n\"\nto = 100\n{rest}")
    };
    let figure = |x: &str, y: &str| {
        format!(
            "[[figure]]\nname = \"f\"\ntitle = \"f\"\nx = \"{x}\"\nx-label = \"x\"\ny = \
             \"{y}\"\ny-label = \"y\"\n"
        )
    };
    for (rest, words) in [
        (claim("").replace("\"n\"", "\"list_pushs\""), "did you mean list_push?"),
        (claim("where = { detektor = \"nbs\" }"), "did you mean detector?"),
        (claim("where = { detector = \"nsb\" }"), "no row will have detector = nsb; did you mean"),
        (claim("where = { scene = \"pcked\" }"), "did you mean packed?"),
        (figure("spcing", "n"), "did you mean spacing?"),
        (figure("n", "lattice"), "there is no variable 'lattice'"),
    ] {
        let text = format!("{HEAD}detectors = [\"nbs\"]\n{SCENE}{rest}\n");
        file(folder, "t.toml", text);
        refused(folder, &["run", "t.toml", "--out", "never"], &["t.toml: line ", words]);
        assert!(!folder.join("never").exists());
    }
    let good = [
        claim("where = { detector = \"@book\", spacing = \">= 0\", missed = 0 }"),
        claim("where = { scene = [\"loose\", \"packed\"] }"),
        figure("size-ratio", "time_ns / n + size_ratio"),
    ];
    for rest in good {
        file(folder, "t.toml", format!("{HEAD}detectors = [\"nbs\"]\n{SCENE}{rest}\n"));
        let ended = run(folder, &["run", "t.toml", "--out", "done"]);
        assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
        std::fs::remove_dir_all(folder.join("done")).unwrap();
    }
}

#[test]
fn libraries_that_were_not_compiled_are_said() {
    if cfg!(feature = "peers") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.toml", format!("{HEAD}detectors = [\"@peers\", \"nbs\"]\n{SCENE}"));
    let ended = run(folder, &["run", "t.toml", "--out", "done"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let said = ended.stderr.lines().find(|line| line.starts_with("kiddo, kd-tree-crate, rstar"));
    assert!(said.is_some_and(|line| line.contains("--features peers")), "{}", ended.stderr);
    refused(folder, &["check", "--detector", "@peers"], &["--features peers"]);
}

#[test]
fn shells_complete_names() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish"] {
        let script = run(folder.path(), &["completions", shell]).stdout;
        for name in ["streamed-nbs", "hash-grid", "@book", "clustered", "speed-error"] {
            assert!(script.contains(name), "{shell}: {name}");
        }
    }
}

#[test]
fn who_is_wrong_comes_first_and_once() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let none = r#"{"reply":"count","counts":{},"contacts":0,"digest":"0x0000000000000000"}"#;
    let answers = [
        ("load", say(r#"{"reply":"loaded"}"#)),
        ("count", say(none)),
        ("memory", say(r#"{"reply":"unsupported"}"#)),
        ("pairs", say(r#"{"reply":"error","reason":"none"}"#)),
    ];
    let script = fake(&answers.each_ref().map(|(request, code)| (*request, code.as_str())));
    let claim = "[[claim]]\nname = \"c\"\nkind = \"at-most\"\nvalue = 1\nto = 2\nwhere = { \
                 detector = \"nbs\" }\n";
    let text = format!(
        "{HEAD}detectors = [\"nbs\"]\n{}{claim}{}",
        SCENE.replace("20", "[20, 30]"),
        runner("fake", "sh", &script)
    );
    file(folder, "t.toml", text);
    let run = |arguments: &[&str]| run(folder, arguments);
    let ended = run(&["run", "t.toml", "--out", "out", "--junit", "junit.xml", "--annotations"]);
    assert_eq!(ended.code, Some(1), "{}{}", ended.stdout, ended.stderr);
    assert!(
        ended.stdout.starts_with("WRONG: fake, in 2 of its 2 cells, worst in "),
        "{}",
        ended.stdout
    );
    let said = |text: &str| text.lines().filter(|line| line.starts_with("WRONG")).count();
    assert_eq!((said(&ended.stdout), said(&ended.stderr)), (1, 1), "{}", ended.stderr);
    assert!(ended.stdout.contains("1 claim: 1 holds, 0 fail, 0 could"), "{}", ended.stdout);
    assert_eq!(ended.stdout.matches("::error ").count(), 1, "{}", ended.stdout);
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let report = read("out/report.md");
    assert!(report.lines().nth(2).unwrap().starts_with("> Warning: WRONG: fake,"), "{report}");
    assert!(read("out/report.html").contains("WRONG: fake, in 2 of its 2 cells"));
    let junit = read("junit.xml");
    let first = junit.split("<testcase ").nth(1).unwrap();
    assert!(first.contains("fake is right") && first.contains("<failure"), "{junit}");
    // A folder without a record, and the one around a result folder.
    std::fs::create_dir(folder.join("empty")).unwrap();
    refused(folder, &["report", "empty"], &["empty has no samples.jsonl, the record from which"]);
    refused(folder, &["report", "."], &["such as ./out"]);
}
