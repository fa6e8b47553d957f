//! CSV and XYZ.

use contactbench_terms::mix::splitmix64;

use super::*;
use crate::scene::{Radii, Scene};

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
        "p holds no radii; add a column named r, or give --radius R (half the diameter; in an \
         experiment radius = R)"
    );
}

/// A scene written as CSV in shortest form comes back to the bit.
#[test]
fn csv_gives_back_every_bit() {
    let number = |k: u64| f64::from_bits(splitmix64(k) >> 2);
    let centres: Vec<_> = (0..500)
        .map(|k| nalgebra::Point::from([3 * k, 3 * k + 1, 3 * k + 2].map(number)))
        .collect();
    let radii: Vec<f64> = (1500..2000).map(number).collect();
    let scene: AnyScene<'_> = Scene::new(centres, Radii::Each(radii.into())).unwrap().into();
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

/// What a file holds with the sizes that count, and what is assumed.
type Told = (Vec<Vec<f64>>, RadiusSource, Vec<String>);

fn told(text: &str, options: Options) -> Result<Told, String> {
    let name = if text.starts_with("ITEM") { "dump" } else { "csv" };
    let (particles, about) =
        load_from(text.as_bytes(), "p", name, options).map_err(|error| format!("{error:#}"))?;
    let said = particles.notices().iter().map(|notice| notice.words(Place::Argument)).collect();
    let scene = particles.scene("p", options.radius).map_err(|error| format!("{error:#}"))?;
    Ok((rows(&scene), about.radius, said))
}

fn columns(text: &str) -> Options {
    Options { columns: Some(text.parse().unwrap()), ..NONE }
}

#[test]
fn the_radius_that_is_given_counts_in_every_format() {
    let half = vec![vec![1.0, 2.0, 3.0, 0.5]];
    let dump = "ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS x y z radius\n1 2 3 9\n";
    for text in ["x,y,z,r\n1,2,3,9\n", "x,y,z,r,g,b\n1,2,3,-9,1,1\n", "1,2,3,9\n", dump] {
        let (found, radius, said) = told(text, HALF).unwrap();
        assert_eq!((found, radius), (half.clone(), RadiusSource::Given), "{text}");
        assert!(said.iter().any(|words| words.contains("the radius is 0.5")), "{text}: {said:?}");
    }
    let array = npy_file("<f8", "False", "(1, 4)", &doubles(&[1.0, 2.0, 3.0, 9.0]));
    let (particles, about) = load_from(&array[..], "p", "npy", HALF).unwrap();
    assert_eq!(about.radius, RadiusSource::Given);
    assert!(particles.notices()[0].words(Place::Argument).contains("the radius is 0.5"));
}

#[test]
fn a_size_that_may_be_red_is_refused_until_it_is_chosen() {
    let cloud = "x,y,z,r,g,b\n0.25,5,5,120,30,20\n9.75,5,5,200,10,10\n";
    let stars = "ra,dec,x,y,z,g,r\n10,20,3,4,1,15.2,14.1\n11,20,20,4,2,16.2,15.1\n";
    let far = "ra,dec,x,y,d\n10,20,3,4,15.2\n";
    let johnson = "x,y,B,V,R\n10,20,3,4,15.2\n";
    for (text, key) in [(cloud, "r=r"), (stars, "r=r"), (far, "d=d"), (johnson, "r=R")] {
        let error = told(text, NONE).unwrap_err();
        assert!(error.contains(&format!("--columns {key}")), "{error}");
        assert_eq!(told(text, HALF).unwrap().1, RadiusSource::Given);
        let chosen = told(text, columns(key)).unwrap();
        assert_ne!(chosen.1, RadiusSource::Missing);
        assert!(chosen.2.is_empty(), "{chosen:?}");
    }
    // A size that is one for sure leaves red red; u and i may be velocities and numbers.
    let sure = "x,y,r,g,b,radius\n1,2,120,30,20,0.5\n";
    assert_eq!(told(sure, NONE).unwrap().0, [[1.0, 2.0, 0.5]]);
    assert_eq!(told("i,x,y,r,u,v\n0,1,2,0.5,0,0\n", NONE).unwrap().0, [[1.0, 2.0, 0.5]]);
}

#[test]
fn a_size_is_chosen_without_the_coordinates() {
    let dump = "ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS id type x y z c_radius\n1 1 1 2 3 0.5\n";
    let csv = "x,y,z,c_radius (m),id\n1,2,3,0.5,7\n";
    for text in [dump, csv] {
        let error = told(text, NONE).unwrap_err();
        assert!(error.contains("--columns r=c_radius"), "{error}");
        assert_eq!(told(text, columns("r=c_radius")).unwrap().0, [[1.0, 2.0, 3.0, 0.5]]);
        assert_eq!(told(text, columns("d=c_radius")).unwrap().0, [[1.0, 2.0, 3.0, 0.25]]);
    }
    let twice = told("x,y,a,a\n1,2,3,4\n", columns("r=a")).unwrap_err();
    assert!(twice.contains("several columns have that name"), "{twice}");
}

#[test]
fn units_are_made_one_or_refused() {
    let ball = vec![vec![0.0003, 5.0, 5.0, 0.5]];
    for (text, said) in [
        ("x (m),y (m),z (m),Diameter (mm)\n0.0003,5,5,1000\n", "multiplied by 1e-3"),
        ("x [mm],y [m],z [m],d [m]\n0.3,5,5,1\n", "multiplied by 1e3"),
        ("x_m,y_m,z_m,r_mm\n3e-4,5,5,500\n", "multiplied by 1e-3"),
        ("x [m],y [m],z [m],r\n0.0003,5,5,0.5\n", "names no unit"),
        ("x [a],y [b],z [b],r [b]\n0.0003,5,5,0.5\n", "read as in one unit"),
        ("x [um],y [µm],z [micron],r [μm]\n0.0003,5,5,0.5\n", ""),
    ] {
        let (found, _, words) = told(text, NONE).unwrap_or_else(|error| panic!("{text}: {error}"));
        match text.contains("[mm]") {
            true => assert_eq!(found, [[0.3, 5000.0, 5000.0, 500.0]], "{text}"),
            false => assert_eq!(found, ball, "{text}"),
        }
        assert_eq!(words.is_empty(), said.is_empty(), "{text}: {words:?}");
        assert!(words.iter().all(|words| words.contains(said)), "{text}: {words:?}");
    }
    let error = told("x [px],y [px],r [mm]\n1,2,3\n", NONE).unwrap_err();
    assert!(error.contains("'x [px]' and 'r [mm]' are in different units"), "{error}");
    // Beside a plain x the name ends in no unit.
    assert_eq!(told("x,y,r,r_cm\n1,2,3,4\n", NONE).unwrap().0, [[1.0, 2.0, 3.0]]);
}
