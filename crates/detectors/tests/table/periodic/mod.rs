//! Compares detectors in boxes with the truth and with known results.

mod agreement;
mod crowded;
mod extremes;
mod finder;
mod golden;

use contactbench_detectors::oracle::boxes::truth;
use contactbench_detectors::table::{Entry, TABLE};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic};
use contactbench_ground::probe::Tally;
use contactbench_ground::scene::{AnyScene, Lattice, Radii, Scene};
use contactbench_lists::periodic::{Finder, contacts};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const LIMIT: u64 = 1 << 28;
/// A low memory limit, because larger grids take too long.
const OPTIONS: Options = Options { memory_limit: 1 << 26, threads: 1 };

#[derive(Clone, Debug)]
struct Bag<const D: usize> {
    centres: Vec<[f64; D]>,
    radii: Radii<'static, f64>,
    vectors: [[f64; 3]; 3],
    periodic: [bool; 3],
    origin: [f64; 3],
}

impl<const D: usize> Bag<D> {
    fn lattice(&self) -> Lattice {
        Lattice::new(self.vectors, self.periodic, self.origin).unwrap()
    }

    fn scene(&self) -> Scene<'static, f64, D> {
        Scene::at(self.centres.iter().copied(), self.radii.clone()).unwrap()
    }

    fn periodic(&self) -> Periodic<'static> {
        let scene = AnyScene::at(self.centres.iter().copied(), self.radii.clone()).unwrap();
        Periodic::new(scene, self.lattice()).unwrap()
    }

    /// Returns S·H in f64; used only if all products and sums are exact.
    fn shift(&self, image: [i32; 3]) -> [f64; D] {
        std::array::from_fn(|k| (0..3).map(|v| f64::from(image[v]) * self.vectors[v][k]).sum())
    }

    fn truth(&self) -> Vec<ImagePair> {
        truth(&self.periodic(), Arithmetic::Exact, LIMIT).unwrap().pairs
    }
}

fn detectors() -> impl Iterator<Item = &'static Entry> {
    TABLE.iter().filter(|entry| entry.must_be_right())
}

fn ask(
    detector: &mut dyn AnyDetector,
    periodic: &Periodic<'_>,
    arithmetic: Arithmetic,
) -> Result<Vec<ImagePair>, Refusal> {
    contacts(periodic, detector, arithmetic, LIMIT)
}

fn count(
    detector: &mut dyn AnyDetector,
    periodic: &Periodic<'_>,
    arithmetic: Arithmetic,
) -> (Digest, Tally) {
    let (mut tally, mut contacts) = (Tally::default(), ContactList::default());
    let mut finder = Finder::new(LIMIT);
    finder.find(periodic, detector, arithmetic, Some(&mut tally), &mut contacts).unwrap();
    (contacts.digest(), tally)
}

fn all_find<const D: usize>(bag: &Bag<D>, expected: &[ImagePair]) {
    let periodic = bag.periodic();
    for entry in detectors() {
        let found = ask(&mut *entry.make(OPTIONS), &periodic, Arithmetic::Exact);
        assert_eq!(found.as_deref(), Ok(expected), "{} on {bag:?}", entry.name);
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Numbers {
    Real,
    /// Small multiples of 2^-8, so that sums and small multiples are exact.
    Dyadic,
}

/// A random scene of up to about twenty particles. Boxes have all shapes, from much smaller than
/// the reach to larger: along axes, tilted, or arbitrary. Particles are inside or far outside.
fn random<const D: usize>(seed: u64, numbers: Numbers) -> Bag<D> {
    let random = &mut ChaCha8Rng::seed_from_u64(seed);
    let tidy = |x: f64| if numbers == Numbers::Dyadic { (x * 256.0).round() / 256.0 } else { x };
    let edge = [0.7, 1.5, 3.0, 6.0][random.random_range(0..4)];
    let mut vectors = [[0.0; 3]; 3];
    for (k, vector) in vectors.iter_mut().enumerate() {
        let stretch = [1.0, 1.0, 0.5, 3.0][random.random_range(0..4)];
        vector[k] = tidy(edge * stretch * (0.75 + 0.5 * random.random::<f64>()));
    }
    match seed % 4 {
        0 => {}
        // Tilted like the boxes of simulation codes, or further.
        1 => {
            let most = [1.0, 1.0, 4.0][random.random_range(0..3)];
            let diagonal = vectors[0][0];
            vectors[1][0] = tidy(most * diagonal * random.random::<f64>());
            if D == 3 {
                vectors[2][0] = tidy(-most * diagonal * random.random::<f64>());
                vectors[2][1] = tidy(most * vectors[1][1] * (random.random::<f64>() - 0.5));
            }
        }
        _ => {
            for vector in &mut vectors[..D] {
                for x in &mut vector[..D] {
                    *x = tidy(*x + edge * (random.random::<f64>() - 0.5));
                }
            }
        }
    }
    let mut periodic = std::array::from_fn(|_| random.random_bool(0.75));
    if D == 2 {
        periodic[2] = false;
    }
    let origin = std::array::from_fn(|_| tidy(4.0 * random.random::<f64>() - 2.0));
    if Lattice::new(vectors, periodic, origin).is_err() {
        return random_again(seed, numbers);
    }
    let most = if edge < 1.0 { 5 } else { 20 };
    let n = random.random_range(0..=most);
    let away = [0.0, 0.0, 3.0, 1000.0][random.random_range(0..4)];
    let centres: Vec<[f64; D]> = (0..n)
        .map(|_| {
            let mut x = [0.0; D];
            for (axis, (vector, periodic)) in vectors[..D].iter().zip(periodic).enumerate() {
                let away = if periodic { away } else { 0.0 };
                let part = random.random::<f64>() + (away * (random.random::<f64>() - 0.5)).round();
                // Some tilted boxes have particles in the upright box of the same edges.
                (0..D)
                    .filter(|&k| seed % 8 != 1 || k == axis)
                    .for_each(|k| x[k] += part * vector[k]);
            }
            x.map(tidy)
        })
        .collect();
    let size = [0.25, 0.5, 1.0][random.random_range(0..3)];
    let radius = |random: &mut ChaCha8Rng| tidy(size * (0.2 + 0.8 * random.random::<f64>()));
    let radii = match random.random_range(0..4) {
        0 | 1 => Radii::Uniform(radius(random)),
        2 => Radii::Each((0..n).map(|_| radius(random)).collect()),
        _ => {
            let mut radii: Vec<f64> = (0..n).map(|_| 0.125 * radius(random)).map(tidy).collect();
            radii.iter_mut().take(1).for_each(|giant| *giant = 2.0 * size);
            Radii::Each(radii.into())
        }
    };
    Bag { centres, radii, vectors, periodic, origin }
}

/// Draws another scene if the vectors of the first were coplanar by chance.
fn random_again<const D: usize>(seed: u64, numbers: Numbers) -> Bag<D> {
    random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1), numbers)
}
