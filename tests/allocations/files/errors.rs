//! Where an error is.

use super::examples::{DATA, DUMP, MERCURY, PLY_HEAD, VTK_HEAD, vtp};
use super::{NONE, gz, refusal};
use crate::loud;

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
            "p:11: 5 columns where 7 are expected",
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
            "p ends after 2 of the 3 atoms that its header announces: it is cut off, or still being \
             written",
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
             the columns x,y[,z][,r], with r, radius, d or diameter, or say which they are with \
             --columns x=NAME,y=NAME",
        ),
        (
            DUMP.replace("-1 1\n", "-1 one\n"),
            "p:7: column 2: 'one' is not a finite number; a bound of the box is expected",
        ),
        (
            scaled.replace("BOX BOUNDS pp pp ff\n0 4\n-1 1\n0 10\n", "TIME\n0.5\n"),
            "p:7: the coordinates are scaled by the box (xs), but there is no 'ITEM: BOX BOUNDS'; \
             write x y z",
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
            "p:15: 7 columns, and no atom style behind 'Atoms'; say which it is: --columns",
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
            vtp("format=\"binary\"", "compressor=\"vtkLZ4DataCompressor\"", "AAAA", "AAAA", ""),
            "p:10: compressed by vtkLZ4DataCompressor, which is not read",
        ),
        (vtp("format=\"binary\"", "", "A*AA", "AAAA", ""), "p:10: its length is cut off"),
        (
            vtp("format=\"appended\"", "", "", "", "").replace("OFFSET", "9"),
            "p ends before its AppendedData; write it again",
        ),
        ("<gpx>\n<body>".into(), "p:1: '<gpx' begins what is no VTK XML file"),
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
