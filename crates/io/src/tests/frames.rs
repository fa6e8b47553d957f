//! Reading frames, also from files whose last frame is incomplete.

use super::*;

/// Returns x of the first particle, the number of the chosen frame, and the number of frames.
fn one(bytes: &[u8], frame: FrameChoice, survey: bool) -> Result<(f64, u64, u64), String> {
    let options = Options { frame, survey, ..HALF };
    let read = load_from(bytes, "p", "", options).map_err(|error| format!("{error:#}"));
    read.map(|(particles, about)| (particles.centre(0)[0], about.frame, about.frames))
}

#[test]
fn one_frame_is_read_by_the_code_that_reads_all() {
    let cube = npy_file("<f8", "False", "(3, 1, 2)", &doubles(&[0.0, 1.0, 1.0, 1.0, 2.0, 1.0]));
    let [(_, dump, _), (_, xyz, _), _] = growing();
    for bytes in [dump.as_bytes(), xyz.as_bytes(), &cube] {
        assert_eq!(one(bytes, FrameChoice::Number(1), true), Ok((1.0, 1, 3)));
        assert_eq!(one(bytes, FrameChoice::Number(1), false), Ok((1.0, 1, 2)));
        assert_eq!(one(bytes, FrameChoice::Number(0), false), Ok((0.0, 0, 1)));
        assert_eq!(one(bytes, FrameChoice::Last, false), Ok((2.0, 2, 3)));
        let refused = |frame| one(bytes, frame, false).unwrap_err();
        assert_eq!(
            refused(FrameChoice::Number(3)),
            "p holds 3 frames, numbered from 0; there is no frame 3"
        );
        assert!(refused(FrameChoice::Only).contains("a second frame begins; choose one"));
        let all = "p: one frame is wanted here; give --frame a number from 0, or last";
        assert_eq!(refused(FrameChoice::All), all);
    }
    let torn = &b"1\n\nA 0 0 0\n1\n\nA x 0 0\n1\n\nA 5 0 0\n"[..];
    let options = Options { frame: FrameChoice::All, ..HALF };
    let count = frames_from(torn, "p", "xyz", options, |frames| Ok(frames.take(9).count()));
    assert_eq!(count.unwrap(), 2, "a frame and an error");
}

#[test]
fn radii_are_sorted_with_ids() {
    let sorted = |text: &str| -> Result<Vec<Vec<f64>>, String> {
        let options = Options { ids: true, ..NONE };
        let (mut particles, _) = load_from(text.as_bytes(), "p", "csv", options).unwrap();
        particles.sort_by_id().map_err(|error| error.to_string())?;
        Ok(rows(&particles.scene("p", None).unwrap()))
    };
    let expected = vec![vec![0.0, 1.0, 10.0], vec![0.0, 2.0, 11.0]];
    assert_eq!(sorted("id,x,y,r\n2,0,2,11\n1,0,1,10\n"), Ok(expected));
    assert!(sorted("id,x,y,r\n1,0,2,11\n1,0,1,10\n").unwrap_err().starts_with("the id 1 stands"));
}

/// Returns files of three frames, in which x of the first particle is the number of the frame:
/// the ending, the text, and the number of lines of the first two frames.
fn growing() -> [(&'static str, String, usize); 3] {
    let dump = |step: u64| {
        format!(
            "ITEM: TIME\n0.5\nITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS \
             pp pp pp\n0 10\n0 10\n0 10\nITEM: ATOMS id x y z\n1 {step} 5 5\n2 9.75 5 5\n"
        )
    };
    let xyz =
        |step: u64| format!("2\nLattice=\"10 10 10\" step={step}\nC {step} 5 5\nC 9.75 5 5\n");
    let csv = |step: u64| {
        let head = if step == 0 { "frame,x,y,z\n" } else { "" };
        format!("{head}{step},{step},5.125,5.25\n{step},9.75,5.125,5.25\n")
    };
    let of = |frame: &dyn Fn(u64) -> String| frame(0) + &frame(1) + &frame(2);
    [("dump", of(&dump), 26), ("xyz", of(&xyz), 8), ("csv", of(&csv), 5)]
}

#[test]
fn whole_frames_are_read_from_a_file_whose_last_frame_is_being_written() {
    for (ending, text, lines) in growing() {
        let third: usize = text.split_inclusive('\n').take(lines).map(str::len).sum();
        let rest = text.len() - third;
        for cut in [text.len() - 12, text.len() - 9, third + rest / 4, third + 3] {
            let bytes = &text.as_bytes()[..cut];
            let load = |frame, survey| {
                load_from(bytes, "p", ending, Options { frame, survey, ..HALF })
                    .map_err(|error| format!("{error:#}"))
            };
            for k in [0, 1] {
                for survey in [false, true] {
                    let (particles, _) = load(FrameChoice::Number(k), survey).unwrap();
                    assert_eq!(particles.centre(0)[0], k as f64, "{ending} {cut} {k}");
                    let said = |notice: &Notice| {
                        let words = notice.to_string();
                        words.contains("is whole") || words.contains("no line feed")
                    };
                    let through = survey || ending == "csv";
                    assert_eq!(particles.notices.iter().any(said), through, "{ending} {cut}");
                }
            }
            let whole = "frames before it are whole: take --frame 1";
            let error = load(FrameChoice::Last, false).unwrap_err();
            assert!(error.ends_with(whole), "{ending} {cut}: {error}");
            let all = Options { frame: FrameChoice::All, ..HALF };
            let mut count = 0;
            let end = frames_from(bytes, "p", ending, all, |frames| {
                frames.map(|frame| frame.map(|_| count += 1)).collect::<anyhow::Result<Vec<_>>>()
            });
            assert!(format!("{:#}", end.unwrap_err()).ends_with(whole));
            assert_eq!(count, 2, "{ending} {cut}");
        }
        let some: String = text.split_inclusive('\n').take(lines).collect();
        let last = Options { frame: FrameChoice::Last, ..HALF };
        let (particles, _) = load_from(some.as_bytes(), "p", ending, last).unwrap();
        assert_eq!(particles.centre(0)[0], 1.0);
        // Without its line feed, the last number may be cut.
        let cut = &text.as_bytes()[..text.len() - 1];
        let (particles, _) = load_from(cut, "p", ending, last).unwrap();
        let words = |notice: &Notice| notice.to_string().contains("no line feed");
        assert!(particles.notices.iter().any(words), "{ending}");
    }
}
