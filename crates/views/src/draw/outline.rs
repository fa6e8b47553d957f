//! The faces of a box, as lines in the drawn plane.

use crate::draw::plane::{Plane, Rectangle, hull};
use contactbench_ground::scene::Lattice;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    pub ends: [[f64; 2]; 2],
    /// True for a periodic face.
    pub repeats: bool,
}

/// A corner, and whether the face that begins there is periodic; `None` without a face.
type Corner = ([f64; 2], Option<bool>);

/// Returns the faces of a box in a plane, clipped to `view` if it is given.
pub fn faces(plane: &Plane, lattice: &Lattice, view: Option<Rectangle>) -> Vec<Face> {
    let view = view.unwrap_or_else(|| around(plane, lattice));
    let [[x, y], [right, top]] = view;
    let mut polygon: Vec<Corner> =
        [[x, y], [right, y], [right, top], [x, top]].map(|corner| (corner, None)).to_vec();
    let whole = closed(lattice, plane.slice.is_some());
    let dim = if plane.slice.is_some() { 3 } else { 2 };
    for vector in 0..dim {
        let repeats = lattice.periodic()[vector];
        let dual = match &whole {
            Some(whole) => whole.dual(vector),
            None if repeats => lattice.dual(vector),
            None => continue,
        };
        // Returns the fraction along the box vector: 0 to 1 within the box.
        let along = |point: [f64; 2]| {
            let mut at = lattice.origin();
            plane.axes.iter().zip(point).for_each(|(&axis, x)| at[axis] = x / plane.factor);
            if let Some(slice) = plane.slice {
                at[slice.axis] = slice.at;
            }
            (0..dim).map(|k| dual[k] * (at[k] - lattice.origin()[k])).sum::<f64>()
        };
        polygon = cut(&polygon, repeats, along);
        polygon = cut(&polygon, repeats, |point| 1.0 - along(point));
    }
    let next = polygon.iter().cycle().skip(1);
    let edges = polygon.iter().zip(next);
    let faces =
        edges.filter_map(|(&(a, kind), &(b, _))| Some(Face { ends: [a, b], repeats: kind? }));
    faces.filter(|face| face.ends.as_flattened().iter().all(|x| x.is_finite())).collect()
}

fn closed(lattice: &Lattice, space: bool) -> Option<Lattice> {
    let mut vectors = *lattice.vectors();
    if !space {
        vectors[2] = [0.0, 0.0, 1.0];
    }
    Lattice::new(vectors, [true; 3], lattice.origin()).ok()
}

/// Returns a rectangle around the circles and all corners of the box. A margin keeps all faces off
/// its edge.
fn around(plane: &Plane, lattice: &Lattice) -> Rectangle {
    let corner = |corner: usize| {
        let vectors = lattice.vectors().iter().enumerate();
        let taken =
            vectors.filter(|(vector, _)| corner >> vector & 1 == 1).map(|(_, vector)| vector);
        plane.axes.map(|axis| {
            let at = taken.clone().fold(lattice.origin()[axis], |at, vector| at + vector[axis]);
            at * plane.factor
        })
    };
    let corners = (0..8).map(corner).map(|at| [at, at]);
    let [low, high] = hull(plane.bounds().into_iter().chain(corners)).unwrap_or_default();
    let more = |k: usize| 0.01 * (high[k] - low[k]);
    [[0, 1].map(|k| low[k] - more(k)), [0, 1].map(|k| high[k] + more(k))]
}

/// Clips a convex polygon where the linear function `inside` is negative. The new edge is a face.
fn cut(polygon: &[Corner], repeats: bool, inside: impl Fn([f64; 2]) -> f64) -> Vec<Corner> {
    let mut left = Vec::new();
    for (k, &(a, edge)) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()].0;
        let (at, then) = (inside(a), inside(b));
        let part = at / (at - then);
        let between = [0, 1].map(|k| a[k] + (b[k] - a[k]) * part);
        if at >= 0.0 {
            left.push((a, edge));
        }
        match (at >= 0.0, then >= 0.0) {
            (true, false) => left.push((between, Some(repeats))),
            (false, true) => left.push((between, edge)),
            _ => {}
        }
    }
    left
}
