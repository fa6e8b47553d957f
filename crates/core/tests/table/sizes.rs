//! Tests of the detectors that divide particles by size, on scenes with many size distributions.

use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::{Options, table};
use contactbench_core::oracle;
use contactbench_core::scene::{AnyScene, Radii, Scene};
use contactbench_core::sink::Digest;
use nalgebra::Point;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Returns particles at random positions in a square or cube with this edge.
pub fn scene<const D: usize>(radii: Vec<f64>, edge: f64, seed: u64) -> AnyScene<'static>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let centre = |_| Point::from(std::array::from_fn(|_| edge * random.random::<f64>()));
    let centres: Vec<Point<f64, D>> = (0..radii.len()).map(centre).collect();
    Scene::new(centres, Radii::Each(radii.into())).unwrap().into()
}

/// Returns size distributions that could break size classes, with names.
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

/// Edges of the box, with which nearly all, some, or few strips of cells have neighbours.
const EDGES: [f64; 3] = [20.0, 150.0, 20_000.0];

fn specs() -> Vec<String> {
    let ratios = table::find("hgrid").unwrap().parameters[0].values;
    let hgrid = ratios.iter().map(|ratio| format!("hgrid:ratio={ratio}"));
    let levels = ["optimal", "0.1/0.25/1/40", "1e-310/1e300"];
    let hgrid = hgrid.chain(levels.map(|levels| format!("hgrid:levels={levels}")));
    let streamed =
        ["form=auto", "form=dense", "form=flat", "form=sparse", "form=dense,level=portable"];
    let nbs = std::iter::once("nbs:levels=auto".to_string());
    hgrid.chain(nbs).chain(streamed.map(|form| format!("streamed-nbs:{form}"))).collect()
}

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
                    for spec in specs() {
                        let spec = table::parse(&spec).unwrap();
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
