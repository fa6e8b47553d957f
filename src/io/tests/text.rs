//! CSV and XYZ.

use super::*;

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
        assert_eq!(
            rows(&read(text.as_bytes(), "csv", NONE).unwrap_or_else(|e| panic!("{text}: {e}"))),
            plane,
            "{text}"
        );
    }
    let space = read(b"z,y,x\n3,2,1\n", "csv", HALF).unwrap();
    assert_eq!(rows(&space), [[1.0, 2.0, 3.0, 0.5]]);
    // Names are not guessed inside other names; foreign bytes in other columns are no obstacle.
    assert_eq!(
        rows(&read(b"x,y,rx,caf\xe9\n1,2,9,\xff\n", "csv", HALF).unwrap()),
        [[1.0, 2.0, 0.5]]
    );
}

#[test]
fn csv_without_a_header_is_read_where_it_has_one_meaning() {
    let with = |radius, dim| Options { radius, dim, ..NONE };
    assert_eq!(
        rows(&read(b"1 2\n3 4\n", "txt", HALF).unwrap()),
        [[1.0, 2.0, 0.5], [3.0, 4.0, 0.5]]
    );
    assert_eq!(rows(&read(b"1,2,3,4\n", "", NONE).unwrap()), [[1.0, 2.0, 3.0, 4.0]]);
    assert_eq!(rows(&read(b"1,2,3\n", "csv", HALF).unwrap()), [[1.0, 2.0, 3.0, 0.5]]);
    assert_eq!(rows(&read(b"1,2,3\n", "csv", with(None, Some(2))).unwrap()), [[1.0, 2.0, 3.0]]);
    assert_eq!(
        read(b"1,2,3\n", "csv", with(None, Some(3))).unwrap_err(),
        "p holds no radii; give --radius R (half the diameter; in an experiment \
         radius = R), or add a column named r"
    );
}

/// A scene written as CSV in shortest form comes back to the bit.
#[test]
fn csv_gives_back_every_bit() {
    let scene = crate::scene::spec::Spec::parse("clustered:dim=3,n=500,size-ratio=7")
        .unwrap()
        .make()
        .unwrap();
    let text: String = rows(&scene)
        .iter()
        .map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    assert_eq!(read(format!("x,y,z,r\n{text}").as_bytes(), "csv", NONE).unwrap(), scene);
}

#[test]
fn xyz_plain_and_extended() {
    let plain = read(b"2\nany comment = 3\nAr 1 2 3\nNe 4 5 6\n\n", "xyz", HALF).unwrap();
    assert_eq!(rows(&plain), [[1.0, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.5]]);
    assert_eq!(rows(&read(b"1\n\nAr 1 2 3 9 9 9\n", "dat", HALF).unwrap()), [[1.0, 2.0, 3.0, 0.5]]);
    for comment in [
        "Properties=species:S:1:pos:R:3:radius:R:1",
        "Lattice=\"5 0 0 0 5 0 0 0 5\" pbc='F F F' properties=\"species:S:1:pos:R:3:radius:R:1\" \
         energy=-1",
    ] {
        let text = format!("2\n{comment}\nAr 1 2 3 0.25\nNe 4 5 6 0.5\n");
        assert_eq!(
            rows(&read(text.as_bytes(), "xyz", NONE).unwrap()),
            [[1.0, 2.0, 3.0, 0.25], [4.0, 5.0, 6.0, 0.5]]
        );
    }
    let plane =
        read(b"1\nProperties=id:I:1:diameter:R:1:vel:R:3:pos:R:2\n7 3 0 0 0 1 2\n", "xyz", NONE)
            .unwrap();
    assert_eq!(rows(&plane), [[1.0, 2.0, 1.5]]);
    assert_eq!(read(b"0\n", "xyz", HALF).unwrap().len(), 0);
    assert_eq!(read(b"0\nProperties=pos:R:3:r:R:1\n", "xyz", NONE).unwrap().len(), 0);
}

#[test]
fn headings_of_paraview_and_units_are_understood() {
    let sphere = "1,2,3,0.5\n";
    for header in [
        "\"Points:0\",\"Points:1\",\"Points:2\",\"radius\"",
        "Points_0,Points_1,Points_2,Radius",
        "x [m],y [m],z [m],r [m]",
        "X(mm),Y(mm),Z(mm),radius (mm)",
    ] {
        let scene = read(format!("{header}\n{sphere}").as_bytes(), "csv", NONE);
        let plain = read(format!("x,y,z,r\n{sphere}").as_bytes(), "csv", NONE).unwrap();
        assert_eq!(scene.unwrap_or_else(|error| panic!("{header}: {error}")), plain, "{header}");
    }
    // Where there is an x, the points are something else.
    let both = read(b"x,y,r,Points:0\n1,2,3,9\n", "csv", NONE).unwrap();
    assert_eq!(both, read(b"x,y,r\n1,2,3\n", "csv", NONE).unwrap());
}

#[test]
fn decimal_commas_are_explained() {
    for (text, words) in [
        ("x;y;r\n1,5;2;1\n", "column 'x': '1,5' has a decimal comma, which is not read"),
        ("x y r\n1 2 0,5\n", "column 'r': '0,5' has a decimal comma"),
        ("1,5 2,5 0,5\n", "the numbers have decimal commas"),
        ("x,y,r\n1,5,2,5,0,5\n", "if the commas are decimal commas, write points"),
    ] {
        let error = read(text.as_bytes(), "csv", NONE).unwrap_err();
        assert!(error.contains(words), "{text}: {error}");
    }
}

/// VTK 5.1 writes offsets and connectivity; some writers leave a blank line before them.
#[test]
fn blank_lines_may_stand_before_the_offsets_of_cells() {
    for blank in ["", "\n", " \n\r\n"] {
        let text = format!(
            "# vtk DataFile Version 5.1\np\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n1 2 3\n4 5 \
             6\nVERTICES 3 2\n{blank}OFFSETS vtktypeint64\n0 1 2\n{blank}CONNECTIVITY \
             vtktypeint64\n0 1\n\nPOINT_DATA 2\nSCALARS radius double\nLOOKUP_TABLE \
             default\n0.5 0.25\n"
        );
        let scene = read(text.as_bytes(), "vtk", NONE);
        assert_eq!(rows(&scene.unwrap()), [[1.0, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.25]]);
        // Before version 5 the indices themselves follow.
        let old = format!(
            "# vtk DataFile Version 3.0\np\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n1 2 3\n4 5 \
             6\nVERTICES 2 4\n{blank}1 0\n1 1\nPOINT_DATA 2\nSCALARS radius \
             double\nLOOKUP_TABLE default\n0.5 0.25\n"
        );
        assert_eq!(read(old.as_bytes(), "vtk", NONE).unwrap().len(), 2);
    }
}
