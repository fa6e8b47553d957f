//! Sixteen floats at a time: an abstraction over vector instructions.
//!
//! A kernel is written once, over [`Wide`] or one [`Register`], and compiled for every instruction
//! set. [`Level::best`] selects the widest set that the processor has at run time, so one binary
//! serves all machines. A value of a type that implements [`Register`] proves that its instructions
//! may be used: either every processor of the architecture has them, or only `detect` creates one.
//!
//! | level | registers | instructions |
//! |---|---|---|
//! | `avx512` | one of 16 floats | AVX-512 F, BW, DQ, VL |
//! | `avx2` | two of 8 floats | AVX2 and FMA |
//! | `neon` | four of 4 floats | NEON, part of aarch64 |
//! | `portable` | four of 4 floats | SSE2, part of x86-64; elsewhere plain Rust |
//!
//! Levels may round differently (a fused multiply-add rounds once), by less than one part in 2^22
//! in a sum of three squares. Detectors leave pairs that this could change to the contact test, so
//! their pairs do not depend on the level.

use std::mem::MaybeUninit;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "aarch64")]
mod neon;
#[cfg(any(test, not(target_arch = "x86_64")))]
mod portable;
mod register;
#[cfg(target_arch = "x86_64")]
mod sse2;

#[cfg(target_arch = "x86_64")]
pub use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub use avx512::Avx512;
#[cfg(target_arch = "aarch64")]
pub use neon::Neon;
#[cfg(any(test, not(target_arch = "x86_64")))]
pub use portable::Portable;
pub use register::Register;
pub use register::read;
#[cfg(target_arch = "x86_64")]
pub use sse2::Sse2;

/// The instructions that every processor of this architecture has.
#[cfg(target_arch = "x86_64")]
pub type Baseline = Sse2;
/// The instructions that every processor of this architecture has.
#[cfg(not(target_arch = "x86_64"))]
pub type Baseline = Portable;

/// Fills an array in a loop. The closure of `std::array::from_fn` may remain a call, and takes five
/// times as long to compile.
#[inline(always)]
#[expect(clippy::needless_range_loop, reason = "an iterator takes longer to compile")]
pub fn fill<A: Copy + Default, const N: usize>(mut f: impl FnMut(usize) -> A) -> [A; N] {
    let mut filled = [A::default(); N];
    for k in 0..N {
        filled[k] = f(k);
    }
    filled
}

/// Number of lanes of a vector.
pub const LANES: usize = 16;
/// Half the number of lanes of a vector.
pub const HALF: usize = LANES / 2;

/// A place for a pair of numbers.
pub type Slot = MaybeUninit<[u32; 2]>;

/// A point and its number, adjacent in memory. In two dimensions the last coordinate is 0.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub struct Spot {
    /// Coordinates of the point, in single precision.
    pub at: [f32; 3],
    /// Number by which callers know the point, usually of a particle.
    pub id: u32,
}

const _: () = assert!(size_of::<Spot>() == 16 && align_of::<Spot>() == 16);

impl Spot {
    /// Returns the squared distance of two points, rounded as in [`Wide::squares`].
    #[inline(always)]
    pub fn square(&self, other: &Spot) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.at[axis] - other.at[axis]);
        x * x + y * y + z * z
    }
}

/// Vectors of [`LANES`] floats in one instruction set. Masks have one bit per lane, the first lane
/// in the lowest bit.
pub trait Wide: Copy + Send + Sync {
    /// Type of the registers that hold the sixteen lanes.
    type Register: Register;
    /// Returns the proof that a register's instructions may be used.
    fn register(self) -> Self::Register;
    /// Type of a vector of [`LANES`] floats.
    type Floats: Copy;
    /// Returns a vector with the same number in every lane.
    fn all(self, x: f32) -> Self::Floats;
    /// Loads sixteen floats.
    fn load(self, from: &[f32; LANES]) -> Self::Floats;
    /// Loads the lower eight lanes from `low` and the upper eight from `high`.
    fn load_two(self, low: &[f32; HALF], high: &[f32; HALF]) -> Self::Floats;
    /// Returns a + b in each lane.
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// Returns a - b in each lane.
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// Returns a · b in each lane.
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// Returns a · b + c in each lane, rounded once or twice.
    fn mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    /// Returns the larger of a and b in each lane, or b if a is NaN.
    fn max(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// Returns a mask of the lanes with a <= b.
    fn at_most(self, a: Self::Floats, b: Self::Floats) -> u32;
    /// Writes the first eight ids that `mask` selects to the front of `to`; the rest of `to` is
    /// unspecified. The lower eight ids are in `low`, the others in `high`.
    fn pack_two(self, low: &[u32; HALF], high: &[u32; HALF], mask: u32, to: &mut [u32; HALF]);
    /// Writes the pair (i, ids\[k\]) to `to`\[k\], for each k.
    fn pair(self, i: u32, ids: &[u32; HALF], to: &mut [Slot; HALF]);
    /// Writes the pairs (i, ids\[k\]) of the lanes k that `mask` selects to the front of `to`; the
    /// rest of `to` is unspecified.
    fn pairs(self, i: u32, ids: &[u32; LANES], mask: u32, to: &mut [Slot; LANES]);
    /// Type of a vector of sixteen pairs of numbers.
    type Pairs: Copy;
    /// Loads sixteen pairs of numbers.
    fn load_pairs(self, from: &[[u32; 2]; LANES]) -> Self::Pairs;
    /// Returns the squared distances of sixteen pairs of points, and the numbers of the points. A
    /// pair in `pairs` holds two indices into `spots`. Every operation is rounded (there is no
    /// fused multiply-add), so that all instruction levels agree.
    ///
    /// # Panics
    /// Panics if an index is beyond `spots`.
    fn squares(self, spots: &[Spot], pairs: &[[u32; 2]; LANES]) -> (Self::Floats, Self::Pairs);
    /// Writes the pairs that `mask` selects to the front of `to`; the rest of `to` is unspecified.
    fn pack_pairs(self, pairs: Self::Pairs, mask: u32, to: &mut [[u32; 2]; LANES]);
    /// Runs a kernel compiled for these instructions.
    fn run<K: Kernel>(self, kernel: K) -> K::Output;
}

/// Code that is written over any [`Wide`] and compiled for each instruction set. Implementations
/// should be `#[inline(always)]`.
pub trait Kernel {
    /// Type of the code's result.
    type Output;
    /// Runs the code; `wide` proves that its instructions may be used.
    fn run<W: Wide>(self, wide: W) -> Self::Output;
}

/// An instruction set that this processor has; its value is the proof.
#[derive(Clone, Copy, Debug)]
pub enum Level {
    /// AVX-512: one register of 16 floats.
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
    /// AVX2: two registers of 8 floats.
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    /// NEON: four registers of 4 floats.
    #[cfg(target_arch = "aarch64")]
    Neon(Neon),
    /// Four registers of 4 floats, for any processor of this architecture.
    Portable(Baseline),
}

impl Level {
    /// Returns all levels that this processor has, the widest first.
    pub fn all() -> Vec<Level> {
        Level::found().collect()
    }

    fn found() -> impl Iterator<Item = Level> {
        [
            #[cfg(target_arch = "x86_64")]
            Avx512::detect().map(Level::Avx512),
            #[cfg(target_arch = "x86_64")]
            Avx2::detect().map(Level::Avx2),
            #[cfg(target_arch = "aarch64")]
            Some(Level::Neon(Neon)),
            Some(Level::Portable(Baseline {})),
        ]
        .into_iter()
        .flatten()
    }

    /// Returns the widest level that this processor has.
    pub fn best() -> Level {
        Level::found().next().unwrap_or(Level::Portable(Baseline {}))
    }

    /// Returns the name of the level, for messages and parameters.
    pub fn name(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(_) => "avx512",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(_) => "avx2",
            #[cfg(target_arch = "aarch64")]
            Level::Neon(_) => "neon",
            Level::Portable(_) => "portable",
        }
    }

    /// Runs a kernel, compiled for the instructions of this level.
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(wide) => Wide::run(wide, kernel),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(wide) => Wide::run(wide, kernel),
            #[cfg(target_arch = "aarch64")]
            Level::Neon(wide) => Wide::run(wide, kernel),
            Level::Portable(wide) => Wide::run(wide, kernel),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests the operations that write pairs.
    #[inline(always)]
    fn pairs_are_packed<W: Wide>(w: W, ids: &[u32; LANES]) {
        for mask in (0..1u32 << LANES).filter(|mask| mask.count_ones() <= 8) {
            let mut to = [0; HALF];
            let expected: Vec<u32> =
                (0..LANES as u32).filter(|k| mask >> k & 1 == 1).map(|k| 1000 + k).collect();
            w.pack_two(ids.first_chunk().unwrap(), ids.last_chunk().unwrap(), mask, &mut to);
            assert_eq!(&to[..expected.len()], expected);
        }
        let mut pairs = [Slot::uninit(); 8];
        w.pair(7, &[1, 2, 3, 4, 5, 6, u32::MAX, 8], &mut pairs);
        assert_eq!(
            // SAFETY: `pair` writes all.
            pairs.map(|pair| unsafe { pair.assume_init() }),
            [[7, 1], [7, 2], [7, 3], [7, 4], [7, 5], [7, 6], [7, u32::MAX], [7, 8]]
        );
        for mask in 0..1u32 << LANES {
            let mut to = [Slot::new([0; 2]); LANES];
            w.pairs(7, ids, mask, &mut to);
            // SAFETY: all slots were made with values.
            let to = to.map(|pair| unsafe { pair.assume_init() });
            let expected = (0..LANES).filter(|k| mask >> k & 1 == 1).map(|k| [7, ids[k]]);
            assert!(expected.zip(to).all(|(a, b)| a == b), "{mask:#x}");
        }
    }

    struct Everything;
    impl Kernel for Everything {
        type Output = Vec<u64>;
        /// Runs all operations, on numbers that are not rounded at any level.
        #[inline(always)]
        fn run<W: Wide>(self, w: W) -> Vec<u64> {
            let a: [f32; LANES] = std::array::from_fn(|k| (k * k) as f32 - 37.0);
            let b: [f32; LANES] = std::array::from_fn(|k| 11.0 - 3.0 * k as f32);
            let ids: [u32; LANES] = std::array::from_fn(|k| 1000 + k as u32);
            let (va, vb) = (w.load(&a), w.load(&b));
            let mut all = Vec::new();
            let mut see = |v: W::Floats| {
                // Each vector is recorded through comparisons, as the ranks of its lanes.
                all.extend(
                    (-3000..3000).step_by(7).map(|x| u64::from(w.at_most(v, w.all(x as f32)))),
                );
            };
            see(w.add(va, vb));
            see(w.sub(va, vb));
            see(w.mul(va, vb));
            see(w.mul_add(va, vb, w.all(5.0)));
            see(w.max(va, vb));
            see(w.load_two(a.last_chunk().unwrap(), b.first_chunk().unwrap()));
            pairs_are_packed(w, &ids);
            // The coordinates have many bits, so that differences, squares and sums are rounded.
            let spots: [Spot; 19] = std::array::from_fn(|k| Spot {
                at: [1.7, -0.3, 0.1].map(|x: f32| (x * (k + 1) as f32).sin()),
                id: (k as u32 + 1).wrapping_mul(0x9e37_79b9),
            });
            let pairs: [[u32; 2]; LANES] =
                std::array::from_fn(|k| [k as u32, (7 * k as u32 + 3) % 19]);
            let (squares, ids) = w.squares(&spots, &pairs);
            let expected = pairs.map(|[a, b]| spots[a as usize].square(&spots[b as usize]));
            assert_eq!(w.at_most(squares, w.load(&expected)), 0xffff);
            assert_eq!(w.at_most(w.load(&expected), squares), 0xffff);
            let as_ids = pairs.map(|pair| pair.map(|place| spots[place as usize].id));
            for mask in 0..1u32 << LANES {
                for (pairs, of) in [(ids, as_ids), (w.load_pairs(&pairs), pairs)] {
                    let mut to = [[0; 2]; LANES];
                    w.pack_pairs(pairs, mask, &mut to);
                    let expected = (0..LANES).filter(|k| mask >> k & 1 == 1).map(|k| of[k]);
                    assert!(expected.zip(to).all(|(a, b)| a == b), "{mask:#x}");
                }
            }
            all
        }
    }

    #[test]
    fn all_levels_compute_the_same() {
        let portable = Wide::run(Portable, Everything);
        for level in Level::all() {
            assert_eq!(level.run(Everything), portable, "{}", level.name());
        }
        assert_eq!(Level::best().name(), Level::all()[0].name());
    }

    /// Tests an index beyond the spots in every lane and on either side of the pair.
    #[test]
    fn places_beyond_the_spots_are_never_read() {
        struct Squares([[u32; 2]; LANES]);
        impl Kernel for Squares {
            type Output = ();
            #[inline(always)]
            fn run<W: Wide>(self, w: W) {
                let spots = [Spot { at: [0.0; 3], id: 0 }; 5];
                w.squares(&spots, &self.0);
            }
        }
        for level in Level::all() {
            for beyond in [5, 6, u32::MAX] {
                for (lane, side) in (0..LANES).flat_map(|lane| [(lane, 0), (lane, 1)]) {
                    let mut pairs = [[4, 0]; LANES];
                    level.run(Squares(pairs));
                    pairs[lane][side] = beyond;
                    let read = std::panic::catch_unwind(|| level.run(Squares(pairs)));
                    assert!(read.is_err(), "{} {beyond} {lane} {side}", level.name());
                }
            }
        }
    }
}
