//! Files that people bring: every format by example, plain and compressed; which frame; where an
//! error is; what false promises cost.

use std::io::{BufReader, Read, Write};

use contactbench::io::{Frame, Options, RadiusSource};
use contactbench::run::alloc;
use contactbench::scene::{AnyScene, Real};
use contactbench::{io, with_scene};
use flate2::Compression;
use flate2::write::{DeflateEncoder, GzEncoder, ZlibEncoder};

use crate::{loud, quiet};

const NONE: Options = Options::NONE;
const HALF: Options = Options { radius: Some(0.5), ..NONE };

fn load(
    bytes: &[u8],
    ending: &str,
    options: Options,
) -> Result<(io::Particles, io::About), String> {
    io::load_from(bytes, "p", ending, options).map_err(|error| format!("{error:#}"))
}

fn refusal(bytes: &[u8], ending: &str, options: Options) -> String {
    let message = load(bytes, ending, options)
        .map(|(particles, about)| panic!("{about:?} {particles:?}"))
        .unwrap_err();
    assert!(!message.contains(char::is_control), "{message:?}");
    message
}

/// Coordinates and radii of all particles, one list each.
fn rows(scene: &AnyScene<'_>) -> Vec<Vec<f64>> {
    with_scene!(scene, scene => (0..scene.len())
        .map(|k| scene.centres()[k].iter().map(|x| x.wide()).chain([scene.radius(k).wide()]).collect())
        .collect())
}

fn read_rows(bytes: &[u8], ending: &str, options: Options) -> (Vec<Vec<f64>>, io::About) {
    let (particles, about) =
        load(bytes, ending, options).unwrap_or_else(|error| panic!("{ending}: {error}"));
    (rows(&particles.scene("p", options.radius).unwrap()), about)
}

fn gz(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn base64(bytes: &[u8]) -> String {
    let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group =
        |group: &[u8]| -> String {
            let bits = group
                .iter()
                .chain([0, 0].iter())
                .take(3)
                .fold(0usize, |bits, &b| bits << 8 | usize::from(b));
            (0..4)
                .map(|k| {
                    if k > group.len() {
                        '='
                    } else {
                        char::from(letters[bits >> (18 - 6 * k) & 63])
                    }
                })
                .collect()
        };
    bytes.chunks(3).map(group).collect()
}

fn le(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn be32(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_be_bytes()).collect()
}

fn npy(shape: &str, values: &[f64]) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
    [
        b"\x93NUMPY\x01\x00".as_slice(),
        &(header.len() as u16).to_le_bytes(),
        header.as_bytes(),
        &le(values),
    ]
    .concat()
}

/// A zip archive as numpy.savez (stored) or numpy.savez_compressed (deflated) writes it; `streamed`
/// as to a pipe, sizes behind the data.
fn npz(files: &[(&str, Vec<u8>)], deflated: bool, streamed: bool) -> Vec<u8> {
    let mut archive = Vec::new();
    for (name, plain) in files {
        let data = if deflated {
            let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(plain).unwrap();
            encoder.finish().unwrap()
        } else {
            plain.clone()
        };
        let (flags, size) = if streamed { (8u16, 0) } else { (0, u32::MAX) };
        archive.extend(b"PK\x03\x04\x2d\x00");
        archive.extend(flags.to_le_bytes());
        archive.extend((if deflated { 8u16 } else { 0 }).to_le_bytes());
        archive.extend([0; 8]);
        archive.extend(size.to_le_bytes());
        archive.extend(size.to_le_bytes());
        archive.extend((name.len() as u16).to_le_bytes());
        archive.extend((if streamed { 0u16 } else { 20 }).to_le_bytes());
        archive.extend(name.as_bytes());
        if streamed {
            archive.extend(&data);
            archive.extend(b"PK\x07\x08\0\0\0\0\0\0\0\0\0\0\0\0");
        } else {
            archive.extend([1, 0, 16, 0]);
            archive.extend((plain.len() as u64).to_le_bytes());
            archive.extend((data.len() as u64).to_le_bytes());
            archive.extend(&data);
        }
    }
    archive.extend(b"PK\x01\x02 and so on");
    archive
}

const DUMP: &str = "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n0 \
                    4\n-1 1\n0 10\nITEM: ATOMS id vx radius z y x type\n7 0 0.5 3 2 1 1\n3 0 0.25 \
                    6 5 4 1\n";
const DATA: &str = "made by hand\n\n2 atoms\n1 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo \
                    zhi\n\nMasses\n\n1 1.0\n\nAtoms # sphere\n\n7 1 1.0 2500 1 2 3\n3 1 0.5 2500 \
                    4 5 6 0 0 -1 # the second\n\nVelocities\n\n7 0 0 0 0 0 0\n";
const MERCURY: &str =
    "2 0.5 0 0 0 9 9 9\n1 2 3 0 0 0 0.5 0 0 0 0 0 7 0\n4 5 6 0 0 0 0.25 0 0 0 0 0 7 0\n";
const VTK_HEAD: &str = "# vtk DataFile Version 3.0\nparticles\n";
const PLY_HEAD: &str = "ply\nformat FORMAT 1.0\ncomment none\nelement vertex 2\nproperty float \
                        x\nproperty float y\nproperty float z\nproperty uchar red\nproperty float \
                        scalar_radius\nelement face 1\nproperty list uchar int \
                        vertex_indices\nend_header\n";

fn vtp(format: &str, attributes: &str, points: &str, radii: &str, after: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<!-- a > b -->\n<VTKFile type=\"PolyData\" \
         byte_order=\"LittleEndian\" {attributes}>\n<PolyData>\n<Piece NumberOfPoints=\"2\" \
         NumberOfVerts=\"0\">\n<PointData Scalars=\"radius\">\n<DataArray type=\"Int32\" \
         Name=\"kind\" format=\"ascii\">\n1 2\n</DataArray>\n<DataArray type=\"Float64\" \
         Name=\"radius\" {format} \
         offset=\"OFFSET\">{radii}</DataArray>\n</PointData>\n<Points>\n<DataArray \
         type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" {format} \
         offset=\"0\">{points}</DataArray>\n</Points>\n</Piece>\n</PolyData>\n{after}</VTKFile>\n"
    )
}

/// Length and numbers as VTK writes them; compressed in blocks of one or two numbers.
fn block(values: &[f64], compressed: bool) -> (Vec<u8>, Vec<u8>) {
    if !compressed {
        return ([&(8 * values.len() as u32).to_le_bytes(), &le(values)[..]].concat(), Vec::new());
    }
    let blocks: Vec<Vec<u8>> = values.chunks(4).map(|values| zlib(&le(values))).collect();
    let last = 8 * (values.len() % 4);
    let mut head: Vec<u32> = vec![blocks.len() as u32, 32, last as u32];
    head.extend(blocks.iter().map(|block| block.len() as u32));
    (head.iter().flat_map(|n| n.to_le_bytes()).collect(), blocks.concat())
}

/// All formats with the same two particles, told by their content.
fn all() -> Vec<(&'static str, Vec<u8>)> {
    let (flat, radii) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [0.5, 0.25]);
    let points = "1 2 3\n4\n5 6\n";
    let vtk_ascii = format!(
        "{VTK_HEAD}ASCII\nDATASET POLYDATA\nPOINTS 2 double\n{points}VERTICES 2 4\n1 0\n1 \
         1\n\nPOINT_DATA 2\nVECTORS v float\n0 0 0 1 1 1\nSCALARS kind int\nLOOKUP_TABLE \
         default\n1 1\nFIELD FieldData 2\nmass 1 2 double\n3 3\ndiameter 1 2 double\n1.0 0.5\n"
    );
    let vtk_binary = [
        format!("{VTK_HEAD}BINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 2 float\n").as_bytes(),
        &be32(&flat.map(|x| x as f32)),
        b"\nCELLS 3 2\nOFFSETS vtktypeint64\n\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\n\0\0\0\0\0\0\0\0\nCONNECTIVITY vtktypeint64\n",
        &[10; 16],
        b"\nCELL_TYPES 2\n\0\0\0\x01\0\0\0\x01\nPOINT_DATA 2\nSCALARS radius float 1\nLOOKUP_TABLE default\n",
        &be32(&radii.map(|x| x as f32)),
        b"\nMETADATA\nINFORMATION 0\n\nCELL_DATA 2\n\xff\xff\xff",
    ]
    .concat();
    let ascii = vtp("format=\"ascii\"", "", "\n1 2 3\n  4 5 6\n", "0.5 0.25", "");
    let inline = |compressed| {
        let text = |values: &[f64]| {
            let (head, data) = block(values, compressed);
            format!("\n   {}{}\n", base64(&head), base64(&data))
        };
        let compressor = if compressed {
            "compressor=\"vtkZLibDataCompressor\" header_type=\"UInt32\""
        } else {
            ""
        };
        vtp("format=\"binary\"", compressor, &text(&flat), &text(&radii), "").into_bytes()
    };
    let appended = |compressed, raw| {
        let encode = |values: &[f64]| {
            let (head, data) = block(values, compressed);
            if raw {
                [head, data].concat()
            } else {
                [base64(&head), base64(&data)].concat().into_bytes()
            }
        };
        let (first, second) = (encode(&flat), encode(&radii));
        let encoding = if raw { "raw" } else { "base64" };
        let compressor = if compressed { "compressor=\"vtkZLibDataCompressor\"" } else { "" };
        let text = vtp(
            "format=\"appended\"",
            compressor,
            "",
            "",
            &format!("<AppendedData encoding=\"{encoding}\">\n  _"),
        );
        let text = text.replace("OFFSET", &(first.len() + 3).to_string());
        let start = text.find("  _").unwrap() + 3;
        // Between the arrays stands one that nobody asks for.
        [&text.as_bytes()[..start], &first, b"abc", &second, b"\n</AppendedData>\n</VTKFile>\n"]
            .concat()
    };
    let ply = |format: &str, rows: &[u8]| {
        [PLY_HEAD.replace("FORMAT", format).as_bytes(), rows, b"\x03 and faces"].concat()
    };
    let ply_row = |big: bool| -> Vec<u8> {
        let number = |x: f64| if big { (x as f32).to_be_bytes() } else { (x as f32).to_le_bytes() };
        let row = |k: usize| {
            [
                &flat[3 * k..3 * k + 3].iter().flat_map(|&x| number(x)).collect::<Vec<u8>>()[..],
                &[9],
                &number(radii[k]),
            ]
            .concat()
        };
        [row(0), row(1)].concat()
    };
    let table = npy("(2, 4)", &[1.0, 2.0, 3.0, 0.5, 4.0, 5.0, 6.0, 0.25]);
    let axes = [
        ("x.npy", npy("(2,)", &[1.0, 4.0])),
        ("note.txt", b"hello".to_vec()),
        ("y.npy", npy("(2,)", &[2.0, 5.0])),
        ("d.npy", npy("(2,)", &[1.0, 0.5])),
        ("z.npy", npy("(2,)", &[3.0, 6.0])),
    ];
    let whole = [("radii.npy", npy("(2,)", &radii)), ("arr_0.npy", npy("(2, 3)", &flat))];
    vec![
        ("CSV", b"x,y,z,r\n1,2,3,0.5\n4,5,6,0.25\n".to_vec()),
        ("CSV", b"# x y z r\n1 2 3 0.5\n4 5 6 0.25\n".to_vec()),
        (
            "YADE text",
            b"#format x_y_z_r_attrs\n# x y z r material\n1\t2\t3\t.5\t7\n4\t5\t6\t.25\t8\n"
                .to_vec(),
        ),
        ("YADE text", b"#format x_y_z_r_matId\n1 2 3 .5 rock\n4 5 6 .25 sand\n".to_vec()),
        ("XYZ", b"2\n\nA 1 2 3\nB 4 5 6\n".to_vec()),
        ("extended XYZ", b"2\nProperties=id:I:1:pos:R:3:d:R:1\n7 1 2 3 1\n3 4 5 6 .5\n".to_vec()),
        ("LAMMPS dump", DUMP.into()),
        (
            "LAMMPS dump",
            DUMP.replace("z y x type", "zs ys xs type")
                .replace("3 2 1 1", "0.3 1.5 .25 1")
                .replace("6 5 4 1", "0.6 3 1 1")
                .into(),
        ),
        (
            "LAMMPS dump",
            DUMP.replace("z y x type", "zu yu xu type")
                .replace("radius", "diameter")
                .replace("0 0.5", "0 1")
                .replace("0.25", ".5")
                .into(),
        ),
        ("LAMMPS data", DATA.into()),
        (
            "LAMMPS data",
            DATA.replace("sphere", "bpm/sphere")
                .replace("7 1 1.0", "7 0 1 1.0")
                .replace("3 1 0.5", "3 0 1 0.5")
                .into(),
        ),
        ("MercuryDPM data", MERCURY.into()),
        ("NumPy npy", table),
        ("NumPy npz", npz(&axes, false, false)),
        ("NumPy npz", npz(&axes, true, false)),
        ("NumPy npz", npz(&whole, true, true)),
        ("VTK legacy, text", vtk_ascii.into()),
        ("VTK legacy, binary", vtk_binary),
        ("VTK XML", ascii.into()),
        ("VTK XML", inline(false)),
        ("VTK XML", inline(true)),
        ("VTK XML", appended(false, true)),
        ("VTK XML", appended(true, true)),
        ("VTK XML", appended(false, false)),
        ("VTK XML", appended(true, false)),
        ("PLY, text", ply("ascii", b"1 2 3 255 0.5\n4 5 6 0 0.25\n")),
        ("PLY, binary", ply("binary_little_endian", &ply_row(false))),
        ("PLY, binary", ply("binary_big_endian", &ply_row(true))),
    ]
}

#[test]
fn every_format_is_told_by_its_content_and_read() {
    let _guard = loud();
    for (format, bytes) in all() {
        let shown = String::from_utf8_lossy(&bytes).into_owned();
        let radius = if format == "XYZ" { Some(0.5) } else { None };
        let options = Options { radius, ..NONE };
        let second = if format == "XYZ" { 0.5 } else { 0.25 };
        let expected = vec![vec![1.0, 2.0, 3.0, 0.5], vec![4.0, 5.0, 6.0, second]];
        let (rows, about) = read_rows(&bytes, "", options);
        assert_eq!((rows, about.format, about.gzip), (expected.clone(), format, false), "{shown}");
        let (rows, packed) = read_rows(&gz(&bytes), "", options);
        assert_eq!(rows, expected, "{format} in gzip");
        assert!(packed.gzip && packed.format == format);
    }
}

#[test]
fn the_source_of_the_radius_is_known() {
    let _guard = loud();
    let source = |bytes: &[u8], options| load(bytes, "", options).unwrap().1.radius;
    assert_eq!(source(DUMP.as_bytes(), NONE), RadiusSource::Column("radius".into()));
    assert_eq!(source(DATA.as_bytes(), NONE), RadiusSource::Halved("diameter".into()));
    assert_eq!(source(b"x,y\n1,2\n", HALF), RadiusSource::Given);
    let (particles, about) = load(b"x,y\n1,2\n", "", NONE).unwrap();
    assert_eq!(
        (particles.len(), particles.has_radii(), about.radius),
        (1, false, RadiusSource::Missing)
    );
    let (particles, _) = load(DUMP.as_bytes(), "", Options { ids: true, ..NONE }).unwrap();
    assert_eq!(particles.ids(), Some(&[7, 3][..]), "in file order, not sorted");
    // Discs: y, no z, and MercuryDPM's eight columns.
    assert_eq!(read_rows(b"1 0 0 0 9 9\n1 2 0 0 .5 0 0 0\n", "", NONE).0, [[1.0, 2.0, 0.5]]);
    assert_eq!(
        read_rows(b"1 0 0 0 0 9 9 0\n1 2 0 0 .5 0 0 0\n", "data", NONE).0,
        [[1.0, 2.0, 0.5]]
    );
    // Atoms without sizes, and without a style.
    let atomic = DATA
        .replace("Atoms # sphere", "Atoms")
        .replace("1 1.0 2500", "1")
        .replace("1 0.5 2500", "1");
    assert_eq!(
        read_rows(atomic.as_bytes(), "", HALF).0,
        [[1.0, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.5]]
    );
}

#[test]
fn one_of_several_frames_is_read() {
    let _guard = loud();
    let second = DUMP.replace("0.5 3 2 1", "0.5 3 2 9").replace("100", "200");
    let dump = format!("{DUMP}{second}");
    let xyz = "1\n\nA 1 2 3\n1\n\nA 9 2 3\n";
    let mercury = format!("{MERCURY}{}", MERCURY.replace("\n1 2 3", "\n9 2 3"));
    for text in [&dump, xyz, &mercury] {
        let first_x = |frame, survey| {
            let radius = text.starts_with("1\n").then_some(0.5);
            load(text.as_bytes(), "", Options { frame, survey, radius, ..NONE })
                .map(|(particles, about)| (particles.centre(0)[0], about.frame, about.frames))
        };
        assert_eq!(first_x(Frame::Number(0), true), Ok((1.0, 0, 2)));
        assert_eq!(first_x(Frame::Number(1), false), Ok((9.0, 1, 2)));
        assert_eq!(first_x(Frame::Last, false), Ok((9.0, 1, 2)));
        assert!(
            first_x(Frame::Only, false)
                .unwrap_err()
                .contains("a second frame begins; say which one")
        );
        assert_eq!(
            first_x(Frame::Number(2), false).unwrap_err(),
            "p holds 2 frames, numbered from 0; there is no frame 2"
        );
    }
    // A frame that is cut off hides those before it only from those who ask for the last.
    let cut = &dump[..dump.len() - 20];
    assert!(load(cut.as_bytes(), "", Options { frame: Frame::Number(0), ..NONE }).is_ok());
    assert!(
        load(cut.as_bytes(), "", Options { frame: Frame::Last, ..NONE })
            .unwrap_err()
            .starts_with("p")
    );
}

#[test]
fn errors_say_where() {
    let _guard = loud();
    let scaled = DUMP.replace("z y x type", "zs ys xs type");
    let vtk = |body: &str| format!("{VTK_HEAD}ASCII\nDATASET POLYDATA\n{body}");
    let cases: Vec<(String, &str)> = vec![
        (
            DUMP.replace("4 1\n", "four 1\n"),
            "p:11: column 'x': 'four' is not a number; mend or remove the line",
        ),
        (
            DUMP.replace("3 0 0.25 6 5 4 1\n", "3 0 0.25 6 5\n"),
            "p:11: 5 columns where 7 are expected by ITEM: ATOMS",
        ),
        (
            DUMP.replace("0.25", "-1"),
            "p:11: column 'radius': '-1' is negative; mend or remove the line",
        ),
        (
            DUMP.replace("0.25", "nan"),
            "p:11: column 'radius': 'nan' is not a finite number; mend or remove the line",
        ),
        (
            DUMP.replace("ATOMS\n2\n", "ATOMS\n3\n"),
            "p ends after 2 of the 3 atoms that its header announces; write it again, or take an \
             earlier --frame",
        ),
        (
            DUMP.replace("ATOMS\n2\n", "ATOMS\n1000000000000000000\n"),
            "p:4: 1000000000000000000 particles; at most 2^32 - 1 = 4294967295 can be numbered: \
             split the file",
        ),
        (
            DUMP.replace("ATOMS\n2\n", "ATOMS\n1\n"),
            "p:11: '3 0 0.25 6 5 4 1' stands where a line 'ITEM: ...' is expected; mend the file",
        ),
        (
            DUMP.replace(" x type", " vz type"),
            "p:9: there is no column 'x' among 'id', 'vx', 'radius', 'z', 'y', 'vz', 'type'; name \
             the columns x,y[,z][,r], with r, radius, d or diameter",
        ),
        (
            DUMP.replace("-1 1\n", "-1 one\n"),
            "p:7: column 2: 'one' is not a finite number; a bound of the box is expected",
        ),
        (
            scaled.replace(
                "BOUNDS pp pp ff\n0 4\n-1 1\n0 10\n",
                "BOUNDS xy xz yz pp pp pp\n0 4 0\n-1 1 0\n0 10 0\n",
            ),
            "p:9: the coordinates are scaled (xs) by a tilted (triclinic) box, which is not read; \
             write x y z instead of xs ys zs",
        ),
        (
            DATA.replace("4 5 6", "4 5 a"),
            "p:16: column 'z': 'a' is not a number; mend or remove the line",
        ),
        (
            DATA.replace("# sphere", "# wavepacket"),
            "p:13: the atom style 'wavepacket' is not read, only",
        ),
        (
            DATA.replace(" # sphere", ""),
            "p:15: 7 columns, and no atom style behind 'Atoms': several are possible",
        ),
        (
            MERCURY.replace("4 5 6", "4 5 x"),
            "p:3: column 'z': 'x' is not a number; mend or remove the line",
        ),
        (
            MERCURY.replacen("2 ", "3 ", 1),
            "p ends after 2 of the 3 particles that the frame's first line announces",
        ),
        (
            MERCURY.replacen("2 ", "1 ", 1),
            "p:3: a line 'N time xmin ymin zmin xmax ymax zmax' is expected",
        ),
        (
            vtk("POINTS 2 double\n1 2 3\n4 5 b6\n"),
            "p:7:5: POINTS: 'b6' is not a number; mend the file",
        ),
        (
            vtk("POINTS 2 double\n1 2 3\n4 inf 6\n"),
            "p:7:3: POINTS: point 1 (from 0): y is inf; it must be finite",
        ),
        (
            vtk("POINTS 2 double\n1 2 3\n4 5\n"),
            "p ends before all numbers of POINTS that it announces; write it again",
        ),
        (
            vtk("POINTS 1 double\n1 2 3\n4 5 6\n"),
            "p:7: '4 5 6' is no part of a VTK file that is known here; is an array before it too \
             long or too short?",
        ),
        (vtk("POINTS 1 double\n1 2 3 4\n"), "p:6: '4' stands behind the 3 numbers of POINTS"),
        (
            vtk("POINTS 1 string\n1 2 3\n"),
            "p:5: numbers of type 'string' are not read; write float or double",
        ),
        (
            vtk("POINTS 1 float\n1 2 3\nPOINT_DATA 2\n"),
            "p:7: data of 2 points, but there are 1 POINTS; write it again",
        ),
        (
            vtk("DIMENSIONS 1 1 1\n"),
            "p holds no points; write them as POINTS, or as CSV with a header x,y,z,r",
        ),
        (
            vtp("format=\"ascii\"", "", "1 2 3 4 5 q", "1 1", ""),
            "p:13: number 6 of the array: 'q' is not a number",
        ),
        (
            vtp("format=\"ascii\"", "", "1 2 3 4 5", "1 1", ""),
            "p:13: the array ends after 5 of its 6 numbers; write the file again",
        ),
        (
            vtp("format=\"ascii\"", "", "1 2 3 4 5 6 7", "1 1", ""),
            "p:13: the array goes on after its 6 numbers; write the file again",
        ),
        (
            vtp("format=\"ascii\"", "", "1 2 3 4 5 6", "1 -1", ""),
            "p:10: point 1 (from 0): 'radius': -1 is negative",
        ),
        (
            vtp("format=\"ascii\"", "compressor=\"vtkLZ4DataCompressor\"", "", "", ""),
            "p:3: compressed by vtkLZ4DataCompressor, which is not read",
        ),
        (vtp("format=\"binary\"", "", "A*AA", "AAAA", ""), "p:10: its length is cut off"),
        (
            vtp("format=\"appended\"", "", "", "", "").replace("OFFSET", "9"),
            "p ends before its AppendedData; write it again",
        ),
        ("<html>\n<body>".into(), "p:1: '<html' begins what is no VTK XML file"),
        (
            PLY_HEAD.replace("FORMAT", "ascii") + "1 2 3 0 .5\n1 2 x 0 .5\n",
            "p:14: column 'z': 'x' is not a number; mend or remove the line",
        ),
        (
            PLY_HEAD.replace("FORMAT", "ascii") + "1 2 3 0 .5\n",
            "p ends after 1 of the 2 vertices that its header announces; write it again",
        ),
        (
            PLY_HEAD.replace("FORMAT", "binary_little_endian") + "1234567890",
            "p ends after 0 of the 2 vertices that its header announces",
        ),
        (
            PLY_HEAD.replace("FORMAT", "ascii").replace("property float y", "property real y"),
            "p:6: 'real' is no type of number",
        ),
        (
            "\0\x01\x02ELF".into(),
            "p is binary, in no format that is known; write its particles as npy, or as CSV",
        ),
        (
            "x,y,r\n1,\x1b[31m,3\n".into(),
            "p:2: column 'y': '\u{fffd}[31m' is not a number; mend or remove the line",
        ),
    ];
    for (text, message) in cases {
        let found = refusal(text.as_bytes(), "", NONE);
        assert!(found.starts_with(message), "\n{found}\n{message}");
    }
    assert_eq!(
        refusal(b"x,y,r\n1,2,3\n", "vtk", NONE),
        "p is not a VTK legacy file: it does not begin with # vtk"
    );
    assert!(refusal(&gz(&gz(b"x,y,r\n1,2,3\n")), "", NONE).contains("compressed twice"));
    let mut damaged = gz(format!("x,y,r\n{}", "1,2,3\n".repeat(1000)).as_bytes());
    damaged.truncate(damaged.len() / 2);
    let found = refusal(&damaged, "", NONE);
    assert!(found.starts_with("cannot read p"), "{found}");
}

/// What a file promises costs nothing: memory follows the bytes that are there.
#[test]
fn promises_and_bombs_are_bounded() {
    let _guard = quiet();
    let bounded = |bytes: &[u8], options| {
        let (message, usage) = alloc::measure(|| refusal(bytes, "", options));
        let peak = usage.expect("the counting allocator is installed").peak_bytes;
        assert!(peak < 4 << 20, "{peak} bytes for: {message}");
        message
    };
    let many = 4_000_000_000u64;
    bounded(DUMP.replace("ATOMS\n2\n", &format!("ATOMS\n{many}\n")).as_bytes(), NONE);
    bounded(DATA.replace("2 atoms", &format!("{many} atoms")).as_bytes(), NONE);
    bounded(MERCURY.replacen("2 ", &format!("{many} "), 1).as_bytes(), NONE);
    bounded(
        format!("{VTK_HEAD}BINARY\nDATASET POLYDATA\nPOINTS {many} double\nabc").as_bytes(),
        HALF,
    );
    bounded(
        PLY_HEAD
            .replace("FORMAT", "binary_little_endian")
            .replace("vertex 2", &format!("vertex {many}"))
            .as_bytes(),
        NONE,
    );
    bounded(
        vtp("format=\"binary\"", "", "AAAAAAAA", "AAAAAAAA", "")
            .replace("NumberOfPoints=\"2\"", &format!("NumberOfPoints=\"{many}\""))
            .as_bytes(),
        NONE,
    );
    bounded(&npz(&[("arr_0.npy", npy(&format!("({many}, 3)"), &[1.0]))], true, false), HALF);
    bounded(&npy(&format!("({many}, 3)"), &[1.0]), HALF);

    // Seventy megabytes of nothing in seventy kilobytes.
    let line = [b"#".as_slice(), &[b' '; 1022], b"\n"].concat();
    let message = bounded(&gz(&line.repeat(1000)).repeat(70), NONE);
    assert!(message.contains("unpacks to more than 200 times its size"), "{message}");

    // A line without end; the reader would go on for ever.
    struct Endless;
    impl Read for Endless {
        fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
            bytes.fill(b'1');
            Ok(bytes.len())
        }
    }
    let (result, usage) =
        alloc::measure(|| io::load_from(BufReader::new(Endless), "p", "csv", NONE));
    assert_eq!(
        result.unwrap_err().to_string(),
        "p:1: the line is longer than 1048576 bytes; this is not a particle file"
    );
    assert!(usage.unwrap().peak_bytes < 4 << 20);
}

/// A hundred and sixty megabytes in some kilobytes: each layer is in proportion to the one around
/// it, and the whole is not.
#[test]
fn layers_of_compression_are_bounded_together() {
    let _guard = quiet();
    // What cannot be made smaller, and zeros: a hundredth and a half of it.
    let mut state = 1u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 12) as f64
    };
    let piece: Vec<f64> = (0..8192).map(|k| if k < 96 { noise() } else { 0.0 }).collect();
    let (piece, pieces) = (le(&piece), 2562);
    let refused = |bytes: &[u8]| {
        assert!(bytes.len() < 200_000, "{} bytes", bytes.len());
        let (message, usage) = alloc::measure(|| refusal(bytes, "", HALF));
        assert!(message.contains("unpacks to more than 200 times its size"), "{message}");
        let peak = usage.expect("the counting allocator is installed").peak_bytes;
        assert!(peak < 100 << 20, "{peak} bytes");
    };

    // One piece in deflate, ended so that it can be repeated.
    let mut deflate = flate2::Compress::new(Compression::best(), false);
    let mut packed = Vec::with_capacity(1 << 16);
    let header = npy(&format!("({}, 4)", pieces * piece.len() / 32), &[]);
    deflate.compress_vec(&header, &mut packed, flate2::FlushCompress::Full).unwrap();
    let start = packed.len();
    deflate.compress_vec(&piece, &mut packed, flate2::FlushCompress::Full).unwrap();
    let repeated = packed[start..].repeat(pieces);
    let member = [&packed[..start], &repeated, b"\x03\x00"].concat();
    assert!(member.len() * 100 > pieces * piece.len(), "the inner layer alone is in proportion");
    let mut archive = b"PK\x03\x04\x2d\0\0\0\x08\0\0\0\0\0\0\0\0\0".to_vec();
    archive.extend((member.len() as u32).to_le_bytes());
    archive.extend([0; 4]);
    archive.extend(b"\x09\0\0\0arr_0.npy");
    archive.extend(&member);
    archive.extend(b"PK\x01\x02 and so on");
    refused(&gz(&archive));

    let block = zlib(&piece);
    let mut data: Vec<u8> = [pieces as u32, piece.len() as u32, 0]
        .into_iter()
        .chain(std::iter::repeat_n(block.len() as u32, pieces))
        .flat_map(u32::to_le_bytes)
        .collect();
    data.extend(block.repeat(pieces));
    let vtu = format!(
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" \
         compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid><Piece \
         NumberOfPoints=\"{}\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" \
         format=\"appended\" offset=\"0\"/></Points></Piece></UnstructuredGrid><AppendedData \
         encoding=\"raw\">_",
        pieces * piece.len() / 24
    );
    refused(&gz(&[vtu.as_bytes(), &data, b"</AppendedData></VTKFile>"].concat()));
}

/// Reading takes at most 2.5 times the bytes of the coordinates, radii and buffers included.
#[test]
fn reading_takes_little_more_than_the_coordinates() {
    let _guard = quiet();
    let n = 150_000;
    let numbers =
        |k: usize| [k as f64 * 1.25, k as f64 / 3.0, 7.0 - k as f64, 1.0 + (k % 7) as f64];
    let text: String = (0..n).map(|k| numbers(k).map(|x| x.to_string()).join(",") + "\n").collect();
    let flat: Vec<f64> = (0..n).flat_map(numbers).collect();
    for bytes in [format!("x,y,z,r\n{text}").into_bytes(), npy(&format!("({n}, 4)"), &flat)] {
        let (scene, usage) = alloc::measure(|| io::from(&bytes[..], "p", "", NONE).unwrap());
        let peak = usage.expect("the counting allocator is installed").peak_bytes;
        assert_eq!(scene.len(), n);
        let most = 5 * (24 * n as u64) / 2;
        println!("{peak} bytes, {:.2} times the coordinates", peak as f64 / (24 * n) as f64);
        assert!(peak <= most, "{peak} bytes; at most {most}");
    }
}
