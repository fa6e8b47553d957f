//! The formats: what is read (`text`, `npy`), what is refused and in which words, and that no bytes
//! make a reader panic (`refused`); their boxes (`boxes`); frames (`frames`), also in several files
//! (`series`).

mod arrays;
mod boxes;
mod codes;
mod frames;
mod lists;
mod npy;
mod refused;
mod series;
mod tables;
mod text;
mod xyz;

use std::path::PathBuf;

use super::*;
use crate::io::formats::npy::MAGIC;
use crate::scene::{Real, array};
use crate::with_scene;

const NONE: Options = Options::NONE;
const HALF: Options = Options { radius: Some(0.5), ..NONE };

fn read(bytes: &[u8], ending: &str, options: Options) -> Result<AnyScene<'static>, String> {
    from(bytes, "p", ending, options).map_err(|error| format!("{error:#}"))
}

/// Coordinates and radii of all particles, one list each.
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

#[test]
fn what_is_not_read_in_a_comment_or_of_a_shape_is_doubted() {
    let said = |text: &str| {
        let (particles, _) = load_from(text.as_bytes(), "p", "xyz", HALF).unwrap();
        particles.notices().iter().map(|notice| notice.words(Place::Argument)).collect::<String>()
    };
    let plain = |comment: &str| said(&format!("2\n{comment}\nA 1 2 3\nA 4 5 6\n"));
    for comment in ["XYZ 8.1 8.5 15.0", "1 8.0 8.0 8.0", "step:1 columns:id,pos", "cell:10,10,10"] {
        assert!(plain(comment).contains("line 2 may hold a box"), "{comment}");
    }
    for comment in ["", "water, 300 K", "frame 7 energy -1.5"] {
        assert_eq!(plain(comment), "", "{comment}");
    }
    let dump = |names: &str| {
        said(&format!(
            "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff ff ff\n0 9\n0 9\n0 \
             9\nITEM: ATOMS x y z {names}\n1 2 3 4 4 5\n"
        ))
    };
    assert!(dump("shapex shapey shapez").contains("may be no spheres"));
    assert_eq!(dump("vx vy vz"), "");
}

#[test]
fn names_that_may_be_frames_are_doubted() {
    let said = |text: &str| {
        let (particles, _) = load_from(text.as_bytes(), "p", "csv", NONE).unwrap();
        particles.notices().iter().map(|notice| notice.words(Place::Argument)).collect::<String>()
    };
    for name in ["timestamp", "frame_idx", "sim_time", "slice", "cycle"] {
        let words = said(&format!("{name},x,y,r\n0,0,0,1\n1,1,0,1\n"));
        assert!(words.contains(&format!("--columns frame={name}")), "{name}: {words}");
    }
    assert_eq!(said("mass,x,y,r\n0,0,0,1\n1,1,0,1\n"), "");
    let ply = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
               property float radius\nproperty float time\nend_header\n0 0 1 0\n1 0 1 1\n";
    let (particles, _) = load_from(ply.as_bytes(), "p", "ply", NONE).unwrap();
    let words = format!("{:?}", particles.notices());
    assert!(words.contains("'time' is not used"), "{words}");
}

#[test]
fn boxes_and_columns_are_not_lost_behind_quotes_and_styles() {
    let quotes = "1\npath=\"C:\\data\\\" Lattice=\"10 0 0 0 10 0 0 0 10\"\nA 1 2 3\n";
    let error = read(quotes.as_bytes(), "xyz", HALF).unwrap_err();
    assert!(error.contains("Lattice stands within the value of another key"), "{error}");
    let hybrid = "t\n\n1 atoms\n\nAtoms # hybrid dipole sphere\n\n1 1 0 0 0 0 9 9 9 2 1\n";
    assert_eq!(rows(&read(hybrid.as_bytes(), "data", NONE).unwrap()), [[0.0, 0.0, 0.0, 1.0]]);
    // Properties hold digits, and are no box.
    let own = "1\nProperties=species:S:1:pos:R:3:radius:R:1\nA 1 2 3 0.5\n";
    let (particles, _) = load_from(own.as_bytes(), "p", "xyz", NONE).unwrap();
    assert_eq!(particles.notices(), []);
}

#[test]
fn dimension_and_radii_follow_the_rules() {
    let flat = b"x,y,z,r\n1,2,0,1\n3,4,-0,1\n";
    assert_eq!(read(flat, "csv", NONE).unwrap().dim(), 3);
    let plane = read(flat, "csv", Options { radius: None, dim: Some(2), ..NONE }).unwrap();
    assert_eq!(rows(&plane), [[1.0, 2.0, 1.0], [3.0, 4.0, 1.0]]);
    assert!(plane.uniform(), "equal radii are one radius");
    assert!(!read(b"x,y,r\n1,2,1\n3,4,2\n", "csv", NONE).unwrap().uniform());
    assert_eq!(read(b"x,y,r\n", "csv", NONE).unwrap().len(), 0);
    assert_eq!(read(b"# x y r\n", "csv", NONE).unwrap().len(), 0);
}

/// Sizes as listed in the index of the data. `CONTACTBENCH_DATA` names their folder, which is not
/// part of the project.
#[test]
fn real_files_have_their_number_of_particles() {
    let Some(data) = std::env::var_os("CONTACTBENCH_DATA").map(PathBuf::from) else { return };
    for (file, radius, n, dim) in [
        ("liggghts_packing/packing.csv", None, 22_410, 3),
        ("rcp_packing/centres.npy", Some(0.5), 10_000, 3),
        ("galaxies/xyz.npy", Some(1.0), 84_383, 3),
        ("craters/craters.csv", None, 24_520, 2),
    ] {
        let scene = scene(&data.join(file), Options { radius, dim: None, ..NONE })
            .unwrap_or_else(|error| panic!("{error:#}"));
        assert_eq!(
            (scene.len(), scene.dim(), scene.uniform()),
            (n, dim, radius.is_some()),
            "{file}"
        );
    }
}
