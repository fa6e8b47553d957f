//! Help, lists, completions and colours.

use std::process::{Command, Stdio};

use contactbench::detect::table::TABLE;
use contactbench::plan::builtin;

use crate::common::{PROGRAM, Place, ended, program};

#[test]
fn every_verb_explains_itself_with_an_example_that_parses() {
    let at = Place::new();
    let help = at.ends(0, "--help", &["Exit codes: 0 "]).stdout;
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    // The name of a verb stands after two blanks; lines that go on are indented further.
    let verbs = lines.take_while(|line| !line.is_empty()).filter(|line| !line.starts_with("   "));
    let verbs: Vec<&str> = verbs.filter_map(|line| line.split_whitespace().next()).collect();
    for verb in ["run", "report", "list", "check", "detect", "runner"] {
        assert!(verbs.contains(&verb), "{verbs:?}");
    }
    for verb in verbs.iter().filter(|verb| **verb != "help") {
        let help = at.run(&format!("{verb} --help"));
        // A verb that is a program of its own may not have been built.
        if help.stderr.contains("this verb is the program ") {
            continue;
        }
        assert_eq!(help.code, Some(0));
        let example = help.stdout.split_once("Example: ");
        let example = example.unwrap_or_else(|| panic!("{verb}: no example")).1;
        let (_, arguments) = example.lines().next().unwrap().split_once("contactbench ").unwrap();
        let words: Vec<&str> =
            std::iter::once("contactbench").chain(arguments.split_whitespace()).collect();
        assert_eq!(words[1], *verb);
        <contactbench::cli::Cli as clap::Parser>::try_parse_from(words)
            .unwrap_or_else(|e| panic!("{verb}: {e}"));
    }
    // Shells complete verbs, options and names.
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = at.good(&format!("completions {shell}")).stdout;
        let names = ["streamed-nbs", "hash-grid", "@book", "clustered", "speed-error"];
        let names = names.iter().filter(|_| ["bash", "zsh", "fish"].contains(&shell));
        for word in verbs.iter().chain(&["slice"]).chain(names) {
            assert!(script.contains(word), "{shell}: {word}");
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

/// Pipes and files get no colours; a terminal, which `script` of util-linux makes, gets them unless
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
        command.args(["-qec", &format!("{no_color} {PROGRAM} dtect"), "/dev/null"]);
        command.env("TERM", "xterm-256color").stdin(Stdio::null()).current_dir(at.root());
        command.env_remove("NO_COLOR").env_remove("CLICOLOR").env_remove("CI");
        command.output().ok().map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let (Some(plain), Some(styled)) = (on_terminal("NO_COLOR=1"), on_terminal("")) else { return };
    assert!(plain.contains("dtect"), "script ran the program: {plain}");
    assert_eq!((plain.contains('\x1b'), styled.contains('\x1b')), (false, true), "{styled}");
}
