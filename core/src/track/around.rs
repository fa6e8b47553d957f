//! Lists that are kept in a periodic box.
//!
//! A list in a box holds triples (i, j, S): particle i near the image of j by S whole vectors of
//! the box. In a later frame a particle may be named by another image, since it has left through a
//! face and come in on the other side. It is then brought about by whole vectors W to where it
//! would be had it gone on, W·H being of the box H of that frame; which W is taken decides on how
//! long the list serves, never on what touches: (i, j, S) is (i, j, S + Wj - Wi) of the particles
//! as given, and that is decided, exactly, for the numbers as given. The proof that no contact is
//! missed, also where the box itself is sheared or pressed, is on the page of filters, 8.

use nalgebra::Point;

use super::travel::way;
use crate::contact::image::{self, Shift};
use crate::contact::{Corners, Slack};
use crate::filter::Near;
use crate::periodic::ImagePair;
use crate::refusal::{Refusal, reserve};
use crate::scene::{Lattice, Scene, array};

/// What a list in a box needs beside its pairs of particles.
pub(super) struct Around<const D: usize> {
    /// When the list was built; none in open space.
    then: Option<Lattice>,
    /// How far the centres reached along each axis then.
    extent: [f64; D],
    /// Of the frame.
    now: Vectors<D>,
    /// Listed triples with S not 0; of places.
    pub through: Vec<ImagePair>,
    /// Places of particles that are brought about in this frame, in ascending order, and W.
    brought: Vec<(u32, [i32; 3])>,
    /// A bit for each place: is it among those?
    marks: Vec<u64>,
    /// How far a particle that is brought about may be from where it is, by rounding.
    off: f64,
}

impl<const D: usize> Default for Around<D> {
    fn default() -> Around<D> {
        Around {
            then: None,
            extent: [0.0; D],
            now: Vectors::NONE,
            through: Vec::new(),
            brought: Vec::new(),
            marks: Vec::new(),
            off: 0.0,
        }
    }
}

/// The box of a frame.
#[derive(Clone, Copy, Debug)]
struct Vectors<const D: usize> {
    /// 0 along open axes.
    vectors: [[f64; D]; 3],
    duals: [[f64; D]; 3],
    /// Who goes farther in a frame is likely to have another name.
    far: f64,
}

impl<const D: usize> Vectors<D> {
    const NONE: Vectors<D> =
        Vectors { vectors: [[0.0; D]; 3], duals: [[0.0; D]; 3], far: f64::INFINITY };

    fn new(lattice: &Lattice) -> Vectors<D> {
        let mut all = Vectors::NONE;
        for v in (0..3).filter(|&v| lattice.periodic()[v]) {
            let (vector, dual) = (lattice.vectors()[v], lattice.dual(v));
            all.vectors[v] = std::array::from_fn(|k| vector[k]);
            all.duals[v] = std::array::from_fn(|k| dual[k]);
            all.far = all.far.min(0.25 * lattice.height(v));
        }
        all
    }

    /// By how many vectors a particle is brought nearest to where it was.
    fn nearest(&self, at: &[f64; D], then: &[f64; D]) -> [i32; 3] {
        const MOST: f64 = (1u32 << 29) as f64;
        self.duals.map(|dual| {
            let fraction: f64 = (0..D).map(|k| dual[k] * (then[k] - at[k])).sum();
            let whole = fraction.round();
            if whole.abs() < MOST { whole as i32 } else { 0 }
        })
    }

    /// S·H.
    fn shift(&self, by: [i32; 3]) -> [f64; D] {
        std::array::from_fn(|k| (0..3).map(|v| f64::from(by[v]) * self.vectors[v][k]).sum())
    }

    /// The sum of the magnitudes of all terms of S·H.
    fn size(&self, by: [i32; 3]) -> f64 {
        let sum = |v: usize| self.vectors[v].iter().map(|x| x.abs()).sum::<f64>();
        (0..3).map(|v| f64::from(by[v]).abs() * sum(v)).sum()
    }
}

/// Of sums of a dozen terms, and of vectors in the space that they span.
const ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;
const SKEWED: f64 = 1.0 / (1u64 << 40) as f64;

impl<const D: usize> Around<D> {
    /// A list will be built in this box, or in open space. Its distances are to be longer by what
    /// is returned, so that particles may be brought about later.
    pub fn begin(
        &mut self,
        lattice: Option<&Lattice>,
        places: usize,
        (low, high): Corners<D>,
    ) -> Result<f64, Refusal> {
        self.through.clear();
        self.brought.clear();
        self.then = lattice.copied();
        self.off = 0.0;
        let Some(lattice) = lattice else { return Ok(0.0) };
        self.now = Vectors::new(lattice);
        self.extent = std::array::from_fn(|k| high[k] - low[k]);
        let marks = places.div_ceil(64);
        self.marks.clear();
        reserve(&mut self.marks, marks)?;
        self.marks.resize(marks, 0);
        let far: f64 = (0..D).map(|k| low[k].abs().max(high[k].abs())).sum();
        // For names some dozens of boxes away.
        Ok(64.0 * ROUNDING * (far + self.now.size([1; 3])))
    }

    /// Whether the list is one for frames in such a box; if so, its particles are about to be
    /// brought to their places.
    pub fn serves(&mut self, lattice: Option<&Lattice>) -> bool {
        let repeats = |lattice: Option<&Lattice>| lattice.map(Lattice::periodic);
        if repeats(lattice) != repeats(self.then.as_ref()) {
            return false;
        }
        if let Some(lattice) = lattice {
            self.now = Vectors::new(lattice);
            self.brought.clear();
            self.marks.fill(0);
            self.off = 0.0;
        }
        true
    }

    /// Brings particles in places from `first` on to where they would be had they gone on.
    pub fn bring(&mut self, at: &mut [Point<f64, D>], then: &[Point<f64, D>], first: usize) {
        if self.then.is_none() {
            return;
        }
        let far = self.now.far;
        for (k, (at, then)) in at.iter_mut().zip(then).enumerate() {
            let gone = (0..D).fold(0.0f64, |most, k| most.max((at[k] - then[k]).abs()));
            if gone > far {
                self.bring_one(at, then, first + k);
            }
        }
    }

    #[cold]
    fn bring_one(&mut self, at: &mut Point<f64, D>, then: &Point<f64, D>, place: usize) {
        let by = self.now.nearest(array(at), array(then));
        if by == [0; 3] {
            return;
        }
        let far: f64 = array(at).iter().map(|x| x.abs()).sum();
        let off = ROUNDING * (far + self.now.size(by));
        // Without room for its name the list is of no use.
        let room = self.brought.try_reserve(1).is_ok();
        self.off = self.off.max(if room { off } else { f64::INFINITY });
        if !room {
            return;
        }
        let shift = self.now.shift(by);
        (0..D).for_each(|k| at[k] += shift[k]);
        self.brought.push((place as u32, by));
        self.marks[place / 64] |= 1 << (place % 64);
    }

    /// How far particles may be, by rounding, from where they were brought.
    pub fn off(&self) -> f64 {
        self.off
    }

    /// How much nearer than by their own ways, of which `first` is the longest, a particle and an
    /// image may have come since the list was built, since the box has changed. Bodies touch at
    /// distances of at most `reach`.
    pub fn nearer(&self, lattice: Option<&Lattice>, first: f64, reach: f64) -> f64 {
        let (Some(now), Some(then)) = (lattice, &self.then) else { return 0.0 };
        if now.vectors() == then.vectors() {
            return 0.0;
        }
        let wide: f64 = self.extent.iter().map(|extent| extent + 2.0 * (first + self.off)).sum();
        let each = (0..3).filter(|&v| now.periodic()[v]).map(|v| {
            let vector = now.vectors()[v];
            let length = vector.iter().map(|x| x.abs()).sum::<f64>();
            let height = now.height(v) - SKEWED * length;
            if height.is_nan() || height <= 0.0 {
                return f64::INFINITY;
            }
            let dual = now.dual(v);
            let along = |k: usize| dual[k].abs() * (self.extent[k] + 2.0 * (first + self.off));
            let spread: f64 = (0..D).map(along).sum();
            let rounded = SKEWED * (length / height) * (wide / height) + SKEWED * spread;
            let most = (reach / height + spread + rounded + SKEWED).floor();
            (most * way(&vector, &then.vectors()[v])).next_up()
        });
        each.fold(0.0, |sum, more| (sum + more).next_up())
    }

    /// What brought particles leave open.
    pub fn slack(&self) -> Slack {
        Slack { relative: 0.0, absolute: 2.0 * self.off }
    }

    /// W.
    fn by(&self, place: u32) -> [i32; 3] {
        if !self.is_brought(place) {
            return [0; 3];
        }
        let found = self.brought.binary_search_by_key(&place, |&(place, _)| place);
        found.map_or([0; 3], |k| self.brought[k].1)
    }

    #[inline(always)]
    fn is_brought(&self, place: u32) -> bool {
        self.marks[place as usize / 64] >> (place % 64) & 1 == 1
    }

    /// S of particles as given, for places that are listed with `image`.
    #[inline]
    pub fn image(&self, a: u32, b: u32, image: [i32; 3]) -> [i32; 3] {
        if self.brought.is_empty() || !(self.is_brought(a) | self.is_brought(b)) {
            return image;
        }
        let (of_a, of_b) = (self.by(a), self.by(b));
        std::array::from_fn(|v| image[v].wrapping_add(of_b[v]).wrapping_sub(of_a[v]))
    }

    /// Does a particle touch an image of another, exactly, for the numbers as given? Tells also
    /// whether that took exact arithmetic.
    pub fn touch(
        &self,
        scene: &Scene<'_, f64, D>,
        [i, j]: [u32; 2],
        image: [i32; 3],
    ) -> (bool, bool) {
        let [i, j] = [i as usize, j as usize];
        let (a, b) = (array(&scene.centres()[i]), array(&scene.centres()[j]));
        let (ra, rb) = (scene.radius(i), scene.radius(j));
        let shift = self.now.shift(image);
        let (mut square, mut size) = (0.0, self.now.size(image));
        for k in 0..D {
            let d = a[k] - b[k] - shift[k];
            square += d * d;
            size += a[k].abs() + b[k].abs();
        }
        let slack = Slack { relative: 0.0, absolute: ROUNDING * size };
        match Near::new(ra + rb, slack).verdict(square) {
            Some(touch) => (touch, false),
            None => {
                let shift = Shift { image, vectors: &self.now.vectors };
                (image::compare(a, b, ra, rb, shift).is_le(), true)
            }
        }
    }

    /// Bytes, where the list has room for as many triples as it holds.
    pub fn bytes(&self) -> u64 {
        match self.then {
            Some(_) => {
                (size_of_val(&*self.through)
                    + size_of_val(&*self.brought)
                    + size_of_val(&*self.marks)) as u64
            }
            None => 0,
        }
    }
}
