//! Files with boxes as users meet them: used or refused in words, never ignored.

use std::path::Path;

use serde_json::{Value, json};

use crate::common::{file, good, refused, run};

/// Two spheres that touch as they stand, and two more through a face of a sheared box: its edges
/// are 4, with xy = 1, and it is open along z.
const TILTED: &str = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n4\nITEM: BOX BOUNDS xy xz yz pp pp \
                      ff\n0 5 1\n0 4 0\n0 4 0\nITEM: ATOMS id radius x y z\n1 0.5 1 1 1\n2 0.5 2 \
                      1 1\n3 0.5 1.5 0.25 3\n4 0.5 2.5 3.25 3\n";
const CUBE: &str = "2\nLattice=\"4 0 0 0 4 0 0 0 4\" Properties=pos:R:3:radius:R:1\n0.25 1 1 \
                    0.5\n3.25 1 1 0.5\n";
const DATA: &str = "made by hand\n\n1 atoms\n0 4 xlo xhi\n0 4 ylo yhi\n0 4 zlo zhi\n\nAtoms # \
                    sphere\n\n1 1 1 1 1 1 1\n";

fn json_of(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&good(folder, arguments).stdout).unwrap()
}

/// What all verbs say that take boundaries as open.
fn words(name: &str, axes: &str) -> String {
    format!(
        "contactbench: {name}: the box repeats along {axes}, and here boundaries are open; give \
         --open (in an experiment open = true) to leave out contacts across it, or take detect, verify or inspect, which know boxes\n"
    )
}

#[test]
fn every_verb_that_takes_boundaries_as_open_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    file(folder, "cube.xyz", CUBE);
    file(folder, "bare.csv", "x,y,z,r\n1,1,1,0.5\n2,1,1,0.5\n");
    file(folder, "list.csv", "i,j\n0,1\n");
    let verbs: [&[&str]; 7] = [
        &["detect"],
        &["verify", "--pairs", "list.csv"],
        &["draw", "-o", "never.svg"],
        &["recommend", "--seconds", "0.1"],
        &["scene"],
        &["trace", "nbs"],
        &["check", "--detector", "nbs", "--scene"],
    ];
    for verb in verbs {
        for (name, axes) in [("tilted.dump", "x and y"), ("cube.xyz", "x, y and z")] {
            let ended = refused(folder, &[verb, &[name]].concat(), &[]);
            assert_eq!(ended.stderr, words(name, axes), "{verb:?}");
        }
        if verb[0] != "check" {
            let with = [verb, &["bare.csv", "--box", "4,4,4"]].concat();
            let ended = refused(folder, &with, &[]);
            assert_eq!(ended.stderr, words("bare.csv", "x, y and z"), "{verb:?}");
        }
        // With a word it is as it was.
        if !["trace", "recommend", "verify"].contains(&verb[0]) {
            good(folder, &[verb, &["tilted.dump", "--open"]].concat());
        }
    }
    assert_eq!(good(folder, &["detect", "tilted.dump", "--open"]).stdout, "i,j\n0,1\n");
    assert_eq!(good(folder, &["detect", "tilted.dump", "--periodic", "none"]).stdout, "i,j\n0,1\n");
    good(folder, &["verify", "tilted.dump", "--pairs", "list.csv", "--open"]);
    // What was written has no box any more.
    good(folder, &["scene", "cube.xyz", "--open", "-o", "open.xyz"]);
    assert_eq!(good(folder, &["detect", "open.xyz"]).stdout, "i,j\n");
}

#[test]
fn experiments_say_that_a_file_is_open() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    let experiment = |open: &str| {
        let text = format!(
            "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
             0\ndetectors = [\"nbs\"]\n[[scene]]\nname = \"file\"\npath = \"tilted.dump\"\n{open}"
        );
        file(folder, "t.toml", text);
    };
    let said = "the box repeats along x and y, and here boundaries are open; give --open (in an \
                experiment open = true) to leave out contacts across it, or take detect, verify or inspect, which know boxes";
    for refusing in ["", "open = false\n", "open = \"false\"\n"] {
        experiment(refusing);
        let ended = run(folder, &["run", "t.toml", "--out", "out"]);
        assert_eq!(ended.code, Some(2), "{refusing}: {}{}", ended.stdout, ended.stderr);
        assert!(ended.stderr.contains(said), "{refusing}: {}", ended.stderr);
        let _ = std::fs::remove_dir_all(folder.join("out"));
    }
    for open in ["open = true\n", "open = \"true\"\n"] {
        experiment(open);
        let ended = run(folder, &["run", "t.toml", "--out", "out"]);
        assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
        std::fs::remove_dir_all(folder.join("out")).unwrap();
    }
    experiment("open = 1\n");
    refused(folder, &["run", "t.toml", "--out", "out"], &["open is 1; it must be true or false"]);
    let scene = ["scene", "file:path=tilted.dump,order=generated,open=true"];
    assert!(good(folder, &scene).stdout.starts_with("x,y,z,r\n1.0,1.0,1.0,0.5\n"));
    refused(folder, &["scene", "file:path=tilted.dump"], &[said]);
}

#[test]
fn inspect_shows_the_box() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    let found = json_of(folder, &["inspect", "tilted.dump", "--json"]);
    for (key, value) in [
        ("box_vectors", json!([[4.0, 0.0, 0.0], [1.0, 4.0, 0.0], [0.0, 0.0, 4.0]])),
        ("box_origin", json!([0.0, 0.0, 0.0])),
        ("box_tilted", json!(true)),
        ("periodic", json!([true, true, false])),
        ("outside", json!(0)),
        ("reach", json!(1.0)),
        // The open numbers, marked.
        ("contacts", json!(1)),
        ("boundaries", json!("open")),
        (
            "warnings",
            json!([
                "1 couples are within 1e-9 of just touching: codes that round in different ways \
                 will disagree about them"
            ]),
        ),
    ] {
        assert_eq!(found[key], value, "{key} in {found:#}");
    }
    let close = |value: &Value, to: f64| (value.as_f64().unwrap() - to).abs() < 1e-12;
    // A shear of 1 in 4 leaves 16 / sqrt 17 between the faces along x.
    assert!(close(&found["box_heights"][0], 16.0 / 17f64.sqrt()), "{found:#}");
    assert!(close(&found["box_lengths"][1], 17f64.sqrt()), "{found:#}");
    assert_eq!((&found["box_heights"][1], &found["box_heights"][2]), (&json!(4.0), &Value::Null));
    let text = good(folder, &["inspect", "tilted.dump"]).stdout;
    for line in [
        "boundaries        the box repeats along x and y, as the file says\n",
        "box               vectors (4 0 0) (1 4 0) (0 0 4), lengths 4 4.123 4, tilted; corner 0 0",
        "outside the box   0 particles\n",
        "between faces     x 3.881, y 4; bodies touch over 1 at most\n",
        "open boundaries: none across the box",
    ] {
        assert!(text.contains(line), "'{line}' in {text}");
    }
    // Outside, small, and of two kinds.
    let xyz = |name: &str, edge: &str, radius: &str| {
        let text = format!(
            "2\nLattice=\"{edge} 0 0 0 9 0 0 0 9\" Properties=pos:R:3:r:R:1\n-1 0 0 {radius}\n2 1 \
             1 {radius}\n"
        );
        file(folder, name, text);
        json_of(folder, &["inspect", name, "--json"])
    };
    let found = xyz("outside.xyz", "4", "0.5");
    assert_eq!((&found["outside"], &found["warnings"]), (&json!(1), &json!([])), "{found:#}");
    let several = "the box is so small along x that two bodies may touch through several images, \
                   of which codes that look at the nearest one see one";
    assert_eq!(xyz("several.xyz", "4", "1")["warnings"], json!([several]));
    let own = "the box is so small along x that a body may touch its own image";
    assert_eq!(xyz("own.xyz", "4", "2")["warnings"], json!([own]));
    assert_eq!(xyz("free.xyz", "4.0001", "1")["warnings"], json!([]));
    // Discs.
    file(folder, "discs.csv", "x,y,r\n1,1,0.5\n");
    let found = json_of(folder, &["inspect", "discs.csv", "--box", "4,0,1,5", "--json"]);
    assert_eq!(found["box_vectors"], json!([[4.0, 0.0], [1.0, 5.0]]));
    assert_eq!(found["periodic"], json!([true, true]));
    // Where there is none, that is said, too.
    for (arguments, line) in [
        (&["discs.csv"][..], "boundaries        open: there is no box in the file\n"),
        (&["discs.csv", "--open"], "boundaries        open (--open)\n"),
        (&["tilted.dump", "--periodic", "none"], "boundaries        open (--periodic none)\n"),
        (
            &["discs.csv", "--box", "4,4", "--periodic", "x"],
            "boundaries        the box repeats along x (--box, --periodic)\n",
        ),
        (
            &["discs.csv", "--box", "4,4"],
            "boundaries        the box repeats along x and y (--box)\n",
        ),
    ] {
        let text = good(folder, &[&["inspect"], arguments].concat()).stdout;
        assert!(text.contains(line), "'{line}' in {text}");
    }
    file(folder, "open.dump", TILTED.replace("pp pp ff", "ff ss mf"));
    let text = good(folder, &["inspect", "open.dump"]).stdout;
    assert!(text.contains("boundaries        open, as the file says\n"), "{text}");
    assert!(text.contains("box in the file   (4 0 0) (1 4 0) (0 0 4)\n"), "{text}");
}

#[test]
fn nobody_is_left_to_guess_about_a_data_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "p.lmp", DATA);
    let unknown = "the file does not say whether its box repeats: boundaries are taken as open; \
                   say --periodic xyz if it does, and --open if not";
    for verb in ["detect", "inspect", "scene"] {
        let ended = good(folder, &[verb, "p.lmp"]);
        assert!(ended.stderr.starts_with(&format!("p.lmp: {unknown}\n")), "{}", ended.stderr);
        let ended = good(folder, &[verb, "p.lmp", "--open"]);
        assert!(!ended.stderr.contains("box"), "{}", ended.stderr);
    }
    let found = json_of(folder, &["inspect", "p.lmp", "--json"]);
    assert_eq!(found["warnings"], json!([unknown]));
    assert_eq!(found["periodic"], json!([false, false, false]));
    let text = good(folder, &["inspect", "p.lmp"]).stdout;
    let line = "taken as open: the file does not say whether its box repeats\n";
    assert!(text.contains(line), "{text}");
    let found = json_of(folder, &["inspect", "p.lmp", "--periodic", "xy", "--json"]);
    assert_eq!(found["box_vectors"][0], json!([4.0, 0.0, 0.0]));
    assert_eq!(found["periodic"], json!([true, true, false]));
    assert_eq!(
        refused(folder, &["detect", "p.lmp", "--periodic", "xy"], &[]).stderr,
        words("p.lmp", "x and y")
    );
}

#[test]
fn what_contradicts_itself_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "cube.xyz", CUBE);
    for (arguments, words) in [
        (
            &["cube.xyz", "--open", "--box", "1,2,3"][..],
            "--open takes boundaries as open, and --box says otherwise; leave one out",
        ),
        (
            &["cube.xyz", "--open", "--periodic", "x"],
            "--open takes boundaries as open, and --periodic says otherwise; leave one out",
        ),
        (
            &["packed:n=9", "--box", "1,2"],
            "--radius, --dim, --frame, --columns, --format, --box, --periodic and --open belong \
             to files; write dim=3 and the like into the scene: packed:n=9",
        ),
        (
            &["--open"],
            "--radius, --dim, --frame, --columns, --format, --box, --periodic and --open belong \
             to a particle file, and none is named",
        ),
    ] {
        refused(folder, &[&["detect"], arguments].concat(), &[words]);
    }
    // Numbers may be negative.
    let found = json_of(folder, &["inspect", "cube.xyz", "--box", "-4,4,4,-1,0,0", "--json"]);
    assert_eq!(found["box_vectors"][1], json!([-1.0, 4.0, 0.0]));
}
