//! Real particle sets, where they are at hand (`../shared/data`, which is not part of the project): the number of touching couples that
//! exact rational arithmetic gave, from every detector that does not refuse.

use std::path::PathBuf;

use contactbench::contact::{Arithmetic, Test};
use contactbench::detect::Options;
use contactbench::detect::table::TABLE;
use contactbench::oracle;
use contactbench::read;
use contactbench::scene::{AnyScene, Radii, Scene};
use contactbench::sink::Digest;
use nalgebra::Point;

fn data(file: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(file);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
    }
    path.exists().then_some(path)
}

fn all_find(name: &str, scene: &AnyScene<'static>, expected: u64) {
    // Brute force would take long for the largest set; agreement of all detectors with the number known is the test.
    for entry in TABLE.iter().filter(|entry| entry.must_be_right() && (entry.name != "direct" || scene.len() <= oracle::BRUTE_FORCE)) {
        let mut digest = Digest::default();
        entry.make(Options::default()).visit(scene, Test::Exact, &mut digest).unwrap();
        assert_eq!(digest.contacts, expected, "{} on {name}", entry.name);
    }
    assert_eq!(oracle::truth(scene, Arithmetic::Exact).unwrap().digest.contacts, expected, "{name}");
}

fn read(file: &str, radius: Option<f64>) -> Option<AnyScene<'static>> {
    data(file).map(|path| read::scene(&path, read::Options { radius, dim: None, ..read::Options::NONE }).unwrap())
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

/// The file is VTK legacy, which this program does not read: its points are big-endian f32 behind the line `POINTS`.
#[test]
fn sph_points_after_conversion() {
    let Some(path) = data("sph_knot/knot.vtk") else { return };
    let bytes = std::fs::read(path).unwrap();
    let marker = b"POINTS 19539 float\n";
    let start = bytes.windows(marker.len()).position(|window| window == marker).unwrap() + marker.len();
    let number = |b: &[u8]| f64::from(f32::from_be_bytes([b[0], b[1], b[2], b[3]]));
    let points: Vec<Point<f64, 3>> =
        bytes[start..start + 19_539 * 12].chunks_exact(12).map(|p| Point::from([number(p), number(&p[4..]), number(&p[8..])])).collect();
    for (radius, pairs) in [(0.05, 306_458), (0.025, 18_977)] {
        all_find("SPH points", &Scene::new(points.clone(), Radii::Uniform(radius)).unwrap().into(), pairs);
    }
}
