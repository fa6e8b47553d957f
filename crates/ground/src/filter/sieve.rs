//! Finds which of a few chosen particles another particle may touch, by bins along each axis.
//!
//! Each axis is cut into [`BINS`] equal bins. Each bin has one bit for each chosen particle, which
//! is set if a particle in the bin may be within the margin of the chosen one along the axis. A
//! particle may touch the chosen particles whose bits are set in its bins of all axes.
//!
//! **No particle is lost.** The bin of x is fl(fl(x - low) · scale), rounded down and limited to
//! the bins. Each of these steps preserves order. If c - m <= x <= c + m, then fl(c - m) <= x <=
//! fl(c + m), because x is a double. So the bin of x is among those from fl(c - m) to fl(c + m).
//!
//! On a circle of length 1, x and c are at least 0 and at most 1, and x + k is within m of c for an
//! integer k. The bin of x is a multiple of [`BINS`] away from that of x + k. Because x + k need
//! not be a double, m is enlarged by 2^-40, which is more than the rounding of c - m or c + m. If m
//! is not below 1/2, all bins are set.

const BINS: i64 = 256;

pub struct Sieve<const A: usize> {
    words: usize,
    low: [f64; A],
    scale: [f64; A],
    /// Words of bits, by axis and bin.
    bits: Vec<u64>,
}

impl<const A: usize> Sieve<A> {
    /// Creates the sieve of particles at `chosen`, with a margin along each axis. `spans` holds the
    /// least and the largest coordinate along each axis, or `None` for a circle of length 1.
    pub fn new(chosen: &[[f64; A]], margin: [f64; A], spans: [Option<[f64; 2]>; A]) -> Sieve<A> {
        let words = chosen.len().div_ceil(64);
        let low = spans.map(|span| span.map_or(0.0, |[low, _]| low));
        let scale = spans.map(|span| BINS as f64 / span.map_or(1.0, |[low, high]| high - low));
        let mut sieve = Sieve { words, low, scale, bits: vec![0; A * BINS as usize * words] };
        for (k, at) in chosen.iter().enumerate() {
            for axis in 0..A {
                let circle = spans[axis].is_none();
                let margin = margin[axis] + if circle { 1.0 / (1u64 << 40) as f64 } else { 0.0 };
                let numbers = [at[axis] - margin, at[axis] + margin].map(|x| sieve.number(axis, x));
                let [first, last] = match circle {
                    true if margin < 0.5 => numbers,
                    true => [0, BINS - 1],
                    false => numbers.map(|number| number.clamp(0, BINS - 1)),
                };
                for bin in first..=last {
                    let row = sieve.row(axis, bin.rem_euclid(BINS));
                    sieve.bits[row + k / 64] |= 1 << (k % 64);
                }
            }
        }
        sieve
    }

    /// Calls `each` with the index of every chosen particle that may touch a particle at `at`.
    pub fn near(&self, at: &[f64; A], mut each: impl FnMut(usize)) {
        let row = |axis| self.row(axis, self.number(axis, at[axis]).clamp(0, BINS - 1));
        let rows: [usize; A] = std::array::from_fn(row);
        for word in 0..self.words {
            let mut left = rows.iter().fold(!0, |all, row| all & self.bits[row + word]);
            while left != 0 {
                each(64 * word + left.trailing_zeros() as usize);
                left &= left - 1;
            }
        }
    }

    /// Returns the unlimited number of a bin. If all coordinates are equal or their difference
    /// overflows, products that are not numbers count as 0, which preserves order.
    fn number(&self, axis: usize, x: f64) -> i64 {
        ((x - self.low[axis]) * self.scale[axis]).floor() as i64
    }

    fn row(&self, axis: usize, bin: i64) -> usize {
        (axis as i64 * BINS + bin) as usize * self.words
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_terms::mix::splitmix64;

    #[test]
    fn each_particle_within_the_margin_is_near_and_few_others() {
        let draw = |k: u64| splitmix64(k) as f64 / u64::MAX as f64;
        let chosen: Vec<[f64; 2]> =
            (0..100).map(|k| [draw(2 * k) * 1e3, draw(2 * k + 1)]).collect();
        let at = |k: usize| [draw(2 * k as u64 + 900) * 1e3, draw(2 * k as u64 + 901)];
        for margin in [[0.0, 0.0], [5.0, 0.3], [400.0, 0.005], [1e300, 0.6], [f64::INFINITY; 2]] {
            let sieve = Sieve::new(&chosen, margin, [Some([0.0, 1e3]), None]);
            let mut found = 0;
            for at in chosen.iter().copied().chain((0..2000).map(at)) {
                let mut near = Vec::new();
                sieve.near(&at, |k| near.push(k));
                found += near.len();
                for (k, c) in chosen.iter().enumerate() {
                    let along = (at[1] - c[1]).abs();
                    let within =
                        (at[0] - c[0]).abs() <= margin[0] && along.min(1.0 - along) <= margin[1];
                    assert!(!within || near.contains(&k), "{at:?} {c:?} {margin:?}");
                }
            }
            assert_eq!(found > 10_000, margin[1] > 0.5, "{found}");
            assert!(found >= 100, "each chosen particle is near itself");
        }
    }

    #[test]
    fn spans_without_a_width_or_that_overflow_keep_all() {
        for [low, high] in [[3.0, 3.0], [0.0, f64::from_bits(1)], [-f64::MAX, f64::MAX]] {
            let sieve = Sieve::new(&[[low], [high]], [high - low], [Some([low, high])]);
            for x in [low, high] {
                let mut near = Vec::new();
                sieve.near(&[x], |k| near.push(k));
                assert_eq!(near, [0, 1], "{x}");
            }
        }
    }
}
