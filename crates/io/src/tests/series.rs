//! Several files as one trajectory or one scene.

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
    let end = super::frames(path, Options { frame: Frame::All, ..options }, |frames| {
        for frame in frames {
            let (particles, about) = frame?;
            let x = (0..particles.len()).map(|k| particles.centre(k)[0]).collect();
            told.push((x, about.frame, about.time));
        }
        Ok(())
    });
    (told, end.map_or_else(|error| format!("{error:#}"), |()| String::new()))
}

fn vtp(kind: &str, x: &[f64]) -> String {
    let n = x.len();
    let points: String = x.iter().map(|x| format!("{x} 5 5 ")).collect();
    let array = "DataArray type=\"Float64\" format=\"ascii\"";
    format!(
        "<VTKFile type=\"{kind}\"><{kind}><Piece NumberOfPoints=\"{n}\"><Points><{array} \
         NumberOfComponents=\"3\">{points}</DataArray></Points><PointData><{array} \
         Name=\"radius\">{}</DataArray></PointData></Piece></{kind}></VTKFile>",
        "0.5 ".repeat(n)
    )
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
    assert_eq!(one(Frame::Last, false), (100.0, 2, 3));
    assert_eq!(one(Frame::Number(0), true), (9.0, 0, 3));
    assert_eq!(one(Frame::Number(1), false), (10.0, 1, 2));
    let refused =
        |path: &Path, frame| format!("{:#}", load(path, Options { frame, ..NONE }).unwrap_err());
    assert!(refused(&pattern, Frame::Number(3)).contains("there is no frame 3"));
    assert!(refused(&pattern, Frame::Only).contains("a second frame begins"));
    let none = folder.path().join("walk_*.csv");
    assert!(refused(&none, Frame::Last).contains("no file matches the pattern"));
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
    assert_eq!(lists(Frame::All).unwrap(), [(Some(0), 1, 1), (Some(1), 0, 0)]);
    assert_eq!(pairs::read(&pattern, &[], Frame::Last).unwrap().frame, Some(1));
    assert_eq!(pairs::read(&pattern, &[], Frame::Number(0)).unwrap().pairs, [[0, 1]]);
    assert!(pairs::read(&pattern, &[], Frame::Only).is_err());
    let none = pairs::read(&folder.path().join("n_*.csv"), &[], Frame::Last).unwrap_err();
    assert!(none.to_string().contains("no file matches the pattern"), "{none}");
}

#[test]
fn lists_of_files_are_frames_with_times() {
    let one = vtp("PolyData", &[1.0]);
    let two = vtp("UnstructuredGrid", &[2.0, 3.0]);
    let pvd = "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0.5\" \
               file=\"b.vtp\"/><DataSet timestep=\"2\" part=\"0\" file=\"a.vtu\"/><DataSet \
               timestep=\"2\" part=\"1\" file=\"b.vtp\"/></Collection></VTKFile>";
    let json = r#"{"file-series-version": "1.0", "files": [{"name": "b.vtp", "time": 0.5},
                  {"name": "a.vtu", "time": 2}]}"#;
    let folder = folder(&[
        ("b.vtp", &one),
        ("a.vtu", &two),
        ("s.pvd", pvd),
        ("s.vtp.series", json),
        ("back.pvd", &pvd.replacen("0.5", "7", 1)),
        ("self.pvd", &pvd.replace("b.vtp", "self.pvd")),
        ("cut.pvd", pvd.strip_suffix("</VTKFile>").unwrap()),
        ("gone.pvd", &pvd.replace("a.vtu", "gone.vtu")),
        ("empty.pvd", "<VTKFile type=\"Collection\"><Collection></Collection></VTKFile>"),
    ]);
    let told = |name: &str| all(&folder.path().join(name), NONE);
    let frames = |second| vec![(vec![1.0], 0, Some(0.5)), (second, 1, Some(2.0))];
    assert_eq!(told("s.pvd"), (frames(vec![2.0, 3.0, 1.0]), String::new()));
    assert_eq!(told("s.vtp.series"), (frames(vec![2.0, 3.0]), String::new()));
    for (name, words) in [
        ("back.pvd", "the time 2 stands behind 7; sort the list by time"),
        ("self.pvd", "is a list of files itself"),
        ("cut.pvd", "ends before </VTKFile>"),
        ("gone.pvd", "gone.vtu"),
        ("empty.pvd", "lists no files"),
    ] {
        let (_, end) = told(name);
        assert!(end.contains(words), "{name}: {end}");
    }
}

#[test]
fn pieces_in_files_are_one_scene() {
    let pieces = "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid GhostLevel=\"0\"><Piece \
                  Source=\"a.vtu\"/><Piece Source=\"e.vtu\"/><Piece Source=\"b.vtp\"/>\
                  </PUnstructuredGrid></VTKFile>";
    let series = "<VTKFile type=\"Collection\"><DataSet timestep=\"4\" file=\"all.pvtu\"/>\
                  </VTKFile>";
    let folder = folder(&[
        ("all.pvtu", pieces),
        ("none.pvtu", &pieces.replace("b.vtp", "sized.csv")),
        ("lost.pvtu", &pieces.replace("b.vtp", "lost/b.vtp")),
        ("s.pvd", series),
        ("a.vtu", &vtp("UnstructuredGrid", &[2.0, 3.0])),
        ("e.vtu", &vtp("UnstructuredGrid", &[])),
        ("b.vtp", &vtp("PolyData", &[1.0])),
        ("sized.csv", "x,y,z\n1,2,3\n"),
    ]);
    let told = |name: &str| all(&folder.path().join(name), NONE);
    let x = vec![2.0, 3.0, 1.0];
    assert_eq!(told("all.pvtu"), (vec![(x.clone(), 0, None)], String::new()));
    assert_eq!(told("s.pvd"), (vec![(x, 0, Some(4.0))], String::new()));
    assert!(told("none.pvtu").1.contains("some hold radii, and others none"));
    let (_, lost) = told("lost.pvtu");
    for words in ["lost.pvtu: its piece ", "lost/b.vtp is missing; ", "out of the list"] {
        assert!(lost.contains(words), "{lost}");
    }
    let (particles, about) = load(&folder.path().join("all.pvtu"), NONE).unwrap();
    assert_eq!((particles.len(), about.frames), (3, 1));
}
