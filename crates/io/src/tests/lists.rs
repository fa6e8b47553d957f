//! Contact lists in arrays; those of text are in `cases/lists.txt`.

use super::*;
use crate::pairs::{self, List};

fn list(bytes: &[u8]) -> anyhow::Result<List> {
    pairs::from(bytes, "p", &[], Frame::Only)
}

fn whole(numbers: &[i64]) -> Vec<u8> {
    numbers.iter().flat_map(|k| k.to_le_bytes()).collect()
}

/// `numpy.argwhere` and `numpy.array([i, j]).T` are in Fortran order.
#[test]
fn arrays_of_either_order_hold_the_same_pairs() {
    let pairs = [[0, 1], [1, 2], [2, 7]];
    for (fortran, shape, numbers) in [
        ("False", "(3, 2)", [0, 1, 1, 2, 2, 7]),
        ("True", "(3, 2)", [0, 1, 2, 1, 2, 7]),
        ("False", "(2, 3)", [0, 1, 2, 1, 2, 7]),
        ("True", "(2, 3)", [0, 1, 1, 2, 2, 7]),
    ] {
        let found = list(&npy_file("<i8", fortran, shape, &whole(&numbers))).unwrap();
        assert_eq!(found.pairs, pairs, "{shape} {fortran}");
        assert_eq!((found.images, found.notices), (None, vec![]), "{shape} {fortran}");
    }
    // As a square array is written in C order, each row is a pair, with a notice.
    let square = whole(&[0, 1, 1, 2]);
    let found = list(&npy_file("<i8", "False", "(2, 2)", &square)).unwrap();
    assert_eq!((found.pairs, found.notices.len()), (vec![[0, 1], [1, 2]], 1));
    let turned = list(&npy_file("<i8", "True", "(2, 2)", &whole(&[0, 4, 1, 5]))).unwrap();
    assert_eq!((turned.pairs, turned.notices.len()), (vec![[0, 1], [4, 5]], 0));
    // Images as columns of their own, and no pairs in the shapes that NumPy gives to nothing.
    let images = list(&npy_file("<i8", "False", "(4, 1)", &whole(&[3, 4, -1, 0]))).unwrap();
    assert_eq!((images.pairs, images.images), (vec![[3, 4]], Some(vec![[-1, 0, 0]])));
    for shape in ["(0,)", "(0, 2)", "(2, 0)"] {
        assert_eq!(list(&npy_file("<f8", "False", shape, &[])).unwrap().pairs, [[0; 2]; 0]);
    }
    for shape in ["(3,)", "(3, 3)", "(7, 8)"] {
        let error = list(&npy_file("<i8", "False", shape, &[])).unwrap_err().to_string();
        assert!(error.contains("(2, pairs)"), "{shape}: {error}");
    }
    // A half is no number of a particle, whichever column it stands in.
    let half = npy_file("<f8", "True", "(2, 2)", &doubles(&[0.0, 1.0, 1.0, 2.5]));
    assert!(list(&half).unwrap_err().to_string().contains("pair 1: 2.5"));
}

#[test]
fn arrays_of_every_type_of_whole_numbers_are_read() {
    for (descr, data) in [
        ("|u1", vec![0, 1, 1, 200]),
        ("|i1", vec![0, 1, 1, 100]),
        ("<u2", vec![0, 0, 1, 0, 1, 0, 2, 1]),
        (">i2", vec![0, 0, 0, 1, 0, 1, 1, 2]),
    ] {
        let found = list(&npy_file(descr, "False", "(2, 2)", &data)).unwrap();
        assert_eq!(found.pairs[0], [0, 1], "{descr}");
        assert!(found.pairs[1][1] >= 100, "{descr}: {:?}", found.pairs);
    }
}

/// An archive with files that are not compressed.
fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (name, data) in arrays {
        let name = format!("{name}.npy");
        bytes.extend(b"PK\x03\x04");
        bytes.extend([20, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend([0, 0]);
        bytes.extend(name.as_bytes());
        bytes.extend(data);
    }
    bytes.extend(b"PK\x01\x02");
    bytes
}

#[test]
fn archives_hold_i_and_j_or_one_array_of_pairs() {
    let row = |numbers: &[i64]| {
        npy_file("<i8", "False", &format!("({},)", numbers.len()), &whole(numbers))
    };
    let two = || npy_file("<i8", "False", "(3, 2)", &whole(&[0, 1, 1, 2, 2, 3]));
    let of = |arrays: &[(&str, Vec<u8>)]| list(&npz(arrays));
    let overlap = npy_file("<f8", "False", "(3,)", &doubles(&[0.5; 3]));
    let found = of(&[("j", row(&[1, 2, 3])), ("i", row(&[0, 1, 2])), ("overlap", overlap)]);
    let found = found.unwrap();
    assert_eq!((found.pairs, found.images), (vec![[0, 1], [1, 2], [2, 3]], None));
    assert_eq!(found.others[0].name, "overlap");
    // As ASE names them: S has a row for each.
    let shifts = npy_file("<i8", "False", "(1, 3)", &whole(&[0, -1, 1]));
    let found = of(&[("i", row(&[4])), ("j", row(&[5])), ("S", shifts)]).unwrap();
    assert_eq!((found.pairs, found.images), (vec![[4, 5]], Some(vec![[0, -1, 1]])));
    let found = of(&[("arr_0", row(&[0, 1])), ("arr_1", row(&[1, 2]))]).unwrap();
    assert_eq!((found.pairs, found.notices.len()), (vec![[0, 1], [1, 2]], 1));
    assert_eq!(of(&[("pairs", two())]).unwrap().pairs, [[0, 1], [1, 2], [2, 3]]);
    let refused = |arrays: &[(&str, Vec<u8>)], words: &str| {
        let error = format!("{:#}", of(arrays).unwrap_err());
        assert!(error.contains(words), "{error}");
    };
    refused(&[("a", two()), ("b", two())], "several arrays may hold the pairs: a b");
    refused(&[("i", row(&[0, 1])), ("j", row(&[1]))], "'j' has 1 numbers, and 'i' has 2");
    refused(&[("left", row(&[0])), ("right", row(&[1]))], "there are: left right");
    refused(&[("i", row(&[0])), ("j", row(&[1])), ("frame", row(&[0]))], "several frames");
    refused(&[("pairs", npy_file("<i8", "False", "(1, 7)", &whole(&[0; 7])))], "(2, pairs)");
}
