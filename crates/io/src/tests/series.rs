//! Several files as one trajectory.

use super::*;

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// For each frame: x of all particles, number, time, file; and the error at the end.
type Told = (Vec<(Vec<f64>, u64, Option<f64>)>, String);

fn all(path: &Path, options: Options) -> Told {
    let mut told = Vec::new();
    let end = crate::frames(path, Options { frame: FrameChoice::All, ..options }, |frames| {
        for frame in frames {
            let (particles, about) = frame?;
            let x = (0..particles.len()).map(|k| particles.centre(k)[0]).collect();
            told.push((x, about.frame, about.time));
        }
        Ok(())
    });
    (told, end.map_or_else(|error| format!("{error:#}"), |()| String::new()))
}

#[test]
fn files_of_a_pattern_are_frames_in_the_order_of_their_numbers() {
    let of = |x: f64| format!("x,y,r\n{x},0,0.5\n");
    let texts = [10, 9, 100].map(|k| (format!("run_{k}.csv"), of(f64::from(k))));
    let files: Vec<(&str, &str)> = texts.iter().map(|(name, text)| (&**name, &**text)).collect();
    let folder = folder(&[&files[..], &[("other.csv", "x,y,r\n")]].concat());
    let pattern = folder.path().join("run_*.csv");
    assert!(exists(&pattern) && !exists(&folder.path().join("walk_*.csv")));
    let frames = [9.0, 10.0, 100.0].iter().zip(0..).map(|(&x, k)| (vec![x], k, None)).collect();
    assert_eq!(all(&pattern, NONE), (frames, String::new()));
    let one = |frame, survey| {
        let (particles, about) = load(&pattern, Options { frame, survey, ..NONE }).unwrap();
        assert!(about.file.unwrap().ends_with(".csv"));
        let said = particles.notices.iter().any(
            |notice| matches!(notice, Notice::Assumed(words) if words.starts_with("3 files are")),
        );
        assert!(said, "what was assumed is a notice");
        (particles.centre(0)[0], about.frame, about.frames)
    };
    assert_eq!(one(FrameChoice::Last, false), (100.0, 2, 3));
    assert_eq!(one(FrameChoice::Number(0), true), (9.0, 0, 3));
    assert_eq!(one(FrameChoice::Number(1), false), (10.0, 1, 2));
    let refused =
        |path: &Path, frame| format!("{:#}", load(path, Options { frame, ..NONE }).unwrap_err());
    assert!(refused(&pattern, FrameChoice::Number(3)).contains("there is no frame 3"));
    assert!(refused(&pattern, FrameChoice::Only).contains("a second frame begins"));
    let none = folder.path().join("walk_*.csv");
    assert!(refused(&none, FrameChoice::Last).contains("no file matches the pattern"));
    std::fs::write(folder.path().join("run_11.csv"), "x,y,r\n1,2\n").unwrap();
    let (told, end) = all(&pattern, NONE);
    assert!(told.len() == 2 && end.contains("run_11.csv:2: 2 columns"), "{end}");
}

#[test]
fn lists_of_a_pattern_are_those_of_frames() {
    let folder = folder(&[("l_9.csv", "i,j\n0,1\n"), ("l_10.csv", "i,j\n"), ("m_1.csv", "0 1\n")]);
    let pattern = folder.path().join("l_*.csv");
    let lists = |frame| -> anyhow::Result<Vec<(Option<u64>, usize, usize)>> {
        pairs::lists(&pattern, &[], frame, |lists| {
            lists.map(|list| list.map(|it| (it.frame, it.pairs.len(), it.notices.len()))).collect()
        })
    };
    assert_eq!(lists(FrameChoice::All).unwrap(), [(Some(0), 1, 1), (Some(1), 0, 0)]);
    assert_eq!(pairs::read(&pattern, &[], FrameChoice::Last).unwrap().frame, Some(1));
    assert_eq!(pairs::read(&pattern, &[], FrameChoice::Number(0)).unwrap().pairs, [[0, 1]]);
    assert!(pairs::read(&pattern, &[], FrameChoice::Only).is_err());
    let none = pairs::read(&folder.path().join("n_*.csv"), &[], FrameChoice::Last).unwrap_err();
    assert!(none.to_string().contains("no file matches the pattern"), "{none}");
}
