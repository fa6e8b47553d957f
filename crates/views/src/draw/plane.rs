//! Circles in the drawn plane: discs, or spheres cut by a slice. The outline of the box there.

use std::str::FromStr;

use anyhow::Context;

use crate::draw::particles::Particle;
use contactbench_ground::scene::Lattice;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// Axis at right angles to the plane: 0, 1 or 2.
    pub axis: usize,
    pub at: f64,
}

impl Slice {
    /// Returns a plane through both particles of a pair, if there is one, at right angles to the
    /// axis along which they are nearest relative to their radii.
    pub fn through([a, b]: [&Particle; 2]) -> Slice {
        let apart = |axis: usize| (a.centre[axis] - b.centre[axis]).abs();
        let axis = [2, 1, 0].into_iter().min_by(|&k, &l| apart(k).total_cmp(&apart(l)));
        let axis = axis.unwrap_or(2);
        let part = if a.r + b.r > 0.0 { a.r / (a.r + b.r) } else { 0.5 };
        Slice { axis, at: a.centre[axis] * (1.0 - part) + b.centre[axis] * part }
    }

    /// Returns the lowest and the highest coordinate of the particles along the plane's normal.
    pub fn range(&self, particles: &[Particle]) -> [f64; 2] {
        let ends =
            particles.iter().map(|body| [-1.0, 1.0].map(|s| body.centre[self.axis] + s * body.r));
        ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [from, to]| {
            [low.min(from), high.max(to)]
        })
    }

    pub fn name(&self) -> &'static str {
        ["x", "y", "z"][self.axis.min(2)]
    }
}

impl FromStr for Slice {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> anyhow::Result<Slice> {
        let read = || {
            let (name, at) = text.split_once('=')?;
            let axis = ["x", "y", "z"].iter().position(|axis| *axis == name.trim())?;
            let at = at.trim().parse().ok().filter(|at: &f64| at.is_finite())?;
            Some(Slice { axis, at })
        };
        read().with_context(|| {
            format!("'{text}' is not a plane; write an axis x, y or z and a number, as in z=0.5")
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    pub id: u32,
    pub at: [f64; 2],
    pub r: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Circle of each particle in input order; `None` outside the plane.
    circles: Vec<Option<Circle>>,
    pub slice: Option<Slice>,
    pub axes: [usize; 2],
    /// Power of two by which coordinates are scaled, so that no difference overflows or vanishes.
    pub factor: f64,
}

impl Plane {
    /// Returns all discs, or the circles of the spheres that meet the slice. The default slice is
    /// through the middle of the first `count` particles.
    pub fn new(particles: &[Particle], dim: usize, slice: Option<Slice>, count: usize) -> Plane {
        let sizes = particles.iter().flat_map(|body| body.centre.into_iter().chain([body.r]));
        let largest = sizes.fold(0.0f64, |most, x| most.max(x.abs()));
        let factor = if largest > 1e300 {
            2f64.powi(-30)
        } else if largest > 0.0 && largest < 1e-290 {
            2f64.powi(300)
        } else {
            1.0
        };
        let middle = || {
            let heights = particles.iter().take(count).map(|body| body.centre[2]);
            let low = heights.clone().fold(f64::INFINITY, f64::min);
            Slice { axis: 2, at: 0.5 * low + 0.5 * heights.fold(f64::NEG_INFINITY, f64::max) }
        };
        let slice = (dim == 3 && !particles.is_empty()).then(|| slice.unwrap_or_else(middle));
        let axes = match slice.map(|slice| slice.axis) {
            Some(0) => [1, 2],
            Some(1) => [0, 2],
            _ => [0, 1],
        };
        let circle = |(id, body): (u32, &Particle)| {
            let r = body.r * factor;
            let away =
                slice.map_or(0.0, |slice| body.centre[slice.axis] * factor - slice.at * factor);
            // (r - away)(r + away) loses no digits, and the root of each factor does not overflow.
            let cut = (r - away).sqrt() * (r + away).sqrt();
            let at = axes.map(|axis| body.centre[axis] * factor);
            (away.abs() <= r).then_some(Circle { id, at, r: cut })
        };
        Plane { circles: (0..).zip(particles).map(circle).collect(), slice, axes, factor }
    }

    pub fn circles(&self) -> impl Iterator<Item = &Circle> + Clone {
        self.circles.iter().flatten()
    }

    pub fn circle(&self, body: u32) -> Option<&Circle> {
        self.circles.get(body as usize)?.as_ref()
    }

    /// Keeps only circles near a pair; keeps all if a particle of the pair has no circle.
    pub fn zoom(&mut self, [i, j]: [u32; 2]) {
        let (Some(a), Some(b)) = (self.circle(i), self.circle(j)) else { return };
        let apart = [0, 1].map(|k| (a.at[k] - b.at[k]).abs());
        let reach = 3.0 * a.r.max(b.r) + apart[0].max(apart[1]);
        let middle = [0, 1].map(|k| 0.5 * a.at[k] + 0.5 * b.at[k]);
        for circle in &mut self.circles {
            *circle = circle.filter(|it| {
                let near = (0..2).all(|k| (it.at[k] - middle[k]).abs() <= reach);
                it.id == i || it.id == j || near
            });
        }
    }

    /// Returns the corners of a box in the plane, in order around it.
    pub fn outline(&self, lattice: &Lattice) -> Vec<[f64; 2]> {
        let corner = |weights: [f64; 3]| {
            let vectors = || lattice.vectors().iter().zip(weights);
            let sum = |k: usize| vectors().map(|(v, times)| v[k] * times).sum::<f64>();
            [0, 1, 2].map(|k| (lattice.origin()[k] + sum(k)) * self.factor)
        };
        let ends = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut points: Vec<[f64; 2]> = match self.slice {
            None => ends.map(|[a, b]| corner([a, b, 0.0])).map(|[x, y, _]| [x, y]).into(),
            Some(Slice { axis, at }) => {
                let edges = (0..3).flat_map(|vector| ends.map(|[a, b]| (vector, a, b)));
                let crossing = |(vector, a, b): (usize, f64, f64)| {
                    let mut weights = [a, b, 0.0];
                    weights.swap(vector, 2);
                    let from = corner(weights);
                    weights[vector] = 1.0;
                    let to = corner(weights);
                    let part = (at * self.factor - from[axis]) / (to[axis] - from[axis]);
                    let between = |k: usize| from[k] + (to[k] - from[k]) * part;
                    (0.0..=1.0).contains(&part).then(|| self.axes.map(between))
                };
                edges.filter_map(crossing).collect()
            }
        };
        points.retain(|point| point.iter().all(|x| x.is_finite()));
        let count = points.len() as f64;
        let middle = [0, 1].map(|k| points.iter().map(|point| point[k] / count).sum::<f64>());
        let angle = |point: &[f64; 2]| (point[1] - middle[1]).atan2(point[0] - middle[0]);
        points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        points
    }

    /// Returns the lower left and the upper right corner of a rectangle around the circles and
    /// further points.
    pub fn bounds(&self, more: &[[f64; 2]]) -> [[f64; 2]; 2] {
        let around =
            |circle: &Circle| [-1.0, 1.0].map(|side| circle.at.map(|x| x + side * circle.r));
        let all = self.circles().map(around).chain(more.iter().map(|&point| [point, point]));
        let wider = |[low, high]: [[f64; 2]; 2], [least, most]: [[f64; 2]; 2]| {
            [[0, 1].map(|k| low[k].min(least[k])), [0, 1].map(|k| high[k].max(most[k]))]
        };
        all.reduce(wider).unwrap_or([[0.0; 2], [1.0; 2]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spheres(centres: &[[f64; 3]], r: f64) -> Vec<Particle> {
        let body = |&centre: &[f64; 3]| Particle { particle: 0, image: [0; 3], centre, r };
        centres.iter().map(body).collect()
    }

    #[test]
    fn a_slice_cuts_spheres_into_circles() {
        let centres = [[0.0, 0.0, 0.0], [10.0, 5.0, 3.0], [20.0, 7.0, 5.5], [30.0, 0.0, 8.0]];
        let scene = spheres(&centres, 5.0);
        let cut = |slice| Plane::new(&scene, 3, slice, usize::MAX);
        let plane = cut(Some("z = 0".parse().unwrap()));
        let found: Vec<_> = plane.circles().map(|c| (c.id, c.at)).collect();
        assert_eq!(found, [(0, [0.0, 0.0]), (1, [10.0, 5.0])]);
        let r = |body: u32| plane.circle(body).map(|circle| circle.r);
        assert!((r(0).unwrap() - 5.0).abs() < 1e-14 && (r(1).unwrap() - 4.0).abs() < 1e-14);
        assert_eq!([r(2), r(9)], [None, None]);
        assert_eq!(cut(None).circles().count(), 4);
        let plane = cut(Some(Slice { axis: 0, at: 31.0 }));
        assert_eq!((plane.axes, plane.circles().next().unwrap().at), ([1, 2], [0.0, 8.0]));
        // A plane tangent to a sphere meets it in a point.
        assert_eq!(cut(Some(Slice { axis: 0, at: 35.0 })).circles().next().unwrap().r, 0.0);
    }
}
