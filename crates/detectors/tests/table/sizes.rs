//! Tests of the detectors that divide particles by size, on scenes with many size distributions.

use contactbench_detectors::oracle;
use contactbench_detectors::table;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::scene::AnyScene;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Returns particles at random positions in a square or cube with this edge.
pub fn scene<const D: usize>(radii: Vec<f64>, edge: f64, seed: u64) -> AnyScene<'static> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let centre = |_| std::array::from_fn(|_| edge * random.random::<f64>());
    AnyScene::at::<D>((0..radii.len()).map(centre), radii).unwrap()
}

/// Returns size distributions that could break size classes, with names.
fn radii() -> Vec<(&'static str, Vec<f64>)> {
    let with = |radius: fn(u32) -> f64| (0..300).map(radius).collect::<Vec<f64>>();
    vec![
        ("one size", with(|_| 0.5)),
        ("a power law over a ratio of 300", with(|k| 300.0 / (f64::from(k) + 1.0))),
        ("exactly at the borders", with(|k| 64.0 / f64::from(1 << (k % 12)))),
        ("a last bit around them", {
            let border = |k: u32| 64.0 / f64::from(1 << (k / 3 % 12));
            let radius = |k: u32| match k % 3 {
                0 => border(k),
                1 => border(k).next_up(),
                _ => border(k).next_down(),
            };
            (0..300).map(radius).collect()
        }),
        ("giants in dust", with(|k| if k % 100 == 7 { 40.0 } else { 0.25 })),
        ("giants in points", with(|k| if k % 100 == 7 { 40.0 } else { 0.0 })),
        ("points", with(|_| 0.0)),
        ("more levels than there are", with(|k| 50.0 * 0.8_f64.powi(k as i32))),
        ("subnormal beside giants", with(|k| if k == 3 { 60.0 } else { 1e-310 })),
    ]
}

/// Edges of the box, with which nearly all, some, or few strips of cells have neighbours.
const EDGES: [f64; 3] = [20.0, 150.0, 20_000.0];

pub const FORMS: [&str; 5] =
    ["form=auto", "form=dense", "form=flat", "form=sparse", "form=dense,level=portable"];

fn specs() -> Vec<(String, usize)> {
    let ratios = table::find("hgrid").unwrap().parameters[0].values;
    let hgrid = ratios.iter().map(|ratio| format!("hgrid:ratio={ratio}"));
    let streamed = FORMS.map(|form| format!("streamed-nbs:{form}"));
    hgrid.chain(streamed).map(|spec| (spec, 1)).collect()
}

/// Compares the answers of detectors, each with a number of threads, with the truth in every safe
/// arithmetic. Returns the numbers of contacts and answers, and of refusals of the extent.
pub fn compared(scene: &AnyScene<'_>, specs: &[(String, usize)], what: &str) -> [u64; 3] {
    let mut seen = [0; 3];
    for arithmetic in Arithmetic::SAFE {
        let Ok(truth) = oracle::truth(scene, arithmetic) else { continue };
        let stored = scene.stored(arithmetic).unwrap();
        for (spec, threads) in specs {
            let what = format!("{what}, {spec}, {}D, {arithmetic:?}", scene.dim());
            let options = Options { threads: *threads, ..Options::default() };
            let (mut detector, mut pairs) = (table::parse(spec).unwrap().make(options), Vec::new());
            match detector.list(&stored, arithmetic.test(), &mut pairs) {
                Ok(()) => {
                    let found = Digest::from_pairs(&pairs);
                    assert_eq!(found, truth.digest, "{what}");
                    (seen[0], seen[1]) = (seen[0] + found.contacts, seen[1] + 1);
                }
                Err(Refusal::Extent { .. } | Refusal::Domain { .. }) => seen[2] += 1,
                Err(refusal) => panic!("{what}: {refusal}"),
            }
        }
    }
    seen
}

#[test]
fn levels_lose_nothing() {
    let mut seen = [0; 3];
    for (k, (name, radii)) in radii().into_iter().enumerate() {
        for edge in EDGES {
            let scenes = [
                scene::<2>(radii.clone(), edge, k as u64),
                scene::<3>(radii.clone(), edge, k as u64),
            ];
            for scene in scenes {
                let found = compared(&scene, &specs(), &format!("{name}, edge {edge}"));
                (0..3).for_each(|k| seen[k] += found[k]);
            }
        }
    }
    assert!(seen[0] > 300_000 && seen[1] > 1500 && seen[2] == 0, "{seen:?}");
}
