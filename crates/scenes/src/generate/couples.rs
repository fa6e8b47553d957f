//! `couples`: couples at the very border of the contact test, each astride a border of the
//! textbook's cells.
//!
//! ```text
//!   |   o|o    |   o|o    |
//!   |    |     |    |     |
//!   |   o|o    |   o|o    |
//! ```
//!
//! The cells of edge D begin at the lowest coordinate; the centres of a couple are D apart, the
//! left one at a border, give or take the rounding error of (x - xmin) / D.
//!
//! On such couples rounding of (x - xmin) / D may put the members two cells apart, and a detector
//! without a margin loses the contact. It does so where coordinates have more bits than x - xmin:
//! near x = 0, when the lowest coordinate is negative. So one couple stands at the lowest
//! coordinate, `offset`, and all others in columns 3D apart that begin at the border next to x = 0
//! (at `offset`, if that is positive). The right member is at the largest double that still touches
//! in exact arithmetic: n / 2 pairs (rounded down) touch.

use anyhow::ensure;

use crate::generate::draw::Draw;
use crate::generate::table::{Generator, Kind, number};
use crate::generate::{DIAMETER, Inputs, room};
use contactbench_core::contact::exact;
use contactbench_core::scene::{Radii, Scene};

pub const GENERATOR: Generator = Generator {
    name: "couples",
    summary: "couples that just touch, astride borders of textbook cells",
    params: &[&[
        DIAMETER,
        number(
            "offset",
            Kind::FINITE,
            0.0,
            "lowest x, in diameters, from -10^12 to 10^12; rounded to f64",
        ),
    ]],
    make: |inputs| {
        Ok(if inputs.dim == 2 { make::<2>(inputs)?.into() } else { make::<3>(inputs)?.into() })
    },
    ..Generator::PLAIN
};

/// The double next to low + d·k, or its neighbour: near 0 that has far more bits than a rounded sum
/// of the two.
fn border(low: f64, d: f64, k: f64) -> f64 {
    let product = d * k;
    let sum = low + product;
    // What the product and the sum have lost, without error (Knuth, Dekker); a fused multiply-add
    // is fixed by IEEE 754.
    let rest = d.mul_add(k, -product);
    let part = sum - low;
    sum + ((low - (sum - part)) + (product - part) + rest)
}

fn make<const D: usize>(inputs: &Inputs<'_>) -> anyhow::Result<Scene<'static, f64, D>> {
    let mut draw = Draw::new(inputs.seed);
    let d = inputs.number("diameter")?;
    let offset = inputs.number("offset")?;
    ensure!(
        offset.abs() <= 1e12,
        "couples: offset is {offset}; it must be from -10^12 to 10^12, or couples could not be \
         told apart"
    );
    let low = offset * d;
    let start = if low < 0.0 { (-low / d).ceil() } else { 0.0 };
    let row = |k: u64| 3.0 * d * k as f64;
    let couples = inputs.n.div_ceil(2);
    // As many along x as in all rows together, or in each of them where there are rows in two
    // directions.
    let across = (1..).find(|&m: &u64| m.saturating_pow(D as u32) >= couples).unwrap_or(1);
    let mut points = room(inputs.n + 1)?;
    for k in 0..couples {
        let cells = start + 3.0 * (k % across) as f64;
        let astray = d * cells * f64::EPSILON * draw.symmetric();
        let mut left =
            [border(low, d, cells) + astray, row(k / across % across), row(k / across / across)];
        if k == 0 {
            left[0] = low;
        }
        let mut right = left;
        right[0] = (left[0] + d).next_up();
        while right[0] > left[0] && exact::compare(&left, &right, 0.5 * d, 0.5 * d).is_gt() {
            right[0] = right[0].next_down();
        }
        points.extend(
            [left, right].map(|p| nalgebra::Point::from(std::array::from_fn(|axis| p[axis]))),
        );
    }
    points.truncate(usize::try_from(inputs.n)?);
    // Only an overflow can spoil a generated scene.
    Scene::new(points, Radii::Uniform(0.5 * d)).map_err(|_| crate::generate::beyond())
}
