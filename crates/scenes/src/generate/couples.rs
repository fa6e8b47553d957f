//! `couples`: pairs that just touch, each across a border of the textbook's cells.
//!
//! ```text
//!   |   o|o    |   o|o    |
//!   |    |     |    |     |
//!   |   o|o    |   o|o    |
//! ```
//!
//! Cells have the edge D and begin at the lowest coordinate. The centres of a pair are D apart. The
//! left centre is on a cell border, up to the rounding error of (x - xmin) / D.
//!
//! Rounding of (x - xmin) / D may put the two particles two cells apart, so that a detector without
//! a margin misses the contact. This happens if x has more significant bits than x - xmin: near x =
//! 0, with a negative lowest coordinate. So one pair is at the lowest coordinate, `offset`. All
//! others are in columns 3D apart, from the border next to x = 0 (from `offset`, if it is
//! positive). The right particle is at the largest double that still touches in exact arithmetic,
//! so n / 2 pairs (rounded down) touch.

use anyhow::ensure;

use crate::generate::draw::Draw;
use crate::generate::table::{Generator, ParameterKind, parameter};
use crate::generate::{DIAMETER, Inputs, room};
use contactbench_ground::contact::exact;
use contactbench_ground::scene::Scene;

pub const GENERATOR: Generator = Generator {
    name: "couples",
    summary: "pairs that just touch, across borders of textbook cells",
    params: &[&[
        DIAMETER,
        parameter(
            "offset",
            ParameterKind::FINITE,
            "0",
            "lowest x, in diameters, from -10^12 to 10^12; rounded to f64",
        ),
    ]],
    make: |inputs| {
        Ok(if inputs.dim == 2 { make::<2>(inputs)?.into() } else { make::<3>(inputs)?.into() })
    },
    ..Generator::PLAIN
};

/// Returns the double nearest to low + d·k, or its neighbour. Near 0 it is far more precise than a
/// rounded sum.
fn border(low: f64, d: f64, k: f64) -> f64 {
    let product = d * k;
    let sum = low + product;
    // Exact errors of product and sum (Knuth, Dekker); IEEE 754 defines fused multiply-add.
    let rest = d.mul_add(k, -product);
    let part = sum - low;
    sum + ((low - (sum - part)) + (product - part) + rest)
}

fn make<const D: usize>(inputs: &Inputs<'_>) -> anyhow::Result<Scene<'static, f64, D>> {
    let mut draw = Draw::new(inputs.seed);
    let d = inputs.number("diameter")?;
    let offset = inputs.number("offset")?;
    ensure!(offset.abs() <= 1e12, "couples: offset is {offset}; it must be from -10^12 to 10^12");
    let low = offset * d;
    let start = if low < 0.0 { (-low / d).ceil() } else { 0.0 };
    let row = |k: u64| 3.0 * d * k as f64;
    let couples = inputs.n.div_ceil(2);
    // The smallest m with m^D at least the number of pairs.
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
        points.extend([left, right].map(|p| std::array::from_fn(|axis| p[axis])));
    }
    points.truncate(usize::try_from(inputs.n)?);
    Scene::at(points, 0.5 * d).map_err(|_| crate::generate::beyond())
}
