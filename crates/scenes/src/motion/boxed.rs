//! Motions in periodic boxes.
//!
//! A particle that leaves through a face returns on the other side: it is shifted by whole vectors.
//! Along open directions, walls reflect the centres as in open space. These walls are at right
//! angles to all periodic vectors and enclose the centres of frame 0.
//!
//! A shear also shears the box (Lees and Edwards 1972, doi:10.1088/0022-3719/5/15/006; `fix deform`
//! of LAMMPS): x grows by γ y for particles and vectors, with y from the corner of the box, which
//! does not move. If the tilt of a vector exceeds half of the first one, which lies along x, whole
//! first vectors are subtracted. This changes no image.

use anyhow::ensure;
use nalgebra::Point;

use super::MotionKind;
use super::paths::between_walls;
use contactbench_ground::scene::{Lattice, Scene, array};

pub(super) struct Boxed<const D: usize> {
    first: Lattice,
    walls: Vec<Wall<D>>,
}

struct Wall<const D: usize> {
    normal: [f64; D],
    low: f64,
    extent: f64,
}

impl<const D: usize> Boxed<D> {
    /// Builds the walls for a scene in the box of frame 0.
    ///
    /// # Errors
    /// Fails if the motion does not work in boxes or in this box, or if the box of discs leaves the
    /// plane.
    pub fn new(
        scene: &Scene<'_, f64, D>,
        first: &Lattice,
        kind: MotionKind,
    ) -> anyhow::Result<Boxed<D>> {
        let goes = matches!(
            kind,
            MotionKind::Rest
                | MotionKind::Drift
                | MotionKind::Shear
                | MotionKind::Jitter
                | MotionKind::Brownian
        );
        ensure!(
            goes,
            "{} needs open boundaries; take rest, drift, shear, jitter or brownian",
            kind.name()
        );
        let first = if D == 2 { first.flat()? } else { *first };
        let [_, y, z] = first.vectors()[0];
        ensure!(
            kind != MotionKind::Shear || !first.periodic()[0] || [y, z] == [0.0; 2],
            "layers slide along x; the first vector has y = {y} and z = {z}: turn the box"
        );
        Ok(Boxed { first, walls: walls(scene, &first) })
    }

    /// Returns the height of the box along y and the y of its corner; `None` if it is not periodic
    /// along y.
    pub fn height(&self) -> Option<(f64, f64)> {
        let repeats = (0..3).filter(|&v| self.first.periodic()[v]);
        let height: f64 = repeats.map(|v| self.first.vectors()[v][1].abs()).sum();
        (height > 0.0).then_some((height, self.first.origin()[1]))
    }

    /// Returns the position of a particle in the box after this displacement from `first`.
    pub fn gone(&self, first: &Point<f64, D>, displacement: &[f64; D]) -> Point<f64, D> {
        let mut at = Point::from(std::array::from_fn(|k| first[k] + displacement[k]));
        for Wall { normal, low, extent } in &self.walls {
            let (from, gone) = (dot(normal, array(first)), dot(normal, displacement));
            let to = low + between_walls(from - low + gone, *extent);
            let back = to - (from + gone);
            (0..D).for_each(|k| at[k] += normal[k] * back);
        }
        brought(&self.first, &at)
    }

    /// Returns the box after a shear of γ; fails if the vectors overflow f64.
    pub fn sheared(&self, gamma: f64) -> anyhow::Result<Lattice> {
        if gamma == 0.0 {
            return Ok(self.first);
        }
        let periodic = self.first.periodic();
        let edge = self.first.vectors()[0][0];
        let slid = |v: usize| {
            let [x, y, z] = self.first.vectors()[v];
            if !periodic[v] || y == 0.0 {
                return [x, y, z];
            }
            let tilt = x + gamma * y;
            let whole = if periodic[0] { (tilt / edge).round() } else { 0.0 };
            [tilt - whole * edge, y, z]
        };
        Ok(Lattice::new(std::array::from_fn(slid), periodic, self.first.origin())?)
    }

    pub fn in_first(&self, at: &Point<f64, D>) -> Point<f64, D> {
        brought(&self.first, at)
    }
}

/// Returns the image of a position that lies in the box, up to rounding.
pub(super) fn brought<const D: usize>(lattice: &Lattice, at: &Point<f64, D>) -> Point<f64, D> {
    let origin = lattice.origin();
    let mut brought = *at;
    for v in (0..3).filter(|&v| lattice.periodic()[v]) {
        let (vector, dual) = (lattice.vectors()[v], lattice.dual(v));
        let fraction: f64 = (0..D).map(|k| dual[k] * (at[k] - origin[k])).sum();
        let whole = fraction.floor();
        if whole != 0.0 {
            (0..D).for_each(|k| brought[k] -= whole * vector[k]);
        }
    }
    brought
}

/// Returns one pair of walls for each open dimension.
fn walls<const D: usize>(scene: &Scene<'_, f64, D>, lattice: &Lattice) -> Vec<Wall<D>> {
    let vectors = (0..3).filter(|&v| lattice.periodic()[v]).map(|v| lattice.vectors()[v]);
    let mut span: Vec<[f64; D]> = Vec::new();
    for vector in vectors {
        span.push(unit(left_of(std::array::from_fn(|k| vector[k]), &span)));
    }
    let mut walls = Vec::new();
    while span.len() < D {
        // Choose the axis farthest from the span; among equal ones, the first.
        let axes = (0..D).map(|axis| std::array::from_fn(|k| f64::from(u8::from(k == axis))));
        let left = axes.map(|axis| left_of(axis, &span));
        let Some(farthest) = left.reduce(|a, b| if dot(&b, &b) > dot(&a, &a) { b } else { a })
        else {
            break;
        };
        let normal = unit(farthest);
        span.push(normal);
        let along = scene.centres().iter().map(|at| dot(&normal, array(at)));
        let (low, high) = along
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        walls.push(Wall { normal, low, extent: high - low });
    }
    walls
}

/// Returns the part of the vector at right angles to the span. Projecting twice reduces rounding
/// errors.
fn left_of<const D: usize>(vector: [f64; D], span: &[[f64; D]]) -> [f64; D] {
    let mut left = vector;
    for direction in span.iter().chain(span) {
        let part = dot(&left, direction);
        (0..D).for_each(|k| left[k] -= part * direction[k]);
    }
    left
}

fn unit<const D: usize>(vector: [f64; D]) -> [f64; D] {
    let length = dot(&vector, &vector).sqrt();
    vector.map(|x| x / length)
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}
