//! Size classes of `streamed-nbs`, tested outside of the crate, whose code is then compiled once.

use contactbench_ground::contact::{Particles, Test, any_particles};
use contactbench_ground::scene::{Radii, Scene};
use contactbench_streamed::classes::Classes;
use nalgebra::Point;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn scene<const D: usize>(radii: Vec<f64>, edge: f64) -> Scene<'static, f64, D> {
    let mut random = ChaCha8Rng::seed_from_u64(radii.len() as u64);
    let centre = |_| Point::from(std::array::from_fn(|_| edge * random.random::<f64>()));
    Scene::new((0..radii.len()).map(centre).collect::<Vec<_>>(), Radii::Each(radii.into())).unwrap()
}

/// Returns the radii of 2,000 small particles (dust), with those of giants inserted at random.
fn dusty(giants: &[f64], dust: impl Fn(u32) -> f64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(giants.len() as u64);
    let mut radii: Vec<f64> = (0..2000).map(dust).collect();
    for &giant in giants {
        radii.insert(random.random_range(0..=radii.len()), giant);
    }
    radii
}

fn classes(radii: Vec<f64>, edge: f64) -> Vec<usize> {
    let scene = scene::<3>(radii, edge);
    let particles = any_particles(&scene, Test::Exact).unwrap();
    let Some(classes) = Classes::of(&particles) else { return Vec::new() };
    if classes.all().len() == 1 {
        return Vec::new();
    }
    let mut found = vec![0; classes.all().len()];
    for id in 0..particles.len() as u32 {
        let class = &classes.all()[classes.number(particles.radius(id))];
        assert!(particles.radius(id) <= class.largest);
        assert!(class.is_wide() || 2.0 * particles.radius(id) >= class.largest);
        found[classes.number(particles.radius(id))] += 1;
    }
    assert_eq!(found, classes.all().iter().map(|class| class.particles).collect::<Vec<_>>());
    found
}

#[test]
fn classes_are_those_that_save_work() {
    // Particles of similar size, or too few of them, are not divided into classes.
    assert_eq!(classes(vec![0.5; 2000], 12.0), []);
    assert_eq!(classes((0..2000).map(|k| 0.3 + 0.1 * f64::from(k % 3)).collect(), 12.0), []);
    assert_eq!(classes(dusty(&[9.0], |_| 0.5)[..60].to_vec(), 12.0), []);
    assert_eq!(classes(vec![0.0; 2000], 12.0), []);
    // Radii of 1 and 0.2 form one class if all particles are far apart.
    assert_eq!(classes((0..2000).map(|k| 1.0 - 0.8 * f64::from(k % 2)).collect(), 1e6), []);
    assert_eq!(classes(dusty(&[5.0, 7.0, 6.0], |_| 0.25), 20.0), [3, 2000]);
    assert_eq!(classes(dusty(&[3.0; 30], |_| 0.0), 20.0), [30, 2000]);
    // A class may begin within an octave: 1.0 and 0.55 are in the same one, 0.45 is in the next.
    let similar = |k| if k % 50 == 0 { 0.45 } else { 0.55 };
    assert_eq!(classes(dusty(&[1.0; 30], similar), 12.0), [30, 2000]);
    // One giant does not justify a class of its own if there are twenty large particles.
    let three = |k| if k % 100 == 0 { 1.0 } else { 0.1 };
    assert_eq!(classes(dusty(&[8.0], three), 20.0), [21, 1980]);
}
