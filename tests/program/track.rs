//! `track`: scenes in motion, and lists that are kept.

use serde_json::Value;

use crate::common::{PROGRAM, file, good, refused, run};

fn json(arguments: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let all: Vec<&str> = [&["track"], arguments, &["--json"]].concat();
    serde_json::from_str(&good(folder.path(), &all).stdout).unwrap()
}

fn number(value: &Value, key: &str) -> u64 {
    value[key].as_u64().unwrap_or_else(|| panic!("{key}: {value}"))
}

const UNSAFE: [&str; 6] = [
    "--tracker",
    "verlet(nbs,skin=0.05,rule=every-20)",
    "--tracker",
    "verlet(nbs,skin=0.05,rule=lammps-10-1-yes)",
    "--tracker",
    "verlet(nbs,skin=0.05,rule=half-skin)",
];

/// What lists miss is counted, and rules that promise nothing are allowed to miss.
#[test]
fn what_rules_miss_is_counted_frame_by_frame() {
    let flight = ["loose:dim=2,n=400,fraction=0.5", "--motion", "drift:speed=0.02"];
    let found = json(&[&flight[..], &["--frames", "61"], &UNSAFE].concat());
    assert_eq!([number(&found, "particles"), number(&found, "frames")], [400, 61]);
    let trackers = found["trackers"].as_array().unwrap();
    let [every, lammps, half_skin] = &trackers[..] else { panic!("{trackers:?}") };
    assert_eq!(number(every, "built"), 4, "frames 0, 20, 40 and 60");
    assert!(number(every, "missed") > 50 && number(lammps, "missed") > 0, "{trackers:?}");
    assert!(number(every, "latest") >= 3 && number(every, "worst_missed") > 3, "{every}");
    assert_eq!(number(half_skin, "missed"), 0);
    assert!(half_skin["first_missed_frame"].is_null());
    let contacts = number(&found, "contacts");
    for tracker in trackers {
        let seen = number(tracker, "reported") + number(tracker, "missed");
        assert_eq!((seen, number(tracker, "spurious")), (contacts, 0), "{tracker}");
        assert!(number(tracker, "formula_bytes") > 400 * 36, "{tracker}");
    }
    // Some flags are raised for nothing; none is rightly raised for more builds than have misses.
    let [flags, right, missing] =
        ["dangerous", "dangerous_rightly", "missing_builds"].map(|key| number(lammps, key));
    assert!(right <= flags && right <= missing && missing > 0, "{lammps}");
    assert!(found["mean_way"].as_f64().unwrap() < found["longest_way"].as_f64().unwrap());
}

/// Two discs that pass each other within a frame; and particles at rest, of which nothing is lost.
#[test]
fn contacts_between_frames_are_counted_and_rest_has_none() {
    let scene = "loose:dim=2,n=500,fraction=0.3";
    let fast = json(&[scene, "--motion", "drift:speed=1.5", "--frames", "9"]);
    assert!(number(&fast, "tunnelled") > 100, "{fast}");
    let slow = json(&[scene, "--motion", "drift:speed=0.001", "--frames", "9"]);
    assert!(number(&slow, "tunnelled") * 50 < number(&fast, "tunnelled"), "{slow}");
    let rest = json(&[scene, "--motion", "rest", "--frames", "30"]);
    assert_eq!(number(&rest, "at_rest"), 29 * 500);
    assert_eq!(rest["longest_way"].as_f64(), Some(0.0));
    assert_eq!(["born", "ended", "tunnelled"].map(|key| number(&rest, key)), [0; 3]);
    for tracker in rest["trackers"].as_array().unwrap() {
        let (name, built) = (tracker["tracker"].as_str().unwrap(), number(tracker, "built"));
        let expected = match name {
            _ if name.starts_with("every-step") => 30,
            _ if name.contains("every-10") => 3,
            _ => 1,
        };
        assert_eq!((built, number(tracker, "missed")), (expected, 0), "{name}");
    }
}

#[test]
fn files_and_all_arithmetics_can_be_tracked_and_the_table_fits_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    file(folder.path(), "discs.csv", "x,y,r\n0,0,0.5\n1,0,0.5\n2.5,0,0.5\n2.5,0.75,0.25\n");
    for arithmetic in ["exact", "f64", "f32", "f32-cell", "textbook"] {
        let said = good(
            folder.path(),
            &["track", "discs.csv", "--motion", "vortex", "--arithmetic", arithmetic],
        );
        assert!(
            said.stdout.contains("discs.csv, 4 particles, vortex:speed=0.01,seed=1, 100 frames")
        );
        assert!(said.stdout.contains("All over streamed-nbs"), "{}", said.stdout);
        let rows = said.stdout.lines().filter(|line| line.contains("  "));
        assert_eq!(rows.clone().count(), 8, "{}", said.stdout);
        assert!(rows.clone().all(|line| line.chars().count() <= 80), "{}", said.stdout);
        assert!(said.stdout.contains("every step "), "{}", said.stdout);
    }
    for what in ["motions", "trackers"] {
        let listed = good(folder.path(), &["list", what]).stdout;
        assert!(listed.contains(if what == "motions" { "brownian" } else { "rule=top-two" }));
    }
}

#[test]
fn what_cannot_be_tracked_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "loose:dim=2,n=50";
    for (arguments, words) in [
        (&["track"][..], &["name a particle file, or a scene"][..]),
        (&["track", scene, "--frames", "0"], &["--frames 0"]),
        (&["track", scene, "--tracker", "verlet(nbz)"], &["there is no detector 'nbz'"]),
        (&["track", scene, "--tracker", "verlet(nbs,rule=x)"], &["rule cannot be 'x'", "top-two"]),
    ] {
        refused(folder.path(), arguments, words);
    }
    let unknown = run(folder.path(), &["track", scene, "--motion", "dirft"]);
    assert_eq!(unknown.code, Some(2));
    assert!(unknown.stderr.contains("did you mean drift?"), "{}", unknown.stderr);
    // What a tracker refuses is its own answer.
    let wide = "loose:dim=2,n=50,diameter=10";
    let huge = ["track", wide, "--tracker", "verlet(nbs,skin=1e308)", "--tracker", "nbs"];
    let said = good(folder.path(), &huge).stdout;
    assert!(said.contains("ended at frame 0: with a skin of"), "{said}");
}

/// What `track` says of a tracker, an experiment has in its record: two paths through the program.
#[test]
fn experiments_say_of_a_course_what_track_says() {
    let folder = tempfile::tempdir().unwrap();
    let experiment = r#"
name = "steps"
title = "Steps"
question = "?"
reading = "!"
blocks = 2
detectors = [
    "nbs",
    "verlet(nbs,skin=0.05,rule=every-20)",
    "verlet(nbs,skin=0.05,rule=lammps-10-1-yes)",
    "verlet(nbs,skin=0.05,rule=half-skin)",
]

[[scene]]
name = "loose"
n = 400
fraction = 0.5
motion = "drift"
speed = 0.02
frames = 61

[[claim]]
name = "half of the skin is safe"
kind = "equal"
where = { rule = "half-skin" }
value = "wrong + never + wrong_frames"
to = "0"

[[claim]]
name = "a list is built at most as often as a detector is asked without one"
kind = "at-most"
value = "builds"
to = "frames"

[[figure]]
name = "skins"
title = "Skins"
kind = "speed-error"
"#;
    file(folder.path(), "steps.toml", experiment);
    let run = good(folder.path(), &["run", "steps.toml", "--out", "out"]);
    assert!(run.stdout.contains("2 claims: 2 hold"), "{}", run.stdout);
    let rows = std::fs::read_to_string(folder.path().join("out/samples.jsonl")).unwrap();
    let rows: Vec<Value> = rows.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let flight = ["loose:dim=2,n=400,fraction=0.5", "--motion", "drift:speed=0.02"];
    let found = json(&[&flight[..], &["--frames", "61"], &UNSAFE].concat());
    let [every, lammps, half_skin] = &found["trackers"].as_array().unwrap()[..] else { panic!() };
    let mut judged = 0;
    for row in &rows {
        let (course, rule) = (&row["course"], &row["detector_params"]["rule"]);
        for key in ["particles", "frames", "contacts", "born", "ended", "tunnelled"] {
            assert_eq!(row["moved"][key], found[key], "{key}: {row}");
        }
        let expected = match (row["detector"].as_str().unwrap(), rule.as_str()) {
            ("verlet", Some("every-20")) => every,
            ("verlet", Some("lammps-10-1-yes")) => lammps,
            ("verlet" | "verlet-twin", Some("half-skin")) => half_skin,
            _ => {
                assert_eq!([&course["builds"], &row["contacts"]], [61, number(&found, "contacts")]);
                continue;
            }
        };
        judged += 1;
        for (key, of_track) in [
            ("builds", "built"),
            ("dangerous", "dangerous"),
            ("dangerous_rightly", "dangerous_rightly"),
            ("missing_builds", "missing_builds"),
            ("listed", "listed"),
            ("never", "never_reported"),
            ("latest", "latest"),
            ("worst_missed", "worst_missed"),
            ("first_wrong", "first_missed_frame"),
        ] {
            assert_eq!(course[key], expected[of_track], "{key}: {row}");
        }
        assert_eq!(row["errors"]["missed"], expected["missed"], "{row}");
        assert_eq!(row["contacts"], expected["reported"], "{row}");
        let missed = number(expected, "missed") > 0;
        assert_eq!(row["outcome"], if missed { "lossy" } else { "ok" }, "{row}");
        match row["pass"].as_str().unwrap() {
            "memory" => assert_eq!(row["formula_bytes"], expected["formula_bytes"], "{row}"),
            "count" => assert!(number(&row["counts"], "contact_test") >= number(course, "listed")),
            _ => assert!(number(row, "building_ns") < number(row, "time_ns"), "{row}"),
        }
    }
    assert!(judged >= 3 * 4, "{judged} rows of trackers");
}

/// Trackers beside detectors, scenes in motion beside scenes at rest, and builds that take turns.
#[test]
fn motion_and_rest_are_in_one_record() {
    let folder = tempfile::tempdir().unwrap();
    let experiment = r#"
name = "mixed"
title = "Mixed"
question = "?"
reading = "!"
blocks = 2
detectors = ["nbs", "nothing", "verlet(nbs,rule=every-3,skin=0)", "every-step(streamed-nbs)"]
arithmetics = ["exact", "textbook"]

[[scene]]
name = "packed"
n = 60

[[scene]]
name = "packed"
n = 60
motion = ["drift", "rest"]
frames = 5
"#;
    file(folder.path(), "mixed.toml", experiment);
    for (out, more) in [("out", &[][..]), ("beside", &["--against", PROGRAM])] {
        let all = [&["run", "mixed.toml", "--out", out], more].concat();
        let said = good(folder.path(), &all);
        assert!(!said.stderr.contains("WRONG"), "{}", said.stderr);
        let report = good(folder.path(), &["report", out]);
        assert!(report.stderr.is_empty(), "{}", report.stderr);
        let rows = std::fs::read_to_string(folder.path().join(out).join("samples.jsonl")).unwrap();
        for row in rows.lines().map(|line| serde_json::from_str::<Value>(line).unwrap()) {
            let outcome = row["outcome"].as_str().unwrap();
            assert!(["ok", "lossy", "control"].contains(&outcome), "{row}");
            let moves = row["params"].get("motion").is_some();
            assert_eq!(moves, !row["moved"].is_null(), "{row}");
            let shown = ["ok", "lossy"].contains(&outcome);
            assert_eq!(moves && shown, !row["course"].is_null(), "{row}");
        }
    }
    // What was measured is not measured again.
    let rows = || std::fs::read_to_string(folder.path().join("out/samples.jsonl")).unwrap();
    let before = rows();
    good(folder.path(), &["run", "mixed.toml", "--out", "out", "--resume"]);
    assert_eq!(before, rows());
}

/// What cannot move, or not so, is said before anything is measured.
#[test]
fn courses_that_make_no_sense_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let head = "name = \"a\"\ntitle = \"a\"\nquestion = \"a\"\nreading = \"a\"\nblocks = 0\n";
    for (detector, scene, words) in [
        (
            "nbs",
            "name = \"packed\"\nn = 9\nmotion = \"drfit\"",
            "there is no motion 'drfit'; did you mean drift?",
        ),
        ("nbs", "name = \"packed\"\nn = 9\nmotion = \"drift\"\nspeed = -1", "speed cannot be '-1'"),
        (
            "nbs",
            "name = \"packed\"\nn = 9\nmotion = \"drift\"\nframes = 0",
            "frames = 0: it must be a whole number from 2",
        ),
        ("nbs", "name = \"packed\"\nn = 9\nspeed = 1", "speed"),
        (
            "nbs",
            "name = \"packed\"\nn = 9\nmotion = \"vortex\"\nperiodic = true",
            "vortex needs open boundaries, and the scene repeats",
        ),
        ("nbs", "name = \"packed\"\nn = 9\nmotion = \"drum\"", "make the motion 'drum'"),
        ("nbs", "name = \"hard\"\nmotion = \"drift\"", "hard cases stay where they are"),
        ("verlet(nbs,skin=x)", "name = \"packed\"\nn = 9", "skin cannot be 'x'"),
        ("verlet(nsb)", "name = \"packed\"\nn = 9", "; did you mean nbs?; the detectors are"),
        ("verlt(nbs)", "name = \"packed\"\nn = 9", "'verlt(nbs)' is no tracker"),
    ] {
        let text = format!("{head}detectors = [\"{detector}\"]\n[[scene]]\n{scene}\n");
        file(folder.path(), "a.toml", text);
        refused(folder.path(), &["run", "a.toml", "--out", "out"], &[words]);
    }
}

/// One frame of a motion in a file, or all of them: the same numbers.
#[test]
fn frames_of_a_motion_are_written_one_or_all() {
    let folder = tempfile::tempdir().unwrap();
    let motion = ["scene", "packed:n=60", "--motion", "brownian:speed=0.05"];
    let write = |more: &[&str]| good(folder.path(), &[&motion[..], more].concat());
    write(&["--frames", "3", "-o", "all.xyz"]);
    write(&["--at", "2", "-o", "two.csv"]);
    write(&["--at", "0", "-o", "first.csv"]);
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("all.xyz"), write(&["--frames", "3"]).stdout.into_bytes());
    good(folder.path(), &["scene", "packed:n=60", "-o", "scene.csv"]);
    assert_eq!(bytes("first.csv"), bytes("scene.csv"), "frame 0 is the scene");
    for (frame, name) in [("0", "first.csv"), ("2", "two.csv")] {
        good(folder.path(), &["scene", "all.xyz", "--frame", frame, "-o", "again.csv"]);
        assert_eq!(bytes("again.csv"), bytes(name), "frame {frame}");
    }
    assert!(bytes("first.csv") != bytes("two.csv"));
    for (more, words) in [
        (&[][..], &["--at K", "--frames COUNT"][..]),
        (&["--frames", "2", "-o", "all.csv"], &["one .xyz file", "--at K"]),
        (&["--frames", "0"], &["at least one"]),
    ] {
        refused(folder.path(), &[&motion[..], more].concat(), words);
    }
    let gone = ["scene", "packed:n=9", "--motion", "collapse", "--at", "1"];
    refused(folder.path(), &gone, &["does not make the motion 'collapse'", "take one of rest"]);
}
