//! What is wrong with a file is said with its place, and never by a panic.

use rand::{RngExt, SeedableRng};

use super::*;

#[test]
fn bad_files_are_refused_with_place_and_remedy() {
    let plane = Options { radius: None, dim: Some(2), ..NONE };
    let long = [b"x,y,r\n1,2,3".as_slice(), &vec![b' '; LONGEST_LINE], b"\n"].concat();
    let shape = |shape| npy_file("<f8", "False", shape, &doubles(&[1.0; 4]));
    let nan = npy_file("<f8", "False", "(2, 2)", &doubles(&[1.0, 2.0, 3.0, f64::NAN]));
    let negative = npy_file("<f8", "False", "(1, 4)", &doubles(&[1.0, 2.0, 3.0, -1.0]));
    let short_data = npy_file("<f8", "False", "(1000000000000, 3)", &doubles(&[1.0; 3]));
    let huge = npy_file("<f8", "False", "(4000000000, 3)", &doubles(&[1.0; 3]));
    let cases: Vec<(&[u8], &str, Options, &str)> = vec![
        (b"", "csv", HALF, "p is empty; a particle file has at least a header such as x,y,r"),
        (
            b"\n\n# nothing\n",
            "csv",
            HALF,
            "p is empty; a particle file has at least a header such as x,y,r",
        ),
        (
            b"x,y\n1,2\n",
            "csv",
            NONE,
            "p holds no radii; add a column named r, or give --radius R (half the diameter; in an \
             experiment radius = R)",
        ),
        (
            b"x,y,r\n1,2,3\n1,2\n",
            "csv",
            NONE,
            "p:3: 2 columns where 3 are expected, separated by ','; mend or remove the line",
        ),
        (
            b"x;y;r\n1,2,3\n",
            "csv",
            NONE,
            "p:2: 1 columns where 3 are expected, separated by ';'; mend or remove the line",
        ),
        (
            b"x,y,r\n1,b,3\n",
            "csv",
            NONE,
            "p:2: column 'y': 'b' is not a number; mend or remove the line",
        ),
        (
            b"x,y,r\n1,,3\n",
            "csv",
            NONE,
            "p:2: column 'y': '' is not a number; mend or remove the line",
        ),
        (
            b"x,y,r\n\n1,nan,3\n",
            "csv",
            NONE,
            "p:3: column 'y': 'nan' is not a finite number; mend or remove the line",
        ),
        (
            b"x,y,r\n1,2,1e999\n",
            "csv",
            NONE,
            "p:2: column 'r': '1e999' is not a finite number; mend or remove the line",
        ),
        (
            b"x,y,D\n1,2,-3\n",
            "csv",
            NONE,
            "p:2: column 'D': '-3' is negative; mend or remove the line",
        ),
        (
            b"x,y,x\n",
            "csv",
            NONE,
            "p:1: the columns 'x' and 'x' both stand for x; remove one, or say which counts \
             with --columns",
        ),
        (
            b"x,y,r,d\n",
            "csv",
            NONE,
            "p:1: there are a radius 'r' and a diameter 'd'; remove one, or say which \
             counts: --columns r=r or --columns d=d",
        ),
        (
            b"a,b\n1,2\n",
            "csv",
            HALF,
            "p:1: there is no column 'x' among 'a', 'b'; name the columns x,y[,z][,r], with r, \
             radius, d or diameter, or say which they are with --columns x=NAME,y=NAME",
        ),
        (
            b"1,2,3\n",
            "csv",
            NONE,
            "p:1: three columns without a header may be x,y,z or x,y,r; put a header line before \
             them",
        ),
        (
            b"1,2,3,4,5\n",
            "csv",
            NONE,
            "p:1: 5 columns without a header; put a header line such as x,y,z,r before them, or \
             say which is which with --columns x=1,y=2 and so on (a packing of \
             YADE: --columns x=1,y=2,z=3,r=4)",
        ),
        (
            b"x,y,r\n1,2,3\n",
            "csv",
            Options { radius: None, dim: Some(3), ..NONE },
            "p holds plane points (x and y only); it cannot be read as 3D: add a column z",
        ),
        (
            b"x,y,z,r\n1,2,0,3\n1,2,5,3\n",
            "csv",
            plane,
            "p: particle 1 has z = 5; only particles with z = 0 can be read as 2D",
        ),
        (
            b"x,y\n",
            "csv",
            Options { radius: Some(-1.0), dim: None, ..NONE },
            "the radius given is -1; it must be finite and not negative",
        ),
        (
            b"x,y\n",
            "csv",
            Options { radius: None, dim: Some(4), ..NONE },
            "the dimension given is 4; it must be 2 or 3",
        ),
        (
            &long,
            "csv",
            NONE,
            "p:2: the line is longer than 1048576 bytes; this is not a particle file",
        ),
        (
            b"ITEM: TIMESTEP\n",
            "dump",
            NONE,
            "p ends in the header of a frame: it is cut off, or still being written",
        ),
        (b"# vtk DataFile\n", "vtk", NONE, "p is cut off in its header; write it again"),
        (
            b"two\n",
            "xyz",
            HALF,
            "p:1: 'two' is not the number of particles, which is the first line of an XYZ file",
        ),
        (
            b"5000000000\n",
            "xyz",
            HALF,
            "p:1: 5000000000 particles; at most 2^32 - 1 = 4294967295 can be numbered: split the \
             file",
        ),
        (
            b"2\n\nA 1 2 3\n",
            "xyz",
            HALF,
            "p ends after 1 of the 2 particles that the frame's first line announces: it is cut \
             off, or still being written; mend the number or the file",
        ),
        (
            b"1\n\nA 1 2 3\n1\n\n",
            "xyz",
            HALF,
            "p:4: a second frame begins; say which one is to be read, with --frame 0 (the first) \
             to --frame last, or remove the others",
        ),
        (b"1\n\nA 1 2\n", "xyz", HALF, "p:3: 3 columns where 4 are expected (species x y z)"),
        (
            b"1\n\nA 1 2 x\n",
            "xyz",
            HALF,
            "p:3: column 'z': 'x' is not a number; mend or remove the line",
        ),
        (
            b"1\n\nA 1 2 3 4\n",
            "xyz",
            NONE,
            "p:3: 5 columns in a plain XYZ file: it is not known whether the others are radii; \
             give --radius R to skip them, or name them in line 2 as in \
             Properties=species:S:1:pos:R:3:radius:R:1",
        ),
        (
            b"1\nProperties=species:S:1\nA\n",
            "xyz",
            HALF,
            "p:2: Properties=species:S:1: there is no pos; the positions must be named pos:R:3",
        ),
        (
            b"1\nProperties=pos:R\n",
            "xyz",
            HALF,
            "p:2: Properties=pos:R: it must be triples name:type:number, as in \
             species:S:1:pos:R:3:radius:R:1",
        ),
        (
            b"1\nProperties=pos:R:4\n",
            "xyz",
            HALF,
            "p:2: Properties=pos:R:4: pos has 4 columns; it must have 2 or 3",
        ),
        (
            b"1\nProperties=pos:R:0\n",
            "xyz",
            HALF,
            "p:2: Properties=pos:R:0: '0' is not a number of columns from 1 to 1000",
        ),
        (
            b"x,y\n",
            "npy",
            HALF,
            "p is not a NumPy file: it does not begin with \\x93NUMPY; write it with numpy.save",
        ),
        (b"\x93NUMPY", "npy", HALF, "p: the npy header is cut off; write the file again"),
        (
            b"\x93NUMPY\x04\0\0\0",
            "npy",
            HALF,
            "p is npy version 4; versions 1 to 3 are read: write it with numpy.save",
        ),
        (
            b"\x93NUMPY\x02\0\0\0\0\x80",
            "npy",
            HALF,
            "p: the npy header has 2147483648 bytes; at most 1048576 are read",
        ),
        (
            &short_data,
            "npy",
            HALF,
            "p: 1000000000000 particles; at most 2^32 - 1 = 4294967295 can be numbered: split the \
             file",
        ),
        (
            &huge,
            "npy",
            HALF,
            "p ends before the 4000000000 x 3 numbers that its header announces; write it again",
        ),
        (
            &nan,
            "npy",
            HALF,
            "p: particle 1 (from 0): y is NaN; it must be finite: mend or remove the row",
        ),
        (
            &negative,
            "npy",
            NONE,
            "p: particle 0 (from 0): the radius -1 is negative; mend or remove the row",
        ),
    ];
    for (bytes, ending, options, message) in cases {
        assert_eq!(read(bytes, ending, options).unwrap_err(), message);
    }
    for (bytes, part) in [
        (shape("(4,)"), "the shape is (4,); it must be (N, 2), (N, 3) or (N, 4)"),
        (shape("(2, 1)"), "the shape is (2, 1); it must be"),
        (shape("(-1, 2)"), "the shape is (-1, 2); it must be"),
        (shape("7"), "the shape is not of the form (N, 3)"),
        (shape("(1, 2)"), "p goes on after the 1 x 2 numbers"),
        (
            npy_file("<i8", "False", "(1, 2)", &[]),
            "the type '<i8' is not read; convert with .astype('f8')",
        ),
        (npy_file("<f8", "Maybe", "(1, 2)", &[]), "fortran_order is neither True nor False"),
    ] {
        let message = read(&bytes, "npy", HALF).unwrap_err();
        assert!(message.contains(part), "{message}");
    }
    let wide = format!("1\nProperties=pos:R:3{}\n", ":v:R:1000".repeat(10));
    let message = read(wide.as_bytes(), "xyz", HALF).unwrap_err();
    assert!(
        message.ends_with("it announces more than 10000 columns; remove what is not needed"),
        "{message}"
    );
    let chosen = Options { columns: Some("r=r".parse().unwrap()), ..HALF };
    assert_eq!(
        read(b"x,y,r\n1,2,3\n", "csv", chosen).unwrap_err(),
        "the radius is given, and a column of sizes is chosen, too; leave one out"
    );
    let missing = scene(Path::new("/nowhere/p.csv"), NONE).unwrap_err();
    assert!(format!("{missing:#}").starts_with("cannot read /nowhere/p.csv: "), "{missing:#}");
    assert!(scene(Path::new("/"), NONE).is_err());
}

/// Damaged files give scenes or sentences, never a panic. The seed is fixed, so that a failure
/// comes back.
#[test]
fn damaged_bytes_never_panic() {
    let files: [(&[u8], &str); 5] = [
        (b"x,y,z,r\n1,2,3,0.5\n4,5,6,0.5\n", "csv"),
        (b"# x y r\n1 2 3\n4 5 6\n", "txt"),
        (
            b"2\nProperties=\"species:S:1:pos:R:3:radius:R:1\" a='b c'\nA 1 2 3 4\nB 5 6 7 8\n",
            "xyz",
        ),
        (&npy_file("<f8", "False", "(2, 4)", &doubles(&[0.5; 8])), "npy"),
        (&npy_file(">f4", "True", "(2, 3)", &[0; 24]), "npy"),
    ];
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let (mut good, mut bad) = (0, 0);
    for (bytes, ending) in files {
        let options = [
            NONE,
            HALF,
            Options { radius: None, dim: Some(2), ..NONE },
            Options { radius: Some(1.0), dim: Some(3), ..NONE },
        ];
        let mut see = |bytes: &[u8], options| match read(bytes, ending, options) {
            Ok(_) => good += 1,
            Err(message) => {
                bad += 1;
                assert!(message.len() < 1000 && !message.is_empty(), "{message}");
            }
        };
        for end in 0..=bytes.len() {
            options.into_iter().for_each(|options| see(&bytes[..end], options));
        }
        for round in 0..3000 {
            let mut bytes = bytes.to_vec();
            for _ in 0..rng.random_range(1..4) {
                let at = rng.random_range(0..bytes.len());
                let pool = b" ,;:\t\n\r\"'=#()-+.eE019\xff\0";
                match rng.random_range(0..3) {
                    0 => bytes[at] = pool[rng.random_range(0..pool.len())],
                    1 => bytes.insert(at, pool[rng.random_range(0..pool.len())]),
                    _ => bytes[at] ^= 1 << rng.random_range(0..8),
                }
            }
            see(&bytes, options[round % options.len()]);
        }
    }
    assert!(good > 500 && bad > 500, "{good} read, {bad} refused: the damage is not of both kinds");
}

/// Read as one line, a list of pairs would be empty, and so would the particles.
#[test]
fn carriage_returns_alone_are_no_line_ends() {
    let words = "p:1: a line ends in a carriage return alone";
    for (text, ending) in [
        ("x,y,r\r1,2,3\r4,5,6\r", "csv"),
        ("1 2 3 4\r5 6 7 8\r", ""),
        ("2\rcomment\rAr 1 2 3\rAr 4 5 6\r", "xyz"),
        ("ply\rformat ascii 1.0\relement vertex 0\rend_header\r", "ply"),
    ] {
        let error = read(text.as_bytes(), ending, NONE).unwrap_err();
        assert!(error.starts_with(words), "{text:?}: {error}");
    }
    let pairs = |text: &str| pairs::from(text.as_bytes(), "p", &[], Frame::Only);
    for text in ["i,j\r0,1\r1,2\r", "0 1\r1 2\r", "i,j\n0,1\r1,2\n"] {
        let error = pairs(text).unwrap_err().to_string();
        assert!(error.contains("a line ends in a carriage return alone"), "{text:?}: {error}");
    }
    assert_eq!(pairs("i,j\r\n0,1\r\n1,2").unwrap().pairs, [[0, 1], [1, 2]]);
}

/// As Finney's packing is published: number, x, y, z.
#[test]
fn columns_that_count_the_particles_are_no_coordinates_and_no_radii() {
    let z = ["0.5", "0.25", "2.75", "1e-3"];
    let numbered = |from: usize| -> String {
        z.iter().enumerate().map(|(k, z)| format!("{} 1.5 -{k} {z}\n", k + from)).collect()
    };
    let refused = |text: &str, options, words: &str| {
        let error = read(text.as_bytes(), "txt", options).unwrap_err();
        assert!(error.contains(words), "{text}: {error}");
    };
    for from in [0, 1] {
        let words = "the first of 4 columns without names counts the particles, and is taken for \
                     'x'; say which column is which: --columns id=1,x=2,y=3,z=4, or --columns \
                     x=1,y=2,z=3,r=4 if it is that";
        refused(&numbered(from), NONE, words);
        refused(&numbered(from).replace(' ', ","), NONE, words);
        let last: String = (0..4).map(|k| format!("1.5 {k} {} {}\n", z[k], k + from)).collect();
        refused(
            &last,
            NONE,
            "the last of 4 columns without names counts the particles, and is taken for 'r'",
        );
        refused(&last, NONE, "--columns x=1,y=2,z=3,id=4, or");
        let rows = (0..4).flat_map(|k| [(k + from) as f64, 1.5, 0.5, 1.0 / (k + 1) as f64]);
        let array = npy_file("<f8", "False", "(4, 4)", &doubles(&rows.collect::<Vec<_>>()));
        assert!(read(&array, "npy", NONE).unwrap_err().contains("counts the particles"));
        assert!(read(&array, "npy", Options { dim: Some(3), ..NONE }).is_ok());
    }
    let plane = Options { dim: Some(2), ..NONE };
    refused("1 0.5 2\n2 0.5 3.5\n3 0.5 4.5\n", plane, "--columns id=1,x=2,y=3, or");
    let chosen = |text: &str| Some(text.parse().unwrap());
    for columns in ["id=1,x=2,y=3,z=4", "x=1,y=2,z=3,r=4"] {
        let radius = (!columns.contains("r=")).then_some(0.5);
        let options = Options { radius, columns: chosen(columns), ..NONE };
        assert_eq!(read(numbered(1).as_bytes(), "txt", options).unwrap().len(), 4);
    }
    // Counted from elsewhere, or named, or beads of one size on a row, or hardly any.
    for text in [
        numbered(2),
        format!("x y z r\n{}", numbered(0)),
        (0..4).map(|k| format!("{k} 0 0 0.5\n")).collect(),
        "0 1 2 3\n1 2 3 4\n".into(),
        "0 1 2 3\n1 2 3 4\n1 2 3 5\n".into(),
    ] {
        read(text.as_bytes(), "txt", NONE).unwrap_or_else(|error| panic!("{text}: {error}"));
    }
}
