//! Compares every detector with the truth on scenes built from bytes.

use contactbench_detectors::oracle;
use contactbench_detectors::oracle::NoTruth;
use contactbench_detectors::oracle::boxes::Truth;
use contactbench_detectors::oracle::loaded::truth;
use contactbench_detectors::spec::DetectorSpec;
use contactbench_detectors::table::TABLE;
use contactbench_ground::contact::{Arithmetic, exact};
use contactbench_ground::detect::Options;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::scene::{AnyScene, Lattice};
use contactbench_io::Given;
use contactbench_lists::searcher::Searcher;
use contactbench_run::check::answer::{Answer, Expected, answer};
use contactbench_run::check::bytes::{nudged, scene_from_bytes};
use contactbench_run::check::numbers::Numbers;
use contactbench_run::check::{Wrong, as_csv};
use contactbench_terms::must;

/// Low memory limit, so that detectors refuse large arrays, which would slow a fuzzer down.
const OPTIONS: Options = Options { memory_limit: 1 << 22, threads: 1 };

/// Compares every detector with the truth on the scene that the bytes describe, in every
/// arithmetic. Unsafe arithmetics may miss contacts but must not report extra pairs. Panics with
/// the scene if a detector is wrong.
pub fn fuzz_one(data: &[u8]) {
    let Some(scene) = scene_from_bytes(data) else { return };
    the_truth_is_exact(&scene);
    let keep = data[0] & 4 != 0;
    // Scenes for detectors that keep buffers: half of the particles, all, two thirds reversed, all.
    let n = scene.len() as u32;
    let mut scenes = vec![scene];
    if keep {
        let some = scenes[0].reordered(&(0..n / 2).collect::<Vec<_>>());
        let others = scenes[0].reordered(&(n / 3..n).rev().collect::<Vec<_>>());
        scenes = vec![some, scenes[0].clone(), others, scenes[0].clone()];
    }
    let scenes: Vec<Given> = scenes.into_iter().map(Given::from).collect();
    hold(&scenes, keep);
}

/// Like [`fuzz_one`], in a periodic box. The first four bytes choose the periodic vectors, the
/// edges in half diameters (some changed in the last bit), and a tilt in eighths of an edge.
pub fn fuzz_box(data: &[u8]) {
    let Some((&[flags, x, y, z], data)) = data.split_first_chunk() else { return };
    let Some(scene) = scene_from_bytes(data) else { return };
    let diameter = Some(2.0 * scene.largest_radius()).filter(|&d| d.is_normal()).unwrap_or(1.0);
    let edge = |byte: u8| {
        let edge = diameter * 0.5 * f64::from(1 + (byte & 15));
        nudged(edge, i32::from(byte >> 4 & 3) - 1)
    };
    let tilt = |byte: u8| edge(x) * f64::from(i32::from(byte >> 6) - 1) * 0.125;
    let vectors = [[edge(x), 0.0, 0.0], [tilt(y), edge(y), 0.0], [tilt(z), tilt(x), edge(z)]];
    let periodic = [flags & 1 != 0, flags & 2 != 0, flags & 4 != 0];
    let Ok(lattice) = Lattice::new(vectors, periodic, [0.0; 3]) else { return };
    let Ok(given) = Given::in_box(scene, lattice) else { return };
    hold(&[given], false);
}

/// Compares every detector with the truth on each scene; if `keep`, detectors keep their buffers
/// between scenes. In open space, variants (parameters, vector instructions) are compared, too.
fn hold(scenes: &[Given], keep: bool) {
    let fresh = |spec: &DetectorSpec| Searcher::new(spec.make(OPTIONS));
    let entries = TABLE.iter().filter(|entry| entry.must_be_right());
    let open = scenes.iter().all(|given| given.lattice.is_none());
    let mut detectors: Vec<_> = entries
        .flat_map(|entry| if open { DetectorSpec::choices(entry) } else { vec![entry.into()] })
        .map(|spec| {
            let searcher = fresh(&spec);
            (spec, searcher)
        })
        .collect();
    for given in scenes {
        let shown = || match &given.lattice {
            Some(lattice) => format!("{lattice:?}\n{}", as_csv(&given.scene)),
            None => as_csv(&given.scene),
        };
        for arithmetic in Arithmetic::ALL {
            let Ok(stored) = given.loaded(arithmetic) else { continue };
            let truth = truth(&stored, arithmetic, OPTIONS.memory_limit);
            for (spec, searcher) in &mut detectors {
                if !keep {
                    *searcher = fresh(spec);
                }
                let expected = truth.as_ref().map_or(Expected::default(), Expected::from);
                let answer = answer(searcher, &stored, arithmetic, expected);
                let boxed = given.lattice.is_some();
                if let Err(why) = right(spec, arithmetic, answer, &truth, boxed) {
                    panic!("{spec} with {} arithmetic: {why}\n{}", arithmetic.name(), shown());
                }
            }
        }
    }
}

/// Checks an answer; the error states what is wrong. Refusals must be promised, and a detector must
/// not report pairs if the truth is unknown, as when a square overflows.
fn right(
    spec: &DetectorSpec,
    arithmetic: Arithmetic,
    answer: Answer,
    truth: &Result<Truth, NoTruth>,
    boxed: bool,
) -> Result<(), String> {
    if let (Answer::Refused(refusal, _), Ok(_)) = (&answer, truth) {
        let promised = match refusal {
            Refusal::Domain { .. } | Refusal::Extent { .. } | Refusal::Memory { .. } => {
                spec.entry.memory != "0"
            }
            // In a box, detectors may refuse images that the truth does not need.
            Refusal::Images { .. } | Refusal::Away { .. } | Refusal::Range => boxed,
            _ => false,
        };
        must!(promised, "it refuses: {refusal}");
    }
    match (answer, truth) {
        (answer, Ok(truth)) => {
            let wrong = answer.wrong(truth);
            match wrong.filter(|wrong| arithmetic.is_safe() || !only_loses(wrong)) {
                None => Ok(()),
                Some(wrong) => Err(wrong.to_string()),
            }
        }
        (Answer::Refused(_, 0) | Answer::Refused(Refusal::Pairs { .. }, _), Err(_)) => Ok(()),
        (
            Answer::Right | Answer::Pairs(_),
            Err(NoTruth::Refused(Refusal::Away { .. } | Refusal::Pairs { .. })),
        ) if boxed => Ok(()),
        (_, Err(error)) => Err(format!("it answers, but {error}")),
    }
}

fn only_loses(wrong: &Wrong) -> bool {
    let Wrong::Pairs(pairs) = wrong else { return false };
    pairs.spurious.is_empty() && pairs.selves.is_empty() && pairs.duplicate.is_empty()
}

/// Checks the contact test of the truth against integer arithmetic.
fn the_truth_is_exact(scene: &AnyScene<'static>) {
    let Ok(truth) = oracle::truth(scene, Arithmetic::Exact) else {
        panic!("exact arithmetic refuses:\n{}", as_csv(scene))
    };
    let numbers = Numbers::new(scene);
    let particles: Vec<([f64; 3], f64)> = numbers
        .values
        .chunks_exact(numbers.stride())
        .map(|particle| {
            (
                std::array::from_fn(|k| if k < numbers.dim { particle[k] } else { 0.0 }),
                particle[numbers.dim],
            )
        })
        .collect();
    let all = (0..particles.len()).flat_map(|i| (i + 1..particles.len()).map(move |j| (i, j)));
    let touching = all.filter(|&(i, j)| {
        exact::compare(&particles[i].0, &particles[j].0, particles[i].1, particles[j].1).is_le()
    });
    let pairs: Vec<[u32; 2]> = touching.map(|(i, j)| [i as u32, j as u32]).collect();
    assert!(pairs == truth.pairs, "the filter of the exact test is wrong on\n{}", as_csv(scene));
}
