//! Help and lists.

use contactbench::detect::table::TABLE;
use contactbench::plan::builtin;

use crate::common::run;

#[test]
fn every_verb_explains_itself_with_an_example_that_parses() {
    let folder = tempfile::tempdir().unwrap();
    let help = run(folder.path(), &["--help"]);
    assert_eq!(help.code, Some(0));
    assert!(help.stdout.contains("Exit codes: 0 "), "{}", help.stdout);
    let verbs: Vec<&str> = help
        .stdout
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty())
        .collect();
    // The name of a verb stands after two blanks; lines that go on are indented further.
    let verbs: Vec<&str> = verbs
        .iter()
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    for verb in ["run", "report", "list", "check", "detect", "runner"] {
        assert!(verbs.contains(&verb), "{verbs:?}");
    }
    for verb in verbs.into_iter().filter(|verb| *verb != "help") {
        let help = run(folder.path(), &[verb, "--help"]);
        // A verb that is a program of its own may not have been built.
        if help.stderr.contains("this verb is the program ") {
            continue;
        }
        assert_eq!(help.code, Some(0));
        let example =
            help.stdout.split_once("Example: ").unwrap_or_else(|| panic!("{verb}: no example")).1;
        let (_, arguments) = example.lines().next().unwrap().split_once("contactbench ").unwrap();
        let words: Vec<&str> =
            std::iter::once("contactbench").chain(arguments.split_whitespace()).collect();
        assert_eq!(words[1], verb);
        <contactbench::cli::Cli as clap::Parser>::try_parse_from(words)
            .unwrap_or_else(|e| panic!("{verb}: {e}"));
    }
}

#[test]
fn list_mentions_every_detector_scene_and_experiment() {
    let folder = tempfile::tempdir().unwrap();
    let listed = |what: &[&str]| run(folder.path(), &[&["list"], what].concat()).stdout;
    let (all, detectors, experiments) =
        (listed(&[]), listed(&["detectors"]), listed(&["experiments"]));
    let begins = |text: &str, word: &str| {
        text.lines().any(|line| line.trim_start_matches([' ', '*']).split(' ').next() == Some(word))
    };
    for entry in TABLE {
        assert!(begins(&all, entry.name) && begins(&detectors, entry.name), "{}", entry.name);
        for words in [entry.cost, entry.memory, entry.limits] {
            assert!(detectors.contains(words), "{words}");
        }
        for parameter in entry.parameters {
            assert!(begins(&detectors, parameter.name), "{}", parameter.name);
            assert!(detectors.contains(&parameter.values.join(", ")), "{}", parameter.name);
        }
    }
    for experiment in builtin::all().unwrap() {
        assert!(
            begins(&all, &experiment.name) && begins(&experiments, &experiment.name),
            "{}",
            experiment.name
        );
        assert!(experiments.contains(&experiment.question));
    }
    for scene in
        ["packed", "loose", "clustered", "pack-a", "pack-b", "pack-c", "pack-d", "file", "hard"]
    {
        assert!(begins(&all, scene) && begins(&listed(&["scenes"]), scene), "{scene}");
    }
    let hard_cases = listed(&["hard-cases"]);
    for case in contactbench::scene::hard::cases() {
        assert!(begins(&hard_cases, case.name), "{}", case.name);
    }
    assert!(hard_cases.lines().all(|line| line.chars().count() <= 100));
    assert!(!begins(&experiments, "nbs") && !begins(&detectors, "scaling"));
}
