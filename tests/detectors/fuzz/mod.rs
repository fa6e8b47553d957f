//! Runs the fuzz targets on their seeds, on mutated seeds and on random bytes, equal on every run.

mod held;
mod readers;

use std::path::Path;

use contactbench::check::bytes::scene_from_bytes;
use contactbench_detectors::oracle;
use contactbench_ground::contact::Arithmetic;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use held::{fuzz_box, fuzz_one};
use readers::{fuzz_reader, fuzz_reader_of, reader, readers};

fn seeds(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/fuzz/seeds").join(target);
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
        .iter()
        .map(|path| {
            (path.file_name().unwrap().to_string_lossy().into(), std::fs::read(path).unwrap())
        })
        .collect()
}

/// Iterates over all seeds, then `count` random inputs and mutated seeds.
fn inputs(target: &str, count: u32) -> impl Iterator<Item = Vec<u8>> {
    let seeds: Vec<Vec<u8>> = seeds(target).into_iter().map(|(_, bytes)| bytes).collect();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let firsts = seeds.clone();
    let others = (0..count).map(move |k| {
        if k % 4 == 0 {
            let mut bytes = vec![0; random.random_range(4..400)];
            random.fill_bytes(&mut bytes);
            return bytes;
        }
        let mut bytes = seeds[random.random_range(0..seeds.len())].clone();
        for _ in 0..random.random_range(1..8) {
            let at = random.random_range(0..bytes.len().max(1)).min(bytes.len());
            match random.random_range(0..6) {
                0 => bytes.insert(at, random.random()),
                1 if at < bytes.len() => drop(bytes.remove(at)),
                2 => bytes.extend_from_slice(&seeds[random.random_range(0..seeds.len())]),
                3 => bytes.truncate(at),
                4 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
                _ if at < bytes.len() => bytes[at] = random.random(),
                _ => {}
            }
        }
        bytes
    });
    firsts.into_iter().chain(others)
}

#[test]
fn detectors_are_right_on_any_bytes() {
    inputs("scenes", 300).for_each(|bytes| fuzz_one(&bytes));
}

#[test]
fn detectors_are_right_on_any_bytes_in_a_box() {
    inputs("boxes", 100).for_each(|bytes| fuzz_box(&bytes));
}

#[test]
fn readers_take_any_bytes() {
    inputs("files", 5_000).for_each(|bytes| fuzz_reader(&bytes));
}

/// Every reader gets its own seeds and those of the other readers.
#[test]
fn every_reader_takes_any_bytes() {
    assert!(readers().count() >= 10);
    for name in readers() {
        let number = reader(&name).unwrap();
        let own = seeds("files").iter().filter(|(_, bytes)| bytes[0] & 15 == number).count();
        assert!(own > 0, "no seeds for {name}");
        inputs("files", 300).for_each(|bytes| fuzz_reader_of(number, &bytes));
    }
    assert_eq!(reader("zip"), None);
}

/// The fuzz inputs make scenes in 2D and 3D, with equal and with different radii, many with
/// contacts that rounding would decide otherwise.
#[test]
fn bytes_make_hard_scenes() {
    for (name, bytes) in seeds("scenes") {
        assert!(scene_from_bytes(&bytes).is_some_and(|scene| scene.len() > 2), "{name}");
    }
    let (mut scenes, mut touching, mut decided_by_rounding, mut kinds) = (0, 0, 0, [0; 4]);
    for bytes in inputs("scenes", 2000) {
        let Some(scene) = scene_from_bytes(&bytes) else { continue };
        scenes += 1;
        kinds[2 * (scene.dim() - 2) + usize::from(scene.uniform())] += 1;
        let exact = oracle::truth(&scene, Arithmetic::Exact).unwrap().pairs;
        touching += u32::from(!exact.is_empty());
        decided_by_rounding += u32::from(
            oracle::truth(&scene, Arithmetic::F64).is_ok_and(|rounded| rounded.pairs != exact),
        );
    }
    println!(
        "{scenes} scenes, {touching} with contacts, in {decided_by_rounding} f64 decides \
         otherwise than exact; kinds {kinds:?}"
    );
    assert!(
        scenes > 1000
            && 2 * touching > scenes
            && 10 * decided_by_rounding > scenes
            && kinds.iter().all(|&k| k > 100)
    );
}
