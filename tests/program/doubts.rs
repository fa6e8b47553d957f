//! What is doubtful about a file is printed by every verb that reads it, once, and by no verb where
//! nothing is doubtful.

use std::path::Path;

use crate::common::{Ended, file, good, run};

/// Names of notices, and words of each.
const KINDS: [(&str, &str); 11] = [
    ("diameters", "may hold diameters"),
    ("unit", "another unit than the coordinates"),
    ("apart", "nothing touches"),
    ("points", "radii of 0"),
    ("nested", "nearly concentric"),
    ("twice", "centre of another"),
    ("flat", "z is 0 for all"),
    ("scaled", "scaled by a box"),
    ("digits", "6 significant digits at most"),
    ("far", "so far from the origin"),
    ("deep", "mean radii in the mean"),
];

/// The notices in a text, each as often as it stands there.
fn notices(text: &str) -> Vec<&'static str> {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let of = |(kind, words): (&'static str, &str)| vec![kind; text.matches(words).count()];
    KINDS.into_iter().flat_map(of).collect()
}

fn said(ended: &Ended, verb: &str) -> Vec<&'static str> {
    notices(if verb == "inspect" { &ended.stdout } else { &ended.stderr })
}

fn table(rows: &[[f64; 4]]) -> String {
    let line = |[x, y, z, r]: &[f64; 4]| format!("{x},{y},{z},{r}\n");
    format!("x,y,z,r\n{}", rows.iter().map(line).collect::<String>())
}

/// A packing of 300 spheres.
fn packing(folder: &Path) -> Vec<[f64; 4]> {
    good(folder, &["scene", "packed:dim=3,n=300,spacing=0.99", "-o", "good.csv"]);
    let text = std::fs::read_to_string(folder.join("good.csv")).unwrap();
    let numbers = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        <[f64; 4]>::try_from(cells).unwrap()
    };
    text.lines().skip(1).map(numbers).collect()
}

/// Files, and what is doubtful about them.
fn files(folder: &Path) -> Vec<(&'static str, Vec<&'static str>)> {
    let rows = packing(folder);
    let changed = |change: &dyn Fn([f64; 4]) -> [f64; 4]| {
        table(&rows.iter().map(|&row| change(row)).collect::<Vec<_>>())
    };
    let with = |row: [f64; 4]| table(&[&rows[..], &[row]].concat());
    let [x, y, z, r] = rows[7];
    let most = |k: usize| rows.iter().map(|row| row[k]).fold(0.0, f64::max);
    let least = |k: usize| rows.iter().map(|row| row[k]).fold(f64::INFINITY, f64::min);
    let share = |row: [f64; 4], k: usize| (row[k] - least(k)) / (most(k) - least(k));
    let apart = |k: u32| f64::from(k * 7919 % 1000) / 100.0;
    let gas: Vec<[f64; 4]> =
        (0..300).map(|k| [apart(k), apart(3 * k + 1), apart(k * k), 0.45]).collect();
    let six: String =
        rows.iter().map(|[x, y, z, r]| format!("{x:.5},{y:.5},{z:.5},{r}\n")).collect();
    for (name, text) in [
        ("doubled.csv", changed(&|[x, y, z, r]| [x, y, z, 2.0 * r])),
        ("unit.csv", changed(&|[x, y, z, r]| [x, y, z, 1000.0 * r])),
        ("tiny.csv", changed(&|[x, y, z, r]| [x, y, z, 0.001 * r])),
        ("points.csv", changed(&|[x, y, z, _]| [x, y, z, 0.0])),
        ("nested.csv", with([x + 1e-3, y, z, r])),
        ("twice.csv", with([x, y, z, r])),
        ("scaled.csv", changed(&|row| [share(row, 0), share(row, 1), share(row, 2), 1e-4])),
        ("gas.csv", table(&gas)),
        ("six.csv", format!("x,y,z,r\n{six}")),
        ("flat.csv", "x,y,z,r\n0,0,0,0.6\n1,0,0,0.6\n".into()),
    ] {
        file(folder, name, text);
    }
    file(folder, "none.csv", "i,j\n");
    vec![
        ("good.csv", vec![]),
        ("doubled.csv", vec!["diameters"]),
        ("unit.csv", vec!["unit"]),
        ("tiny.csv", vec!["apart"]),
        ("points.csv", vec!["points"]),
        ("nested.csv", vec!["nested"]),
        ("twice.csv", vec!["twice"]),
        ("scaled.csv", vec!["apart", "scaled"]),
        ("gas.csv", vec!["deep"]),
        ("six.csv", vec!["digits"]),
        ("flat.csv", vec!["flat"]),
    ]
}

#[test]
fn every_verb_prints_what_is_doubtful() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, expected) in files(folder) {
        let verbs = [
            &["inspect", name][..],
            &["detect", name],
            &["inspect", name, "--json"],
            &["verify", name, "--pairs", "none.csv"],
            &["verify", name, "--pairs", "none.csv", "--json"],
            &["draw", name],
            &["track", name, "--frames", "2", "--tracker", "every-step(nbs)"],
            &["check", "--scene", name, "--detector", "nbs"],
            &["detect", name, "--frame", "all"],
        ];
        // One mechanism prints all kinds: some kinds are enough for the other verbs.
        let all = ["good.csv", "doubled.csv", "nested.csv", "flat.csv"].contains(&name);
        for arguments in &verbs[..if all { verbs.len() } else { 2 }] {
            let ended = run(folder, arguments);
            // `inspect` says what f32 would do in any case: small radii are far from the origin.
            let found: Vec<&str> =
                said(&ended, arguments[0]).into_iter().filter(|&kind| kind != "far").collect();
            assert_eq!(found, expected, "{arguments:?}: {}", ended.stderr);
        }
    }
    let expected = vec!["nested"];
    let ended = run(folder, &["recommend", "nested.csv", "--seconds", "0.1"]);
    assert_eq!(said(&ended, "recommend"), expected, "{}", ended.stderr);
    let text = |scene: &str| {
        format!(
            "name = \"d\"\ntitle = \"T\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 1\n\
             detectors = [\"nbs\"]\n[[scene]]\n{scene}\n"
        )
    };
    file(folder, "d.toml", text("name = \"file\"\npath = \"nested.csv\""));
    let ended = good(folder, &["run", "d.toml", "--out", "a"]);
    assert_eq!(said(&ended, "run"), expected, "{}", ended.stderr);
    // What is made is not doubted.
    file(folder, "d.toml", text("name = \"loose\"\nn = 50"));
    let ended = good(folder, &["run", "d.toml", "--out", "b"]);
    assert_eq!(said(&ended, "run"), Vec::<&str>::new(), "{}", ended.stderr);
    // `trace` takes few discs.
    file(folder, "discs.csv", "x,y,r\n0,0,0.5\n3,0,0.5\n");
    assert_eq!(said(&good(folder, &["trace", "nbs", "discs.csv"]), "trace"), ["apart"]);
    // Radius and arithmetic as options.
    file(folder, "far.csv", "x,y\n1e7,0\n10000001,0\n");
    let far = |arithmetic: &str| {
        let arguments = ["detect", "far.csv", "--radius", "0.5", "--arithmetic", arithmetic];
        said(&good(folder, &arguments), "detect")
    };
    assert_eq!((far("f32"), far("exact")), (vec!["far"], vec![]));
    let ended = good(folder, &["detect", "far.csv", "--radius", "0"]);
    assert_eq!(said(&ended, "detect"), ["points"]);
}

/// Of several frames each notice is printed once, and that nothing touches only if nothing does in
/// any.
#[test]
fn frames_are_doubted_once() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let frame = |step: u32, x: f64, r: f64| {
        format!(
            "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n2\nITEM: ATOMS id x y z radius\n1 0 0 \
             0.5 {r}\n2 {x} 0 0.25 {r}\n"
        )
    };
    let of = |frames: &[(f64, f64)]| -> String {
        frames.iter().zip(0..).map(|(&(x, r), k)| frame(k, x, r)).collect()
    };
    file(folder, "falls.dump", of(&[(3.0, 0.5), (2.0, 0.5), (0.9, 0.5), (3.0, 0.5)]));
    file(folder, "apart.dump", of(&[(3.0, 0.5), (2.0, 0.5), (1.5, 0.5)]));
    file(folder, "points.dump", of(&[(3.0, 0.0), (2.0, 0.0), (1.0, 0.0)]));
    file(folder, "none.csv", "frame,i,j\n0,0,1\n1,0,1\n2,0,1\n");
    for (name, expected) in
        [("falls.dump", &[][..]), ("apart.dump", &["apart"]), ("points.dump", &["points"])]
    {
        for arguments in [
            &["detect", name, "--frame", "all"][..],
            &["track", name, "--tracker", "every-step(nbs)"],
            &["draw", name, "-o", "a.html"],
        ] {
            let ended = run(folder, arguments);
            assert_eq!(said(&ended, arguments[0]), expected, "{arguments:?}: {}", ended.stderr);
        }
    }
    // No frame is said to be the one that is read where all were asked for.
    let ended = good(folder, &["inspect", "falls.dump", "--frame", "all"]);
    assert!(!ended.stdout.contains("this is frame"), "{}", ended.stdout);
}
