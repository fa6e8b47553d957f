//! Lists kept while bodies move: a small reference tracker is made wrong in one way at a time, and
//! couples at the limit of the skin (`crates/campaigns`) and a few plain motions must find out each.
//!
//! The reference bounds ways and sums by the least doubles that are no smaller, so that no mistake
//! hides behind a bound that is wider than it must be.

mod tracker;

use contactbench::contact::exact::compare;
use rayon::prelude::*;
use tracker::Tracker;

use contactbench_campaigns::draw::{Draw, Sphere};
use contactbench_campaigns::moving::couples::Couple;

ways! {
    // How far bodies have gone.
    /// A half of the half: the way of one may be the skin, and that of two twice the skin.
    HalfCounted,
    /// Along the first axis only.
    AlongX,
    /// Along the axis along which it is farthest.
    LargestAxis,
    /// As computed, not rounded up.
    Nearest,
    /// Rounded up by a part of itself, which is nothing where squares vanish.
    PartOfItself,
    /// Sums of ways are not rounded up.
    SumNearest,
    /// Sums of ways are rounded down.
    SumDown,
    /// Since the frame before, not since the list was built.
    SinceLastFrame,
    /// Since the first list was built.
    SinceFirstList,
    /// The longest way alone for two.
    SecondForgotten,
    /// The mean of all for the longest.
    Mean,
    /// The last body is not looked at.
    LastForgotten,

    // When the list is built.
    /// In the frame after that in which it is due.
    OneStepLate,
    /// Where radii are others, by ways alone.
    RadiiKept,
    /// Where the number of bodies is another, by ways alone.
    NumberKept,
    /// It is due, and the old one is kept, with new places.
    PairsKept,

    // What is in the list.
    /// The skin of one of two bodies.
    OneSkin,
    /// Of each body a skin in its own diameters.
    OwnSkin,
    /// Larger radii are not rounded up.
    RadiusNearest,
    /// Larger radii are rounded down.
    RadiusDown,
    /// Not what is exactly a skin apart.
    Strict,
    ;

    // Changes that look wrong and are not.
    /// Right.
    List,
    /// It is built where ways are just the skin.
    AtLimit,
    /// The sum over the frames goes on when the list is built.
    SumGoesOn,
    /// Twice the skin.
    Thicker,
    /// The list is kept, and so are places and the sum, where nothing has moved.
    RestsWhereBuilt,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Rule {
    TopTwo,
    HalfSkin,
    Summed,
}

const RULES: [Rule; 3] = [Rule::TopTwo, Rule::HalfSkin, Rule::Summed];

impl Way {
    /// The rules that it changes.
    fn rules(self) -> &'static [Rule] {
        match self {
            // Twice a way is exact.
            Way::SumNearest | Way::SumDown => &[Rule::TopTwo, Rule::Summed],
            Way::SecondForgotten => &[Rule::TopTwo],
            // The sum begins anew.
            Way::SinceFirstList => &[Rule::TopTwo, Rule::HalfSkin],
            Way::SumGoesOn => &[Rule::Summed],
            _ => &RULES,
        }
    }
}

/// Bodies in a frame, and the pairs of them that touch.
struct Frame<const D: usize> {
    centres: Vec<[f64; D]>,
    radii: Vec<f64>,
    truth: Vec<[u32; 2]>,
}

struct Trial<const D: usize> {
    name: &'static str,
    /// In diameters of the largest body.
    skin: f64,
    frames: Vec<Frame<D>>,
}

fn is_right<const D: usize>(way: Way, rule: Rule, trial: &Trial<D>) -> bool {
    let mut tracker = Tracker::new(way, rule, trial.skin);
    trial.frames.iter().all(|frame| tracker.step(frame) == frame.truth)
}

/// All couples and motions in one dimension.
fn trials<const D: usize>() -> Vec<Trial<D>> {
    let (sphere, mut draw) = (Sphere::made(), Draw::new(D as u64, 0));
    let couple = |couple: Couple<D>| {
        let frame = |k: usize| {
            let (centres, radii) = couple.bodies(k);
            Frame { centres, radii, truth: couple.touching(k) }
        };
        let frames = (0..couple.frame_count()).map(frame).collect();
        Trial { name: couple.name, skin: couple.skin, frames }
    };
    let mut trials: Vec<_> = (0..3_000).map(|_| couple(Couple::new(&sphere, &mut draw))).collect();
    let row = |name: &'static str, frames: [&[[f64; 2]]; 3]| {
        // Places along x and radii.
        let frame = |row: &&[[f64; 2]]| {
            let centre = |&[x, _]: &[f64; 2]| std::array::from_fn(|k| [x, 0.0][k.min(1)]);
            plain(row.iter().map(centre).collect(), row.iter().map(|&[_, r]| r).collect())
        };
        Trial { name, skin: 0.125, frames: frames.iter().map(frame).collect() }
    };
    trials.push(row(
        "a body grows",
        [&[[0.0, 1.0], [3.0, 1.0]], &[[0.0, 2.0], [3.0, 1.0]], &[[0.0, 1.0], [3.0, 1.0]]],
    ));
    trials.push(row(
        "a body comes",
        [&[[0.0, 1.0], [3.0, 1.0]], &[[0.0, 1.0], [3.0, 1.0], [1.0, 1.0]], &[[3.0, 1.0]]],
    ));
    trials.extend((0..20).map(|k| flight(k, &mut draw)));
    trials
}

fn plain<const D: usize>(centres: Vec<[f64; D]>, radii: Vec<f64>) -> Frame<D> {
    let n = radii.len();
    let touch =
        |&[i, j]: &[usize; 2]| compare(&centres[i], &centres[j], radii[i], radii[j]).is_le();
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j])).filter(touch);
    let truth = pairs.map(|pair| pair.map(|k| k as u32)).collect();
    Frame { centres, radii, truth }
}

/// A dozen in straight flight, or to and fro.
fn flight<const D: usize>(k: u64, draw: &mut Draw) -> Trial<D> {
    let mut somewhere = |size: f64| -> Vec<[f64; D]> {
        (0..12).map(|_| std::array::from_fn(|_| size * (2.0 * draw.unit() - 1.0))).collect()
    };
    let (first, go) = (somewhere(3.0), somewhere(0.25));
    let radius = |i: u32| if k.is_multiple_of(2) { 0.5 } else { 0.1 * f64::from(i) };
    let radii: Vec<f64> = (0..12).map(radius).collect();
    let frame = |step: u64| {
        let time = if k.is_multiple_of(4) { step % 4 } else { step } as f64;
        let at = |i: usize| std::array::from_fn(|k| first[i][k] + time * go[i][k]);
        plain((0..12).map(at).collect(), radii.clone())
    };
    Trial { name: "flight", skin: 0.25 * (k % 5) as f64, frames: (0..20).map(frame).collect() }
}

/// The names of so many trials at most that find a mutant out.
fn found_out<const D: usize>(way: Way, rule: Rule, trials: &[Trial<D>]) -> Vec<&'static str> {
    let wrong = trials.iter().filter(|trial| !is_right(way, rule, trial));
    wrong.map(|trial| trial.name).take(20).collect()
}

#[test]
fn motions_at_the_limit_find_out_every_mutant_of_every_rule() {
    let (plane, space) = (trials::<2>(), trials::<3>());
    let rows: Vec<(Way, Rule)> =
        MUTANTS.iter().flat_map(|&way| way.rules().iter().map(move |&rule| (way, rule))).collect();
    println!("| mutant of lists | rule | found out by |\n|---|---|---|");
    let found: Vec<_> = rows
        .par_iter()
        .map(|&(way, rule)| (found_out(way, rule, &plane), found_out(way, rule, &space)))
        .collect();
    for ((way, rule), (plane, space)) in rows.iter().zip(found) {
        let mut names = [&plane[..], &space[..]].concat();
        names.sort_unstable();
        names.dedup();
        println!("| {way:?} | {rule:?} | {} |", names.join(", "));
        assert!(!plane.is_empty() && !space.is_empty(), "nothing finds out {way:?} of {rule:?}");
    }
}

#[test]
fn motions_at_the_limit_find_no_fault_with_what_is_right() {
    fn all<const D: usize>(trials: &[Trial<D>]) {
        let built = |trial: &Trial<D>, rule: Rule| {
            let mut tracker = Tracker::new(Way::List, rule, trial.skin);
            trial.frames.iter().map(|frame| tracker.step(frame).len()).sum::<usize>()
        };
        for rule in RULES {
            let touching: usize = trials.iter().map(|trial| built(trial, rule)).sum();
            assert!(touching > trials.len(), "{touching}");
            for &way in RIGHT.iter().filter(|way| way.rules().contains(&rule)) {
                trials.par_iter().enumerate().for_each(|(k, trial)| {
                    let name = trial.name;
                    assert!(is_right(way, rule, trial), "{way:?} of {rule:?} on {name} {k}");
                });
            }
        }
    }
    all(&trials::<2>());
    all(&trials::<3>());
}
