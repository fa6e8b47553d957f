//! Tests of whole detectors on isolated pairs, in open space and in periodic boxes.
//!
//! ```text
//!      |         |         |         |     open space: borders at low + m·reach (a textbook grid)
//!      |         |  b......a         |     and low + m·reach / (1 - 2^-18) (this project): a
//!      |         |         |         |     within an ulp of one of them, pairs six cells apart
//!
//!   +-----.-----------.-----+     every pair has its own site, six reaches from the next one, also
//!   |                 b     |     through the faces, so nothing else touches; the first sites are
//!   a           a           a     on the faces; then particles are replaced by other images, up to
//!   |            b          |     many boxes away, and the vectors by others of the same lattice
//!   +-----.-----------------+
//! ```
//!
//! In small boxes the gaps of all pairs and images are computed in 128-bit integers.

use std::cmp::Ordering;

use contactbench_detectors::oracle::boxes;
use contactbench_detectors::spec::DetectorSpec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::periodic;
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic};
use contactbench_ground::probe::{Op, Tally};
use contactbench_lists::periodic::Finder;

use crate::draw::{Draw, Sphere};
use crate::near::Lengths;
use crate::predicate::{FAR, OFFSETS};
use crate::tracking::right;
use crate::whole::Whole;
use crate::{Counts, Plan, Totals, What, in_batches};

const LIMIT: u64 = 1 << 28;
/// Distance between pairs, in reaches (largest sums of two radii).
const PITCH: i64 = 6;
/// Interval, in scenes of a row, at which detectors also run in the rounded arithmetics, and the
/// library's truth is compared with the construction. It includes the first scene.
const ALSO: usize = 8;
/// Number of box vectors between a particle and the image that represents it.
const AWAY: [f64; 3] = [0.0, 1e3, 1e6];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    Open,
    Straight,
    /// Vectors in lower triangular form; each is tilted by up to a whole edge of the others.
    Tilted,
    /// Other vectors of the lattice of `Tilted`, which are long and nearly coplanar.
    Skewed,
    /// Edges smaller than the reach; vectors are tilted, skewed, or neither.
    Small,
}

pub fn detectors(plan: Plan) -> Totals {
    rows(plan, &[(Shape::Open, "borders")], &OFFSETS)
}

pub fn boxes(plan: Plan) -> Totals {
    let shapes = [
        (Shape::Straight, "straight boxes"),
        (Shape::Tilted, "tilted boxes"),
        (Shape::Skewed, "skewed boxes"),
        (Shape::Small, "small boxes"),
    ];
    rows(plan, &shapes, &AWAY)
}

fn rows(plan: Plan, shapes: &[(Shape, &str)], places: &[f64]) -> Totals {
    let (plane, space) = (Sphere::<2>::made(), Sphere::<3>::made());
    let mut rows = Vec::new();
    for dim in [2, 3] {
        rows.extend(
            shapes.iter().flat_map(|&shape| places.iter().map(move |&at| (shape, dim, at))),
        );
    }
    in_batches(plan, 2 * rows.len(), |piece| {
        let (((shape, name), dim, away), index) = (rows[piece % rows.len()], piece / rows.len());
        let draw = &mut Draw::new(plan.seed, 1 << 62 | (shape as u64) << 56 | piece as u64);
        let counts = match dim {
            2 => Setting { sphere: &plane, shape, away }.run(index, draw),
            _ => Setting { sphere: &space, shape, away }.run(index, draw),
        };
        let mut table = Totals::default();
        table.add(name, &format!("{dim}D {away:e}"), counts);
        table
    })
}

struct Setting<'a, const D: usize> {
    sphere: &'a Sphere<D>,
    shape: Shape,
    /// In open space: the offset from the origin, in diameters. In boxes: how many box vectors away
    /// the image that represents a particle may be. If it is 0, only adjacent images are used, and
    /// coordinates use all bits of an f64.
    away: f64,
}

impl<const D: usize> Setting<'_, D> {
    /// Returns lower triangular vectors of about these lengths; a random part of them is periodic.
    fn lattice(&self, edges: [i64; D], tilted: bool, draw: &mut Draw) -> Whole<D> {
        let mut whole = Whole::default();
        for v in 0..D {
            whole.vectors[v][v] = edges[v] + draw.bit();
            let below = if tilted { v } else { 0 };
            for (entry, &edge) in whole.vectors[v][..below].iter_mut().zip(&edges) {
                *entry = match draw.below(3) {
                    0 => draw.bit(),
                    1 => edge / 2 + draw.bit(),
                    _ => draw.below(edge),
                };
            }
            whole.periodic[v] = !draw.once_in(4);
        }
        whole.periodic[draw.axis::<D>()] = true;
        whole
    }

    /// Returns the largest coordinate in a box at which doubles can hold its images and vectors.
    fn room(&self) -> f64 {
        let bits = if self.shape == Shape::Skewed { 46 } else { 53 };
        (1i64 << bits) as f64 / (3.0 * self.away + 1.0)
    }

    /// Builds a scene in open space with a pair at every site.
    fn on_borders(&self, index: usize, draw: &mut Draw) -> Whole<D> {
        let sites: i64 = if D == 2 { 12 } else { 5 };
        let cells = PITCH * (sites + 1);
        let about_zero = self.away == 0.0;
        let room = match about_zero {
            true => (1i64 << 54) as f64 / (cells + 1) as f64,
            false => FAR as f64 / self.away,
        };
        let lengths = Lengths::new(self.sphere, room, index % 2 == 1, draw);
        let reach = lengths.reach;
        let low = if about_zero { -cells * reach / 2 } else { FAR };
        let mut whole = Whole { fine: lengths.fine, ..Whole::default() };
        // The two corners have separate particles.
        whole.points.extend([[low; D], [low + cells * reach; D]]);
        whole.radii.extend([reach << lengths.fine; 2]);
        for site in 0..sites.pow(D as u32) {
            let a = std::array::from_fn(|k| {
                let m = PITCH * (site / sites.pow(k as u32) % sites) + 3;
                low + match draw.below(4) {
                    0 => m * reach + draw.below(reach),
                    1 => m * reach + draw.within(1),
                    _ => margin(m * reach) + draw.within(1),
                }
            });
            whole.pair(a, lengths.near(draw));
        }
        whole
    }

    /// Builds a scene in a box with a pair at every site.
    fn at_sites(&self, index: usize, draw: &mut Draw) -> Whole<D> {
        let most = if D == 2 { [1, 6, 10] } else { [1, 3, 4] };
        let sites: i64 = most[index % 3];
        let room = self.room() / (PITCH * (sites + 1)) as f64;
        let lengths = Lengths::new(self.sphere, room, index / 3 % 2 == 1, draw);
        let (reach, edge) = (lengths.reach, PITCH * lengths.reach);
        let mut whole = self.lattice([sites * edge; D], self.shape != Shape::Straight, draw);
        whole.fine = lengths.fine;
        for site in 0..sites.pow(D as u32) {
            let a = std::array::from_fn(|k| {
                let side = draw.sign();
                let beside = match draw.below(4) {
                    0 => draw.within(1),
                    1 => side * reach + draw.within(1),
                    // This is the distance from a face within which particles need images.
                    2 => side * margin(reach) + draw.within(1),
                    _ => draw.within(reach),
                };
                site / sites.pow(k as u32) % sites * edge + beside
            });
            // The first pair has the largest radii, because small particles alone would make too
            // many cells.
            let sizes = lengths.sizes && site > 0;
            whole.pair(a, Lengths { sizes, ..lengths }.near(draw));
        }
        whole
    }

    /// Builds one to three particles in a box whose edges are a fifth or a third of the reach, so
    /// that many images are exactly at the reach.
    fn few(&self, index: usize, draw: &mut Draw) -> Whole<D> {
        let parts = if D == 2 { 5 } else { 3 };
        let (turn, one_size) = (index % 3, (index / 3).is_multiple_of(2));
        let edge = (self.room() / 8.0 * (1.0 - 0.3 * draw.unit())) as i64 / 2 * 2;
        let mut whole = self.lattice([edge; D], turn > 0 && draw.once_in(2), draw);
        let reach = parts * edge;
        whole.fine = reach.leading_zeros() as i32 - 11;
        for k in 0..=turn {
            whole.points.push(std::array::from_fn(|_| match draw.below(3) {
                0 => draw.bit(),
                1 => edge / 2 + draw.bit(),
                _ => draw.below(edge),
            }));
            // Radii are equal, or have sums that are multiples of edges.
            let part = if one_size || k == 0 { parts } else { draw.below(parts) };
            let more = if one_size { 0 } else { draw.bit() };
            whole.radii.push((((part * edge) << whole.fine) + more).abs());
        }
        whole.meet();
        whole
    }

    /// Builds scene number `index` with its contacts, and returns it with the exponent of its unit.
    fn scene(&self, index: usize, draw: &mut Draw) -> (Whole<D>, i32) {
        let mut whole = match self.shape {
            Shape::Open => self.on_borders(index, draw),
            Shape::Small => self.few(index, draw),
            _ => self.at_sites(index, draw),
        };
        if self.shape != Shape::Open {
            whole.name_other_images(self.away as i64, draw);
        }
        if self.shape == Shape::Skewed || self.shape == Shape::Small && index % 3 > 1 {
            whole.take_other_vectors(draw);
        }
        whole.shuffle(draw);
        (whole, draw.exponent(index as i64 % 4, 400))
    }

    fn run(&self, index: usize, draw: &mut Draw) -> Counts {
        let mut counts = Counts::default();
        let (whole, exponent) = self.scene(index, draw);
        let Some(periodic) = whole.periodic(exponent, draw) else {
            counts.add(What::Refused, 1);
            return counts;
        };
        let expected = whole.expected();
        for (_, truth) in &expected {
            counts.add([What::Overlap, What::Tangent, What::Apart][(*truth as i8 + 1) as usize], 1);
        }
        let also = index.is_multiple_of(ALSO);
        if also {
            counts += library(&periodic, &expected);
        }
        let mut finder = Finder::new(LIMIT);
        let mut detectors = all();
        let mut compare = |detector: &mut dyn AnyDetector, arithmetic, expected: &[_]| {
            compare(detector, &mut finder, &periodic, arithmetic, expected)
        };
        for (name, detector) in &mut detectors {
            counts += compare(&mut **detector, Arithmetic::Exact, &expected);
            if *name == "nbs" {
                let rounded = compare(&mut **detector, Arithmetic::F64, &expected);
                counts.add(What::Rounded, expected.len() as u64);
                counts.add(What::RoundedWrong, rounded.errors());
            }
        }
        for arithmetic in Arithmetic::SAFE.into_iter().filter(|&a| also && a != Arithmetic::Exact) {
            // Scenes that f32 cannot store are skipped.
            let Ok(truth) = boxes::truth(&periodic, arithmetic, LIMIT) else { continue };
            let touching: Vec<_> =
                truth.pairs.into_iter().map(|pair| (pair, Ordering::Less)).collect();
            for (_, detector) in &mut detectors {
                counts += compare(&mut **detector, arithmetic, &touching);
            }
        }
        counts
    }
}

/// Returns the cell border of this project that corresponds to the textbook's border at `x`.
fn margin(x: i64) -> i64 {
    (i128::from(x) * (1 << 18) / ((1 << 18) - 1)) as i64
}

/// Returns the detectors whose answers must be right, in every variant, without twins.
fn all() -> Vec<(String, Box<dyn AnyDetector>)> {
    let choices = right().flat_map(DetectorSpec::choices);
    choices.map(|spec| (spec.to_string(), spec.make(Options::default()))).collect()
}

/// Compares the library's truth and depths with the construction.
fn library(periodic: &Periodic<'_>, expected: &[(ImagePair, Ordering)]) -> Counts {
    let mut counts = Counts::default();
    let touching: Vec<ImagePair> =
        expected.iter().filter(|(_, truth)| truth.is_le()).map(|(pair, _)| *pair).collect();
    match boxes::truth(periodic, Arithmetic::Exact, LIMIT) {
        Ok(truth) => counts.add(What::Label, u64::from(truth.pairs != touching)),
        Err(_) => counts.add(What::Refused, 1),
    }
    for (pair, truth) in expected {
        let depth = periodic::depth(periodic, *pair);
        counts.add(What::Depth, u64::from(0.0f64.partial_cmp(&depth) != Some(*truth)));
    }
    counts
}

fn compare(
    detector: &mut dyn AnyDetector,
    finder: &mut Finder,
    periodic: &Periodic<'_>,
    arithmetic: Arithmetic,
    expected: &[(ImagePair, Ordering)],
) -> Counts {
    let (mut counts, mut tally) = (Counts::default(), Tally::default());
    let mut contacts = ContactList::default();
    let found = finder.find(periodic, detector, arithmetic, Some(&mut tally), &mut contacts);
    counts.add(What::Refused, u64::from(found.is_err()));
    counts.add(What::Pairs, expected.len() as u64);
    counts.add(What::Exact, tally.get(Op::ExactTest));
    let mut seen = vec![0u64; expected.len()];
    for pair in periodic::without_shift(&contacts.plain).chain(contacts.shifted) {
        match expected.binary_search_by_key(&pair, |(pair, _)| *pair) {
            Ok(place) if expected[place].1.is_le() => seen[place] += 1,
            _ if pair.i == pair.j && pair.image == [0; 3] => counts.add(What::Itself, 1),
            _ => counts.add(What::Spurious, 1),
        }
    }
    for ((_, truth), seen) in expected.iter().zip(seen) {
        counts.add(What::Missed, u64::from(truth.is_le() && seen == 0));
        counts.add(What::Duplicate, seen.saturating_sub(1));
    }
    counts
}
