//! Files of named arrays: NumPy archives and records, VTK, PLY; their sizes, boxes and cells.

use super::*;

fn loaded(bytes: &[u8], ending: &str, options: Options) -> Result<(Particles, About), String> {
    load_from(bytes, "p", ending, options).map_err(|error| format!("{error:#}"))
}

fn refused(bytes: &[u8], ending: &str, options: Options) -> String {
    loaded(bytes, ending, options).map(|(particles, _)| particles.len()).unwrap_err()
}

fn radii(bytes: &[u8], ending: &str, options: Options) -> Vec<f64> {
    let (particles, _) = loaded(bytes, ending, options).unwrap_or_else(|error| panic!("{error}"));
    particles.radii.unwrap_or_default()
}

fn columns(text: &str) -> Options {
    Options { columns: Some(text.parse().unwrap()), ..NONE }
}

/// An archive whose files are stored.
fn npz(files: &[(&str, &str, &str, &[f64])]) -> Vec<u8> {
    let mut archive = Vec::new();
    for (name, descr, shape, values) in files {
        let data: Vec<u8> = values
            .iter()
            .flat_map(|value| match *descr {
                "|u1" | "|b1" => vec![*value as u8],
                ">i4" => (*value as i32).to_be_bytes().to_vec(),
                _ => value.to_le_bytes().to_vec(),
            })
            .collect();
        let file = npy_file(descr, "False", shape, &data);
        let name = format!("{name}.npy");
        archive.extend(b"PK\x03\x04\x14\0\0\0\0\0\0\0\0\0\0\0\0\0");
        let size = (file.len() as u32).to_le_bytes();
        archive.extend([size, size].concat());
        archive.extend((name.len() as u16).to_le_bytes());
        archive.extend([0, 0]);
        archive.extend(name.bytes());
        archive.extend(file);
    }
    archive.extend(b"PK\x05\x06");
    archive.extend([0; 18]);
    archive
}

const TWO: [f64; 6] = [0.25, 5.0, 5.0, 9.75, 5.0, 5.0];

#[test]
fn archives_hold_one_radius_for_all_or_one_for_each() {
    let file = |shape: &str, r: &[f64]| {
        npz(&[("x", "<f8", "(2, 3)", &TWO), ("r", "<f8", shape, r), ("t", "<U3", "(9,)", &[])])
    };
    assert_eq!(radii(&file("()", &[0.5]), "npz", NONE), [0.5, 0.5]);
    assert_eq!(radii(&file("(1,)", &[0.5]), "npz", NONE), [0.5, 0.5]);
    assert_eq!(radii(&file("(2,)", &[0.5, 1.0]), "npz", NONE), [0.5, 1.0]);
    assert_eq!(radii(&file("(2, 1)", &[0.5, 1.0]), "npz", NONE), [0.5, 1.0]);
    let error = refused(&file("(3,)", &[0.5; 3]), "npz", NONE);
    assert!(error.contains("2 points, but 'r' has the shape (3,)"), "{error}");
    // Other names are listed, and taken if they are chosen.
    let named = npz(&[("pos", "<f8", "(2, 3)", &TWO), ("rad", "<f8", "(2,)", &[0.5, 1.0])]);
    assert_eq!(loaded(&named, "npz", NONE).unwrap().0.unused, ["rad"]);
    assert_eq!(radii(&named, "npz", columns("r=rad")), [0.5, 1.0]);
    assert_eq!(radii(&named, "npz", columns("d=rad")), [0.25, 0.5]);
    assert!(refused(&named, "npz", columns("r=size")).contains("no array of that name"));
    // Red beside green and blue, or as bytes.
    let colours = |kind: &str| {
        npz(&[
            ("x", "<f8", "(2, 3)", &TWO),
            ("r", kind, "(2,)", &[1.0, 2.0]),
            ("g", kind, "(2,)", &[1.0, 2.0]),
            ("b", kind, "(2,)", &[1.0, 2.0]),
        ])
    };
    for kind in ["<f8", "|u1"] {
        assert_eq!(radii(&colours(kind), "npz", NONE), [0.0; 0], "{kind}");
        assert_eq!(radii(&colours(kind), "npz", columns("r=r")), [1.0, 2.0], "{kind}");
    }
}

#[test]
fn archives_hold_boxes() {
    let with = |name: &str, shape: &str, values: &[f64]| {
        npz(&[
            ("x", "<f8", "(2, 3)", &TWO),
            ("r", "<f8", "()", &[0.5]),
            (name, "<f8", shape, values),
            ("pbc", "|b1", "(3,)", &[1.0, 1.0, 0.0]),
        ])
    };
    let cube = [[10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]];
    for (name, shape, values) in
        [("box", "(3,)", vec![10.0; 3]), ("L", "()", vec![10.0]), ("cell", "(3, 3)", cube.concat())]
    {
        let (particles, about) = loaded(&with(name, shape, &values), "npz", NONE).unwrap();
        assert_eq!(about.declared.unwrap().vectors, Some(cube), "{name}");
        assert_eq!(particles.lattice().unwrap().periodic(), [true, true, false], "{name}");
        let said = format!("{:?}", particles.notices());
        assert!(said.contains(&format!("the array '{name}' is taken as")), "{said}");
    }
    // Where it does not say whether it repeats, that is a notice.
    let silent = npz(&[
        ("x", "<f8", "(2, 3)", &TWO),
        ("r", "<f8", "()", &[0.5]),
        ("box", ">i4", "(3,)", &[10.0; 3]),
    ]);
    let (particles, _) = loaded(&silent, "npz", NONE).unwrap();
    assert!(particles.lattice().is_none() && particles.has_box);
    assert!(particles.notices().contains(&Notice::Boundaries));
    let error = refused(&with("box", "(6,)", &[10.0; 6]), "npz", NONE);
    assert!(error.contains("'box' has the shape (6,)") && error.contains("--box"), "{error}");
    let open = Options { boundaries: Boundaries { open: true, ..Boundaries::AS_DECLARED }, ..NONE };
    assert!(loaded(&with("box", "(6,)", &[10.0; 6]), "npz", open).is_ok());
}

#[test]
fn archives_hold_frames() {
    let x: Vec<f64> = (0..18).map(f64::from).collect();
    let file =
        |shape: &str, r: &[f64]| npz(&[("r", "<f8", shape, r), ("x", "<f8", "(3, 2, 3)", &x)]);
    let all = |bytes: &[u8]| {
        let options = Options { frame: Frame::All, ..NONE };
        frames_from(bytes, "p", "npz", options, |frames| {
            let frame = |frame: anyhow::Result<(Particles, About)>| {
                let (particles, about) = frame?;
                let second = particles.centre(1);
                Ok((about.frame, second, particles.radii.unwrap_or_default()))
            };
            frames.map(frame).collect::<anyhow::Result<Vec<_>>>()
        })
        .map_err(|error| format!("{error:#}"))
    };
    let expected = |r: [[f64; 2]; 3]| -> Vec<(u64, [f64; 3], Vec<f64>)> {
        let frame = |(k, r): (usize, [f64; 2])| {
            let x = 6.0 * k as f64;
            (k as u64, [x + 3.0, x + 4.0, x + 5.0], r.to_vec())
        };
        r.into_iter().enumerate().map(frame).collect()
    };
    assert_eq!(all(&file("()", &[0.5])), Ok(expected([[0.5; 2]; 3])));
    assert_eq!(all(&file("(2,)", &[0.5, 1.0])), Ok(expected([[0.5, 1.0]; 3])));
    let each = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]];
    assert_eq!(all(&file("(3, 2)", each.as_flattened())), Ok(expected(each)));
    assert!(all(&file("(3,)", &[0.5; 3])).unwrap_err().contains("'r' has the shape (3,)"));
    assert!(refused(&file("()", &[0.5]), "npz", NONE).contains("a second frame begins"));
    let last = Options { frame: Frame::Last, ..NONE };
    assert_eq!(loaded(&file("()", &[0.5]), "npz", last).unwrap().0.centre(0), [12.0, 13.0, 14.0]);
}

#[test]
fn arrays_with_fields_are_read_by_name() {
    let row = |x: f64, r: f32| {
        let numbers = [x, 5.0, 5.0].into_iter().flat_map(f64::to_le_bytes);
        numbers.chain([0; 8]).chain(r.to_le_bytes()).collect::<Vec<u8>>()
    };
    let data = [row(1.0, 0.5), row(2.0, 0.25)].concat();
    let file = |fields: &str| {
        let header = format!("{{'descr': {fields}, 'fortran_order': False, 'shape': (2,), }}\n");
        let length = (header.len() as u16).to_le_bytes();
        [MAGIC, &[1, 0], &length, header.as_bytes(), &data].concat()
    };
    let fields = |r: &str| {
        format!("[('x', '<f8'), ('y', '<f8'), ('z', '<f8'), ('v', '<f4', (2,)), ('{r}', '<f4')]")
    };
    assert_eq!(radii(&file(&fields("radius")), "npy", NONE), [0.5, 0.25]);
    assert_eq!(radii(&file(&fields("shape")), "npy", columns("r=shape")), [0.5, 0.25]);
    let (particles, _) = loaded(&file(&fields("radius")), "npy", NONE).unwrap();
    assert_eq!(particles.centre(1), [2.0, 5.0, 5.0]);
    let vectors = "[('pos', '<f8', (3,)), ('v', '<f4', (2,)), ('radius', '<f4')]";
    let error = refused(&file(vectors), "npy", NONE);
    assert!(error.contains("numpy.column_stack([a['pos']"), "{error}");
    let objects = "[('x', '|O'), ('y', '<f8')]";
    assert!(refused(&file(objects), "npy", NONE).contains("is not read; save one plain array"));
    for (descr, shape, words) in [
        ("<f8", "(3, 100)", "save the transpose, a.T"),
        ("<f8", "(100, 7)", "choose columns, as in a[:, [0, 1, 2, 3]]"),
        ("|O", "(2, 3)", "it holds Python objects"),
        ("<c16", "(2, 3)", "save a.real"),
        ("<f2", "(2, 3)", "convert with .astype('f8')"),
        ("<i8", "(2, 3)", "convert with .astype('f8')"),
        ("<f8", "()", "the shape is ()"),
    ] {
        let error = refused(&npy_file(descr, "False", shape, &[0; 64]), "npy", HALF);
        assert!(error.contains(words), "{descr} {shape}: {error}");
    }
}

/// A file of one piece: what stands in the piece, and its other attributes.
fn vtk_xml(kind: &str, attributes: &str, pieces: &[(&str, &str)]) -> String {
    let piece = |(more, inner): &(&str, &str)| format!("<Piece {more}>{inner}</Piece>");
    let pieces: String = pieces.iter().map(piece).collect();
    format!("<VTKFile type=\"{kind}\" {attributes}><{kind}>{pieces}</{kind}></VTKFile>")
}

fn ascii(name: &str, numbers: &str) -> String {
    format!("<DataArray type=\"Float64\" Name=\"{name}\" format=\"ascii\">{numbers}</DataArray>")
}

fn points(numbers: &str) -> String {
    format!(
        "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" \
         format=\"ascii\">{numbers}</DataArray></Points>"
    )
}

#[test]
fn pieces_follow_each_other_and_text_is_never_compressed() {
    let of = |radii: &str| format!("<PointData>{}</PointData>", ascii("radius", radii));
    let (two, one) = (points("1 2 3 4 5 6") + &of("0.5 0.25"), of("2") + &points("7 8 9"));
    let none = "<Points></Points>".to_string();
    let file = vtk_xml(
        "UnstructuredGrid",
        "compressor=\"vtkLZ4DataCompressor\"",
        &[
            ("NumberOfPoints=\"0\"", &none),
            ("NumberOfPoints=\"2\"", &two),
            ("NumberOfPoints=\"1\"", &one),
        ],
    );
    let scene = read(file.as_bytes(), "vtu", NONE).unwrap();
    let expected = [[1.0, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.25], [7.0, 8.0, 9.0, 2.0]];
    assert_eq!(rows(&scene), expected);
    let unsized_piece = file.replace(&of("2"), "");
    assert!(refused(unsized_piece.as_bytes(), "vtu", NONE).contains("holds 3 points but 2 radii"));
    let packed = file.replace("format=\"ascii\">2<", "format=\"binary\">AAAA<");
    assert!(refused(packed.as_bytes(), "vtu", NONE).contains("vtkLZ4DataCompressor"));
    let list = vtk_xml("Collection", "", &[]);
    assert!(refused(list.as_bytes(), "pvd", NONE).contains("names others beside it"));
    let ghosts = file.replace("Name=\"radius\"", "Name=\"vtkGhostType\"");
    assert!(refused(ghosts.as_bytes(), "vtu", HALF).contains("3 of the points are ghosts"));
}

#[test]
fn sizes_of_vtk_have_any_name_and_place() {
    let piece = |data: &str| {
        let inner = points("1 2 3 4 5 6") + data;
        vtk_xml("PolyData", "", &[("NumberOfPoints=\"2\" NumberOfVerts=\"2\"", &inner)])
    };
    let of = |place: &str, arrays: &[(&str, &str)]| {
        let arrays: String = arrays.iter().map(|(name, all)| ascii(name, all)).collect();
        piece(&format!(
            "<{place}>{arrays}</{place}><Verts>{}{}</Verts>",
            ascii("connectivity", "0 1"),
            ascii("offsets", "1 2")
        ))
    };
    let named = of("PointData", &[("particle_radius", "1 2"), ("type", "0 0")]);
    let (particles, _) = loaded(named.as_bytes(), "vtp", NONE).unwrap();
    assert_eq!(
        (particles.has_radii(), &*particles.unused),
        (false, &["particle_radius", "type"].map(String::from)[..])
    );
    assert_eq!(radii(named.as_bytes(), "vtp", columns("r=particle_radius")), [1.0, 2.0]);
    assert!(refused(named.as_bytes(), "vtp", columns("x=a,y=b")).contains("its own points"));
    let both = of("PointData", &[("diameter", "2 4"), ("radius", "1 2")]);
    assert_eq!(radii(both.as_bytes(), "vtp", NONE), [1.0, 2.0]);
    let (particles, about) = loaded(both.as_bytes(), "vtp", NONE).unwrap();
    assert_eq!(about.radius, RadiusSource::Column("radius".into()));
    assert_eq!(particles.notices().len(), 1, "{:?}", particles.notices());
    let differ = of("PointData", &[("diameter", "2 4"), ("radius", "1 3")]);
    let error = refused(differ.as_bytes(), "vtp", NONE);
    assert!(error.contains("differ at point 1") && error.contains("--columns r=radius"), "{error}");
    assert_eq!(radii(differ.as_bytes(), "vtp", columns("d=diameter")), [1.0, 2.0]);
    // Sizes of cells count where cell k is point k.
    let cells = of("CellData", &[("radius", "1 2")]);
    assert_eq!(radii(cells.as_bytes(), "vtp", NONE), [1.0, 2.0]);
    let turned = cells.replace(">0 1<", ">1 0<");
    let (particles, _) = loaded(turned.as_bytes(), "vtp", NONE).unwrap();
    assert_eq!((particles.has_radii(), &*particles.unused[0]), (false, "radius (of cells)"));
    let red = of("PointData", &[("r", "1 2"), ("g", "1 2"), ("b", "1 2")]);
    assert_eq!(radii(red.as_bytes(), "vtp", NONE), [0.0; 0]);
    for (head, cells) in [
        ("5.1", "VERTICES 3 2\nOFFSETS vtktypeint64\n0 1 2\nCONNECTIVITY vtktypeint64\n0 1\n"),
        ("3.0", "VERTICES 2 4\n1 0 1 1\n"),
    ] {
        let text = format!(
            "# vtk DataFile Version {head}\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n1 2 3 4 5 \
             6\n{cells}CELL_DATA 2\nSCALARS radius double\nLOOKUP_TABLE default\n1 2\n"
        );
        assert_eq!(radii(text.as_bytes(), "vtk", NONE), [1.0, 2.0], "{head}");
        // VECTORS of cells have a number of cells, and stand before the data of points.
        let text = text.replace(
            "CELL_DATA 2\n",
            "VERTICES 0 0\nPOINT_DATA 2\nSCALARS size float\nLOOKUP_TABLE d\n7 7\nCELL_DATA 2\n\
             VECTORS v double\n1 1 1 1 1 1\n",
        );
        assert_eq!(radii(text.as_bytes(), "vtk", NONE), [1.0, 2.0], "{head}");
        assert_eq!(radii(text.as_bytes(), "vtk", columns("r=size")), [7.0, 7.0], "{head}");
    }
}

#[test]
fn corners_of_meshes_are_no_particles() {
    let inner = points("0 0 0 1 0 0 0 1 0")
        + &format!("<PointData>{}</PointData>", ascii("radius", "0.5 0.5 0.5"));
    let piece = |more: &str, cells: &str| {
        let (kind, inner) = match cells {
            "" => ("PolyData", inner.clone()),
            _ => ("UnstructuredGrid", format!("{inner}<Cells>{}</Cells>", ascii("types", cells))),
        };
        vtk_xml(kind, "", &[(&format!("NumberOfPoints=\"3\" {more}"), &inner)])
    };
    let legacy = |kind: &str, cells: &str| {
        format!(
            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET {kind}\nPOINTS 3 double\n0 0 0 1 0 0 \
             0 1 0\n{cells}\nPOINT_DATA 3\nSCALARS radius double\nLOOKUP_TABLE default\n1 1 1\n"
        )
    };
    let ply = |element: &str, list: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double \
             y\nproperty double z\nproperty float radius\n{element}\nproperty \
             {list}\nend_header\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n"
        )
    };
    let faces = [
        (piece("NumberOfPolys=\"1\"", ""), "vtp"),
        (piece("NumberOfStrips=\"1\"", ""), "vtp"),
        (piece("NumberOfCells=\"1\"", "5"), "vtu"),
        (piece("NumberOfCells=\"2\"", "1 10"), "vtu"),
        (legacy("POLYDATA", "POLYGONS 1 4\n3 0 1 2"), "vtk"),
        (legacy("POLYDATA", "TRIANGLE_STRIPS 1 4\n3 0 1 2"), "vtk"),
        (legacy("UNSTRUCTURED_GRID", "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5"), "vtk"),
        (ply("element face 1", "list uchar int vertex_indices"), "ply"),
    ];
    for (text, ending) in &faces {
        let error = refused(text.as_bytes(), ending, NONE);
        assert!(error.contains("the points are the corners of 1"), "{text}: {error}");
        assert!(error.contains("Glyph") && error.contains("--radius R"), "{error}");
        // A size that is given says that they are particles.
        for options in [HALF, columns("r=radius")] {
            let (particles, _) = loaded(text.as_bytes(), ending, options).unwrap();
            assert_eq!(particles.len(), 3);
            let said = format!("{:?}", particles.notices());
            assert!(said.contains("the corners of 1"), "{said}");
        }
    }
    for (text, ending) in [
        (piece("NumberOfLines=\"2\"", ""), "vtp"),
        (piece("NumberOfCells=\"2\"", "3 4"), "vtu"),
        (legacy("POLYDATA", "LINES 2 6\n2 0 1 2 1 2"), "vtk"),
    ] {
        let (particles, _) = loaded(text.as_bytes(), ending, NONE).unwrap();
        let said = format!("{:?}", particles.notices());
        assert!(particles.has_radii() && said.contains("2 lines between the points"), "{said}");
    }
    for (text, ending) in [
        (piece("NumberOfVerts=\"3\"", ""), "vtp"),
        (piece("NumberOfCells=\"3\"", "1 1 1"), "vtu"),
        (piece("NumberOfCells=\"1\"", "2"), "vtu"),
        (legacy("UNSTRUCTURED_GRID", "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n2"), "vtk"),
        (legacy("STRUCTURED_GRID", "DIMENSIONS 3 1 1"), "vtk"),
        (ply("element face 0", "list uchar int vertex_indices"), "ply"),
    ] {
        let (particles, _) = loaded(text.as_bytes(), ending, NONE).unwrap();
        // All z are 0, which is another matter.
        assert_eq!(particles.notices(), [Notice::Flat], "{text}");
    }
    let grid = legacy("STRUCTURED_GRID", "DIMENSIONS 3 2 1");
    assert!(refused(grid.as_bytes(), "vtk", NONE).contains("the corners of 1 polygon,"));
}

#[test]
fn bytes_named_r_are_red_in_ply() {
    let ply = |kind: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty \
             float z\nproperty {kind} r\nproperty float scalar_size\nend_header\n1 2 3 255 4\n"
        )
    };
    assert_eq!(radii(ply("float").as_bytes(), "ply", NONE), [255.0]);
    assert_eq!(radii(ply("uchar").as_bytes(), "ply", NONE), [0.0; 0]);
    assert_eq!(radii(ply("uchar").as_bytes(), "ply", columns("r=r")), [255.0]);
    assert_eq!(radii(ply("uchar").as_bytes(), "ply", columns("d=scalar_size")), [2.0]);
}
