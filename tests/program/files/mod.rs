//! Tests `detect`, and the files that the program reads and writes.

mod limits;
mod output;

use contactbench::io::{self, Options};
use contactbench::scene::spec::Spec;

use crate::common::Place;

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
            // Equal radii are read back as one radius for all particles.
            assert_eq!(found, expected, "{spec} in {name}");
        }
        assert_eq!(at.good(&format!("scene {spec}")).stdout, at.read("scene.csv"));
    }
}
