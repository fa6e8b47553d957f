//! Estimates the number of pairs of a scene before a detector runs.
//!
//! If radii and coordinates are given in different units, every particle may touch hundreds of
//! others. A sample detects this within a moment, before a detection that takes minutes.

use crate::limits::refusal::Refusal;
use crate::pairs::pair_list::PAIR_BYTES;
use crate::scene::{AnyScene, Real, Scene, array};
use crate::with_scene;
use contactbench_terms::mix::splitmix64;

/// Number of random particles that are compared with all others.
const SAMPLE: usize = 100;
/// Number of standard errors that are subtracted from the mean for a safe lower bound.
const SURE: f64 = 4.0;

/// Number of contacts per particle, estimated from a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crowd {
    /// Mean number of contacts per particle.
    pub mean: f64,
    /// Lower bound of the mean number of contacts; equal to the mean if all particles were sampled.
    pub least: f64,
}

impl Crowd {
    /// Compares 100 random particles with all others; smaller scenes are compared in full. Each
    /// call draws the same particles. Distances are rounded.
    pub fn new(scene: &AnyScene<'_>) -> Crowd {
        let n = scene.len();
        let asked: Vec<usize> = if n <= SAMPLE {
            (0..n).collect()
        } else {
            (0..SAMPLE as u64).map(|k| (splitmix64(k) % n as u64) as usize).collect()
        };
        let count = asked.len().max(1) as f64;
        let found: Vec<f64> = with_scene!(scene, scene => {
            asked.iter().map(|&i| touching(scene, i) as f64).collect()
        });
        let mean = found.iter().sum::<f64>() / count;
        let square = found.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        let error = if n <= SAMPLE { 0.0 } else { (square / (count - 1.0) / count).sqrt() };
        Crowd { mean, least: (mean - SURE * error).max(0.0) }
    }
}

/// Counts the particles that touch particle `i`, except those whose squares of distances overflow.
fn touching<T: Real, const D: usize>(scene: &Scene<'_, T, D>, i: usize) -> usize {
    (0..scene.len()).filter(|&j| touch(scene, i, j)).count()
}

#[inline(always)]
fn touch<T: Real, const D: usize>(scene: &Scene<'_, T, D>, i: usize, j: usize) -> bool {
    let [a, b] = [i, j].map(|k| array(&scene.centres()[k]).map(Real::wide));
    let square: f64 = (0..D).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
    let reach = scene.radius(i).wide() + scene.radius(j).wide();
    let near = square <= reach * reach && square < f64::INFINITY;
    i != j && near && (reach * reach > 0.0 || a == b)
}

/// Returns whether the mean number of contacts may be `each` or more. It tests a number of random
/// pairs of which six would touch if the mean were `each`, and returns true if at least three
/// touch. Fewer touch by chance once in 16 times, and once in 2,000 if the mean is twice as large;
/// the list then ends at its limit. Also returns true if too many tests would be needed or there
/// are few particles.
fn might_touch(scene: &AnyScene<'_>, each: f64) -> bool {
    const EXPECTED: f64 = 6.0;
    const ENOUGH: usize = 3;
    let n = scene.len() as u64;
    let samples = (EXPECTED * n as f64 / each) as u64;
    if n <= SAMPLE as u64 || samples > n / 4 {
        return true;
    }
    let drawn = |k: u64| (splitmix64(k) % n) as usize;
    with_scene!(scene, scene => {
        let touching = (0..samples).filter(|&k| touch(scene, drawn(2 * k), drawn(2 * k + 1)));
        touching.take(ENOUGH).count() == ENOUGH
    })
}

/// Refuses a scene whose list of pairs will almost certainly take more than `limit` bytes. Fails
/// with [`Refusal::Crowd`].
pub fn within(scene: &AnyScene<'_>, limit: u64) -> Result<(), Refusal> {
    let n = scene.len() as f64;
    let bytes = |each: f64| 0.5 * each * n * PAIR_BYTES as f64;
    // In most scenes even all pairs take less than the limit.
    if bytes(n - 1.0) <= limit as f64 {
        return Ok(());
    }
    if !might_touch(scene, limit as f64 / bytes(1.0)) {
        return Ok(());
    }
    let crowd = Crowd::new(scene);
    if bytes(crowd.least) <= limit as f64 {
        return Ok(());
    }
    Err(Refusal::Crowd { particles: scene.len() as u64, each: crowd.mean, limit })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(n: u32, centre: impl Fn(u32) -> [f64; 2], r: f64) -> AnyScene<'static> {
        AnyScene::at((0..n).map(centre), r).unwrap()
    }

    #[test]
    fn crowds_are_refused_and_packs_are_not() {
        // 4,000 particles at one point have 7,998,000 pairs of 8 bytes.
        let heap = scene(4000, |_| [1.0, 2.0], 0.0);
        assert_eq!(Crowd::new(&heap), Crowd { mean: 3999.0, least: 3999.0 });
        assert_eq!(within(&heap, 63_984_000), Ok(()));
        let refusal = within(&heap, 63_983_999).unwrap_err();
        assert_eq!(refusal, Refusal::Crowd { particles: 4000, each: 3999.0, limit: 63_983_999 });
        let few = scene(80, |_| [1.0, 2.0], 0.0);
        assert_eq!(within(&few, 8 * 80 * 79 / 2), Ok(()));
        assert!(within(&few, 8 * 80 * 79 / 2 - 1).is_err());
        // In a square lattice particles inside have four contacts, and those at the edges fewer.
        let lattice = |k: u32| [f64::from(k % 64), f64::from(k / 64)];
        let pack = scene(4096, lattice, 0.5);
        let crowd = Crowd::new(&pack);
        assert!(crowd.least < 4.0 && crowd.mean > 3.5, "{crowd:?}");
        assert_eq!(within(&pack, 8 * 8064), Ok(()));
        // Diameters of 10 on a lattice of spacing 1 give each particle about 300 neighbours.
        let crowd = Crowd::new(&scene(4096, lattice, 5.0));
        assert!((200.0..320.0).contains(&crowd.least) && crowd.mean < 320.0, "{crowd:?}");
    }

    /// Random pairs suffice to accept a packing with four neighbours, unless some touch by chance.
    /// A packing with 300 neighbours is sampled in full, at a limit of 100.
    #[test]
    fn random_pairs_separate_packings_from_crowds() {
        let lattice = |k: u32| [f64::from(k % 64), f64::from(k / 64)];
        let compared = |r: f64| {
            let scenes = (4096..4136).map(|n| scene(n, lattice, r));
            scenes.filter(|scene| might_touch(scene, 100.0)).count()
        };
        assert!(compared(0.5) <= 1 && compared(5.0) == 40, "{} {}", compared(0.5), compared(5.0));
    }

    #[test]
    fn a_crowd_too_small_to_be_sampled_well_is_left_to_the_list() {
        let few = scene(10_000, |k| [if k < 300 { 0.0 } else { f64::from(k) * 3.0 }, 0.0], 1.0);
        assert_eq!(Crowd::new(&few).least, 0.0);
    }

    #[test]
    fn distances_out_of_range_count_as_no_contact() {
        let far = |k: u32| [if k == 0 { 0.0 } else { f64::from(k) * 1e300 }, 0.0];
        assert_eq!(Crowd::new(&scene(50, far, 1e299)).mean, 0.0);
        let near = |k: u32| [f64::from(k) * 1e-200, 0.0];
        assert_eq!(Crowd::new(&scene(50, near, 0.0)).mean, 0.0);
        let empty = Crowd::new(&scene(0, near, 0.0));
        assert_eq!((empty.mean, empty.least), (0.0, 0.0));
    }
}
