//! Every format: what is read, what is refused and in which words, and that no bytes make a reader panic.

use rand::{RngExt, SeedableRng};

use super::*;
use crate::contact::Real;
use crate::with_scene;

const NONE: Options = Options::NONE;
const HALF: Options = Options { radius: Some(0.5), ..NONE };

fn read(bytes: &[u8], ending: &str, options: Options) -> Result<AnyScene<'static>, String> {
    from(bytes, "p", ending, options).map_err(|error| format!("{error:#}"))
}

/// Coordinates and radii of all particles, one list each.
fn rows(scene: &AnyScene<'_>) -> Vec<Vec<f64>> {
    with_scene!(scene, scene => (0..scene.len())
        .map(|k| crate::contact::array(&scene.centres()[k]).iter().map(|x| x.wide()).chain([scene.radius(k).wide()]).collect())
        .collect())
}

fn npy(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes = [npy::MAGIC, &[1, 0], &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat();
    bytes.extend_from_slice(data);
    bytes
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

#[test]
fn csv_headers_decide() {
    let plane = vec![vec![1.0, 2.0, 0.5], vec![-3.5, 4e2, 0.25]];
    for text in [
        "x,y,r\n1,2,0.5\n-3.5,4e2,0.25\n",
        "\u{feff}X;Y;Radius\r\n1;2;0.5\r\n-3.5;4e2;0.25",
        "# made by hand\n\nname\td\ty\tx\n\nfirst\t1\t2\t1\n# more\nsecond\t.5\t+400\t-3.5\n",
        "  y   x   diameter \n 2   1  1 \n 4e2 -3.5 0.5\n\n",
        "\"x\",\"y\",\"r\"\n\"1\",\"2\",\"0.5\"\n-3.5,400,0.25\n",
        "# x y r\n# in metres\n1 2 .5\n-3.5 400 .25",
        "# x y r\n1,2,.5\n-3.5,400,.25",
    ] {
        assert_eq!(rows(&read(text.as_bytes(), "csv", NONE).unwrap_or_else(|e| panic!("{text}: {e}"))), plane, "{text}");
    }
    let space = read(b"z,y,x\n3,2,1\n", "csv", HALF).unwrap();
    assert_eq!(rows(&space), [[1.0, 2.0, 3.0, 0.5]]);
    // Names are not guessed inside other names; foreign bytes in other columns are no obstacle.
    assert_eq!(rows(&read(b"x,y,rx,caf\xe9\n1,2,9,\xff\n", "csv", HALF).unwrap()), [[1.0, 2.0, 0.5]]);
}

#[test]
fn csv_without_a_header_is_read_where_it_has_one_meaning() {
    let with = |radius, dim| Options { radius, dim, ..NONE };
    assert_eq!(rows(&read(b"1 2\n3 4\n", "txt", HALF).unwrap()), [[1.0, 2.0, 0.5], [3.0, 4.0, 0.5]]);
    assert_eq!(rows(&read(b"1,2,3,4\n", "", NONE).unwrap()), [[1.0, 2.0, 3.0, 4.0]]);
    assert_eq!(rows(&read(b"1,2,3\n", "csv", HALF).unwrap()), [[1.0, 2.0, 3.0, 0.5]]);
    assert_eq!(rows(&read(b"1,2,3\n", "csv", with(None, Some(2))).unwrap()), [[1.0, 2.0, 3.0]]);
    assert_eq!(
        read(b"1,2,3\n", "csv", with(None, Some(3))).unwrap_err(),
        "p holds no radii; give --radius R (half the diameter), or add a column named r"
    );
}

#[test]
fn xyz_plain_and_extended() {
    let plain = read(b"2\nany comment = 3\nAr 1 2 3\nNe 4 5 6\n\n", "xyz", HALF).unwrap();
    assert_eq!(rows(&plain), [[1.0, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.5]]);
    assert_eq!(rows(&read(b"1\n\nAr 1 2 3 9 9 9\n", "dat", HALF).unwrap()), [[1.0, 2.0, 3.0, 0.5]]);
    for comment in [
        "Properties=species:S:1:pos:R:3:radius:R:1",
        "Lattice=\"5 0 0 0 5 0 0 0 5\" pbc='T T F' properties=\"species:S:1:pos:R:3:radius:R:1\" energy=-1",
    ] {
        let text = format!("2\n{comment}\nAr 1 2 3 0.25\nNe 4 5 6 0.5\n");
        assert_eq!(rows(&read(text.as_bytes(), "xyz", NONE).unwrap()), [[1.0, 2.0, 3.0, 0.25], [4.0, 5.0, 6.0, 0.5]]);
    }
    let plane = read(b"1\nProperties=id:I:1:diameter:R:1:vel:R:3:pos:R:2\n7 3 0 0 0 1 2\n", "xyz", NONE).unwrap();
    assert_eq!(rows(&plane), [[1.0, 2.0, 1.5]]);
    assert_eq!(read(b"0\n", "xyz", HALF).unwrap().len(), 0);
    assert_eq!(read(b"0\nProperties=pos:R:3:r:R:1\n", "xyz", NONE).unwrap().len(), 0);
}

#[test]
fn npy_of_both_widths_byte_orders_and_layouts() {
    let expected = [[1.0, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.25]];
    let by_rows: [f64; 8] = [1.0, 2.0, 3.0, 0.5, 4.0, 5.0, 6.0, 0.25];
    let by_columns: [f64; 8] = [1.0, 4.0, 2.0, 5.0, 3.0, 6.0, 0.5, 0.25];
    for (fortran, values) in [("False", by_rows), ("True", by_columns)] {
        for (descr, data) in [
            ("<f8", values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>()),
            (">f8", values.iter().flat_map(|x| x.to_be_bytes()).collect()),
            ("<f4", values.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect()),
            (">f4", values.iter().flat_map(|&x| (x as f32).to_be_bytes()).collect()),
        ] {
            let bytes = npy(descr, fortran, "(2, 4)", &data);
            assert_eq!(rows(&read(&bytes, "npy", NONE).unwrap()), expected, "{descr} {fortran}");
            // The versions 2 and 3 have a longer length field.
            for version in [2, 3] {
                let bytes = [&bytes[..6], &[version, 0], &bytes[8..10], &[0, 0], &bytes[10..]].concat();
                assert_eq!(rows(&read(&bytes, "", NONE).unwrap()), expected);
            }
        }
    }
    let three = npy("<f8", "False", "(1, 3)", &doubles(&[1.0, 2.0, 3.0]));
    assert_eq!(rows(&read(&three, "npy", HALF).unwrap()), [[1.0, 2.0, 3.0, 0.5]]);
    assert_eq!(rows(&read(&three, "npy", Options { radius: None, dim: Some(2), ..NONE }).unwrap()), [[1.0, 2.0, 3.0]]);
    let two = npy("<f8", "False", "(1, 2)", &doubles(&[1.0, 2.0]));
    assert_eq!(rows(&read(&two, "npy", HALF).unwrap()), [[1.0, 2.0, 0.5]]);
    assert_eq!(read(&npy("<f8", "False", "(0, 3)", &[]), "npy", HALF).unwrap().len(), 0);
    // More values than one piece of the stream.
    let many: Vec<f64> = (0..60_000).map(f64::from).collect();
    let scene = read(&npy("<f8", "True", "(30000, 2)", &doubles(&many)), "npy", HALF).unwrap();
    assert_eq!(rows(&scene)[29_999], [29_999.0, 59_999.0, 0.5]);
}

#[test]
fn dimension_and_radii_follow_the_rules() {
    let flat = b"x,y,z,r\n1,2,0,1\n3,4,-0,1\n";
    assert_eq!(read(flat, "csv", NONE).unwrap().dim(), 3);
    let plane = read(flat, "csv", Options { radius: None, dim: Some(2), ..NONE }).unwrap();
    assert_eq!(rows(&plane), [[1.0, 2.0, 1.0], [3.0, 4.0, 1.0]]);
    assert!(plane.uniform(), "equal radii are one radius");
    assert!(!read(b"x,y,r\n1,2,1\n3,4,2\n", "csv", NONE).unwrap().uniform());
    assert_eq!(read(b"x,y,r\n", "csv", NONE).unwrap().len(), 0);
    assert_eq!(read(b"# x y r\n", "csv", NONE).unwrap().len(), 0);
}

#[test]
fn bad_files_are_refused_with_place_and_remedy() {
    let plane = Options { radius: None, dim: Some(2), ..NONE };
    let space = Options { radius: Some(1.0), dim: Some(3), ..NONE };
    let long = [b"x,y,r\n1,2,3".as_slice(), &vec![b' '; LONGEST_LINE], b"\n"].concat();
    let shape = |shape| npy("<f8", "False", shape, &doubles(&[1.0; 4]));
    let nan = npy("<f8", "False", "(2, 2)", &doubles(&[1.0, 2.0, 3.0, f64::NAN]));
    let negative = npy("<f8", "False", "(1, 4)", &doubles(&[1.0, 2.0, 3.0, -1.0]));
    let short_data = npy("<f8", "False", "(1000000000000, 3)", &doubles(&[1.0; 3]));
    let huge = npy("<f8", "False", "(4000000000, 3)", &doubles(&[1.0; 3]));
    let cases: Vec<(&[u8], &str, Options, &str)> = vec![
        (b"", "csv", HALF, "p is empty; a particle file has at least a header such as x,y,r"),
        (b"\n\n# nothing\n", "csv", HALF, "p is empty; a particle file has at least a header such as x,y,r"),
        (b"x,y\n1,2\n", "csv", NONE, "p holds no radii; give --radius R (half the diameter), or add a column named r"),
        (b"x,y,r\n1,2,3\n", "csv", HALF, "p holds radii, but the radius 0.5 was given too; leave one out"),
        (b"x,y,r\n1,2,3\n1,2\n", "csv", NONE, "p:3: 2 columns where 3 are expected, separated by ','; mend or remove the line"),
        (b"x;y;r\n1,2,3\n", "csv", NONE, "p:2: 1 columns where 3 are expected, separated by ';'; mend or remove the line"),
        (b"x,y,r\n1,b,3\n", "csv", NONE, "p:2: column 'y': 'b' is not a number; mend or remove the line"),
        (b"x,y,r\n1,,3\n", "csv", NONE, "p:2: column 'y': '' is not a number; mend or remove the line"),
        (b"x,y,r\n\n1,nan,3\n", "csv", NONE, "p:3: column 'y': 'nan' is not a finite number; mend or remove the line"),
        (b"x,y,r\n1,2,1e999\n", "csv", NONE, "p:2: column 'r': '1e999' is not a finite number; mend or remove the line"),
        (b"x,y,D\n1,2,-3\n", "csv", NONE, "p:2: column 'D': '-3' is negative; mend or remove the line"),
        (b"x,y,x\n", "csv", NONE, "p:1: the column 'x' stands twice; remove one"),
        (b"x,y,r,d\n", "csv", NONE, "p:1: there are a radius and a diameter column; remove one"),
        (
            b"a,b\n1,2\n",
            "csv",
            HALF,
            "p:1: there is no column 'x' among 'a', 'b'; name the columns x,y[,z][,r], with r, radius, d or diameter",
        ),
        (b"1,2,3\n", "csv", NONE, "p:1: three columns without a header may be x,y,z or x,y,r; put a header line before them"),
        (b"1,2,3,4,5\n", "csv", NONE, "p:1: 5 columns without a header; put a header line such as x,y,z,r before them"),
        (
            b"x,y,r\n1,2,3\n",
            "csv",
            Options { radius: None, dim: Some(3), ..NONE },
            "p holds plane points (x and y only); it cannot be read as 3D: add a column z",
        ),
        (b"x,y,z,r\n1,2,0,3\n1,2,5,3\n", "csv", plane, "p: particle 1 has z = 5; only particles with z = 0 can be read as 2D"),
        (b"x,y\n", "csv", Options { radius: Some(-1.0), dim: None, ..NONE }, "the radius given is -1; it must be finite and not negative"),
        (b"x,y\n", "csv", Options { radius: None, dim: Some(4), ..NONE }, "the dimension given is 4; it must be 2 or 3"),
        (&long, "csv", NONE, "p:2: the line is longer than 1048576 bytes; this is not a particle file"),
        (b"ITEM: TIMESTEP\n", "dump", NONE, "p is cut off in a header; write it again"),
        (b"# vtk DataFile\n", "vtk", NONE, "p is cut off in its header; write it again"),
        (b"two\n", "xyz", HALF, "p:1: 'two' is not the number of particles, which is the first line of an XYZ file"),
        (b"5000000000\n", "xyz", HALF, "p:1: 5000000000 particles; at most 2^32 - 1 = 4294967295 can be numbered: split the file"),
        (b"2\n\nA 1 2 3\n", "xyz", HALF, "p ends after 1 of the 2 particles that its first line announces; mend the number or the file"),
        (
            b"1\n\nA 1 2 3\n1\n\n",
            "xyz",
            HALF,
            "p:4: a second frame begins; say which one is to be read, with --frame 0 (the first) to --frame last, or remove the others",
        ),
        (b"1\n\nA 1 2\n", "xyz", HALF, "p:3: 3 columns where 4 are expected (species x y z)"),
        (b"1\n\nA 1 2 x\n", "xyz", HALF, "p:3: column 'z': 'x' is not a number; mend or remove the line"),
        (
            b"1\n\nA 1 2 3 4\n",
            "xyz",
            NONE,
            "p:3: 5 columns in a plain XYZ file: it is not known whether the others are radii; \
             give --radius R to skip them, or name them in line 2 as in Properties=species:S:1:pos:R:3:radius:R:1",
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
            "p:2: Properties=pos:R: it must be triples name:type:number, as in species:S:1:pos:R:3:radius:R:1",
        ),
        (b"1\nProperties=pos:R:4\n", "xyz", HALF, "p:2: Properties=pos:R:4: pos has 4 columns; it must have 2 or 3"),
        (b"1\nProperties=pos:R:0\n", "xyz", HALF, "p:2: Properties=pos:R:0: '0' is not a number of columns from 1 to 1000"),
        (b"x,y\n", "npy", HALF, "p is not a NumPy file: it does not begin with \\x93NUMPY; write it with numpy.save"),
        (b"\x93NUMPY", "npy", HALF, "p: the npy header is cut off; write the file again"),
        (b"\x93NUMPY\x04\0\0\0", "npy", HALF, "p is npy version 4; versions 1 to 3 are read: write it with numpy.save"),
        (b"\x93NUMPY\x02\0\0\0\0\x80", "npy", HALF, "p: the npy header has 2147483648 bytes; at most 1048576 are read"),
        (&short_data, "npy", HALF, "p: 1000000000000 particles; at most 2^32 - 1 = 4294967295 can be numbered: split the file"),
        (&huge, "npy", HALF, "p ends before the 4000000000 x 3 numbers that its header announces; write it again"),
        (&nan, "npy", HALF, "p: particle 1 (from 0): y is NaN; it must be finite: mend or remove the row"),
        (&negative, "npy", NONE, "p: particle 0 (from 0): the radius -1 is negative; mend or remove the row"),
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
        (npy("<i8", "False", "(1, 2)", &[]), "the type '<i8' is not read; convert with .astype('f8')"),
        (npy("<f8", "Maybe", "(1, 2)", &[]), "fortran_order is neither True nor False"),
    ] {
        let message = read(&bytes, "npy", HALF).unwrap_err();
        assert!(message.contains(part), "{message}");
    }
    let wide = format!("1\nProperties=pos:R:3{}\n", ":v:R:1000".repeat(10));
    let message = read(wide.as_bytes(), "xyz", HALF).unwrap_err();
    assert!(message.ends_with("it announces more than 10000 columns; remove what is not needed"), "{message}");
    assert_eq!(read(b"x,y,r\n1,2,3\n", "csv", space).unwrap_err(), "p holds radii, but the radius 1 was given too; leave one out");
    let missing = scene(Path::new("/nowhere/p.csv"), NONE).unwrap_err();
    assert!(format!("{missing:#}").starts_with("cannot read /nowhere/p.csv: "), "{missing:#}");
    assert!(scene(Path::new("/"), NONE).is_err());
}

/// Damaged files give scenes or sentences, never a panic. The seed is fixed, so that a failure comes back.
#[test]
fn damaged_bytes_never_panic() {
    let files: [(&[u8], &str); 5] = [
        (b"x,y,z,r\n1,2,3,0.5\n4,5,6,0.5\n", "csv"),
        (b"# x y r\n1 2 3\n4 5 6\n", "txt"),
        (b"2\nProperties=\"species:S:1:pos:R:3:radius:R:1\" a='b c'\nA 1 2 3 4\nB 5 6 7 8\n", "xyz"),
        (&npy("<f8", "False", "(2, 4)", &doubles(&[0.5; 8])), "npy"),
        (&npy(">f4", "True", "(2, 3)", &[0; 24]), "npy"),
    ];
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let (mut good, mut bad) = (0, 0);
    for (bytes, ending) in files {
        let options = [NONE, HALF, Options { radius: None, dim: Some(2), ..NONE }, Options { radius: Some(1.0), dim: Some(3), ..NONE }];
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

#[test]
fn pairs_are_written_as_csv_and_npy() {
    let folder = tempfile::tempdir().unwrap();
    let list = [[0, 1], [7, 0xfedc_ba98]];
    let path = folder.path().join("pairs.CSV");
    write::pairs(&path, &list).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "i,j\n0,1\n7,4275878552\n");
    let path = folder.path().join("pairs.npy");
    for list in [&list[..], &[]] {
        write::pairs(&path, list).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let start = bytes.len() - 8 * list.len();
        assert_eq!(start % 64, 0);
        assert_eq!((&bytes[..8], usize::from(bytes[8])), (b"\x93NUMPY\x01\0".as_slice(), start - 10));
        let header = format!("{{'descr': '<u4', 'fortran_order': False, 'shape': ({}, 2), }}", list.len());
        assert_eq!(std::str::from_utf8(&bytes[10..start]).unwrap().trim_end(), header);
        assert_eq!(bytes[start - 1], b'\n');
        let words: Vec<u32> = bytes[start..].as_chunks().0.iter().map(|&word| u32::from_le_bytes(word)).collect();
        assert_eq!(words, list.as_flattened());
    }
    let message = write::pairs(Path::new("pairs.txt"), &list).unwrap_err().to_string();
    assert_eq!(message, "pairs.txt: the ending of a file of pairs must be .csv, .npy or .vtk");
    assert!(
        format!("{:#}", write::pairs(Path::new("/nowhere/pairs.csv"), &list).unwrap_err()).starts_with("cannot write /nowhere/pairs.csv: ")
    );
}

/// A scene written as CSV in shortest form comes back to the bit.
#[test]
fn csv_gives_back_every_bit() {
    let scene = crate::scene::spec::Spec::parse("clustered:dim=3,n=500,size-ratio=7").unwrap().make().unwrap();
    let text: String = rows(&scene).iter().map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(",") + "\n").collect();
    assert_eq!(read(format!("x,y,z,r\n{text}").as_bytes(), "csv", NONE).unwrap(), scene);
}

/// Sizes as listed in the data folder's index; the folder is not part of the project.
#[test]
fn real_files_have_their_number_of_particles() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    if !data.is_dir() {
        eprintln!("skipped: no folder {}", data.display());
        return;
    }
    for (file, radius, n, dim) in [
        ("liggghts_packing/packing.csv", None, 22_410, 3),
        ("rcp_packing/centres.npy", Some(0.5), 10_000, 3),
        ("galaxies/xyz.npy", Some(1.0), 84_383, 3),
        ("craters/craters.csv", None, 24_520, 2),
    ] {
        let scene = scene(&data.join(file), Options { radius, dim: None, ..NONE }).unwrap_or_else(|error| panic!("{error:#}"));
        assert_eq!((scene.len(), scene.dim(), scene.uniform()), (n, dim, radius.is_some()), "{file}");
    }
}
