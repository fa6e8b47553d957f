//! `detect` and the files that it reads and writes.

mod doubts;
mod limits;
mod output;
mod real_data;

use contactbench::io::{self, Options};
use contactbench::scene::spec::Spec;

use crate::common::Place;

/// What is written reads back to the same bits, in every format.
#[test]
fn scenes_are_written_and_read_back_to_the_bit() {
    let at = Place::new();
    for spec in [
        "clustered:dim=3,n=300,size-ratio=7,seed=3",
        "loose:dim=2,n=200,offset=1e9",
        "packed:dim=3,n=100",
        "hard:case=subnormal-coordinates",
    ] {
        let expected = Spec::parse(spec).unwrap().make().unwrap();
        for name in ["scene.csv", "scene.xyz", "scene.npy"] {
            at.good(&format!("scene {spec} -o {name}"));
            let dim = name.ends_with("npy").then_some(expected.dim() as u32);
            let found = io::scene(&at.path(name), Options { dim, ..Options::NONE }).unwrap();
            // A list of equal radii comes back as one radius for all.
            assert_eq!(found, expected, "{spec} in {name}");
        }
        assert_eq!(at.good(&format!("scene {spec}")).stdout, at.read("scene.csv"));
    }
}

/// Arrays of other programs (VTK 9.5, NumPy 2) are read, or refused with the remedy.
#[test]
fn arrays_of_other_programs_are_read_or_refused() {
    let at = Place::new();
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/arrays");
    for (line, code, words) in [
        ("boxed.npz", 0, "0 pairs"),
        ("boxed.npz", 0, "'box' is taken as"),
        ("boxed.npz --periodic xyz", 0, "1 pair"),
        ("scalar.npz", 0, "0 pairs"),
        ("scalar.npz --box 10,10,10", 0, "1 pair"),
        ("structured.npy", 0, "0 pairs"),
        ("structured.npy --box 10,10,10", 0, "1 pair"),
        ("frames.npz --frame all", 0, "frame"),
        ("particle_radius.vtp --columns r=particle_radius", 0, "\n0,2\n"),
        ("cellradius.vtk", 0, "\n0,2\n"),
        ("both.vtp", 0, "\n0,2\n"),
        ("ascii-lz4-attribute.vtp", 0, "\n0,2\n"),
        ("particle_radius.vtp", 2, "--columns r=particle_radius"),
        ("glyph.vtp", 2, "48 polygons"),
        ("pieces.vtu", 0, "\n0,1\n"),
        ("parallel.pvtu", 0, "\n0,1\n"),
        ("series.pvd", 0, "\n0,1\n"),
    ] {
        at.ends(code, &format!("detect {data}/{line}"), &[words]);
    }
}
