use nalgebra::Point;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::contact::{Arithmetic, Test};
use crate::detect::table;
use crate::oracle;
use crate::probe::Tally;
use crate::scene::{AnyScene, Radii, Scene};
use crate::sink::Digest;

/// Particles at random in a box with this edge.
fn scene<const D: usize>(radii: Vec<f64>, edge: f64, seed: u64) -> AnyScene<'static>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let centre = |_| Point::from(std::array::from_fn(|_| edge * random.random::<f64>()));
    let centres: Vec<Point<f64, D>> = (0..radii.len()).map(centre).collect();
    Scene::new(centres, Radii::Each(radii.into())).unwrap().into()
}

/// Radii of every kind that levels could stumble over.
fn radii() -> Vec<(&'static str, Vec<f64>)> {
    let with = |radius: fn(u32) -> f64| (0..600).map(radius).collect::<Vec<f64>>();
    vec![
        ("one size", with(|_| 0.5)),
        ("a power law over a ratio of 600", with(|k| 300.0 / (f64::from(k) + 1.0))),
        ("exactly at the borders", with(|k| 64.0 / f64::from(1 << (k % 12)))),
        ("a last bit around them", {
            let border = |k: u32| 64.0 / f64::from(1 << (k / 3 % 12));
            let radius = |k: u32| match k % 3 {
                0 => border(k),
                1 => border(k).next_up(),
                _ => border(k).next_down(),
            };
            (0..600).map(radius).collect()
        }),
        ("giants in dust", with(|k| if k % 200 == 7 { 40.0 } else { 0.25 })),
        ("giants in points", with(|k| if k % 200 == 7 { 40.0 } else { 0.0 })),
        ("points", with(|_| 0.0)),
        ("more levels than there are", with(|k| 50.0 * 0.8_f64.powi(k as i32))),
        ("subnormal beside giants", with(|k| if k == 3 { 60.0 } else { 1e-310 })),
    ]
}

/// Few enough cells that nearly every strip has neighbours, and so many that most have none.
const EDGES: [f64; 3] = [20.0, 150.0, 20_000.0];

#[test]
fn levels_lose_nothing() {
    let (mut contacts, mut answers) = (0, 0);
    for (k, (name, radii)) in radii().into_iter().enumerate() {
        for edge in EDGES {
            let scenes = [
                scene::<2>(radii.clone(), edge, k as u64),
                scene::<3>(radii.clone(), edge, k as u64),
            ];
            for scene in scenes {
                for arithmetic in Arithmetic::SAFE {
                    let Ok(truth) = oracle::truth(&scene, arithmetic) else { continue };
                    let stored = scene.stored(arithmetic).unwrap();
                    for ratio in table::find("hgrid").unwrap().parameters[0].values {
                        let spec = table::parse(&format!("hgrid:ratio={ratio}")).unwrap();
                        let mut digest = Digest::default();
                        let mut detector = spec.make(Options::default());
                        detector.visit(&stored, arithmetic.test(), &mut digest).unwrap();
                        assert_eq!(
                            digest,
                            truth.digest,
                            "{name}, edge {edge}, {spec}, {}D, {arithmetic:?}",
                            scene.dim()
                        );
                        contacts += digest.contacts;
                        answers += 1;
                    }
                }
            }
        }
    }
    assert!(contacts > 1_000_000 && answers > 1500, "{contacts} {answers}");
}

fn count(detector: &str, scene: &AnyScene<'_>) -> Tally {
    let mut tally = Tally::default();
    let mut detector = table::parse(detector).unwrap().make(Options::default());
    detector.count(scene, Test::Exact, &mut tally, &mut Digest::default()).unwrap();
    tally
}

/// One size is one level, with the cells and the half of the neighbours of `cell-grid`; and all
/// sizes in one level have the same cells.
#[test]
fn one_level_tests_what_the_cell_grid_tests() {
    let equal = scene::<3>(vec![0.5; 3000], 12.0, 1);
    let mixed = scene::<2>((0..3000).map(|k| 0.1 + 0.4 * f64::from(k % 7)).collect(), 90.0, 2);
    for (scene, detector) in
        [(&equal, "hgrid"), (&equal, "hgrid:ratio=8"), (&mixed, "hgrid:ratio=one-level")]
    {
        let (one, grid) = (count(detector, scene), count("cell-grid", scene));
        assert_eq!(one.get(Op::ContactTest), grid.get(Op::ContactTest), "{detector}");
        assert_eq!(one.get(Op::LevelProbe), 0, "{detector}");
    }
    let levels = count("hgrid", &mixed);
    assert!(
        levels.get(Op::ContactTest) < count("cell-grid", &mixed).get(Op::ContactTest)
            && levels.get(Op::LevelProbe) > 0
    );
}

/// A giant is tested against the dust around it, and against all dust where that is less than to
/// look at the cells; the dust never against the giant's cells.
#[test]
fn a_giant_costs_what_is_around_it() {
    let dust = 4000;
    let edge = 10.0;
    let with = |giant: Option<f64>| {
        let radii = (0..dust).map(|_| 0.25).chain(giant).collect();
        count("hgrid", &scene::<3>(radii, edge, 5)).get(Op::ContactTest)
    };
    let without = with(None);
    for giant in [1.5, 2.5, 10.0, 250.0] {
        let more = with(Some(giant)) - without;
        // As many as are in the box around it, a cell wider on each side.
        let around = (2.0 * (giant + 4.0 * 0.25) / edge).min(1.0).powi(3) * f64::from(dust);
        assert!(more as f64 <= 1.3 * around + 30.0, "{giant}: {more}, of {around}");
    }
}

/// Two parts of the dust as far apart as can be: the strips that are there take room, the domain
/// does not.
#[test]
fn memory_is_of_bodies_not_of_cells() {
    let mut radii = vec![0.25; 1000];
    radii.push(250.0);
    let near = scene::<3>(radii.clone(), 60.0, 3);
    let far = scene::<3>(radii, 60_000.0, 3);
    let bytes = |scene: &AnyScene<'_>| {
        let mut detector = table::parse("hgrid").unwrap().make(Options::default());
        detector.visit(scene, Test::Exact, &mut Digest::default()).unwrap();
        detector.formula_bytes()
    };
    // 2048 slots and 2, a place and a record each; a strip each at most.
    let least = 4 * (2050 + 1001) + 32 * 1001;
    for scene in [near, far] {
        let found = bytes(&scene);
        assert!((least + 48..=least + 48 * 1001).contains(&found), "{found}");
    }
}
