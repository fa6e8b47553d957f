//! A periodic box: which images a particle has.

mod reduced;

pub use reduced::Numbers;
pub(crate) use reduced::{AS_GIVEN, shifted};

/// The lattice of a periodic box: three vectors, and along which of them the scene repeats. Discs
/// use the first two.
///
/// The image of a point x by whole numbers S is x + S·H, the sum of S\[a\] times vector a over the
/// periodic vectors. Vectors may have any direction; simulation codes write them in lower
/// triangular form, the first along x, the second in the plane of x and y, whose off-diagonal
/// numbers are the tilt. Particles may be outside the box: every image of them is in the scene, so
/// it does not matter which one is named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    vectors: [[f64; 3]; 3],
    periodic: [bool; 3],
    origin: [f64; 3],
}

/// What is wrong with a box.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // the fields are explained by the messages
pub enum LatticeError {
    /// NaN or infinite.
    #[error("the box has a number {value}; vectors and corner must be finite: mend the box")]
    Finite { value: f64 },
    /// Zero, or in the span of the others, up to rounding.
    #[error(
        "the periodic vectors of the box enclose nothing: the distance of its faces along vector \
         {} is {}; mend the box, or make that axis open",
        vector + 1, shown(*height)
    )]
    Flat { vector: usize, height: f64 },
    /// Squares of its numbers overflow or vanish.
    #[error(
        "vector {} of the box is {} long, and squares of it leave the range of f64; take other \
         units",
        vector + 1, shown(*length)
    )]
    Range { vector: usize, length: f64 },
    /// Discs in a box that leaves their plane.
    #[error(
        "vector {} of the box leaves the plane of the discs: its z is {value}, and must be 0",
        vector + 1
    )]
    Plane { vector: usize, value: f64 },
}

/// Faces nearer than this part of their vector's length are taken for one, once vectors are as
/// short as can be: the dual vectors, from which filters are made, would have few digits left.
const FLATTEST: f64 = 1.0 / (1u64 << 30) as f64;

impl Lattice {
    /// Open space: a box that repeats along none of its vectors.
    pub const OPEN: Lattice = Lattice {
        vectors: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        periodic: [false; 3],
        origin: [0.0; 3],
    };

    /// A box of these vectors, periodic along those that are marked, with its corner at `origin`.
    /// Vectors along which it is open are looked at by no contact test.
    ///
    /// # Errors
    /// Numbers that are not finite, periodic vectors that do not span as many dimensions as they
    /// are (the shortest of the same lattice, up to 2^-30).
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
        // However far it is tilted.
        let (reduced, _) = lattice.reduced();
        for vector in (0..3).filter(|&vector| periodic[vector]) {
            let (height, length) = (reduced.height(vector), norm(reduced.vectors[vector]));
            // Also where a square overflows or vanishes, and there is no number.
            if !(height > FLATTEST * length && height.is_normal()) {
                let most = |v: usize| vectors[v].into_iter().fold(0.0f64, |m, x| m.max(x.abs()));
                let mut lengths = (0..3).filter(|&v| periodic[v]).map(|v| (v, most(v)));
                let out = |length: f64| length > 0.0 && !(length * length).is_normal();
                if let Some((vector, length)) = lengths.find(|(_, length)| out(*length)) {
                    return Err(LatticeError::Range { vector, length });
                }
                // Beside a vector of no length there is no direction, and it is the one to mend.
                let none = (0..3).find(|&v| periodic[v] && most(v) == 0.0);
                let height = if height.is_nan() { 0.0 } else { height };
                return Err(LatticeError::Flat { vector: none.unwrap_or(vector), height });
            }
        }
        Ok(lattice)
    }

    /// A box with edges along the axes and its corner at the origin.
    ///
    /// # Errors
    /// As [`Lattice::new`].
    pub fn along_axes(lengths: [f64; 3], periodic: [bool; 3]) -> Result<Lattice, LatticeError> {
        let [x, y, z] = lengths;
        Lattice::new([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], periodic, [0.0; 3])
    }

    /// The same box for discs: the third vector is left out.
    ///
    /// # Errors
    /// [`LatticeError::Plane`] if another periodic vector leaves the plane.
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

    /// The vectors, one per row.
    pub fn vectors(&self) -> &[[f64; 3]; 3] {
        &self.vectors
    }

    /// Along which vectors the scene repeats.
    pub fn periodic(&self) -> [bool; 3] {
        self.periodic
    }

    /// Does it repeat along any?
    pub fn repeats(&self) -> bool {
        self.periodic.contains(&true)
    }

    /// The corner of the box from which the vectors start. It decides no contact.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Is any periodic vector not along its axis?
    pub fn is_tilted(&self) -> bool {
        (0..3).any(|a| self.periodic[a] && (0..3).any(|k| k != a && self.vectors[a][k] != 0.0))
    }

    /// The distance between the two faces of the box that a periodic vector joins, in f64, with an
    /// error of some last places (relative to the vector's length). A particle whose reach is less
    /// does not meet its own image by that vector. Infinite where the box is open.
    pub fn height(&self, vector: usize) -> f64 {
        if self.periodic[vector] { norm(self.normal(vector)) } else { f64::INFINITY }
    }

    /// The dual of a periodic vector: its product with the vector is 1, with the other periodic
    /// ones 0, and along it a step of length 1 / [`Lattice::height`] changes the coordinate in
    /// units of the vector the most. In f64, with an error as that of the height.
    pub fn dual(&self, vector: usize) -> [f64; 3] {
        let normal = self.normal(vector);
        let square = dot(normal, normal);
        normal.map(|x| x / square)
    }

    /// What is left of a vector without its parts in the span of the other periodic ones.
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
        // Twice, since the first time leaves what rounding makes of a long part.
        for direction in [span[0], span[1], span[0], span[1]] {
            left = without(left, direction);
        }
        left
    }
}

/// A length, for messages.
fn shown(length: f64) -> String {
    if length == 0.0 { "0".into() } else { format!("{length:e}") }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = norm(a);
    a.map(|x| x / length)
}

/// `a` without its part along a direction of length 1.
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
        // A shear changes the height along the first vector, not along the second.
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
        assert!(flat.contains("along vector 1 is 0; mend"), "{flat}");
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
