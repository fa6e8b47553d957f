//! Lists that are kept in a periodic box.
//!
//! A list in a box holds triples (i, j, S): particle i near the image of j shifted by S box
//! vectors. In a later frame a particle may be given by another image, because it left through one
//! face and entered through the opposite one. An integer shift W then brings it near the position
//! where it would be without that jump. The choice of W affects how long the list serves, never the
//! contacts. For the given positions (i, j, S) means (i, j, S + Wj - Wi), which is decided exactly.
//! [`contactbench_ground::filter`], section 8, proves that no contact is missed. If a vector of the
//! box changes, the list is rebuilt.

use nalgebra::Point;

use contactbench_ground::contact::image::{self, Shift};

use contactbench_ground::contact::{Corners, Slack, Test, rule};
use contactbench_ground::filter::Near;
use contactbench_ground::limits::refusal::{Refusal, reserve};
use contactbench_ground::periodic::ImagePair;
use contactbench_ground::scene::lattice::Numbers;
use contactbench_ground::scene::{Lattice, Scene, array};
use contactbench_ground::wide::fill;

#[derive(Default)]
pub(super) struct Around<const D: usize> {
    /// The box when the list was built, or `None` in open space.
    then: Option<Lattice>,
    now: Vectors<D>,
    /// Listed triples (i, j, S) with S other than 0, numbered by places.
    pub through: Vec<ImagePair>,
    /// Place and W of each particle with W other than 0 in this frame, in ascending order.
    brought: Vec<(u32, [i32; 3])>,
    /// One bit per place: set if the particle has a W other than 0 (is in `brought`).
    marks: Vec<u64>,
    /// Bound for the rounding error of a displacement, caused by W.
    off: f64,
}

#[derive(Clone, Copy, Debug)]
struct Vectors<const D: usize> {
    /// Vectors of the box; zeros along open axes.
    vectors: [[f64; D]; 3],
    /// Duals of the shortest vectors of the lattice; `numbers` gives those vectors as integer
    /// combinations of the box vectors.
    duals: [[f64; D]; 3],
    numbers: Numbers,
    /// Longest plausible displacement in one frame. A particle that moves farther was probably
    /// stored as another image.
    far: f64,
}

impl<const D: usize> Default for Vectors<D> {
    fn default() -> Vectors<D> {
        let none = [[0.0; D]; 3];
        Vectors { vectors: none, duals: none, numbers: [[0; 3]; 3], far: f64::INFINITY }
    }
}

impl<const D: usize> Vectors<D> {
    fn new(lattice: &Lattice) -> Vectors<D> {
        let mut all = Vectors::default();
        // A reduced lattice has the same duals and heights however tilted the given box is.
        let (short, numbers) = lattice.reduced();
        all.numbers = numbers;
        for v in (0..3).filter(|&v| lattice.periodic()[v]) {
            let (vector, dual) = (lattice.vectors()[v], short.dual(v));
            all.vectors[v] = fill(|k| vector[k]);
            all.duals[v] = fill(|k| dual[k]);
            all.far = all.far.min(0.25 * short.height(v));
        }
        all
    }

    /// Returns the shift that brings a particle near its earlier position. Its numbers are below
    /// 2^28, so that S + Wj - Wi fits in 32 bits (S is below 2^30).
    fn nearest(&self, at: &[f64; D], then: &[f64; D]) -> [i32; 3] {
        const MOST: f64 = (1u32 << 28) as f64;
        let short =
            self.duals.map(|dual| (0..D).map(|k| dual[k] * (then[k] - at[k])).sum::<f64>().round());
        let by: [f64; 3] = fill(|v| (0..3).map(|s| short[s] * f64::from(self.numbers[s][v])).sum());
        if by.iter().all(|whole| whole.abs() < MOST) {
            by.map(|whole| whole as i32)
        } else {
            [0; 3]
        }
    }

    fn shift(&self, by: [i32; 3]) -> [f64; D] {
        fill(|k| (0..3).map(|v| f64::from(by[v]) * self.vectors[v][k]).sum())
    }

    /// Returns the sum of the magnitudes of all terms of the shift S·H.
    fn size(&self, by: [i32; 3]) -> f64 {
        let sum = |v: usize| self.vectors[v].iter().map(|x| x.abs()).sum::<f64>();
        (0..3).map(|v| f64::from(by[v]).abs() * sum(v)).sum()
    }
}

/// Bound for the relative rounding error of a sum of a dozen terms.
const ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

impl<const D: usize> Around<D> {
    /// Prepares for a list in this box, or in open space. Returns the margin that must be added to
    /// the distances of the list, because particles may be shifted later.
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
        let far: f64 = (0..D).map(|k| low[k].abs().max(high[k].abs())).sum();
        let marks = places.div_ceil(64);
        self.marks.clear();
        reserve(&mut self.marks, marks)?;
        self.marks.resize(marks, 0);
        // The margin covers images a few dozen boxes away.
        Ok(64.0 * ROUNDING * (far + self.now.size([1; 3])))
    }

    /// Returns whether the list remains valid in this box, and if so prepares to shift particles.
    pub fn serves(&mut self, lattice: Option<&Lattice>) -> bool {
        let repeats = |lattice: Option<&Lattice>| lattice.map(Lattice::periodic);
        if repeats(lattice) != repeats(self.then.as_ref()) {
            return false;
        }
        let (Some(now), Some(then)) = (lattice, &self.then) else { return true };
        if (0..3).any(|v| now.periodic()[v] && now.vectors()[v] != then.vectors()[v]) {
            return false;
        }
        self.brought.clear();
        self.marks.fill(0);
        self.off = 0.0;
        true
    }

    pub fn is_box(&self) -> bool {
        self.then.is_some()
    }

    /// Shifts the particles at places from `first` on back to where they would be if they had not
    /// jumped through faces.
    pub fn bring(&mut self, at: &mut [Point<f64, D>], then: &[Point<f64, D>], first: usize) {
        let far = self.now.far;
        for (k, (at, then)) in at.iter_mut().zip(then).enumerate() {
            let gone = (0..D).fold(0.0f64, |most, k| most.max((at[k] - then[k]).abs()));
            if gone > far {
                self.bring_one(at, then, first + k);
            }
        }
    }

    #[cold]
    fn bring_one(&mut self, at: &mut Point<f64, D>, from: &Point<f64, D>, place: usize) {
        let by = self.now.nearest(array(at), array(from));
        let shift = self.now.shift(by);
        let way = |by: &[f64; D]| (0..D).map(|k| (at[k] + by[k] - from[k]).powi(2)).sum::<f64>();
        // The particle is not shifted if that would move it farther away.
        if by == [0; 3] || way(&shift) >= way(&[0.0; D]) {
            return;
        }
        let far: f64 = array(at).iter().map(|x| x.abs()).sum();
        let off = ROUNDING * (far + self.now.size(by));
        // If memory does not suffice to record the shift, the list becomes invalid.
        let room = self.brought.try_reserve(1).is_ok();
        self.off = self.off.max(if room { off } else { f64::INFINITY });
        if !room {
            return;
        }
        (0..D).for_each(|k| at[k] += shift[k]);
        self.brought.push((place as u32, by));
        self.marks[place / 64] |= 1 << (place % 64);
    }

    /// Returns the bound for the rounding error of the shifted particles.
    pub fn off(&self) -> f64 {
        self.off
    }

    /// Returns how much shifted particles widen the uncertainty of distances.
    pub fn slack(&self) -> Slack {
        Slack { relative: 0.0, absolute: 2.0 * self.off }
    }

    /// Returns the shift W of the particle at this place.
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

    /// Returns the image by which two listed places touch at their given positions: S + Wj - Wi.
    #[inline]
    pub fn image(&self, a: u32, b: u32, image: [i32; 3]) -> [i32; 3] {
        if self.brought.is_empty() || !(self.is_brought(a) | self.is_brought(b)) {
            return image;
        }
        let (of_a, of_b) = (self.by(a), self.by(b));
        fill(|v| image[v].wrapping_add(of_b[v]).wrapping_sub(of_a[v]))
    }

    /// Returns whether a particle touches an image of another, decided exactly for the given
    /// numbers, and whether exact arithmetic was needed.
    pub fn touch(
        &self,
        scene: &Scene<'_, f64, D>,
        [i, j]: [u32; 2],
        image: [i32; 3],
        test: Test,
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
                (rule::touches(test, image::compare(a, b, ra, rb, shift)), true)
            }
        }
    }

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
