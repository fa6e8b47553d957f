use nalgebra::Point;

use super::*;
use crate::contact::Arithmetic;
use crate::oracle;
use crate::scene::{Radii, Scene};
use crate::sink::normalise;
use crate::track::parse;
use crate::track::tests::{Draw, Motion, frames, grid, missed, tracker};

const ALL: [&str; 6] = [
    "incremental(sweep)",
    "incremental(nbs)",
    "incremental(screening)",
    "incremental(bvh)",
    "incremental(bvh,margin=0)",
    "incremental(bvh,margin=1e308)",
];

fn discs(centres: Vec<[f64; 2]>, radii: Radii<'static, f64>) -> AnyScene<'static> {
    let centres: Vec<_> = centres.into_iter().map(Point::from).collect();
    Scene::new(centres, radii).unwrap().into()
}

#[test]
fn nothing_is_missed_in_any_arithmetic() {
    let mut all = 0;
    for seed in 0..3 {
        for motion in [Motion::Flight, Motion::Swing, Motion::Few] {
            for sizes in [false, true] {
                let scenes = [
                    frames::<2>(70, sizes, motion, 20 + seed),
                    frames::<3>(70, sizes, motion, 30 + seed),
                ];
                for arithmetic in Arithmetic::ALL {
                    for text in ALL {
                        for frames in &scenes {
                            let found = missed(&mut *tracker(text), frames, arithmetic);
                            assert_eq!(found[0], 0, "{text} {motion:?} {arithmetic:?}");
                            all += found[1];
                        }
                    }
                }
            }
        }
    }
    assert!(all > 500_000, "{all}");
}

/// Points whose distances vanish when they are squared touch, and are cells apart.
#[test]
fn the_textbooks_reach_is_not_taken() {
    let at = |k: i32| [1e-164 * f64::from(k), 0.5e-164 * f64::from(k % 10)];
    let frames = vec![discs((0..100).map(at).collect(), Radii::Uniform(1e-166)); 2];
    for text in ALL.into_iter().chain(["verlet(nbs,skin=auto)"]) {
        assert_eq!(missed(&mut *tracker(text), &frames, Arithmetic::Textbook)[0], 0, "{text}");
    }
    assert!(missed(&mut *tracker("nbs"), &frames, Arithmetic::Textbook)[0] > 0);
}

/// Walks on which bodies change places and cells hundreds of times, and leave the grid.
#[test]
fn long_walks_are_followed() {
    fn walk<const D: usize>(seed: u64) -> Vec<AnyScene<'static>>
    where
        AnyScene<'static>: From<Scene<'static, f64, D>>,
    {
        let (mut draw, n) = (Draw(seed << 32), 1 + (seed as usize * 7) % 40);
        let edge = 0.7 * (n as f64).powf(1.0 / D as f64);
        let mut at: Vec<[f64; D]> =
            (0..n).map(|_| std::array::from_fn(|_| edge * draw.symmetric())).collect();
        let step = [0.02, 0.2, 1.0][seed as usize % 3];
        (0..60)
            .map(|_| {
                at.iter_mut().flatten().for_each(|x| *x += step * draw.symmetric());
                let centres: Vec<Point<f64, D>> = at.iter().map(|&x| Point::from(x)).collect();
                Scene::new(centres, Radii::Uniform(0.5)).unwrap().into()
            })
            .collect()
    }
    for seed in 0..40 {
        for frames in [walk::<2>(seed), walk::<3>(seed)] {
            for text in &ALL[..5] {
                let lost = missed(&mut *tracker(text), &frames, Arithmetic::Exact)[0];
                assert_eq!(lost, 0, "{text} {seed}");
            }
        }
    }
}

/// Frames that have nothing to do with one another: other order, number, radii, dimension, storage
/// and test, numbers at the ends of the range, and refusals and `forget` in between.
#[test]
fn whatever_the_frame_before_was_the_next_is_complete() {
    let (one, each) = (Radii::Uniform, |radii: Vec<f64>| Radii::Each(radii.into()));
    let plane = frames::<2>(60, false, Motion::Flight, 1);
    let mut mixed = vec![
        discs(vec![], one(1.0)),
        discs(vec![], each(vec![])),
        discs(vec![[3.0, 4.0]], one(1.0)),
        discs(vec![[3.0, 4.0]; 50], one(0.0)),
        discs(vec![[-1e300, 1e300]; 50], one(1e-300)),
        discs((0..50).map(|k| [1e300 * f64::from(k % 7), 1e-300]).collect(), one(5e299)),
        discs((0..50).map(|k| [1e-300 * f64::from(k % 7), 0.0]).collect(), one(5e-301)),
        discs(vec![[f64::MAX, 0.0], [-f64::MAX, 0.0], [0.0, 1.0]], one(f64::MAX)),
        discs(vec![[f64::MAX, 0.0], [0.0, 0.0]], each(vec![f64::MAX, 0.0])),
        discs(vec![[0.0, 0.0], [0.0, 5e-324]], each(vec![5e-324, 0.0])),
        discs(vec![[0.0, 0.0], [4e9, 0.0]], one(0.5)),
        plane[0].clone(),
        plane[11].clone(),
        plane[3].reordered(&(0..60).rev().collect::<Vec<u32>>()),
        frames::<2>(60, true, Motion::Flight, 1)[0].clone(),
        frames::<2>(60, true, Motion::Flight, 9)[5].clone(),
        frames::<2>(41, false, Motion::Flight, 1)[0].clone(),
        frames::<3>(60, false, Motion::Flight, 1)[0].clone(),
        frames::<3>(60, true, Motion::Flight, 2)[0].clone(),
    ];
    // A body that grows, where it is.
    for r in [1.0, 2.5, 1.0] {
        mixed.push(discs(vec![[0.0, 0.0], [3.0, 0.0]], each(vec![r, 1.0])));
    }
    let mut draw = Draw(5);
    let mut chosen = |n: usize| (draw.symmetric().abs() * n as f64) as usize;
    let (mut refused, mut found) = (0, 0);
    for text in ALL {
        let mut carried = tracker(text);
        let every = text.strip_prefix("incremental(").unwrap().split([',', ')']).next().unwrap();
        for _ in 0..1500 {
            let arithmetic = Arithmetic::SAFE[chosen(4)];
            let Ok(frame) = mixed[chosen(mixed.len())].stored(arithmetic) else { continue };
            if chosen(20) == 0 {
                carried.forget();
            }
            let asked = |tracker: &mut dyn Tracker| {
                let mut pairs = vec![[7, 8]];
                let step = tracker.step(&frame, arithmetic.test(), None, &mut pairs);
                assert_eq!(pairs[0], [7, 8], "{text}");
                pairs.remove(0);
                normalise(&mut pairs);
                assert!(step.is_ok() || pairs.is_empty(), "{text}");
                step.map(|_| pairs)
            };
            match (asked(&mut *carried), asked(&mut *tracker(every))) {
                (Ok(pairs), Ok(expected)) => {
                    assert_eq!(pairs, expected, "{text} in {arithmetic:?}: {frame:?}");
                    found += pairs.len();
                }
                (Err(a), Err(b)) => {
                    assert_eq!(std::mem::discriminant(&a), std::mem::discriminant(&b));
                    refused += 1;
                }
                (a, b) => panic!("{text}: {a:?} {b:?}"),
            }
        }
    }
    assert!(refused > 300 && found > 100_000, "{refused} {found}");
}

fn counted(tracker: &mut dyn Tracker, frame: &AnyScene<'_>) -> (Step, Tally) {
    let (mut tally, mut pairs) = (Tally::default(), Vec::new());
    let step = tracker.step(frame, Test::Exact, Some(&mut tally), &mut pairs).unwrap();
    normalise(&mut pairs);
    assert_eq!(pairs, oracle::truth(frame, Arithmetic::Exact).unwrap().pairs);
    (step, tally)
}

/// Bodies at rest cost the search alone, and one that goes costs what it has left.
#[test]
fn what_is_mended_is_what_has_changed() {
    // Two diameters apart in y, so that one body moves a cell without meeting others.
    let lattice = |first: [f64; 2]| {
        let at = |k: usize| if k == 0 { first } else { [(k % 20) as f64, (k / 20) as f64 * 2.0] };
        discs((0..400).map(at).collect(), Radii::Uniform(0.5))
    };
    let (home, away) = (lattice([0.0, 0.0]), lattice([10.5, 1.0]));
    for (text, op, least, most) in [
        ("incremental(sweep)", Op::Swap, 1, 19),
        ("incremental(nbs)", Op::Reinsert, 1, 1),
        ("incremental(screening)", Op::Reinsert, 1, 1),
        ("incremental(bvh)", Op::Refit, 1, 6),
    ] {
        let mut tracker = tracker(text);
        let (built, _) = counted(&mut *tracker, &home);
        assert!(built.built, "{text}");
        let (still, tally) = counted(&mut *tracker, &home);
        assert!(!still.built && still.building.is_zero(), "{text}");
        assert_eq!((tally.get(op), tally.get(Op::Move)), (0, 0), "{text}");
        // With and without a tally the same is said.
        let step = tracker.step(&home, Test::Exact, None, &mut Vec::new()).unwrap();
        assert_eq!(step, still, "{text}");
        assert_eq!(step.listed, tally.get(Op::ContactTest), "{text}");
        let (_, tally) = counted(&mut *tracker, &away);
        assert!((least..=most).contains(&tally.get(op)), "{text}: {}", tally.get(op));
        let cells = text == "incremental(screening)";
        assert!(!cells || tally.get(Op::ListPush) == 1, "{text}");
        tracker.forget();
        assert!(counted(&mut *tracker, &away).0.built, "{text}");
    }
}

/// A frame without any order costs no more than about twice what it does without a frame before.
#[test]
fn disorder_is_given_up_in_time() {
    let (n, mut draw) = (900u32, Draw(17));
    let mut scattered = || {
        let at = |_| [24.0 * draw.symmetric(), 20.0 * draw.symmetric()];
        discs((0..n).map(at).collect(), Radii::Uniform(0.5))
    };
    let scenes: Vec<_> = (0..6).map(|_| scattered()).collect();
    let work = |tally: &Tally| tally.iter().map(|(_, count)| count).sum::<u64>();
    for text in ALL {
        let mut carried = tracker(text);
        for scene in &scenes {
            let (_, afresh) = counted(&mut *tracker(text), scene);
            let (step, tally) = counted(&mut *carried, scene);
            let (cost, most) = (work(&tally), 5 * work(&afresh) / 2);
            assert!(cost <= most, "{text}: {cost}, at most {most}");
            let grid = ["incremental(nbs)", "incremental(screening)"].contains(&text);
            assert!(step.built || grid || text.ends_with("e308)"), "{text}");
            assert!(tally.get(Op::Swap) <= sorting(n as usize) + u64::from(n));
        }
    }
    assert_eq!([0, 1, 2, 3, 8, 9].map(sorting), [0, 0, 2, 6, 24, 36]);
}

/// The axis of the sweep stays until another is more than twice as long.
#[test]
fn the_axis_of_the_sweep_is_kept_while_it_is_good() {
    let wide = |x: f64, y: f64| {
        let at = |k: i32| [x * f64::from(k % 20), y * f64::from(k / 20)];
        discs((0..400).map(at).collect(), Radii::Uniform(0.5))
    };
    let mut tracker = tracker("incremental(sweep)");
    let steps = [(1.2, 1.0), (1.0, 1.2), (1.0, 1.99), (1.0, 2.01), (1.2, 1.0)]
        .map(|(x, y)| counted(&mut *tracker, &wide(x, y)).0);
    assert_eq!(steps.map(|step| step.built), [true, false, false, true, false]);
    // Whichever is the first axis, the second is another: few overlap along both.
    assert!(steps.iter().all(|step| step.listed < 4 * 400), "{steps:?}");
}

/// The grid serves until a body leaves the spare cell around it, and only bodies of its reach.
#[test]
fn the_grid_is_kept_while_bodies_are_in_it() {
    let row = |shift: f64, r: f64| {
        let at = |k: i32| [f64::from(k), shift + f64::from(k % 3)];
        discs((0..30).map(at).collect(), Radii::Uniform(r))
    };
    for text in &ALL[1..3] {
        let mut tracker = tracker(text);
        let built: Vec<bool> =
            [(0.0, 0.5), (0.9, 0.5), (-0.9, 0.5), (1.1, 0.5), (1.1, 0.25), (1.1, 0.25)]
                .map(|(shift, r)| counted(&mut *tracker, &row(shift, r)).0.built)
                .into();
        assert_eq!(built, [true, false, false, true, true, false], "{text}");
    }
}

/// Bodies that mix make the boxes larger: the tree is built anew when that has cost as much, and
/// the searches do not become ever dearer.
#[test]
fn a_tree_that_has_become_bad_is_built_anew() {
    let frames = |speed: f64| {
        let mut draw = Draw(3);
        let mut at: Vec<[f64; 2]> =
            (0..600).map(|_| std::array::from_fn(|_| 16.0 * draw.symmetric())).collect();
        let go: Vec<[f64; 2]> =
            (0..600).map(|_| std::array::from_fn(|_| speed * draw.symmetric())).collect();
        (0..80)
            .map(|_| {
                for (at, go) in at.iter_mut().zip(&go) {
                    (0..2).for_each(|k| at[k] = (at[k] + go[k]).clamp(-16.0, 16.0));
                }
                discs(at.clone(), Radii::Uniform(0.5))
            })
            .collect::<Vec<_>>()
    };
    let builds = |speed: f64| {
        let mut tracker = tracker("incremental(bvh)");
        let steps: Vec<_> = frames(speed).iter().map(|it| counted(&mut *tracker, it)).collect();
        let visits = |k: usize| steps[k].1.get(Op::NodeVisit) + steps[k].1.get(Op::BoundTest);
        let dearest = (0..80).map(visits).max().unwrap();
        assert!(dearest < 4 * visits(0), "{speed}: {dearest}, {}", visits(0));
        steps.iter().filter(|(step, _)| step.built).count()
    };
    let [slow, fast] = [0.02, 0.2].map(builds);
    assert!((2..10).contains(&slow) && slow < fast && fast < 40, "{slow} {fast}");
}

/// What does not fit the limit is refused before it is taken, and spare cells are left out first.
#[test]
fn limits_hold_to_the_byte() {
    let scene = &frames::<3>(500, true, Motion::Flight, 1)[0];
    let step = |text: &str, memory_limit: u64, pairs: usize| {
        let mut tracker = parse(text).unwrap().make(Options { memory_limit, threads: 1 });
        let result =
            tracker.step(scene, Test::Exact, None, &mut Vec::with_capacity(pairs)).map(|_| ());
        (result, tracker.formula_bytes())
    };
    for text in &ALL[..4] {
        // Contacts fit in any case.
        let room = oracle::truth(scene, Arithmetic::Exact).unwrap().pairs.len();
        let (result, mut formula) = step(text, 1 << 30, room);
        assert_eq!(result, Ok(()));
        if let (Ok(()), lean) = step(text, formula - 1, room) {
            assert!(lean < formula && (text.contains("nbs") || text.contains("scr")), "{text}");
            formula = lean;
        }
        assert_eq!(step(text, formula, room), (Ok(()), formula), "{text}");
        let (refused, taken) = step(text, formula - 1, room);
        let name = text.split(',').next().unwrap();
        let Err(Refusal::Memory { detector, needed, .. }) = refused else { panic!("{refused:?}") };
        assert_eq!((detector, needed, taken), (name, formula, 0), "{text}");
    }
    // Contacts that do not fit: the next frame is taken as the first.
    for text in &ALL[..4] {
        let mut tracker = parse(text).unwrap().make(Options { memory_limit: 3_000, threads: 1 });
        let mut step = |apart| tracker.step(&grid(apart), Test::Exact, None, &mut Vec::new());
        assert!(step(2.5).unwrap().built && !step(2.5).unwrap().built, "{text}");
        assert!(matches!(step(0.5), Err(Refusal::Pairs { .. })), "{text}");
        assert!(step(2.5).unwrap().built, "{text}");
    }
    let mut tracker = parse(ALL[0]).unwrap().make(Options { memory_limit: 1 << 30, threads: 1 });
    assert_eq!(tracker.formula_bytes(), 0);
    tracker.step(scene, Test::Exact, None, &mut Vec::new()).unwrap();
    assert_eq!(tracker.formula_bytes(), 500 * 40);
}
