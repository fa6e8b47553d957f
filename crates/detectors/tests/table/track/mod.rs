mod boxes;
mod spec;

use contactbench_detectors::oracle;
use contactbench_detectors::tracker::parse;
use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::detect::Options;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::normalise::normalise;
use contactbench_ground::periodic::Searchable;
use contactbench_ground::periodic::{ContactList, Periodic};
use contactbench_ground::scene::{AnyScene, Lattice, Radii};
use contactbench_lists::track::{Step, Tracker};
use contactbench_terms::mix::splitmix64;

/// Random numbers, uniform in [-1, 1), from a counter.
struct Draw(u64);

impl Draw {
    fn symmetric(&mut self) -> f64 {
        self.0 += 1;
        (splitmix64(self.0) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

#[derive(Clone, Copy, Debug)]
enum Motion {
    Flight,
    /// Oscillation about the first position.
    Swing,
    /// A few particles move far, the others rest.
    Few,
}

/// Returns frames of discs or spheres, so dense that each touches a few others.
fn frames<const D: usize>(
    n: usize,
    sizes: bool,
    motion: Motion,
    seed: u64,
) -> Vec<AnyScene<'static>> {
    let mut draw = Draw(seed << 32);
    let edge = 0.6 * (n as f64).powf(1.0 / D as f64);
    let mut points = |size: f64| -> Vec<[f64; D]> {
        (0..n).map(|_| std::array::from_fn(|_| size * draw.symmetric())).collect()
    };
    let (first, velocities) = (points(edge), points(0.07));
    let radii = match sizes {
        true => Radii::Each((0..n).map(|k| 0.1 + 0.4 * (k % 7) as f64 / 6.0).collect()),
        false => Radii::Uniform(0.5),
    };
    let frame = |k: u32| {
        let along = |i: usize, axis: usize| match motion {
            Motion::Flight => f64::from(k) * velocities[i][axis],
            Motion::Swing => f64::from(k % 5) * velocities[(i + k as usize) % n][axis],
            Motion::Few if i.is_multiple_of(9) => f64::from(k) * 3.0 * velocities[i][axis],
            Motion::Few => 0.0,
        };
        let row = |i: usize| std::array::from_fn(|axis| first[i][axis] + along(i, axis));
        AnyScene::at::<D>((0..n).map(row), radii.clone()).unwrap()
    };
    (0..12).map(frame).collect()
}

/// Counts missed and actual contacts, summed over frames. Reported pairs must touch under any rule.
fn missed(
    tracker: &mut dyn Tracker,
    frames: &[AnyScene<'_>],
    arithmetic: Arithmetic,
) -> [usize; 2] {
    let (mut missed, mut all, mut pairs) = (0, 0, Vec::new());
    for frame in frames {
        let Ok(frame) = frame.stored(arithmetic) else { continue };
        let truth = oracle::truth_as_stored(&frame, arithmetic.test(), 1 << 30).unwrap().pairs;
        pairs.clear();
        tracker.step(&frame, arithmetic.test(), None, &mut pairs).unwrap();
        normalise(&mut pairs);
        let errors = oracle::compare(&pairs, &truth, &frame);
        assert_eq!([errors.spurious, errors.duplicate, errors.self_pairs], [0; 3], "{errors}");
        missed += errors.missed as usize;
        all += truth.len();
    }
    [missed, all]
}

fn tracker(text: &str) -> Box<dyn Tracker> {
    parse(text).unwrap().make(Options { memory_limit: 1 << 26, threads: 1 })
}

/// A list contains pairs that a rounded test accepts beyond the sum of the radii, from the first
/// frame on, for any skin.
#[test]
fn a_fresh_list_contains_pairs_that_rounding_accepts() {
    let pair = |x: [f64; 2], r: f64| AnyScene::at(x.map(|x| [x, 0.0]), r).unwrap();
    for (x, r, arithmetic) in [
        ([-1e-9, 1.0], 0.5, Arithmetic::F32),
        ([0.0, 1e-170], 0.0, Arithmetic::F64),
        ([0.0, 1e-25], 0.0, Arithmetic::F32),
        ([0.0, 1e-170], 0.0, Arithmetic::Textbook),
    ] {
        let frames = [pair(x, r), pair(x, r)];
        for rule in ["half-skin", "top-two", "summed"] {
            let text = format!("verlet(direct,skin=0,rule={rule})");
            let found = missed(&mut *tracker(&text), &frames, arithmetic);
            assert_eq!(found, [0, 2], "{text} {x:?} {arithmetic:?}");
        }
        // A list made for the exact test cannot be used for a test that rounds.
        let mut tracker = tracker("verlet(direct,skin=0)");
        let frame = pair(x, r).stored(arithmetic).unwrap();
        let step = |tracker: &mut dyn Tracker, test| {
            let mut pairs = Vec::new();
            (tracker.step(&frame, test, None, &mut pairs).unwrap().built, pairs.len())
        };
        assert_eq!(step(&mut *tracker, Test::Exact), (true, 0), "{x:?}");
        assert_eq!(step(&mut *tracker, arithmetic.test()), (true, 1), "{x:?}");
    }
}

/// Skins and particles that overflow are refused; displacements that overflow exceed any skin.
#[test]
fn numbers_that_overflow_lose_nothing() {
    let frame = |x: f64, r: f64| AnyScene::at([[-x, 0.0], [x, 0.0]], r).unwrap();
    let mut pairs = Vec::new();
    for (skin, r) in [("1e308", 1.0), ("0", f64::MAX), ("0.5", 1e308)] {
        let refused = tracker(&format!("verlet(direct,skin={skin})"))
            .step(&frame(1.7e308, r), Test::Exact, None, &mut pairs)
            .unwrap_err();
        assert!(matches!(refused, Refusal::Skin { .. }), "{refused}");
    }
    let frames = [frame(1.7e308, 1.0), frame(0.0, 1.0), frame(1.7e308, 1.0)];
    for rule in ["half-skin", "top-two", "summed"] {
        let text = format!("verlet(direct,skin=1e300,rule={rule})");
        let found = missed(&mut *tracker(&text), &frames, Arithmetic::Exact);
        assert_eq!(found, [0, 1], "{text}");
    }
}

/// The rules discard the same list in their documented order, and never after the first frame in
/// which an unlisted pair touches.
#[test]
fn the_ladder_of_rules_has_no_exception() {
    let (mut apart, mut equal) = (0, 0);
    for seed in 0..150 {
        let motion = [Motion::Flight, Motion::Swing, Motion::Few][seed as usize % 3];
        let frames = frames::<2>(30, seed % 2 == 0, motion, 100 + seed);
        let given_up = |rule: &str, skin: &str| {
            let mut tracker = tracker(&format!("verlet(nbs,skin={skin},rule={rule})"));
            let mut pairs = Vec::new();
            let mut built =
                |frame| tracker.step(frame, Test::Exact, None, &mut pairs).unwrap().built;
            assert!(built(&frames[0]));
            (1..frames.len()).find(|&k| built(&frames[k])).unwrap_or(frames.len())
        };
        for skin in ["0.6", "1.2"] {
            let mut kept = tracker(&format!("verlet(nbs,skin={skin},rule=every-1000)"));
            let first_miss = (0..frames.len())
                .find(|&k| missed(&mut *kept, &frames[k..=k], Arithmetic::Exact)[0] > 0)
                .unwrap_or(frames.len());
            let [top_two, half_skin, summed] =
                ["top-two", "half-skin", "summed"].map(|rule| given_up(rule, skin));
            assert!(
                first_miss >= top_two && top_two >= half_skin && half_skin >= summed,
                "{seed} {skin}: {first_miss} {top_two} {half_skin} {summed}"
            );
            apart += usize::from(top_two > half_skin || half_skin > summed);
            equal += usize::from(top_two == summed);
        }
    }
    assert!(apart > 50 && equal > 20, "{apart} {equal}");
}

#[test]
fn unsafe_rules_miss_contacts_and_lammps_says_dangerous() {
    let frames = frames::<2>(200, false, Motion::Flight, 5);
    let of = |text: &str| missed(&mut *tracker(text), &frames, Arithmetic::Exact);
    assert_eq!(of("verlet(nbs,skin=0.05,rule=every-1)")[0], 0);
    let [every_6, all] = of("verlet(nbs,skin=0.05,rule=every-6)");
    assert!(every_6 > all / 50, "{every_6} of {all}");
    assert!(of("verlet(nbs,skin=0.05,rule=lammps-5-1-yes)")[0] > 0);
    let mut tracker = tracker("verlet(nbs,skin=0.05,rule=lammps-5-1-yes)");
    let steps: Vec<Step> = frames
        .iter()
        .map(|it| tracker.step(it, Test::Exact, None, &mut Vec::new()).unwrap())
        .collect();
    let built: Vec<usize> = (0..steps.len()).filter(|&k| steps[k].built).collect();
    assert_eq!(built, [0, 5, 10]);
    assert!(steps[5].dangerous && steps[10].dangerous && !steps[0].dangerous);
}

/// 49 discs of diameter 2 on a square lattice with this spacing.
fn grid(apart: f64) -> AnyScene<'static> {
    let at = |k: i32| [k % 7, k / 7].map(|x| apart * f64::from(x));
    AnyScene::at((0..49).map(at), 1.0).unwrap()
}

#[test]
fn changed_particles_or_radii_start_a_new_list() {
    let plane = frames::<2>(60, false, Motion::Few, 1);
    let space = frames::<3>(60, false, Motion::Few, 2);
    let sizes = frames::<2>(60, true, Motion::Few, 1);
    let fewer = frames::<2>(40, false, Motion::Few, 1);
    let mixed: Vec<AnyScene<'_>> = [&plane, &sizes, &plane, &fewer, &space, &fewer, &sizes]
        .into_iter()
        .map(|frames| frames[0].clone())
        .collect();
    for text in ["verlet(nbs,skin=9)", "verlet(kd-tree,skin=9)", "nbs"] {
        assert_eq!(missed(&mut *tracker(text), &mixed, Arithmetic::Exact)[0], 0, "{text}");
    }
    // A particle grows, so it gains contacts without any displacement.
    let grown = |r: f64| AnyScene::at([[0.0, 0.0], [3.0, 0.0]], vec![r, 1.0]).unwrap();
    let [lost, all] = missed(
        &mut *tracker("verlet(nbs,skin=0.1)"),
        &[grown(1.0), grown(2.5), grown(1.0)],
        Arithmetic::Exact,
    );
    assert_eq!([lost, all], [0, 1]);
}

/// After a refusal the pairs are unchanged, and the next frame counts as the first.
#[test]
fn a_refusal_starts_a_new_list() {
    let make =
        |text: &str, memory_limit| parse(text).unwrap().make(Options { memory_limit, threads: 1 });
    let mut pairs = vec![[7, 8]];
    let mut step = |tracker: &mut dyn Tracker, frame: &AnyScene<'_>| {
        let step = tracker.step(frame, Test::Exact, None, &mut pairs);
        assert_eq!(pairs, [[7, 8]]);
        step.map(|step| step.built)
    };
    // Too many contacts are refused; then the particles farther apart start a new list.
    let (near, far) = (grid(0.5), grid(2.5));
    let mut of_few = make("verlet(direct,skin=0)", 3_000);
    assert_eq!(step(&mut *of_few, &far), Ok(true));
    let refused = step(&mut *of_few, &near).unwrap_err();
    assert!(matches!(refused, Refusal::Pairs { .. } | Refusal::Listed { .. }), "{refused}");
    assert_eq!(step(&mut *of_few, &far), Ok(true));
    let listed = step(&mut *make("verlet(direct,skin=9)", 3_000), &far).unwrap_err();
    assert!(listed.to_string().contains("within a skin of"), "{listed}");
    let arrays = step(&mut *make("verlet(direct,skin=0)", 1_000), &far).unwrap_err();
    assert!(matches!(arrays, Refusal::Memory { detector: "verlet", .. }), "{arrays}");
    // A skin that is too large is refused, as are too many pairs.
    let mut huge = tracker("verlet(nbs,skin=1e308)");
    for _ in 0..2 {
        let refused = step(&mut *huge, &far).unwrap_err();
        assert!(refused.to_string().contains("skin"), "{refused}");
    }
    let alone = AnyScene::at([[0.0, 0.0]], 1.0).unwrap();
    for text in ["verlet(direct,skin=9)", "verlet(direct,skin=0)", "direct"] {
        let mut tracker = make(text, 300);
        assert!(step(&mut *tracker, &near).is_err(), "{text}");
        assert_eq!(step(&mut *tracker, &alone), Ok(true), "{text}");
    }
}

#[test]
fn formulas_give_the_bytes_of_the_arrays() {
    let plane = frames::<2>(500, true, Motion::Flight, 1).swap_remove(0);
    let space = frames::<3>(500, true, Motion::Flight, 1).swap_remove(0);
    for (rule, full) in [("top-two", 1), ("summed", 2)] {
        for (frame, dim) in [(&plane, 2), (&space, 3)] {
            let mut tracker = tracker(&format!("verlet(direct,rule={rule},skin=0.6)"));
            assert_eq!(tracker.formula_bytes(), 0);
            let step = tracker.step(frame, Test::Exact, None, &mut Vec::new()).unwrap();
            // Per particle: its position in f64 when the list was built, its position in f32 and
            // its number in the last frame, and two radii.
            let each = 8 * dim * full + 16 + 16;
            assert!(step.listed > 501);
            assert_eq!(tracker.formula_bytes(), 500 * each + 8 * step.listed);
        }
    }
}

/// In a very long box, rounding would list nearly every pair through every image across the box.
#[test]
fn a_box_so_long_that_rounding_exceeds_the_radii_has_no_list() {
    let mut draw = Draw(9);
    let mut place = || 2.17 + 2.17 * draw.symmetric();
    let rows = (0..12).map(|_| [place(), place()]);
    let scene = AnyScene::at(rows, 0.25).unwrap();
    for (length, builds) in [(1e9, 1), (1e14, 3), (4.3e16, 3)] {
        let lattice = Lattice::along_axes([length, 4.34, 0.0], [true, true, false]).unwrap();
        let frame = Periodic::new(scene.clone(), lattice).unwrap();
        let mut truth = oracle::boxes::truth(&frame, Arithmetic::Exact, 1 << 20).unwrap().pairs;
        truth.sort();
        for name in ["verlet(sweep,skin=0.1)", "verlet(streamed-nbs,skin=auto)"] {
            let (mut tracker, mut built) = (tracker(name), 0);
            for _ in 0..3 {
                let mut found = ContactList::default();
                let step =
                    tracker.find(Searchable::Boxed(&frame, Arithmetic::Exact), None, &mut found);
                let step = step.unwrap();
                built += usize::from(step.built);
                assert_eq!(found.sorted(12, 1 << 20).unwrap(), truth, "{length}, {name}");
                assert!(step.listed < 100, "{length}, {name}: {} listed", step.listed);
            }
            assert_eq!(built, builds, "{length}, {name}");
        }
    }
}
