//! Metamorphic relations: what a change of the scene does to the set of pairs, without asking which
//! pairs are right. Every detector of the table is held to them, in 2D and 3D, in every safe
//! arithmetic in which the relation is exact.
//!
//! | relation | the set of pairs | exact in | because |
//! |---|---|---|---|
//! | permutation of the particles | renamed | all | a - b and b - a round alike, ri + rj commutes |
//! | one radius for all, or the same one each | same | all | the same operations |
//! | removal of particles | those of the rest | all; f32-cell if the largest stays | the cell's edge is made from the largest |
//! | a particle twice | its pairs twice, and one more | all | 0 <= s² holds rounded, too |
//! | larger radii | a superset | all; f32-cell up to the largest | rounding is monotone: s' >= s gives s'² >= s² |
//! | scaling by 2^k | same | all | no bit is lost; rounded tests while no square under- or overflows |
//! | mirroring of an axis | same | all; f32-cell on its grid | the ties of its rounding go upwards on both sides of 0 |
//! | exchange of x and y | same | all | a + b = b + a, rounded, too |
//! | exchange of other axes | same | exact | (a + b) + c is not a + (b + c) |
//! | translation | same | all | dyadic numbers with few bits: no difference changes |
//! | a copy far away | twice | all | as translation |
//!
//! The relations ask nothing of the oracle, and hold `direct`, on which the oracle rests, to the
//! same.
//!
//! `cargo test --test detectors metamorphic -- --nocapture` prints how many answers were compared.

mod relations;
mod scenes;

use std::cell::RefCell;
use std::collections::BTreeMap;

use contactbench::check;
use contactbench::contact::Arithmetic;
use contactbench::detect::any::AnyDetector;
use contactbench::detect::table::{Entry, TABLE};
use contactbench::detect::{Options, Refusal};
use contactbench::scene::{AnyScene, Scene};
use contactbench::sink::normalise;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use scenes::Bag;

/// Pairs as they are compared: each i < j, ascending.
type Pairs = Vec<[u32; 2]>;

/// What a relation says of one scene.
struct Claim<const D: usize> {
    before: Bag<D>,
    after: Bag<D>,
    /// The pairs after, from the pairs before.
    expected: Box<dyn Fn(&Pairs) -> Pairs>,
    /// There may be more.
    superset: bool,
}

impl<const D: usize> Claim<D> {
    /// The change leaves the pairs as they are.
    fn same(before: Bag<D>, after: Bag<D>) -> Claim<D> {
        Claim { before, after, expected: Box::new(Pairs::clone), superset: false }
    }
}

/// The number of pairs before; `None` if nothing was compared.
type Compared = Result<Option<usize>, TestCaseError>;

/// A relation; `None` where it is not exact.
type Relation<const D: usize> = fn(&Bag<D>, Arithmetic, &mut ChaCha8Rng) -> Option<Claim<D>>;

const ALL: &[Arithmetic] = &Arithmetic::SAFE;

/// One test for each relation, in both dimensions.
macro_rules! relations {
    ($($test:ident: $relation:ident in $arithmetics:expr;)*) => {$(
        #[test]
        fn $test() {
            let relation = (relations::$relation::<2>, relations::$relation::<3>);
            hold(stringify!($relation), $arithmetics, relation.0, relation.1);
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

/// Small, so that far-away particles are refused, and not slow.
const OPTIONS: Options = Options { memory_limit: 2 << 20, threads: 1 };

/// Holds all detectors to a relation, in both dimensions.
fn hold(name: &str, arithmetics: &[Arithmetic], plane: Relation<2>, space: Relation<3>) {
    each(name, arithmetics, &|bag, arithmetic, seed, entry| {
        compare(plane, bag, arithmetic, seed, entry)
    });
    each(name, arithmetics, &|bag, arithmetic, seed, entry| {
        compare(space, bag, arithmetic, seed, entry)
    });
}

/// Compares what a detector finds before and after.
fn compare<const D: usize>(
    relation: Relation<D>,
    bag: &Bag<D>,
    arithmetic: Arithmetic,
    seed: u64,
    entry: &Entry,
) -> Compared
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let Some(claim) = relation(bag, arithmetic, &mut ChaCha8Rng::seed_from_u64(seed)) else {
        return Ok(None);
    };
    let mut answers = [&claim.before, &claim.after]
        .map(|bag| answer(entry.name, &mut *entry.make(OPTIONS), bag, arithmetic));
    let [Ok(Some(before)), Ok(Some(after))] = &mut answers else {
        return answers.into_iter().find_map(Result::err).map_or(Ok(None), Err);
    };
    let mut expected = (claim.expected)(before);
    normalise(&mut expected);
    let holds = if claim.superset {
        expected.iter().all(|pair| after.binary_search(pair).is_ok())
    } else {
        *after == expected
    };
    prop_assert!(holds, "{}", difference(after, &expected, &claim.before, &claim.after));
    Ok(Some(before.len()))
}

/// The pairs that a detector finds; `None` if it refuses, or the scene cannot be stored. No pair
/// may be repeated, or be none.
fn answer<const D: usize>(
    name: &str,
    detector: &mut dyn AnyDetector,
    bag: &Bag<D>,
    arithmetic: Arithmetic,
) -> Result<Option<Pairs>, TestCaseError>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let Ok(stored) = bag.scene().stored(arithmetic) else { return Ok(None) };
    let mut pairs = Pairs::new();
    match detector.list(&stored, arithmetic.test(), &mut pairs) {
        Err(Refusal::Overflow { .. }) => return Ok(None),
        Err(refusal) => {
            prop_assert!(name != "direct", "direct works on every scene, but: {refusal}");
            prop_assert!(pairs.is_empty(), "refused after reporting: {refusal}");
            return Ok(None);
        }
        Ok(()) => normalise(&mut pairs),
    }
    let valid = pairs.iter().all(|[i, j]| i < j && (*j as usize) < bag.len())
        && pairs.windows(2).all(|w| w[0] < w[1]);
    prop_assert!(
        valid,
        "pairs repeated, or with themselves: {pairs:?} on\n{}",
        check::as_csv(&bag.scene())
    );
    Ok(Some(pairs))
}

fn difference<const D: usize>(
    found: &Pairs,
    expected: &Pairs,
    before: &Bag<D>,
    after: &Bag<D>,
) -> String
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let without = |a: &Pairs, b: &Pairs| {
        a.iter().filter(|pair| !b.contains(pair)).copied().collect::<Pairs>()
    };
    let (missed, added) = (without(expected, found), without(found, expected));
    let [before, after] = [before, after].map(|bag| check::as_csv(&bag.scene()));
    format!(
        "missed {missed:?}, added {added:?} of {} expected\nbefore:\n{before}after:\n{after}",
        expected.len()
    )
}

/// Runs a check on scenes, in all arithmetics, with all detectors, and prints how much was
/// compared: in each arithmetic it must be something.
fn each<const D: usize>(
    name: &str,
    arithmetics: &[Arithmetic],
    check: &dyn Fn(&Bag<D>, Arithmetic, u64, &Entry) -> Compared,
) {
    let compared: RefCell<BTreeMap<Arithmetic, [usize; 2]>> = RefCell::default();
    let mut runner =
        TestRunner::new(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() });
    let ended = runner.run(&(scenes::bags::<D>(), any::<u64>().no_shrink()), |(bag, seed)| {
        for &arithmetic in arithmetics {
            for entry in TABLE.iter().filter(|entry| entry.must_be_right()) {
                let pairs = check(&bag, arithmetic, seed, entry).map_err(|error| {
                    TestCaseError::fail(format!(
                        "{name}: {} in {}: {error}",
                        entry.name,
                        arithmetic.name()
                    ))
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
    if let Err(error) = ended {
        panic!("{error}");
    }
    let compared = compared.into_inner();
    for arithmetic in arithmetics {
        let [answers, pairs] = compared.get(arithmetic).copied().unwrap_or_default();
        println!("{name:<20} {D}D {:<9} {answers:>6} answers {pairs:>8} pairs", arithmetic.name());
        assert!(
            answers > 100 && pairs > 100,
            "{name} in {D}D, {}: too few answers to say anything",
            arithmetic.name()
        );
    }
}
