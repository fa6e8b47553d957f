//! Files that people bring: every format by example, plain and compressed; which frame; where an
//! error is; what false promises cost.

mod errors;
mod examples;
mod formats;
mod limits;

use std::io::Write;

use contactbench::io::Options;
use contactbench::scene::{AnyScene, Real};
use contactbench::{io, with_scene};
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};

const NONE: Options = Options::NONE;

const HALF: Options = Options { radius: Some(0.5), ..NONE };

fn load(
    bytes: &[u8],
    ending: &str,
    options: Options,
) -> Result<(io::Particles, io::About), String> {
    io::load_from(bytes, "p", ending, options).map_err(|error| format!("{error:#}"))
}

fn refusal(bytes: &[u8], ending: &str, options: Options) -> String {
    let message = load(bytes, ending, options)
        .map(|(particles, about)| panic!("{about:?} {particles:?}"))
        .unwrap_err();
    assert!(!message.contains(char::is_control), "{message:?}");
    message
}

/// Coordinates and radii of all particles, one list each.
fn rows(scene: &AnyScene<'_>) -> Vec<Vec<f64>> {
    with_scene!(scene, scene => (0..scene.len())
        .map(|k| scene.centres()[k].iter().map(|x| x.wide()).chain([scene.radius(k).wide()]).collect())
        .collect())
}

fn read_rows(bytes: &[u8], ending: &str, options: Options) -> (Vec<Vec<f64>>, io::About) {
    let (particles, about) =
        load(bytes, ending, options).unwrap_or_else(|error| panic!("{ending}: {error}"));
    (rows(&particles.given("p", options.radius).unwrap().scene), about)
}

fn gz(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}
