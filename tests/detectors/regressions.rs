//! The contacts of the files of `tests/regressions`, which `check` gives to every detector.

use contactbench::io;
use contactbench_detectors::oracle;
use contactbench_ground::contact::Arithmetic;

/// Each file has exactly the contacts for which it was written.
#[test]
fn the_files_hold_the_pairs_that_they_name() {
    let pairs = |name: &str, arithmetic| {
        let path = format!("{}/tests/regressions/{name}.csv", env!("CARGO_MANIFEST_DIR"));
        let given = io::given(path.as_ref(), io::Options::default()).unwrap();
        oracle::truth(&given.open("a regression").unwrap(), arithmetic).unwrap().pairs
    };
    assert_eq!(pairs("three-discs", Arithmetic::Exact), [[0, 1]]);
    assert_eq!(pairs("three-discs", Arithmetic::F64), [[0, 1], [1, 2]]);
    assert_eq!(pairs("tangent-3-4-5", Arithmetic::Exact), [[0, 1], [0, 2], [4, 5]]);
    assert_eq!(pairs("far-apart", Arithmetic::Exact), [[0, 1], [3, 4], [4, 5]]);
    assert_eq!(pairs("subnormal", Arithmetic::Exact), [[0, 1], [0, 3]]);
    let all = pairs("subnormal", Arithmetic::F64);
    assert_eq!(all.len(), 10);
}
