//! Compares the model of the work with the published model and with counts.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::contact::{Test, any_bodies};
use crate::detect::modern::hgrid::levels::Levels;
use crate::detect::modern::hgrid::{Borders, HGrid, Parting};
use crate::detect::{Detector, Options};
use crate::probe::{Op, Tally};
use crate::scene::Scene;
use crate::sink::Digest;

/// Returns `n` radii up to 1 as quantiles of a power law: number density r^exponent, such as r^-3.
fn power(n: u32, ratio: f64, exponent: f64) -> Vec<f64> {
    let power = exponent + 1.0;
    let least = ratio.powf(-power);
    let quantile = |k| {
        let part = f64::from(k) / f64::from(n - 1);
        (1.0 + part * (least - 1.0)).powf(1.0 / power)
    };
    (0..n).map(quantile).collect()
}

fn filled<const D: usize>(radii: Vec<f64>, fraction: f64, seed: u64) -> Scene<'static, f64, D> {
    let ball = if D == 2 { std::f64::consts::PI } else { std::f64::consts::PI * 4.0 / 3.0 };
    let volume: f64 = radii.iter().map(|r| ball * r.powi(D as i32)).sum();
    let edge = (volume / fraction).powf(1.0 / D as f64);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let centre = |_| std::array::from_fn(|_| edge * random.random::<f64>());
    Scene::at((0..radii.len()).map(centre), radii).unwrap()
}

/// Returns the counted work of `hgrid`, and the modelled work for its levels.
fn both<const D: usize>(scene: &Scene<'_, f64, D>, parting: &Parting) -> [Work; 2] {
    let (mut tally, mut digest) = (Tally::default(), Digest::default());
    let mut hgrid = HGrid::<D>::with_levels(parting.clone(), Options::default());
    let bodies = any_bodies(scene, Test::Exact).unwrap();
    hgrid.detect(bodies, &mut tally, &mut digest).unwrap();
    let counted =
        Work { tests: tally.get(Op::ContactTest) as f64, looks: tally.get(Op::LevelProbe) as f64 };
    let levels = Levels::new(&bodies, parting).unwrap();
    let mut modelled = Work::default();
    let full = || levels.all().iter().enumerate().filter(|(_, level)| level.class.bodies > 0);
    for (number, level) in full() {
        modelled.tests += level.class.beside().tests;
        for id in 0..bodies.len() as u32 {
            let larger = levels.class(bodies.radius(id));
            if larger < number {
                let larger = &levels.all()[larger].class;
                let work = level.class.visits(larger, 1.0, bodies.radius(id));
                modelled.tests += work.tests;
                modelled.looks += work.looks;
            }
        }
    }
    [counted, modelled]
}

/// Far from the walls the model equals the published one (doi:10.1007/s40571-014-0020-9, appendix
/// 1): tests in half of 3^D cells within a level, and in (2r/h + 2)^D cells of a finer one.
#[test]
fn in_a_wide_box_the_model_is_the_published_one() {
    fn check<const D: usize>() {
        let power = |x: f64| x.powi(D as i32);
        let class = |largest: f64| Class::<D> {
            low: [0.0; D],
            high: [40_000.0 * largest; D],
            largest,
            bodies: power(2000.0 / 3.0) as usize * 30usize.pow(D as u32),
            sum: 0.0,
        };
        for largest in [1.0, 0.3] {
            let class = class(largest);
            let (edge, n) = (2.0 * largest, class.bodies as f64);
            let each = n / power(40_000.0 * largest / edge);
            let found = class.beside().tests / n;
            let published = 0.5 * power(3.0) * each;
            assert!((found / published - 1.0).abs() < 1e-3, "{found} {published}");
            for radius in [1.1, 3.0, 7.7, 40.0] {
                let (found, cells) = (class.visits(&class, 1.0, radius), 2.0 * radius / edge + 2.0);
                assert!((found.tests / (each * power(cells)) - 1.0).abs() < 0.02, "{found:?}");
                let strips = (cells - 1.0) / 8.0 + 1.0;
                let looks = strips * cells.powi(D as i32 - 1);
                assert!((found.looks / looks - 1.0).abs() < 0.02, "{found:?} {looks}");
            }
        }
    }
    check::<2>();
    check::<3>();
}

/// Counted and modelled work agree within 5% for all size ratios, packings, exponents and levels.
#[test]
fn counted_work_is_as_modelled() {
    fn check<const D: usize>() -> f64 {
        let borders = Borders::parse("0.05/0.2/0.7").unwrap();
        let ratio = |ratio| Parting::Ratio(Some(ratio));
        let partings = [
            Parting::Ratio(None),
            ratio(1.25),
            ratio(2.0),
            ratio(4.0),
            Parting::Borders(borders),
            Parting::Optimal,
        ];
        let mut worst = 0.0_f64;
        for size in [1.0, 2.0, 10.0, 50.0, 300.0] {
            for (fraction, exponent) in
                [0.1, 0.8].into_iter().flat_map(|f| [-2.0, -4.0].map(|e| (f, e)))
            {
                // Four scenes are averaged: much depends on the positions of a few large particles.
                let scene = |seed| filled::<D>(power(3000, size, exponent), fraction, seed);
                let scenes = [1, 2, 3, 4].map(scene);
                for parting in &partings {
                    let (mut counted, mut modelled) = (0.0, 0.0);
                    for scene in &scenes {
                        let [a, b] = both(scene, parting).map(Work::all);
                        counted += a;
                        modelled += b;
                    }
                    worst = worst.max((counted / modelled - 1.0).abs());
                }
            }
        }
        worst
    }
    let worst = [check::<2>(), check::<3>()];
    assert!(worst.iter().all(|&off| off < 0.05), "{worst:?}");
}

#[test]
fn the_optimum_is_no_worse_than_any_ratio() {
    fn check<const D: usize>() {
        let giants = |n: u32| (0..n).map(|k| if k % 500 == 0 { 1.0 } else { 0.02 }).collect();
        let scenes = [
            power(3000, 2.0, -3.0),
            power(3000, 10.0, -3.0),
            power(3000, 10.0, -4.0),
            power(3000, 100.0, -2.0),
            power(3000, 100.0, -4.0),
            giants(3000),
        ];
        for (seed, radii) in (1..).zip(scenes) {
            let scene = filled::<D>(radii, 0.5, seed);
            let [optimal, _] = both(&scene, &Parting::Optimal).map(Work::all);
            for ratio in [None, Some(1.25), Some(1.6), Some(2.0), Some(2.5), Some(4.0), Some(8.0)] {
                let [other, _] = both(&scene, &Parting::Ratio(ratio)).map(Work::all);
                assert!(optimal < 1.03 * other, "{D}D, {seed}, {ratio:?}: {optimal}, not {other}");
            }
        }
    }
    check::<2>();
    check::<3>();
}
