//! Doubts about particles and their box that follow from the numbers in a file, not from names.

use std::collections::HashMap;

use crate::particles::Particles;
use crate::raw::lines::{number, short};
use crate::types::{Notice, assumed};
use contactbench_ground::scene::Lattice;

/// How near a face a particle is at the face, as a fraction of the box: files often have six
/// decimals.
const AT_FACE: f64 = 1e-6;

/// Returns doubts about particles in a periodic box.
pub fn of_box(particles: &Particles) -> Vec<Notice> {
    let Some(lattice) = &particles.lattice else { return Vec::new() };
    fractions(particles, lattice).into_iter().chain(twice(particles, lattice)).collect()
}

fn points(particles: &Particles) -> impl Iterator<Item = [f64; 3]> + Clone {
    (0..particles.len()).map(|k| particles.centre(k))
}

/// Returns the least and the largest coordinate along an axis.
fn range(particles: &Particles, axis: usize) -> [f64; 2] {
    points(particles)
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| [a.min(p[axis]), b.max(p[axis])])
}

/// Doubts that coordinates are lengths, if all lie between 0 and 1 in a larger box.
fn fractions(particles: &Particles, lattice: &Lattice) -> Option<Notice> {
    let axes = || (0..3).filter(|&axis| lattice.periodic()[axis]);
    let wide = particles.len() > 2 && axes().all(|axis| lattice.height(axis) >= 2.0);
    // Molecules are small, too, but seldom fill a cube of edge 1 that begins at the origin.
    let fills =
        |axis| matches!(range(particles, axis), [0.0..0.5, high] if (0.5..=1.0).contains(&high));
    (wide && axes().all(fills)).then(|| {
        assumed!(
            "all coordinates are between 0 and 1, and the box is larger; if they are fractions of \
             the box, multiply them by its vectors"
        )
    })
}

/// Doubts about particles at the upper faces of the box that repeat those at the lower ones.
fn twice(particles: &Particles, lattice: &Lattice) -> Option<Notice> {
    let heights = [0, 1, 2].map(|axis| lattice.height(axis));
    let size = heights.into_iter().filter(|height| height.is_finite()).fold(0.0, f64::max);
    let duals = [0, 1, 2].map(|axis| lattice.dual(axis));
    // The place of a particle in fractions of the box, and along open axes in units of its size.
    let place = |point: [f64; 3]| {
        let from: [f64; 3] = std::array::from_fn(|k| point[k] - lattice.origin()[k]);
        std::array::from_fn::<f64, 3, _>(|axis| match lattice.periodic()[axis] {
            true => (0..3).map(|k| duals[axis][k] * from[k]).sum(),
            false => from[axis] / size,
        })
    };
    let at = |axis: usize, face: f64, place: [f64; 3]| {
        lattice.periodic()[axis] && (place[axis] - face).abs() < AT_FACE
    };
    let key = |place: [f64; 3]| place.map(|x| (x / AT_FACE / 10.0).round() as i64);
    let on = |face: f64| {
        let places = points(particles).map(place).enumerate();
        places.filter(move |(_, place)| (0..3).any(|axis| at(axis, face, *place)))
    };
    let lower: HashMap<[i64; 3], usize> = on(0.0).map(|(k, place)| (key(place), k)).collect();
    let same = |(k, place): (usize, [f64; 3])| {
        let moved = std::array::from_fn(|axis| match at(axis, 1.0, place) {
            true => place[axis] - 1.0,
            false => place[axis],
        });
        lower.get(&key(moved)).map(|other| [k, *other])
    };
    let mut pairs = on(1.0).filter_map(same);
    let [k, other] = pairs.next()?;
    Some(assumed!(
        "{} of the particles repeat others across the box, such as {k} repeats {other} (from 0); if \
         atoms at its faces are written twice, leave out those at the upper faces",
        1 + pairs.count()
    ))
}

/// Doubts that a comment may be ignored, if one of its numbers is as large as the region of the
/// particles, or up to twice as large.
pub fn of_comment(comment: &str, particles: &Particles) -> Option<Notice> {
    let between = |c: char| c.is_whitespace() || "=,;:()[]{}\"'#%".contains(c);
    let words = comment.split(between).filter(|word| !word.is_empty());
    let numbers: Vec<f64> = words.filter_map(|word| number(word.as_bytes())).collect();
    if !(1..=9).contains(&numbers.len()) || particles.is_empty() {
        return None;
    }
    let extents = (0..particles.dim()).map(|axis| range(particles, axis)).map(|[a, b]| b - a);
    let extent = extents.fold(0.0, f64::max);
    let differences = numbers.windows(2).map(|two| two[1] - two[0]);
    let fits = |x: f64| x > 0.0 && x >= extent && x <= 2.0 * extent;
    numbers.iter().copied().chain(differences).any(fits).then(|| {
        assumed!(
            "'{}' may describe a box but is not read; if it does, give --box LX,LY,LZ, otherwise \
             --open",
            short(comment.trim())
        )
    })
}
