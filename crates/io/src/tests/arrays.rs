//! NumPy archives and records: their sizes, boxes, ids and frames.

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

/// As tables and dumps have them; those of VTK are in `cases/vtk.txt`.
#[test]
fn ids_stand_in_arrays_of_many_names() {
    let ids = |shape, numbers: &[f64], label, options: Options| {
        let file = npz(&[("x", "<f8", "(2, 3)", &TWO), (label, ">i4", shape, numbers)]);
        loaded(&file, "npz", Options { ids: true, ..options }).unwrap().0.ids.unwrap_or_default()
    };
    for name in ["id", "ids", "GlobalIds"] {
        assert_eq!(ids("(2,)", &[7.0, 5.0], name, HALF), [7, 5], "{name}");
    }
    let chosen = Options { radius: Some(0.5), ..columns("id=n") };
    assert_eq!(ids("(2,)", &[7.0, 5.0], "n", chosen), [7, 5]);
    assert_eq!(ids("(2,)", &[7.0, 5.0], "n", HALF), [0; 0]);
    // Only a column of ids may repeat: what needs single ids then refuses it.
    assert_eq!(ids("(2,)", &[5.0, 5.0], "ids", HALF), [0; 0]);
    assert_eq!(ids("(2,)", &[5.0, 5.0], "id", HALF), [5, 5]);
    assert_eq!(ids("(1,)", &[7.0], "id", HALF), [0; 0], "one for two");
}
