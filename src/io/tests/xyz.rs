//! The comment line of extended XYZ, as its specification allows it.

use super::*;

/// The vectors of the declared box, and along which of them it repeats.
type Boxed = Option<(Option<[[f64; 3]; 3]>, Option<[bool; 3]>)>;

const TEN: Option<[[f64; 3]; 3]> = Some([[10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]]);
const SKEW: Option<[[f64; 3]; 3]> = Some([[10.0, 1.0, 0.0], [0.0, 10.0, 2.0], [3.0, 0.0, 10.0]]);

fn boxed(comment: &str, options: Options) -> Result<(f64, Boxed), String> {
    let text = format!("2\n{comment}\nC 0.25 5 5 0.5 9 8\nC 9.75 5 5 0.5 7 6\n");
    let read = load_from(text.as_bytes(), "p", "xyz", options);
    let (particles, about) = read.map_err(|error| format!("{error:#}"))?;
    let declared = about.declared.map(|declared| (declared.vectors, declared.periodic));
    Ok((particles.centre(1)[0], declared))
}

fn with(pair: &str, properties: &str) -> String {
    format!("{pair} Properties=species:S:1:{properties}")
}

/// Each was a box, flags or columns lost in silence, or refused, before.
#[test]
fn all_forms_of_the_specification_are_read() {
    const POS: &str = "pos:R:3:radius:R:1:v:R:2";
    let yes = Some([true; 3]);
    for (pair, vectors, periodic) in [
        ("Lattice = \"10 0 0 0 10 0 0 0 10\"", TEN, yes),
        ("Lattice\t=\t\"10\t0 0 0 10 0 0 0 10\"", TEN, yes),
        ("\"Lattice\"=\"10 0 0 0 10 0 0 0 10\"", TEN, yes),
        ("'Lattice' ='10 0 0 0 10 0 0 0 10'", TEN, yes),
        ("LATTICE=\"1.0D1 0 0 0 10.d0 0 0 0 1d+01\"", TEN, yes),
        ("Lattice={10 0 0 0 10 0 0 0 10}", TEN, yes),
        ("Lattice=[[10,0,0],[0,10,0],[0,0,10]]", TEN, yes),
        ("Lattice=[ [10, 1, 0], [0, 10, 2], [3, 0, 10] ]", SKEW, yes),
        ("Lattice=\"10 1 0 0 10 2 3 0 10\"", SKEW, yes),
        ("Lattice=[10, 1, 0, 0, 10, 2, 3, 0, 10]", SKEW, yes),
        ("Lattice=10,1,0,0,10,2,3,0,10", SKEW, yes),
        ("Lattice=\"10, 1, 0, 0, 10, 2, 3, 0, 10\"", SKEW, yes),
        ("Lattice=\"10 10 10\"", TEN, yes),
        ("energy=-1e3 name=\"a \\\"b\\\" = c\" flag Lattice=\"10 10 10\"", TEN, yes),
        ("name='it = {' Lattice=\"10 10 10\" pbc = \"T T F\"", TEN, Some([true, true, false])),
        ("Lattice=\"10 10 10\" pbc=[T, T, F]", TEN, Some([true, true, false])),
        ("Lattice=\"10 10 10\" pbc=[True, FALSE, false]", TEN, Some([true, false, false])),
        ("Lattice=\"10 10 10\" pbc={F F T}", TEN, Some([false, false, true])),
        ("Lattice=\"10 10 10\" pbc=T,T,F", TEN, Some([true, true, false])),
        ("Lattice=\"10 10 10\" PBC=\"1 1 0\"", TEN, Some([true, true, false])),
        ("Lattice=\"10 10 10\" \"pbc\" = F", TEN, Some([false; 3])),
        ("Lattice=\"10 10 10\" pbc=T cell=\"5 5 5\" box=7", TEN, yes),
    ] {
        let read = boxed(&with(pair, POS), NONE);
        assert_eq!(read, Ok((9.75, Some((vectors, periodic)))), "{pair}");
    }
    // The positions are the columns that the line names.
    for properties in [
        "Properties = species:S:1:pos:R:3:radius:R:1:v:R:2",
        "\"Properties\"=\"species:S:1:pos:R:3:radius:R:1:v:R:2\"",
        "Properties={species:S:1:pos:R:3:radius:R:1:v:R:2}",
    ] {
        assert_eq!(boxed(properties, NONE), Ok((9.75, None)), "{properties}");
    }
    let moved = "Properties = species:S:1:force:R:3:pos:R:3";
    assert_eq!(boxed(moved, HALF), Ok((0.5, None)));
    // Discs have four numbers and two flags.
    let plane = boxed(&with("Lattice=\"10 1 0 10\" pbc=\"T F\"", "pos:R:2:v:R:3:r:R:1"), NONE);
    let vectors = Some([[10.0, 1.0, 0.0], [0.0, 10.0, 0.0], [0.0; 3]]);
    assert_eq!(plane, Ok((9.75, Some((vectors, Some([true, false, false]))))));
    // The comment of a plain file is no pair.
    for comment in ["", "it's 5 o'clock", "= [ {", "a=\"b", "T = 3 [K", "Lattice constant 5"] {
        assert_eq!(boxed(comment, HALF), Ok((9.75, None)), "{comment}");
    }
}

#[test]
fn a_key_that_decides_and_cannot_be_read_is_refused_with_its_column() {
    const POS: &str = "pos:R:3:radius:R:1:v:R:2";
    for (pair, words) in [
        ("Lattice=\"10 0 0 0 10 0 0 0\"", "p:2: column 1: Lattice=\"10 0 0 0 10 0 0 0\" must be"),
        ("Lattice=10 0 0 0 10 0 0 0 10", "p:2: column 1: Lattice=\"10\" must be nine"),
        ("a=b Lattice=\"10 10\"", "column 5: Lattice="),
        ("Lattice=\"10 10 10 10\"", "column 1: Lattice="),
        ("Lattice=\"10 10 x\"", "column 1: Lattice="),
        ("Lattice=\"10 10 inf\"", "column 1: Lattice="),
        ("Lattice=[[10,0],[0,10,0],[0,0,10]]", "column 17: the rows of the array are not equally"),
        ("Lattice=[[[10,0,0]]]", "column 11: arrays have two levels"),
        ("Lattice=\"10 10 10", "column 9: the quote or brace that begins here has no end"),
        ("Lattice=[10, 10, 10", "column 9: the bracket that begins here has no end"),
        ("pbc==T", "column 5: no value stands behind '='"),
        ("Lattice=\"10 10 10\" pbc=\"T T\"", "column 20: pbc=\"T T\" must be T or F"),
        ("Lattice=\"10 10 10\" pbc=TTF", "column 20: pbc=\"TTF\" must be"),
        ("Lattice=\"9 9 9\" lattice=\"10 10 10\"", "column 17: Lattice stands there twice"),
        ("latice=\"10 10 10\"", "the key 'latice' is not read, and may be meant for Lattice"),
        ("cell=\"10 10 10\"", "the key 'cell' is not read"),
        ("Box = 10", "the key 'Box' is not read"),
        ("Lattice=\"9 9 9\" pbcs=T", "the key 'pbcs' is not read, and may be meant for pbc"),
        ("Lattice=\"9 9 9\" periodic=F", "the key 'periodic' is not read"),
    ] {
        let error = boxed(&with(pair, POS), NONE).unwrap_err();
        assert!(error.starts_with("p:2: ") && error.contains(words), "{pair}: {error}");
    }
    let box_of = "# CELL(abcABC): 10 10 10 90 90 90  Step: 0  positions{angstrom}";
    assert!(boxed(box_of, HALF).unwrap_err().contains("i-PI"), "a box that is not read");
    for comment in ["Propertes=species:S:1:pos:R:3", "property = species:S:1:pos:R:3"] {
        let error = boxed(comment, HALF).unwrap_err();
        assert!(error.contains("may be meant for Properties"), "{error}");
    }
    // The option that the message names.
    let open = Options { boundaries: Boundaries { open: true, ..Boundaries::AS_DECLARED }, ..NONE };
    assert_eq!(boxed(&with("cell=\"10 10 10\"", POS), open), Ok((9.75, None)));
}

/// Fortran writes exponents with D; so do its codes in columns of any text.
#[test]
fn exponents_with_d_are_read_in_every_text() {
    let text = b"2\nProperties=species:S:1:pos:R:3:radius:R:1\nC 1.0D+00 0.0D0 0 5d-1\n\
                 C 0.2D+01 0.0D0 0 5d-1\n";
    let expected = [[1.0, 0.0, 0.0, 0.5], [2.0, 0.0, 0.0, 0.5]];
    assert_eq!(rows(&read(text, "xyz", NONE).unwrap()), expected);
    let csv = b"x,y,z,r\n1.0D+00,0.0D0,0,5d-1\n0.2D+01,0d0,0,5D-1\n";
    assert_eq!(rows(&read(csv, "csv", NONE).unwrap()), expected);
    for word in ["d1", "1d", "1dd1", "0x1d1", "1d1.5", "d", "1d1e1"] {
        assert_eq!(lines::number(word.as_bytes()), None, "{word}");
    }
}
