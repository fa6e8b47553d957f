//! What the cases are built of. Places have three coordinates; in the plane the third is dropped.

use nalgebra::Point;

use contactbench_core::scene::{Lattice, Radii, Scene, SceneError};
use contactbench_io::Given;

/// The steps of a case, or why there is no such scene.
pub type Steps = anyhow::Result<Vec<Given>>;

/// A centre.
pub type Place = [f64; 3];

/// One step: bodies of one radius.
pub fn uniform(dim: u32, places: &[Place], r: f64) -> Steps {
    Ok(vec![scene(dim, places.iter(), Radii::Uniform(r))?])
}

/// One step: bodies with a radius each.
pub fn each(dim: u32, bodies: &[(Place, f64)]) -> Steps {
    let radii: Vec<f64> = bodies.iter().map(|(_, r)| *r).collect();
    Ok(vec![scene(dim, bodies.iter().map(|(place, _)| place), Radii::Each(radii.into()))?])
}

/// The same steps in a box that repeats along some of its vectors, with its corner at the origin.
pub fn in_box(steps: Steps, vectors: [Place; 3], periodic: [bool; 3]) -> Steps {
    let lattice = Lattice::new(vectors, periodic, [0.0; 3])?;
    steps?.into_iter().map(|step| Given::in_box(step.scene, lattice)).collect()
}

/// The steps of all parts, in order.
pub fn history(parts: impl IntoIterator<Item = Steps>) -> Steps {
    let parts = parts.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    Ok(parts.into_iter().flatten().collect())
}

fn scene<'a>(
    dim: u32,
    places: impl Iterator<Item = &'a Place>,
    radii: Radii<'static, f64>,
) -> Result<Given, SceneError> {
    Ok(if dim == 2 {
        Scene::new(places.map(|&[x, y, _]| Point::from([x, y])).collect::<Vec<_>>(), radii)?.into()
    } else {
        Scene::new(places.map(|&place| Point::from(place)).collect::<Vec<_>>(), radii)?.into()
    })
}

/// 2^k.
pub const fn two_to(k: i32) -> f64 {
    if k < -1022 {
        f64::from_bits(1 << (k + 1074))
    } else {
        f64::from_bits(((k + 1023) as u64) << 52)
    }
}

/// A line along every axis: the coordinates `line` on that axis, `park` on the others. With a
/// `park` far from all of the line, lines do not meet, and with one above them all the smallest
/// coordinate on every axis is that of the line.
pub fn lines(dim: u32, line: &[f64], park: f64) -> Vec<Place> {
    let along = |axis: usize, x: f64| std::array::from_fn(|k| if k == axis { x } else { park });
    (0..dim as usize).flat_map(|axis| line.iter().map(move |&x| along(axis, x))).collect()
}

/// A square or cubic lattice of `m` sites per axis, x first; site k of an axis has the coordinate
/// `at(k)`.
pub fn lattice(dim: u32, m: u32, at: impl Fn(f64) -> f64) -> Vec<Place> {
    let layers = if dim == 2 { 1 } else { m };
    (0..m * m * layers).map(|k| [k % m, k / m % m, k / m / m].map(|i| at(f64::from(i)))).collect()
}

/// The first of two numbers in the plane, the second in space.
pub fn by_dim<T>(dim: u32, values: [T; 2]) -> T {
    let [plane, space] = values;
    if dim == 2 { plane } else { space }
}

/// All vectors of `dim` components -1, 0 and 1 but the one of zeros.
pub fn neighbours(dim: u32) -> Vec<Place> {
    let all = lattice(3, 3, |k| k - 1.0).into_iter();
    all.filter(|v| (dim == 3 || v[2] == 0.0) && *v != [0.0; 3]).collect()
}

/// All vectors of `dim` components -1 and 1; in the plane the third is 0.
pub fn corners(dim: u32) -> Vec<Place> {
    neighbours(dim).into_iter().filter(|v| v[..dim as usize].iter().all(|&x| x != 0.0)).collect()
}

/// a + s·b.
pub fn plus(a: Place, s: f64, b: Place) -> Place {
    std::array::from_fn(|k| a[k] + s * b[k])
}

/// Place k of an endless staircase of places that are at least `gap` apart.
pub fn site(k: usize, gap: f64) -> Place {
    [k % 8, k / 8, k % 3].map(|i| i as f64 * gap)
}

/// The largest double y with y - x <= d in exact arithmetic.
pub fn reach_from(x: f64, d: f64) -> f64 {
    let sum = x + d;
    // What rounding took away (Knuth's two-sum): sum + lost = x + d.
    let part = sum - x;
    let lost = (x - (sum - part)) + (d - part);
    if lost < 0.0 { sum.next_down() } else { sum }
}
