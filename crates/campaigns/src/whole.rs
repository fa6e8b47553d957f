//! A scene in a box, in integers, and changes of it that only affect the images of its contacts.

use std::cmp::Ordering;

use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_ground::scene::{AnyScene, Lattice, Radii};

use crate::draw::{Draw, power};
use crate::near::{Near, gap};

/// Two particles, an image of the second, and the sign of the gap between first and image.
pub type Meeting = ([usize; 2], [i64; 3], Ordering);

/// A scene in integers, in open space or in a box. Radii are in half fine units.
pub struct Whole<const D: usize> {
    pub points: Vec<[i64; D]>,
    pub radii: Vec<i64>,
    pub vectors: [[i64; D]; 3],
    pub periodic: [bool; 3],
    pub fine: i32,
    pub meetings: Vec<Meeting>,
}

impl<const D: usize> Default for Whole<D> {
    fn default() -> Whole<D> {
        let (points, radii, meetings) = (Vec::new(), Vec::new(), Vec::new());
        Whole { points, radii, vectors: [[0; D]; 3], periodic: [false; 3], fine: 0, meetings }
    }
}

impl<const D: usize> Whole<D> {
    /// Adds the two particles of a pair, with the first particle at `a`.
    pub fn pair(&mut self, a: [i64; D], Near { vector, radii, truth }: Near<D>) {
        let i = self.points.len();
        self.points.extend([a, std::array::from_fn(|k| a[k] + vector[k])]);
        self.radii.extend(radii);
        self.meetings.push(([i, i + 1], [0; 3], truth));
    }

    /// Finds all pairs that touch or nearly touch. The vectors must be in lower triangular form.
    pub fn meet(&mut self) {
        let n = self.points.len();
        for (i, j) in (0..n).flat_map(|i| (i..n).map(move |j| (i, j))) {
            let radii = [self.radii[i], self.radii[j]];
            let far = ((radii[0] + radii[1]) >> (self.fine + 1)) + 4;
            let difference = std::array::from_fn(|k| self.points[i][k] - self.points[j][k]);
            let mut near = Vec::new();
            self.images(D, difference, far, [0; 3], &mut near);
            for (vector, image) in near {
                if i < j || image > [0; 3] {
                    self.meetings.push(([i, j], image, gap(&vector, radii, self.fine)));
                }
            }
        }
    }

    /// Collects the images S, by vectors `v` - 1 and below, for which no component of `difference`
    /// - S·H exceeds `far`, with these differences.
    fn images(
        &self,
        v: usize,
        difference: [i64; D],
        far: i64,
        image: [i64; 3],
        near: &mut Vec<([i64; D], [i64; 3])>,
    ) {
        let Some(v) = v.checked_sub(1) else { return near.push((difference, image)) };
        let edge = self.vectors[v][v];
        let (low, high) = if self.periodic[v] {
            ((difference[v] - far).div_euclid(edge), (difference[v] + far).div_euclid(edge) + 1)
        } else {
            (0, 0)
        };
        for number in low..=high {
            let left: [i64; D] =
                std::array::from_fn(|k| difference[k] - number * self.vectors[v][k]);
            if left[v].abs() <= far {
                let mut image = image;
                image[v] = number;
                self.images(v, left, far, image, near);
            }
        }
    }

    /// Replaces particles by images of themselves if doubles can hold these images.
    pub fn name_other_images(&mut self, away: i64, draw: &mut Draw) {
        let mut by = vec![[0; 3]; self.points.len()];
        for (point, by) in self.points.iter_mut().zip(&mut by) {
            let image = self.periodic.map(|repeats| match repeats {
                true if draw.once_in(2) => draw.within(away.max(1)),
                _ => 0,
            });
            let moved: [i64; D] = std::array::from_fn(|k| {
                point[k] + (0..3).map(|v| image[v] * self.vectors[v][k]).sum::<i64>()
            });
            if moved.iter().all(|&x| is_double(x)) {
                (*point, *by) = (moved, image);
            }
        }
        for ([i, j], image, _) in &mut self.meetings {
            *image = std::array::from_fn(|v| image[v] + by[*i][v] - by[*j][v]);
        }
    }

    /// Adds multiples of vectors to other vectors, and reverses some vectors.
    pub fn take_other_vectors(&mut self, draw: &mut Draw) {
        let periodic: Vec<usize> = (0..3).filter(|&v| self.periodic[v]).collect();
        for _ in 0..3 {
            let [a, b] = [(); 2].map(|()| draw.one_of(&periodic));
            let times = if a == b { -2 } else { draw.within(3) };
            let vector = std::array::from_fn(|k| self.vectors[a][k] + times * self.vectors[b][k]);
            if !vector.iter().all(|&x| is_double(x)) {
                continue;
            }
            self.vectors[a] = vector;
            for (_, image, _) in &mut self.meetings {
                // The old vector is Ha = H'a - times·Hb; if a = b, it is -H'a.
                if a == b { image[a] = -image[a] } else { image[b] -= times * image[a] }
            }
        }
    }

    pub fn shuffle(&mut self, draw: &mut Draw) {
        let order = draw.order(self.points.len());
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
        self.points = order.iter().map(|&k| self.points[k]).collect();
        self.radii = order.iter().map(|&k| self.radii[k]).collect();
        self.meetings.iter_mut().for_each(|(pair, ..)| *pair = pair.map(|k| place[k]));
    }

    /// Returns the contacts in ascending order, in canonical form.
    pub fn expected(&self) -> Vec<(ImagePair, Ordering)> {
        let name = |&([i, j], image, truth): &Meeting| {
            (ImagePair::new(i as u32, j as u32, image.map(|number| number as i32)), truth)
        };
        let mut expected: Vec<_> = self.meetings.iter().map(name).collect();
        expected.sort_unstable();
        expected
    }

    /// Converts the scene to doubles in units of 2^`exponent`, with a random corner of the box.
    pub fn periodic(&self, exponent: i32, draw: &mut Draw) -> Option<Periodic<'static>> {
        let (unit, half) = (power(exponent), power(exponent - self.fine - 1));
        let centres = self.points.iter().map(|x| x.map(|x| x as f64 * unit));
        let radius = |r: &i64| *r as f64 * half;
        let radii = sizes(self.radii.iter().map(radius).collect());
        let mut vectors = [[0.0; 3]; 3];
        let mut origin = [0.0; 3];
        for k in 0..D {
            (0..3).for_each(|v| vectors[v][k] = self.vectors[v][k] as f64 * unit);
            if draw.once_in(2) {
                origin[k] = draw.unit() * vectors[k][k];
            }
        }
        let lattice = match self.periodic.contains(&true) {
            true => Lattice::new(vectors, self.periodic, origin).ok()?,
            false => Lattice::OPEN,
        };
        Periodic::new(AnyScene::at(centres, radii).ok()?, lattice).ok()
    }
}

/// Returns a common radius if all are equal, else a radius each.
pub fn sizes(radii: Vec<f64>) -> Radii<'static, f64> {
    match radii.first() {
        Some(&first) if radii.iter().all(|r| *r == first) => Radii::Uniform(first),
        _ => Radii::Each(radii.into()),
    }
}

fn is_double(x: i64) -> bool {
    x == 0 || x.unsigned_abs() >> x.trailing_zeros() < 1 << 53
}
