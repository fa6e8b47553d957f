//! Names of contacts in a periodic box that stay the same in all frames.
//!
//! The image S of a contact (i, j, S) changes if a particle leaves through a face and enters on the
//! other side, or if a sheared box is flipped back. To undo both, two things are tracked. Wk counts
//! the box vectors by which particle k was moved so far; each step moves it to the image nearest to
//! its last position. C expresses the current box vectors by those of the first frame, which move
//! with the box. Then S·C + Wi - Wj does not change.

use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_ground::scene::{AnyScene, Lattice};
use contactbench_lists::track::distance_bound;
use contactbench_scenes::touching::particle;

/// A matrix of whole numbers, with one row for each box vector.
type Numbers = [[i32; 3]; 3];

const SAME: Numbers = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

pub(crate) struct Onward {
    /// Whole numbers of later box vectors that bring each particle nearest to its earlier position.
    pub by: Vec<[i32; 3]>,
    /// The later box vectors in terms of the earlier ones after their motion; `back` is the
    /// inverse.
    turned: Numbers,
    back: Numbers,
}

#[derive(Default)]
pub struct Names {
    last: Option<Periodic<'static>>,
    /// W of each particle, in terms of the first frame's vectors; empty in open space.
    brought: Vec<[i32; 3]>,
    /// The matrix C; `back` is its inverse.
    turned: Numbers,
    back: Numbers,
}

impl Names {
    /// Adds a frame. Returns the frame before it and the step between them; `None` for the first
    /// frame, or if the number of particles or the periodic axes changed.
    pub(crate) fn next(
        &mut self,
        frame: &Periodic<'static>,
    ) -> Option<(Periodic<'static>, Onward)> {
        let last = self.last.replace(frame.clone());
        let step = last.and_then(|last| Onward::new(&last, frame).map(|onward| (last, onward)));
        match &step {
            Some((_, onward)) => {
                self.turned = product(&onward.turned, &self.turned);
                self.back = product(&self.back, &onward.back);
                for (all, &by) in self.brought.iter_mut().zip(&onward.by) {
                    *all = add(*all, times(by, &self.turned));
                }
            }
            None => {
                let moved = if frame.lattice().repeats() { frame.scene().len() } else { 0 };
                self.brought = vec![[0; 3]; moved];
                (self.turned, self.back) = (SAME, SAME);
            }
        }
        step
    }

    pub fn name(&self, pair: ImagePair) -> ImagePair {
        let apart = self.apart(pair);
        ImagePair::new(pair.i, pair.j, add(times(pair.image, &self.turned), apart))
    }

    pub fn called(&self, name: ImagePair) -> ImagePair {
        let apart = self.apart(name).map(i32::wrapping_neg);
        ImagePair::new(name.i, name.j, times(add(name.image, apart), &self.back))
    }

    /// Returns Wi - Wj, the number of box vectors by which i was moved more than j.
    fn apart(&self, pair: ImagePair) -> [i32; 3] {
        let of = |k: u32| self.brought.get(k as usize).copied().unwrap_or_default();
        add(of(pair.i), of(pair.j).map(i32::wrapping_neg))
    }
}

impl Onward {
    fn new(last: &Periodic<'_>, frame: &Periodic<'_>) -> Option<Onward> {
        let (from, to) = (last.lattice(), frame.lattice());
        let (a, b) = (last.scene(), frame.scene());
        if a.len() != b.len() || a.dim() != b.dim() || from.periodic() != to.periodic() {
            return None;
        }
        let (turned, back) = turned(from, to);
        let nearest = Nearest::new(to);
        let then = centres(a);
        let by = centres(b).into_iter().zip(then).map(|(at, then)| nearest.by(at, then)).collect();
        Some(Onward { by, turned, back })
    }

    /// Returns the displacement of each particle to its nearest image, rounded up, and the number of
    /// particles that did not move.
    pub fn displacements(&self, last: &Periodic<'_>, frame: &Periodic<'_>) -> (Vec<f64>, usize) {
        let vectors = repeating(frame.lattice());
        let (from, to) = (centres(last.scene()), centres(frame.scene()));
        let mut at_rest = 0;
        let all = from.iter().zip(to).zip(&self.by).map(|((from, to), &by)| {
            let shift = sum(by, &vectors);
            let to: [f64; 3] = std::array::from_fn(|k| to[k] + shift[k]);
            at_rest += usize::from(*from == to);
            if *from == to { 0.0 } else { distance_bound(from, &to) }
        });
        (all.collect(), at_rest)
    }
}

pub(super) fn repeating(lattice: &Lattice) -> [[f64; 3]; 3] {
    let (vectors, repeats) = (lattice.vectors(), lattice.periodic());
    std::array::from_fn(|v| if repeats[v] { vectors[v] } else { [0.0; 3] })
}

pub(super) fn sum(image: [i32; 3], vectors: &[[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (0..3).map(|v| f64::from(image[v]) * vectors[v][k]).sum())
}

/// Returns the later box vectors as whole-number combinations of the earlier ones, and the inverse.
/// Returns the identity if there are no such combinations.
fn turned(from: &Lattice, to: &Lattice) -> (Numbers, Numbers) {
    if from.vectors() == to.vectors() {
        return (SAME, SAME);
    }
    let repeats = from.periodic();
    let mut turned = SAME;
    for b in (0..3).filter(|&b| repeats[b]) {
        let dual = from.dual(b);
        for a in (0..3).filter(|&a| repeats[a]) {
            let part: f64 = to.vectors()[a].iter().zip(dual).map(|(x, y)| x * y).sum();
            turned[a][b] = part.round() as i32;
        }
    }
    inverse(&turned).map_or((SAME, SAME), |back| (turned, back))
}

fn inverse(of: &Numbers) -> Option<Numbers> {
    let minor = |a: usize, b: usize| -> i128 {
        let at = |i: usize, k: usize| i128::from(of[(a + i) % 3][(b + k) % 3]);
        at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
    };
    let determinant: i128 = (0..3).map(|b| i128::from(of[0][b]) * minor(0, b)).sum();
    if determinant.abs() != 1 {
        return None;
    }
    let mut inverse = SAME;
    for (b, row) in inverse.iter_mut().enumerate() {
        for (a, number) in row.iter_mut().enumerate() {
            *number = i32::try_from(determinant * minor(a, b)).ok()?;
        }
    }
    Some(inverse)
}

fn add(a: [i32; 3], b: [i32; 3]) -> [i32; 3] {
    std::array::from_fn(|v| a[v].wrapping_add(b[v]))
}

fn times(row: [i32; 3], by: &Numbers) -> [i32; 3] {
    let product = |v: usize, k: usize| row[v].wrapping_mul(by[v][k]);
    std::array::from_fn(|k| (0..3).fold(0, |sum: i32, v| sum.wrapping_add(product(v, k))))
}

fn product(a: &Numbers, b: &Numbers) -> Numbers {
    a.map(|row| times(row, b))
}

pub(super) fn centres(scene: &AnyScene<'_>) -> Vec<[f64; 3]> {
    (0..scene.len() as u32).map(|k| particle(scene, k).0).collect()
}

/// Finds the nearest image. Vectors are reduced to be as short as possible. Then the nearest image
/// is among those next to the rounded fractions (as in `minimum_image` of ASE).
pub(super) struct Nearest {
    vectors: [[f64; 3]; 3],
    duals: [[f64; 3]; 3],
    numbers: Numbers,
    /// Square of the distance up to which a moved particle has no nearer image.
    near: f64,
}

impl Nearest {
    pub fn new(lattice: &Lattice) -> Nearest {
        let (lattice, numbers) = lattice.reduced();
        let repeats = lattice.periodic();
        let duals = std::array::from_fn(|v| if repeats[v] { lattice.dual(v) } else { [0.0; 3] });
        // The factor is slightly less than one half, because of rounding.
        let near = 0.49 * lattice.shortest();
        Nearest { vectors: repeating(&lattice), duals, numbers, near: near * near }
    }

    /// Returns the whole numbers of box vectors that bring `at` nearest to `then`.
    pub fn by(&self, at: [f64; 3], then: [f64; 3]) -> [i32; 3] {
        let step: [f64; 3] = std::array::from_fn(|k| then[k] - at[k]);
        if square(step) <= self.near {
            return [0; 3];
        }
        let about = self.duals.map(|dual| {
            let fraction: f64 = (0..3).map(|k| dual[k] * step[k]).sum();
            fraction.round() as i32
        });
        let left = |by: [i32; 3]| {
            let sum = sum(by, &self.vectors);
            square(std::array::from_fn(|k| step[k] - sum[k]))
        };
        let mut best = (left(about), about);
        let steps = |v: usize| if self.duals[v] == [0.0; 3] { 0..=0 } else { -1..=1 };
        let others = steps(0).flat_map(|x| steps(1).map(move |y| (x, y)));
        let others = others.flat_map(|(x, y)| steps(2).map(move |z| [x, y, z]));
        for by in others.map(|step| add(about, step)) {
            if best.0 <= self.near {
                break;
            }
            let left = left(by);
            if left < best.0 {
                best = (left, by);
            }
        }
        times(best.1, &self.numbers)
    }
}

fn square(x: [f64; 3]) -> f64 {
    x.iter().map(|x| x * x).sum()
}
