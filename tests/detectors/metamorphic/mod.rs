//! Metamorphic relations: a known change of the scene changes the set of pairs in a known way. All
//! detectors are tested, in 2D and 3D, in every safe arithmetic in which the relation is exact.
//!
//! | relation | the set of pairs | exact in | because |
//! |---|---|---|---|
//! | permutation of the particles | renamed | all | a - b and b - a round alike, ri + rj commutes |
//! | one radius for all, or the same for each particle | same | all | the same operations |
//! | removal of particles | the pairs of the other particles | all | a test reads two particles |
//! | a particle twice | its pairs twice, and both as a pair | all | 0 <= s² also holds after rounding |
//! | larger radii | a superset | all | rounding is monotone: s' >= s gives s'² >= s² |
//! | scaling by 2^k | same | all | no bit is lost; rounded tests while no square under- or overflows |
//! | mirroring of an axis | same | all | rounding is symmetric |
//! | exchange of x and y | same | all | a + b = b + a also holds after rounding |
//! | exchange of other axes | same | exact | (a + b) + c is not a + (b + c) |
//! | translation | same | all | coordinates have few bits, so differences stay equal |
//! | a copy far away | each pair twice | all | as for translation |
//!
//! The relations do not use the oracle, so they also test `direct`, on which the oracle rests.
//!
//! `cargo test --test detectors metamorphic -- --nocapture` prints the number of comparisons.

mod relations;
mod scenes;

use std::cell::RefCell;
use std::collections::BTreeMap;

use contactbench::check;
use contactbench::scene::Scene;
use contactbench_detectors::table::{Entry, TABLE};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::normalise::normalise;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use relations::Given;
use scenes::any_scene;

/// Pairs with i < j, in ascending order.
type Pairs = Vec<[u32; 2]>;

type Flat<const D: usize> = Scene<'static, f64, D>;

/// A changed scene, and the pairs expected there.
struct Claim<const D: usize> {
    before: Flat<D>,
    after: Flat<D>,
    /// Computes the pairs after the change from those before.
    expected: Box<dyn Fn(&Pairs) -> Pairs>,
    superset: bool,
}

/// A relation; it returns `None` where the change of pairs is not exact.
type Relation<const D: usize> = fn(Given<'_, D>) -> Option<Claim<D>>;

const ALL: &[Arithmetic] = &Arithmetic::SAFE;

/// Defines one test for each metamorphic relation.
macro_rules! relations {
    ($($test:ident: $relation:ident in $arithmetics:expr;)*) => {$(
        #[test]
        fn $test() {
            hold(stringify!($relation), $arithmetics, |it: Given<'_, 2>| it.$relation());
            hold(stringify!($relation), $arithmetics, |it: Given<'_, 3>| it.$relation());
        }
    )*};
}

relations! {
    permutation_renames_the_pairs: permutation in ALL;
    one_radius_for_all_is_the_same_radius_each: radius_each in ALL;
    removal_leaves_the_pairs_of_the_rest: removal in ALL;
    a_particle_twice_has_its_pairs_twice_and_one_more: twice in ALL;
    larger_radii_lose_no_pair: growth in ALL;
    powers_of_two_scale: scaling in ALL;
    a_mirror_changes_nothing: mirror in ALL;
    x_and_y_may_be_exchanged: exchange in ALL;
    axes_may_be_turned_in_exact_arithmetic: turned in &[Arithmetic::Exact];
    translation_without_rounding_changes_nothing: translation in ALL;
    a_copy_far_away_has_the_same_pairs: copy in ALL;
}

/// The memory limit is small, so that scenes with far particles are refused quickly.
const OPTIONS: Options = Options { memory_limit: 2 << 20, threads: 1 };

/// Compares the pairs that a detector finds before and after a change. Returns the number of pairs
/// before, or `None` if nothing was compared.
fn compare<const D: usize>(claim: &Claim<D>, arithmetic: Arithmetic, entry: &Entry) -> Compared {
    let mut found = Vec::new();
    for scene in [&claim.before, &claim.after] {
        let Some(pairs) = answer(entry, scene, arithmetic)? else { return Ok(None) };
        found.push(pairs);
    }
    let [before, after] = [&found[0], &found[1]];
    let mut expected = (claim.expected)(before);
    normalise(&mut expected);
    let holds = match claim.superset {
        true => expected.iter().all(|pair| after.binary_search(pair).is_ok()),
        false => *after == expected,
    };
    prop_assert!(holds, "{}", difference(after, &expected, claim));
    Ok(Some(before.len()))
}

type Compared = Result<Option<usize>, TestCaseError>;

/// Returns the pairs of a detector; `None` if it refuses or the scene cannot be stored. Fails on
/// repeated and self pairs.
fn answer<const D: usize>(
    entry: &Entry,
    scene: &Flat<D>,
    arithmetic: Arithmetic,
) -> Result<Option<Pairs>, TestCaseError> {
    let scene = any_scene(scene);
    let Ok(stored) = scene.stored(arithmetic) else { return Ok(None) };
    let mut pairs = Pairs::new();
    match entry.make(OPTIONS).list(&stored, arithmetic.test(), &mut pairs) {
        Err(Refusal::Overflow { .. }) => return Ok(None),
        Err(refusal) => {
            prop_assert!(entry.name != "direct", "direct works on every scene, but: {refusal}");
            prop_assert!(pairs.is_empty(), "refused after reporting: {refusal}");
            return Ok(None);
        }
        Ok(()) => normalise(&mut pairs),
    }
    let valid = pairs.iter().all(|[i, j]| i < j && (*j as usize) < scene.len())
        && pairs.windows(2).all(|w| w[0] < w[1]);
    prop_assert!(valid, "repeated, or with themselves: {pairs:?} on\n{}", check::as_csv(&scene));
    Ok(Some(pairs))
}

fn difference<const D: usize>(found: &Pairs, expected: &Pairs, claim: &Claim<D>) -> String {
    let without = |a: &Pairs, b: &Pairs| {
        a.iter().filter(|pair| !b.contains(pair)).copied().collect::<Pairs>()
    };
    let (missed, added) = (without(expected, found), without(found, expected));
    let [before, after] =
        [&claim.before, &claim.after].map(|scene| check::as_csv(&any_scene(scene)));
    let all = expected.len();
    format!("missed {missed:?}, added {added:?} of {all}\nbefore:\n{before}after:\n{after}")
}

/// Tests a relation with all detectors and arithmetics, and prints the number of comparisons, which
/// must not be 0 for any arithmetic.
fn hold<const D: usize>(name: &str, arithmetics: &[Arithmetic], relation: Relation<D>) {
    let compared: RefCell<BTreeMap<Arithmetic, [usize; 2]>> = RefCell::default();
    // A quarter of proptest's number, which the environment variable PROPTEST_CASES sets.
    let usual = ProptestConfig::default();
    let config =
        ProptestConfig { failure_persistence: None, cases: usual.cases.div_ceil(4), ..usual };
    let scenes = (scenes::scenes::<D>(), any::<u64>().no_shrink());
    let ended = TestRunner::new(config).run(&scenes, |(scene, seed)| {
        for &arithmetic in arithmetics {
            let random = &mut ChaCha8Rng::seed_from_u64(seed);
            let Some(claim) = relation(Given { scene: &scene, arithmetic, random }) else {
                continue;
            };
            for entry in TABLE.iter().filter(|entry| entry.must_be_right()) {
                let pairs = compare(&claim, arithmetic, entry).map_err(|error| {
                    let (detector, arithmetic) = (entry.name, arithmetic.name());
                    TestCaseError::fail(format!("{name}: {detector} in {arithmetic}: {error}"))
                })?;
                if let Some(pairs) = pairs {
                    let mut compared = compared.borrow_mut();
                    let [answers, all] = compared.entry(arithmetic).or_default();
                    (*answers, *all) = (*answers + 1, *all + pairs);
                }
            }
        }
        Ok(())
    });
    ended.unwrap_or_else(|error| panic!("{error}"));
    let compared = compared.into_inner();
    for arithmetic in arithmetics {
        let [answers, pairs] = compared.get(arithmetic).copied().unwrap_or_default();
        let what = format!("{name:<20} {D}D {:<9}", arithmetic.name());
        println!("{what} {answers:>6} answers {pairs:>8} pairs");
        assert!(answers > 100 && pairs > 100, "{what}: too few answers to say anything");
    }
}
