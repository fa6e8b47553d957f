//! `scene`, `inspect` and `verify` as users meet them.

use std::path::Path;

use contactbench::io;
use contactbench::io::Options;
use contactbench::scene::spec::Spec;
use serde_json::Value;

use crate::common::{file, good, refused, run};

fn json(folder: &Path, arguments: &[&str], code: i32) -> Value {
    let ended = run(folder, arguments);
    assert_eq!(ended.code, Some(code), "{arguments:?}: {}{}", ended.stdout, ended.stderr);
    serde_json::from_str(&ended.stdout)
        .unwrap_or_else(|error| panic!("{arguments:?}: {error}: {}", ended.stdout))
}

/// What is written reads back to the same bits, in every format.
#[test]
fn scenes_are_written_and_read_back_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for spec in [
        "clustered:dim=3,n=300,size-ratio=7,seed=3",
        "loose:dim=2,n=200,offset=1e9",
        "packed:dim=3,n=100",
        "hard:case=subnormal-coordinates",
    ] {
        let expected = Spec::parse(spec).unwrap().make().unwrap();
        for name in ["scene.csv", "scene.xyz", "scene.npy"] {
            good(folder, &["scene", spec, "-o", name]);
            let dim = name.ends_with("npy").then_some(expected.dim() as u32);
            let found = io::scene(&folder.join(name), Options { dim, ..Options::NONE }).unwrap();
            // A list of equal radii comes back as one radius for all.
            assert_eq!(found, expected, "{spec} in {name}");
        }
        let printed = good(folder, &["scene", spec]).stdout;
        assert_eq!(printed, std::fs::read_to_string(folder.join("scene.csv")).unwrap());
    }
    // A file becomes another.
    file(
        folder,
        "two.dump",
        "ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS x y radius\n1 2 3\nITEM: NUMBER OF ATOMS\n1\nITEM: \
         ATOMS x y radius\n4 5 6\n",
    );
    good(folder, &["scene", "two.dump", "--frame", "last", "-o", "one.csv"]);
    assert_eq!(std::fs::read_to_string(folder.join("one.csv")).unwrap(), "x,y,r\n4.0,5.0,6.0\n");
    let refused = |arguments: &[&str], words: &str| {
        let ended = run(folder, arguments);
        let said = ended.code == Some(2) && ended.stderr.contains(words);
        assert!(said, "{arguments:?}: {}", ended.stderr);
    };
    refused(
        &["scene", "packed:n=10", "-o", "scene.vtk"],
        "the ending of a file of a scene must be .csv, .xyz or .npy",
    );
    refused(&["scene", "packed:n=10", "--dim", "3"], "write dim=3 and the like into the scene");
    refused(&["scene", "nowhere.csv"], "cannot read nowhere.csv");
    // All verbs take the last frame, and say so; an experiment must choose.
    for verb in ["detect", "inspect", "scene"] {
        let ended = good(folder, &[verb, "two.dump"]);
        let said = "two.dump: frame 1, the last of 0 to 1, is read (--frame)";
        assert!(ended.stderr.contains(said), "{verb}: {}", ended.stderr);
        let chosen = good(folder, &[verb, "two.dump", "--frame", "last"]);
        assert_eq!(ended.stdout, chosen.stdout, "{verb}");
        assert!(!chosen.stderr.contains("is read"), "{}", chosen.stderr);
    }
    refused(&["scene", "file:path=two.dump"], "say which one is to be read");
    refused(&["detect", "two.dump", "--frame", "second"], "it must be a number from 0, or last");
}

#[test]
fn pairs_are_written_as_lines_that_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "discs.csv", "x,y,d\n0,0,1\n1,0,1\n2.5,0.1,1.5\n");
    good(folder, &["detect", "discs.csv", "-o", "pairs.vtk"]);
    let text = std::fs::read_to_string(folder.join("pairs.vtk")).unwrap();
    assert!(
        text.contains(
            "POINTS 3 double\n0.0 0.0 0.0\n1.0 0.0 0.0\n2.5 0.1 0.0\nLINES 1 3\n2 0 1\nPOINT_DATA \
             3\n"
        ),
        "{text}"
    );
    // The points with their radii are a scene, whose pairs are the same.
    assert_eq!(
        good(folder, &["detect", "pairs.vtk", "--dim", "2"]).stdout,
        good(folder, &["detect", "discs.csv"]).stdout
    );
    // The same through the scene named file.
    let through = good(
        folder,
        &["scene", "file:path=pairs.vtk,file-dim=2,order=generated,frame=0,format=vtk"],
    )
    .stdout;
    assert_eq!(through, "x,y,r\n0.0,0.0,0.5\n1.0,0.0,0.5\n2.5,0.1,0.75\n");
}

#[test]
fn inspect_says_what_was_understood() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let frame = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n4\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 \
                 9\n0 9\nITEM: ATOMS id x y z diameter\n";
    file(
        folder,
        "p.dump",
        format!("{frame}1 0 0 0 1\n2 1 0 0 1\n3 1 0 0 1\n4 5 5 5 2\n").repeat(2),
    );
    let found = json(folder, &["inspect", "p.dump", "--json"], 0);
    for (key, value) in [
        ("format", "LAMMPS dump".into()),
        ("n", 4.into()),
        ("dim", 3.into()),
        ("frames", 2.into()),
        ("frame", 1.into()),
        ("radius_source", "diameter".into()),
        ("radius_column", "diameter".into()),
        ("radius_min", 0.5.into()),
        ("radius_mean", 0.625.into()),
        ("radius_max", 1.0.into()),
        ("coincident_centres", 1.into()),
        // 0 touches 1 and 2 exactly, which lie on each other.
        ("contacts", 3.into()),
        ("near_tangent", 2.into()),
        ("coordination", 1.5.into()),
        ("f32_missed", 0.into()),
    ] as [(&str, Value); 15]
    {
        assert_eq!(found[key], value, "{key} in {found:#}");
    }
    let warnings = found["warnings"].to_string();
    for part in
        ["the file has 2 frames", "1 particles have the centre of another, such as particle"]
    {
        assert!(warnings.contains(part), "{warnings}");
    }
    let text = good(folder, &["inspect", "p.dump", "--frame", "0"]).stdout;
    for part in [
        "4 spheres (3D)",
        "2; read: frame 0",
        "'diameter' in the file, a diameter, halved",
        "warning: the file has 2 frames",
        "3 (exact;",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

/// What else is doubted is in doubts.rs.
#[test]
fn inspect_counts_what_it_cannot_list_and_says_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "centres.csv", "x,y\n0,0\n1,0\n");
    let text = good(folder, &["inspect", "centres.csv"]).stdout;
    for part in ["2 discs (2D)", "none in the file; contacts need --radius R"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    file(folder, "none.csv", "x,y,r\n");
    let none = json(folder, &["inspect", "none.csv", "--json"], 0);
    assert!(none["warnings"].to_string().contains("there are no particles"), "{none}");
    // All on one place: half a billion contacts are not listed.
    file(folder, "heap.csv", format!("x,y,r\n{}", "0,0,1\n".repeat(20_000)));
    let heap = json(folder, &["inspect", "heap.csv", "--json"], 0);
    assert_eq!(heap["coordination"], 19_999.0);
}

#[test]
fn verify_compares_lists_of_every_kind() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // A row of discs that just touch, with ids from 10 downwards.
    let rows: String = (0..6).map(|k| format!("{} {k} 0 0.5\n", 10 - k)).collect();
    file(
        folder,
        "row.dump",
        format!("ITEM: NUMBER OF ATOMS\n6\nITEM: ATOMS id x y radius\n{rows}"),
    );
    let pairs = [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5]];
    let listed = |name: &str, head: &str, line: &dyn Fn(i64, i64) -> String| {
        file(folder, name, format!("{head}{}", pairs.map(|[i, j]| line(i, j)).concat()));
    };
    listed("zero.csv", "i,j\n", &|i, j| format!("{j},{i}\n"));
    listed("one.txt", "# contacts\n", &|i, j| format!("{} {} 0.1\n", i + 1, j + 1));
    listed("ids.csv", "", &|i, j| format!("{},{}\n", 10 - i, 10 - j));
    let tail = "0 0 0 0 0 0 0 0 0 0 0";
    listed("both.fstat", "# 0 1\n# \n# \n", &|i, j| {
        format!("0 {i} {j} {tail}\n0 {j} {i} {tail}\n0 {i} -1 {tail}\n")
    });
    let local =
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n5\nITEM: ENTRIES index c_1[1] c_1[2]\n";
    listed("local.dump", local, &|i, j| format!("1 {} {}\n", 10 - i, 10 - j));
    good(folder, &["detect", "row.dump", "-o", "own.npy"]);
    for arguments in [
        &["zero.csv"][..],
        &["zero.csv", "--base", "0"],
        &["one.txt", "--base", "1"],
        &["zero.csv", "--pairs-columns", "j,i"],
        &["ids.csv", "--ids"],
        &["both.fstat"],
        &["local.dump"],
        &["local.dump", "--pairs-columns", "c_1[2],c_1[1]"],
        &["own.npy"],
    ] {
        let verify = [&["verify", "row.dump", "--json", "--pairs"], arguments].concat();
        let found = json(folder, &verify, 0);
        assert_eq!([&found["reported"], &found["contacts"]], [5, 5], "{arguments:?}: {found:#}");
        assert_eq!(found["same"], true);
    }
    let both = good(folder, &["verify", "row.dump", "--pairs", "both.fstat"]).stdout;
    assert!(
        both.contains("from both sides and taken once, 5 contacts with walls left out\nthe same:"),
        "{both}"
    );

    // Wrong numbers are guessed.
    for (list, flag) in [("one.txt", "--base 1"), ("ids.csv", "--ids")] {
        let found = json(folder, &["verify", "row.dump", "--pairs", list, "--json"], 1);
        assert_eq!(found["hint"], flag, "{found:#}");
    }
    assert_eq!(
        json(folder, &["verify", "row.dump", "--pairs", "zero.csv", "--base", "1", "--json"], 1)["hint"],
        "--base 0"
    );
}

/// Lists with the usual mistakes: the hint names the options with which they agree.
#[test]
fn verify_recognises_the_usual_mistakes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    good(folder, &["scene", "packed:dim=3,n=64,lattice=cubic,order=generated", "-o", "p.csv"]);
    let pairs = good(folder, &["detect", "p.csv"]).stdout;
    let pairs: Vec<[i64; 2]> = pairs
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').unwrap())
        .map(|(i, j)| [i.parse().unwrap(), j.parse().unwrap()])
        .collect();
    let listed = |name: &str, base: i64, both: bool| {
        let line = |[i, j]: [i64; 2]| format!("{},{}\n", i + base, j + base);
        let turned = |[i, j]: [i64; 2]| if both { line([j, i]) } else { String::new() };
        let text: String = pairs.iter().map(|&pair| line(pair) + &turned(pair)).collect();
        file(folder, name, text);
    };
    listed("one.csv", 1, false);
    listed("both.csv", 1, true);
    // Every pair less than 1.3 apart; the pack has diameters of 1.
    let wider = std::fs::read_to_string(folder.join("p.csv")).unwrap().replace(",0.5\n", ",0.65\n");
    file(folder, "wider.csv", wider);
    good(folder, &["detect", "wider.csv", "-o", "skin.csv"]);
    let all = pairs.len();
    for (list, words) in [
        ("one.csv", format!("hint: with numbers from 1, all {all} pairs agree: add --base 1\n")),
        ("both.csv", format!("all {all} pairs agree: add --base 1 --both-sides\n")),
        ("skin.csv", "pairs agree: add --skin 0.".into()),
    ] {
        let verify = ["verify", "p.csv", "--pairs", list];
        let ended = run(folder, &verify);
        assert!(ended.stdout.contains(&words), "'{words}' in:\n{}", ended.stdout);
        // What would be said of the wrong reading helps nobody.
        assert!(!ended.stdout.contains("the worst first"), "{}", ended.stdout);
        let found = json(folder, &[&verify[..], &["--json"]].concat(), 1);
        let flags: Vec<&str> = found["hint"].as_str().unwrap().split(' ').collect();
        assert_eq!(json(folder, &[&verify[..], &["--json"], &flags].concat(), 0)["same"], true);
    }
}

#[test]
fn verify_shows_what_differs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "p.csv", "x,y,r\n0,0,1\n1,0,1\n3,0,1\n10,0,1\n20,0,1\n");
    // True are 0,1 (overlap of one radius) and 1,2 (tangent).
    file(folder, "theirs.csv", "i,j\n2,1\n1,2\n3,3\n2,3\n0,4\n1,9\n");
    let ended = run(folder, &["verify", "p.csv", "--pairs", "theirs.csv"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    for part in [
        "p.csv: 5 particles, 2 touching pairs (exact arithmetic)",
        "theirs.csv: 6 pairs (CSV; places in the file, from 0)",
        "missed       1  deepest overlap 1 mean radii",
        "spurious     2  widest gap 18 mean radii",
        "duplicate    1",
        "with itself  1",
        "unknown      1  such as 1,9: the file has no such particle",
        "  0,1  overlap 1\n    0: 0.0 0.0 r 1.0\n    1: 1.0 0.0 r 1.0\n",
        "  0,4  gap 18\n",
    ] {
        assert!(ended.stdout.contains(part), "'{part}' in:\n{}", ended.stdout);
    }
    let found = json(folder, &["verify", "p.csv", "--pairs", "theirs.csv", "--json"], 1);
    assert_eq!(
        (&found["errors"]["missed"], &found["unknown"], &found["same"]),
        (&1.into(), &1.into(), &false.into())
    );
    assert_eq!(found["missed"][0]["bodies"][1]["centre"], serde_json::json!([1.0, 0.0]));

    // What is decided by rounding is right or wrong by the arithmetic.
    file(
        folder,
        "near.csv",
        "x,y,r\n0,0,0.5\n1.0000000000000002,0,0.5\n16777216,0,0.5\n16777217.5,0,0.5\n",
    );
    file(folder, "none.csv", "i,j\n");
    file(folder, "one.csv", "i,j\n0,1\n");
    good(folder, &["verify", "near.csv", "--pairs", "none.csv"]);
    assert_eq!(run(folder, &["verify", "near.csv", "--pairs", "one.csv"]).code, Some(1));
    good(folder, &["verify", "near.csv", "--pairs", "one.csv", "--arithmetic", "f32"]);
}

/// What the readers refuse is in the cases of crates/io/src/tests.
#[test]
fn verify_refuses_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "p.csv", "x,y,r\n0,0,1\n1,0,1\n");
    file(folder, "bad.csv", "i,j\n0,1\n0,b\n");
    file(folder, "binary.csv", b"0,1\n\0\x01");
    file(folder, "fine.csv", "0,1\n");
    for (arguments, words) in [
        (&["bad.csv"][..], "bad.csv:3: column 2: 'b' is not the number of a particle"),
        (&["binary.csv"], "binary.csv is binary, and no npy or npz file"),
        (&["bad.csv", "--base", "2"], "--base 2: it must be 0 or 1"),
        (&["bad.csv", "--pairs-columns", "a,b"], "there is no column 'a'"),
        (&["nowhere.csv"], "cannot read nowhere.csv"),
        (
            &["fine.csv", "--ids"],
            "p.csv has no column 'id' of whole numbers; give --base 0 or --base 1",
        ),
    ] {
        refused(folder, &[&["verify", "p.csv", "--pairs"], arguments].concat(), &[words]);
    }
}

/// A run writes its third frame, and the whole ones are wanted.
#[test]
fn every_verb_takes_a_whole_frame_of_a_file_that_is_being_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let frame = |step: u32, rows: &str| {
        format!(
            "ITEM: TIME\n0.25\nITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp \
             pp pp\n0 10\n0 10\n0 10\nITEM: ATOMS id type x y z\n{rows}"
        )
    };
    let whole = frame(0, "1 1 0.25 5 5\n2 1 9.75 5 5\n");
    file(folder, "cut.dump", &(whole + &frame(100, "2 1 9.")));
    file(folder, "pairs.csv", "i,j\n0,1\n");
    let taken = |verb: &str, more: &[&str]| {
        run(folder, &[&[verb, "cut.dump", "--radius", "0.5"], more].concat())
    };
    for (verb, more) in [
        ("inspect", &["--frame", "0"][..]),
        ("detect", &["--frame", "0"]),
        ("draw", &["--frame", "0", "-o", "cut.svg"]),
        ("verify", &["--frame", "0", "--pairs", "pairs.csv"]),
        ("track", &["--frames", "1"]),
        ("scene", &["--frame", "0", "--open", "-o", "cut.csv"]),
    ] {
        let ended = taken(verb, more);
        assert_eq!(ended.code, Some(0), "{verb}: {}{}", ended.stdout, ended.stderr);
    }
    assert!(taken("inspect", &["--frame", "0"]).stdout.contains("a later one is not"));
    for (verb, more) in [
        ("inspect", &[][..]),
        ("inspect", &["--frame", "all"]),
        ("detect", &["--frame", "last"]),
        ("detect", &["--frame", "all"]),
        ("track", &[]),
    ] {
        let ended = taken(verb, more);
        assert_eq!(ended.code, Some(2), "{verb}: {}{}", ended.stdout, ended.stderr);
        let remedy = "take --frame 0, or all with head -n 13 cut.dump";
        assert!(ended.stderr.contains(remedy), "{verb}: {}", ended.stderr);
    }
}
