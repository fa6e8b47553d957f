use super::*;
use crate::{Format, Frame, Options, load_from};

/// The beginning of a file of each format.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let zip = |name: &str| {
        let length = (name.len() as u16).to_le_bytes();
        [b"PK\x03\x04", &[0; 22][..], &length, &[0, 0], name.as_bytes(), b"abc"].concat()
    };
    let triangles = [&[b' '; 80][..], &[9, 0, 0, 0], &triangle().repeat(9)].concat();
    let bytes = |bytes: &[u8]| [bytes, &[0, 7, 0, 9][..]].concat();
    let mut samples = vec![
        ("compressed with bzip2", bytes(b"BZh91AY&SY")),
        ("compressed with xz", bytes(b"\xfd7zXZ\0")),
        ("compressed with lzma", bytes(b"]\0\0")),
        ("compressed with zstd", bytes(b"(\xb5/\xfd")),
        ("compressed with lz4", bytes(b"\x04\"M\x18")),
        ("compressed with compress", bytes(b"\x1f\x9d")),
        ("a 7z archive", bytes(b"7z\xbc\xaf\x27\x1c")),
        ("a rar archive", bytes(b"Rar!\x1a\x07")),
        ("a tar archive", [b"p.csv", &[0; 252][..], b"ustar\0"].concat()),
        ("an Excel workbook", zip("[Content_Types].xml")),
        ("a zip archive whose first file is not a NumPy array", zip("c.dump")),
        ("an HDF5 file", bytes(b"\x89HDF\r\n\x1a\n")),
        ("a NetCDF file", bytes(b"CDF\x01")),
        ("a MATLAB file", bytes(b"MATLAB 5.0 MAT-file")),
        ("a pickle of Python", bytes(b"\x80\x04\x95")),
        ("a Parquet file", bytes(b"PAR1")),
        ("an Arrow or Feather file", bytes(b"ARROW1")),
        ("an SQLite database", bytes(b"SQLite format 3\0")),
        ("a trajectory of ASE", bytes(b"- of UlmASE-Trajectory")),
        ("a DCD file", bytes(b"\x54\0\0\0CORD")),
        ("an XTC file", bytes(b"\0\0\x07\xcb")),
        ("a TRR file", bytes(b"\0\0\x07\xc9")),
        ("a binary restart of LAMMPS", bytes(b"LammpS RestartT\0")),
        ("a binary dump of LAMMPS", bytes(b"\xf6\xff\xff\xff\xff\xff\xff\xffDUMPCUSTOM")),
        ("a LAS or LAZ point cloud", bytes(b"LASF")),
        ("UTF-16 text", b"\xff\xfex\0,\0y\0".to_vec()),
        ("a PDF", bytes(b"%PDF-1.7")),
        ("a picture", bytes(b"\x89PNG\r\n")),
        ("a glTF mesh", bytes(b"glTF")),
        ("a binary STL mesh", triangles),
    ];
    samples.extend(texts().into_iter().map(|(name, text)| (name, text.as_bytes().to_vec())));
    samples
}

fn triangle() -> Vec<u8> {
    let normal = [0.0f32, 0.0, 1.0].into_iter().chain([0.5; 9]);
    normal.flat_map(f32::to_le_bytes).chain([0, 0]).collect()
}

fn texts() -> Vec<(&'static str, &'static str)> {
    vec![
        (
            "a pointer of Git LFS",
            "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 5\n",
        ),
        ("a web page", "\n<!DOCTYPE html>\n<html><body>404</body></html>\n"),
        ("a JSON file", "{\"particles\": [{\"x\": 0.25, \"y\": 5, \"r\": 0.5}]}"),
        (
            "a LAMMPS dump of style yaml",
            "---\ncreator: LAMMPS\ntimestep: 0\nnatoms: 2\nkeywords: [ id, x, y, z, ]\n",
        ),
        ("a YAML file", "---\nparticles:\n  - [0, 1, 2]\n"),
        (
            "a PDB file",
            "CRYST1   10.000   10.000   10.000  90.00  90.00  90.00 P 1           1\nATOM      1 \
              N ALA A   1       0.250   5.000   5.000  1.00  0.00           N\n",
        ),
        ("a PDB file", "TITLE     water\nCRYST1\n"),
        ("a PDB file", "MODEL        1\nATOM      1\n"),
        ("a PDB file", "REMARK 888\nREMARK 888 written by MAESTRO\n"),
        ("a CIF file", "# made by hand\n\ndata_x\n_cell_length_a 10\nloop_\n_atom_site_label\n"),
        (
            "a GROMACS file (gro)",
            "Two waters, t= 0.0\n    2\n    1WATER  OW1    1   0.025   0.500   0.500\n    1WATER  \
             HW2    2   0.975   0.500   0.500\n   1.00000   1.00000   1.00000\n",
        ),
        (
            "a topology of GROMACS (itp, top)",
            "; made by hand\n#include \"a.itp\"\n\n[ moleculetype ]\n; name nrexcl\nSOL 2\n",
        ),
        (
            "a restart file of MercuryDPM",
            "restart_version 1.0 name Drum\ndataFile name Drum.data fileType ONE_FILE\n",
        ),
        (
            "a table of TrackMate with four header rows",
            "LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,FRAME,RADIUS\nLabel,Spot ID,Track \
             ID,Quality,X,Y,Frame,Radius\nLabel,Spot ID,Track ID,Quality,X,Y,Frame,R\n,,,(quality),\
             (micron),(micron),,(micron)\nID0,0,0,5.5,1,2,0,2.5\n",
        ),
        (
            "a VASP file (POSCAR)",
            "Si2\n1.0\n10.0 0.0 0.0\n0.0 10.0 0.0\n0.0 0.0 10.0\nSi\n2\nDirect\n0.025 0.5 0.5\n\
             0.975 0.5 0.5\n",
        ),
        ("an AtomEye file (cfg)", "Number of particles = 2\nA = 10.0 Angstrom\nH0(1,1) = 1 A\n"),
        (
            "a point cloud of PCL (pcd)",
            "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nDATA ascii\n0.25 5 5\n",
        ),
        ("a file of Kratos (mdpa)", "Begin ModelPartData\nEnd ModelPartData\nBegin Nodes\n"),
        ("a geometry of ESyS-Particle (geo)", "LSMGeometry 1.2\nBoundingBox 0 0 0 10 10 10\n"),
        ("an STL mesh", "solid ball\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
        ("an OBJ mesh", "# a cube\no cube\nv 0 0 0\nv 1 0 0\nf 1 2 3\n"),
        ("an OFF mesh", "OFF\n8 6 0\n0 0 0\n"),
    ]
}

#[test]
fn each_format_of_the_table_is_named_with_its_way_out_whatever_the_file_is_called() {
    let samples = samples();
    for Unread { name, .. } in UNREAD {
        assert!(samples.iter().any(|sample| sample.0 == *name), "{name} has no sample");
    }
    for (name, bytes) in &samples {
        let Unread { way, .. } = UNREAD.iter().find(|it| it.name == *name).expect(name);
        for ending in ["", "csv", "xyz", "dump", "dat"] {
            let error = load_from(&bytes[..], "p", ending, Options::NONE).unwrap_err().to_string();
            let way = way.replace("FILE", "p");
            let named = error.starts_with(&format!("p is {name}")) && error.ends_with(&way);
            assert!(named, "{name}, '{ending}': {error}");
        }
        let list = crate::pairs::from(&bytes[..], "p", &[], Frame::Only);
        let error = list.unwrap_err().to_string();
        assert!(error.starts_with(&format!("p is {name}")), "{error}");
        assert!(!error.contains("x,y,z"), "a list of pairs: {error}");
    }
}

/// What one knows better than the table is read.
#[test]
fn the_format_that_is_given_counts() {
    let options = Options { format: Some(Format::Csv), radius: Some(0.5), ..Options::NONE };
    let text = b"OFF\n0 1\n2 3\n";
    assert!(load_from(&text[..], "p", "", Options::NONE).unwrap_err().to_string().contains("OFF"));
    let error = load_from(&text[..], "p", "", options).unwrap_err().to_string();
    assert!(error.starts_with("p:1: "), "{error}");
}

#[test]
fn texts_that_are_read_are_none_of_them() {
    for text in [
        "x,y,z,r\n1,2,3,4\n",
        "x y z\n1 2 3\n1 2 3\n",
        "2\ncomment\nC 0 0 0\nC 1 0 0\n",
        "2\n1.0\n10 0 0\n0 10 0\n",
        "title\n2\n0 10 0\n0 0 10\n5 5 5\n",
        "ITEM: TIMESTEP\n0\n",
        "v x y\n1 2 3\n4 5 6\n",
        "data,x,y\n1,2,3\n",
        "- 1 2\n",
        "ATOM x y z\n1 2 3 4\n",
    ] {
        assert!(refuse(text.as_bytes(), "p", None).is_ok(), "{text}");
    }
}
