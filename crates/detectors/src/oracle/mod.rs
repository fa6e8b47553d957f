//! Finds the true contacts of a scene, for a given arithmetic.
//!
//! * Up to [`BRUTE_FORCE`] particles, every pair is tested.
//! * Above, two different detectors must find contacts of the same digest, and 1,000 random
//!   particles are tested against all others, except those that a sieve proves to be apart. If
//!   fewer than two detectors accept the scene, every pair is tested after all.
//!
//! Unit tests compare the contact test itself with arbitrary-precision arithmetic.

pub mod boxes;
pub mod loaded;

pub use contactbench_terms::errors::{Causes, Errors};

use self::loaded::{Difference, differences};
use crate::table;
use crate::table::Entry;
use contactbench_ground::contact::depth::depth;
use contactbench_ground::contact::{Arithmetic, Particles, Test, WithParticles, with_stored};
use contactbench_ground::detect::Options;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::filter::{Sieve, bounds};
use contactbench_ground::limits::crowd;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::pair_list::{Allowance, PairList};
use contactbench_ground::pairs::{
    normalise::normalise,
    sink::{Digest, Sink},
};
use contactbench_ground::parallel;
use contactbench_ground::probe::Silent;
use contactbench_ground::scene::{AnyScene, Real, array};
use contactbench_ground::with_scene;
use contactbench_terms::mix::splitmix64;

/// Largest number of particles for which every pair is tested.
pub const BRUTE_FORCE: usize = 3_000;
/// Number of random particles that are tested against all others if not every pair is tested.
pub const SAMPLE: usize = 1_000;

/// The true contacts of a scene, as pairs.
pub struct Truth {
    /// Each pair that touches, once, the smaller index first, in ascending order.
    pub pairs: Vec<[u32; 2]>,
    /// Fingerprint of all pairs in `pairs`.
    pub digest: Digest,
}

/// Largest number of particles for which all pairs are tested if detectors refuse the scene.
pub const LARGEST_BRUTE_FORCE: usize = 200_000;

/// Why the truth could not be established.
#[derive(Debug, thiserror::Error)]
pub enum NoTruth {
    /// The arithmetic cannot represent the scene's distances.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The arithmetic cannot store the scene.
    #[error("as stored: {0}")]
    Stored(#[from] contactbench_ground::scene::SceneError),
    /// Fewer than two detectors accept the scene, and it is too large to test all pairs.
    #[error(
        "fewer than two detectors accept this scene, and {n} particles are too many to test all \
         pairs (at most {LARGEST_BRUTE_FORCE})"
    )]
    TooLarge {
        /// Number of particles of the scene.
        n: usize,
    },
    /// Two detectors found different contacts, which is a defect of this program.
    #[error(
        "{first} and {second} disagree on this scene ({a} and {b} contacts): one of them is wrong"
    )]
    Disagree {
        /// Name of the first of two detectors.
        first: &'static str,
        /// Name of the second detector.
        second: &'static str,
        /// Number of contacts that the first detector found.
        a: usize,
        /// Number of contacts that the second detector found.
        b: usize,
    },
    /// A detector and a sample that was tested directly disagree: a defect of this program.
    #[error(
        "two detectors agree, but testing particle {particle} against all others finds different \
         contacts"
    )]
    Sample {
        /// Number of a particle with different contacts.
        particle: u32,
    },
}

/// Returns the true contacts of `scene` in `arithmetic`, which may first round the scene to f32.
/// Fails as [`truth_as_stored`], with the memory limit of [`Options::default`].
pub fn truth(scene: &AnyScene<'_>, arithmetic: Arithmetic) -> Result<Truth, NoTruth> {
    let limit = Options::default().memory_limit;
    let stored = scene.as_stored(arithmetic)?;
    truth_as_stored(&stored, arithmetic.test(), limit)
}

/// Returns the true contacts of a scene under a contact test, for its numbers as stored. A list of
/// pairs may take `limit` bytes; two lists may exist during the computation.
///
/// # Errors
/// Returns [`NoTruth::Refused`] if the list would be longer or squares of distances overflow. The
/// variants of [`NoTruth`] describe the other errors.
pub fn truth_as_stored(scene: &AnyScene<'_>, test: Test, limit: u64) -> Result<Truth, NoTruth> {
    let test = test.safe();
    if test.is_exact() && !scene.is_f64() {
        let stored = scene.as_stored(Arithmetic::F64)?;
        return truth_as_stored(&stored, test, limit);
    }
    crowd::within(scene, limit)?;
    let pairs = if scene.len() <= BRUTE_FORCE {
        brute_force(scene, test, limit)?
    } else {
        agreed(scene, test, limit)?
    };
    let digest = Digest::from_pairs(&pairs);
    Ok(Truth { pairs, digest })
}

fn brute_force(scene: &AnyScene<'_>, test: Test, limit: u64) -> Result<Vec<[u32; 2]>, Refusal> {
    rows(scene, test, Rows { chosen: None, limit })
}

/// Returns the contacts of the chosen particles, in ascending order, under a contact test, for the
/// scene's numbers as stored. Each chosen particle is tested against all others, except those that
/// are certainly apart. A list of pairs may take `limit` bytes.
///
/// # Errors
/// Fails as [`truth_as_stored`].
pub fn touching(
    scene: &AnyScene<'_>,
    test: Test,
    chosen: &[bool],
    limit: u64,
) -> Result<Vec<[u32; 2]>, NoTruth> {
    let test = test.safe();
    if test.is_exact() && !scene.is_f64() {
        let stored = scene.as_stored(Arithmetic::F64)?;
        return touching(&stored, test, chosen, limit);
    }
    let mut pairs = rows(scene, test, Rows { chosen: Some(&numbers(chosen)), limit })?;
    pairs.dedup(); // Pairs of two chosen particles were tested from both sides.
    Ok(pairs)
}

/// Returns the numbers of the chosen particles.
pub(crate) fn numbers(chosen: &[bool]) -> Vec<u32> {
    (0..chosen.len() as u32).filter(|&k| chosen[k as usize]).collect()
}

fn rows(scene: &AnyScene<'_>, test: Test, rows: Rows<'_>) -> Result<Vec<[u32; 2]>, Refusal> {
    match scene {
        AnyScene::Plane(scene) => with_stored(scene, test, rows),
        AnyScene::Space(scene) => with_stored(scene, test, rows),
    }
}

fn agreed(scene: &AnyScene<'_>, test: Test, limit: u64) -> Result<Vec<[u32; 2]>, NoTruth> {
    let n = scene.len();
    let ask = |detector: &mut dyn AnyDetector| {
        let mut pairs = Vec::new();
        detector.list(scene, test, &mut pairs)?;
        Ok((Digest::from_pairs(&pairs), pairs))
    };
    let sorted = |mut pairs: Vec<_>| {
        normalise(&mut pairs);
        Ok(pairs)
    };
    let tested = |chosen: &[bool]| touching(scene, test, chosen, limit);
    match agreed_by(n, &table::judges(), limit, ask, sorted, tested, |pair| pair)? {
        Some(pairs) => Ok(pairs),
        None if n > LARGEST_BRUTE_FORCE => Err(NoTruth::TooLarge { n }),
        None => Ok(brute_force(scene, test, limit)?),
    }
}

/// Runs detectors one after another until two have accepted the scene. Returns the
/// contacts in ascending order if both agree with each other, and with random particles that are
/// tested against all others; `None` if fewer than two detectors accept the scene.
pub(crate) fn agreed_by<L, C: Copy + PartialEq>(
    n: usize,
    judges: &[&'static Entry],
    limit: u64,
    ask: impl Fn(&mut dyn AnyDetector) -> Result<(Digest, L), Refusal>,
    sorted: impl Fn(L) -> Result<Vec<C>, Refusal>,
    tested: impl Fn(&[bool]) -> Result<Vec<C>, NoTruth>,
    particles: impl Fn(C) -> [u32; 2],
) -> Result<Option<Vec<C>>, NoTruth> {
    let options = Options { memory_limit: limit, ..Options::default() };
    let mut first: Option<(&'static str, Digest)> = None;
    for entry in judges {
        let (digest, list) = match ask(&mut *entry.make(options)) {
            Ok(answer) => answer,
            Err(refusal) if refusal.is_of_scene() => return Err(refusal.into()),
            Err(_) => continue,
        };
        let Some((first, agreed)) = first.replace((entry.name, digest)) else { continue };
        if agreed != digest {
            let (a, b) = (agreed.contacts as usize, digest.contacts as usize);
            return Err(NoTruth::Disagree { first, second: entry.name, a, b });
        }
        let (pairs, chosen) = (sorted(list)?, random(n, SAMPLE, 0));
        let is_chosen = |k: u32| chosen[k as usize];
        let of_chosen = |&pair: &C| particles(pair).into_iter().any(is_chosen);
        let mut theirs = pairs.iter().copied().filter(of_chosen);
        let mut ours = tested(&chosen)?.into_iter();
        loop {
            match (ours.next(), theirs.next()) {
                (None, None) => break,
                (a, b) if a == b => {}
                (a, b) => {
                    let [i, j] = a.or(b).map_or([0; 2], &particles);
                    let particle = if is_chosen(i) { i } else { j };
                    return Err(NoTruth::Sample { particle });
                }
            }
        }
        drop(theirs);
        return Ok(Some(pairs));
    }
    Ok(None)
}

/// Returns which of `n` particles are in a random sample of at most `count` particles.
pub fn random(n: usize, count: usize, seed: u32) -> Vec<bool> {
    let mut chosen = vec![false; n];
    let mut left = count.min(n);
    for k in u64::from(seed) << 32.. {
        if left == 0 {
            break;
        }
        let drawn = (splitmix64(k) % n as u64) as usize;
        left -= usize::from(!std::mem::replace(&mut chosen[drawn], true));
    }
    chosen
}

/// Tests all pairs, or only the chosen particles against all others. Pairs are in ascending order;
/// a pair of two chosen particles appears twice.
struct Rows<'a> {
    chosen: Option<&'a [u32]>,
    /// Limit for the list of pairs, in bytes.
    limit: u64,
}

impl<T: Real, const D: usize> WithParticles<T, D> for Rows<'_> {
    type Output = Result<Vec<[u32; 2]>, Refusal>;
    fn call<B: Particles<T, D>>(self, particles: B) -> Self::Output {
        let n = particles.len() as u32;
        let test = |i: u32, j: u32, pairs: &mut PairList<'_>| {
            if particles.touch(i, j, &mut Silent) {
                pairs.contact(i, j);
            }
        };
        let sieve = self.chosen.map(|chosen| {
            let (low, high) = bounds(&particles);
            let at: Vec<[f64; D]> = chosen.iter().map(|&k| particles.position(k)).collect();
            let spans = std::array::from_fn(|k| Some([low[k], high[k]]));
            (chosen, Sieve::new(&at, [particles.reach(); D], spans))
        });
        let threads = rayon::current_num_threads();
        let count = (n as usize, n as usize);
        let found = parallel::contacts(count, threads, self.limit, &|rows, pairs| {
            for i in rows.start as u32..rows.end as u32 {
                match &sieve {
                    None => (i + 1..n).for_each(|j| test(i, j, pairs)),
                    Some((chosen, sieve)) => sieve.near(&particles.position(i), |k| {
                        if chosen[k] != i {
                            test(chosen[k], i, pairs);
                        }
                    }),
                }
            }
        })?;
        let allowance = Allowance::new(self.limit);
        let (mut all, mut pairs) = (PairList::new(&allowance), Vec::new());
        all.gather(&found.iter().map(Vec::as_slice).collect::<Vec<_>>());
        drop(found);
        all.end(n as usize, &mut pairs)?;
        normalise(&mut pairs);
        Ok(pairs)
    }
}

/// Compares a detector's pairs with the true contacts. Both lists must be in the order of
/// [`normalise`]; they are not copied. Depths are computed from `scene`.
pub fn compare(reported: &[[u32; 2]], truth: &[[u32; 2]], scene: &AnyScene<'_>) -> Errors {
    compare_by(reported, truth, |[i, j]| i == j, |pair| depth_of(scene, pair))
}

/// Compares as [`compare`] does, for any type of contact. The two closures return whether a contact
/// pairs a particle with itself, and the depth of a contact.
pub fn compare_by<C: Copy + Ord>(
    reported: &[C],
    truth: &[C],
    is_self: impl Fn(C) -> bool,
    depth: impl Fn(C) -> f64,
) -> Errors {
    debug_assert!(reported.is_sorted() && truth.is_sorted());
    let mut errors = Errors::default();
    differences(reported, truth, |kind, pair| match kind {
        Difference::Missed => {
            errors.missed += 1;
            errors.deepest_miss = errors.deepest_miss.max(depth(pair));
        }
        Difference::Repeated => errors.duplicate += 1,
        Difference::Added if is_self(pair) => errors.self_pairs += 1,
        Difference::Added => {
            errors.spurious += 1;
            errors.widest_false = errors.widest_false.max(-depth(pair));
        }
    });
    errors
}

/// Returns the [`depth`] of a pair. Infinity is replaced by the largest double, which a record can
/// hold. Returns 0 if a particle is not in the scene.
pub fn depth_of(scene: &AnyScene<'_>, [i, j]: [u32; 2]) -> f64 {
    let (i, j) = (i as usize, j as usize);
    with_scene!(scene, scene => {
        let centres = scene.centres();
        let (Some(a), Some(b)) = (centres.get(i), centres.get(j)) else { return 0.0 };
        let (a, b) = (array(a).map(Real::wide), array(b).map(Real::wide));
        depth(&a, &b, scene.radius(i).wide(), scene.radius(j).wide()).clamp(-f64::MAX, f64::MAX)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::PLAIN;

    static JUDGE: Entry = PLAIN;

    #[test]
    fn judges_must_agree_with_each_other_and_with_the_sample() {
        const RIGHT: [[u32; 2]; 2] = [[0, 1], [2, 3]];
        let agreed = |second: &[[u32; 2]], tested: &[[u32; 2]]| {
            let asked = std::cell::Cell::new(0);
            let ask = |_: &mut dyn AnyDetector| {
                asked.set(asked.get() + 1);
                let pairs = if asked.get() == 1 { &RIGHT } else { second };
                Ok((Digest::from_pairs(pairs), pairs.to_vec()))
            };
            agreed_by(4, &[&JUDGE; 2], 1 << 20, ask, Ok, |_| Ok(tested.to_vec()), |pair| pair)
        };
        assert_eq!(agreed(&RIGHT, &RIGHT).unwrap().unwrap(), RIGHT);
        let disagree = agreed(&RIGHT[..1], &RIGHT).unwrap_err();
        assert!(matches!(disagree, NoTruth::Disagree { a: 2, b: 1, .. }), "{disagree}");
        for tested in [&RIGHT[..1], &[[0, 1], [1, 2], [2, 3]], &[[0, 1], [2, 4]]] {
            let found = agreed(&RIGHT, tested).unwrap_err();
            assert!(matches!(found, NoTruth::Sample { .. }), "{tested:?}: {found}");
        }
    }
}
