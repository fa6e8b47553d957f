//! Scenes in motion in boxes that repeat: `track`, `scene`, `inspect` and `run`.

use std::path::Path;

use serde_json::Value;

use crate::common::{fake, file, good, refused, runner, say};

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let all: Vec<&str> = [arguments, &["--json"]].concat();
    serde_json::from_str(&good(folder, &all).stdout).unwrap()
}

/// What a motion is like; all but times and the name.
fn moved(of: &Value) -> Vec<Value> {
    let keys =
        ["particles", "frames", "contacts", "born", "ended", "tunnelled", "longest_way", "at_rest"];
    keys.map(|key| of[key].clone()).to_vec()
}

const SHEARED: &str = "loose:dim=2,n=50,fraction=0.5,periodic=true,tilt=0.2";
const SHEAR: [&str; 4] = ["--motion", "shear:speed=0.25", "--frames", "30"];

/// A box in each frame: as they are made, and as they are read from a file.
#[test]
fn frames_in_boxes_are_followed_as_they_are_made_and_from_files() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    good(folder, &[&["scene", SHEARED][..], &SHEAR, &["-o", "all.xyz"]].concat());
    let text = std::fs::read_to_string(folder.join("all.xyz")).unwrap();
    let boxes: Vec<&str> = text.lines().filter(|line| line.contains("Lattice=")).collect();
    assert!(boxes.len() == 30 && boxes.windows(2).all(|two| two[0] != two[1]), "{boxes:?}");
    let trackers = ["--tracker", "every-step(nbs)", "--tracker", "verlet(nbs,skin=0.3)"];
    let made = json(folder, &[&["track", SHEARED][..], &SHEAR, &trackers].concat());
    let read = json(folder, &[&["track", "all.xyz"][..], &trackers].concat());
    assert_eq!(moved(&made), moved(&read));
    assert!(made["born"].as_u64() > Some(5) && made["uncounted"].is_null(), "{made}");
    for of in [&made, &read] {
        for tracker in of["trackers"].as_array().unwrap() {
            assert_eq!(tracker["missed"].as_u64(), Some(0), "{tracker}");
            assert_eq!(tracker["reported"], of["contacts"], "{tracker}");
        }
    }
    let inspected = json(folder, &["inspect", "all.xyz", "--frame", "all"]);
    assert_eq!(moved(&inspected["motion"]), moved(&read));
    // One of them alone is a scene in its box, and moves on from there.
    good(folder, &["scene", SHEARED, "--motion", "shear:speed=0.25", "--at", "29", "-o", "a.xyz"]);
    let last = std::fs::read_to_string(folder.join("a.xyz")).unwrap();
    assert_eq!(last.lines().nth(1), Some(boxes[29]));
    let on = ["--motion", "drift:speed=0.1", "--frames", "3", "--tracker", "every-step(nbs)"];
    let alone = json(folder, &[&["track", "a.xyz"][..], &on].concat());
    let of_all = json(folder, &[&["track", "all.xyz", "--frame", "last"][..], &on].concat());
    assert_eq!(moved(&alone), moved(&of_all));
    // Without its box there are fewer.
    let open = json(folder, &[&["track", "all.xyz", "--open"][..], &trackers].concat());
    assert!(open["contacts"].as_u64() < read["contacts"].as_u64(), "{open}");
}

/// The box of a file that has none is named on the command line.
#[test]
fn the_box_is_named_for_files_without_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // One flies on through a face beside another: a wrapped dump, and its unwrapped twin.
    let dump = |name: &str, wrap: bool| {
        let frame = |k: u32| {
            let x = |x: f64| if wrap { x.rem_euclid(8.0) } else { x };
            let [a, b] = [6.5, 7.25].map(|at| x(at + 0.25 * f64::from(k)));
            format!("2\nProperties=species:S:1:pos:R:2:radius:R:1\nA {a} 1 0.5\nA {b} 1 0.5\n")
        };
        file(folder, name, (0..9).map(frame).collect::<String>());
    };
    dump("wrapped.xyz", true);
    dump("twin.xyz", false);
    let of = |name: &str| {
        json(folder, &["track", name, "--box", "8,8", "--tracker", "verlet(nbs,rule=every-9)"])
    };
    let [wrapped, twin] = ["wrapped.xyz", "twin.xyz"].map(of);
    assert_eq!(moved(&wrapped), moved(&twin));
    assert_eq!([&wrapped["born"], &wrapped["ended"], &wrapped["contacts"]], [0, 0, 9]);
    assert_eq!(wrapped["trackers"][0]["missed"], 0);
    let open = json(folder, &["track", "wrapped.xyz", "--tracker", "every-step(nbs)"]);
    assert!(open["ended"] == 1 && open["longest_way"].as_f64() > Some(7.0), "{open}");
}

#[test]
fn what_does_not_go_in_boxes_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for motion in ["rotation", "vortex", "bullet"] {
        let words = &[&*format!("{motion} needs open boundaries"), "drift, shear, jitter"];
        refused(folder, &["track", SHEARED, "--motion", motion], words);
        refused(folder, &["scene", SHEARED, "--motion", motion, "--at", "1"], words);
    }
    let frame = |pbc: &str| {
        format!(
            "1\nLattice=\"4 0 0 0 4 0 0 0 4\" pbc=\"{pbc}\" \
             Properties=species:S:1:pos:R:3:radius:R:1\nA 1 1 1 0.5\n"
        )
    };
    file(folder, "a.xyz", frame("T T T") + &frame("T F T"));
    let words = "frame 1: the box repeats along x and z, and along x, y and z in the first frame";
    refused(folder, &["track", "a.xyz"], &[words, "(--periodic)", "--open"]);
    assert!(good(folder, &["inspect", "a.xyz", "--frame", "all"]).stdout.contains(words));
    good(folder, &["track", "a.xyz", "--periodic", "xz", "--tracker", "every-step(nbs)"]);
    let said = ["--tracker", "verlet(nbs)"];
    let in_f32 = ["track", SHEARED, "--frames", "2", "--arithmetic", "f32"];
    let said = good(folder, &[&in_f32[..], &said].concat()).stdout;
    assert!(said.contains("decides in exact arithmetic, not in f32"), "{said}");
}

/// Frames, boxes and answers go from process to process, and each frame is judged.
#[test]
fn trackers_in_boxes_are_judged_frame_by_frame() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let rule = "verlet(nbs,rule=every-7,skin=0.05)";
    let hello = say(r#"{"reply":"hello","protocol":3,"detector":"old","arithmetic":"exact"}"#);
    // What it is sent is in its answer.
    let old = format!(
        "{hello}\nwhile read -r line; do\ncase \"$line\" in\n*'\"boxes\"'*) exit 3 ;;\n\
         *'\"box\"'*) {} ;;\n*) {} ;;\nesac\ndone",
        say(r#"{"reply":"refused","reason":"one box for all"}"#),
        say(r#"{"reply":"unsupported"}"#)
    );
    file(
        folder,
        "a.toml",
        format!(
            "name = \"a\"\ntitle = \"a\"\nquestion = \"a\"\nreading = \"a\"\nblocks = 1\n\
             detectors = [\"every-step(nbs)\", \"{rule}\", \"nbs\"]\n\
             [[scene]]\nname = \"loose\"\ndim = [2, 3]\nn = 50\nfraction = 0.5\nperiodic = true\n\
             order = \"generated\"\nmotion = [\"drift\", \"shear\"]\nspeed = 0.15\nframes = 15\n\n{}{}",
            runner("old", "sh", &old),
            runner("older", "sh", &fake(&[]))
        ),
    );
    good(folder, &["run", "a.toml", "--out", "out"]);
    let rows = std::fs::read_to_string(folder.join("out/samples.jsonl")).unwrap();
    let rows: Vec<Value> = rows.lines().map(|row| serde_json::from_str(row).unwrap()).collect();
    let mut lossy = 0;
    for dim in [2, 3] {
        for motion in ["drift", "shear"] {
            let of = |detector: &str, rule: Option<&str>| -> Value {
                let of = |row: &&Value| {
                    row["detector"] == detector
                        && row["dim"] == dim
                        && row["params"]["motion"] == motion
                        && rule.is_none_or(|rule| row["detector_params"]["rule"] == rule)
                };
                rows.iter().find(of).unwrap_or_else(|| panic!("{detector} {motion}")).clone()
            };
            let scene = format!("loose:dim={dim},n=50,fraction=0.5,periodic=true,order=generated");
            let motion_text = format!("{motion}:speed=0.15");
            let arguments = ["track", &scene, "--motion", &motion_text, "--frames", "15"];
            let tracked = json(folder, &[&arguments[..], &["--tracker", rule]].concat());
            let tracker = &tracked["trackers"][0];
            for detector in ["every-step", "nbs"] {
                let row = of(detector, None);
                assert_eq!(
                    (&row["outcome"], &row["contacts"]),
                    (&"ok".into(), &tracked["contacts"])
                );
            }
            // The judge and `track` find the same.
            let row = of("verlet", Some("every-7"));
            let missed = tracker["missed"].as_u64().unwrap();
            assert_eq!(row["outcome"], if missed > 0 { "lossy" } else { "ok" });
            assert_eq!(row["errors"]["missed"].as_u64(), Some(missed));
            for (ours, theirs) in [
                ("first_wrong", "first_missed_frame"),
                ("never", "never_reported"),
                ("latest", "latest"),
                ("deepest_late", "deepest"),
                ("worst_missed", "worst_missed"),
                ("listed", "listed"),
                ("builds", "built"),
            ] {
                assert_eq!(row["course"][ours], tracker[theirs], "{motion} {dim} {ours}");
            }
            for key in ["contacts", "born", "ended", "tunnelled"] {
                assert_eq!(row["moved"][key], tracked[key], "{motion} {dim} {key}");
            }
            lossy += missed;
            let said = |name: &str| {
                let row = of(name, None);
                format!("{}: {}", row["outcome"].as_str().unwrap(), row["reason"].as_str().unwrap())
            };
            let old = said("old");
            let words = match motion {
                "drift" => "refused: one box for all",
                _ => {
                    "unavailable: the runner speaks protocol 3, which knows one box for all frames"
                }
            };
            assert!(old.starts_with(words), "{old}");
            let older = said("older");
            assert!(older.contains("unavailable: periodic scenes are skipped"), "{older}");
        }
    }
    assert!(lossy > 20, "{lossy}");
}
