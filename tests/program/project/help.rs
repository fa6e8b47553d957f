//! Tests help, examples, mistakes on the command line, lists and JSON.

use clap::{CommandFactory, Parser};
use contactbench::cli::Cli;

use crate::common::{Place, npy};

#[test]
fn each_verb_has_help_of_80_columns_and_a_man_page() {
    let at = Place::new();
    at.good("completions --man man");
    let command = Cli::command();
    // `ranks` passes its options on.
    let verbs = command.get_subcommands().map(|verb| verb.get_name());
    for verb in verbs.filter(|verb| *verb != "ranks").chain([""]) {
        let ended = at.run_wide(&format!("{verb} --help"), 80);
        assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""), "{verb}");
        let long = ended.stdout.lines().find(|line| line.chars().count() > 80);
        assert_eq!(long, None, "{verb}");
        let page = format!("man/contactbench-{verb}.1").replace("-.", ".");
        assert!(at.read(&page).contains(".SH SYNOPSIS"), "{verb}");
    }
}

#[test]
fn examples_of_the_help_run() {
    let at = Place::new();
    let experiment = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 2\n\
                      detectors = [\"nbs\", \"sorting\"]\n[[scene]]\nname = \"loose\"\nn = [50, 100]\n";
    at.file("my-experiment.toml", experiment);
    at.good("run my-experiment.toml --out laptop");
    at.shell("for name in server part-1 part-2; do cp -r laptop $name; done");
    at.shell("mkdir results; cp -r laptop results/before; cp -r laptop results/after");
    at.file("packing.csv", "x,y,r\n0,0,1\n1,0,1\n9,0,1\n");
    at.file("theirs.csv", "i,j\n1,2\n");
    at.file("centres.npy", npy(&[vec![0.0, 0.0], vec![1.0, 0.0]]));
    let dump =
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS id x y z radius\n1 2 3 4 1\n";
    at.file("packing.dump", dump);
    at.file("flow.dump", dump);
    let lists = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n0\nITEM: ENTRIES c_1[1] c_1[2]\n";
    at.file("lists.dump", lists);
    let core = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/detectors/src");
    at.shell(&format!("mkdir -p crates/detectors; cp -r {core} crates/detectors"));
    for verb in Cli::command().get_subcommands() {
        let (name, end) = (verb.get_name(), verb.get_after_help().unwrap().to_string());
        let examples = end.lines().filter_map(|line| line.strip_prefix("  contactbench "));
        assert!(examples.clone().next().is_some(), "{name} has no example");
        for example in examples {
            let words = shlex::split(&format!("contactbench {example}")).unwrap();
            Cli::try_parse_from(words).unwrap_or_else(|error| panic!("{example}: {error}"));
            // Examples of these verbs are not run: they take seconds or need other programs.
            if !["check", "ranks", "recommend", "run", "track"].contains(&name) {
                at.good(example);
            }
        }
    }
}

#[test]
fn a_mistake_is_answered_by_the_nearest_name() {
    let at = Place::new();
    at.file("a.csv", "x,y,r\n0,0,1\n");
    for (line, nearest) in [
        ("dtect a.csv", "detect'"),
        ("detect a.csv --detectr nbs", "--detector"),
        ("detect a.csv --detector nbz", "nbs"),
        ("detect a.csv --arithmetic f46", "f64"),
        ("detect a.cvs", "a.csv"),
        ("detect pcked:n=9", "packed:n=9"),
        ("detect packed:m=9", "n"),
        ("track a.csv --tracker verlt(nbs)", "verlet"),
        ("track a.csv --motion vortx", "vortex"),
        ("list detector", "detectors"),
        ("run scalng", "scaling"),
    ] {
        let said = at.ends(2, line, &[nearest]);
        assert_eq!(said.stdout, "", "{line}");
    }
}
