//! Tests help, lists, completions and colours.

use std::process::{Command, Stdio};

use clap::{CommandFactory, Parser};
use contactbench::cli::Cli;
use contactbench::plan::builtin;
use contactbench_detectors::table::TABLE;

use crate::common::{PROGRAM, Place, ended, npy, program};

/// Returns the examples in a verb's help, without the name of the program.
fn examples(verb: &clap::Command) -> Vec<String> {
    let end = verb.get_after_help().unwrap().to_string();
    end.lines().filter_map(|line| line.strip_prefix("  contactbench ")).map(String::from).collect()
}

#[test]
fn each_verb_has_a_man_page() {
    let at = Place::new();
    at.good("completions --man man");
    let verbs = Cli::command().get_subcommands().count();
    assert_eq!(std::fs::read_dir(at.path("man")).unwrap().count(), 1 + verbs);
    let page = at.read("man/contactbench-site.1");
    assert!(page.contains(".SH SYNOPSIS") && page.contains("\\-\\-out"), "{page}");
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
        let name = verb.get_name();
        let page = include_str!("../cases/pages/help.txt");
        assert!(page.contains(&format!("$ {name} --help\n")) || name == "ranks", "{name}");
        assert!(!examples(verb).is_empty(), "{name}");
        for example in examples(verb) {
            let words = shlex::split(&format!("contactbench {example}")).unwrap();
            Cli::try_parse_from(words).unwrap_or_else(|error| panic!("{example}: {error}"));
            // Examples of these verbs are not run: they take seconds or need other programs.
            if !["check", "ranks", "recommend", "run", "track"].contains(&name) {
                at.good(&example);
            }
        }
    }
}

#[test]
fn list_names_every_detector_scene_and_experiment() {
    let at = Place::new();
    let listed = |what: &str| at.good(&format!("list {what}")).stdout;
    let [all, detectors, experiments, scenes] =
        ["", "detectors", "experiments", "scenes"].map(listed);
    let begins = |text: &str, word: &str| {
        text.lines().any(|line| line.trim_start_matches([' ', '*']).split(' ').next() == Some(word))
    };
    for entry in TABLE {
        assert!(begins(&all, entry.name) && begins(&detectors, entry.name), "{}", entry.name);
        let columns = [entry.cost, entry.memory, entry.limits].map(String::from);
        let values = entry.parameters.iter().map(|it| it.values.join(", "));
        for words in columns.into_iter().chain(values) {
            assert!(detectors.contains(&words), "{}: {words}", entry.name);
        }
    }
    for experiment in builtin::all().unwrap() {
        let name = &experiment.name;
        assert!(begins(&all, name) && begins(&experiments, name), "{name}");
        assert!(experiments.contains(&experiment.question));
    }
    for scene in
        ["packed", "loose", "clustered", "pack-a", "pack-b", "pack-c", "pack-d", "file", "hard"]
    {
        assert!(begins(&all, scene) && begins(&scenes, scene), "{scene}");
    }
    let hard_cases = listed("hard-cases");
    for case in contactbench::scene::hard::cases() {
        assert!(begins(&hard_cases, case.name), "{}", case.name);
    }
    assert!(hard_cases.lines().all(|line| line.chars().count() <= 100));
    assert!(!begins(&experiments, "nbs") && !begins(&detectors, "scaling"));
}

/// Pipes and files get no colours. A terminal, made by `script` of util-linux, gets colours unless
/// NO_COLOR is set.
#[test]
fn colours_are_for_terminals() {
    let at = Place::new();
    for line in ["--help", "dtect", "list detectors"] {
        let mut command = program(at.root(), &line.split(' ').collect::<Vec<_>>());
        command.env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
        let ended = ended(command.output().unwrap());
        assert!(!ended.stdout.contains('\x1b') && !ended.stderr.contains('\x1b'), "{line}");
    }
    let on_terminal = |no_color: &str| {
        let mut command = Command::new("script");
        command.args(["-qec", &format!("{no_color} {PROGRAM} --help"), "/dev/null"]);
        command.env("TERM", "xterm-256color").stdin(Stdio::null()).current_dir(at.root());
        command.env_remove("NO_COLOR").env_remove("CLICOLOR").env_remove("CI");
        command.output().ok().map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let (Some(plain), Some(styled)) = (on_terminal("NO_COLOR=1"), on_terminal("")) else { return };
    assert!(plain.contains("detect"), "script ran the program: {plain}");
    assert_eq!((plain.contains('\x1b'), styled.contains('\x1b')), (false, true), "{styled}");
}
