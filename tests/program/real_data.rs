//! Real particle sets, which are not part of the project: `CONTACTBENCH_DATA` names their folder.
//! The number of contacts that exact rational arithmetic gave, from every detector that does not
//! refuse.

use std::path::PathBuf;

use contactbench::contact::{Arithmetic, Test};
use contactbench::detect::Options;
use contactbench::detect::table::TABLE;
use contactbench::scene::AnyScene;
use contactbench::sink::Digest;
use contactbench::{io, oracle};

fn data(file: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("CONTACTBENCH_DATA") else {
        crate::common::untested("real particle sets", "CONTACTBENCH_DATA");
        return None;
    };
    Some(PathBuf::from(folder).join(file))
}

fn all_find(name: &str, scene: &AnyScene<'static>, expected: u64) {
    // Brute force would take long for the largest set; agreement of all detectors with the number
    // known is the test.
    for entry in TABLE.iter().filter(|entry| {
        entry.must_be_right() && (entry.name != "direct" || scene.len() <= oracle::BRUTE_FORCE)
    }) {
        let mut digest = Digest::default();
        entry.make(Options::default()).visit(scene, Test::Exact, &mut digest).unwrap();
        assert_eq!(digest.contacts, expected, "{} on {name}", entry.name);
    }
    assert_eq!(
        oracle::truth(scene, Arithmetic::Exact).unwrap().digest.contacts,
        expected,
        "{name}"
    );
}

fn read(file: &str, radius: Option<f64>) -> Option<AnyScene<'static>> {
    data(file).map(|path| {
        io::scene(&path, io::Options { radius, dim: None, ..io::Options::NONE }).unwrap()
    })
}

#[test]
fn granular_packing() {
    if let Some(scene) = read("liggghts_packing/packing.csv", None) {
        all_find("granular packing", &scene, 56_836);
    }
}

#[test]
fn random_close_packing() {
    for (radius, pairs) in [(0.51, 33_143), (0.5, 2)] {
        if let Some(scene) = read("rcp_packing/centres.npy", Some(radius)) {
            all_find("random close packing", &scene, pairs);
            if radius == 0.5 {
                // What rounding makes of a packing that is exactly jammed.
                assert_eq!(oracle::truth(&scene, Arithmetic::F32).unwrap().digest.contacts, 14_851);
            }
        }
    }
}

#[test]
fn galaxies() {
    for (radius, pairs) in [(1.0, 166_936), (0.4, 25_668)] {
        if let Some(scene) = read("galaxies/xyz.npy", Some(radius)) {
            all_find("galaxies", &scene, pairs);
        }
    }
}

#[test]
fn craters() {
    if let Some(scene) = read("craters/craters.csv", None) {
        all_find("craters", &scene, 13_231);
    }
}

#[test]
fn sph_points() {
    for (radius, pairs) in [(0.05, 306_458), (0.025, 18_977)] {
        if let Some(scene) = read("sph_knot/knot.vtk", Some(radius)) {
            all_find("SPH points", &scene, pairs);
        }
    }
}

/// The dump has twelve columns, the CSV that was made of it four: the same scene to the bit.
#[test]
fn a_dump_is_the_same_scene_as_its_csv() {
    if let (Some(dump), Some(csv)) =
        (read("liggghts_packing/packing.dump", None), read("liggghts_packing/packing.csv", None))
    {
        assert_eq!(dump, csv);
    }
}
