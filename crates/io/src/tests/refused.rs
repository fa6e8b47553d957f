//! What is wrong with a file is said with its place, and never by a panic.

use rand::{RngExt, SeedableRng};

use super::*;

/// Text that is refused is in `cases/refused.txt`.
#[test]
fn bad_arrays_and_options_are_refused_with_place_and_remedy() {
    let shape = |shape| npy_file("<f8", "False", shape, &doubles(&[1.0; 4]));
    let numbers = |shape, numbers: &[f64]| npy_file("<f8", "False", shape, &doubles(numbers));
    for (bytes, words) in [
        (b"x,y\n".to_vec(), "p is not a NumPy file: it does not begin with \\x93NUMPY"),
        (b"\x93NUMPY".to_vec(), "p: the npy header is cut off"),
        (b"\x93NUMPY\x04\0\0\0".to_vec(), "p is npy version 4; versions 1 to 3 are read"),
        (b"\x93NUMPY\x02\0\0\0\0\x80".to_vec(), "the npy header has 2147483648 bytes"),
        (numbers("(1000000000000, 3)", &[1.0; 3]), "p: 1000000000000 particles; at most 2^32 - 1"),
        (numbers("(4000000000, 3)", &[1.0; 3]), "p ends before the 4000000000 x 3 numbers"),
        (numbers("(2, 2)", &[1.0, 2.0, 3.0, f64::NAN]), "p: particle 1 (from 0): y is NaN"),
        (
            numbers("(1, 4)", &[1.0, 2.0, 3.0, -1.0]),
            "particle 0 (from 0): the radius -1 is negative",
        ),
        (shape("(4,)"), "the shape is (4,); it must be (N, 2), (N, 3) or (N, 4)"),
        (shape("(2, 1)"), "the shape is (2, 1); it must be"),
        (shape("(-1, 2)"), "the shape is (-1, 2); it must be"),
        (shape("7"), "the shape is not of the form (N, 3)"),
        (shape("(1, 2)"), "p goes on after the 1 x 2 numbers"),
        (
            npy_file("<i8", "False", "(1, 2)", &[]),
            "the type '<i8' is not read; convert with .astype('f8')",
        ),
        (npy_file("<f8", "Maybe", "(1, 2)", &[]), "fortran_order is neither True nor False"),
    ] {
        let options = if words.contains("negative") { NONE } else { HALF };
        let message = read(&bytes, "npy", options).unwrap_err();
        assert!(message.contains(words), "{message}");
    }
    // As Finney's packing is published, in an array: number, x, y, z.
    let rows = [0.0, 1.5, 0.5, 1.0, 1.0, 1.5, 0.5, 0.5, 2.0, 1.5, 0.5, 0.25];
    let array = numbers("(3, 4)", &rows);
    assert!(read(&array, "npy", NONE).unwrap_err().contains("counts the particles"));
    assert!(read(&array, "npy", Options { dim: Some(3), ..NONE }).is_ok());
    let long = [b"x,y,r\n1,2,3".as_slice(), &vec![b' '; LONGEST_LINE], b"\n"].concat();
    let message = read(&long, "csv", NONE).unwrap_err();
    assert!(message.starts_with("p:2: the line is longer than 1048576 bytes"), "{message}");
    let message = read(b"x,y\n", "csv", Options { dim: Some(4), ..NONE }).unwrap_err();
    assert_eq!(message, "the dimension given is 4; it must be 2 or 3");
    let missing = scene(Path::new("/nowhere/p.csv"), NONE).unwrap_err();
    assert!(format!("{missing:#}").starts_with("cannot read /nowhere/p.csv: "), "{missing:#}");
    assert!(scene(Path::new("/"), NONE).is_err());
}

/// Damaged files give scenes or sentences, never a panic. The seed is fixed, so that a failure
/// comes back.
#[test]
fn damaged_bytes_never_panic() {
    let files: [(&[u8], &str); 5] = [
        (b"x,y,z,r\n1,2,3,0.5\n4,5,6,0.5\n", "csv"),
        (b"# x y r\n1 2 3\n4 5 6\n", "txt"),
        (
            b"2\nProperties=\"species:S:1:pos:R:3:radius:R:1\" a='b c'\nA 1 2 3 4\nB 5 6 7 8\n",
            "xyz",
        ),
        (&npy_file("<f8", "False", "(2, 4)", &doubles(&[0.5; 8])), "npy"),
        (&npy_file(">f4", "True", "(2, 3)", &[0; 24]), "npy"),
    ];
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let (mut good, mut bad) = (0, 0);
    for (bytes, ending) in files {
        let options = [
            NONE,
            HALF,
            Options { radius: None, dim: Some(2), ..NONE },
            Options { radius: Some(1.0), dim: Some(3), ..NONE },
        ];
        let mut see = |bytes: &[u8], options| match read(bytes, ending, options) {
            Ok(_) => good += 1,
            Err(message) => {
                bad += 1;
                assert!(message.len() < 1000 && !message.is_empty(), "{message}");
            }
        };
        for end in 0..=bytes.len() {
            options.into_iter().for_each(|options| see(&bytes[..end], options));
        }
        for round in 0..3000 {
            let mut bytes = bytes.to_vec();
            for _ in 0..rng.random_range(1..4) {
                let at = rng.random_range(0..bytes.len());
                let pool = b" ,;:\t\n\r\"'=#()-+.eE019\xff\0";
                match rng.random_range(0..3) {
                    0 => bytes[at] = pool[rng.random_range(0..pool.len())],
                    1 => bytes.insert(at, pool[rng.random_range(0..pool.len())]),
                    _ => bytes[at] ^= 1 << rng.random_range(0..8),
                }
            }
            see(&bytes, options[round % options.len()]);
        }
    }
    assert!(good > 500 && bad > 500, "{good} read, {bad} refused: the damage is not of both kinds");
}
