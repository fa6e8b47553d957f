//! Periodic boxes: the vectors along which a scene repeats.

mod reduced;

pub use reduced::Numbers;
pub use reduced::{AS_GIVEN, shifted};

/// The lattice of a periodic box: three vectors, of which some or all are periodic, so that the
/// scene repeats along them. Discs use the first two.
///
/// The image of a point x by integers S is x + S·H, the sum of S\[a\] times vector a over the
/// periodic vectors. Vectors may have any direction. Simulation codes write them in lower
/// triangular form: the first along x, the second in the xy plane, with the tilt in the
/// off-diagonal numbers. Particles may be outside the box: the scene contains all their images, so
/// any image may be given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    vectors: [[f64; 3]; 3],
    periodic: [bool; 3],
    origin: [f64; 3],
}

/// Why a box is invalid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // the fields are explained by the messages
pub enum LatticeError {
    /// A number of the box is NaN or infinite.
    #[error("the box has a number {value}; vectors and corner must be finite: fix the box")]
    Finite { value: f64 },
    /// A periodic vector is zero or, up to rounding, a combination of the other ones.
    #[error(
        "the periodic vectors of the box enclose nothing: the distance of its faces along vector \
         {} is {}; fix the box, or make that axis open",
        vector + 1, shown(*height)
    )]
    Flat { vector: usize, height: f64 },
    /// The square of a vector's length overflows or underflows.
    #[error(
        "vector {} of the box is {} long, and squares of it leave the range of f64; use other \
         units",
        vector + 1, shown(*length)
    )]
    Range { vector: usize, length: f64 },
    /// A periodic vector of a box of discs is not in their plane.
    #[error(
        "vector {} of the box leaves the plane of the discs: its z is {value}, and must be 0",
        vector + 1
    )]
    Plane { vector: usize, value: f64 },
}

/// Smallest accepted height of a box relative to the vector's length, after reduction to the
/// shortest vectors. Below it the dual vectors, which filters need, would have few correct digits.
const FLATTEST: f64 = 1.0 / (1u64 << 30) as f64;

impl Lattice {
    /// Open space: a box that is not periodic along any vector.
    pub const OPEN: Lattice = Lattice {
        vectors: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        periodic: [false; 3],
        origin: [0.0; 3],
    };

    /// Creates a box from three vectors, of which `periodic` marks the periodic ones, with its
    /// corner at `origin`. Contact tests ignore vectors that are not periodic.
    ///
    /// # Errors
    /// Fails if a number is not finite, or if the periodic vectors are linearly dependent. The test
    /// uses the shortest vectors of the same lattice, with a tolerance of 2^-30.
    pub fn new(
        vectors: [[f64; 3]; 3],
        periodic: [bool; 3],
        origin: [f64; 3],
    ) -> Result<Lattice, LatticeError> {
        let mut numbers = vectors.as_flattened().iter().chain(&origin);
        if let Some(&value) = numbers.find(|value| !value.is_finite()) {
            return Err(LatticeError::Finite { value });
        }
        let lattice = Lattice { vectors, periodic, origin };
        // The heights of the reduced lattice do not depend on the tilt of the box.
        let (reduced, _) = lattice.reduced();
        for vector in (0..3).filter(|&vector| periodic[vector]) {
            let (height, length) = (reduced.height(vector), norm(reduced.vectors[vector]));
            // The condition is also true if a square overflows or underflows, so that the height is
            // NaN.
            if !(height > FLATTEST * length && height.is_normal()) {
                let most = |v: usize| vectors[v].into_iter().fold(0.0f64, |m, x| m.max(x.abs()));
                let mut lengths = (0..3).filter(|&v| periodic[v]).map(|v| (v, most(v)));
                let out = |length: f64| length > 0.0 && !(length * length).is_normal();
                if let Some((vector, length)) = lengths.find(|(_, length)| out(*length)) {
                    return Err(LatticeError::Range { vector, length });
                }
                // A zero vector is reported, because it makes the other vectors' heights undefined.
                let none = (0..3).find(|&v| periodic[v] && most(v) == 0.0);
                let height = if height.is_nan() { 0.0 } else { height };
                return Err(LatticeError::Flat { vector: none.unwrap_or(vector), height });
            }
        }
        Ok(lattice)
    }

    /// Creates a box with its edges along the axes and its corner at the origin. Fails as
    /// [`Lattice::new`].
    pub fn along_axes(lengths: [f64; 3], periodic: [bool; 3]) -> Result<Lattice, LatticeError> {
        let [x, y, z] = lengths;
        Lattice::new([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], periodic, [0.0; 3])
    }

    /// Returns this box for discs: its third vector is not periodic.
    ///
    /// # Errors
    /// Returns [`LatticeError::Plane`] if a periodic vector of the other two is not in the plane.
    pub fn flat(self) -> Result<Lattice, LatticeError> {
        let periodic = [self.periodic[0], self.periodic[1], false];
        for vector in (0..2).filter(|&vector| periodic[vector]) {
            let value = self.vectors[vector][2];
            if value != 0.0 {
                return Err(LatticeError::Plane { vector, value });
            }
        }
        Ok(Lattice { periodic, ..self })
    }

    /// Returns the vectors, one per row.
    pub fn vectors(&self) -> &[[f64; 3]; 3] {
        &self.vectors
    }

    /// Returns for each vector whether the scene repeats along it.
    pub fn periodic(&self) -> [bool; 3] {
        self.periodic
    }

    /// Returns whether the scene repeats along any vector.
    pub fn repeats(&self) -> bool {
        self.periodic.contains(&true)
    }

    /// Returns the corner of the box at which the vectors start. It does not affect contacts.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Returns whether any periodic vector is not along the axis with its index.
    pub fn is_tilted(&self) -> bool {
        (0..3).any(|a| self.periodic[a] && (0..3).any(|k| k != a && self.vectors[a][k] != 0.0))
    }

    /// Returns the distance between the two faces that a periodic vector connects, with an error of
    /// a few ulps of the vector's length, or infinity if the box is open along it. A particle whose
    /// diameter is smaller does not touch its own image by that vector.
    pub fn height(&self, vector: usize) -> f64 {
        if self.periodic[vector] { norm(self.normal(vector)) } else { f64::INFINITY }
    }

    /// Returns the dual of a periodic vector: its product with the vector is 1, and with the other
    /// periodic vectors 0. Its length is 1 / [`Lattice::height`], with the same relative error.
    pub fn dual(&self, vector: usize) -> [f64; 3] {
        let normal = self.normal(vector);
        let square = dot(normal, normal);
        normal.map(|x| x / square)
    }

    /// Returns the part of a vector that is orthogonal to the other periodic vectors.
    fn normal(&self, vector: usize) -> [f64; 3] {
        let mut left = self.vectors[vector];
        let mut others = (0..3).filter(|&k| k != vector && self.periodic[k]);
        let (first, second) = (others.next(), others.next());
        let mut span = [[0.0; 3]; 2];
        if let Some(first) = first {
            span[0] = unit(self.vectors[first]);
        }
        if let Some(second) = second {
            span[1] = unit(without(self.vectors[second], span[0]));
        }
        // Each direction is subtracted twice: rounding of a long part leaves a remainder the first
        // time.
        for direction in [span[0], span[1], span[0], span[1]] {
            left = without(left, direction);
        }
        left
    }
}

fn shown(length: f64) -> String {
    if length == 0.0 { "0".into() } else { format!("{length:e}") }
}

#[inline]
pub fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

pub fn norm<const D: usize>(a: [f64; D]) -> f64 {
    dot(a, a).sqrt()
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = norm(a);
    a.map(|x| x / length)
}

fn without(a: [f64; 3], direction: [f64; 3]) -> [f64; 3] {
    let part = dot(a, direction);
    std::array::from_fn(|k| a[k] - part * direction[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_distances_of_faces() {
        let cube = Lattice::along_axes([2.0, 3.0, 4.0], [true, true, false]).unwrap();
        assert_eq!([0, 1, 2].map(|a| cube.height(a)), [2.0, 3.0, f64::INFINITY]);
        assert!(cube.repeats() && !cube.is_tilted());
        // The shear changes the height along the first vector, but not along the second.
        let sheared = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let sheared = Lattice::new(sheared, [true; 3], [0.0; 3]).unwrap();
        assert!((sheared.height(0) - 0.5f64.sqrt()).abs() < 1e-15);
        assert!((sheared.height(1) - 1.0).abs() < 1e-15 && sheared.is_tilted());
        let dual = sheared.dual(0);
        assert!((dual[0] - 1.0).abs() < 1e-15 && (dual[1] + 1.0).abs() < 1e-15);
        let wild = [[0.2, 1.2, 1.4], [1.4, 0.1, 1.6], [1.3, 2.0, -0.1]];
        let wild = Lattice::new(wild, [true; 3], [0.0; 3]).unwrap();
        for a in 0..3 {
            for b in 0..3 {
                let expected = f64::from(u8::from(a == b));
                assert!((dot(wild.dual(a), wild.vectors()[b]) - expected).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn boxes_that_enclose_nothing_are_refused() {
        let of = |vectors, periodic| Lattice::new(vectors, periodic, [0.0; 3]);
        let plane = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        assert!(matches!(of(plane, [true; 3]), Err(LatticeError::Flat { .. })));
        assert!(of(plane, [true, true, false]).is_ok());
        assert!(of(plane, [true, false, true]).is_ok());
        assert!(of([[0.0; 3]; 3], [false; 3]).is_ok());
        assert!(matches!(
            of([[0.0; 3]; 3], [true, false, false]),
            Err(LatticeError::Flat { vector: 0, .. })
        ));
        for length in [1e200, 1e-200] {
            let edges = [[1.0, 0.0, 0.0], [0.0, length, 0.0], [0.0, 0.0, 1.0]];
            assert_eq!(of(edges, [true; 3]), Err(LatticeError::Range { vector: 1, length }));
            assert!(of(edges, [true, false, true]).is_ok());
        }
        let flat = of([[0.0; 3]; 3], [true, false, false]).unwrap_err().to_string();
        assert!(flat.contains("along vector 1 is 0; fix"), "{flat}");
        let bad = [[f64::NAN, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        assert!(matches!(of(bad, [false; 3]), Err(LatticeError::Finite { .. })));
        let out = [[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(matches!(
            of(out, [true; 3]).unwrap().flat(),
            Err(LatticeError::Plane { vector: 0, .. })
        ));
        assert!(!of(out, [false, true, true]).unwrap().flat().unwrap().periodic()[2]);
    }
}
