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
    let verbs: [&[&str]; 5] = [
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
        if !["trace", "recommend"].contains(&verb[0]) {
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
        // And those of the box.
        ("contacts_in_box", json!(2)),
        ("contacts_across", json!(1)),
        ("coordination_in_box", json!(1.0)),
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
        "in the box        2 contacts (exact), 1 of them across it, 1 per particle\n",
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
        refused(folder, &["draw", "p.lmp", "--periodic", "xy"], &[]).stderr,
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

/// The words of a file, by numbers.
fn npy_i32(folder: &Path, name: &str) -> (String, Vec<i32>) {
    let bytes = std::fs::read(folder.join(name)).unwrap();
    let start = bytes.iter().position(|&b| b == b'\n').unwrap() + 1;
    let words = bytes[start..].chunks_exact(4).map(|b| i32::from_le_bytes(b.try_into().unwrap()));
    (String::from_utf8_lossy(&bytes[10..start]).into_owned(), words.collect())
}

#[test]
fn detect_names_the_images_that_touch() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    file(folder, "cube.xyz", CUBE);
    // The image of the last by minus the second vector, (2.5 - 1, 3.25 - 4), touches the third.
    let csv = "i,j,sx,sy,sz\n0,1,0,0,0\n2,3,0,-1,0\n";
    for detector in ["streamed-nbs", "direct", "kd-tree"] {
        let ended = good(folder, &["detect", "tilted.dump", "--detector", detector]);
        assert_eq!(ended.stdout, csv, "{detector}");
        for part in [
            "tilted.dump: N = 4, 3D, 2 pairs, 1 of them across the box, which repeats along x and y (",
            " images made), ",
            detector,
        ] {
            assert!(ended.stderr.contains(part), "'{part}' in {}", ended.stderr);
        }
    }
    good(folder, &["detect", "tilted.dump", "-o", "pairs.npy"]);
    let (header, words) = npy_i32(folder, "pairs.npy");
    assert!(header.contains("'descr': '<i4'") && header.contains("(2, 5)"), "{header}");
    assert_eq!(words, [0, 1, 0, 0, 0, 2, 3, 0, -1, 0]);
    good(folder, &["detect", "tilted.dump", "-o", "pairs.vtk"]);
    let text = std::fs::read_to_string(folder.join("pairs.vtk")).unwrap();
    for part in [
        "POINTS 5 double\n1.0 1.0 1.0\n",
        "\n2.5 3.25 3.0\n1.5 -0.75 3.0\nLINES 2 6\n2 0 1\n2 2 4\nPOINT_DATA 5\n",
        "default\n0.5\n0.5\n0.5\n0.5\n0.0\nSCALARS image int 1\nLOOKUP_TABLE default\n0\n0\n0\n0\n1\n",
    ] {
        assert!(text.contains(part), "'{part}' in {text}");
    }
    // A unit cube: one body and its own images, as often as it has them.
    file(folder, "one.csv", "x,y,z,r\n0.25,0.5,7,0.5\n");
    let one = |arguments: &[&str]| {
        good(folder, &[&["detect", "one.csv", "--box", "1,1,1"], arguments].concat()).stdout
    };
    assert_eq!(one(&[]), "i,j,sx,sy,sz\n0,0,0,0,1\n0,0,0,1,0\n0,0,1,0,0\n");
    assert_eq!(one(&["--periodic", "y"]), "i,j,sx,sy,sz\n0,0,0,1,0\n");
    assert_eq!(one(&["--arithmetic", "f32"]).lines().count(), 4);
    // Discs: two through the side, and what is written.
    file(folder, "discs.csv", "x,y,r\n0.25,1,0.5\n3.25,1,0.5\n");
    let discs = ["detect", "discs.csv", "--box", "4,4"];
    assert_eq!(good(folder, &discs).stdout, "i,j,sx,sy\n0,1,-1,0\n");
    good(folder, &[&discs[..], &["-o", "discs.npy"]].concat());
    let (header, words) = npy_i32(folder, "discs.npy");
    assert!(header.contains("(1, 4)"), "{header}");
    assert_eq!(words, [0, 1, -1, 0]);
    good(folder, &[&discs[..], &["-o", "discs.vtk"]].concat());
    let text = std::fs::read_to_string(folder.join("discs.vtk")).unwrap();
    assert!(
        text.contains("POINTS 3 double\n0.25 1.0 0.0\n3.25 1.0 0.0\n-0.75 1.0 0.0\n"),
        "{text}"
    );
    // Without a box nothing has changed.
    assert_eq!(good(folder, &["detect", "discs.csv"]).stdout, "i,j\n");
    // Too many are refused before they are made, in words.
    let small = ["detect", "cube.xyz", "--box", "1e-4,1,1", "--memory-limit", "1MiB"];
    refused(folder, &small, &["images in and around the box", "the limit is 1048576"]);
    file(folder, "heap.csv", format!("x,y,r\n{}", "0,0,0.5\n".repeat(40)));
    let heap =
        ["detect", "heap.csv", "--box", "0.01,9", "--periodic", "x", "--memory-limit", "1MiB"];
    refused(folder, &heap, &["heap.csv: ", " pairs", "1048576"]);
    let many = ["detect", "cube.xyz", "--box", "1e-3,1,1", "--memory-limit", "400KiB"];
    refused(folder, &many, &["cube.xyz: ", "limit"]);
    // A plane of LAMMPS is periodic along z, too: whoever reads it in 3D is told.
    file(folder, "plane.xyz", CUBE.replace("1 1 0.5", "1 0 0.5"));
    let said = "plane.xyz: z is 0 for all, and the box repeats along z: if these are discs, give \
                --dim 2\n";
    assert!(good(folder, &["detect", "plane.xyz"]).stderr.starts_with(said));
    assert!(!good(folder, &["detect", "plane.xyz", "--dim", "2"]).stderr.contains("z is 0"));
}

#[test]
fn verify_compares_lists_with_images_and_without() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    file(folder, "one.csv", "x,y,z,r\n0.25,0.5,7,0.5\n");
    good(folder, &["detect", "tilted.dump", "-o", "own.npy"]);
    good(folder, &["detect", "tilted.dump", "-o", "own.csv"]);
    file(folder, "ids.csv", "i,j,sx,sy,sz\n2,1,0,0,0\n4,3,0,1,0\n");
    file(folder, "pairs.csv", "0,1\n3,2\n");
    let local = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n2\nITEM: BOX BOUNDS xy xz yz pp pp \
                 ff\n0 5 1\n0 4 0\n0 4 0\nITEM: ENTRIES c_1[1] c_1[2]\n1 2\n3 4\n";
    file(folder, "local.dump", local);
    let images = "pairs with their images";
    let through_one = "pairs; each touches through one image";
    for (arguments, compared) in [
        (&["own.npy", "--base", "0"][..], images),
        (&["own.csv", "--base", "0"], images),
        (&["ids.csv", "--ids"], images),
        (&["pairs.csv"], through_one),
        (&["local.dump"], through_one),
    ] {
        let verify = [&["verify", "tilted.dump", "--pairs"], arguments].concat();
        let found = json_of(folder, &[&verify[..], &["--json"]].concat());
        assert_eq!(
            (&found["same"], &found["contacts"], &found["compared"], &found["periodic"]),
            (&json!(true), &json!(2), &json!(compared), &json!([true, true, false])),
            "{arguments:?}: {found:#}"
        );
        let text = good(folder, &verify).stdout;
        let head = "tilted.dump: 4 particles, 2 touching pairs in a box that repeats along x and y \
                    (exact arithmetic)\n";
        assert!(text.starts_with(head), "{text}");
        assert!(text.contains(&format!("compared: {compared}\nthe same: no pair")), "{text}");
    }
    // One body that touches three pairs of images of itself.
    for (rows, compared) in [
        (1, "pairs without images, each once, through how many it touches"),
        (3, "pairs without images, each as often as images of it touch"),
    ] {
        file(folder, "self.csv", format!("i,j\n{}", "0,0\n".repeat(rows)));
        let verify = ["verify", "one.csv", "--pairs", "self.csv", "--box", "1,1,1", "--json"];
        let found = json_of(folder, &verify);
        assert_eq!((&found["same"], &found["compared"]), (&json!(true), &json!(compared)));
    }
    file(folder, "self.csv", "i,j,sx,sy,sz\n0,0,0,0,-1\n0,0,0,1,0\n0,0,-1,0,0\n");
    good(folder, &["verify", "one.csv", "--pairs", "self.csv", "--box", "1,1,1"]);
    // Without a box a body does not touch itself.
    file(folder, "self.csv", "i,j\n0,0\n");
    assert_eq!(run(folder, &["verify", "one.csv", "--pairs", "self.csv"]).code, Some(1));

    // What differs is shown with its image.
    file(
        folder,
        "wrong.csv",
        "i,j,sx,sy,sz\n0,1,0,0,0\n0,1,0,0,0\n2,3,0,0,0\n0,0,0,0,0\n0,9,0,0,0\n",
    );
    let ended = run(folder, &["verify", "tilted.dump", "--pairs", "wrong.csv"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    for part in [
        "missed       1  deepest overlap 0 mean radii",
        "spurious     1  widest gap 4.325 mean radii",
        "duplicate    1",
        "with itself  1",
        "unknown      1  such as 0,9: the file has no such particle",
        "  2,3  image 0,-1,0  overlap 0\n    2: 1.5 0.25 3.0 r 0.5\n",
        "  2,3  gap 4.325\n",
    ] {
        assert!(ended.stdout.contains(part), "'{part}' in:\n{}", ended.stdout);
    }
    let wrong = run(folder, &["verify", "tilted.dump", "--pairs", "wrong.csv", "--json"]);
    let found: Value = serde_json::from_str(&wrong.stdout).unwrap();
    assert_eq!(found["missed"][0]["image"], json!([0, -1, 0]), "{found:#}");
}

/// What is wrong with a list in a box, and the options with which it agrees.
#[test]
fn verify_says_which_option_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    file(folder, "p.lmp", DATA.replace("1 atoms", "2 atoms") + "2 1 1 1 4.25 1 1\n");
    file(folder, "near.csv", "x,y,r\n0.25,1,0.5\n3.25,1,0.5\n3.25,2.1,0.5\n");
    let list = |text: &str| file(folder, "list.csv", text);
    let hint = |arguments: &[&str], words: &str, flags: Value| {
        let verify = [&["verify"], arguments, &["--pairs", "list.csv"]].concat();
        let ended = run(folder, &verify);
        let said: String = ended.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(ended.code, Some(1), "{}{}", ended.stdout, ended.stderr);
        assert!(said.contains(&format!("hint: with {words}")), "'{words}' in:\n{}", ended.stdout);
        let found = run(folder, &[&verify[..], &["--json"]].concat());
        let found: Value = serde_json::from_str(&found.stdout).unwrap();
        assert_eq!(found["hint"], flags, "{found:#}");
        // With what is said it agrees.
        if let Some(flags) = flags.as_str() {
            let more: Vec<&str> = flags.split(' ').collect();
            good(folder, &[&verify[..], &more].concat());
        }
    };
    let tilted = ["tilted.dump"];
    list("i,j\n0,1\n");
    let open = "open boundaries (no contact across the box), all 1 pair agree: add --open";
    hint(&tilted, open, json!("--open"));
    list("i,j,sx,sy,sz\n1,2,0,0,0\n3,4,0,-1,0\n");
    hint(&tilted, "numbers from 1, all 2 pairs agree: add --base 1", json!("--base 1"));
    list("i,j,sx,sy,sz\n0,1,0,0,0\n3,2,0,1,0\n1,0,0,0,0\n2,3,0,-1,0\n");
    let twice = "each pair taken once, which is listed as i,j and as j,i, all 2 pairs agree: add \
                 --both-sides";
    hint(&tilted, twice, json!("--both-sides"));
    list("i,j,sx,sy,sz\n0,1,0,0,0\n2,3,0,1,0\n");
    let turned =
        "images of i in the place of those of j (S with the other sign), all 2 pairs agree";
    hint(&tilted, turned, Value::Null);
    list("i,j\n0,1\n0,2\n1,2\n");
    let skin = "pairs up to 0.487 apart (a skin), all 3 pairs agree: add --skin 0.487";
    hint(&["near.csv", "--box", "4,4"], skin, json!("--skin 0.487"));
    list("i,j\n0,2\n1,2\n");
    file(folder, "row.csv", "x,y,r\n0.25,1,0.5\n3.25,1,0.5\n3.5,1.5,0.5\n");
    let tangent = "< in the place of <= (the pairs missed touch in one point), all 2 pairs agree";
    hint(&["row.csv", "--box", "4,4"], tangent, Value::Null);
    // A box of which the file does not say whether it repeats, or that was left out.
    list("1,2\n2,1\n");
    let declared = "numbers from 1, and each pair taken once, which is listed as i,j and as j,i, \
                    and the file's box, repeating along x, y and z, all 1 pair agree: add --base 1 \
                    --both-sides --periodic xyz";
    hint(&["p.lmp"], declared, json!("--base 1 --both-sides --periodic xyz"));
    list("0,1\n2,3\n");
    let ended = run(folder, &["verify", "tilted.dump", "--pairs", "list.csv", "--open"]);
    let left_out = "hint: with the file's box, repeating along x and y, all 2 pairs agree: leave \
                    out --open\n";
    assert!(ended.stdout.contains(left_out), "{}", ended.stdout);
    // A box that nobody has declared is guessed.
    let rows: String = (0..6).map(|k| format!("{},{},0.5\n", k % 2 * 5, 2 * (k / 2))).collect();
    file(folder, "guess.csv", format!("x,y,r\n{rows}"));
    list("0,1\n2,3\n4,5\n");
    let guess = "periodic images (a box of 6 along x), all 3 pairs agree: add --box 6.0,0.0 \
                 --periodic x";
    hint(&["guess.csv"], guess, json!("--box 6.0,0.0 --periodic x"));
}

#[test]
fn lists_that_do_not_fit_the_box_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    for (text, arguments, words) in [
        (
            "i,j,sx,sy,sz\n0,1,0,0,0\n0,1,0,0,1\n",
            &[][..],
            "list.csv: pair 1 of the list (from 0) names the image 0,0,1, and the box repeats \
             along x and y; give --periodic with all axes along which it repeats",
        ),
        (
            "i,j,sx,sy,sz\n0,1,0,0,0\n2,3,0,-1,0\n",
            &["--open"],
            "list.csv: pair 1 (from 0) names an image in a box that repeats, 0,-1,0, and boundaries \
             are open here; give --box LX,LY,LZ and --periodic xyz, or leave out --open",
        ),
        (
            "i,j,sx\n0,1,0\n",
            &[],
            "list.csv:1: images need the columns sx and sy, and sz for spheres; name them",
        ),
        (
            "i,j,sx,sy,sz\n0,1,0,one,0\n",
            &[],
            "list.csv:2: column 4: 'one' is not the number of an image",
        ),
        (
            "i,j,sx,sy,sz\n0,1,0,0,3000000000\n",
            &[],
            "list.csv:2: 3000000000 is not the number of an image: below 2^31",
        ),
    ] {
        file(folder, "list.csv", text);
        let verify = ["verify", "tilted.dump", "--pairs", "list.csv"];
        let ended = refused(folder, &[&verify[..], arguments].concat(), &[]);
        assert_eq!(ended.stderr, format!("contactbench: {words}\n"));
    }
    // Images that are none are nothing special.
    file(folder, "list.csv", "i,j,sx,sy,sz\n0,1,0,0,0\n");
    good(folder, &["verify", "tilted.dump", "--pairs", "list.csv", "--open"]);
    file(folder, "three.npy", crate::common::npy(&[vec![0.0, 1.0, 0.0]]));
    refused(
        folder,
        &["verify", "tilted.dump", "--pairs", "three.npy"],
        &[
            "pairs have the shape (pairs, 2), with images in a box (pairs, 4) for discs and (pairs, 5)",
        ],
    );
}
