//! What the particles of a file and their contacts make doubtful: radii in another unit, diameters
//! taken for radii, particles written twice. Scenes that are made are not doubted.
//!
//! The rules stand here alone: `inspect` and all other verbs print their [`Notice`]s.

use std::collections::BTreeSet;

use contactbench_core::contact::{Arithmetic, Test};
use contactbench_core::crowd;
use contactbench_core::detect::{Options, Refusal, table};
use contactbench_core::memory::limit_for;
use contactbench_core::periodic::{self, ImagePair, Periodic};
use contactbench_core::scene::{AnyScene, Radii, Real, array};
use contactbench_core::sink::Visit;
use contactbench_core::with_scene;
use contactbench_io::Given;
use contactbench_io::{Notice, RadiusSource};

use crate::touching::particle;

/// At most about so many pairs are looked at, spread over the list: large scenes lose no time.
const EXAMINED: usize = 1 << 18;
/// More bytes of pairs than this are estimated, not looked for.
const MOST_BYTES: u64 = 400_000_000;
/// Fewer contacts say nothing of their mean.
const ENOUGH: u64 = 10;
/// Hard bodies overlap less in the mean, in mean radii; places at random by 0.5 and more.
const DEEP: f64 = 0.25;
/// Spheres that overlap by more than this, in mean radii, are nearly concentric; 2 is all.
const NESTED: f64 = 1.8;
/// f32 places bodies to this part of their radius, or else that is a doubt.
const COARSE: f64 = 1e-3;

/// What the contacts of a scene look like.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touching {
    /// Contacts per particle; an estimate where they are too many to be looked for.
    pub each: f64,
    /// Contacts; none if they are estimated.
    pairs: Option<u64>,
    examined: u64,
    /// The sum over the pairs examined, in mean radii.
    overlap: f64,
    /// Pairs that are nearly concentric, and the first.
    nested: u64,
    first: [u32; 2],
    /// Particles with the centre of an earlier one.
    coincident: BTreeSet<u32>,
}

impl Touching {
    /// An estimate of contacts per particle.
    pub fn estimated(each: f64) -> Touching {
        Touching { each, ..Touching::default() }
    }

    /// These contacts in open space.
    pub fn open(scene: &AnyScene<'_>, pairs: &[[u32; 2]]) -> Touching {
        Touching::over(scene, pairs, |&pair| (pair, overlap(scene, pair)))
    }

    /// These contacts in a box that repeats.
    pub fn boxed(periodic: &Periodic<'_>, pairs: &[ImagePair]) -> Touching {
        let depth = |&pair: &ImagePair| ([pair.i, pair.j], periodic::depth(periodic, pair));
        Touching::over(periodic.scene(), pairs, depth)
    }

    fn over<P>(scene: &AnyScene<'_>, pairs: &[P], of: impl Fn(&P) -> ([u32; 2], f64)) -> Touching {
        let mut touching = Touching::default();
        for (pair, overlap) in pairs.iter().step_by(pairs.len() / EXAMINED + 1).map(of) {
            // A small box brings bodies onto themselves.
            if pair[0] != pair[1] {
                touching.examine(scene, pair, overlap);
            }
        }
        touching.of(pairs.len(), scene)
    }

    /// Looks for the contacts; none where no detector takes the scene.
    pub fn search(given: &Given) -> Option<Touching> {
        let scene = &given.scene;
        if let Err(Refusal::Crowd { each, .. }) = crowd::within(scene, MOST_BYTES) {
            return Some(Touching::estimated(each));
        }
        let memory_limit = limit_for(scene.len());
        let mut detector = table::fast(Options { memory_limit, threads: 1 });
        if let Some(periodic) = given.periodic().ok()? {
            let exact = Arithmetic::Exact;
            let pairs = periodic::contacts(&periodic, &mut *detector, exact, memory_limit).ok()?;
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

/// All doubts about a scene whose radii come from `source`, in the order in which they are printed.
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
        // Where the contacts are those of a packing, the unit of length is a box's edge.
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
    // Equal bodies that do not overlap have at most 12 neighbours, or 6.
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

/// Spacing of f32 at the coordinate farthest from the origin, in mean radii; not finite where all
/// are points.
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

/// Do the coordinates of many particles fill the range from 0 to 1?
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

/// The smallest radius and the largest.
fn radii(scene: &AnyScene<'_>) -> [f64; 2] {
    with_scene!(scene, scene => match scene.radii() {
        Radii::Uniform(r) => [r.wide(); 2],
        Radii::Each(radii) => radii.iter().fold([f64::INFINITY, 0.0], |[low, high], r| {
            [low.min(r.wide()), high.max(r.wide())]
        }),
    })
}

/// Overlap in mean radii, rounded; not a finite number where it cannot be told.
fn overlap(scene: &AnyScene<'_>, pair: [u32; 2]) -> f64 {
    let [(a, ra), (b, rb)] = pair.map(|k| particle(scene, k));
    let square: f64 = a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b)).sum();
    // Points that touch are in one place.
    if ra + rb == 0.0 { 2.0 } else { 2.0 * (1.0 - square.sqrt() / (ra + rb)) }
}
