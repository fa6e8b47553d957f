//! Tests moving particles in periodic boxes: `track`, `scene`, `inspect` and `run`.

use serde_json::Value;

use crate::common::{Place, fake, runner, say};

/// Returns the description of a motion without its times and names.
fn moved(of: &Value) -> Vec<Value> {
    let keys = ["particles", "frames", "contacts", "born", "ended", "longest_way", "at_rest"];
    keys.map(|key| of[key].clone()).to_vec()
}

const SHEARED: &str = "loose:dim=2,n=50,fraction=0.5,periodic=true,tilt=0.2";

/// Each frame has its own box, whether it is generated or read from a file.
#[test]
fn frames_in_boxes_are_followed_as_they_are_made_and_from_files() {
    let at = Place::new();
    let shear = "--motion shear:speed=0.25 --frames 30";
    at.good(&format!("scene {SHEARED} {shear} -o all.xyz"));
    let text = at.read("all.xyz");
    let boxes: Vec<&str> = text.lines().filter(|line| line.contains("Lattice=")).collect();
    assert!(boxes.len() == 30 && boxes.windows(2).all(|two| two[0] != two[1]), "{boxes:?}");
    let trackers = "--tracker every-step(nbs) --tracker verlet(nbs,skin=0.3)";
    let made = at.json(&format!("track {SHEARED} {shear} {trackers}"));
    let read = at.json(&format!("track all.xyz {trackers}"));
    assert_eq!(moved(&made), moved(&read));
    assert!(made["born"].as_u64() > Some(5), "{made}");
    for tracker in [&made, &read].iter().flat_map(|of| of["trackers"].as_array().unwrap()) {
        assert_eq!((&tracker["missed"], &tracker["reported"]), (&0.into(), &made["contacts"]));
    }
    let inspected = at.json("inspect all.xyz --frame all");
    assert_eq!(moved(&inspected["motion"]), moved(&read));
    // One frame alone is a scene in a box, which another motion can move.
    at.good(&format!("scene {SHEARED} --motion shear:speed=0.25 --at 29 -o a.xyz"));
    assert_eq!(at.read("a.xyz").lines().nth(1), Some(boxes[29]));
    let on = "--motion drift:speed=0.1 --frames 3 --tracker every-step(nbs)";
    let alone = at.json(&format!("track a.xyz {on}"));
    assert_eq!(moved(&alone), moved(&at.json(&format!("track all.xyz --frame last {on}"))));
    let open = at.json(&format!("track all.xyz --open {trackers}"));
    assert!(open["contacts"].as_u64() < read["contacts"].as_u64(), "{open}");
}

/// `--box` gives a file its box. Two touching particles cross a face, with wrapped and with
/// unwrapped coordinates.
#[test]
fn the_box_is_named_for_files_without_one() {
    let at = Place::new();
    for name in ["wrapped.xyz", "twin.xyz"] {
        let frame = |k: u32| {
            let [a, b] = [6.5, 7.25].map(|x| x + 0.25 * f64::from(k));
            let [a, b] = [a, b].map(|x| if name == "twin.xyz" { x } else { x.rem_euclid(8.0) });
            format!("2\nProperties=species:S:1:pos:R:2:radius:R:1\nA {a} 1 0.5\nA {b} 1 0.5\n")
        };
        at.file(name, (0..9).map(frame).collect::<String>());
    }
    let of = |name| at.json(&format!("track {name} --box 8,8 --tracker verlet(nbs,rule=every-9)"));
    let [wrapped, twin] = ["wrapped.xyz", "twin.xyz"].map(of);
    assert_eq!(moved(&wrapped), moved(&twin));
    assert_eq!([&wrapped["born"], &wrapped["ended"], &wrapped["contacts"]], [0, 0, 9]);
    assert_eq!(wrapped["trackers"][0]["missed"], 0);
    let open = at.json("track wrapped.xyz --tracker every-step(nbs)");
    assert!(open["ended"] == 1 && open["longest_way"].as_f64() > Some(7.0), "{open}");
}

/// Fields of a tracker in a row, with their names in the JSON of `track`.
pub const SAME: [(&str, &str); 10] = [
    ("builds", "built"),
    ("dangerous", "dangerous"),
    ("dangerous_rightly", "dangerous_rightly"),
    ("missing_builds", "missing_builds"),
    ("listed", "listed"),
    ("never", "never_reported"),
    ("latest", "latest"),
    ("worst_missed", "worst_missed"),
    ("first_wrong", "first_missed_frame"),
    ("deepest_late", "deepest"),
];

#[test]
fn runners_receive_the_boxes_of_frames() {
    let at = Place::new();
    // The runner refuses with the field that it received, so the reason shows it.
    let load = format!(
        "case \"$line\" in *'\"boxes\"'*) {} ;; *'\"box\"'*) {} ;; *) exit 3 ;; esac",
        say(r#"{"reply":"refused","reason":"a box for each"}"#),
        say(r#"{"reply":"refused","reason":"one box for all"}"#)
    );
    let text = format!(
        "name = \"a\"\ntitle = \"a\"\nquestion = \"a\"\nreading = \"a\"\nblocks = 0\n\
         detectors = [\"nbs\"]\n\
         [[scene]]\nname = \"loose\"\ndim = [2, 3]\nn = 50\nfraction = 0.5\nperiodic = true\n\
         order = \"generated\"\nmotion = [\"drift\", \"shear\"]\nspeed = 0.15\nframes = 15\n\n{}",
        runner("open", "sh", &fake(&[("load", &load)]))
    );
    at.file("a.toml", text);
    at.good("run a.toml --out out");
    let rows = at.read("out/samples.jsonl");
    let rows: Vec<Value> = rows.lines().map(|row| serde_json::from_str(row).unwrap()).collect();
    for (dim, motion) in [2, 3].iter().flat_map(|dim| ["drift", "shear"].map(|it| (*dim, it))) {
        let of = |row: &&Value| {
            row["detector"] == "open" && row["dim"] == dim && row["params"]["motion"] == motion
        };
        let row = rows.iter().find(of).unwrap_or_else(|| panic!("{dim} {motion}"));
        let sent = if motion == "drift" { "one box for all" } else { "a box for each" };
        assert_eq!((&row["outcome"], &row["reason"]), (&"refused".into(), &sent.into()));
    }
}
