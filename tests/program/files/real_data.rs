//! Tests real particle sets in the folder `CONTACTBENCH_DATA`, which is not part of the project.
//! Every detector refuses a set or finds as many contacts as exact rational arithmetic did.

use std::path::PathBuf;

use contactbench::io;
use contactbench_detectors::oracle;
use contactbench_detectors::table::{Speed, TABLE};
use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::detect::Options;
use contactbench_ground::pairs::sink::Digest;

#[test]
fn real_sets_have_their_number_of_contacts() {
    let Some(data) = std::env::var_os("CONTACTBENCH_DATA").map(PathBuf::from) else {
        crate::common::untested("real particle sets", "CONTACTBENCH_DATA");
        return;
    };
    let read = |file: &str, radius: Option<f64>| {
        io::scene(&data.join(file), io::Options { radius, ..io::Options::NONE }).unwrap()
    };
    let mut digest = Digest::default();
    for (file, radius, n, contacts) in [
        ("liggghts_packing/packing.csv", None, 22_410, 56_836),
        ("rcp_packing/centres.npy", Some(0.51), 10_000, 33_143),
        ("rcp_packing/centres.npy", Some(0.5), 10_000, 2),
        ("galaxies/xyz.npy", Some(1.0), 84_383, 166_936),
        ("galaxies/xyz.npy", Some(0.4), 84_383, 25_668),
        ("craters/craters.csv", None, 24_520, 13_231),
        ("sph_knot/knot.vtk", Some(0.05), 0, 306_458),
        ("sph_knot/knot.vtk", Some(0.025), 0, 18_977),
    ] {
        let scene = read(file, radius);
        assert!(n == 0 || scene.len() == n, "{file}: {}", scene.len());
        // Large sets are left to the fast detectors.
        let (all, large) = (scene.len() <= 20_000, scene.len() > 30_000);
        let asked = TABLE.iter().filter(|it| it.must_be_right() && (all || it.name != "direct"));
        for entry in asked.filter(|it| !large || it.speed == Speed::Fast) {
            digest = Digest::default();
            entry.make(Options::default()).visit(&scene, Test::Exact, &mut digest).unwrap();
            assert_eq!(digest.contacts, contacts, "{} on {file}", entry.name);
        }
        assert_eq!(oracle::truth(&scene, Arithmetic::Exact).unwrap().digest, digest, "{file}");
    }
    // In an exactly jammed packing, rounding to f32 breaks contacts.
    let jammed = read("rcp_packing/centres.npy", Some(0.5));
    assert_eq!(oracle::truth(&jammed, Arithmetic::F32).unwrap().digest.contacts, 14_851);
    // The dump has twelve columns, the CSV made from it four.
    let both = ["dump", "csv"].map(|it| read(&format!("liggghts_packing/packing.{it}"), None));
    assert_eq!(both[0], both[1]);
}
