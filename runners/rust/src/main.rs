//! Neighbour search libraries as runners (docs/PROTOCOL.md), to be measured beside our detectors.
//!
//! The argument is the name of a library. It is used as its documentation recommends, in f64 and on
//! one thread, as a *filter*: it finds all pairs that may be within reach of each other, and
//! [`scene::Scene::touch`] decides exactly. The time covers the same work as for other detectors,
//! from raw coordinates to the complete list of pairs, the construction of the library's structure
//! included.
//!
//! Build it in this folder: `cargo build --release`, or, with the SIMD code of kiddo,
//! `cargo +nightly build --release --features simd`.

mod libraries;
mod scene;
mod serve;

use libraries::{KdTree, Kiddo, Linkcell, Neighbourhood, Parry, Rstar, Zelll};
use serve::{serve, unavailable};

const NAMES: &str = "kd-tree, kiddo, linkcell, neighbourhood, parry, rstar, zelll";

fn main() -> std::io::Result<()> {
    let name = std::env::args().nth(1).unwrap_or_default();
    match name.as_str() {
        "kd-tree" => serve::<KdTree>("kd-tree-crate", "kd-tree"),
        "kiddo" => serve::<Kiddo>("kiddo", "kiddo"),
        "linkcell" => serve::<Linkcell>("linkcell", "linkcell"),
        "neighbourhood" => serve::<Neighbourhood>("neighbourhood", "neighbourhood"),
        "parry" => serve::<Parry>("parry", "parry3d-f64"),
        "rstar" => serve::<Rstar>("rstar", "rstar"),
        "zelll" => serve::<Zelll>("zelll", "zelll"),
        _ => unavailable(&format!("there is no library '{name}'; the libraries are: {NAMES}")),
    }
}
