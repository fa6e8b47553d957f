//! One step in a box: displacements to the nearest image, and contacts between two frames.
//!
//! Particle i moves from xi to yi, its nearest image in the next frame. The image S of j moves from
//! xj + S·H to yj + S·H'. H are the box vectors, and H' the vectors to which they have moved, even
//! if the box was flipped. Paths are straight lines between positions that are rounded to f64. So
//! the count may differ for pairs whose least distance is within rounding of touching.
//!
//! **Which pairs can meet.** For a pair that touches during the step, let d be its distance before.
//! Then d is at most ri + rj, plus both displacements, plus the displacement of the image by the
//! box. The latter is at most the sum over vectors v of |Sv| |H'v - Hv|. Let gv be the dual vector
//! of Hv, and wv the width of all particles along it. Then |Sv| <= wv + |gv| d. So d (1 - B) is at
//! most ri + rj + displacements + A, with A = sum of wv |H'v - Hv| and B = sum of |gv| |H'v - Hv|.

use super::names::{Onward, centres, repeating, sum};
use contactbench_detectors::oracle::NoTruth;
use contactbench_detectors::oracle::boxes;
use contactbench_detectors::table;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::contact::exact::label;
use contactbench_ground::contact::image::{Shift, compare};
use contactbench_ground::contact::swept::touches_within;
use contactbench_ground::detect::Options;
use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_ground::scene::{AnyScene, Radii, Real, Scene};
use contactbench_ground::with_scene;
use contactbench_lists::periodic;
use contactbench_lists::track::distance_bound;

/// Relative rounding error of sums of about a dozen terms.
const ROUNDING: f64 = 1.0 / (1u64 << 40) as f64;

pub(crate) struct Through<'a> {
    last: &'a Periodic<'a>,
    frame: &'a Periodic<'a>,
    onward: &'a Onward,
    /// Positions x before and y after the step, and those of the next frame as given.
    from: Vec<[f64; 3]>,
    to: Vec<[f64; 3]>,
    given: Vec<[f64; 3]>,
}

impl<'a> Through<'a> {
    pub fn new(last: &'a Periodic<'a>, frame: &'a Periodic<'a>, onward: &'a Onward) -> Through<'a> {
        let vectors = repeating(frame.lattice());
        let given = centres(frame.scene());
        let to = given.iter().zip(&onward.by).map(|(at, &by)| moved(at, by, &vectors)).collect();
        Through { last, frame, onward, from: centres(last.scene()), to, given }
    }

    /// Returns the displacement of each particle, rounded up, and the number of particles that did
    /// not move.
    pub fn displacements(&self) -> (Vec<f64>, usize) {
        let ends = || self.from.iter().zip(&self.to);
        let gone = |a, b| if a == b { 0.0 } else { distance_bound(a, b) };
        (ends().map(|(a, b)| gone(a, b)).collect(), ends().filter(|(a, b)| a == b).count())
    }

    pub fn changes(&self) -> bool {
        let now = repeating(self.last.lattice());
        self.onward.vectors(self.frame.lattice()) != now
    }

    /// Returns the number of contacts that exist only between the frames, or why it is unknown.
    /// Counts contacts of the chosen particles alone, if given.
    pub fn tunnelled(
        &self,
        displacements: &[f64],
        chosen: Option<&[bool]>,
        memory_limit: u64,
    ) -> Result<u64, String> {
        let (before, after) = (repeating(self.last.lattice()), repeating(self.frame.lattice()));
        let onward = self.onward.vectors(self.frame.lattice());
        let more = self.more(displacements, &before, &onward)?;
        let near = self.near(displacements, more, chosen, memory_limit)?;
        let radius = |k| with_scene!(self.last.scene(), scene => scene.radius(k).wide());
        let is_tunnelled = |pair: &ImagePair| {
            let (i, j) = (pair.i as usize, pair.j as usize);
            let [ri, rj] = [radius(i), radius(j)];
            let from = [self.from[i], moved(&self.from[j], pair.image, &before)];
            let to = [self.to[i], moved(&self.to[j], pair.image, &onward)];
            let apart = |at: &[[f64; 3]], image, vectors| {
                compare(&at[i], &at[j], ri, rj, Shift { image, vectors }).is_gt()
            };
            // The pair must not touch in the rounded positions either; otherwise nearly touching
            // pairs at rest would count.
            let is_apart = |[a, b]: &[[f64; 3]; 2]| !label(a, b, ri, rj).touches();
            is_apart(&from)
                && is_apart(&to)
                && touches_within([&from[0], &to[0]], [&from[1], &to[1]], ri, rj)
                && apart(&self.from, pair.image, &before)
                && apart(&self.given, self.onward.called(*pair), &after)
        };
        Ok(near.iter().filter(|pair| is_tunnelled(pair)).count() as u64)
    }

    /// Returns an upper bound for the part of d, in the module's proof, that the motion of the box
    /// adds.
    fn more(
        &self,
        displacements: &[f64],
        before: &[[f64; 3]; 3],
        onward: &[[f64; 3]; 3],
    ) -> Result<f64, String> {
        let longest = displacements.iter().fold(0.0f64, |most, &step| most.max(step));
        let reach = 2.0 * (self.last.scene().largest_radius() + longest);
        let (mut wide, mut share) = (0.0, 0.0);
        for v in (0..3).filter(|&v| before[v] != onward[v]) {
            let moved = distance_bound(&onward[v], &before[v]);
            let dual = self.last.lattice().dual(v);
            let along = |at: &[f64; 3]| -> f64 { (0..3).map(|k| dual[k] * at[k]).sum() };
            let (low, high) = self
                .from
                .iter()
                .map(along)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                    (low.min(x), high.max(x))
                });
            wide += moved * (high - low + ROUNDING * (high.abs() + low.abs() + 1.0));
            share += moved * distance_bound(&dual, &[0.0; 3]);
        }
        if share < 0.5 {
            Ok((reach + wide) / (1.0 - share) * (1.0 + ROUNDING) - reach)
        } else {
            Err("the box changes too much from one frame to the next".into())
        }
    }

    fn near(
        &self,
        displacements: &[f64],
        more: f64,
        chosen: Option<&[bool]>,
        memory_limit: u64,
    ) -> Result<Vec<ImagePair>, String> {
        let wider =
            displacements.iter().map(|step| (step + 0.5 * more) * (1.0 + ROUNDING)).collect();
        let wider: AnyScene<'static> = match self.last.scene() {
            AnyScene::Plane(scene) => wider_by(&scene.widened(), wider)?.into(),
            AnyScene::Space(scene) => wider_by(&scene.widened(), wider)?.into(),
        };
        let wider =
            Periodic::new(wider, *self.last.lattice()).map_err(|error| error.to_string())?;
        let options = Options { memory_limit, threads: 1 };
        let exact = Arithmetic::Exact;
        let near = match chosen {
            Some(chosen) => boxes::touching(&wider, exact, chosen, memory_limit),
            None => periodic::contacts(&wider, &mut *table::fast(options), exact, memory_limit)
                .map_err(NoTruth::from),
        };
        near.map_err(|why| format!("particles widened by their displacements: {why}"))
    }
}

fn wider_by<const D: usize>(
    scene: &Scene<'_, f64, D>,
    by: Vec<f64>,
) -> Result<Scene<'static, f64, D>, String> {
    let radii = by.iter().enumerate().map(|(k, by)| (scene.radius(k) + by).next_up());
    let radii = Radii::Each(radii.collect::<Vec<_>>().into());
    Scene::new(scene.centres().to_vec(), radii).map_err(|error| error.to_string())
}

fn moved(at: &[f64; 3], image: [i32; 3], vectors: &[[f64; 3]; 3]) -> [f64; 3] {
    let shift = sum(image, vectors);
    std::array::from_fn(|k| at[k] + shift[k])
}
