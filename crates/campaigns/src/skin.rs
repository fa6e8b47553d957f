//! A few moving particles, two of which come into contact exactly when their displacements have
//! used up the skin. All numbers are integers, so the contacts of a frame are computed without the
//! library.
//!
//! ```text
//!   a >--------alpha-------->          (    t    )          <--------beta--------< b
//!                                      in contact
//!   when the list is built: t + s apart, or a unit more or less; alpha + beta = s, or nearly
//! ```
//!
//! On a *line* (along an axis, a Pythagorean direction or any other) coordinates are near 2^52
//! units, so that a unit is an ulp, and skins are between 1/64 and 3 diameters. *Thin* skins are a
//! few units, with a diameter near 2^58. Displacements are a few units or several diameters, so
//! that their sums and squares lose the units.

use contactbench_detectors::table::DetectorSpec;
use contactbench_detectors::tracker::TrackerSpec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::scene::AnyScene;
use contactbench_lists::track::{Rule, Skin};

use crate::draw::{Draw, Sphere, direction, power, square};
use crate::predicate::FAR;
use crate::tracking::{RULES, StoredFrame, add, detectors};
use crate::whole::sizes;
use crate::{Plan, Totals, What, in_batches};

/// A few particles in consecutive frames; two of them form the pair under test.
struct Pair<const D: usize> {
    name: &'static str,
    /// Centres of each frame, in units.
    frames: Vec<Vec<[i64; D]>>,
    /// Radii in half units.
    radii: Vec<i64>,
    /// The length of a unit is 2^exponent.
    exponent: i32,
    /// Skin in diameters of the largest particle.
    skin: f64,
    /// Skin in half units.
    skin_units: i64,
    /// The frame in which the gap of the pair is about the skin.
    start: usize,
}

/// Offsets of coordinates in diameters; 0 means around the origin.
const OFFSETS: [f64; 4] = [0.0, 1e3, 1e6, 1e9];
/// A half-skin rule whose comparison is rounded: it misses contacts only by rounding.
const NEARLY: Rule = Rule::Lammps { delay: 0, every: 1, check: true };
const PAIRS: usize = 200;

pub fn pairs(plan: Plan) -> Totals {
    let (plane, space) = (Sphere::<2>::made(), Sphere::<3>::made());
    let detectors = detectors();
    in_batches(plan, 64, |piece| {
        let mut draw = Draw::new(plan.seed, 1 << 62 | piece as u64);
        let mut table = Totals::default();
        for turn in 0..PAIRS {
            let by = &detectors[(PAIRS * piece + turn) % detectors.len()];
            match draw.once_in(2) {
                true => Pair::new(&plane, &mut draw).follow(by, &mut draw, &mut table),
                false => Pair::new(&space, &mut draw).follow(by, &mut draw, &mut table),
            }
        }
        table
    })
}

impl<const D: usize> Pair<D> {
    fn new(sphere: &Sphere<D>, draw: &mut Draw) -> Pair<D> {
        let mut pair = if draw.once_in(3) { thin(draw) } else { line(sphere, draw) };
        // Some pairs part and meet again.
        if draw.once_in(4) {
            let again = [pair.start, pair.frames.len() - 1].map(|k| pair.frames[k].clone());
            pair.frames.extend(again);
        }
        let turn = draw.below(4);
        pair.exponent = draw.exponent(turn, 900);
        let order = draw.order(pair.radii.len());
        pair.radii = order.iter().map(|&k| pair.radii[k]).collect();
        for frame in &mut pair.frames {
            *frame = order.iter().map(|&k| frame[k]).collect();
        }
        pair
    }

    /// Runs trackers with all rules over the frames, in exact arithmetic and in a rounded one.
    fn follow(&self, detector: &DetectorSpec, draw: &mut Draw, table: &mut Totals) {
        let mut counts = crate::Counts::default();
        counts.add(What::Came, self.came() as u64);
        table.add(self.name, "pairs", counts);
        let all = 0..self.frames.len();
        let exact = |k: usize| StoredFrame { scene: self.scene(k), truth: self.touching(k) };
        let exact: Vec<StoredFrame> = all.clone().map(exact).collect();
        let rounded = draw.one_of(&[Arithmetic::F32, Arithmetic::F64]);
        // Absent if the arithmetic cannot store a frame.
        let stored: Option<Vec<StoredFrame>> =
            all.map(|k| StoredFrame::new(&self.scene(k), rounded)).collect();
        let kinds = [(Arithmetic::Exact, exact)].into_iter().chain(stored.map(|it| (rounded, it)));
        for (arithmetic, frames) in kinds {
            for rule in RULES.into_iter().chain([NEARLY]) {
                let (detector, skin) = (detector.clone(), Skin::Diameters(self.skin));
                add(table, &TrackerSpec::Verlet { detector, skin, rule }, &frames, arithmetic);
            }
        }
    }

    fn scene(&self, k: usize) -> AnyScene<'static> {
        let (unit, half) = (power(self.exponent), power(self.exponent - 1));
        let centres = self.frames[k].iter().map(|x| x.map(|x| x as f64 * unit));
        let radii = self.radii.iter().map(|&r| r as f64 * half).collect();
        AnyScene::at(centres, sizes(radii)).expect("coordinates and radii are below 2^960")
    }

    /// Returns the pairs that touch in frame `k`, in ascending order.
    fn touching(&self, k: usize) -> Vec<[u32; 2]> {
        self.within(k, 0)
    }

    /// Counts pairs that touch in the last frame and were farther apart than the skin at the start.
    fn came(&self) -> usize {
        let near = self.within(self.start, self.skin_units);
        self.touching(self.frames.len() - 1).iter().filter(|pair| !near.contains(pair)).count()
    }

    /// Returns the pairs in frame `k` with a gap of at most this many half units.
    fn within(&self, k: usize, gap: i64) -> Vec<[u32; 2]> {
        let (at, n) = (&self.frames[k], self.radii.len());
        let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j]));
        let near = |&[i, j]: &[usize; 2]| {
            let twice: [i64; D] = std::array::from_fn(|k| 2 * (at[i][k] - at[j][k]));
            square(&twice) <= square(&[self.radii[i] + self.radii[j] + gap])
        };
        pairs.filter(near).map(|pair| pair.map(|k| k as u32)).collect()
    }
}

/// Sizes on a line, as multiples of the length of the sphere's vectors.
struct Line {
    /// Diameter of the first particle, 2^p times an even number m.
    diameter: i64,
    /// Diameter of the second particle, at most that of the first.
    smaller: i64,
    /// The skin, q·m.
    skin: i64,
    /// The skin in diameters.
    ratio: f64,
    /// Radii in half units; the second may be a half unit off.
    radii: [i64; 2],
}

impl Line {
    fn new(length: i64, offset: f64, draw: &mut Draw) -> Line {
        let p = 1 + draw.below(6);
        let q = 1 + draw.below(3 << p);
        // Displacements are at most twelve skins.
        let room = match offset == 0.0 {
            true => FAR / (length * ((1 << p) + 12 * q)),
            false => (FAR as f64 / offset) as i64 / (length << p),
        };
        let m = 2 * (room / 2).max(1);
        let diameter = m << p;
        let one_size = draw.once_in(2);
        let smaller = if one_size { diameter } else { 2 * draw.below(diameter / 2 + 1) };
        let other = smaller * length + if one_size { 0 } else { draw.bit() };
        let radii = [diameter * length, other.max(0)];
        Line { diameter, smaller, skin: m * q, ratio: q as f64 / (1 << p) as f64, radii }
    }

    /// Distance of two centres in contact.
    fn touch(&self) -> i64 {
        (self.diameter + self.smaller) / 2
    }
}

/// Returns a function that gives the displacement by some multiple of the sphere's length along a
/// random direction: exact along an axis or a Pythagorean vector, rounded along any other.
fn along<const D: usize>(sphere: &Sphere<D>, draw: &mut Draw) -> impl Fn(i64) -> [i64; D] + use<D> {
    let (turn, length) = (draw.below(3), sphere.length);
    let mut vector = match turn {
        0 => [0; D],
        1 => sphere.any(draw),
        _ => direction(draw, FAR),
    };
    if turn == 0 {
        vector[draw.axis::<D>()] = draw.sign() * length;
    }
    move |multiple| match turn {
        0 | 1 => vector.map(|x| x * multiple),
        _ => vector.map(|x| ((i128::from(x) * i128::from(multiple * length)) >> 52) as i64),
    }
}

fn moved<const D: usize>(at: [i64; D], by: [i64; D], sign: i64) -> [i64; D] {
    std::array::from_fn(|k| at[k] + sign * by[k])
}

/// Changes one component by up to this many units.
fn nearly<const D: usize>(mut at: [i64; D], units: i64, draw: &mut Draw) -> [i64; D] {
    at[draw.axis::<D>()] += draw.within(units);
    at
}

/// Makes a pair that moves along a line:
///
/// 1. At the start the gap is the skin.
/// 2. In one to three steps, the first particle moves by `alpha`, the second by the rest of the
///    skin, towards each other.
/// 3. At the end they are in contact.
///
/// Start and end deviate from these positions by at most the same small number of units, or by 0.
fn line<const D: usize>(sphere: &Sphere<D>, draw: &mut Draw) -> Pair<D> {
    let offset = draw.one_of(&OFFSETS);
    let line = Line::new(sphere.length, offset, draw);
    let (skin, length) = (line.skin, sphere.length);
    let along = along(sphere, draw);
    let off = draw.one_of(&[0, 0, 1, 1, 2, 40]);
    let base = if offset == 0.0 { 0 } else { FAR * 3 / 2 };
    let a: [i64; D] = std::array::from_fn(|_| draw.sign() * (base + draw.within(1 << 50)));
    let b = nearly(moved(a, along(line.touch() + skin), 1), off, draw);

    let part = draw.below(skin + 1);
    let alpha = draw.one_of(&[skin, 0, skin / 2, part]);
    let steps = 1 + draw.below(3);
    let after = |k: i64| {
        let way = |whole: i64| along(whole * k / steps);
        [moved(a, way(alpha), 1), moved(b, way(skin - alpha), -1)]
    };
    let end = after(steps).map(|at| nearly(at, off, draw));
    let mut frames: Vec<Vec<_>> = (0..steps).map(|k| after(k).into()).collect();
    frames.push(end.into());
    let mut start = 0;
    // Sometimes a list of the final positions is built first; it is useless after a jump away.
    if draw.once_in(3) {
        frames.splice(0..0, [end.into(), vec![moved(a, along(9 * skin), -1), b]]);
        start = 2;
    }
    let mut radii = line.radii.to_vec();
    // Some motions have a third particle, which does not move.
    if draw.once_in(2) {
        let most = (line.touch() + skin) * length;
        let at = std::array::from_fn(|k| a[k] + draw.within(most));
        frames.iter_mut().for_each(|frame| frame.push(at));
        radii.push(line.radii[1]);
    }
    let skin_units = 2 * skin * length;
    Pair { name: "line", frames, radii, exponent: 0, skin: line.ratio, skin_units, start }
}

/// Makes a pair of equal particles with a very large diameter, one of which moves by units, the
/// other by diameters or not at all.
fn thin<const D: usize>(draw: &mut Draw) -> Pair<D> {
    // Keeps only the highest 53 bits, which a double can hold.
    let double = |x: i64| x as f64 as i64;
    let some = ((1 << 51) + draw.below(1 << 51)) << 6;
    let diameter = draw.one_of(&[1 << 57, some]);
    let few = 1 + draw.below(64);
    let (skin, far) = match draw.once_in(2) {
        true => (few as f64 / diameter as f64, 0),
        false => {
            let skin = (1 + draw.below(192)) as f64 / 64.0;
            (skin, double((diameter as f64 * skin) as i64))
        }
    };
    let (axis, sign, units) = (draw.axis::<D>(), draw.sign(), draw.within(1 << 20));
    let off = draw.one_of(&[units, 0]);
    // The particles at `first` and `second` along the axis; the second is off the axis.
    let frame = |first: i64, second: i64| -> Vec<[i64; D]> {
        let mut at = [[0; D]; 2];
        (at[0][axis], at[1][axis]) = (sign * first, sign * second);
        at[1][(axis + 1) % D] = off;
        at.into()
    };
    let fine = if far == 0 { few + draw.within(1) } else { draw.within(4) };
    let mut frames = vec![frame(double(-diameter - far), fine)];
    if draw.once_in(2) {
        frames.push(frame(double(-diameter - far / 2), fine / 2));
    }
    let near = draw.within(2);
    frames.push(frame(-diameter, draw.one_of(&[0, near])));
    let (radii, skin_units) = (vec![diameter; 2], 2 * if far == 0 { few } else { far });
    Pair { name: "thin", frames, radii, exponent: 0, skin, skin_units, start: 0 }
}
