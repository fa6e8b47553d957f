"""The crate zelll, called from Rust: needs cargo, which downloads the crate once. It has no boxes.
The crate lists candidates, and the program tests their distances."""

from .external import CACHE, compiled, program

MANIFEST = """[package]
name = "list-rs"
edition = "2024"
[[bin]]
name = "list-rs"
path = "list.rs"
[dependencies]
zelll = "=0.5.0"
[workspace]
"""
SOURCE = """\
use std::io::{Read, Write};

use zelll::{CellGrid, ParticleLike};

#[derive(Clone, Copy, Default)]
struct Atom(usize, [f64; 3]);

impl ParticleLike<[f64; 3]> for Atom {
    fn coords(&self) -> [f64; 3] {
        self.1
    }
}

fn main() {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text).expect("input is text");
    let numbers: Vec<f64> =
        text.split_whitespace().map(|word| word.parse().expect("input is numbers")).collect();
    let (cutoff, positions) = (numbers[1], &numbers[14..]);
    let atoms = positions.chunks_exact(3).enumerate().map(|(i, x)| Atom(i, [x[0], x[1], x[2]]));
    // Wider cells leave room for the rounding of the crate's cell numbers.
    let grid = CellGrid::new(atoms, cutoff * (1.0 + 1e-5));
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    for (Atom(i, x), Atom(j, y)) in grid.particle_pairs() {
        let square: f64 = x.iter().zip(y).map(|(a, b)| (b - a) * (b - a)).sum();
        if square < cutoff * cutoff {
            writeln!(out, "{i} {j} 0 0 0").expect("output is read");
        }
    }
}
"""


def prepare(positions, cell, pbc, cutoff):
    if pbc.any():
        raise NotImplementedError("the library supports only open boxes")
    CACHE.mkdir(parents=True, exist_ok=True)
    source = CACHE / "list.rs"
    for name, text in (("Cargo.toml", MANIFEST), ("list.rs", SOURCE)):
        if not (CACHE / name).exists() or (CACHE / name).read_text() != text:
            (CACHE / name).write_text(text)
    build = 'cargo build -q --release --target-dir target && cp target/release/list-rs "$2"'
    path = compiled(source, ["sh", "-c", build, "sh"])
    return lambda: program([str(path)])(positions, cell, pbc, cutoff)
