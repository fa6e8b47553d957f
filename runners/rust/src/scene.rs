//! A scene file, and the exact contact test.

use std::array;

/// Discs or spheres at rest, in open space.
pub struct Scene<const D: usize> {
    pub centres: Vec<[f64; D]>,
    /// One radius for all particles, or one for each.
    radii: Vec<f64>,
    /// Largest distance at which two particles touch.
    pub reach: f64,
}

/// Coordinates and radii other than 0 must be within 2^-400 and 2^400: the products of such numbers
/// and of their rounding errors are exact sums of two f64.
const LARGEST: f64 = f64::from_bits((1023 + 400) << 52);

impl<const D: usize> Scene<D> {
    /// Makes the scene of the rows of a file, with a column of radii unless `radius` is given.
    pub fn new(rows: &[f64], radius: Option<f64>) -> Result<Scene<D>, String> {
        let extreme = |x: &f64| *x != 0.0 && !(1.0 / LARGEST..=LARGEST).contains(&x.abs());
        if let Some(x) = rows.iter().chain(&radius).find(|x| extreme(x)) {
            return Err(format!(
                "the scene has the number {x:e}, not within 2^-400 and 2^400; scale it"
            ));
        }
        let width = D + usize::from(radius.is_none());
        let rows = rows.chunks_exact(width);
        let radii = match radius {
            Some(radius) => vec![radius],
            None => rows.clone().map(|row| row[D]).collect(),
        };
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let centres = rows.map(|row| array::from_fn(|k| row[k])).collect();
        Ok(Scene { centres, radii, reach: 2.0 * largest })
    }

    pub fn radius(&self, i: u32) -> f64 {
        if self.radii.len() == 1 { self.radii[0] } else { self.radii[i as usize] }
    }

    /// Returns the smallest and the largest coordinates; the origin if there are no particles.
    pub fn bounds(&self) -> [[f64; D]; 2] {
        let first = self.centres.first().copied().unwrap_or([0.0; D]);
        self.centres.iter().fold([first; 2], |[low, high], p| {
            [array::from_fn(|k| low[k].min(p[k])), array::from_fn(|k| high[k].max(p[k]))]
        })
    }

    /// Returns whether the particles touch, decided exactly.
    #[inline]
    pub fn touch(&self, i: u32, j: u32) -> bool {
        let (a, b) = (&self.centres[i as usize], &self.centres[j as usize]);
        let square: f64 = (0..D).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
        let sum = self.radius(i) + self.radius(j);
        // Both sides are off by less than 2^-49 of themselves.
        let doubt = (square + sum * sum) * f64::EPSILON * 8.0;
        if (square - sum * sum).abs() > doubt { square < sum * sum } else { self.decide(i, j) }
    }

    /// Compares the squares without rounding.
    #[cold]
    fn decide(&self, i: u32, j: u32) -> bool {
        // Parts whose sum is exact, each beyond the bits of the previous one.
        let mut parts: Vec<f64> = Vec::new();
        let mut add = |mut x: f64| {
            for part in &mut parts {
                (x, *part) = two_sum(x, *part);
            }
            parts.push(x);
        };
        let mut add_square = |[high, low]: [f64; 2], sign: f64| {
            for (x, y) in [(high, high), (high, low), (high, low), (low, low)] {
                add(sign * x * y);
                add(sign * x.mul_add(y, -(x * y)));
            }
        };
        for k in 0..D {
            let (a, b) = (self.centres[i as usize][k], self.centres[j as usize][k]);
            add_square(two_sum(a, -b).into(), 1.0);
        }
        add_square(two_sum(self.radius(i), self.radius(j)).into(), -1.0);
        parts.iter().rev().find(|part| **part != 0.0).is_none_or(|part| *part < 0.0)
    }
}

/// Returns the rounded sum and its error (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let rest = sum - a;
    (sum, (a - (sum - rest)) + (b - rest))
}

/// Returns the numbers of an npy file, version 1, of type `<f8`.
pub fn numbers(path: &str, count: usize) -> Result<Vec<f64>, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("cannot read {path}: {error}"))?;
    let head = bytes.get(8..10).map_or(0, |size| usize::from(size[0]) | usize::from(size[1]) << 8);
    let data = bytes.get(10 + head..).unwrap_or_default();
    if !bytes.starts_with(b"\x93NUMPY\x01") || data.len() != 8 * count {
        return Err(format!("{path} is not an npy file of {count} numbers"));
    }
    let (words, _) = data.as_chunks::<8>();
    Ok(words.iter().map(|word| f64::from_le_bytes(*word)).collect())
}

/// Writes pairs as an npy file, version 1, of type `<u4`.
pub fn write(path: &str, pairs: &[[u32; 2]]) -> Result<(), String> {
    let head =
        format!("{{'descr': '<u4', 'fortran_order': False, 'shape': ({}, 2), }}", pairs.len());
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{head:117}\n").bytes());
    bytes.extend(pairs.as_flattened().iter().flat_map(|i| i.to_le_bytes()));
    std::fs::write(path, bytes).map_err(|error| format!("cannot write {path}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_are_decided_exactly() {
        // The squares of 3, 4 and 5, and their neighbours, where rounded sums err.
        let [less, more] = [5f64.next_down(), 5f64.next_up()];
        for (distance, touch) in [(less, true), (5.0, true), (more, false)] {
            let scene = Scene::<2>::new(&[0.0, 0.0, distance, 0.0], Some(2.5)).unwrap();
            assert_eq!(scene.touch(0, 1), touch, "{distance}");
        }
        for (x, touch) in [(3f64.next_down(), true), (3.0, true), (3f64.next_up(), false)] {
            let scene = Scene::<2>::new(&[x, 4.0, 2.5, 0.0, 0.0, 2.5], None).unwrap();
            assert_eq!(scene.touch(0, 1), touch, "{x}");
        }
        assert!(Scene::<2>::new(&[1e200, 0.0], Some(1.0)).is_err());
        assert!(Scene::<2>::new(&[1.0, 0.0], Some(1e-200)).is_err());
    }
}
