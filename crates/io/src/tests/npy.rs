//! Reading and writing NumPy arrays.

use super::*;
use contactbench_ground::periodic::ImagePair;

/// Writes pairs without a scene, so their particles do not exist.
fn written(path: &Path, pairs: &[[u32; 2]]) -> anyhow::Result<()> {
    let scene = read(b"x,y,r\n", "csv", NONE).unwrap();
    let style = write::Style::plain(&scene);
    write::contacts(
        Some(path),
        pairs.iter().map(|&[i, j]| ImagePair { i, j, image: [0; 3] }),
        &style,
    )
}

/// The parts contain all rows, each once, wherever blocks of the stream end.
#[test]
fn a_part_of_an_array_is_its_rows_and_says_which() {
    let part = |bytes: &[u8], part: [u64; 2]| {
        let options = Options { part: Some(part), ..HALF };
        load_from(bytes, "p.npy", "npy", options).unwrap().0
    };
    for n in [0_u64, 2, 3, 10_000] {
        let numbers: Vec<f64> = (0..3 * n).map(|k| k as f64).collect();
        let bytes = npy_file("<f8", "False", &format!("({n}, 3)"), &doubles(&numbers));
        let mut seen = 0;
        for k in 0..3 {
            let particles = part(&bytes, [k, 3]);
            assert_eq!(particles.first, (n >= 3).then_some(seen), "{n} {k}");
            for row in 0..particles.len() {
                let first = 3.0 * (seen + row as u64) as f64;
                assert_eq!(particles.centre(row), [first, first + 1.0, first + 2.0]);
            }
            seen += if n >= 3 { particles.len() as u64 } else { 0 };
        }
        assert!(seen == n || n < 3);
    }
    let columns = npy_file("<f8", "True", "(3, 2)", &doubles(&[0.0; 6]));
    assert_eq!((part(&columns, [1, 3]).first, part(&columns, [1, 3]).len()), (Some(1), 1));
}

#[test]
fn arrays_of_several_pieces_are_whole() {
    let mut numbers: Vec<f64> = (0..4 * 10_000).map(|k| 1.0 + f64::from(k)).collect();
    let file = |numbers: &[f64]| npy_file("<f8", "False", "(10000, 4)", &doubles(numbers));
    let scene = read(&file(&numbers), "npy", NONE).unwrap();
    assert_eq!(rows(&scene).concat(), numbers);
    let by_column: Vec<f64> = (0..4)
        .flat_map(|k| (0..10_000).map(move |row| 4 * row + k))
        .map(|k| 1.0 + f64::from(k))
        .collect();
    let turned = npy_file("<f8", "True", "(10000, 4)", &doubles(&by_column));
    assert_eq!(read(&turned, "npy", NONE).unwrap(), scene);
    numbers[4 * 9876 + 2] = f64::NAN;
    let message = read(&file(&numbers), "npy", NONE).unwrap_err().to_string();
    assert!(message.contains("9876"), "{message}");
}

#[test]
fn pairs_are_written_as_csv_and_npy() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pairs.npy");
    let many: Vec<[u32; 2]> = (0..10_000).map(|k| [k, 3 * k + 1]).collect();
    for list in [&[[0, 1], [7, 0xfedc_ba98]][..], &[], &many] {
        let text: String = list.iter().map(|[i, j]| format!("{i},{j}\n")).collect();
        for name in ["pairs.csv", "pairs.CSV"] {
            let path = folder.path().join(name);
            written(&path, list).unwrap();
            assert_eq!(std::fs::read_to_string(&path).unwrap(), format!("i,j\n{text}"));
        }
        written(&path, list).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let start = bytes.len() - 8 * list.len();
        assert!(start.is_multiple_of(64) && start <= 192, "{start}");
        assert_eq!(bytes[..8], *b"\x93NUMPY\x01\0");
        assert_eq!(usize::from(bytes[8]), start - 10);
        let header =
            format!("{{'descr': '<u4', 'fortran_order': False, 'shape': ({}, 2), }}", list.len());
        assert_eq!(std::str::from_utf8(&bytes[10..start]).unwrap().trim_end(), header);
        assert_eq!(bytes[start - 1], b'\n');
        let words: Vec<u32> =
            bytes[start..].as_chunks().0.iter().map(|&word| u32::from_le_bytes(word)).collect();
        assert_eq!(words, list.as_flattened());
    }
    let refused = |path: &str| format!("{:#}", written(Path::new(path), &many).unwrap_err());
    let endings = "pairs.txt: the ending of a file of pairs must be .csv, .npy or .vtk";
    assert_eq!(refused("pairs.txt"), endings);
    assert!(refused("/nowhere/pairs.csv").starts_with("cannot write /nowhere/pairs.csv: "));
}
