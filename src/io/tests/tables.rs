//! Tables: rows of several times, boxes in comments, quotes and comments.

use super::*;

const DEM: &str = "frame,time,id,x,y,z,diameter,active\n0,0,1,0,0,0,1,1\n0,0,2,3,0,0,1,1\n\
                   1,0.1,1,0.75,0,0,1,1\n1,0.1,2,2.5,0,0,1,1\n";
const TRACKED: &str = "y,x,mass,size,frame,particle\n5,0.25,3,1,0,0.0\n5,4,3,1,0,1.0\n\
                       5,3.25,3,1,1,1.0\n5,1,3,1,1,0.0\n";

/// Number, step and time of each frame, with the x and the ids of its particles.
type Told = Vec<(u64, Option<i64>, Option<f64>, Vec<f64>, Vec<i64>)>;

fn every(text: &str, options: Options) -> Result<Told, String> {
    let options = Options { ids: true, frame: Frame::All, ..options };
    let all = |frames: Frames<'_>| -> anyhow::Result<Told> {
        let told = |frame: anyhow::Result<(Particles, About)>| {
            let (particles, about) = frame?;
            let x = (0..particles.len()).map(|k| particles.centre(k)[0]).collect();
            let ids = particles.ids().unwrap_or_default().to_vec();
            Ok((about.frame, about.step, about.time, x, ids))
        };
        frames.map(told).collect()
    };
    frames_from(text.as_bytes(), "p", "csv", options, all).map_err(|error| format!("{error:#}"))
}

fn one(text: &str, options: Options) -> Result<(Particles, About), String> {
    load_from(text.as_bytes(), "p", "csv", options).map_err(|error| format!("{error:#}"))
}

fn columns(text: &str) -> Options {
    Options { columns: Some(text.parse().unwrap()), radius: Some(0.5), ..NONE }
}

#[test]
fn rows_of_several_times_are_frames() {
    let dem: Told = vec![
        (0, Some(0), Some(0.0), vec![0.0, 3.0], vec![1, 2]),
        (1, Some(1), Some(0.1), vec![0.75, 2.5], vec![1, 2]),
    ];
    assert_eq!(every(DEM, NONE).unwrap(), dem);
    assert_eq!(every(&DEM.replace("frame,time", "timestep,t"), NONE).unwrap(), dem);
    let tracked: Told = vec![
        (0, Some(0), None, vec![0.25, 4.0], vec![0, 1]),
        (1, Some(1), None, vec![3.25, 1.0], vec![1, 0]),
    ];
    assert_eq!(every(TRACKED, HALF).unwrap(), tracked);
    for name in ["TimeStep", "time_step", "iteration", "Snapshot", "frame_no", "Time [s]", "t"] {
        let text = TRACKED.replace("frame", name);
        assert_eq!(every(&text, HALF).unwrap().len(), 2, "{name}");
    }
    // Falling, as texts, and with other columns in front.
    let falling = "# x y t\n1 2 0.5\n2 2 0.5\n\n3 2 0.25 # the second\n";
    assert_eq!(every(falling, HALF).unwrap()[1].2, Some(0.25));
    let dated = "x,y,time\n1,2,10:00\n2,2,10:00\n3,2,10:05\n";
    assert_eq!(every(dated, HALF).unwrap().len(), 2);
    // One value is one frame.
    assert_eq!(
        every("x,y,t\n1,2,7\n3,2,7\n", HALF).unwrap(),
        [(0, None, Some(7.0), vec![1.0, 3.0], vec![])]
    );
}

#[test]
fn a_frame_of_a_table_is_chosen_as_in_other_files() {
    let taken = |frame| {
        let (particles, about) = one(DEM, Options { frame, ..NONE })?;
        Ok::<_, String>((particles.centre(0)[0], about.frame, about.frames))
    };
    assert_eq!(taken(Frame::Number(0)), Ok((0.0, 0, 2)));
    assert_eq!(taken(Frame::Last), Ok((0.75, 1, 2)));
    assert!(taken(Frame::Only).unwrap_err().contains("a second frame begins"));
    assert!(taken(Frame::Number(2)).unwrap_err().contains("holds 2 frames"));
    let plain = one("x,y\n1,2\n", Options { frame: Frame::Number(1), ..HALF }).unwrap_err();
    assert!(plain.contains("there is no frame 1"), "{plain}");
    // Frames that are numbered otherwise in the file are said.
    let late = TRACKED.replace(",1,0,", ",1,5,").replace(",1,1,", ",1,7,");
    let (particles, about) = one(&late, Options { frame: Frame::Number(1), ..HALF }).unwrap();
    assert_eq!((about.frame, about.step), (1, Some(7)));
    assert!(particles.notices()[0].words(Place::Argument).contains("that with 7 in 'frame'"));
}

#[test]
fn rows_that_are_not_sorted_by_time_are_refused() {
    let walkers = "# id frame x y z r\n1 0 0.75 5 5 0.5\n1 1 0.75 5 5 0.5\n2 0 3 5 5 0.5\n";
    for frame in [Frame::All, Frame::Number(0), Frame::Last] {
        let error = match frame {
            Frame::All => every(walkers, NONE).unwrap_err(),
            frame => one(walkers, Options { frame, ..NONE }).unwrap_err(),
        };
        assert!(error.starts_with("p:4: the rows are not sorted by 'frame'"), "{error}");
        assert!(error.contains("-k 2"), "{error}");
    }
    let each = "x,y,r,t\n1,2,0.5,7.5\n2,2,0.5,9.5\n3,2,0.5,3\n";
    let error = every(each, NONE).unwrap_err();
    assert!(error.contains("--columns frame=t"), "{error}");
    let none = Options { columns: Some("frame=none".parse().unwrap()), ..NONE };
    assert_eq!(every(each, none).unwrap()[0].3, [1.0, 2.0, 3.0]);
    assert_eq!(every(TRACKED, columns("x=x,y=y,frame=none")).unwrap().len(), 1);
    assert_eq!(every(&TRACKED.replace("frame", "k"), columns("frame=k")).unwrap().len(), 2);
    let bare: String = TRACKED.lines().skip(1).map(|line| format!("{line}\n")).collect();
    assert_eq!(every(&bare, columns("x=2,y=1,frame=5")).unwrap()[1].3, [3.25, 1.0]);
    assert!(every(&DEM.replace("\n1,", "\nnan,"), NONE).unwrap_err().contains("is no frame"));
    let error =
        one("ITEM: NUMBER OF ATOMS\n", Options { columns: columns("frame=a").columns, ..NONE });
    assert!(error.unwrap_err().contains("frame= in --columns belongs to tables"));
}

#[test]
fn the_box_of_a_packing_is_its_first_line() {
    let woo = "##PERIODIC:: 10 10 10\n0.25 5 5 0.5\n9.75 5 5 0.5\n";
    let yade = woo.replace("0.5\n", "0.5 -1\n");
    let named = woo.replace("10\n0", "10\n# x y z r\n0");
    let format = woo.replace("10\n0", "10\n#format x_y_z_r\n0");
    let chosen = Options { columns: Some("x=1,y=2,z=3,r=4".parse().unwrap()), ..NONE };
    for (text, options) in
        [(woo, NONE), (&yade, NONE), (&yade, chosen), (&named, NONE), (&format, NONE)]
    {
        let (particles, about) = one(text, options).unwrap();
        let lattice = particles.lattice().expect("a box that repeats");
        assert_eq!(lattice.vectors(), &[[10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]]);
        assert_eq!((lattice.periodic(), particles.len()), ([true; 3], 2), "{text}");
        assert!(particles.notices().is_empty() && about.format == "YADE text");
    }
    let open = Options { boundaries: Boundaries { open: true, ..Boundaries::AS_DECLARED }, ..NONE };
    assert!(one(woo, open).unwrap().0.lattice().is_none());
    for bad in ["10 10", "10 10 x", "10 10 -1", ""] {
        let text = woo.replace("10 10 10", bad);
        assert!(one(&text, NONE).unwrap_err().contains("three edges"), "{bad}");
        assert!(one(&text, open).is_ok());
    }
    let said = one("# box 10 10 10\nx,y,r\n1,2,3\n", NONE).unwrap().0;
    assert!(said.notices()[0].words(Place::Argument).contains("may describe a box"));
}

#[test]
fn quotes_comments_and_separators_at_the_end_are_understood() {
    let ball = vec![vec![0.25, 5.0, 5.0, 0.5], vec![1.25, 5.0, 5.0, 0.5]];
    for text in [
        "x,y,z,r,name\n0.25,5,5,0.5,\"grain, big\"\n1.25,5,5,0.5,b\n",
        "\"a, b\",x,y,z,r\n \"say \"\"x, y\"\"\" ,0.25,5,5,0.5\n\"\",1.25,5,5,0.5\n",
        "name;x;y;z;r\n\"a;b\";0.25;5;5;0.5\nb;1.25;5;5;0.5\n",
        "\"a name\" x y z r\n\"b c\" 0.25 5 5 0.5\nd 1.25 5 5 0.5\n",
        "% x y z r\n0.25 5 5 0.5\n1.25 5 5 0.5\n",
        "// x,y,z,r\n0.25,5,5,0.5\n! half\n1.25,5,5,0.5\n",
        "x,y,z,r\n0.25,5,5,0.5 # first\n1.25,5,5,0.5\n",
        "x y z r # in metres\n0.25 5 5 0.5 # first, of 2\n1.25 5 5 0.5 % last\n",
        "x,y,z,r\n0.25,5,5,0.5,\n1.25,5,5,0.5,\n",
        "x,y,z,r\n0.25,5,5,0.5\n1.25,5,5,0.5, # odd\n",
        "x,y,z,r,\n0.25,5,5,0.5,\n1.25,5,5,0.5,left\n",
        "0.25,5,5,0.5,\n1.25,5,5,0.5,\n",
        "x,y,z,r,Spot #,note\n0.25,5,5,0.5,1,a # b\n1.25,5,5,0.5,2,50 %\n",
        "note,x,y,z,r\na # b,0.25,5,5,0.5\nc,1.25,5,5,0.5\n",
    ] {
        let found = read(text.as_bytes(), "csv", NONE);
        assert_eq!(rows(&found.unwrap_or_else(|error| panic!("{text}: {error}"))), ball, "{text}");
    }
    let ids = Options { ids: true, ..NONE };
    let (particles, _) = one("x,y,r,id\n1,2,3,7 # first\n1,2,3,8,\n", ids).unwrap();
    assert_eq!(particles.ids(), Some(&[7, 8][..]));
    let error = one("x,y,r,a\n1,2,3,\"b\nc\"\n", NONE).unwrap_err();
    assert!(error.starts_with("p:3: 1 columns where 4 are expected"), "{error}");
}

/// A first row of numbers and texts is no header.
#[test]
fn the_first_row_is_not_lost() {
    let text = "A 1 2 3 0.5\nB 4 5 6 0.5\n";
    let chosen = Options { columns: Some("x=2,y=3,z=4,r=5".parse().unwrap()), ..NONE };
    assert_eq!(one(text, chosen).unwrap().0.len(), 2);
    let error = one(text, NONE).unwrap_err();
    assert!(error.contains("the first line holds numbers, and no names"), "{error}");
    let pandas = one("0,1,2,3\n5,5,5,0.5\n", NONE).unwrap().0;
    assert!(pandas.notices()[0].words(Place::Argument).contains("the line counts the columns"));
    let plain = |row: &str| from(format!("1\n\n{row}\n").as_bytes(), "p", "xyz", HALF);
    assert!(plain("1 2 3 4").is_ok() && plain("C 2 3 4").is_ok());
    assert!(plain("0.5 2 3 4").unwrap_err().to_string().contains("the species is expected"));
}

#[test]
fn columns_without_names_that_count_are_refused_in_any_order() {
    let four = "1 0.5 0.5 0.5\n2 1.25 0.5 0.5\n3 2 0.75 0.5\n";
    let turned = "3 0.5 0.5 0.5\n1 1.25 0.5 0.5\n2 2 0.75 0.5\n";
    for text in [four, turned, &four.replace(" 0.5\n", " 0.25\n")] {
        let error = one(text, NONE).unwrap_err();
        assert!(error.contains("--columns id=1,x=2,y=3,r=4, or"), "{error}");
    }
    let error = one("2 1 5\n0 5 1\n1 7 7\n", HALF).unwrap_err();
    assert!(error.contains("--columns id=1,x=2,y=3, or"), "{error}");
    let graph = one("1 5\n2 7\n3 1\n", HALF).unwrap().0;
    assert!(graph.notices()[0].words(Place::Argument).contains("counts the particles"));
    // Each number once, from 0 or from 1.
    for text in ["1 5 1 2\n1 1 5 2\n2 1 1 2\n", "0 5 1 2\n3 1 5 2\n1 1 1 2\n"] {
        assert!(one(text, NONE).is_ok(), "{text}");
    }
}
