//! The truth about a periodic scene: all pairs, and all of their images that can be within reach.
//!
//! **Exact.** For every pair i <= j the whole numbers S are gone through for which |xi - xj - S·H|
//! can be at most ri + rj, from the numbers as given: no particle is wrapped, no image is made, no
//! half is taken but that of a particle with itself. By (1) of the page on frames Sa differs from
//! fa = ga·(xi - xj) by at most |ga| (ri + rj) + 2c off(a); fa as computed, from a difference that
//! is rounded, is within 8u of the sum of |ga| (|xi| + |xj|) by coordinates. A quarter more is
//! taken on either side. Each such image is decided by exact arithmetic, but for those that are
//! apart along one axis: there the computed xi - xj - S·H has an error of at most 8u times the sum
//! of the magnitudes of its terms (five terms, products with one rounding more).
//!
//! Above [`BRUTE_FORCE`] particles, fewer than in open scenes since a pair takes longer, two
//! detectors must give the same contacts, and random particles are held against all others in this
//! way, as in [`crate::oracle`].
//!
//! **Rounded.** What a rounded test says depends on rounded images, so those are given: the truth
//! is that of the open scene of all bodies that detectors get ([`super::images`]), as stored. The
//! exact truth of those is between the two ([`truth_as_stored`]).

use super::contacts::List;
use super::crowded;
use super::frame::{Frame, MOST, U};
use super::images::Images;
use super::made::touches;
use super::stored::stored;
use super::{IMAGE_PAIR_BYTES, ImagePair, Periodic};
use crate::contact::depth::depth_of_image;
use crate::contact::image::Shift;
use crate::contact::{Arithmetic, Test};
use crate::detect::any::{AnyDetector, Searched};
use crate::detect::table;
use crate::oracle::{self, NoTruth, SAMPLE, Sample};
use crate::probe::Silent;
use crate::refusal::Refusal;
use crate::scene::{AnyScene, Scene, array};
use crate::sink::{Digest, Visit};

/// Up to this number of particles every pair is tested.
pub const BRUTE_FORCE: usize = 3_000;
/// Above it, random particles are tested against all others: as many as make about so many tests.
const TESTS: usize = 20_000_000;

/// The set of contacts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truth {
    /// Each contact once, in ascending order.
    pub pairs: Vec<ImagePair>,
    /// Their fingerprint.
    pub digest: Digest,
}

/// The truth about a periodic scene in an arithmetic; that of the test, where the arithmetic has
/// filters that lose contacts. Lists of contacts, and images where they are made, may take `limit`
/// bytes each.
///
/// # Errors
/// [`NoTruth::Refused`] where there are more contacts than that, or the box makes no sense, or the
/// arithmetic cannot hold the scene; else what [`NoTruth`] says.
pub fn truth(
    periodic: &Periodic<'_>,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Truth, NoTruth> {
    let pairs = match periodic.scene() {
        AnyScene::Plane(scene) => of(periodic, &scene.widened(), arithmetic, limit),
        AnyScene::Space(scene) => of(periodic, &scene.widened(), arithmetic, limit),
    }?;
    Ok(Truth::new(pairs))
}

/// What is true, in exact arithmetic, of particles and images as they are stored for an arithmetic:
/// brought into the box, copied across its faces, and rounded. Against [`truth()`] in exact
/// arithmetic it shows what storing them changes, against that in the arithmetic what its test
/// does.
///
/// # Errors
/// As [`truth()`].
pub fn truth_as_stored(
    periodic: &Periodic<'_>,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Truth, NoTruth> {
    let pairs = match periodic.scene() {
        AnyScene::Plane(scene) => {
            bodies(periodic, &scene.widened(), arithmetic, Test::Exact, limit)
        }
        AnyScene::Space(scene) => {
            bodies(periodic, &scene.widened(), arithmetic, Test::Exact, limit)
        }
    }?;
    Ok(Truth::new(pairs))
}

impl Truth {
    fn new(pairs: Vec<ImagePair>) -> Truth {
        let mut digest = Digest::default();
        pairs.iter().for_each(|&ImagePair { i, j, image }| digest.image(i, j, image));
        Truth { pairs, digest }
    }
}

fn of<const D: usize>(
    periodic: &Periodic<'_>,
    scene: &Scene<'_, f64, D>,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Vec<ImagePair>, NoTruth>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    if arithmetic != Arithmetic::Exact {
        return bodies(periodic, scene, arithmetic, arithmetic.test(), limit);
    }
    let frame = Frame::new(periodic.lattice())?;
    if scene.len() > BRUTE_FORCE {
        let n = scene.len();
        let ask = |detector: &mut dyn AnyDetector| {
            super::contacts(periodic, detector, Arithmetic::Exact, limit)
        };
        let sample = Sample { n, particles: (TESTS / n).clamp(16, SAMPLE) };
        let tested = |chosen: &[bool]| tested(scene, &frame, Some(chosen), limit);
        let agreed =
            sample.agreed(&table::judges(|it| it.boxed), limit, ask, tested, |p| [p.i, p.j])?;
        return agreed.ok_or(NoTruth::TooLarge { n });
    }
    Ok(tested(scene, &frame, None, limit)?)
}

/// Of the bodies that detectors get, as stored, by a test.
fn bodies<const D: usize>(
    periodic: &Periodic<'_>,
    scene: &Scene<'_, f64, D>,
    arithmetic: Arithmetic,
    test: Test,
    limit: u64,
) -> Result<Vec<ImagePair>, NoTruth>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let mut images = Images::default();
    let images = images.make(scene, periodic.lattice(), arithmetic, limit)?;
    crowded::within(&images, limit)?;
    let stored = stored(&AnyScene::from(images.open()?), arithmetic)?;
    let mut list = List::new(limit);
    if crowded::is_small(&images) {
        let mut sink = Visit(|a, b| images.pair(a, b).into_iter().for_each(|pair| list.push(pair)));
        let searched = Searched::scene(&stored, test);
        crowded::search(&searched, images.particles(), &mut Silent, &mut sink)?;
        return Ok(list.end(scene.len())?);
    }
    let truth = oracle::truth_as_stored(&stored, test, limit)?;
    let pairs = truth.pairs.iter().filter_map(|&[a, b]| images.pair(a, b));
    pairs.for_each(|pair| list.push(pair));
    Ok(list.end(scene.len())?)
}

/// All pairs tested, or those of the particles that are chosen; in ascending order.
pub(super) fn tested<const D: usize>(
    scene: &Scene<'_, f64, D>,
    frame: &Frame<D>,
    chosen: Option<&[bool]>,
    limit: u64,
) -> Result<Vec<ImagePair>, Refusal> {
    let n = scene.len();
    let reach = 2.0 * scene.largest_radius();
    if frame.periodic.contains(&true) && reach == f64::INFINITY {
        return Err(Refusal::Range);
    }
    let at = |index: usize| array(&scene.centres()[index]);
    // A sphere is half of the box around it, of a skewed one far less; most pairs have none.
    let most = 8.0 * n as f64 * n as f64 + 16.0 * (limit / IMAGE_PAIR_BYTES) as f64;
    let (mut images, mut list) = (0.0, List::new(limit));
    let few: Vec<usize> = match chosen {
        Some(chosen) => (0..n).filter(|&j| chosen[j]).collect(),
        None => Vec::new(),
    };
    for i in 0..n {
        let all = chosen.is_none_or(|chosen| chosen[i]);
        // All later particles, or those of them that are chosen.
        let few = if all { &[][..] } else { &few[few.partition_point(|&j| j < i)..] };
        for j in (i..if all { n } else { i }).chain(few.iter().copied()) {
            let sum = scene.radius(i) + scene.radius(j);
            let ranges = around(frame, [i, j], at(i), at(j), sum)?;
            images += ranges.map(|[low, high]| f64::from(high - low + 1)).iter().product::<f64>();
            if images > most {
                let needed = images * IMAGE_PAIR_BYTES as f64;
                return Err(Refusal::Images { particles: n as u64, images, reach, needed, limit });
            }
            for_all(ranges, |image| {
                let Ok(given) = frame.given(image) else { return };
                if i == j && image <= [0; 3] || apart(frame, at(i), at(j), given, sum) {
                    return;
                }
                let image = given;
                let pair = [i as u32, j as u32];
                if touches(scene, pair, Shift { image, vectors: &frame.vectors }) {
                    list.push(ImagePair::new(pair[0], pair[1], image));
                }
            });
        }
    }
    list.end(n)
}

/// From the lowest to the highest S.
fn around<const D: usize>(
    frame: &Frame<D>,
    [i, j]: [usize; 2],
    a: &[f64; D],
    b: &[f64; D],
    sum: f64,
) -> Result<[[i32; 2]; 3], Refusal> {
    let difference: [f64; D] = std::array::from_fn(|k| a[k] - b[k]);
    let magnitude: [f64; D] = std::array::from_fn(|k| a[k].abs() + b[k].abs());
    let fractions: [f64; 3] = std::array::from_fn(|v| frame.fraction(v, &difference));
    let errors: [f64; 3] = std::array::from_fn(|v| 16.0 * U * frame.most(v, &magnitude));
    let spread = std::array::from_fn(|v| fractions[v].abs() + errors[v]);
    let (coupling, most) = frame.coupling(spread, sum * (1.0 + 4.0 * U));
    let mut ranges = [[0; 2]; 3];
    for v in (0..3).filter(|&v| frame.periodic[v]) {
        let margin = frame.lengths[v] * sum * (1.0 + 16.0 * U) + errors[v] + coupling[v] + 0.25;
        let (low, high) = ((fractions[v] - margin).ceil(), (fractions[v] + margin).floor());
        if !(most < MOST && low > -MOST && high < MOST) {
            let particle = if size(a) > size(b) { i } else { j } as u32;
            return Err(Refusal::Away { particle, vector: v, boxes: fractions[v] });
        }
        ranges[v] = [low as i32, high as i32];
    }
    let most = frame.most_given(ranges.map(|[low, high]| f64::from(low.abs().max(high.abs()))));
    match (0..3).find(|&v| most[v] >= MOST) {
        Some(vector) => Err(Refusal::Skewed { vector }),
        None => Ok(ranges),
    }
}

fn size<const D: usize>(x: &[f64; D]) -> f64 {
    x.iter().fold(0.0, |most, x| x.abs().max(most))
}

/// Is the image surely too far away along some axis?
fn apart<const D: usize>(
    frame: &Frame<D>,
    a: &[f64; D],
    b: &[f64; D],
    image: [i32; 3],
    sum: f64,
) -> bool {
    (0..D).any(|k| {
        let (mut difference, mut terms) = (a[k] - b[k], a[k].abs() + b[k].abs());
        for (count, vector) in image.into_iter().zip(&frame.vectors) {
            let product = f64::from(count) * vector[k];
            difference -= product;
            terms += product.abs();
        }
        let error = 16.0 * U * terms + f64::MIN_POSITIVE;
        // Not where anything overflows: infinity less infinity is no number.
        difference.abs() - error > sum * (1.0 + 4.0 * U) && terms < f64::INFINITY
    })
}

fn for_all([x, y, z]: [[i32; 2]; 3], mut call: impl FnMut([i32; 3])) {
    for a in x[0]..=x[1] {
        for b in y[0]..=y[1] {
            for c in z[0]..=z[1] {
                call([a, b, c]);
            }
        }
    }
}

/// See [`depth_of_image`]; within the range of doubles. 0 for particles that the scene does not
/// have.
pub fn depth(periodic: &Periodic<'_>, pair: ImagePair) -> f64 {
    match periodic.scene() {
        AnyScene::Plane(scene) => depth_in(&scene.widened(), periodic, pair),
        AnyScene::Space(scene) => depth_in(&scene.widened(), periodic, pair),
    }
}

fn depth_in<const D: usize>(
    scene: &Scene<'_, f64, D>,
    periodic: &Periodic<'_>,
    ImagePair { i, j, image }: ImagePair,
) -> f64 {
    let (i, j) = (i as usize, j as usize);
    let centres = scene.centres();
    let (Some(a), Some(b)) = (centres.get(i), centres.get(j)) else { return 0.0 };
    let (flags, rows) = (periodic.lattice().periodic(), periodic.lattice().vectors());
    let vectors: [[f64; D]; 3] = std::array::from_fn(|v| std::array::from_fn(|k| rows[v][k]));
    let image = std::array::from_fn(|v| if flags[v] { image[v] } else { 0 });
    let shift = Shift { image, vectors: &vectors };
    depth_of_image(array(a), array(b), scene.radius(i), scene.radius(j), shift)
        .clamp(-f64::MAX, f64::MAX)
}
