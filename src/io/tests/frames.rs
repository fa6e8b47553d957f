//! Frames one after the other: of particles, and of contact lists.

use super::*;
use crate::io::pairs::{self, List};

/// Frames as they are told: number, step, time, ids, and the x of every particle in the order of
/// ids; then how they end.
type Told = (Vec<(u64, Option<i64>, Option<f64>, Vec<i64>, Vec<f64>)>, String);

fn all(bytes: &[u8], ending: &str, options: Options) -> Told {
    let options = Options { ids: true, frame: Frame::All, ..options };
    let mut told = Vec::new();
    let end = frames_from(bytes, "p", ending, options, |frames| {
        for frame in frames {
            let (mut particles, about) = frame?;
            particles.sort_by_id()?;
            let x = (0..particles.len()).map(|k| particles.centre(k)[0]).collect();
            let ids = particles.ids().unwrap_or_default().to_vec();
            told.push((about.frame, about.step, about.time, ids, x));
        }
        Ok(())
    });
    (told, end.map_or_else(|error| format!("{error:#}"), |()| String::new()))
}

/// The frame that is chosen, by the x of its first particle, its number, and the number of frames.
fn one(bytes: &[u8], ending: &str, frame: Frame, survey: bool) -> Result<(f64, u64, u64), String> {
    let options = Options { frame, survey, ..HALF };
    let read = load_from(bytes, "p", ending, options).map_err(|error| format!("{error:#}"));
    read.map(|(particles, about)| (particles.centre(0)[0], about.frame, about.frames))
}

fn dump(step: i64, rows: &str) -> String {
    let n = rows.lines().count();
    format!("ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{n}\nITEM: ATOMS id x y z\n{rows}")
}

fn cube(values: usize) -> Vec<u8> {
    let data: Vec<f64> = (0..values).map(|k| (k / 4 * 10 + k % 4) as f64).collect();
    npy_file("<f8", "False", "(3, 2, 2)", &doubles(&data))
}

#[test]
fn all_formats_of_frames_give_them_one_by_one() {
    let text = dump(0, "1 0 0 0\n2 1 0 0\n") + &dump(50, "2 11 0 0\n1 10 0 0\n");
    let text = text + &dump(75, "2 21 0 0\n7 27 0 0\n1 20 0 0\n");
    let frames = vec![
        (0, Some(0), None, vec![1, 2], vec![0.0, 1.0]),
        (1, Some(50), None, vec![1, 2], vec![10.0, 11.0]),
        (2, Some(75), None, vec![1, 2, 7], vec![20.0, 21.0, 27.0]),
    ];
    assert_eq!(all(text.as_bytes(), "", HALF), (frames.clone(), String::new()));
    let timed = text.replace("ITEM: NUMBER", "ITEM: TIME\n0.5\nITEM: NUMBER");
    let timed = all(timed.as_bytes(), "", HALF).0;
    assert!(timed.iter().all(|frame| frame.2 == Some(0.5)), "{timed:?}");
    let packed = {
        use std::io::Write;
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), Default::default());
        packed.write_all(text.as_bytes()).unwrap();
        packed.finish().unwrap()
    };
    assert_eq!(all(&packed, "", HALF), (frames, String::new()));

    let xyz = "1\nProperties=species:S:1:pos:R:3:id:I:1 Step=4 time = 2.5D-1, E=7\nA 1 0 0 9\n\n2\n\
               Properties=species:S:1:pos:R:3:id:I:1\nA 3 0 0 9\nB 2 0 0 8\n";
    let frames = vec![
        (0, Some(4), Some(0.25), vec![9], vec![1.0]),
        (1, None, None, vec![8, 9], vec![2.0, 3.0]),
    ];
    assert_eq!(all(xyz.as_bytes(), "xyz", HALF), (frames, String::new()));

    let mercury = "1 0.5 0 0 9 9\n1 0 0 0 0.5 0 0 0\n0 1.5 0 0 9 9\n";
    let frames =
        vec![(0, None, Some(0.5), vec![], vec![1.0]), (1, None, Some(1.5), vec![], vec![])];
    assert_eq!(all(mercury.as_bytes(), "", NONE), (frames, String::new()));

    let frame = |k: u64| (k, None, None, vec![], vec![10.0 * k as f64, 10.0 * k as f64 + 2.0]);
    let frames: Vec<_> = (0..3).map(frame).collect();
    assert_eq!(all(&cube(12), "npy", HALF), (frames, String::new()));
    // The radii go with the ids.
    let sized = text.replace("id x y z", "id radius x y");
    let ids = Options { ids: true, frame: Frame::Number(2), dim: Some(2), ..NONE };
    let (mut particles, _) = load_from(sized.as_bytes(), "p", "", ids).unwrap();
    particles.sort_by_id().unwrap();
    let sizes = rows(&particles.scene("p", None).unwrap());
    assert_eq!(sizes, [[0.0, 0.0, 20.0], [0.0, 0.0, 21.0], [0.0, 0.0, 27.0]]);
    // A file that is one frame is one.
    let csv = vec![(0, None, None, vec![], vec![1.0])];
    assert_eq!(all(b"x,y\n1,2\n", "csv", HALF), (csv, String::new()));
}

#[test]
fn one_frame_is_read_by_the_same_code() {
    let text = dump(0, "1 0 0 0\n") + &dump(50, "1 10 0 0\n") + &dump(75, "1 20 0 0\n");
    for (bytes, ending) in [(text.as_bytes(), ""), (&cube(12), "npy")] {
        assert_eq!(one(bytes, ending, Frame::Number(1), true), Ok((10.0, 1, 3)));
        assert_eq!(one(bytes, ending, Frame::Number(1), false), Ok((10.0, 1, 2)));
        assert_eq!(one(bytes, ending, Frame::Number(0), false), Ok((0.0, 0, 1)));
        assert_eq!(one(bytes, ending, Frame::Last, false), Ok((20.0, 2, 3)));
        let refused = |frame| one(bytes, ending, frame, false).unwrap_err();
        assert_eq!(
            refused(Frame::Number(3)),
            "p holds 3 frames, numbered from 0; there is no frame 3"
        );
        assert!(refused(Frame::Only).contains("a second frame begins; say which one"));
        assert_eq!(
            refused(Frame::All),
            "p: one frame is wanted here; give --frame a number from 0, or last"
        );
    }
}

#[test]
fn frames_that_are_cut_off_end_the_others_in_words() {
    let text = dump(0, "1 0 0 0\n2 1 0 0\n") + &dump(50, "2 11 0 0\n1 10 0 0\n");
    let (told, end) = all(&text.as_bytes()[..text.len() - 9], "", HALF);
    let cut = "p ends after 1 of the 2 atoms that its header announces: it is cut off, or still \
    being written; frame 0 is whole: take --frame 0, or all with head -n 7 p";
    assert_eq!((told.len(), &*end), (1, cut));
    assert!(one(&text.as_bytes()[..text.len() - 9], "", Frame::Number(0), false).is_ok());
    let header = text.rfind("2\nITEM: ATOMS").unwrap();
    let (told, end) = all(&text.as_bytes()[..header], "", HALF);
    assert_eq!(told.len(), 1);
    assert!(end.starts_with("p ends in the header of a frame"), "{end}");
    let (told, end) = all(b"1\n\nA 0 0 0\n2\n\nA 0 0 0\n", "xyz", HALF);
    assert_eq!(told.len(), 1);
    assert!(end.starts_with("p ends after 1 of the 2 particles"), "{end}");
    let (told, end) = all(&cube(10), "npy", HALF);
    assert_eq!(told.len(), 2);
    assert!(end.starts_with("frame 2: p ends before the 2 x 2 numbers"), "{end}");
    assert!(one(&cube(9), "npy", Frame::Last, false).is_err());
    assert!(one(&cube(6), "npy", Frame::Number(2), false).unwrap_err().contains("ends in frame 1"));
    let (told, end) = all(&cube(13), "npy", HALF);
    assert_eq!(told.len(), 3);
    assert!(end.starts_with("p goes on after"), "{end}");
    // An error ends them, whatever follows.
    let torn = &b"1\n\nA 0 0 0\n1\n\nA x 0 0\n1\n\nA 5 0 0\n"[..];
    let options = Options { frame: Frame::All, ..HALF };
    let count = frames_from(torn, "p", "xyz", options, |frames| Ok(frames.take(9).count()));
    assert_eq!(count.unwrap(), 2, "a frame and an error");
    let twice = dump(0, "1 0 0 0\n1 1 0 0\n");
    assert!(all(twice.as_bytes(), "", HALF).1.starts_with("the id 1 stands twice"));
}

#[test]
fn arrays_of_frames_without_end_are_refused() {
    for (shape, fortran, words) in [
        ("(18446744073709551615, 0, 3)", "False", "it must be that of rows"),
        ("(0, 5, 3)", "False", "it must be that of rows"),
        ("(2, 2, 2)", "True", "in Fortran order; write frames in C order"),
        ("(18446744073709551615, 4000000000, 3)", "False", "p ends before the"),
        ("(2, 2, 2, 2)", "False", "it must be that of rows"),
    ] {
        let end = all(&npy_file("<f8", fortran, shape, &[0; 16]), "npy", HALF).1;
        assert!(end.contains(words), "{shape}: {end}");
    }
    assert!(
        pairs::from(&cube(12)[..], "p", &[], Frame::Only).is_err(),
        "three dimensions are no pairs"
    );
}

/// A list by its frame, its step and its pairs.
type Lists = Vec<(Option<u64>, Option<i64>, Vec<[i64; 2]>)>;

fn lists(bytes: &[u8]) -> (Lists, String) {
    let mut told = Vec::new();
    let end = pairs::lists_from(bytes, "p", &[], Frame::All, |lists| {
        for list in lists {
            let List { frame, step, pairs, .. } = list?;
            told.push((frame, step, pairs));
        }
        Ok(())
    });
    (told, end.map_or_else(|error| format!("{error:#}"), |()| String::new()))
}

#[test]
fn lists_of_all_formats_come_frame_by_frame() {
    let local = |step: i64, rows: &str| {
        let n = rows.lines().count();
        format!(
            "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ENTRIES\n{n}\nITEM: BOX BOUNDS ff ff ff\n0 1\n\
             0 1\n0 1\nITEM: ENTRIES index c_p[1] c_p[2]\n{rows}"
        )
    };
    let text = local(0, "1 1 2\n") + &local(10, "") + &local(20, "1 1 2\n2 2 3\n");
    let frames = vec![
        (Some(0), Some(0), vec![[1, 2]]),
        (Some(1), Some(10), vec![]),
        (Some(2), Some(20), vec![[1, 2], [2, 3]]),
    ];
    assert_eq!(lists(text.as_bytes()), (frames, String::new()));
    let (told, end) = lists(&text.as_bytes()[..text.len() - 6]);
    assert_eq!(
        (told.len(), &*end),
        (2, "p ends after 1 of the 2 entries that its header announces")
    );

    let fstat = |rows: &[&str]| {
        let rows: Vec<String> =
            rows.iter().map(|row| format!("0 {row}{}\n", " 0".repeat(11))).collect();
        format!("# 0 2\n#\n#\n{}", rows.concat())
    };
    let text =
        fstat(&["0 1", "1 0"]) + &fstat(&[]).replacen("#\n#\n", "", 1) + &fstat(&["2 3", "2 -1"]);
    // Headers that follow each other are one.
    let (told, end) = lists(text.as_bytes());
    let pairs: Vec<_> = told.into_iter().map(|(frame, _, pairs)| (frame, pairs)).collect();
    assert_eq!((pairs, &*end), (vec![(Some(0), vec![[0, 1]]), (Some(1), vec![[2, 3]])], ""));

    let rows = b"frame,i,j,force\n0,0,1,0.5\n0,1,2,0.5\n4,0,1,0.5\n";
    let frames = vec![(Some(0), None, vec![[0, 1], [1, 2]]), (Some(4), None, vec![[0, 1]])];
    assert_eq!(lists(rows), (frames.clone(), String::new()));
    let array: Vec<u8> =
        [0, 0, 1, 0, 1, 2, 4, 0, 1].into_iter().flat_map(|k: i32| k.to_le_bytes()).collect();
    assert_eq!(lists(&npy_file("<i4", "False", "(3, 3)", &array)), (frames, String::new()));
    let steps = vec![(Some(0), Some(-5), vec![[0, 1]]), (Some(1), Some(70), vec![[0, 1], [1, 2]])];
    assert_eq!(lists(b"# i j step\n0 1 -5\n0 1 70\n# c\n\n1 2 70\n"), (steps, String::new()));
    // No rows are no frames, and no frame is one list.
    assert_eq!(lists(b"frame,i,j\n"), (vec![], String::new()));
    assert_eq!(lists(b"i,j\n"), (vec![(None, None, vec![])], String::new()));
    let back = "p:3: frame 0 stands after frame 1; sort the rows by frame";
    assert_eq!(
        lists(b"frame,i,j\n1,0,1\n0,0,1\n"),
        (vec![(Some(1), None, vec![[0, 1]])], back.into())
    );
    let bad = "p:2: column 1: '-1' is not a frame";
    assert_eq!(lists(b"frame,i,j\n-1,0,1\n"), (vec![], bad.into()));
}

#[test]
fn one_list_of_rows_is_chosen_by_its_frame() {
    let rows = &b"frame,i,j\n2,0,1\n2,1,2\n4,0,1\n4,1,2\n4,2,3\n9,0,9\n"[..];
    let count =
        |frame| pairs::from(rows, "p", &[], frame).map(|list| (list.frame, list.pairs.len()));
    for (frame, pairs) in [(0, 0), (2, 2), (3, 0), (4, 3), (9, 1), (11, 0)] {
        assert_eq!(count(Frame::Number(frame)).unwrap(), (Some(frame), pairs), "frame {frame}");
    }
    assert_eq!(count(Frame::Last).unwrap(), (Some(9), 1));
    assert!(count(Frame::Only).unwrap_err().to_string().contains("a second frame begins"));
}
