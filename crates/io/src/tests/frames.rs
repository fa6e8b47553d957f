//! Frames one after the other: of particles, and of contact lists.

use super::*;
use crate::pairs;

/// Frames as they are read: number, step, time, ids, and the x of every particle in the order of
/// ids; then the error that ends them, if any.
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
fn arrays_and_compressed_files_give_frames_one_by_one() {
    let frame = |k: u64| (k, None, None, vec![], vec![10.0 * k as f64, 10.0 * k as f64 + 2.0]);
    let frames: Vec<_> = (0..3).map(frame).collect();
    assert_eq!(all(&cube(12), "npy", HALF), (frames, String::new()));
    let text = dump(0, "1 0 0 0\n2 1 0 0\n") + &dump(50, "2 11 0 0\n1 10 0 0\n");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), Default::default());
    std::io::Write::write_all(&mut packed, text.as_bytes()).unwrap();
    let told = all(&packed.finish().unwrap(), "", HALF);
    let second = (1, Some(50), None, vec![1, 2], vec![10.0, 11.0]);
    assert_eq!((told.0.len(), &told.0[1], &*told.1), (2, &second, ""));
    // The radii go with the ids.
    let sized = text.replace("id x y z", "id radius x y");
    let ids = Options { ids: true, frame: Frame::Number(1), dim: Some(2), ..NONE };
    let (mut particles, _) = load_from(sized.as_bytes(), "p", "", ids).unwrap();
    particles.sort_by_id().unwrap();
    let sizes = rows(&particles.scene("p", None).unwrap());
    assert_eq!(sizes, [[0.0, 0.0, 10.0], [0.0, 0.0, 11.0]]);
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

#[test]
fn rows_of_an_array_name_their_frame() {
    let numbers = [0, 0, 1, 0, 1, 2, 4, 0, 1].map(i32::to_le_bytes).concat();
    let array = npy_file("<i4", "False", "(3, 3)", &numbers);
    let lists = pairs::lists_from(&array[..], "p", &[], Frame::All, |lists| {
        lists.map(|list| list.map(|it| (it.frame, it.pairs))).collect::<anyhow::Result<Vec<_>>>()
    });
    assert_eq!(lists.unwrap(), [(Some(0), vec![[0, 1], [1, 2]]), (Some(4), vec![[0, 1]])]);
}
