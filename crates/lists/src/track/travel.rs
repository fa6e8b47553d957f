//! Displacements of particles: upper bounds from rounded squares.

/// Returns an upper bound of a distance in up to three dimensions from its computed square, Σ
/// fl(fl(x - y)²). The bound is never 0.
///
/// The true square is at most (1 + 8u) times the computed one plus 2^-1072
/// ([`contactbench_ground::filter`], section 5), where u = 2^-53. The code takes the root of (1 +
/// 16u) times the computed square plus 2^-960. This is larger, because its two roundings take less
/// than the other 8u. `sqrt` rounds correctly, so the next double is above the true root.
pub(super) fn at_most(square: f64) -> f64 {
    const BAND: f64 = 16.0 / (1u64 << 53) as f64;
    const FLOOR: f64 = f64::from_bits((1023 - 960) << 52);
    (square * (1.0 + BAND) + FLOOR).sqrt().next_up()
}

/// Returns an upper bound of the distance of two points in up to three dimensions.
pub fn distance_bound<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    at_most(square(a, b))
}

#[inline(always)]
pub(super) fn square<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).fold(0.0, |sum, k| {
        let d = a[k] - b[k];
        sum + d * d
    })
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TopTwo {
    pub first: f64,
    pub second: f64,
}

impl TopTwo {
    /// Takes a squared distance. Usually it is not among the two largest so far.
    #[inline(always)]
    pub fn take(&mut self, square: f64) {
        if square > self.second {
            self.replace(square);
        }
    }

    #[cold]
    #[inline(never)]
    fn replace(&mut self, square: f64) {
        self.second = if square > self.first { self.first } else { square };
        self.first = square.max(self.first);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_ground::contact::exact::{Label, label};

    #[test]
    fn no_way_is_longer_than_its_bound() {
        let mut tight = 0;
        for scale in [1.0, 1e-3, 1e-160, 1e-170, 1e-308, 5e-324, 1e160] {
            for k in 1..500 {
                let x = f64::from(k) / 7.0;
                let (a, b) =
                    ([x * scale, scale / 3.0, -x * scale], [0.1 * scale, x * scale, scale]);
                let bound = at_most(square(&a, &b));
                // A particle whose radius is the bound touches a point at this distance.
                assert!(label(&a, &b, bound, 0.0) != Label::Apart, "{a:?} {b:?} {bound}");
                tight += usize::from(label(&a, &b, bound * (1.0 - 4e-15), 0.0) == Label::Apart);
            }
        }
        assert!(tight > 990, "{tight}");
        assert_eq!(at_most(f64::INFINITY), f64::INFINITY);
    }

    #[test]
    fn the_largest_two_are_kept() {
        for squares in [[1.0, 2.0, 3.0], [3.0, 2.0, 1.0], [2.0, 3.0, 2.0], [3.0, 1.0, 2.0]] {
            let mut top = TopTwo::default();
            squares.iter().for_each(|&square| top.take(square));
            assert_eq!(top, TopTwo { first: 3.0, second: 2.0 }, "{squares:?}");
        }
        let mut top = TopTwo::default();
        [5.0, 5.0].iter().for_each(|&square| top.take(square));
        assert_eq!(top, TopTwo { first: 5.0, second: 5.0 });
    }
}
