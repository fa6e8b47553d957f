//! The second part: whole detectors on scenes of isolated near-tangent couples that sit on the
//! borders of cells.
//!
//! ```text
//!      |         |         |         |         |         |         |         |         |
//!      |         |  b......a         |         |         |        .a......b  |         |
//!      |         |         |         |         |         |         |         |         |
//!   borders at low + m·reach (a textbook grid) and low + m·reach / (1 - 2^-18) (ours): a within
//!   one ulp of one of them, five cells from one couple to the next, so that nothing else touches
//! ```

use std::cmp::Ordering;

use contactbench_core::contact::Test;
use contactbench_core::detect::Options;
use contactbench_core::detect::any::AnyDetector;
use contactbench_core::detect::spec::DetectorSpec;
use contactbench_core::detect::table::{Role, TABLE};
use contactbench_core::probe::{Op, Tally};
use contactbench_core::scene::{AnyScene, Radii, Scene};
use contactbench_core::sink::Visit;
use nalgebra::Point;

use super::counts::{Counts, What};
use super::near::{Lengths, Near};
use crate::draw::{Draw, Sphere, power};

/// Every so many scenes of a row, the first included, a small one is given to the detectors that
/// test all pairs, too.
pub const SMALL: u64 = 64;
/// Cells from couple to couple.
const PITCH: i64 = 5;

/// Sites per axis.
fn sites<const D: usize>(small: bool) -> i64 {
    match (D, small) {
        (2, false) => 40,
        (2, true) => 12,
        (_, false) => 12,
        (_, true) => 5,
    }
}

/// Couples in a scene that is not small.
pub fn couples<const D: usize>() -> u64 {
    sites::<D>(false).pow(D as u32) as u64
}

/// Detectors that must be right, in every form of their code; the twin is the same code again.
pub fn detectors(small: bool) -> Vec<(String, Box<dyn AnyDetector>)> {
    TABLE
        .iter()
        .filter(|entry| {
            entry.must_be_right()
                && !matches!(entry.role, Role::Twin(_))
                && (small || entry.name != "direct")
        })
        .flat_map(DetectorSpec::choices)
        .map(|spec| (spec.to_string(), spec.make(Options::default())))
        .collect()
}

/// Isolated couples: particle i belongs to couple `couple_of[i]`.
struct Couples<const D: usize> {
    scene: Scene<'static, f64, D>,
    couple_of: Vec<usize>,
    truths: Vec<Ordering>,
    exponent: i32,
}

/// What the scenes of one row have in common.
pub struct Row<'a, const D: usize> {
    pub sphere: &'a Sphere<D>,
    /// In diameters; 0: about the origin, as many bits as there are.
    pub offset: f64,
    /// Couples of several sizes; else one radius for all.
    pub sizes: bool,
}

impl<const D: usize> Row<'_, D> {
    fn couples(&self, index: u64, draw: &mut Draw) -> Option<Couples<D>> {
        let sites = sites::<D>(index.is_multiple_of(SMALL));
        let cells = PITCH * (sites + 1);
        let room = if self.offset == 0.0 {
            (1i64 << 54) as f64 / (cells + 1) as f64
        } else {
            (1i64 << 52) as f64 / self.offset
        };
        let lengths = Lengths::new(self.sphere, room, self.sizes, draw);
        let (reach, fine) = (lengths.reach, lengths.fine);
        let low = if self.offset == 0.0 { -cells * reach / 2 } else { 1 << 52 };
        let exponent = match index % 4 {
            0 => -52,
            1 => 0,
            2 => draw.within(200) as i32,
            _ => draw.within(480) as i32,
        };
        // Two lone bodies hold the corners of the box.
        let (mut points, mut radii, mut truths) =
            (vec![[low; D], [low + cells * reach; D]], vec![reach << fine; 2], Vec::new());
        for site in 0..sites.pow(D as u32) {
            let a: [i64; D] = std::array::from_fn(|k| {
                let m = PITCH * (site / sites.pow(k as u32) % sites) + 3;
                low + match draw.below(4) {
                    0 => m * reach + draw.below(reach),
                    1 => m * reach + draw.within(1),
                    _ => {
                        (i128::from(m * reach) * (1 << 18) / ((1 << 18) - 1)) as i64
                            + draw.within(1)
                    }
                }
            });
            let Near { vector, radii: pair, truth } = lengths.near(draw);
            truths.push(truth);
            points.extend([a, std::array::from_fn(|k| a[k] + vector[k])]);
            radii.extend(pair);
        }
        let order = draw.order(points.len());
        let (unit, half) = (power(exponent), power(exponent - fine - 1));
        let centres: Vec<_> =
            order.iter().map(|&i| Point::from(points[i].map(|x| x as f64 * unit))).collect();
        let radii = if self.sizes {
            Radii::Each(order.iter().map(|&i| radii[i] as f64 * half).collect())
        } else {
            Radii::Uniform((reach << fine) as f64 * half)
        };
        // Particles 0 and 1 are the lone bodies; they are couple -1 of this numbering, which no
        // pair may belong to.
        let couple_of = order.iter().map(|&i| (i / 2).wrapping_sub(1)).collect();
        Some(Couples { scene: Scene::new(centres, radii).ok()?, couple_of, truths, exponent })
    }

    /// Gives scene number `index` to all detectors.
    pub fn run(&self, index: u64, test: Test, draw: &mut Draw) -> Counts
    where
        AnyScene<'static>: From<Scene<'static, f64, D>>,
    {
        let mut counts = Counts::default();
        let Some(Couples { scene, couple_of, truths, exponent }) = self.couples(index, draw) else {
            counts.add(What::Refused, 1);
            return counts;
        };
        for truth in &truths {
            counts.add([What::Overlap, What::Tangent, What::Apart][(*truth as i8 + 1) as usize], 1);
        }
        let scene = AnyScene::from(scene);
        for (name, mut detector) in detectors(index.is_multiple_of(SMALL)) {
            let found = compare(detector.as_mut(), &scene, test, &couple_of, &truths);
            counts += found;
            if name == "nbs" && exponent.abs() <= 200 {
                let rounded =
                    compare(detector.as_mut(), &scene, Test::Rounded, &couple_of, &truths);
                counts.add(What::Rounded, truths.len() as u64);
                counts.add(What::RoundedWrong, rounded.errors());
            }
        }
        counts
    }
}

/// One detection, every contact held to the labels.
fn compare(
    detector: &mut dyn AnyDetector,
    scene: &AnyScene<'_>,
    test: Test,
    couple_of: &[usize],
    truths: &[Ordering],
) -> Counts {
    let (mut counts, mut tally) = (Counts::default(), Tally::default());
    let mut seen = vec![0u64; truths.len()];
    let mut sink = Visit(|i: u32, j: u32| {
        let (i, j) = (i as usize, j as usize);
        let couple = couple_of[i];
        if i == j {
            counts.add(What::Itself, 1);
        } else if couple != couple_of[j] || truths.get(couple).is_none_or(|truth| truth.is_gt()) {
            counts.add(What::Spurious, 1);
        } else {
            seen[couple] += 1;
        }
    });
    let refused = detector.count(scene, test, &mut tally, &mut sink).is_err();
    counts.add(What::Refused, u64::from(refused));
    counts.add(What::Pairs, truths.len() as u64);
    counts.add(What::Exact, tally.get(Op::ExactTest));
    for (truth, seen) in truths.iter().zip(seen) {
        counts.add(What::Missed, u64::from(truth.is_le() && seen == 0));
        counts.add(What::Duplicate, seen.saturating_sub(1));
    }
    counts
}
