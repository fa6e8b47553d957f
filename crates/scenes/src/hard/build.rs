//! Building blocks of the hard cases. Positions have three coordinates; 2D scenes drop the third.

use crate::generate::draw::Draw;
use contactbench_ground::scene::{Lattice, Radii, Scene, SceneError};
use contactbench_io::Given;

/// The scenes that one detector gets in turn, or an error if a scene is invalid.
pub type Steps = anyhow::Result<Vec<Given>>;

pub type Place = [f64; 3];

/// Centre and radius of a particle.
pub type Particle = (Place, f64);

/// Returns one step, with particles of equal radius.
pub fn uniform(dim: u32, places: impl IntoIterator<Item = Place>, r: f64) -> Steps {
    Ok(vec![scene(dim, places, r)?])
}

/// Returns one step, with particles that each have their own radius.
pub fn each(dim: u32, particles: impl IntoIterator<Item = Particle>) -> Steps {
    let (places, radii): (Vec<Place>, Vec<f64>) = particles.into_iter().unzip();
    Ok(vec![scene(dim, places, radii)?])
}

/// Returns one step, a lattice of equal particles, with `sites` per axis in 2D and in 3D.
pub fn grid(dim: u32, sites: [u32; 2], r: f64, at: impl Fn(f64) -> f64) -> Steps {
    uniform(dim, lattice(dim, sites, at), r)
}

/// Puts the scenes into a box with its corner at the origin.
pub fn in_box(steps: Steps, vectors: [Place; 3], periodic: [bool; 3]) -> Steps {
    let lattice = Lattice::new(vectors, periodic, [0.0; 3])?;
    steps?.into_iter().map(|step| Given::in_box(step.scene, lattice)).collect()
}

pub fn history(parts: impl IntoIterator<Item = Steps>) -> Steps {
    let parts = parts.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    Ok(parts.into_iter().flatten().collect())
}

fn scene(
    dim: u32,
    places: impl IntoIterator<Item = Place>,
    radii: impl Into<Radii<'static, f64>>,
) -> Result<Given, SceneError> {
    Ok(match dim {
        2 => Scene::at(places.into_iter().map(|[x, y, _]| [x, y]), radii)?.into(),
        _ => Scene::at(places, radii)?.into(),
    })
}

pub const fn two_to(k: i32) -> f64 {
    if k < -1022 {
        f64::from_bits(1 << (k + 1074))
    } else {
        f64::from_bits(((k + 1023) as u64) << 52)
    }
}

pub fn places(n: u32, at: impl Fn(f64) -> Place) -> Vec<Place> {
    (0..n).map(|k| at(f64::from(k))).collect()
}

/// Returns `n` positions drawn from one random sequence.
pub fn drawn(seed: u64, n: u32, mut place: impl FnMut(&mut Draw) -> Place) -> Vec<Place> {
    let mut draw = Draw::new(seed);
    (0..n).map(|_| place(&mut draw)).collect()
}

pub fn of_size(places: impl IntoIterator<Item = Place>, r: f64) -> impl Iterator<Item = Particle> {
    places.into_iter().map(move |place| (place, r))
}

/// Returns the position with coordinate `x` on one axis and `other` on the others.
pub fn on_axis(axis: usize, x: f64, other: f64) -> Place {
    std::array::from_fn(|k| if k == axis { x } else { other })
}

/// Returns a line of positions along every axis, with the coordinates `line` on that axis and
/// `park` on the others. If `park` is above all of `line`, lines do not meet, and on every axis the
/// smallest coordinate belongs to the line along it.
pub fn lines(dim: u32, line: &[f64], park: f64) -> Vec<Place> {
    let along = |axis| line.iter().map(move |&x| on_axis(axis, x, park));
    (0..dim as usize).flat_map(along).collect()
}

/// Returns a square or cubic lattice, with x fastest. `sites` holds the sites per axis in 2D and in
/// 3D; site k of an axis has the coordinate `at(k)`.
pub fn lattice(dim: u32, sites: [u32; 2], at: impl Fn(f64) -> f64) -> Vec<Place> {
    let m = by_dim(dim, sites);
    let layers = if dim == 2 { 1 } else { m };
    (0..m * m * layers).map(|k| [k % m, k / m % m, k / m / m].map(|i| at(f64::from(i)))).collect()
}

/// Returns the first value in 2D and the second in 3D.
pub fn by_dim<T>(dim: u32, values: [T; 2]) -> T {
    let [plane, space] = values;
    if dim == 2 { plane } else { space }
}

/// Returns all vectors of -1, 0 and 1 except zero; in 2D the third component is 0.
pub fn neighbours(dim: u32) -> Vec<Place> {
    let all = lattice(3, [3; 2], |k| k - 1.0).into_iter();
    all.filter(|v| (dim == 3 || v[2] == 0.0) && *v != [0.0; 3]).collect()
}

/// Returns all vectors of -1 and 1; in 2D the third component is 0.
pub fn corners(dim: u32) -> Vec<Place> {
    neighbours(dim).into_iter().filter(|v| v[..dim as usize].iter().all(|&x| x != 0.0)).collect()
}

/// Returns the vectors of this length along every axis, in both directions.
pub fn axes(dim: u32, length: f64) -> Vec<Place> {
    let both = |axis| [length, -length].map(|x| on_axis(axis, x, 0.0));
    (0..dim as usize).flat_map(both).collect()
}

pub fn plus(a: Place, s: f64, b: Place) -> Place {
    std::array::from_fn(|k| a[k] + s * b[k])
}

/// Returns position k of an endless staircase whose positions are at least `gap` apart.
pub fn site(k: usize, gap: f64) -> Place {
    [k % 8, k / 8, k % 3].map(|i| i as f64 * gap)
}

/// Returns the largest double y with y - x <= d in exact arithmetic.
pub fn reach_from(x: f64, d: f64) -> f64 {
    let sum = x + d;
    // `lost` is the rounding error (Knuth's two-sum): sum + lost = x + d.
    let part = sum - x;
    let lost = (x - (sum - part)) + (d - part);
    if lost < 0.0 { sum.next_down() } else { sum }
}
