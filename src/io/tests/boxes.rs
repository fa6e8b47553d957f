//! Boxes: what files say of them, what the options make of that, and that no box is ignored; which
//! are refused (`refused`).

mod refused;

use super::*;
use crate::io::boxes::{Axes, Edges};
use crate::scene::Lattice;

/// The box in which a file's particles repeat, and the notes.
fn box_of(
    text: &str,
    ending: &str,
    options: Options,
) -> Result<(Option<Lattice>, Vec<String>), String> {
    load_from(text.as_bytes(), "p", ending, options)
        .map(|(particles, _)| {
            let notices = particles.notices().iter().map(|notice| notice.words(Place::Argument));
            (particles.lattice().copied(), notices.collect())
        })
        .map_err(|error| format!("{error:#}"))
}

fn lattice(text: &str, ending: &str, options: Options) -> Lattice {
    box_of(text, ending, options).unwrap().0.unwrap()
}

fn with(boundaries: Boundaries) -> Options {
    Options { boundaries, ..NONE }
}

fn given(edges: Option<&str>, periodic: Option<&str>) -> Options {
    with(Boundaries {
        edges: edges.map(|text| text.parse().unwrap()),
        periodic: periodic.map(|text| text.parse().unwrap()),
        open: false,
    })
}

fn open() -> Options {
    with(Boundaries { open: true, ..Boundaries::AS_DECLARED })
}

fn of(vectors: [[f64; 3]; 3], periodic: [bool; 3], origin: [f64; 3]) -> Lattice {
    Lattice::new(vectors, periodic, origin).unwrap()
}

fn dump(bounds: &str, atoms: &str) -> String {
    format!("ITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS {bounds}ITEM: ATOMS {atoms}")
}

const ATOM: &str = "id radius x y z\n1 0.5 1 1 1\n";
const SCALED: &str = "id radius xs ys zs\n1 0.5 0.5 0.25 0.5\n";
/// From 10, -2, 1 by 4, 4, 2, with xy = -3, xz = -2, yz = -0.5: least of 0, xy, xz, xy + xz is -5.
const TILTED: &str = "xy xz yz pp ff pp\n5 14 -3\n-2.5 2 -2\n1 3 -0.5\n";

#[test]
fn dumps_say_where_the_box_is_and_along_which_axes_it_repeats() {
    let straight = dump("pp pp ff\n-1 3\n0 5\n2 4\n", ATOM);
    let vectors = [[4.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 2.0]];
    assert_eq!(lattice(&straight, "", NONE), of(vectors, [true, true, false], [-1.0, 0.0, 2.0]));
    let tilted = of(
        [[4.0, 0.0, 0.0], [-3.0, 4.0, 0.0], [-2.0, -0.5, 2.0]],
        [true, false, true],
        [10.0, -2.0, 1.0],
    );
    assert_eq!(lattice(&dump(TILTED, ATOM), "", NONE), tilted);
    // All of the tilt to the other side: from 1 by 3, with xy = 2, xz = 1, most is 3.
    let right = "xy xz yz pp pp pp\n1 7 2\n0 4.5 1\n0 2 0.5\n";
    assert_eq!(
        lattice(&dump(right, ATOM), "", NONE),
        of([[3.0, 0.0, 0.0], [2.0, 4.0, 0.0], [1.0, 0.5, 2.0]], [true; 3], [1.0, 0.0, 0.0])
    );
    let general = "abc origin pp ff pp\n4 0 0 -2\n1 5 0 -3\n0.5 0.25 6 -4\n";
    assert_eq!(
        lattice(&dump(general, ATOM), "", NONE),
        of(
            [[4.0, 0.0, 0.0], [1.0, 5.0, 0.0], [0.5, 0.25, 6.0]],
            [true, false, true],
            [-2.0, -3.0, -4.0]
        )
    );
    // Fixed and shrunken boundaries are open ones, however mixed.
    for flags in ["ff ff ff", "sm mf fs", "ss mm ff"] {
        let text = dump(&format!("{flags}\n0 1\n0 1\n0 1\n"), ATOM);
        assert_eq!(box_of(&text, "", NONE), Ok((None, vec![])), "{flags}");
    }
    // The box of a frame is for that frame.
    let frames = straight.clone() + &dump("ff ff ff\n0 1\n0 1\n0 1\n", ATOM);
    let frame = |frame| box_of(&frames, "", Options { frame, ..NONE }).unwrap().0.is_some();
    assert_eq!((frame(Frame::Number(0)), frame(Frame::Last)), (true, false));
    let bare = straight + &format!("ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS {ATOM}");
    let last = Options { frame: Frame::Last, ..NONE };
    assert_eq!(box_of(&bare, "", last), Ok((None, vec![])));
}

#[test]
fn scaled_coordinates_are_turned_into_lengths_in_boxes_of_every_shape() {
    let centre = |bounds: &str, atoms: &str| {
        let (particles, _) = load_from(dump(bounds, atoms).as_bytes(), "p", "", open()).unwrap();
        let said = particles.notices().iter().any(|notice| {
            let words = notice.words(Place::Argument);
            words == "coordinates scaled by the box (xs): turned into lengths, which are rounded"
        });
        assert!(said, "{:?}", particles.notices());
        particles.centre(0)
    };
    assert_eq!(centre("pp pp ff\n-1 3\n0 5\n2 4\n", SCALED), [1.0, 1.25, 3.0]);
    // 10 + 0.5 4 - 0.25 3 - 0.5 2, -2 + 0.25 4 - 0.5 0.5, 1 + 0.5 2.
    assert_eq!(centre(TILTED, SCALED), [10.25, -1.25, 2.0]);
    let general = "abc origin pp ff pp\n4 0 0 -2\n1 5 0 -3\n0.5 0.25 6 -4\n";
    assert_eq!(centre(general, "xsu ysu zsu radius\n0.5 0.5 0.5 1\n"), [0.75, -0.375, -1.0]);
    // Discs have no third vector.
    assert_eq!(centre(TILTED, "xs ys radius\n0.5 0.25 1\n"), [11.25, -1.0, 0.0]);
}

#[test]
fn boxes_of_which_nobody_says_whether_they_repeat_are_open_and_that_is_said() {
    let unknown = || Ok((None, vec![Notice::Boundaries.words(Place::Argument)]));
    let old = dump("\n0 4\n0 5\n0 6\n", ATOM);
    let data =
        "c\n\n1 atoms\n0 4 xlo xhi\n0 5 ylo yhi\n0 6 zlo zhi\nAtoms # sphere\n\n1 1 1 1 1 1 1\n";
    let mercury = "1 0 0 0 0 4 5 6\n1 2 3 0 0 0 1 0 0 0 0 0 0 0\n";
    let edges = |tilt: [f64; 3]| [[4.0, 0.0, 0.0], [tilt[0], 5.0, 0.0], [tilt[1], tilt[2], 6.0]];
    for text in [&old, data, mercury] {
        assert_eq!(box_of(text, "", NONE), unknown(), "{text}");
        // Whoever says so knows it.
        assert_eq!(box_of(text, "", open()), Ok((None, vec![])), "{text}");
        assert_eq!(box_of(text, "", given(None, Some("none"))), Ok((None, vec![])), "{text}");
        let periodic = lattice(text, "", given(None, Some("xz")));
        assert_eq!(periodic, of(edges([0.0; 3]), [true, false, true], [0.0; 3]), "{text}");
    }
    // Data files have the bounds of the box itself, tilted or not.
    let tilted = data.replace("Atoms", "1 -2 0.5 xy xz yz # tilt\nAtoms");
    assert_eq!(box_of(&tilted, "", NONE), unknown());
    assert_eq!(
        lattice(&tilted, "", given(None, Some("xyz"))),
        of(edges([1.0, -2.0, 0.5]), [true; 3], [0.0; 3])
    );
    let general = "c\n\n1 atoms\n4 0 0 avec\n1 5 0 bvec\n0 0 6 cvec\n1 2 3 abc origin\nAtoms # \
                   sphere\n\n1 1 1 1 1 1 1\n";
    assert_eq!(
        lattice(general, "", given(None, Some("y"))),
        of(edges([1.0, 0.0, 0.0]), [false, true, false], [1.0, 2.0, 3.0])
    );
    // Without a box there is nothing to say.
    assert_eq!(box_of("x,y,r\n1,2,3\n", "csv", NONE), Ok((None, vec![])));
}

#[test]
fn a_lattice_repeats_along_all_vectors_unless_pbc_says_otherwise() {
    let xyz = |comment: &str| format!("1\n{comment} Properties=pos:R:3:r:R:1\n1 2 3 0.5\n");
    let wild = [[0.2, 1.2, 1.4], [1.4, 0.1, 1.6], [1.3, 2.0, -0.1]];
    let text = "Lattice=\"0.2 1.2 1.4 1.4 0.1 1.6 1.3 2.0 -0.1\"";
    assert_eq!(lattice(&xyz(text), "xyz", NONE), of(wild, [true; 3], [0.0; 3]));
    let corner = format!("{text} pbc='T F t' Origin=\"1 2 3\"");
    assert_eq!(lattice(&xyz(&corner), "xyz", NONE), of(wild, [true, false, true], [1.0, 2.0, 3.0]));
    let numbers = format!("pbc=\"1 0 True\" energy=-1 {text}");
    assert_eq!(lattice(&xyz(&numbers), "xyz", NONE).periodic(), [true, false, true]);
    for none in ["pbc=\"F F F\"".to_string(), format!("{text} pbc=\"F F F\"")] {
        assert_eq!(box_of(&xyz(&none), "xyz", NONE), Ok((None, vec![])), "{none}");
    }
    // Plain files may have one, too.
    let plain = "1\nLattice=\"4 0 0 0 5 0 0 0 6\"\nA 1 2 3\n";
    assert_eq!(
        lattice(plain, "xyz", HALF),
        Lattice::along_axes([4.0, 5.0, 6.0], [true; 3]).unwrap()
    );
    // Discs leave the third vector out, and what there is must be in their plane.
    let plane = |numbers: &str| {
        let text = format!("1\nLattice=\"{numbers}\" Properties=pos:R:2:r:R:1\n1 2 0.5\n");
        box_of(&text, "xyz", NONE).map(|(lattice, _)| lattice.unwrap())
    };
    let flat = plane("4 0 0 1 5 0 7 8 9").unwrap();
    assert_eq!((flat.periodic(), flat.vectors()[1]), ([true, true, false], [1.0, 5.0, 0.0]));
    assert_eq!(
        plane("4 0 0 1 5 2 7 8 9").unwrap_err(),
        "p: vector 2 of the box leaves the plane of the discs: its z is 2, and must be 0 (--box, \
         --periodic, --open)"
    );
    let spheres = "1\nLattice=\"4 0 0 0 5 0 0 0 6\" Properties=pos:R:3:r:R:1\n1 2 0 0.5\n";
    let discs = lattice(spheres, "xyz", Options { dim: Some(2), ..NONE });
    assert_eq!(discs.periodic(), [true, true, false]);
}

#[test]
fn the_options_have_the_last_word() {
    let file = dump("pp pp ff\n-1 3\n0 5\n2 4\n", ATOM);
    let own = [[4.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 2.0]];
    let corner = [-1.0, 0.0, 2.0];
    assert_eq!(lattice(&file, "", given(None, Some("zy"))), of(own, [false, true, true], corner));
    let cases: [(&str, [[f64; 3]; 3]); 5] = [
        ("7,8,9", [[7.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 9.0]]),
        ("7 8", [[7.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0; 3]]),
        ("7,1,2,8", [[7.0, 1.0, 0.0], [2.0, 8.0, 0.0], [0.0; 3]]),
        ("7,8,9,-1,2e0,0.5", [[7.0, 0.0, 0.0], [-1.0, 8.0, 0.0], [2.0, 0.5, 9.0]]),
        ("7,1,2,3,8,4,5,6,9", [[7.0, 1.0, 2.0], [3.0, 8.0, 4.0], [5.0, 6.0, 9.0]]),
    ];
    for (text, vectors) in cases {
        // The corner and the axes stay the file's.
        let expected = of(vectors, [true, true, false], corner);
        assert_eq!(lattice(&file, "", given(Some(text), None)), expected, "{text}");
        // Without a word of the file, a box repeats along all that it has.
        let bare = "x,y,z,r\n1,2,3,0.5\n";
        let all = [true, true, vectors[2] != [0.0; 3]];
        let expected = of(vectors, all, [0.0; 3]);
        assert_eq!(lattice(bare, "csv", given(Some(text), None)), expected, "{text}");
        let discs = lattice("x,y,r\n1,2,0.5\n", "csv", given(Some("7,8,9"), None));
        assert_eq!(discs.periodic(), [true, true, false]);
    }
    for options in [open(), given(None, Some("none"))] {
        assert_eq!(box_of(&file, "", options), Ok((None, Vec::new())));
        assert_eq!(rows(&read(file.as_bytes(), "", options).unwrap()), [[1.0, 1.0, 1.0, 0.5]]);
    }
}

#[test]
fn lengths_that_are_rounded_differences_are_said() {
    let note = "the vectors of the box are differences of its bounds, and rounded; --box gives \
                them to the last digit";
    let notes = |bounds: &str, options| box_of(&dump(bounds, ATOM), "", options).unwrap().1;
    assert_eq!(notes("pp pp pp\n-0.1 0.2\n0 1\n0 1\n", NONE), [note]);
    assert_eq!(notes("xy xz yz pp pp pp\n-0.1 1 -0.1\n0 1 0\n0 1 0\n", NONE), [""; 0]);
    assert_eq!(notes("xy xz yz pp pp pp\n-0.1 1 -0.3\n0 1 0\n0 1 0\n", NONE), [note]);
    // 0.3 itself is a number like others.
    assert_eq!(notes("pp pp pp\n0 0.3\n-1 1\n0.25 1\n", NONE), [""; 0]);
    assert_eq!(notes("pp pp pp\n-0.1 0.2\n0 1\n0 1\n", given(Some("0.3,1,1"), None)), [""; 0]);
    assert_eq!(notes("ff ff ff\n-0.1 0.2\n0 1\n0 1\n", NONE), [""; 0]);
}

/// Whatever the format, no open scene is made of particles with a box, but where that is asked for.
#[test]
fn no_box_is_ignored() {
    let words = |axes: &str| {
        format!(
            "p: the box repeats along {axes}, and here boundaries are open; give --open to leave \
             out contacts across it"
        )
    };
    for (flags, axes) in [("pp ff ff", "x"), ("ff pp pp", "y and z"), ("pp pp pp", "x, y and z")] {
        let text = dump(&format!("{flags}\n0 4\n0 4\n0 4\n"), ATOM);
        assert_eq!(read(text.as_bytes(), "", NONE), Err(words(axes)));
        assert!(read(text.as_bytes(), "", open()).is_ok());
    }
    let csv = b"x,y,z,r\n1,2,3,0.5\n";
    assert_eq!(read(csv, "csv", given(Some("4,4"), None)), Err(words("x and y")));
    let xyz = b"1\nLattice=\"4 0 0 0 4 0 0 0 4\"\nA 1 2 3\n";
    assert_eq!(read(xyz, "xyz", HALF), Err(words("x, y and z")));
    // With a box, particles come with it.
    let (particles, _) = load_from(&xyz[..], "p", "xyz", HALF).unwrap();
    let given = particles.given("p", Some(0.5)).unwrap();
    assert_eq!(given.scene.len(), 1);
    assert!(given.lattice.is_some_and(|lattice| lattice.repeats()));
}
