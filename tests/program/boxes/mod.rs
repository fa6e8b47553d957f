//! Files with boxes as users meet them: used or refused in words, never ignored.

mod columns;
mod draw;
mod inspect;
mod lists;
mod moving;

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

/// A row of the record that an experiment left in `out`.
fn counted(folder: &Path) -> Value {
    let rows = std::fs::read_to_string(folder.join("out/samples.jsonl")).unwrap();
    std::fs::remove_dir_all(folder.join("out")).unwrap();
    let mut rows = rows.lines().map(|row| serde_json::from_str::<Value>(row).unwrap());
    rows.find(|row| row["pass"] == "count").unwrap()
}

/// What a verb says that takes boundaries as open.
const OPEN: &str = "the box repeats along x and y, and here boundaries are open; give --open to \
                    leave out contacts across it\n";

/// Or it would be a picture of other contacts.
#[test]
fn a_verb_that_knows_no_boxes_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    let ended = refused(folder, &["trace", "nbs", "tilted.dump"], &[]);
    assert_eq!(ended.stderr, format!("contactbench: tilted.dump: {OPEN}"));
    let scene = ["trace", "nbs", "packed:n=9,periodic=true"];
    refused(folder, &scene, &["packed:n=9,periodic=true: the scene repeats along x and y, and"]);
}

#[test]
fn the_other_verbs_take_the_box() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    file(folder, "cube.xyz", CUBE);
    file(folder, "list.csv", "i,j\n0,1\n");
    for (name, contacts) in [("tilted.dump", 2), ("cube.xyz", 1)] {
        good(folder, &["check", "--detector", "nbs", "--scene", name]);
        let found = json_of(folder, &["recommend", "--seconds", "0.1", "--json", name]);
        assert_eq!(found["contacts"], contacts, "{found:#}");
        let repeats = if name == "cube.xyz" { "x, y and z" } else { "x and y" };
        let said = good(folder, &["recommend", "--seconds", "0.1", name]).stdout;
        assert!(said.contains(&format!("repeating along {repeats}, {contacts} contact")), "{said}");
        // What is written is the same scene in the same box, or refused.
        good(folder, &["scene", name, "-o", "again.xyz"]);
        let printed = good(folder, &["scene", name]).stdout;
        assert_eq!(printed, std::fs::read_to_string(folder.join("again.xyz")).unwrap());
        let [before, after] =
            [name, "again.xyz"].map(|name| good(folder, &["detect", name]).stdout);
        assert_eq!(before, after);
        refused(folder, &["scene", name, "-o", "again.csv"], &["only .xyz files hold one"]);
        good(folder, &["scene", name, "--open", "-o", "again.csv"]);
    }
    assert_eq!(good(folder, &["detect", "tilted.dump", "--open"]).stdout, "i,j\n0,1\n");
    assert_eq!(good(folder, &["detect", "tilted.dump", "--periodic", "none"]).stdout, "i,j\n0,1\n");
    good(folder, &["verify", "tilted.dump", "--pairs", "list.csv", "--open"]);
    // What was written has no box any more.
    good(folder, &["scene", "cube.xyz", "--open", "-o", "open.xyz"]);
    assert_eq!(good(folder, &["detect", "open.xyz"]).stdout, "i,j\n");
    // A generated scene and its file are one.
    let spec = "loose:n=40,periodic=true,tilt=0.25,fraction=0.5,order=generated";
    good(folder, &["scene", spec, "-o", "loose.xyz"]);
    let [made, read] = [spec, "loose.xyz"].map(|name| good(folder, &["detect", name]).stdout);
    assert_eq!(made, read);
    assert!(made.starts_with("i,j,sx,sy\n"), "{made}");
}

#[test]
fn experiments_take_the_box_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    file(folder, "bare.csv", "x,y,z,r\n0.25,1,1,0.5\n3.25,1,1,0.5\n");
    file(folder, "discs.csv", "x,y,r\n0.25,1,0.5\n3.25,1,0.5\n");
    let experiment = |keys: &str| {
        let text = format!(
            "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
             0\ndetectors = [\"nbs\"]\n[[scene]]\nname = \"file\"\n{keys}"
        );
        file(folder, "t.toml", text);
    };
    for (keys, contacts) in [
        ("path = \"tilted.dump\"\n", 2),
        ("path = \"tilted.dump\"\nopen = true\n", 1),
        ("path = \"tilted.dump\"\nopen = \"true\"\n", 1),
        ("path = \"tilted.dump\"\nperiodic = \"none\"\n", 1),
        ("path = \"tilted.dump\"\nperiodic = \"x\"\n", 1),
        ("path = \"bare.csv\"\n", 0),
        ("path = \"bare.csv\"\nbox = \"4,4,4\"\n", 1),
        ("path = \"discs.csv\"\nbox = \"4,4\"\nperiodic = true\n", 1),
        ("path = \"bare.csv\"\nbox = \"4,4,4\"\nperiodic = \"yz\"\n", 0),
    ] {
        experiment(keys);
        let ended = run(folder, &["run", "t.toml", "--out", "out"]);
        assert_eq!(ended.code, Some(0), "{keys}: {}{}", ended.stdout, ended.stderr);
        let row = counted(folder);
        assert_eq!((&row["contacts"], &row["outcome"]), (&json!(contacts), &json!("ok")), "{keys}");
        let made = row["counts"]["ghost_made"].as_u64().unwrap();
        let repeats = !keys.contains("open") && !keys.contains("none");
        assert!(made == 0 || repeats, "{keys}: {made}");
    }
    // Where the file does not say whether its box repeats, that is said.
    file(folder, "p.lmp", DATA);
    for (keys, said) in [("", true), ("open = true\n", false), ("periodic = \"xy\"\n", false)] {
        experiment(&format!("path = \"p.lmp\"\n{keys}"));
        let ended = run(folder, &["run", "t.toml", "--out", "out"]);
        assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
        let words = "p.lmp: the file does not say whether its box repeats: boundaries are taken as \
                     open; say periodic = \"xyz\" in the experiment if it does, and open = true if \
                     not\n";
        assert_eq!(ended.stderr.contains(words), said, "{}", ended.stderr);
        std::fs::remove_dir_all(folder.join("out")).unwrap();
    }
    // Once, and of the frame that is read.
    let frame = |flags: &str| TILTED.replace(" pp pp ff", flags);
    file(folder, "two.dump", frame("") + &frame(" pp pp ff"));
    for (frame, said) in [("0", 1), ("1", 0)] {
        experiment(&format!("path = \"two.dump\"\nframe = \"{frame}\"\nseed = [1, 2]\n"));
        let ended = run(folder, &["run", "t.toml", "--out", "out"]);
        let words = "two.dump: the file does not say";
        assert_eq!(ended.stderr.matches(words).count(), said, "{}", ended.stderr);
        std::fs::remove_dir_all(folder.join("out")).unwrap();
    }
    experiment("path = \"tilted.dump\"\nopen = 1\n");
    refused(folder, &["run", "t.toml", "--out", "out"], &["open is 1; it must be true or false"]);
    let scene = ["scene", "file:path=tilted.dump,order=generated,open=true"];
    assert!(good(folder, &scene).stdout.starts_with("x,y,z,r\n1.0,1.0,1.0,0.5\n"));
}

#[test]
fn nobody_is_left_to_guess_about_a_data_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "p.lmp", DATA);
    let unknown = "the file does not say whether its box repeats: boundaries are taken as open; \
                   say --periodic xyz if it does, and --open if not";
    file(folder, "none.csv", "i,j\n");
    let verify = ["verify", "--pairs", "none.csv"];
    for verb in [&["detect"][..], &["inspect"], &["scene"], &verify] {
        let ended = run(folder, &[verb, &["p.lmp"]].concat());
        let said = ended.stdout + &ended.stderr;
        assert_eq!(said.matches(unknown).count(), 1, "{verb:?}: {said}");
        let ended = run(folder, &[verb, &["p.lmp", "--open"]].concat());
        assert!(!ended.stderr.contains("box"), "{}", ended.stderr);
    }
    // Also where a scene is named so.
    let of_scene = "file:path=p.lmp: the file does not say whether its box repeats: boundaries are \
                    taken as open; say periodic=xyz if it does, and open=true if not\n";
    let check = ["check", "--detector", "direct", "--scene"];
    for verb in [&["detect"][..], &["scene"], &["draw", "-o", "p.svg"], &check] {
        let ended = good(folder, &[verb, &["file:path=p.lmp"]].concat());
        assert_eq!(ended.stderr.matches(of_scene).count(), 1, "{}", ended.stderr);
        let ended = good(folder, &[verb, &["file:path=p.lmp,open=true"]].concat());
        assert!(!ended.stderr.contains("box"), "{}", ended.stderr);
    }
    file(folder, "plane.xyz", CUBE.replace("1 1 0.5", "1 0 0.5"));
    let ended = good(folder, &["detect", "file:path=plane.xyz"]);
    assert!(ended.stderr.contains("if these are discs, give dim=2\n"), "{}", ended.stderr);
    let found = json_of(folder, &["inspect", "p.lmp", "--json"]);
    assert_eq!(found["warnings"], json!([unknown]));
    assert_eq!(found["periodic"], json!([false, false, false]));
    let text = good(folder, &["inspect", "p.lmp"]).stdout;
    let line = "taken as open: the file does not say whether its box repeats\n";
    assert!(text.contains(line), "{text}");
    let found = json_of(folder, &["inspect", "p.lmp", "--periodic", "xy", "--json"]);
    assert_eq!(found["box_vectors"][0], json!([4.0, 0.0, 0.0]));
    assert_eq!(found["periodic"], json!([true, true, false]));
    let ended = refused(folder, &["trace", "nbs", "p.lmp", "--periodic", "xy"], &[]);
    assert_eq!(ended.stderr, format!("contactbench: p.lmp: {OPEN}"));
}

#[test]
fn discs_in_a_box_come_back_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = "packed:dim=2,n=12,periodic=true";
    good(folder, &["scene", scene, "-o", "discs.xyz"]);
    let (text, pairs) = (
        std::fs::read_to_string(folder.join("discs.xyz")).unwrap(),
        good(folder, &["detect", scene, "-o", "pairs.csv"]),
    );
    assert!(pairs.stderr.contains("the box, which repeats along x and y"), "{}", pairs.stderr);
    let of = |keys: &str| format!("file:path=discs.xyz,order=generated{keys}");
    for from in ["discs.xyz", &of(""), &of(",periodic=true"), &of(",dim=2,periodic=xy")] {
        assert_eq!(good(folder, &["scene", from]).stdout, text, "{from}");
        good(folder, &["check", "--detector", "nbs", "--scene", from]);
        good(folder, &["draw", from, "-o", "discs.svg"]);
    }
    for boundaries in [&[][..], &["--periodic", "xy"], &["--periodic", "true"]] {
        let verify = ["verify", "discs.xyz", "--pairs", "pairs.csv"];
        good(folder, &[&verify, boundaries].concat());
    }
    let beyond = ["detect", "discs.xyz", "--periodic", "xyz"];
    refused(folder, &beyond, &["repeats along x and y at most"]);
}

#[test]
fn check_takes_the_box_as_other_verbs_do() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // It touches three pairs of its own images.
    file(folder, "one.csv", "x,y,z\n0.25,0.5,7\n");
    for (arguments, missed) in [
        (&["--box", "1,1,1"][..], 3),
        (&["--box", "1,1,1", "--periodic", "xz"], 2),
        (&["--box", "1,0,0,0,1,0,3,0,1"], 3),
        (&["--open"], 0),
    ] {
        let check = ["check", "--scene", "one.csv", "--radius", "0.5", "--detector"];
        good(folder, &[&check[..], &["direct"], arguments].concat());
        let ended = run(folder, &[&check[..], &["nothing"], arguments].concat());
        assert_eq!(ended.code, Some(i32::from(missed > 0)), "{}", ended.stdout);
        let words = format!(": {missed} missed, 0 spurious");
        assert_eq!(ended.stdout.contains(&words), missed > 0, "{}", ended.stdout);
    }
    refused(folder, &["check", "--box", "1,1,1"], &["belong to a particle file", "--scene"]);
    let scene = ["check", "--scene", "packed:n=9", "--open"];
    refused(folder, &scene, &["--open belong to files"]);
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
    for (numbers, words) in [
        ("-5,5", "an edge of -5 is negative; write LX,LY or LX,LY,LZ"),
        ("5,-5,5,1,0,0", "an edge of -5 is negative"),
        ("nan,5", "'nan' is not a finite number"),
        ("5", "1 number is no box"),
    ] {
        let ended = run(folder, &["detect", "cube.xyz", "--box", numbers]);
        assert_eq!(ended.code, Some(2), "{numbers}");
        assert!(ended.stderr.contains(words), "{numbers}: {}", ended.stderr);
    }
    // Verbs that take boundaries as open do not offer boxes.
    for (verb, offers) in
        [("check", true), ("detect", true), ("draw", true), ("scene", true), ("trace", false)]
    {
        let help = good(folder, &[verb, "--help"]).stdout;
        assert!(help.contains("--open"), "{help}");
        assert_eq!([help.contains("--box"), help.contains("--periodic")], [offers; 2], "{help}");
    }
    // Other numbers may be negative.
    let found = json_of(folder, &["inspect", "cube.xyz", "--box", "4,4,4,-1,0,0", "--json"]);
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
            "tilted.dump: N = 4, 3D, 2 pairs, 1 of them across the box, which repeats along x and y",
            " (1 image made), ",
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
        "POINTS 6 double\n1.0 1.0 1.0\n",
        "\n2.5 3.25 3.0\n1.5 -0.75 3.0\n2.5 4.25 3.0\nLINES 3 9\n2 0 1\n2 2 4\n2 3 5\nPOINT_DATA 6\n",
        "default\n0.5\n0.5\n0.5\n0.5\n0.0\n0.0\nSCALARS image int 1\nLOOKUP_TABLE \
         default\n0\n0\n0\n0\n1\n1\n",
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
        text.contains(
            "POINTS 4 double\n0.25 1.0 0.0\n3.25 1.0 0.0\n-0.75 1.0 0.0\n4.25 1.0 0.0\nLINES 2 6\n"
        ),
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
    // The sorted list of 780 contacts has 20 bytes for each.
    let heap = ["detect", "heap.csv", "--box", "9,9", "--detector", "direct", "--memory-limit"];
    refused(folder, &[&heap[..], &["15599"]].concat(), &["780 touching pairs", "15599 bytes"]);
    good(folder, &[&heap[..], &["15600"]].concat());
    let many = ["detect", "cube.xyz", "--box", "1e-3,1,1", "--memory-limit", "400KiB"];
    refused(folder, &many, &["cube.xyz: ", "limit"]);
    // A plane of LAMMPS is periodic along z, too: whoever reads it in 3D is told.
    file(folder, "plane.xyz", CUBE.replace("1 1 0.5", "1 0 0.5"));
    let said = "plane.xyz: z is 0 for all, and the box repeats along z: if these are discs, give \
                --dim 2\n";
    assert!(good(folder, &["detect", "plane.xyz"]).stderr.starts_with(said));
    for dim in ["2", "3"] {
        assert!(!good(folder, &["detect", "plane.xyz", "--dim", dim]).stderr.contains("z is 0"));
    }
}
