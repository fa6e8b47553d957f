//! A file of every format.

use std::io::Write;

use flate2::Compression;
use flate2::write::DeflateEncoder;

use super::zlib;

pub fn base64(bytes: &[u8]) -> String {
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

pub fn le(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

pub fn be32(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_be_bytes()).collect()
}

pub fn npy(shape: &str, values: &[f64]) -> Vec<u8> {
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
pub fn npz(files: &[(&str, Vec<u8>)], deflated: bool, streamed: bool) -> Vec<u8> {
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

pub const DUMP: &str = "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n0 \
                    4\n-1 1\n0 10\nITEM: ATOMS id vx radius z y x type\n7 0 0.5 3 2 1 1\n3 0 0.25 \
                    6 5 4 1\n";

pub const DATA: &str = "made by hand\n\n2 atoms\n1 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo \
                    zhi\n\nMasses\n\n1 1.0\n\nAtoms # sphere\n\n7 1 1.0 2500 1 2 3\n3 1 0.5 2500 \
                    4 5 6 0 0 -1 # the second\n\nVelocities\n\n7 0 0 0 0 0 0\n";

pub const MERCURY: &str =
    "2 0.5 0 0 0 9 9 9\n1 2 3 0 0 0 0.5 0 0 0 0 0 7 0\n4 5 6 0 0 0 0.25 0 0 0 0 0 7 0\n";

pub const VTK_HEAD: &str = "# vtk DataFile Version 3.0\nparticles\n";

pub const PLY_HEAD: &str = "ply\nformat FORMAT 1.0\ncomment none\nelement vertex 2\nproperty float \
                        x\nproperty float y\nproperty float z\nproperty uchar red\nproperty float \
                        scalar_radius\nelement face 0\nproperty list uchar int \
                        vertex_indices\nend_header\n";

pub fn vtp(format: &str, attributes: &str, points: &str, radii: &str, after: &str) -> String {
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
pub fn block(values: &[f64], compressed: bool) -> (Vec<u8>, Vec<u8>) {
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
pub fn all() -> Vec<(&'static str, Vec<u8>)> {
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
