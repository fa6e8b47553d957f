//! The command line as users meet it: bad input ends with exit code 2 and one sentence that names
//! the place and the remedy; good input gives the same pairs in every form; every verb explains
//! itself.

mod check;
mod help;
mod output;
mod refusals;

use std::path::Path;

use crate::common;
use crate::common::Ended;

const DETECTORS: [&str; 12] = [
    "direct",
    "binary-tree",
    "screening",
    "sorting",
    "nbs",
    "streamed-nbs",
    "cell-grid",
    "hash-grid",
    "hgrid",
    "sweep",
    "kd-tree",
    "bvh",
];

/// A hexagonal layer of 12 x 12 discs that overlap a little, in no simple order (7 and 144 have no
/// common factor), with a radius each.
fn layer() -> Vec<[f64; 3]> {
    let place = |k: u32| {
        let (row, column) = (k / 12, k % 12);
        [
            0.975 * (f64::from(column) + 0.5 * f64::from(row % 2)),
            0.85 * f64::from(row),
            0.5 - 0.01 * f64::from(k % 3),
        ]
    };
    (0..144).map(|k| place(k * 7 % 144)).collect()
}

fn csv(particles: &[[f64; 3]]) -> String {
    particles.iter().fold("x,y,r\n".into(), |text, [x, y, r]| format!("{text}{x:?},{y:?},{r:?}\n"))
}

/// `detect` that is refused by name, with nothing on standard output.
fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let ended = common::refused(folder, &[&["detect"], arguments].concat(), words);
    assert_eq!(&*ended.stdout, "", "{arguments:?}");
    assert!(ended.stderr.starts_with("contactbench: "), "{}", ended.stderr);
}

fn detected(folder: &Path, arguments: &[&str]) -> Ended {
    common::good(folder, &[&["detect"], arguments].concat())
}
