//! A scene as a list of numbers, which the shrinker changes one by one.

use contactbench_ground::scene::{AnyScene, Radii, Real, SceneError, array};
use contactbench_ground::with_scene;

#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    pub dim: usize,
    /// Coordinates and radius of each particle: `dim + 1` numbers.
    pub values: Vec<f64>,
}

impl Numbers {
    pub fn new(scene: &AnyScene<'_>) -> Numbers {
        let mut values = Vec::with_capacity(scene.len() * (scene.dim() + 1));
        with_scene!(scene, scene => for (k, centre) in scene.centres().iter().enumerate() {
            values.extend(array(centre).iter().map(|x| x.wide()));
            values.push(scene.radius(k).wide());
        });
        Numbers { dim: scene.dim(), values }
    }

    pub fn stride(&self) -> usize {
        self.dim + 1
    }

    pub fn len(&self) -> usize {
        self.values.len() / self.stride()
    }

    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    pub fn radii(&self) -> impl Iterator<Item = f64> {
        self.values.iter().skip(self.dim).step_by(self.stride()).copied()
    }

    pub fn mixed(&self) -> bool {
        self.radii().any(|r| r != self.values[self.dim])
    }

    /// Returns the scene, as if read from a file of these numbers: equal radii become one.
    pub fn scene(&self) -> Result<AnyScene<'static>, SceneError> {
        match self.values.get(self.dim) {
            Some(&r) if !self.mixed() => self.scene_of(r),
            _ => self.scene_of(self.radii().collect::<Vec<_>>()),
        }
    }

    /// Returns the scene with these radii instead of its own.
    pub fn scene_of(
        &self,
        radii: impl Into<Radii<'static, f64>>,
    ) -> Result<AnyScene<'static>, SceneError> {
        let all = self.values.chunks_exact(self.stride());
        match self.dim {
            2 => AnyScene::at(all.map(|it| [it[0], it[1]]), radii),
            _ => AnyScene::at(all.map(|it| [it[0], it[1], it[2]]), radii),
        }
    }
}

/// Number of significant bits of the mantissa: 0 for 0, 1 for powers of two, at most 53.
pub fn bits(x: f64) -> u32 {
    if x == 0.0 {
        return 0;
    }
    // `frexp` returns a fraction from 1/2 to 1, also for subnormal numbers.
    let (fraction, _) = libm::frexp(x);
    53 - (fraction.to_bits() & ((1 << 52) - 1)).trailing_zeros().min(52)
}

pub fn rounded(x: f64, count: u32) -> f64 {
    let (fraction, exponent) = libm::frexp(x);
    libm::scalbn(libm::round(libm::scalbn(fraction, count as i32)), exponent - count as i32)
}

pub fn scaled(x: f64, exponent: i32) -> Option<f64> {
    let scaled = libm::scalbn(x, exponent);
    (scaled.is_finite() && libm::scalbn(scaled, -exponent) == x).then_some(scaled)
}

pub fn difference(a: f64, b: f64) -> Option<f64> {
    // Knuth's TwoSum computes the rounding error of a - b.
    let d = a - b;
    let part = d - a;
    let error = (a - (d - part)) + (-b - part);
    // After an overflow, the error is NaN.
    (error == 0.0).then_some(d)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_counted_and_rounded_also_of_subnormals() {
        let cases = [
            (0.0, 0),
            (-0.0, 0),
            (1.0, 1),
            (-0.75, 2),
            (10.0, 3),
            (1.0f64.next_down(), 53),
            (0.1, 52),
            (f64::from_bits(1), 1),
            (f64::MAX, 53),
        ];
        for (x, count) in cases {
            assert_eq!(bits(x), count, "{x:e}");
            assert_eq!(rounded(x, 53), x, "{x:e}");
            assert!(
                (1..53).all(|k| bits(rounded(x, k)) <= k || rounded(x, k).is_infinite()),
                "{x:e}"
            );
        }
        assert_eq!(
            [rounded(0.1, 1), rounded(0.7, 1), rounded(-11.0, 3), rounded(f64::from_bits(5), 2)],
            [0.125, 0.5, -12.0, 3e-323]
        );
        assert_eq!(bits(f64::from_bits(0b1011)), 4);
    }

    #[test]
    fn only_exact_results_are_given() {
        assert_eq!(
            (difference(3.0, 1.0), difference(1e300, -1.0), difference(f64::MAX, -f64::MAX)),
            (Some(2.0), None, None)
        );
        assert_eq!(
            (scaled(3.0, -2), scaled(f64::from_bits(3), -1), scaled(1.0, 1024)),
            (Some(0.75), None, None)
        );
        assert_eq!(scaled(f64::from_bits(1), 1074), Some(1.0));
    }

    #[test]
    fn a_scene_is_its_numbers() {
        for (dim, values) in [
            (2, vec![0.0, 1.0, 0.5, 2.0, 3.0, 0.5]),
            (3, vec![0.0, 1.0, 2.0, 0.5, 2.0, 3.0, 4.0, 0.25]),
            (2, vec![]),
        ] {
            let numbers = Numbers { dim, values };
            let scene = numbers.scene().unwrap();
            assert_eq!(
                (Numbers::new(&scene), scene.uniform()),
                (numbers.clone(), dim == 2 && !numbers.is_empty())
            );
        }
    }
}
