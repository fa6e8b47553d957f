//! What contacts in a box are called in all frames.
//!
//! A contact (i, j, S) in a box changes its name where a particle leaves through a face and comes
//! in on the other side, and where a sheared box is flipped back. Two things are kept, so that it
//! has one name for as long as it lasts: by how many whole vectors W each particle has been brought
//! about so far, from frame to frame to the image nearest to where it was; and the vectors of the
//! box as whole numbers C of those of the first frame, as they have moved on. Then S·C + Wi - Wj is
//! the same in all frames.

use contactbench_core::periodic::{ImagePair, Periodic};
use contactbench_core::scene::{AnyScene, Lattice};
use contactbench_scenes::touching::particle;

/// Whole numbers, one row for each vector of a box.
type Numbers = [[i32; 3]; 3];

const SAME: Numbers = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/// From one frame in a box to the next.
pub(crate) struct Onward {
    /// So many vectors of the later box bring a particle nearest to where it was.
    pub by: Vec<[i32; 3]>,
    /// The vectors of the later box by those of the earlier one, as they have moved on.
    turned: Numbers,
    back: Numbers,
}

/// The names in the frame that was seen last.
#[derive(Default)]
pub struct Names {
    last: Option<Periodic<'static>>,
    /// W of each particle, of vectors of the first frame.
    brought: Vec<[i32; 3]>,
    /// C, and the other way.
    turned: Numbers,
    back: Numbers,
}

impl Names {
    /// One more frame. Gives the one before it, and how it goes on from there; none for the first,
    /// and where there are other particles, or a box that repeats otherwise.
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
                self.brought = vec![[0; 3]; frame.scene().len()];
                (self.turned, self.back) = (SAME, SAME);
            }
        }
        step
    }

    /// The name in all frames.
    pub fn name(&self, pair: ImagePair) -> ImagePair {
        let apart = self.apart(pair);
        ImagePair::new(pair.i, pair.j, add(times(pair.image, &self.turned), apart))
    }

    /// What has this name, as this frame calls it.
    pub fn called(&self, name: ImagePair) -> ImagePair {
        let apart = self.apart(name).map(i32::wrapping_neg);
        ImagePair::new(name.i, name.j, times(add(name.image, apart), &self.back))
    }

    /// Wi - Wj.
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

    /// What is called so in the earlier frame, as the later one calls it.
    pub fn called(&self, ImagePair { i, j, image }: ImagePair) -> [i32; 3] {
        let [of_i, of_j] = [i, j].map(|k| self.by[k as usize]);
        add(times(image, &self.back), add(of_j, of_i.map(i32::wrapping_neg)))
    }

    /// The vectors of the later box that have become of those of the earlier one; 0 where it is
    /// open.
    pub fn vectors(&self, to: &Lattice) -> [[f64; 3]; 3] {
        let vectors = repeating(to);
        self.back.map(|row| sum(row, &vectors))
    }
}

/// The vectors along which a box repeats, and 0 for the others.
pub(super) fn repeating(lattice: &Lattice) -> [[f64; 3]; 3] {
    let (vectors, repeats) = (lattice.vectors(), lattice.periodic());
    std::array::from_fn(|v| if repeats[v] { vectors[v] } else { [0.0; 3] })
}

/// S·H.
pub(super) fn sum(image: [i32; 3], vectors: &[[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (0..3).map(|v| f64::from(image[v]) * vectors[v][k]).sum())
}

/// The vectors of one box by those of another, and the other way; as they are where they are not
/// of one lattice that has moved on.
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

/// Of whole numbers, if it has such.
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

/// A row by a matrix.
fn times(row: [i32; 3], by: &Numbers) -> [i32; 3] {
    let product = |v: usize, k: usize| row[v].wrapping_mul(by[v][k]);
    std::array::from_fn(|k| (0..3).fold(0, |sum: i32, v| sum.wrapping_add(product(v, k))))
}

fn product(a: &Numbers, b: &Numbers) -> Numbers {
    a.map(|row| times(row, b))
}

/// Centres with three coordinates.
pub(super) fn centres(scene: &AnyScene<'_>) -> Vec<[f64; 3]> {
    (0..scene.len() as u32).map(|k| particle(scene, k).0).collect()
}

/// Finds the nearest image. Vectors are as short as can be: then the nearest one is among those
/// around the fractions, each rounded (as in the `minimum_image` of ASE).
pub(super) struct Nearest {
    vectors: [[f64; 3]; 3],
    duals: [[f64; 3]; 3],
    numbers: Numbers,
    /// The square of a length: whoever has gone no farther has no nearer image.
    near: f64,
}

impl Nearest {
    pub fn new(lattice: &Lattice) -> Nearest {
        let (lattice, numbers) = lattice.reduced();
        let repeats = lattice.periodic();
        let duals = std::array::from_fn(|v| if repeats[v] { lattice.dual(v) } else { [0.0; 3] });
        // With a little less than half for rounding.
        let near = 0.49 * lattice.shortest();
        Nearest { vectors: repeating(&lattice), duals, numbers, near: near * near }
    }

    /// How many vectors of the box bring `at` nearest to `then`.
    pub fn by(&self, at: [f64; 3], then: [f64; 3]) -> [i32; 3] {
        let way: [f64; 3] = std::array::from_fn(|k| then[k] - at[k]);
        if square(way) <= self.near {
            return [0; 3];
        }
        let about = self.duals.map(|dual| {
            let fraction: f64 = (0..3).map(|k| dual[k] * way[k]).sum();
            fraction.round() as i32
        });
        let left = |by: [i32; 3]| {
            let sum = sum(by, &self.vectors);
            square(std::array::from_fn(|k| way[k] - sum[k]))
        };
        let mut best = (left(about), about);
        let steps = |v: usize| if self.duals[v] == [0.0; 3] { 0..=0 } else { -1..=1 };
        let others = steps(0).flat_map(|x| steps(1).map(move |y| (x, y)));
        let others = others.flat_map(|(x, y)| steps(2).map(move |z| [x, y, z]));
        for by in others.map(|step| add(about, step)) {
            // Most are next to where they were.
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
