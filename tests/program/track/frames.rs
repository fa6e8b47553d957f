//! Tests `--frame all`: files of many frames in `track`, `detect`, `verify` and `inspect`.

use std::fmt::Write as _;

use serde_json::Value;

use crate::common::Place;

/// Returns the centre of disc `i` in frame `k`. 40 discs of radius 1 come together and fly apart;
/// every third disc stays.
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

/// Returns the contacts of every second frame by id, as LAMMPS writes them, without the pairs in
/// `left_out`: frame, and index of the pair.
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

/// `track` follows the frames of a file, with rows in any order; a motion moves one frame instead.
#[test]
fn trackers_follow_the_frames_of_a_file() {
    let at = Place::new();
    at.file("t.dump", dump(12, "ff ff ff"));
    let trackers = "--tracker verlet(nbs,rule=every-4,skin=0) --tracker verlet(nbs)";
    let of = |more: &str| at.json(&format!("track t.dump {more} {trackers}"));
    let found = of("");
    assert_eq!([&found["frames"], &found["particles"]], [12, 40]);
    assert_eq!(found["motion"], "as recorded");
    let [every, half] = [&found["trackers"][0], &found["trackers"][1]];
    assert_eq!([&half["missed"], &half["spurious"], &every["built"]], [0, 0, 3]);
    assert!(every["missed"].as_u64() > Some(10), "{every}");
    // 14 of the 40 discs stay at rest in all eleven steps.
    assert_eq!(found["at_rest"], 11 * 14);
    assert!(found["born"].as_u64() > Some(10) && found["ended"].as_u64() > Some(10), "{found}");
    assert_eq!([&of("--frames 5")["frames"], &of("--frame all")["frames"]], [5, 12]);
    let moved = of("--motion rest --frame 3 --frames 4");
    assert_eq!(
        ([&moved["frames"], &moved["born"]], &moved["motion"]),
        ([&4.into(), &0.into()], &"rest".into())
    );
    assert_eq!(of("--frame 3")["motion"], "drift:speed=0.01,seed=1");
    // An array has the same centres, but no ids.
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (12, 40, 2), }\n";
    let mut bytes = [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..]].concat();
    bytes.extend(header.bytes());
    let places = (0..12).flat_map(|k| (0..40).flat_map(move |i| place(k, i)));
    places.for_each(|x| bytes.extend(x.to_le_bytes()));
    at.file("t.npy", &bytes);
    let array = at.json(&format!("track t.npy --radius 1 {trackers}"));
    for key in ["contacts", "born", "ended", "at_rest", "longest_way"] {
        assert_eq!(array[key], found[key], "{key}");
    }
    for (one, other) in [(0, "missed"), (0, "latest"), (1, "built")] {
        assert_eq!(array["trackers"][one][other], found["trackers"][one][other], "{other}");
    }
    // `inspect` describes the same motion as `track`.
    let inspected = at.json("inspect t.dump --frame all");
    assert_eq!([&inspected["frames"], &inspected["frame"]], [12, 11]);
    for key in ["particles", "contacts", "born", "ended", "mean_way", "longest_way"] {
        assert_eq!(inspected["motion"][key], found[key], "{key}");
    }
    at.ends(0, "inspect t.dump --frame all", &["12 frames of 40 particles", "35%"]);
    assert!(!at.good("inspect t.dump").stdout.contains("12 frames of 40"));
}

/// `verify` pairs frames with lists by time step, and finds the missing contacts.
#[test]
fn lists_of_all_frames_are_compared_by_their_steps() {
    let at = Place::new();
    at.file("t.dump", dump(12, "ff ff ff"));
    let verify = "verify t.dump --pairs l.dump --frame all";
    at.file("l.dump", local(12, &[]));
    let left_out = ": 1 3 5 7 9 11";
    at.ends(0, verify, &["6 frames", left_out]);
    assert_eq!(at.json(verify)["paired_by"], "step");
    // One contact is reported a list late, another never.
    at.file("l.dump", local(12, &[(2, 3), (10, 0)]));
    let said = at.ends(1, verify, &["2 of 6 frames", "1 contact", " 500 "]);
    assert!(said.stdout.lines().all(|line| !line.ends_with(' ')), "{}", said.stdout);
    let found = at.json(verify);
    assert_eq!([&found["errors"]["missed"], &found["errors"]["spurious"]], [2, 0]);
    assert_eq!([&found["first_wrong_frame"], &found["frames_missed"]], [2, 2]);
    assert_eq!([&found["never_reported"], &found["latest"]], [1, 1]);
    let frames = found["frames"].as_array().unwrap();
    let missed: Vec<&Value> = frames.iter().map(|frame| &frame["errors"]["missed"]).collect();
    assert_eq!(missed, [0, 1, 0, 0, 0, 1].map(Value::from).each_ref());
    // One frame compared alone has the same result; a list of another time step is refused.
    let one = "verify t.dump --pairs l.dump";
    let of_step = at.json(&format!("{one} --frame 4 --pairs-frame 2"));
    assert_eq!(of_step["errors"], frames[2]["errors"]);
    for (more, words) in [
        ("--frame 4", "l.dump: | step 400 | frame 4 (step 200)"),
        ("--frame all --pairs-frame 1", "--pairs-frame"),
    ] {
        at.ends(2, &format!("{one} {more}"), &words.split(" | ").collect::<Vec<_>>());
    }
    at.ends(1, &format!("{one} --frame 4 --pairs-frame 1"), &["step 100"]);
    // Without --frame, `verify` uses the last frame and prints a note.
    at.file("t.dump", dump(11, "ff ff ff"));
    assert!(at.run(one).stderr.contains("t.dump: --frame all"));
}

/// `verify` reads the lists of `detect --frame all`, and reports a removed pair as missed.
#[test]
fn contacts_of_all_frames_are_written_and_read_again() {
    let at = Place::new();
    for (flags, columns) in [("ff ff ff", "frame,i,j"), ("pp ff ff", "frame,i,j,sx,sy,sz")] {
        at.file("t.dump", dump(12, flags));
        let all = "detect t.dump --frame all --places";
        for list in ["l.csv", "l.npy"] {
            at.ends(0, &format!("{all} -o {list}"), &["t.dump: 12 frames, N = 40, 3D, "]);
            let found = at.json(&format!("verify t.dump --pairs {list} --frame all"));
            assert_eq!([&found["same"], &found["without_rows"]], [&Value::from(true), &0.into()]);
        }
        let text = at.read("l.csv");
        assert_eq!((text.lines().next(), at.good(all).stdout), (Some(columns), text.clone()));
        // The list has the same contacts for a frame as `detect` finds in this frame alone.
        let alone = at.good("detect t.dump --frame 7").stdout;
        let of_seven = text.lines().filter_map(|line| line.strip_prefix("7,"));
        assert!(of_seven.eq(alone.lines().skip(1)), "{alone}");
        let keep = |keep: &dyn Fn(usize, &str) -> bool| -> String {
            let lines = text.lines().enumerate().filter(|(k, line)| keep(*k, line));
            lines.map(|(_, line)| format!("{line}\n")).collect()
        };
        let first = text.lines().position(|line| line.starts_with("7,")).unwrap();
        at.file("l.csv", keep(&|k, _| k != first));
        let found = at.json("verify t.dump --pairs l.csv --frame all");
        assert_eq!([&found["errors"]["missed"], &found["errors"]["spurious"]], [1, 0]);
        assert_eq!([&found["first_wrong_frame"], &found["frames_missed"]], [7, 1]);
        assert_eq!(at.json("verify t.dump --pairs l.csv --frame 7")["errors"]["missed"], 1);
        at.good("verify t.dump --pairs l.csv --frame 8");
        // A frame without rows is taken to have no contacts, even at the end of the list.
        at.file("l.csv", keep(&|_, line| !line.starts_with("11,") && !line.starts_with("3,")));
        let found = at.json("verify t.dump --pairs l.csv --frame all");
        assert_eq!(found["without_rows"], 2);
        for frame in [3, 11].map(|k| &found["frames"][k]) {
            assert_eq!(frame["errors"]["missed"], frame["contacts"]);
        }
        at.ends(2, "verify t.dump --pairs l.csv", &["frame 10", "frame 11"]);
    }
    // A frame number that the table does not hold is refused.
    at.file("late.csv", "step,i,j\n300,0,1\n550,0,1\n");
    let late = ["late.csv", "2 frames", "frame 11"];
    at.ends(2, "verify t.dump --pairs late.csv --frame 11", &late);
}
