//! Sixteen floats at a time: what the vector code of a detector is written in.
//!
//! A kernel is written once, over [`Wide`], and compiled for every instruction set; the widest that
//! the processor has is chosen when the program runs ([`Level::best`]), so one binary serves all
//! machines. A value of an implementing type is the proof that its instructions may be used: only
//! [`Level`] makes one, after asking the processor.
//!
//! | level | registers | instructions |
//! |---|---|---|
//! | `avx512` | one of 16 floats | AVX-512 F, BW, DQ, VL |
//! | `avx2` | two of 8 floats | AVX2 and FMA |
//! | `portable` | an array of 16 floats | none in particular |
//!
//! The levels may round differently (a fused multiply-add rounds once), by less than one part in
//! 2^22 in a sum of three squares. Detectors leave to the contact test what that could change, so
//! their pairs are the same on every level.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

#[cfg(target_arch = "x86_64")]
pub use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub use avx512::Avx512;
pub use portable::Portable;

/// Numbers handled together.
pub const LANES: usize = 16;
/// Half of them.
pub const HALF: usize = LANES / 2;

/// Vectors of [`LANES`] floats on one instruction set. Masks have one bit per lane, the first lane
/// in the lowest.
pub trait Wide: Copy + Send + Sync {
    /// A vector of floats.
    type Floats: Copy;
    /// The same number in every lane.
    fn all(self, x: f32) -> Self::Floats;
    /// As stored.
    fn load(self, from: &[f32; LANES]) -> Self::Floats;
    /// Eight lanes from one place, eight from another.
    fn load_two(self, low: &[f32; HALF], high: &[f32; HALF]) -> Self::Floats;
    /// a + b.
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// a - b.
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// a · b.
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// a · b + c, rounded once or twice.
    fn mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    /// The larger of a and b; b where a is no number.
    fn max(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// The lanes in which a <= b.
    fn at_most(self, a: Self::Floats, b: Self::Floats) -> u32;
    /// Writes the lanes of `ids` that are in `mask` side by side to the front of `to`, if they are
    /// at most eight; what comes after them is anything.
    fn pack(self, ids: &[u32; LANES], mask: u32, to: &mut [u32; HALF]);
    /// As [`Wide::pack`], with ids from two places.
    fn pack_two(self, low: &[u32; HALF], high: &[u32; HALF], mask: u32, to: &mut [u32; HALF]);
    /// Writes the pairs (i, ids\[k\]).
    fn pair(self, i: u32, ids: &[u32; HALF], to: &mut [[u32; 2]; HALF]);
    /// Runs a kernel, compiled for these instructions.
    fn run<K: Kernel>(self, kernel: K) -> K::Output;
}

/// Code over any [`Wide`], to be inlined where the instructions are known. Implementations should
/// be `#[inline(always)]`.
pub trait Kernel {
    /// What comes of it.
    type Output;
    /// Does it.
    fn run<W: Wide>(self, wide: W) -> Self::Output;
}

/// An instruction set that this processor has.
#[derive(Clone, Copy, Debug)]
pub enum Level {
    /// See [`Avx512`].
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
    /// See [`Avx2`].
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    /// See [`Portable`].
    Portable(Portable),
}

impl Level {
    /// All levels of this processor, the widest first.
    pub fn all() -> Vec<Level> {
        let mut levels = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            levels.extend(Avx512::detect().map(Level::Avx512));
            levels.extend(Avx2::detect().map(Level::Avx2));
        }
        levels.push(Level::Portable(Portable));
        levels
    }

    /// The widest.
    pub fn best() -> Level {
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(level) = Avx512::detect() {
                return Level::Avx512(level);
            }
            if let Some(level) = Avx2::detect() {
                return Level::Avx2(level);
            }
        }
        Level::Portable(Portable)
    }

    /// Its name, for messages.
    pub fn name(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(_) => "avx512",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(_) => "avx2",
            Level::Portable(_) => "portable",
        }
    }

    /// Runs a kernel on this level.
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(wide) => wide.run(kernel),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(wide) => wide.run(kernel),
            Level::Portable(wide) => wide.run(kernel),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Everything;
    impl Kernel for Everything {
        type Output = Vec<u64>;
        /// All operations on numbers on which no level rounds.
        #[inline(always)]
        fn run<W: Wide>(self, w: W) -> Vec<u64> {
            let a: [f32; LANES] = std::array::from_fn(|k| (k * k) as f32 - 37.0);
            let b: [f32; LANES] = std::array::from_fn(|k| 11.0 - 3.0 * k as f32);
            let ids: [u32; LANES] = std::array::from_fn(|k| 1000 + k as u32);
            let (va, vb) = (w.load(&a), w.load(&b));
            let mut all = Vec::new();
            let mut see = |v: W::Floats| {
                // A vector, seen through comparisons: the ranks of its lanes.
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
            for mask in (0..1u32 << LANES).filter(|mask| mask.count_ones() <= 8) {
                let mut to = [0; HALF];
                w.pack(&ids, mask, &mut to);
                let expected: Vec<u32> =
                    (0..LANES as u32).filter(|k| mask >> k & 1 == 1).map(|k| 1000 + k).collect();
                assert_eq!(&to[..expected.len()], expected);
                to = [0; HALF];
                w.pack_two(ids.first_chunk().unwrap(), ids.last_chunk().unwrap(), mask, &mut to);
                assert_eq!(&to[..expected.len()], expected);
            }
            let mut pairs = [[0; 2]; 8];
            w.pair(7, &[1, 2, 3, 4, 5, 6, u32::MAX, 8], &mut pairs);
            assert_eq!(
                pairs,
                [[7, 1], [7, 2], [7, 3], [7, 4], [7, 5], [7, 6], [7, u32::MAX], [7, 8]]
            );
            all
        }
    }

    #[test]
    fn all_levels_compute_the_same() {
        let portable = Level::Portable(Portable).run(Everything);
        for level in Level::all() {
            assert_eq!(level.run(Everything), portable, "{}", level.name());
        }
        assert_eq!(Level::best().name(), Level::all()[0].name());
    }
}
