//! How a contact list that differs from the truth may be meant, so that it agrees: other numbers,
//! pairs from both sides, rounding, a skin, other radii, a periodic box.

pub mod words;

use crate::check::listed::{Meaning, Naming, pair_depth, pair_gap, particle};
use crate::contact::{Arithmetic, Test};
use crate::detect::{Options, table};
use crate::oracle::{self, Errors};
use crate::scene::{AnyScene, Radii, Real, Scene, array};
use crate::sink::normalise;
use crate::with_scene;

/// Pairs apart by more than this, in mean radii, are not of a skin.
pub(super) const FAR: f64 = 2.5;
/// Differences below this, in mean radii, may be rounding of f32.
pub(super) const ROUNDED: f64 = 1e-3;
/// Couples within this of just touching, in mean radii, are tangent to the last digits.
pub(super) const TANGENT: f64 = 1e-9;
/// So many pairs at least before a periodic box is guessed that the file does not declare.
const ENOUGH: usize = 3;

/// A way to read a list, and what differs all the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// What the numbers mean.
    pub meaning: Meaning,
    /// Every pair stands there as i,j and as j,i.
    pub both_sides: bool,
    /// What else explains pairs that differ.
    pub deviation: Option<Deviation>,
    /// Lengths of a periodic box along the axes that pairs reach across; none along the others.
    pub periodic: Option<Vec<Option<f64>>>,
    /// The box that the file declares repeats along these axes.
    pub declared: Option<[bool; 3]>,
    /// Which images are named, where the list has any.
    pub images: ImagesOf,
    /// What of the box the list knows.
    pub taken: TakenBox,
    /// Pairs of the list, each once.
    pub listed: u64,
    /// Pairs that differ all the same.
    pub wrong: u64,
}

/// What the images of a list are images of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ImagesOf {
    /// The second particle, as it should be.
    #[default]
    Second,
    /// The first particle.
    First,
    /// The second one, counted from where both are when they are put into the box.
    Wrapped,
    /// Nothing: without them the pairs agree.
    LeftOut,
}

/// What of a box a list knows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TakenBox {
    /// All of it.
    #[default]
    All,
    /// Nothing: boundaries are open.
    Open,
    /// All but contacts of particles with their own images.
    WithoutOwn,
    /// The nearest image of each pair.
    Nearest,
    /// That it repeats along these axes.
    Along([bool; 3]),
    /// Its edges, and not its tilt.
    Straight([f64; 3]),
}

impl Reading {
    /// As it stands.
    pub(super) fn plain(meaning: Meaning) -> Reading {
        Reading {
            meaning,
            both_sides: false,
            deviation: None,
            periodic: None,
            declared: None,
            images: ImagesOf::default(),
            taken: TakenBox::default(),
            listed: 0,
            wrong: 0,
        }
    }
}

/// How the list's idea of contact differs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Deviation {
    /// It is what this arithmetic decides.
    Rounded(Arithmetic),
    /// It lacks the pairs that touch in one point.
    Strict,
    /// All that differ are tangent to the last digits.
    Tangent,
    /// All pairs up to this gap, a length, are there.
    Skin(f64),
    /// It is that of radii this many times as large.
    Radii(f64),
}

/// The reading with the fewest pairs that differ; none if it is not better by half than the first
/// naming as it stands. `truth` is in ascending order; `bounds` is the box that the file declares.
pub(super) fn explain(
    scene: &AnyScene<'_>,
    list: &[[i64; 2]],
    namings: &[&Naming],
    truth: &[[u32; 2]],
    arithmetic: Arithmetic,
    bounds: Option<&[[f64; 2]]>,
) -> anyhow::Result<Option<Reading>> {
    let readings = namings.iter().enumerate().map(|(k, naming)| {
        let (mut reported, unknown) = naming.apply(list, scene.len())?;
        let both_sides = from_both_sides(&reported);
        normalise(&mut reported);
        let errors = oracle::compare(&reported, truth, scene);
        let both_sides = both_sides && errors.duplicate > 0;
        reported.dedup();
        let as_given = errors.wrong() + unknown.len() as u64;
        let wrong = as_given - if both_sides { errors.duplicate } else { 0 };
        Ok((wrong, k, as_given, both_sides, reported, errors, unknown.len() as u64))
    });
    let readings = readings.collect::<anyhow::Result<Vec<_>>>()?;
    let given = readings.first().map(|reading| reading.2);
    let best = readings.into_iter().min_by_key(|reading| (reading.0, reading.1));
    let Some((given, (wrong, k, _, both_sides, reported, errors, unknown))) = given.zip(best)
    else {
        return Ok(None);
    };
    let mut reading = Reading {
        both_sides,
        listed: if both_sides { list.len() as u64 / 2 } else { list.len() as u64 },
        wrong,
        ..Reading::plain(namings[k].meaning())
    };
    if errors.missed + errors.spurious > 0 {
        let found = Differences::new(scene, &reported, truth, arithmetic);
        reading.deviation = found.deviation();
        reading.periodic = found.periodic(bounds, reading.deviation);
        // What is left is wrong in other ways.
        let Errors { duplicate, self_pairs, .. } = errors;
        let others = self_pairs + unknown + if both_sides { 0 } else { duplicate };
        let near = if reading.deviation.is_some() { 0 } else { found.near() };
        let far = if reading.periodic.is_some() { 0 } else { found.far.len() as u64 };
        reading.wrong = others + near + far;
    }
    Ok((reading.wrong < given.div_ceil(2)).then_some(reading))
}

/// Is every pair there exactly twice, once from each side?
pub(super) fn from_both_sides<T: Copy + Ord>(pairs: &[[T; 2]]) -> bool {
    let mut sorted = pairs.to_vec();
    let mut turned: Vec<[T; 2]> = pairs.iter().map(|&[i, j]| [j, i]).collect();
    sorted.sort_unstable();
    turned.sort_unstable();
    sorted == turned && sorted.windows(2).all(|pair| pair[0] != pair[1])
}

type Pair = [u32; 2];

/// Pairs on which list and truth differ.
struct Differences<'a> {
    scene: &'a AnyScene<'a>,
    truth: &'a [Pair],
    arithmetic: Arithmetic,
    /// The list without the far ones, ascending.
    listed: Vec<Pair>,
    /// With the overlap in mean radii.
    missed: Vec<(Pair, f64)>,
    /// Listed, apart, but not far; with the depth, which is negative.
    apart: Vec<(Pair, f64)>,
    /// Listed and far apart.
    far: Vec<Pair>,
}

impl<'a> Differences<'a> {
    fn new(
        scene: &'a AnyScene<'a>,
        reported: &[Pair],
        truth: &'a [Pair],
        arithmetic: Arithmetic,
    ) -> Differences<'a> {
        let deep = |pair: Pair| (pair, pair_depth(scene, pair));
        let only = |these: &[Pair], those: &[Pair]| -> Vec<(Pair, f64)> {
            let lacks = |pair: &Pair| pair[0] != pair[1] && those.binary_search(pair).is_err();
            these.iter().copied().filter(lacks).map(deep).collect()
        };
        let missed = only(truth, reported);
        let (apart, far): (Vec<_>, Vec<_>) =
            only(reported, truth).into_iter().partition(|(_, depth)| -depth <= FAR);
        let far: Vec<Pair> = far.into_iter().map(|(pair, _)| pair).collect();
        let near = |pair: &Pair| pair[0] != pair[1] && far.binary_search(pair).is_err();
        let listed = reported.iter().copied().filter(near).collect();
        Differences { scene, truth, arithmetic, listed, missed, apart, far }
    }

    fn near(&self) -> u64 {
        (self.missed.len() + self.apart.len()) as u64
    }

    fn deviation(&self) -> Option<Deviation> {
        let sizes = || self.missed.iter().chain(&self.apart).map(|(_, depth)| depth.abs());
        if self.near() == 0 || self.listed.is_empty() {
            return None;
        }
        let most = sizes().fold(0.0, f64::max);
        if most < ROUNDED && self.arithmetic == Arithmetic::Exact {
            let agrees = |arithmetic| {
                oracle::truth(self.scene, arithmetic).is_ok_and(|truth| truth.pairs == self.listed)
            };
            for arithmetic in [Arithmetic::F64, Arithmetic::F32] {
                if agrees(arithmetic) {
                    return Some(Deviation::Rounded(arithmetic));
                }
            }
        }
        let tie = |pair: &Pair| pair[0] != pair[1] && pair_depth(self.scene, *pair) == 0.0;
        if most == 0.0 && !self.listed.iter().any(tie) {
            return Some(Deviation::Strict);
        }
        if most < TANGENT {
            return Some(Deviation::Tangent);
        }
        if self.missed.is_empty() { self.larger() } else { self.smaller() }
    }

    /// Everything up to some gap is listed.
    fn larger(&self) -> Option<Deviation> {
        let count = |wider: &dyn Fn(f64) -> f64, within: &dyn Fn(Pair) -> bool| {
            touching(self.scene, wider)
                .map(|pairs| pairs.into_iter().filter(|&p| within(p)).count())
        };
        let deepest = self.apart.iter().fold(0.0f64, |most, (_, depth)| most.max(-depth));
        // The depth is 2(1 - d/s): a gap of two mean radii is a distance of twice the radii.
        let scaled = |by: f64| {
            let within = |pair: Pair| -pair_depth(self.scene, pair) <= 2.0 * (by - 1.0);
            count(&|r| r * by * (1.0 + 1e-9), &within) == Some(self.listed.len())
        };
        if deepest > 1.5 && scaled(2.0) {
            return Some(Deviation::Radii(2.0));
        }
        let gap = self.apart.iter().fold(0.0f64, |m, (pair, _)| m.max(pair_gap(self.scene, *pair)));
        let within = |pair: Pair| pair_gap(self.scene, pair) <= gap;
        if count(&|r| (r + gap / 2.0) * (1.0 + 1e-9), &within) == Some(self.listed.len()) {
            return Some(Deviation::Skin(gap));
        }
        let by = 1.0 + deepest / 2.0;
        scaled(by).then_some(Deviation::Radii(by))
    }

    /// Only the deeper ones are listed.
    fn smaller(&self) -> Option<Deviation> {
        if !self.apart.is_empty() {
            return None;
        }
        let depths: Vec<f64> = self.truth.iter().map(|&p| pair_depth(self.scene, p)).collect();
        let deeper = |least: f64| depths.iter().filter(|&&depth| depth >= least).count();
        if deeper(1.0) == self.listed.len() {
            return Some(Deviation::Radii(0.5));
        }
        let listed = self.listed.iter().map(|&pair| pair_depth(self.scene, pair));
        let least = listed.fold(f64::INFINITY, f64::min);
        (deeper(least) == self.listed.len()).then_some(Deviation::Radii(1.0 - least / 2.0))
    }

    /// Do all far pairs touch across a box? Where the file declares none, it is the longest in
    /// which all of them do.
    fn periodic(
        &self,
        bounds: Option<&[[f64; 2]]>,
        deviation: Option<Deviation>,
    ) -> Option<Vec<Option<f64>>> {
        let dim = self.scene.dim();
        if self.far.is_empty() || bounds.is_none() && self.far.len() < ENOUGH {
            return None;
        }
        let skin = if let Some(Deviation::Skin(gap)) = deviation { gap } else { 0.0 };
        let extents = extents(self.scene);
        let declared = |k: usize| bounds.and_then(|bounds| bounds.get(k));
        let least = |k: usize| match declared(k) {
            Some([low, high]) => [high - low; 2],
            None => [extents[k], f64::INFINITY],
        };
        let mut lengths: Vec<[f64; 2]> = (0..dim).map(least).collect();
        let mut across = vec![false; dim];
        for &[i, j] in &self.far {
            let ((a, ra), (b, rb)) = (particle(self.scene, i), particle(self.scene, j));
            let reach = (ra + rb + skin) * (1.0 + 1e-9);
            let apart: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).collect();
            // Along the other axes the two are near each other as they stand.
            let beside: f64 = apart.iter().filter(|&&x| x <= reach).map(|x| x * x).sum();
            let square = reach * reach - beside;
            if square < 0.0 || apart.iter().all(|&x| x <= reach) {
                return None;
            }
            for k in (0..dim).filter(|&k| apart[k] > reach) {
                let [low, high] = lengths[k];
                let low = low.max(apart[k] - square.sqrt());
                let high = high.min(apart[k] + square.sqrt());
                if low > high {
                    return None;
                }
                across[k] = true;
                if declared(k).is_none() {
                    lengths[k] = [low, high];
                }
            }
        }
        // In a shorter box more pairs would touch than are listed.
        let length = |k: usize| {
            let [low, high] = lengths[k];
            across[k].then(|| if declared(k).is_some() { high } else { short(low, high) })
        };
        Some((0..dim).map(length).collect())
    }
}

/// The number in that range with the fewest digits, the largest of them.
fn short(low: f64, high: f64) -> f64 {
    let power = high.abs().log10().floor() as i32;
    let rounded = |digits: i32| {
        let step = 10f64.powi(power - digits);
        format!("{:.*e}", digits as usize, (high / step).floor() * step).parse().unwrap_or(high)
    };
    (0..16).map(rounded).find(|&x| low <= x && x <= high).unwrap_or(high)
}

/// How far the centres reach along each axis.
fn extents(scene: &AnyScene<'_>) -> Vec<f64> {
    with_scene!(scene, scene => {
        let dim = scene.centres().first().map_or(0, |point| array(point).len());
        let along = |k: usize| scene.centres().iter().map(move |point| array(point)[k].wide());
        let extent = |k| {
            along(k).fold(f64::NEG_INFINITY, f64::max) - along(k).fold(f64::INFINITY, f64::min)
        };
        (0..dim).map(extent).collect()
    })
}

/// The pairs that touch with other radii; none if no detector takes that scene.
fn touching(scene: &AnyScene<'_>, radius: &dyn Fn(f64) -> f64) -> Option<Vec<Pair>> {
    with_scene!(scene, scene => {
        let scene = scene.widened();
        let radii = (0..scene.len()).map(|k| radius(scene.radius(k))).collect();
        let wider = Scene::new(scene.centres().to_vec(), Radii::Each(radii)).ok()?;
        let mut pairs = Vec::new();
        let mut detector = table::robust(Options::default());
        detector.list(&wider.into(), Test::Exact, &mut pairs).ok()?;
        normalise(&mut pairs);
        Some(pairs)
    })
}
