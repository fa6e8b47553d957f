//! Displacements of particles from one frame to the next, to the nearest image in a periodic box,
//! and the nearest images of pairs.

use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_ground::scene::{AnyScene, Lattice};
use contactbench_lists::track::distance_bound;
use contactbench_scenes::touching::particle;

/// Returns the displacement of each particle, rounded up, and 0 if it did not move. Returns `None`
/// if the number of particles or the periodic axes changed.
pub fn displacements(last: &Periodic<'_>, frame: &Periodic<'_>) -> Option<Vec<f64>> {
    let (a, b) = (last.scene(), frame.scene());
    let same = a.len() == b.len() && a.dim() == b.dim();
    if !same || last.lattice().periodic() != frame.lattice().periodic() {
        return None;
    }
    let (nearest, vectors) = (Nearest::new(frame.lattice()), repeating(frame.lattice()));
    let moved = |(from, at): ([f64; 3], [f64; 3])| {
        let shift = sum(nearest.by(at, from), &vectors);
        let to = std::array::from_fn(|k| at[k] + shift[k]);
        if from == to { 0.0 } else { distance_bound(&from, &to) }
    };
    Some(centres(a).zip(centres(b)).map(moved).collect())
}

/// Returns the image of j nearest to i.
pub(crate) fn nearest(periodic: &Periodic<'_>, [i, j]: [u32; 2]) -> ImagePair {
    let [a, b] = [i, j].map(|k| particle(periodic.scene(), k).0);
    ImagePair::new(i, j, Nearest::new(periodic.lattice()).by(b, a))
}

fn centres(scene: &AnyScene<'_>) -> impl Iterator<Item = [f64; 3]> {
    (0..scene.len() as u32).map(|k| particle(scene, k).0)
}

fn repeating(lattice: &Lattice) -> [[f64; 3]; 3] {
    let (vectors, repeats) = (lattice.vectors(), lattice.periodic());
    std::array::from_fn(|v| if repeats[v] { vectors[v] } else { [0.0; 3] })
}

fn sum(image: [i32; 3], vectors: &[[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|k| (0..3).map(|v| f64::from(image[v]) * vectors[v][k]).sum())
}

/// Finds the nearest image. Vectors are reduced to be as short as possible. Then the nearest image
/// is among those next to the rounded fractions (as in `minimum_image` of ASE).
struct Nearest {
    vectors: [[f64; 3]; 3],
    duals: [[f64; 3]; 3],
    numbers: [[i32; 3]; 3],
    /// Square of the distance up to which a moved particle has no nearer image.
    near: f64,
}

impl Nearest {
    fn new(lattice: &Lattice) -> Nearest {
        let (lattice, numbers) = lattice.reduced();
        let repeats = lattice.periodic();
        let duals = std::array::from_fn(|v| if repeats[v] { lattice.dual(v) } else { [0.0; 3] });
        // The factor is slightly less than one half, because of rounding.
        let near = 0.49 * lattice.shortest();
        Nearest { vectors: repeating(&lattice), duals, numbers, near: near * near }
    }

    /// Returns the whole numbers of box vectors that bring `at` nearest to `then`.
    fn by(&self, at: [f64; 3], then: [f64; 3]) -> [i32; 3] {
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
        for step in others {
            let by = std::array::from_fn(|v| about[v].wrapping_add(step[v]));
            if best.0 <= self.near {
                break;
            }
            let left = left(by);
            if left < best.0 {
                best = (left, by);
            }
        }
        let (_, row) = best;
        let part = |v: usize, k: usize| row[v].wrapping_mul(self.numbers[v][k]);
        std::array::from_fn(|k| (0..3).fold(0, |sum: i32, v| sum.wrapping_add(part(v, k))))
    }
}

fn square(x: [f64; 3]) -> f64 {
    x.iter().map(|x| x * x).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_terms::mix::splitmix64;

    /// Compares displacements with all images that can be the nearest, also in very tilted boxes.
    #[test]
    fn displacements_are_to_the_nearest_image() {
        for (vectors, repeats) in [
            ([[4.0, 0.0, 0.0], [1.9, 3.0, 0.0], [0.0; 3]], [true, true, false]),
            ([[4.0, 0.0, 0.0], [9.5, 3.0, 0.0], [-4.0, 2.5, 5.0]], [true; 3]),
            ([[2.0, 0.0, 0.0], [1.0, 1.75, 0.0], [1.0, 0.5, 1.5]], [true; 3]),
            ([[4.0, 0.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 1.0]], [false, true, false]),
        ] {
            let lattice = Lattice::new(vectors, repeats, [0.0; 3]).unwrap();
            let (nearest, vectors) = (Nearest::new(&lattice), repeating(&lattice));
            let draw = |k: u64| (splitmix64(k) % 2048) as f64 / 128.0 - 8.0;
            for k in 0..80 {
                let at = |from: u64| {
                    [draw(6 * k + from), draw(6 * k + from + 1), draw(6 * k + from + 2)]
                };
                let [at, then] = [at(0), at(3)];
                let far = |by: [i32; 3]| {
                    let sum = sum(by, &vectors);
                    (0..3).map(|k| (then[k] - at[k] - sum[k]).powi(2)).sum::<f64>()
                };
                let all = (0..29i32.pow(3)).map(|s| [s / 841 - 14, s / 29 % 29 - 14, s % 29 - 14]);
                let least = all.map(far).fold(f64::INFINITY, f64::min);
                assert!(far(nearest.by(at, then)) <= least + 1e-9, "{lattice:?} {at:?} {then:?}");
            }
        }
    }
}
