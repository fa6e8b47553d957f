//! The true contacts of a periodic scene: all pairs, with all images that can be within reach.
//!
//! **Exact.** For every pair i <= j, all integers S are tried for which |xi - xj - S·H| can be at
//! most ri + rj, computed from the given numbers. No particle is wrapped, no image is made, and no
//! images are skipped by symmetry except those of a particle with itself. By (1) in `frame.rs` Sa
//! differs from fa = ga·(xi - xj) by at most |ga| (ri + rj) + 2c off(a). The computed fa, from a
//! rounded difference, has an error of at most 8u times the sum of |ga| (|xi| + |xj|) over
//! coordinates. A margin of a quarter is added on either side. Exact arithmetic decides each such
//! image except those that are clearly apart along one axis: the computed xi - xj - S·H has an
//! error of at most 8u times the sum of the magnitudes of its terms (five terms, products with one
//! more rounding).
//!
//! In scenes of more than [`BRUTE_FORCE`] particles two detectors must find equal contacts, and
//! random particles are tested against all others, as in [`crate::oracle`]. A sieve over fractions
//! leaves out particles that are certainly apart: by the bound above, without the quarter, some fa
//! must be near an integer. The sieve compares computed fractions of single particles. Each has an
//! error of at most 4u times the sum of |ga| |x|, and its part below 1 is rounded by less than u.
//!
//! **Rounded.** The result of a rounded test depends on rounded images. The truth is therefore that
//! of the open scene of particles and images that detectors get
//! ([`contactbench_lists::periodic::images`]), as stored. [`truth_as_stored`] decides the same
//! stored scene exactly.

use crate::oracle;
pub use crate::oracle::BRUTE_FORCE;
use crate::oracle::{NoTruth, agreed_by, numbers};
use crate::table;
use contactbench_ground::contact::image::Shift;
use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::detect::any::{AnyDetector, Searched};
use contactbench_ground::filter::Sieve;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::{Digest, Visit};
use contactbench_ground::periodic::{ContactList, List};
use contactbench_ground::periodic::{IMAGE_PAIR_BYTES, ImagePair, Periodic, without_shift};
use contactbench_ground::probe::Silent;
use contactbench_ground::scene::{AnyScene, Scene, array};
use contactbench_ground::wide::fill;
use contactbench_lists::periodic::Finder;
use contactbench_lists::periodic::crowded;
use contactbench_lists::periodic::frame::{MOST, ReducedBox, U};
use contactbench_lists::periodic::images::Images;
use contactbench_lists::periodic::made::touches;
use contactbench_lists::periodic::stored::stored;

/// The true contacts of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truth {
    /// Each contact once, in ascending order.
    pub pairs: Vec<ImagePair>,
    /// Fingerprint of all contacts in `pairs`.
    pub digest: Digest,
}

/// Returns the true contacts of a periodic scene in an arithmetic. For `textbook` arithmetic these
/// are the pairs that its contact test accepts, without its filters. Each list of contacts, and
/// images if any are made, may take `limit` bytes.
///
/// # Errors
/// Returns [`NoTruth::Refused`] if the limit is too low, the box is too skewed or the arithmetic
/// cannot represent the scene. The variants of [`NoTruth`] describe the other errors.
pub fn truth(
    periodic: &Periodic<'_>,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Truth, NoTruth> {
    if !periodic.lattice().repeats() {
        let stored = periodic.scene().as_stored(arithmetic)?;
        let pairs = oracle::truth_as_stored(&stored, arithmetic.test(), limit)?.pairs;
        return Ok(Truth::new(without_shift(&pairs).collect()));
    }
    Ok(Truth::new(any(periodic, arithmetic, None, limit)?))
}

/// Returns the contacts of particles and images as they are stored for an arithmetic, decided
/// exactly: brought into the box, copied across its faces, and rounded. Compared with [`truth()`]
/// in exact arithmetic, this shows the effect of storing; compared with [`truth()`] in the given
/// arithmetic, the effect of its test. Fails as [`truth()`].
pub fn truth_as_stored(
    periodic: &Periodic<'_>,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Truth, NoTruth> {
    let exact = arithmetic.exact().test();
    let pairs = match periodic.scene() {
        AnyScene::Plane(scene) => particles(periodic, &scene.widened(), arithmetic, exact, limit),
        AnyScene::Space(scene) => particles(periodic, &scene.widened(), arithmetic, exact, limit),
    }?;
    Ok(Truth::new(pairs))
}

/// Returns the contacts of the chosen particles, in ascending order. Exact arithmetic tests each of
/// them against all particles; other arithmetics select from [`truth()`]. Fails as [`truth()`].
pub fn touching(
    periodic: &Periodic<'_>,
    arithmetic: Arithmetic,
    chosen: &[bool],
    limit: u64,
) -> Result<Vec<ImagePair>, NoTruth> {
    if !periodic.lattice().repeats() {
        let stored = periodic.scene().as_stored(arithmetic)?;
        let pairs = oracle::touching(&stored, arithmetic.test(), chosen, limit)?;
        return Ok(without_shift(&pairs).collect());
    }
    let mut pairs = any(periodic, arithmetic, Some(chosen), limit)?;
    pairs.retain(|pair| chosen[pair.i as usize] || chosen[pair.j as usize]);
    Ok(pairs)
}

impl Truth {
    fn new(pairs: Vec<ImagePair>) -> Truth {
        let mut digest = Digest::default();
        pairs.iter().for_each(|&ImagePair { i, j, image }| digest.image(i, j, image));
        Truth { pairs, digest }
    }
}

/// Returns all contacts; if some particles are `chosen`, at least theirs.
fn any(
    periodic: &Periodic<'_>,
    arithmetic: Arithmetic,
    chosen: Option<&[bool]>,
    limit: u64,
) -> Result<Vec<ImagePair>, NoTruth> {
    match periodic.scene() {
        AnyScene::Plane(scene) => of(periodic, &scene.widened(), arithmetic, chosen, limit),
        AnyScene::Space(scene) => of(periodic, &scene.widened(), arithmetic, chosen, limit),
    }
}

fn of<const D: usize>(
    periodic: &Periodic<'_>,
    scene: &Scene<'_, f64, D>,
    arithmetic: Arithmetic,
    chosen: Option<&[bool]>,
    limit: u64,
) -> Result<Vec<ImagePair>, NoTruth>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    if !arithmetic.is_exact() {
        return particles(periodic, scene, arithmetic, arithmetic.test(), limit);
    }
    let frame = ReducedBox::new(periodic.lattice())?;
    if chosen.is_none() && scene.len() > BRUTE_FORCE {
        let n = scene.len();
        let ask = |detector: &mut dyn AnyDetector| {
            let mut contacts = ContactList::default();
            Finder::new(limit).list(periodic, detector, arithmetic, &mut contacts)?;
            Ok((contacts.digest(), contacts))
        };
        let sorted = |contacts: ContactList| contacts.sorted(n, limit);
        let tested =
            |chosen: &[bool]| Ok(tested(scene, &frame, Some(chosen), arithmetic.test(), limit)?);
        let agreed = agreed_by(n, &table::judges(), limit, ask, sorted, tested, |p| [p.i, p.j])?;
        return agreed.ok_or(NoTruth::TooLarge { n });
    }
    Ok(tested(scene, &frame, chosen, arithmetic.test(), limit)?)
}

/// Tests the pairs of the open scene that detectors get, as it is stored.
fn particles<const D: usize>(
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

/// Tests all pairs, or only pairs with a chosen particle, and returns contacts in ascending order.
fn tested<const D: usize>(
    scene: &Scene<'_, f64, D>,
    frame: &ReducedBox<D>,
    chosen: Option<&[bool]>,
    test: Test,
    limit: u64,
) -> Result<Vec<ImagePair>, Refusal> {
    let n = scene.len();
    let reach = 2.0 * scene.largest_radius();
    if frame.periodic.contains(&true) && reach == f64::INFINITY {
        return Err(Refusal::Range);
    }
    let mut tests = Tests { scene, frame, test, reach, limit, images: 0.0, list: List::new(limit) };
    match chosen {
        None => (0..n).try_for_each(|i| (i..n).try_for_each(|j| tests.pair(i, j)))?,
        Some(chosen) => tests.chosen(chosen)?,
    }
    tests.list.end(n)
}

/// Tests of pairs in a periodic scene, and the contacts found so far.
struct Tests<'a, const D: usize> {
    scene: &'a Scene<'a, f64, D>,
    frame: &'a ReducedBox<D>,
    test: Test,
    /// Largest distance of two particles that touch.
    reach: f64,
    limit: u64,
    /// Number of images tested so far.
    images: f64,
    list: List,
}

impl<const D: usize> Tests<'_, D> {
    fn at(&self, index: usize) -> [f64; D] {
        *array(&self.scene.centres()[index])
    }

    /// Tests a pair with all images within reach.
    fn pair(&mut self, i: usize, j: usize) -> Result<(), Refusal> {
        let (scene, frame, a, b) = (self.scene, self.frame, self.at(i), self.at(j));
        let sum = scene.radius(i) + scene.radius(j);
        let ranges = around(frame, [i, j], &a, &b, sum)?;
        self.images += ranges.map(|[low, high]| f64::from(high - low + 1)).iter().product::<f64>();
        // The limit is 8 images per pair, although most pairs have no image in reach, and 16 per
        // contact that fits in memory. The tested images fill a box around a sphere, which takes
        // half of it, or much less if the box is skewed.
        let (n, images, limit) = (scene.len() as f64, self.images, self.limit);
        if images > 8.0 * n * n + 16.0 * (limit / IMAGE_PAIR_BYTES) as f64 {
            let needed = images * IMAGE_PAIR_BYTES as f64;
            let (particles, reach) = (scene.len() as u64, self.reach);
            return Err(Refusal::Images { particles, images, reach, needed, limit });
        }
        let pair = [i as u32, j as u32];
        for_all(ranges, |image| {
            let Ok(given) = frame.given(image) else { return };
            if i == j && image <= [0; 3] || apart(frame, &a, &b, given, sum) {
                return;
            }
            let shift = Shift { image: given, vectors: &frame.vectors };
            if touches(scene, pair, shift, self.test) {
                self.list.push(ImagePair::new(pair[0], pair[1], given));
            }
        });
        Ok(())
    }

    /// Tests each pair that has a chosen particle, unless the two are certainly apart.
    fn chosen(&mut self, chosen: &[bool]) -> Result<(), Refusal> {
        let (frame, few) = (self.frame, numbers(chosen));
        let fractions = |x: &[f64; D]| -> [f64; 3] {
            fill(|v| {
                let fraction = frame.fraction(v, x);
                fraction - fraction.floor()
            })
        };
        let mut most = [0.0f64; D];
        for j in 0..chosen.len() {
            most = fill(|k| most[k].max(self.at(j)[k].abs()));
        }
        let most: [f64; 3] = fill(|v| frame.most(v, &most));
        let (coupling, _) =
            frame.coupling(most.map(|most| 4.0 * most), self.reach * (1.0 + 4.0 * U));
        let margin = fill(|v| match frame.periodic[v] {
            true => {
                let rounding = 32.0 * U * (most[v] + 1.0);
                frame.lengths[v] * self.reach * (1.0 + 16.0 * U) + rounding + coupling[v]
            }
            false => f64::INFINITY,
        });
        let places: Vec<[f64; 3]> = few.iter().map(|&k| fractions(&self.at(k as usize))).collect();
        let sieve = Sieve::new(&places, margin, [None; 3]);
        for (j, &one_of_them) in chosen.iter().enumerate() {
            let mut result = Ok(());
            sieve.near(&fractions(&self.at(j)), |k| {
                let i = few[k] as usize;
                // A pair of two chosen particles is tested once.
                if result.is_ok() && !(one_of_them && j < i) {
                    result = self.pair(i.min(j), i.max(j));
                }
            });
            result?;
        }
        Ok(())
    }
}

/// Returns the lowest and the highest S to be tested along each vector.
fn around<const D: usize>(
    frame: &ReducedBox<D>,
    [i, j]: [usize; 2],
    a: &[f64; D],
    b: &[f64; D],
    sum: f64,
) -> Result<[[i32; 2]; 3], Refusal> {
    let difference: [f64; D] = fill(|k| a[k] - b[k]);
    let magnitude: [f64; D] = fill(|k| a[k].abs() + b[k].abs());
    let fractions: [f64; 3] = fill(|v| frame.fraction(v, &difference));
    let errors: [f64; 3] = fill(|v| 16.0 * U * frame.most(v, &magnitude));
    let spread = fill(|v| fractions[v].abs() + errors[v]);
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

/// Returns whether the image is certainly too far away along some axis.
fn apart<const D: usize>(
    frame: &ReducedBox<D>,
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
        // If a term overflows, nothing is decided: infinity minus infinity is NaN.
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
