//! The command line as users meet it: bad input ends with exit code 2 and one sentence that names
//! the place and the remedy; good input gives the same pairs in every form; every verb explains
//! itself.

use std::path::Path;
use std::process::{Command, Stdio};

use contactbench::contact::Test;
use contactbench::detect::Options;
use contactbench::detect::table::{self, Entry, TABLE};
use contactbench::experiment::builtin;
use contactbench::io;

use crate::common::{Ended, PROGRAM, ended, file, npy, pairs, run};

const DETECTORS: [&str; 11] = [
    "direct",
    "binary-tree",
    "screening",
    "sorting",
    "nbs",
    "streamed-nbs",
    "cell-grid",
    "hash-grid",
    "sweep",
    "kd-tree",
    "bvh",
];

/// `detect` with exit code 2, nothing on standard output, and one line on standard error with all
/// these words.
fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let ended = run(folder, &[&["detect"], arguments].concat());
    assert_eq!((ended.code, &*ended.stdout), (Some(2), ""), "{arguments:?}: {}", ended.stderr);
    assert_eq!(ended.stderr.lines().count(), 1, "{arguments:?}: {}", ended.stderr);
    assert!(ended.stderr.starts_with("contactbench: "), "{}", ended.stderr);
    for word in words {
        assert!(ended.stderr.contains(word), "{arguments:?}: no '{word}' in: {}", ended.stderr);
    }
}

fn detected(folder: &Path, arguments: &[&str]) -> Ended {
    let ended = run(folder, &[&["detect"], arguments].concat());
    assert_eq!(ended.code, Some(0), "{arguments:?}: {}", ended.stderr);
    ended
}

/// A hexagonal layer of 12 x 12 discs that overlap a little, in no simple order (7 and 144 have no
/// common factor), with a radius each.
fn layer() -> Vec<[f64; 3]> {
    let place = |k: u32| {
        let (row, column) = (k / 12, k % 12);
        [
            0.975 * (f64::from(column) + 0.5 * f64::from(row % 2)),
            0.85 * f64::from(row),
            0.5 - 0.01 * f64::from(k % 3),
        ]
    };
    (0..144).map(|k| place(k * 7 % 144)).collect()
}

fn csv(particles: &[[f64; 3]]) -> String {
    particles.iter().fold("x,y,r\n".into(), |text, [x, y, r]| format!("{text}{x:?},{y:?},{r:?}\n"))
}

#[test]
fn bad_files_are_refused_with_place_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, text, words) in [
        (
            "nan.csv",
            "x,y,r\n0,0,1\n1,NaN,1\n",
            ["nan.csv:3", "column 'y'", "'NaN' is not a finite number; mend or remove the line"],
        ),
        (
            "inf.csv",
            "x,y,r\n0,0,1\n-inf,0,1\n",
            ["inf.csv:3", "column 'x'", "'-inf' is not a finite number; mend or remove"],
        ),
        (
            "huge.csv",
            "x,y,r\n0,0,1\n1e999,0,1\n",
            ["huge.csv:3", "column 'x'", "'1e999' is not a finite number; mend or remove"],
        ),
        (
            "negative.csv",
            "x,y,r\n0,0,1\n0,0,-2\n",
            ["negative.csv:3", "column 'r'", "'-2' is negative; mend or remove the line"],
        ),
        (
            "word.csv",
            "x,y,r\n0,0,1\n0,left,1\n",
            ["word.csv:3", "column 'y'", "'left' is not a number; mend or remove the line"],
        ),
        ("empty.csv", "", ["empty.csv", "is empty", "a header such as x,y,r"]),
        ("blank.csv", "\n\n", ["blank.csv", "is empty", "a header such as x,y,r"]),
        (
            "ragged.csv",
            "x,y,r\n0,0,1\n1,0\n",
            ["ragged.csv:3", "2 columns where 3 are expected", "mend or remove the line"],
        ),
        (
            "bare.csv",
            "x,y\n0,0\n",
            [
                "bare.csv",
                "holds no radii",
                "give --radius R (half the diameter), or add a column named r",
            ],
        ),
        ("fake.npy", "x,y,r\n0,0,1\n", ["fake.npy", "is not a NumPy file", "numpy.save"]),
        ("short.xyz", "3\n\nA 0 0 0\n", ["short.xyz", "3", ""]),
    ] {
        file(folder, name, text);
        refused(folder, &[name], &words);
    }
    file(folder, "nan.npy", npy(&[vec![0.0, 0.0, 0.0], vec![1.0, f64::NAN, 0.0]]));
    refused(
        folder,
        &["nan.npy", "--radius", "1"],
        &["nan.npy", "particle 1 (from 0)", "y is NaN", "mend or remove the row"],
    );
    file(folder, "negative.npy", npy(&[vec![0.0, 0.0, 0.0, 1.0], vec![1.0, 0.0, 0.0, -1.0]]));
    refused(
        folder,
        &["negative.npy"],
        &[
            "negative.npy",
            "particle 1 (from 0)",
            "the radius -1 is negative",
            "mend or remove the row",
        ],
    );
    refused(folder, &["missing.csv"], &["cannot read missing.csv", "No such file"]);
    refused(folder, &["."], &["cannot read ."]);
}

#[test]
fn a_detector_takes_the_parameters_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "a.csv", "x,y\n0,0\n1,0\n");
    let with = |detector: &'static str| ["a.csv", "--radius", "0.5", "--detector", detector];
    let allowed = "it is one of best, portable, avx2, avx512";
    refused(folder, &with("streamed-nbs:level=sse2"), &["level cannot be 'sse2'", allowed]);
    refused(folder, &with("nbs:level=portable"), &["no parameter 'level'", "nbs takes no"]);
    let ended = detected(folder, &with("streamed-nbs:level=portable,form=auto"));
    assert!(ended.stdout.contains("0,1"), "{}", ended.stdout);
    assert!(ended.stderr.contains(" streamed-nbs:level=portable, exact"), "{}", ended.stderr);
}

#[test]
fn bad_options_are_refused_with_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "a.csv", "x,y\n0,0\n1,0\n");
    file(folder, "r.csv", "x,y,r\n0,0,1\n");
    let names = DETECTORS.join(", ");
    refused(
        folder,
        &["a.csv", "--radius", "1", "--detector", "nsb"],
        &["there is no detector 'nsb'", &names],
    );
    refused(
        folder,
        &["a.csv", "--radius", "1", "-o", "pairs.txt"],
        &["pairs.txt", "must be .csv, .npy or .vtk"],
    );
    refused(
        folder,
        &["a.csv", "--radius", "1", "-o", "no/such/pairs.csv"],
        &["cannot write no/such/pairs.csv"],
    );
    refused(
        folder,
        &["a.csv", "--radius=-1"],
        &["the radius given is -1; it must be finite and not negative"],
    );
    refused(folder, &["a.csv", "--radius", "nan"], &["the radius given is NaN; it must be finite"]);
    refused(
        folder,
        &["r.csv", "--radius", "1"],
        &["r.csv holds radii, but the radius 1 was given too; leave one out"],
    );
    refused(
        folder,
        &["a.csv", "--radius", "1", "--dim", "4"],
        &["the dimension given is 4; it must be 2 or 3"],
    );
    refused(folder, &["a.csv", "--radius", "1", "--threads", "0"], &["--threads 0"]);
    refused(
        folder,
        &["a.csv", "--radius", "1", "--detector", "nbs", "--threads", "2"],
        &["nbs is sequential", "leave out --threads, or use streamed-nbs"],
    );
    // Too large for f32.
    refused(
        folder,
        &["a.csv", "--radius", "1e39", "--arithmetic", "f32"],
        &["a.csv in f32", "radius"],
    );
    // clap's own messages have several lines.
    let unknown = run(folder, &["detect", "a.csv", "--raduis", "1"]);
    assert_eq!(unknown.code, Some(2));
    assert!(
        unknown.stderr.contains("--radius"),
        "the nearest option is proposed: {}",
        unknown.stderr
    );
}

#[test]
fn scenes_that_no_grid_can_hold_are_refused_with_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "far.csv", "x,y,r\n0,0,1\n1e12,0,1\n");
    for detector in ["binary-tree", "screening", "sorting", "nbs", "cell-grid", "hash-grid"] {
        refused(
            folder,
            &["far.csv", "--detector", detector],
            &[
                "5.000e11 cells",
                "along x (0e0 to 1e12)",
                "2^31",
                "remove far-away particles, or use kd-tree",
            ],
        );
    }
    for detector in ["direct", "sweep", "kd-tree", "bvh"] {
        assert_eq!(detected(folder, &["far.csv", "--detector", detector]).stdout, "i,j\n");
    }
    // 999,999 cells per axis (of a little more than a diameter, and two at the borders), and two
    // particles, 4 bytes each.
    file(folder, "loose.csv", "x,y,r\n0,0,0.5\n1e6,1e6,0.5\n");
    let words = [
        "screening needs 3999992000012 bytes",
        "999999 x 999999 cells",
        "the limit is 268435456",
        "raise the memory limit",
    ];
    refused(folder, &["loose.csv", "--detector", "screening"], &words);
    refused(
        folder,
        &["loose.csv", "--memory-limit", "1000"],
        &["nbs needs", "the limit is 1000", "raise the memory limit"],
    );
    assert_eq!(detected(folder, &["loose.csv"]).stdout, "i,j\n");
}

#[test]
fn no_one_and_two_particles_work() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (dim, header, rows) in
        [(2, "x,y,r\n", ["0,0,1\n", "2,0,1\n"]), (3, "x,y,z,r\n", ["0,0,0,1\n", "0,2,0,1\n"])]
    {
        for n in 0..=2 {
            file(folder, "few.csv", format!("{header}{}", rows[..n].concat()));
            for detector in DETECTORS {
                for arithmetic in ["f32", "f64", "exact"] {
                    let ended = detected(
                        folder,
                        &["few.csv", "--detector", detector, "--arithmetic", arithmetic],
                    );
                    // The two touch exactly.
                    assert_eq!(
                        ended.stdout,
                        if n == 2 { "i,j\n0,1\n" } else { "i,j\n" },
                        "{detector} {arithmetic}"
                    );
                    let summary = format!("few.csv: N = {n}, {dim}D, {} pairs, ", n / 2);
                    assert!(
                        ended.stderr.starts_with(&summary) && ended.stderr.lines().count() == 1,
                        "{}",
                        ended.stderr
                    );
                    assert!(
                        ended.stderr.ends_with(&format!(", {detector}, {arithmetic} arithmetic\n")),
                        "{}",
                        ended.stderr
                    );
                }
            }
        }
    }
}

#[test]
fn every_form_of_output_holds_the_same_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let particles = layer();
    file(folder, "layer.csv", csv(&particles));
    let touch = |[ax, ay, ar]: [f64; 3], [bx, by, br]: [f64; 3]| {
        (ax - bx).powi(2) + (ay - by).powi(2) <= (ar + br).powi(2)
    };
    let all = (0..144u32).flat_map(|i| (i + 1..144).map(move |j| [i, j]));
    let truth: Vec<[u32; 2]> =
        all.filter(|[i, j]| touch(particles[*i as usize], particles[*j as usize])).collect();
    assert!(truth.len() > particles.len(), "a dense layer: {} pairs", truth.len());
    let text = truth.iter().fold("i,j\n".to_string(), |text, [i, j]| format!("{text}{i},{j}\n"));
    for detector in DETECTORS {
        // No two of these discs touch exactly, so that all arithmetics agree.
        assert_eq!(
            detected(folder, &["layer.csv", "--detector", detector]).stdout,
            text,
            "{detector}"
        );
        let written = detected(folder, &["layer.csv", "--detector", detector, "-o", "pairs.csv"]);
        assert_eq!(
            (&*written.stdout, std::fs::read_to_string(folder.join("pairs.csv")).unwrap()),
            ("", text.clone())
        );
        detected(folder, &["layer.csv", "--detector", detector, "--output", "pairs.npy"]);
        assert_eq!(pairs(&folder.join("pairs.npy")), truth);
    }
    for detector in ["direct", "cell-grid"] {
        let by = |threads| {
            detected(folder, &["layer.csv", "--detector", detector, "--threads", threads]).stdout
        };
        assert_eq!(by("1"), by("2"), "{detector}");
    }
    // The same particles as npy: three columns are x, y, radius where two dimensions are asked for.
    file(
        folder,
        "layer.npy",
        npy(&particles.iter().map(|particle| particle.to_vec()).collect::<Vec<_>>()),
    );
    assert_eq!(detected(folder, &["layer.npy", "--dim", "2"]).stdout, text);
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error_and_a_full_disc_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // 400 discs in one place: 79,800 pairs, more than any pipe holds.
    file(folder, "heap.csv", (0..400).fold("x,y,r\n".to_string(), |text, _| text + "0,0,1\n"));
    let script = format!("{{ {PROGRAM} detect heap.csv; echo $? > code; }} | head -1");
    let first = ended(
        Command::new("sh")
            .args(["-c", &script])
            .current_dir(folder)
            .stdin(Stdio::null())
            .output()
            .unwrap(),
    );
    assert_eq!((&*first.stdout, &*first.stderr), ("i,j\n", ""));
    assert_eq!(std::fs::read_to_string(folder.join("code")).unwrap(), "0\n");
    if Path::new("/dev/full").exists() {
        for name in ["heap.csv", "two.csv"] {
            // Two pairs of lines wait in a buffer until the end.
            file(folder, "two.csv", "x,y,r\n0,0,1\n0,0,1\n");
            let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
            let output = crate::common::program(folder, &["detect", name])
                .stdout(full)
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            let ended = ended(output.wait_with_output().unwrap());
            assert_eq!(ended.code, Some(2), "{name}");
            assert!(
                ended.stderr.contains("cannot write the pairs to standard output: No space left"),
                "{}",
                ended.stderr
            );
        }
    }
}

#[test]
fn check_passes_detectors_and_fails_the_control_that_finds_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let right = run(folder, &["check", "--detector", "nbs", "--seeds", "1"]);
    assert_eq!((right.code, &*right.stderr), (Some(0), ""));
    assert!(
        right.stdout.contains(" detections by nbs: all agree with all pairs tested"),
        "{}",
        right.stdout
    );
    // What cells cannot number is refused, and said; no generated scene is such.
    assert!(
        right.stdout.contains("scenes: generated 168, hard cases ")
            && right.stdout.contains(" times: nbs: "),
        "{}",
        right.stdout
    );
    let wrong = run(folder, &["check", "--detector", "nothing", "--seeds", "1"]);
    assert_eq!(wrong.code, Some(1));
    assert!(
        wrong.stdout.contains("2 particles, 1 missed, 0 spurious, 0 duplicate pairs"),
        "{}",
        wrong.stdout
    );
    // What it tells the user to type shows the difference.
    let commands: Vec<Vec<&str>> = wrong
        .stdout
        .lines()
        .filter_map(|line| line.split_once("contactbench "))
        .map(|(_, c)| c.split(' ').collect())
        .collect();
    let found: Vec<String> = commands.iter().map(|command| run(folder, command).stdout).collect();
    assert_eq!(found[1..], ["i,j\n", "i,j\n0,1\n"], "{commands:?}");
    assert!(
        found[0].contains("1 missed, 0 spurious, 0 duplicate pairs; missed 0,1"),
        "{}",
        found[0]
    );
    assert_eq!(run(folder, &["check", "--detector", "nsb"]).code, Some(2));
}

#[test]
fn check_takes_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "two.csv", "# a comment\nx,y,r\n0,0,1\n2,0,1\n9,0,1\n");
    file(folder, "far.csv", "x,y,z,r\n0,0,0,1\n1e40,0,0,1\n");
    let right = run(
        folder,
        &[
            "check",
            "--scene",
            "two.csv",
            "--scene",
            "far.csv",
            "--arithmetic",
            "exact",
            "--arithmetic",
            "f32",
        ],
    );
    assert_eq!((right.code, &*right.stderr), (Some(0), ""), "{}", right.stdout);
    // All detectors on a scene in two arithmetics; on the other those that need no array over
    // cells, in exact: the others refuse, and f32 cannot hold it.
    let all = TABLE.iter().filter(|entry| entry.must_be_right()).count();
    let scene = io::scene(&folder.join("far.csv"), io::Options::default()).unwrap();
    let takes = |entry: &&Entry| {
        entry.make(Options::default()).list(&scene, Test::Exact, &mut Vec::new()).is_ok()
    };
    let far = TABLE.iter().filter(|entry| entry.must_be_right()).filter(takes).count();
    for name in ["direct", "sweep", "kd-tree", "bvh", "streamed-nbs"] {
        assert!(takes(&table::find(name).unwrap()), "{name}");
    }
    assert!(
        right.stdout.contains(&format!("check: {} detections by ", 2 * all + far)),
        "{}",
        right.stdout
    );
    assert!(
        right.stdout.contains("refused 1 times: f32: ")
            && right.stdout.contains("refused 1 times: nbs: "),
        "{}",
        right.stdout
    );
    let wrong = run(
        folder,
        &["check", "--scene", "two.csv", "--detector", "nothing", "--out", "new/folder"],
    );
    assert_eq!(wrong.code, Some(1), "{}", wrong.stderr);
    assert!(
        wrong.stdout.contains("on two.csv: 1 missed, 0 spurious, 0 duplicate pairs; missed 0,1\n"),
        "{}",
        wrong.stdout
    );
    assert!(folder.join("new/folder/failing-nothing-exact-two.csv").exists());
    // The folder that nobody named stays as it is.
    let before = std::fs::read_dir(folder).unwrap().count();
    let wrong = run(folder, &["check", "--scene", "two.csv", "--detector", "nothing"]);
    let place = wrong.stdout.lines().find_map(|line| line.split_once("smallest failing scene: "));
    let place = place.and_then(|(_, rest)| rest.rsplit_once(": ")).map(|(_, place)| place).unwrap();
    assert!(Path::new(place).exists() && place.contains("contactbench-check-"), "{place}");
    // The temporary folder of tests is this folder: one more folder is all there is.
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), before + 1);
    assert_eq!(run(folder, &["check", "--scene", "none.csv"]).code, Some(2));
}

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
