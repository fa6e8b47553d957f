//! Boxes that cannot be used, and words of the options that are none.

use super::*;

#[test]
fn boxes_that_cannot_be_used_are_refused_in_words() {
    let bounds = |bounds: &str| dump(bounds, ATOM);
    let xyz = |comment: &str| format!("1\n{comment} Properties=pos:R:3:r:R:1\n1 2 3 0.5\n");
    let csv = || "x,y,r\n1,2,0.5\n".to_string();
    let cases: Vec<(String, &str, Options, &str)> = vec![
        (
            bounds("pf pp pp\n0 1\n0 1\n0 1\n"),
            "",
            NONE,
            "p:3: the boundaries of the box are 'pf pp pp': a box repeats at both ends of an \
             axis, pp; mend the line, or give --periodic or --open",
        ),
        (
            bounds("pp pp\n0 1\n0 1\n0 1\n"),
            "",
            NONE,
            "p:3: the boundaries of the box are 'pp pp': two letters for each of the three axes \
             are expected, as in pp pp ff; mend the line, or give --periodic or --open",
        ),
        (
            bounds("pp pp xx\n0 1\n0 1\n0 1\n"),
            "",
            NONE,
            "p:3: the boundaries of the box are 'pp pp xx': the letters are p, f, s and m, two \
             for each axis, as in pp pp ff; mend the line, or give --periodic or --open",
        ),
        (
            bounds("pp pp pp\n0 1\n0\n0 1\n"),
            "",
            NONE,
            "p:5: two bounds of the box are expected, lo and hi",
        ),
        (
            bounds("xy xz yz pp pp pp\n0 1 0\n0 1\n0 1 0\n"),
            "",
            NONE,
            "p:5: three numbers of the tilted box are expected: lo, hi and tilt",
        ),
        (
            bounds("abc origin pp pp pp\n1 0 0 0\n0 1 0\n0 0 1 0\n"),
            "",
            NONE,
            "p:5: four numbers of the box are expected: a vector, and one of its corner",
        ),
        (
            bounds("pp pp pp\n0 1 0.5\n0 1 0\n0 1 0\n"),
            "",
            NONE,
            "p:4: 3 numbers of the box, and its header announces 2; a tilted box has 'xy xz yz' \
             there: mend it, or give --open",
        ),
        (
            bounds("xy xz yz pp pp pp\n0 1 0\n0 1 nan\n0 1 0\n"),
            "",
            NONE,
            "p:5: column 3: 'nan' is not a finite number; a bound of the box is expected",
        ),
        (
            bounds("pp pp pp\n0 1\n2 2\n0 1\n"),
            "",
            NONE,
            "p: the box has no length along y, and cannot repeat there: mend it, or make that \
             axis open (--box, --periodic, --open)",
        ),
        (
            xyz("Lattice=\"1 2 3 0 0 1 1 2 4\""),
            "xyz",
            NONE,
            "p: the periodic vectors of the box enclose nothing: the distance of its faces along \
             vector 1 is 0; mend the box, or make that axis open (--box, --periodic, --open)",
        ),
        (
            bounds("pp pp pp\n0 1\n0 1\n-1e308 1e308\n"),
            "",
            NONE,
            "p: the box has a number inf; vectors and corner must be finite: mend the box (--box, \
             --periodic, --open)",
        ),
        (
            bounds("pp pp ff\n0 1\n5 0\n0 1\n"),
            "",
            NONE,
            "p:6: along y the box goes from 5 to 0; the lower bound stands first: mend the file, \
             or give --box or --open",
        ),
        (
            bounds("xy xz yz pp pp pp\n0 3 4\n0 1 0\n0 1 0\n"),
            "",
            NONE,
            "p:6: the tilt 4 0 0 is larger than the bounds, which are those of the box around the \
             tilted one: along x nothing is left; mend the file, or give --box or --open",
        ),
        (
            "\n\n1 atoms\n0 4 xlo xhi\n4 0 ylo yhi\n0 4 zlo zhi\n\nAtoms # sphere\n\n1 1 1 1 1 1 \
             1\n"
            .into(),
            "",
            with(Boundaries::AS_DECLARED),
            "p:5: the box goes from 4 to 0; the lower bound stands first: mend the file, or give \
             --box or --open",
        ),
        (
            bounds("pp pp pp\n0 1\n0 1e200\n0 1\n"),
            "",
            NONE,
            "p: vector 2 of the box is 1e200 long, and squares of it leave the range of f64; take \
             other units (--box, --periodic, --open)",
        ),
        (
            bounds("ff ff ff\n0 1\n0 1\n0 1\n"),
            "",
            given(Some("1,1,1"), None),
            "p says that its box is open along all axes; say with --periodic along which that of \
             --box repeats, as in --periodic xyz",
        ),
        (
            xyz("Lattice=\"1 0 0 0 1 0 0 0\""),
            "xyz",
            NONE,
            "p:2: column 1: Lattice=\"1 0 0 0 1 0 0 0\" must be nine finite numbers, one vector \
             after the other, or three edges; mend the line, or give --open",
        ),
        (
            xyz("Lattice=\"1 0 0 0 1 0 0 0 one\""),
            "xyz",
            NONE,
            "p:2: column 1: Lattice=\"1 0 0 0 1 0 0 0 one\" must be nine finite numbers, one \
             vector after the other, or three edges; mend the line, or give --open",
        ),
        (
            xyz("Lattice=\"1 0 0 0 1 0 0 0 1\" Origin=\"0 0\""),
            "xyz",
            NONE,
            "p:2: column 29: Origin=\"0 0\" must be three finite numbers; mend the line, or give \
             --open",
        ),
        (
            xyz("Lattice=\"1 0 0 0 1 0 0 0 1\" pbc=\"T T\""),
            "xyz",
            NONE,
            "p:2: column 29: pbc=\"T T\" must be T or F for each vector, as in pbc=\"T T F\"; \
             mend the line, or give --periodic or --open",
        ),
        (
            xyz("pbc=\"T T F\""),
            "xyz",
            NONE,
            "p says that it repeats along x and y, but not the box's vectors; give --box \
             LX,LY,LZ, or --open",
        ),
        (
            csv(),
            "csv",
            given(None, Some("x")),
            "--periodic needs a box, and p declares none; give --box LX,LY,LZ, or --open",
        ),
        (
            csv(),
            "csv",
            given(Some("1,1,1"), Some("xz")),
            "p holds discs, whose box repeats along x and y at most; leave z out of --periodic",
        ),
        (
            csv(),
            "csv",
            given(Some("1,1"), Some("none")),
            "--periodic none takes boundaries as open, and --box says otherwise; leave one out",
        ),
        (
            csv(),
            "csv",
            with(Boundaries { open: true, ..given(Some("1,1"), None).boundaries }),
            "--open takes boundaries as open, and --box says otherwise; leave one out",
        ),
        (
            csv(),
            "csv",
            with(Boundaries { open: true, ..given(None, Some("x")).boundaries }),
            "--open takes boundaries as open, and --periodic says otherwise; leave one out",
        ),
    ];
    for (text, ending, options, message) in &cases {
        assert_eq!(box_of(text, ending, *options).unwrap_err(), *message);
        // What is wrong with a box that nobody uses is no obstacle, but for numbers.
        let usable = (!message.contains("column") || message.contains("=\""))
            && !message.contains("expected: ")
            && !message.contains("bounds of the box are expected");
        assert_eq!(box_of(text, ending, open()).is_ok(), usable, "{message}");
    }
    // Words of the options.
    let form = "write LX,LY or LX,LY,LZ, with a tilt LX,LY,LZ,XY,XZ,YZ, or the vectors row by \
                row, four numbers for discs and nine for spheres";
    for (text, message) in [
        ("1", format!("1 number is no box; {form}")),
        ("", format!("0 numbers are no box; {form}")),
        ("1,2,3,4,5", format!("5 numbers are no box; {form}")),
        ("1,two", format!("'two' is not a finite number; {form}")),
        ("1,inf", format!("'inf' is not a finite number; {form}")),
    ] {
        assert_eq!(text.parse::<Edges>().unwrap_err(), message);
    }
    for text in ["", "xx", "xw", "XY", "x,y", "all"] {
        assert_eq!(
            text.parse::<Axes>().unwrap_err(),
            "it must be the axes along which the box repeats, as in x, xy or xyz; or true \
             for all, none or false for no axis"
        );
    }
    assert_eq!("zx".parse(), Ok(Axes::These([true, false, true])));
}
