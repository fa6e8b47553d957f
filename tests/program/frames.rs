//! `--frame all`: files of many frames through `track`, `detect`, `verify` and `inspect`.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use crate::common::{file, good, refused, run};

/// Discs of radius 1 in a row that comes together and flies apart: 40 in 12 frames, in another
/// order in every frame, with ids from 1; at the steps 0, 50, ... Those of every third column stay.
fn place(k: usize, i: usize) -> [f64; 2] {
    let (x, y) = ((i % 8) as f64 * 2.25, (i / 8) as f64 * 2.0);
    let swing = [0.0, 0.25, 0.5, 0.75, 0.5, 0.25][k % 6];
    if i.is_multiple_of(3) { [x, y] } else { [x - swing, y + 0.125 * swing] }
}

fn dump(frames: usize, flags: &str) -> String {
    let mut text = String::new();
    for k in 0..frames {
        let _ = write!(
            text,
            "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n40\nITEM: BOX BOUNDS {flags}\n-2 18\n-1.5 \
             10\n-2 2\nITEM: ATOMS id radius x y z\n",
            50 * k
        );
        for at in 0..40 {
            let i = (at * 7 + k * 11) % 40;
            let [x, y] = place(k, i);
            let _ = writeln!(text, "{} 1 {x} {y} 0", i + 1);
        }
    }
    text
}

/// Its contacts by ids, as LAMMPS writes them, at every second frame; `left_out` names what is
/// missing: frame and the place of the pair.
fn local(frames: usize, left_out: &[(usize, usize)]) -> String {
    let mut text = String::new();
    for k in (0..frames).step_by(2) {
        let mut pairs = Vec::new();
        for (i, j) in (0..40).flat_map(|i| (i + 1..40).map(move |j| (i, j))) {
            let ([ax, ay], [bx, by]) = (place(k, i), place(k, j));
            if (ax - bx) * (ax - bx) + (ay - by) * (ay - by) <= 4.0 {
                pairs.push(format!("{} {}\n", j + 1, i + 1));
            }
        }
        let wrong = left_out.iter().filter(|(frame, _)| *frame == k);
        wrong.for_each(|&(_, at)| drop(pairs.remove(at)));
        let _ = write!(
            text,
            "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ENTRIES\n{}\nITEM: BOX BOUNDS ff ff ff\n-2 18\n\
             -1.5 10\n-2 2\nITEM: ENTRIES c_p[1] c_p[2]\n{}",
            50 * k,
            pairs.len(),
            pairs.concat()
        );
    }
    text
}

/// Without its last line.
fn without_last(text: &str) -> &str {
    &text[..=text.trim_end().rfind('\n').unwrap()]
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let ended = run(folder, &[arguments, &["--json"]].concat());
    assert_eq!(ended.code.filter(|code| *code < 2), ended.code, "{}", ended.stderr);
    serde_json::from_str(&ended.stdout).unwrap_or_else(|_| panic!("{}", ended.stdout))
}

/// What a file holds is followed as it is, whatever the order of its rows; a motion moves one
/// frame.
#[test]
fn trackers_follow_the_frames_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.dump", dump(12, "ff ff ff"));
    let trackers = ["--tracker", "verlet(nbs,rule=every-4,skin=0)", "--tracker", "verlet(nbs)"];
    let of =
        |arguments: &[&str]| json(folder, &[&["track", "t.dump"], arguments, &trackers].concat());
    let found = of(&[]);
    assert_eq!([&found["frames"], &found["particles"]], [12, 40]);
    assert_eq!(found["motion"], "as recorded");
    let [every, half] = [&found["trackers"][0], &found["trackers"][1]];
    assert_eq!([&half["missed"], &half["spurious"], &every["built"]], [0, 0, 3]);
    assert!(every["missed"].as_u64() > Some(10), "{every}");
    // Every third stays in all eleven steps.
    assert_eq!(found["at_rest"], 11 * 14);
    assert!(found["born"].as_u64() > Some(10) && found["ended"].as_u64() > Some(10), "{found}");
    assert_eq!([&of(&["--frames", "5"])["frames"], &of(&["--frame", "all"])["frames"]], [5, 12]);
    let moved = of(&["--motion", "rest", "--frame", "3", "--frames", "4"]);
    assert_eq!([&moved["frames"], &moved["born"]], [4, 0]);
    assert_eq!(moved["motion"], "rest");
    assert_eq!(of(&["--frame", "3"])["motion"], "drift:speed=0.01,seed=1");
    // The same places in an array, in one order and without ids.
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (12, 40, 2), }\n";
    let mut bytes = [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..]].concat();
    bytes.extend(header.bytes());
    let places = (0..12).flat_map(|k| (0..40).flat_map(move |i| place(k, i)));
    places.for_each(|x| bytes.extend(x.to_le_bytes()));
    file(folder, "t.npy", &bytes);
    let array = json(folder, &[&["track", "t.npy", "--radius", "1"][..], &trackers].concat());
    for key in ["contacts", "born", "ended", "at_rest", "tunnelled", "longest_way"] {
        assert_eq!(array[key], found[key], "{key}");
    }
    for (one, other) in [(0, "missed"), (0, "latest"), (1, "built")] {
        assert_eq!(array["trackers"][one][other], found["trackers"][one][other], "{other}");
    }
}

#[test]
fn what_is_no_motion_is_refused_with_its_frame() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let three = dump(3, "ff ff ff");
    file(folder, "other.dump", three.replacen("\n40 1 ", "\n41 1 ", 2).replacen("41 1", "40 1", 1));
    let words = "other.dump: frame 1 (step 50): there is no particle of id 40; a motion is of the \
                 same particles: write all of them in every frame, or take those before (--frames)";
    refused(folder, &["track", "other.dump"], &[words]);
    good(folder, &["track", "other.dump", "--frames", "1"]);
    file(folder, "box.dump", dump(2, "pp ff ff") + &dump(3, "pp pp ff"));
    let words = "frame 2 (step 0): the box repeats along x and y, and along x in the first frame";
    refused(folder, &["track", "box.dump"], &[words]);
    file(folder, "cut.dump", without_last(&three));
    refused(folder, &["track", "cut.dump"], &["cut.dump ends after 39 of the 40 atoms"]);
    for verb in ["recommend", "draw", "scene"] {
        let out = if verb == "recommend" { &[][..] } else { &["-o", "out.csv"] };
        let all = [&[verb, "other.dump", "--frame", "all"], out].concat();
        let ended = run(folder, &all);
        assert_eq!(ended.code, Some(2), "{verb}: {}", ended.stderr);
    }
    let words = ["t: one frame is wanted here; give --frame a number from 0, or last"];
    let words = words.map(|text| text.replacen('t', "other.dump", 1));
    refused(folder, &["scene", "other.dump", "--frame", "all"], &[&words[0]]);
    refused(folder, &["detect", "packed:n=9", "--frame", "all"], &["belong to files"]);
}

/// What another code left out is found frame by frame, by the steps of the files.
#[test]
fn lists_of_all_frames_are_compared_by_their_steps() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.dump", dump(12, "ff ff ff"));
    let verify = ["verify", "t.dump", "--pairs", "l.dump", "--frame", "all"];
    file(folder, "l.dump", local(12, &[]));
    let said = good(folder, &verify).stdout;
    assert!(
        said.contains("the same in 6 frames: no pair is missed, spurious or repeated"),
        "{said}"
    );
    assert!(said.contains("left out, without a list: 6 frames of the particles: 1 3 5 7 9 11"));
    assert_eq!(json(folder, &verify)["paired_by"], "step");

    // One that is listed in the next; then one that never is.
    file(folder, "l.dump", local(12, &[(2, 3), (10, 0)]));
    let ended = run(folder, &verify);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let found = json(folder, &verify);
    assert_eq!([&found["errors"]["missed"], &found["errors"]["spurious"]], [2, 0]);
    assert_eq!([&found["first_wrong_frame"], &found["frames_missed"]], [2, 2]);
    assert_eq!([&found["never_reported"], &found["latest"]], [1, 1]);
    let frames = found["frames"].as_array().unwrap();
    let missed: Vec<u64> =
        frames.iter().map(|frame| frame["errors"]["missed"].as_u64().unwrap()).collect();
    assert_eq!(missed, [0, 1, 0, 0, 0, 1]);
    assert!(ended.stdout.lines().all(|line| !line.ends_with(' ')), "{}", ended.stdout);
    for words in ["2 of 6 frames differ", "1 contact missed to its end", "deepest missed", " 500  "]
    {
        assert!(ended.stdout.contains(words), "no '{words}' in {}", ended.stdout);
    }
    // One frame by itself is what it was, and another step is no list of it.
    fn one<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
        [&["verify", "t.dump", "--pairs", "l.dump"], arguments].concat()
    }
    let of_step = json(folder, &one(&["--frame", "4", "--pairs-frame", "2"]));
    assert_eq!(of_step["errors"], frames[2]["errors"]);
    let words = "l.dump: the list is of step 400, the particles of frame 4 (step 200) in t.dump; \
                 give --frame all, which brings them together, or --pairs-frame K for the list";
    refused(folder, &one(&["--frame", "4"]), &[words]);
    let said = run(folder, &one(&["--frame", "4", "--pairs-frame", "1"])).stderr;
    assert!(
        said.contains("the list is of step 100, the particles of frame 4 (step 200)"),
        "{said}"
    );
    refused(folder, &one(&["--frame", "all", "--pairs-frame", "1"]), &["leave one out"]);
    // The last is taken, and it is said what else there is.
    file(folder, "t.dump", dump(11, "ff ff ff"));
    let said = run(folder, &one(&[])).stderr;
    assert!(said.contains("t.dump: --frame all compares each of them"), "{said}");

    let shifted = local(12, &[]).replace("TIMESTEP\n200", "TIMESTEP\n210");
    file(folder, "l.dump", shifted);
    let words = "l.dump: the list of step 210 has no particles: up to there t.dump has the steps \
                 0 50 100 150 200 250; write both at the same steps";
    refused(folder, &verify, &[words]);
}

/// A thousand frames are not a thousand lines, and the first that is wrong is among those shown.
#[test]
fn of_many_frames_the_worst_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.dump", dump(60, "ff ff ff"));
    let wrong: Vec<(usize, usize)> =
        (4..60).step_by(2).flat_map(|k| vec![(k, 0); 1 + k / 20]).collect();
    file(folder, "l.dump", local(60, &wrong));
    let ended = run(folder, &["verify", "t.dump", "--pairs", "l.dump", "--frame", "all"]);
    let rows = ended.stdout.lines().skip_while(|line| !line.contains("touching  listed")).skip(1);
    let rows: Vec<&str> = rows.take_while(|line| !line.starts_with('(')).collect();
    assert_eq!((ended.code, rows.len()), (Some(1), 12), "{}", ended.stdout);
    assert!(rows[0].trim_start().starts_with("200 "), "{}", ended.stdout);
    assert!(rows[1].trim_start().starts_with("1000 "), "{}", ended.stdout);
    let words = "(12 of 30 frames: of 28 that differ the first and the worst; --json has all)";
    assert!(ended.stdout.contains(words), "{}", ended.stdout);
}

/// An unsorted dump lists the particles otherwise in each frame: ids name the same contact.
#[test]
fn contacts_of_all_frames_are_named_by_id() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let frame = |step: u32, rows: &str| {
        format!(
            "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS ff ff ff\n0 9\n0 \
             9\n0 9\nITEM: ATOMS id x y z radius\n{rows}"
        )
    };
    let text = frame(0, "7 1 1 1 0.5\n9 1.75 1 1 0.5\n8 5 5 5 0.5\n")
        + &frame(1, "8 5 5 5 0.5\n9 1.5 1 1 0.5\n7 1 1 1 0.5\n");
    file(folder, "u.dump", &text);
    let all = ["detect", "u.dump", "--frame", "all"];
    let ended = good(folder, &all);
    assert_eq!(ended.stdout, "frame,id1,id2\n0,7,9\n1,7,9\n");
    assert!(ended.stderr.contains("by id (--places"), "{}", ended.stderr);
    let places = good(folder, &[&all[..], &["--places"]].concat()).stdout;
    assert_eq!(places, "frame,i,j\n0,0,1\n1,1,2\n");
    let with = ["--with", "overlap,normal,ids"];
    let text = good(folder, &[&["detect", "u.dump"][..], &with].concat()).stdout;
    let row = "1,2,0.5,1.0,-1.0,0.0,0.0,9,7";
    assert_eq!(text, format!("i,j,overlap,depth,nx,ny,nz,id1,id2\n{row}\n"));
    // By id the smaller stands first, and the normal goes from it to the other.
    let text = good(folder, &[&["detect", "u.dump", "--ids"][..], &with].concat()).stdout;
    assert_eq!(text, "id1,id2,overlap,depth,nx,ny,nz\n7,9,0.5,1.0,1.0,0.0,0.0\n");
    for list in ["l.csv", "l.npy"] {
        good(folder, &[&all[..], &["-o", list]].concat());
        let verify = ["verify", "u.dump", "--pairs", list, "--frame", "all"];
        let ids = if list == "l.npy" { &["--ids"][..] } else { &[] };
        assert_eq!(json(folder, &[&verify[..], ids].concat())["same"], true, "{list}");
    }
    // Across a box: the image belongs to the second, whichever that is.
    let boxed = ["detect", "u.dump", "--ids", "--box", "1.4,9,9", "--periodic", "x"];
    let text = good(folder, &[&boxed[..], &["--with", "overlap"]].concat()).stdout;
    assert!(text.starts_with("id1,id2,sx,sy,sz,overlap,depth\n7,9,-1,0,0,"), "{text}");
    file(folder, "boxed.csv", text);
    let verify = ["verify", "u.dump", "--box", "1.4,9,9", "--periodic", "x", "--pairs"];
    good(folder, &[&verify[..], &["boxed.csv"]].concat());
    good(folder, &["detect", "u.dump", "--ids", "--with", "overlap,normal", "-o", "l.vtk"]);
    let lines = std::fs::read_to_string(folder.join("l.vtk")).unwrap();
    for part in
        ["SCALARS id long 1\nLOOKUP_TABLE default\n8\n9\n7\n", "CELL_DATA 1\nSCALARS overlap"]
    {
        assert!(lines.contains(part), "{part} in {lines}");
    }
    file(folder, "none.csv", "x,y,r\n0,0,1\n1,0,1\n");
    file(folder, "twice.csv", "id,x,y,r\n4,0,0,1\n4,1,0,1\n");
    refused(folder, &["detect", "none.csv", "--ids"], &["no column 'id'", "--columns id=K"]);
    refused(folder, &["detect", "twice.csv", "--with", "ids"], &["the id 4 stands there twice"]);
    refused(folder, &["detect", "packed:n=9", "--ids"], &["no column 'id'"]);
}

/// A list of another frame of the same file, alone and frame by frame.
#[test]
fn a_list_of_another_frame_is_named_by_its_frame() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for flags in ["ff ff ff", "pp ff ff"] {
        file(folder, "t.dump", dump(12, flags));
        good(folder, &["detect", "t.dump", "--frame", "5", "-o", "five.csv"]);
        let verify = ["verify", "t.dump", "--pairs", "five.csv", "--frame", "2"];
        let ended = run(folder, &verify);
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        assert!(ended.stdout.contains("that of frame 5"), "{}", ended.stdout);
        let ended = run(folder, &[&verify[..], &["--json"]].concat());
        let found: Value = serde_json::from_str(&ended.stdout).unwrap();
        assert_eq!(found["hint"], "--frame 5");
        // All lists one frame late: those of frame 0 to 10, called 1 to 11.
        let all = ["detect", "t.dump", "--frame", "all", "--places"];
        let text = good(folder, &all).stdout;
        let late = |line: &str| -> Option<String> {
            let (frame, rest) = line.split_once(',')?;
            let frame: u32 = frame.parse().ok()?;
            (frame < 11).then(|| format!("{},{rest}\n", frame + 1))
        };
        let head = text.lines().next().unwrap();
        let rows: String = text.lines().filter_map(late).collect();
        file(folder, "late.csv", format!("{head}\n{rows}"));
        let ended = run(folder, &["verify", "t.dump", "--pairs", "late.csv", "--frame", "all"]);
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        assert!(ended.stdout.contains("one frame before"), "{}", ended.stdout);
    }
}

/// What `detect` writes of all frames, `verify` reads; and one pair that is taken out is missed.
#[test]
fn contacts_of_all_frames_are_written_and_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (flags, columns) in [("ff ff ff", "frame,i,j"), ("pp ff ff", "frame,i,j,sx,sy,sz")] {
        file(folder, "t.dump", dump(12, flags));
        for list in ["l.csv", "l.npy"] {
            let said = {
                let detect = ["detect", "t.dump", "--frame", "all", "--places", "-o", list];
                good(folder, &detect).stderr
            };
            assert!(said.contains("t.dump: 12 frames, N = 40, 3D, "), "{said}");
            let verify = ["verify", "t.dump", "--pairs", list, "--frame", "all"];
            good(folder, &verify);
            let found = json(folder, &verify);
            assert_eq!(
                [&found["same"], &found["without_rows"]],
                [&Value::Bool(true), &Value::from(0)]
            );
        }
        let text = std::fs::read_to_string(folder.join("l.csv")).unwrap();
        assert_eq!(text.lines().next(), Some(columns));
        let printed = good(folder, &["detect", "t.dump", "--frame", "all", "--places"]).stdout;
        assert_eq!(printed, text);
        // Of each frame what is written of it alone.
        let alone = good(folder, &["detect", "t.dump", "--frame", "7"]).stdout;
        let of_seven = text.lines().filter_map(|line| line.strip_prefix("7,"));
        assert!(of_seven.eq(alone.lines().skip(1)), "{alone}");
        let at = text.lines().position(|line| line.starts_with("7,")).unwrap();
        let rest: Vec<&str> =
            text.lines().enumerate().filter(|(k, _)| *k != at).map(|(_, line)| line).collect();
        file(folder, "l.csv", rest.join("\n") + "\n");
        let found = json(folder, &["verify", "t.dump", "--pairs", "l.csv", "--frame", "all"]);
        assert_eq!([&found["errors"]["missed"], &found["errors"]["spurious"]], [1, 0]);
        assert_eq!([&found["first_wrong_frame"], &found["frames_missed"]], [7, 1]);
        let found = json(folder, &["verify", "t.dump", "--pairs", "l.csv", "--frame", "7"]);
        assert_eq!(found["errors"]["missed"], 1);
        good(folder, &["verify", "t.dump", "--pairs", "l.csv", "--frame", "8"]);
    }
    refused(folder, &["detect", "t.dump", "--frame", "all", "-o", "l.vtk"], &["give --frame K"]);
    // A frame of which no row speaks is one without contacts, also where it is the last.
    let text = std::fs::read_to_string(folder.join("l.csv")).unwrap();
    let rows = |keep: &dyn Fn(&str) -> bool| -> String {
        text.lines().filter(|line| keep(line)).map(|line| format!("{line}\n")).collect()
    };
    file(folder, "l.csv", rows(&|line| !line.starts_with("11,") && !line.starts_with("3,")));
    let found = json(folder, &["verify", "t.dump", "--pairs", "l.csv", "--frame", "all"]);
    assert_eq!(found["without_rows"], 2);
    let [three, eleven] = [3, 11].map(|k| &found["frames"][k]);
    assert_eq!(
        [&three["errors"]["missed"], &eleven["errors"]["missed"]],
        [&three["contacts"], &eleven["contacts"]]
    );
    let ended = run(folder, &["verify", "t.dump", "--pairs", "l.csv"]);
    let words =
        "l.csv: the list is of frame 10, the particles of frame 11 (step 550) in t.dump; give";
    assert!(ended.code == Some(2) && ended.stderr.contains(words), "{}", ended.stderr);
    // A file that cannot be read to its end leaves no list behind.
    file(folder, "cut.dump", without_last(&dump(12, "ff ff ff")));
    refused(folder, &["detect", "cut.dump", "--frame", "all", "-o", "new.csv"], &["39 of the 40"]);
    refused(folder, &["detect", "cut.dump", "--frame", "all", "-o", "new.npy"], &["39 of the 40"]);
    assert!(!folder.join("new.csv").exists() && !folder.join("new.npy").exists());
}

#[test]
fn the_motion_of_a_file_is_described() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.dump", dump(12, "ff ff ff"));
    let tracked = json(folder, &["track", "t.dump", "--tracker", "nbs"]);
    let found = json(folder, &["inspect", "t.dump", "--frame", "all"]);
    assert_eq!([&found["frames"], &found["frame"]], [12, 11]);
    for key in ["particles", "contacts", "born", "ended", "tunnelled", "mean_way", "longest_way"] {
        assert_eq!(found["motion"][key], tracked[key], "{key}");
    }
    let said = good(folder, &["inspect", "t.dump", "--frame", "all"]).stdout;
    let words = "12 frames of 40 particles: a particle goes";
    assert!(said.contains(words) && said.contains("35% of them stay where they are"), "{said}");
    assert!(
        !good(folder, &["inspect", "t.dump", "--frame", "last"]).stdout.contains("a particle goes")
    );
    file(folder, "box.dump", dump(2, "pp ff ff"));
    let said = good(folder, &["inspect", "box.dump", "--frame", "all"]).stdout;
    assert!(said.contains("2 frames of 40 particles: a particle goes"), "{said}");
    file(folder, "one.csv", "x,y,r\n0,0,1\n");
    let said = good(folder, &["inspect", "one.csv", "--frame", "all"]).stdout;
    assert!(said.contains("none: the file has one frame"), "{said}");
}

/// Lists that would be taken for something else are refused, or named.
#[test]
fn one_list_of_many_is_the_one_that_is_meant() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let one = "1\n\nA 0 0 0\nA 1 0 0\n".replacen('1', "2", 1);
    file(folder, "p.xyz", &one);
    file(folder, "l.csv", "step,i,j\n0,0,1\n10,0,1\n20,0,1\n");
    let verify = ["verify", "p.xyz", "--radius", "0.5", "--pairs", "l.csv"];
    let said = run(folder, &verify);
    assert_eq!(said.code, Some(0), "{}{}", said.stdout, said.stderr);
    assert!(said.stderr.contains("l.csv: the list of step 20 is read (--pairs-frame)"));
    refused(folder, &[&verify[..], &["--pairs-frame", "all"]].concat(), &["of one frame; for all"]);
    // Rows of half of the steps: there is no list of that number, and no empty one is made up.
    file(folder, "t.dump", dump(12, "ff ff ff"));
    file(folder, "late.csv", "step,i,j\n300,0,1\n550,0,1\n");
    let late = ["verify", "t.dump", "--pairs", "late.csv", "--frame", "11"];
    refused(folder, &late, &["late.csv holds 2 frames, numbered from 0; there is no frame 11"]);
    // A frame before the pair and an image of discs.
    let header = "{'descr': '<i4', 'fortran_order': False, 'shape': (1, 5), }\n";
    let mut bytes = [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..]].concat();
    bytes.extend(header.bytes());
    [0i32, 0, 1, 0, 0].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    file(folder, "l.npy", &bytes);
    file(folder, "p.csv", "x,y,r\n0,0,0.5\n1,0,0.5\n");
    let discs = ["verify", "p.csv", "--box", "9,9", "--pairs", "l.npy"];
    refused(folder, &discs, &["if the first column is the frame, give --frame all"]);
}
