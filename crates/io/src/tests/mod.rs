//! Tests of the readers: files (`cases`), several files (`series`), long arrays and written pairs
//! (`npy`), incomplete files (`frames`), damaged files (`refused`).

mod cases;
mod frames;
mod npy;
mod refused;
mod series;

use std::path::Path;

use super::*;
use crate::formats::npy::MAGIC;
use contactbench_ground::scene::{AnyScene, Real, array};
use contactbench_ground::with_scene;

const NONE: Options = Options::NONE;
const HALF: Options = Options { radius: Some(0.5), ..NONE };

fn read(bytes: &[u8], ending: &str, options: Options) -> Result<AnyScene<'static>, String> {
    let read = load_from(bytes, "p", ending, options);
    let scene = read.and_then(|(particles, _)| particles.scene("p", options.radius));
    scene.map_err(|error| format!("{error:#}"))
}

fn data(name: &str) -> Vec<u8> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    std::fs::read(root.join("tests/data").join(name)).unwrap()
}

fn rows(scene: &AnyScene<'_>) -> Vec<Vec<f64>> {
    with_scene!(scene, scene => {
        let centre = |k: usize| array(&scene.centres()[k]).map(|x| x.wide());
        let row = |k: usize| centre(k).into_iter().chain([scene.radius(k).wide()]).collect();
        (0..scene.len()).map(row).collect()
    })
}

fn npy_file(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header =
        format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes =
        [MAGIC, &[1, 0], &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat();
    bytes.extend_from_slice(data);
    bytes
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), Default::default());
    std::io::Write::write_all(&mut packed, bytes).unwrap();
    packed.finish().unwrap()
}

#[test]
fn the_documentation_lists_every_format() {
    let page = include_str!("../../../../docs/FILES.md");
    for Format { key, .. } in &FORMATS {
        assert!(page.contains(&format!("(`{key}`) |")), "{key}");
    }
}

#[test]
fn equal_radii_are_one_radius() {
    let uniform = |text: &str| read(text.as_bytes(), "csv", NONE).unwrap().uniform();
    assert!(uniform("x,y,r\n1,2,1\n3,4,1\n") && !uniform("x,y,r\n1,2,1\n3,4,2\n"));
}
