//! `new-detector`: the detector that it writes is compiled here and held to the truth, and its
//! lines come to the right places, all or none.

use std::collections::BTreeMap;
use std::path::Path;

use contactbench::check::contender::Contender;
use contactbench::check::{self, Limits};
use contactbench::contact::Arithmetic;
use contactbench::detect::any::Both;
use contactbench::detect::table::{Entry, Group, Judge, Role, Speed};
use contactbench::detect::{Declare, Detector, Options, Refusal, within};
use contactbench::{contact, sink};

use crate::common::run;

#[path = "../../src/cli/template.rs"]
mod written;
use written::NewDetector;

const TEMPLATE: &str = include_str!("../../src/cli/template.rs");
const FOLDER: &str = "crates/core/src/detect";

static ENTRY: Entry = Entry {
    name: "new-detector",
    role: Role::Detector,
    group: Group::Modern,
    summary: "",
    cost: "",
    memory: "16N",
    limits: "",
    threads: false,
    speed: Speed::Usual,
    judge: Judge::NOT,
    parameters: &[],
    constructor: Both::<NewDetector, NewDetector>::boxed,
};

#[test]
fn what_is_written_works() {
    let limits = Limits { seeds: 1, time: std::time::Duration::from_secs(60), ..Limits::default() };
    let report = check::battery(&[Contender::from(&ENTRY)], &Arithmetic::SAFE, &limits).unwrap();
    for failure in &report.failures {
        println!(
            "{} {:?} on {}:\n{}",
            failure.detector,
            failure.arithmetic,
            failure.found_on,
            check::as_csv(&failure.smallest.scene)
        );
    }
    assert!(
        report.failures.is_empty() && !report.cut && report.cases > 1500,
        "{} cases",
        report.cases
    );
    // It refuses what the arithmetic cannot hold, and nothing else.
    assert!(
        report.refused.keys().all(|reason| !reason.starts_with("new-detector")),
        "{:?}",
        report.refused
    );
    // A limit is kept to.
    let scene = contactbench::scene::spec::Spec::parse("packed:n=300").unwrap().make().unwrap();
    let visit = |memory_limit| {
        let mut count = sink::Count::default();
        let answer = ENTRY.make(Options { memory_limit, threads: 1 }).visit(
            &scene,
            contact::Test::Exact,
            &mut count,
        );
        (answer.is_ok(), count.0 > 0)
    };
    assert_eq!((visit(16 * 300), visit(16 * 300 - 1)), ((true, true), (false, false)));
}

/// A folder with the two files that are changed, as they are in this checkout.
fn checkout() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let detect = folder.path().join(FOLDER);
    std::fs::create_dir_all(detect.join("table")).unwrap();
    for name in ["mod.rs", "table/mod.rs"] {
        std::fs::copy(
            Path::new(env!("CARGO_MANIFEST_DIR")).join(FOLDER).join(name),
            detect.join(name),
        )
        .unwrap();
    }
    folder
}

/// Name to text of all files.
fn files(checkout: &Path) -> BTreeMap<String, String> {
    let folder = checkout.join(FOLDER);
    let entries = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap());
    let files = entries.filter(|entry| entry.path().is_file());
    let names = files.map(|entry| entry.file_name().into_string().unwrap());
    let names = names.chain(["table/mod.rs".to_string()]);
    names.map(|name| (name.clone(), std::fs::read_to_string(folder.join(name)).unwrap())).collect()
}

/// The lines of `after` without those of `before`, which must all be there, in order.
fn added<'a>(before: &str, after: &'a str) -> Vec<&'a str> {
    let mut old = before.lines().peekable();
    let new = after.lines().filter(|line| old.next_if_eq(line).is_none()).collect();
    assert_eq!(old.next(), None, "a line is gone");
    new
}

#[test]
fn the_lines_come_to_their_places() {
    for (given, name, module, kind) in [
        ("quick-tree", "quick-tree", "quick_tree", "QuickTree"),
        ("aaa_1", "aaa-1", "aaa_1", "Aaa1"),
        ("swift", "swift", "swift", "Swift"),
        ("zz", "zz", "zz", "Zz"),
        (
            "a-name-as-long-as-it-may-be-1234",
            "a-name-as-long-as-it-may-be-1234",
            "a_name_as_long_as_it_may_be_1234",
            "ANameAsLongAsItMayBe1234",
        ),
    ] {
        let folder = checkout();
        let before = files(folder.path());
        let ended = run(folder.path(), &["new-detector", given]);
        assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{given}: {}", ended.stdout);
        assert!(ended.stdout.contains(&format!("check --detector {name}")), "{}", ended.stdout);
        let after = files(folder.path());
        assert_eq!(after.len(), 3);
        // The file is the template that is compiled above, with other names.
        let file = &after[&format!("{module}.rs")];
        assert_eq!(*file, TEMPLATE.replace("new-detector", name).replace("NewDetector", kind));
        assert!(
            file.contains(&format!("pub struct {kind} {{"))
                && file.contains(&format!("within(&self.options, \"{name}\""))
        );
        // One module, in its place; what belongs to the next one stays with it.
        assert_eq!(added(&before["mod.rs"], &after["mod.rs"]), [format!("pub mod {module};")]);
        let modules: Vec<&str> =
            after["mod.rs"].lines().filter_map(|line| line.strip_prefix("pub mod ")).collect();
        assert!(modules.is_sorted(), "{modules:?}");
        // One entry, before the controls.
        let lines = added(&before["table/mod.rs"], &after["table/mod.rs"]).join("\n");
        assert!(
            lines.contains(&format!("name: \"{name}\",")) && lines.matches("Entry {").count() == 1,
            "{lines}"
        );
        assert!(lines.contains(&format!("super::{module}::{kind}")), "{lines}");
        let place = |name: &str| after["table/mod.rs"].find(&format!("name: \"{name}\"")).unwrap();
        assert!(place("kd-tree") < place(name) && place(name) < place("nothing"));
        // Once only.
        let again = run(folder.path(), &["new-detector", given]);
        assert!(
            again.code == Some(2) && again.stderr.contains("already; take another name"),
            "{}",
            again.stderr
        );
        assert_eq!(files(folder.path()), after);
    }
}

#[test]
fn bad_names_are_refused_and_change_nothing() {
    let folder = checkout();
    let before = files(folder.path());
    for (name, words) in [
        ("Grid", "small letter"),
        ("2d-grid", "small letter"),
        ("a--b", "single '-'"),
        ("-a", "unexpected argument"),
        ("a b", "small letter"),
        ("../a", "small letter"),
        ("größe", "small letter"),
        ("", "small letter"),
        ("loop", "a word of the language"),
        ("self", "a word of the language"),
        ("sink", "a type Sink"),
        ("vec", "a type Vec"),
        ("nbs", "there is a detector 'nbs' already"),
        ("nbs_twin", "there is a detector 'nbs-twin' already"),
        ("kiddo", "a library"),
        ("modern", "there is a module modern"),
        ("streamed", "there is a module streamed"),
        ("a-name-that-is-longer-than-it-may-be", "at most 32"),
    ] {
        let ended = run(folder.path(), &["new-detector", name]);
        assert!(
            ended.code == Some(2) && ended.stderr.contains(words),
            "{name}: {:?} {}",
            ended.code,
            ended.stderr
        );
        assert_eq!(files(folder.path()), before, "{name}");
    }
}

#[test]
fn in_an_unexpected_tree_nothing_is_changed_and_the_lines_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let ended = run(folder.path(), &["new-detector", "quick-tree"]);
    assert!(
        ended.code == Some(2)
            && ended
                .stderr
                .contains("no crates/core/src/detect/mod.rs; go there, or give it with --in"),
        "{}",
        ended.stderr
    );
    for (file, old, words) in [
        ("table/mod.rs", "pub static TABLE", "constructor: Both::<super::quick_tree::QuickTree"),
        ("mod.rs", "pub mod ", "pub mod quick_tree;"),
    ] {
        let folder = checkout();
        let path = folder.path().join(FOLDER).join(file);
        std::fs::write(
            &path,
            std::fs::read_to_string(&path).unwrap().replace(old, "pub(crate) thing "),
        )
        .unwrap();
        let before = files(folder.path());
        let ended = run(
            Path::new("/"),
            &["new-detector", "quick-tree", "--in", &folder.path().display().to_string()],
        );
        assert!(
            ended.code == Some(2) && ended.stderr.contains("nothing was changed"),
            "{file}: {}",
            ended.stderr
        );
        assert!(
            ended.stderr.contains(words) && ended.stderr.contains(&path.display().to_string()),
            "{file}: {}",
            ended.stderr
        );
        assert_eq!(files(folder.path()), before, "{file}");
    }
}
