//! Errors name their place, and no file makes a reader panic.

use rand::{RngExt, SeedableRng};

use super::*;

#[test]
fn long_lines_and_missing_files_are_refused() {
    let long = [b"x,y,r\n1,2,3".as_slice(), &vec![b' '; LONGEST_LINE], b"\n"].concat();
    let message = read(&long, "csv", NONE).unwrap_err();
    assert!(message.starts_with("p:2: the line is longer than 1048576 bytes"), "{message}");
    let missing = scene(Path::new("/nowhere/p.csv"), NONE).unwrap_err();
    assert!(format!("{missing:#}").starts_with("cannot read /nowhere/p.csv: "), "{missing:#}");
    assert!(scene(Path::new("/"), NONE).is_err());
    let twice = read(&packed(&packed(b"x,y,r\n1,2,3\n")), "", NONE).unwrap_err();
    assert!(twice.contains("compressed twice"), "{twice}");
    let damaged = packed(format!("x,y,r\n{}", "1,2,3\n".repeat(1000)).as_bytes());
    let message = read(&damaged[..damaged.len() / 2], "", NONE).unwrap_err();
    assert!(message.starts_with("cannot read p"), "{message}");
}

/// The seed is fixed so that failures are reproducible.
#[test]
fn damaged_bytes_never_panic() {
    let files: [(&[u8], &str); 6] = [
        (b"x,y,z,r\n1,2,3,0.5\n4,5,6,0.5\n", "csv"),
        (b"# x y r\n1 2 3\n4 5 6\n", "txt"),
        (
            b"2\nProperties=\"species:S:1:pos:R:3:radius:R:1\" a='b c'\nA 1 2 3 4\nB 5 6 7 8\n",
            "xyz",
        ),
        (&npy_file("<f8", "False", "(2, 4)", &doubles(&[0.5; 8])), "npy"),
        (&npy_file(">f4", "True", "(2, 3)", &[0; 24]), "npy"),
        (&data("plane.gsd"), "gsd"),
    ];
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let (mut good, mut bad) = (0, 0);
    for (bytes, ending) in files {
        let options = [
            NONE,
            HALF,
            Options { dim: Some(2), ..NONE },
            Options { radius: Some(1.0), dim: Some(3), ..NONE },
        ];
        let mut see = |bytes: &[u8], options| match read(bytes, ending, options) {
            Ok(_) => good += 1,
            Err(message) => {
                bad += 1;
                assert!(message.len() < 1000 && !message.is_empty(), "{message}");
            }
        };
        for end in (0..=bytes.len()).step_by(1 + bytes.len() / 500) {
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
