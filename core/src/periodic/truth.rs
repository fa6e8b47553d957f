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
//! **Rounded.** What a rounded test says depends on rounded images, so those are given: the truth
//! is the arithmetic's own test on all pairs of the scene with its images as stored, which are the
//! bodies that detectors get ([`super::images`]).

use super::contacts::{List, stored};
use super::frame::{Frame, MOST, U};
use super::images::{Images, touches};
use super::{IMAGE_PAIR_BYTES, ImagePair, Periodic};
use crate::contact::depth::depth_of_image;
use crate::contact::image::Shift;
use crate::contact::{Arithmetic, Bodies, WithBodies, with_stored};
use crate::oracle::{Errors, LARGEST_BRUTE_FORCE, NoTruth};
use crate::probe::Silent;
use crate::refusal::Refusal;
use crate::scene::{AnyScene, Real, Scene, array};
use crate::sink::Digest;

/// The set of contacts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truth {
    /// Each contact once, in ascending order.
    pub pairs: Vec<ImagePair>,
    /// Their fingerprint.
    pub digest: Digest,
}

/// The truth about a periodic scene in an arithmetic, by testing all pairs; that of the test, where
/// the arithmetic has filters that lose contacts. The list, and images for a rounded arithmetic,
/// may take `limit` bytes.
///
/// # Errors
/// [`NoTruth::TooLarge`] beyond [`LARGEST_BRUTE_FORCE`] particles; [`NoTruth::Refused`] where there
/// are more contacts than the limit allows, or the box makes no sense, or the arithmetic cannot
/// hold the scene.
pub fn truth(
    periodic: &Periodic<'_>,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Truth, NoTruth> {
    let n = periodic.scene().len();
    if n > LARGEST_BRUTE_FORCE {
        return Err(NoTruth::TooLarge { n });
    }
    let mut list = List::new(limit);
    match periodic.scene() {
        AnyScene::Plane(scene) => of(periodic, &scene.widened(), arithmetic, limit, &mut list),
        AnyScene::Space(scene) => of(periodic, &scene.widened(), arithmetic, limit, &mut list),
    }?;
    let pairs = list.end(n)?;
    let mut digest = Digest::default();
    pairs.iter().for_each(|&ImagePair { i, j, image }| digest.image(i, j, image));
    Ok(Truth { pairs, digest })
}

fn of<const D: usize>(
    periodic: &Periodic<'_>,
    scene: &Scene<'_, f64, D>,
    arithmetic: Arithmetic,
    limit: u64,
    list: &mut List,
) -> Result<(), NoTruth>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    if arithmetic == Arithmetic::Exact {
        return Ok(exact(scene, &Frame::new(periodic.lattice())?, limit, list)?);
    }
    let (images, open) = Images::new(scene, periodic.lattice(), arithmetic, limit)?;
    let stored = stored(&AnyScene::from(open), arithmetic)?;
    let all = All { owners: scene.len() as u32, images: &images, list };
    Ok(match &stored {
        AnyScene::Plane(stored) => with_stored(stored, arithmetic.test().safe(), all),
        AnyScene::Space(stored) => with_stored(stored, arithmetic.test().safe(), all),
    }?)
}

fn exact<const D: usize>(
    scene: &Scene<'_, f64, D>,
    frame: &Frame<D>,
    limit: u64,
    list: &mut List,
) -> Result<(), Refusal> {
    let n = scene.len();
    let at = |index: usize| array(&scene.centres()[index]);
    // A sphere is half of the box around it, of a skewed one far less; most pairs have none.
    let most = 8.0 * (n * n) as f64 + 16.0 * (limit / IMAGE_PAIR_BYTES) as f64;
    let mut images = 0.0;
    for i in 0..n {
        for j in i..n {
            let sum = scene.radius(i) + scene.radius(j);
            let ranges = around(frame, [i, j], at(i), at(j), sum)?;
            images += ranges.map(|[low, high]| f64::from(high - low + 1)).iter().product::<f64>();
            if images > most {
                let needed = images * IMAGE_PAIR_BYTES as f64;
                let (particles, reach) = (n as u64, 2.0 * scene.largest_radius());
                return Err(Refusal::Images { particles, images, reach, needed, limit });
            }
            for_all(ranges, |image| {
                if i == j && image <= [0; 3] || apart(frame, at(i), at(j), image, sum) {
                    return;
                }
                let pair = [i as u32, j as u32];
                if touches(scene, pair, Shift { image, vectors: &frame.vectors }) {
                    list.push(ImagePair { i: pair[0], j: pair[1], image });
                }
            });
        }
    }
    Ok(())
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
    Ok(ranges)
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

/// All pairs of an owner and a body, as stored.
struct All<'a, const D: usize> {
    owners: u32,
    images: &'a Images<'a, D>,
    list: &'a mut List,
}

impl<T: Real, const D: usize, const E: usize> WithBodies<T, E> for All<'_, D> {
    type Output = Result<(), Refusal>;
    fn call<B: Bodies<T, E>>(self, bodies: B) -> Self::Output {
        for a in 0..self.owners {
            for b in a + 1..bodies.len() as u32 {
                if bodies.touch(a, b, &mut Silent) {
                    self.images.pair(a, b).into_iter().for_each(|pair| self.list.push(pair));
                }
            }
        }
        Ok(())
    }
}

/// What a list of contacts misses and adds against the truth, both in ascending order, as
/// [`crate::oracle::compare`] does: depths are those of the scene as given. A particle named as
/// touching itself, not an image of it, counts as a self-pair.
pub fn compare(reported: &[ImagePair], truth: &[ImagePair], periodic: &Periodic<'_>) -> Errors {
    let (mut errors, mut last) = (Errors::default(), None);
    let mut miss = |pair: ImagePair| {
        errors.missed += 1;
        errors.deepest_miss = errors.deepest_miss.max(depth(periodic, pair));
    };
    let mut truth = truth.iter().copied().peekable();
    for &pair in reported {
        if last.replace(pair) == Some(pair) {
            errors.duplicate += 1;
            continue;
        }
        while let Some(missed) = truth.next_if(|&t| t < pair) {
            miss(missed);
        }
        if truth.next_if_eq(&pair).is_some() {
        } else if pair.i == pair.j && pair.image == [0; 3] {
            errors.self_pairs += 1;
        } else {
            errors.spurious += 1;
            errors.widest_false = errors.widest_false.max(-depth(periodic, pair));
        }
    }
    truth.for_each(miss);
    errors
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
