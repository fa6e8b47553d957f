//! Doubts about a file's particles and contacts: radii in another unit, diameters taken for radii,
//! particles written twice. Generated scenes raise no doubts. `inspect` and all other verbs print
//! the [`Notice`]s made here.

use std::collections::BTreeSet;

use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::detect::Options;
use contactbench_ground::limits::crowd;
use contactbench_ground::limits::memory::limit_for;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Visit;
use contactbench_ground::periodic;
use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_ground::scene::{AnyScene, Radii, Real, array};
use contactbench_ground::with_scene;
use contactbench_io::Given;
use contactbench_io::{Notice, RadiusSource};
use contactbench_lists::periodic::contacts;
use contactbench_streamed::streamed;

use crate::touching::particle;

/// Limit for the number of examined contacts, approximately. They are spread evenly over the list.
const EXAMINED: usize = 1 << 18;
/// If a list of all contacts would take more bytes than this, their number is estimated.
const MOST_BYTES: u64 = 400_000_000;
/// Least number of contacts whose mean overlap is judged.
const ENOUGH: u64 = 10;
/// Suspicious mean overlap, in mean radii. Packed particles overlap less; random ones 0.5 or more.
const DEEP: f64 = 0.25;
/// Overlap in mean radii above which pairs are nearly concentric. Concentric pairs overlap by 2.
const NESTED: f64 = 1.8;
/// Suspicious spacing of f32 coordinates, in mean radii.
const COARSE: f64 = 1e-3;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touching {
    /// Contacts per particle; estimated if there are too many to find.
    pub each: f64,
    /// Number of contacts; `None` if estimated.
    pairs: Option<u64>,
    examined: u64,
    /// Sum of the overlaps of examined pairs, in mean radii.
    overlap: f64,
    /// Number of nearly concentric pairs; `first` is one of them.
    nested: u64,
    first: [u32; 2],
    /// Particles with the same centre as an earlier particle.
    coincident: BTreeSet<u32>,
}

impl Touching {
    pub fn estimated(each: f64) -> Touching {
        Touching { each, ..Touching::default() }
    }

    pub fn open(scene: &AnyScene<'_>, pairs: &[[u32; 2]]) -> Touching {
        Touching::over(scene, pairs, |&pair| (pair, overlap(scene, pair)))
    }

    pub fn boxed(periodic: &Periodic<'_>, pairs: &[ImagePair]) -> Touching {
        let depth = |&pair: &ImagePair| ([pair.i, pair.j], periodic::depth(periodic, pair));
        Touching::over(periodic.scene(), pairs, depth)
    }

    fn over<P>(scene: &AnyScene<'_>, pairs: &[P], of: impl Fn(&P) -> ([u32; 2], f64)) -> Touching {
        let mut touching = Touching::default();
        for (pair, overlap) in pairs.iter().step_by(pairs.len() / EXAMINED + 1).map(of) {
            // In a small box a particle can touch its own image; such contacts are skipped.
            if pair[0] != pair[1] {
                touching.examine(scene, pair, overlap);
            }
        }
        touching.of(pairs.len(), scene)
    }

    /// Finds and examines the contacts; `None` if the detector refuses the scene.
    pub fn search(given: &Given) -> Option<Touching> {
        let scene = &given.scene;
        if let Err(Refusal::Crowd { each, .. }) = crowd::within(scene, MOST_BYTES) {
            return Some(Touching::estimated(each));
        }
        let memory_limit = limit_for(scene.len());
        let mut detector = streamed(None, None, Options { memory_limit, threads: 1 });
        if let Some(periodic) = given.periodic().ok()? {
            let exact = Arithmetic::Exact;
            let pairs = contacts(&periodic, &mut *detector, exact, memory_limit).ok()?;
            return Some(Touching::boxed(&periodic, &pairs));
        }
        let (mut touching, mut pairs) = (Touching::default(), 0);
        let mut sink = Visit(|i: u32, j: u32| {
            pairs += 1;
            if pairs <= EXAMINED {
                touching.examine(scene, [i.min(j), i.max(j)], overlap(scene, [i, j]));
            }
        });
        detector.visit(scene, Test::Exact, &mut sink).ok()?;
        Some(touching.of(pairs, scene))
    }

    fn examine(&mut self, scene: &AnyScene<'_>, pair: [u32; 2], overlap: f64) {
        if !overlap.is_finite() {
            return;
        }
        self.examined += 1;
        self.overlap += overlap;
        if overlap < NESTED {
            return;
        }
        if particle(scene, pair[0]).0 == particle(scene, pair[1]).0 {
            self.coincident.insert(pair[1]);
        } else {
            if self.nested == 0 {
                self.first = pair;
            }
            self.nested += 1;
        }
    }

    fn of(mut self, pairs: usize, scene: &AnyScene<'_>) -> Touching {
        self.pairs = Some(pairs as u64);
        self.each = 2.0 * pairs as f64 / scene.len().max(1) as f64;
        self
    }
}

/// Returns all doubts in the order in which they are printed. `source` names the origin of the
/// radii.
pub fn doubts(
    scene: &AnyScene<'_>,
    source: &RadiusSource,
    arithmetic: Arithmetic,
    touching: Option<&Touching>,
) -> Vec<Notice> {
    let mut doubts = Vec::new();
    let radii = radii(scene);
    if scene.is_empty() {
        return doubts;
    }
    if radii[0] == 0.0 {
        doubts.push(Notice::Points);
    }
    if let Some(touching) = touching {
        let before = doubts.len();
        of_contacts(scene, radii[1], source, touching, &mut doubts);
        // Coordinates from 0 to 1 are probably fractions of the edges of the box.
        let scaled = || is_scaled(scene.len(), scene.dim(), |k| particle(scene, k as u32).0);
        if doubts.len() > before && scaled() {
            doubts.push(Notice::Scaled);
        }
        if !touching.coincident.is_empty() {
            let first = touching.coincident.first().copied().unwrap_or_default();
            doubts.push(Notice::Coincident(touching.coincident.len() as u64, first));
        }
    }
    if arithmetic == Arithmetic::F32 {
        let spacing = f32_spacing(scene);
        doubts.extend((spacing > COARSE).then_some(Notice::Far(spacing)));
    }
    doubts
}

fn of_contacts(
    scene: &AnyScene<'_>,
    largest: f64,
    source: &RadiusSource,
    touching: &Touching,
    doubts: &mut Vec<Notice>,
) {
    // Equal particles that do not overlap have at most 6 neighbours in 2D and 12 in 3D.
    let crowded = if scene.dim() == 2 { 9.0 } else { 18.0 };
    let mean = touching.overlap / touching.examined.max(1) as f64;
    if touching.pairs == Some(0) {
        doubts.extend((scene.len() > 1 && largest > 0.0).then_some(Notice::Apart));
    } else if touching.each > crowded {
        let other_unit = touching.each > 5.0 * crowded;
        doubts.push(Notice::Crowded { each: touching.each, other_unit, source: source.clone() });
    } else if touching.examined >= ENOUGH && mean > DEEP && largest > 0.0 {
        doubts.push(Notice::Deep(mean));
    } else if touching.nested > 0 {
        doubts.push(Notice::Nested(touching.nested, touching.first));
    }
}

/// Returns the spacing of f32 at the largest coordinate, in mean radii; 0 if all radii are 0.
pub fn f32_spacing(scene: &AnyScene<'_>) -> f64 {
    let n = scene.len().max(1) as f64;
    let (largest, mean) = with_scene!(scene, scene => {
        let coordinates = scene.centres().iter().flat_map(array);
        let largest = coordinates.fold(0.0f64, |most, x| most.max(x.wide().abs()));
        let mean = match scene.radii() {
            Radii::Uniform(r) => r.wide(),
            Radii::Each(radii) => radii.iter().map(|r| r.wide() / n).sum::<f64>(),
        };
        (largest, mean)
    });
    let spacing = largest * 2f64.powi(-23) / mean;
    if spacing.is_finite() { spacing } else { 0.0 }
}

/// Returns whether there are over 100 particles and their coordinates fill the range from 0 to 1.
pub fn is_scaled(n: usize, dim: usize, centre: impl Fn(usize) -> [f64; 3]) -> bool {
    let (mut low, mut high) = ([1.0f64; 3], [0.0f64; 3]);
    n > 100
        && (0..n).all(|k| {
            let x = centre(k);
            (0..dim).all(|axis| {
                (low[axis], high[axis]) = (low[axis].min(x[axis]), high[axis].max(x[axis]));
                (0.0..=1.0).contains(&x[axis])
            })
        })
        && (0..dim).all(|axis| high[axis] - low[axis] > 0.9)
}

fn radii(scene: &AnyScene<'_>) -> [f64; 2] {
    with_scene!(scene, scene => match scene.radii() {
        Radii::Uniform(r) => [r.wide(); 2],
        Radii::Each(radii) => radii.iter().fold([f64::INFINITY, 0.0], |[low, high], r| {
            [low.min(r.wide()), high.max(r.wide())]
        }),
    })
}

/// Returns the overlap in mean radii, rounded; not finite if it overflows.
fn overlap(scene: &AnyScene<'_>, pair: [u32; 2]) -> f64 {
    let [(a, ra), (b, rb)] = pair.map(|k| particle(scene, k));
    let square: f64 = a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b)).sum();
    // Points that touch are coincident.
    if ra + rb == 0.0 { 2.0 } else { 2.0 * (1.0 - square.sqrt() / (ra + rb)) }
}
