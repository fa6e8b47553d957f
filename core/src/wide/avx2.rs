//! AVX2: two registers of 8 floats; ids are packed by a permutation from a table.

use std::arch::x86_64::*;

use super::{HALF, Kernel, LANES, Wide};

/// A processor with AVX2, FMA, BMI and POPCNT. Made by [`Avx2::detect`] only.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    /// `Some` on a processor that has the instructions.
    pub fn detect() -> Option<Avx2> {
        (is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("popcnt"))
        .then_some(Avx2(()))
    }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
#[inline(never)]
fn compiled<K: Kernel>(wide: Avx2, kernel: K) -> K::Output {
    kernel.run(wide)
}

/// For every mask of 8 lanes: the lanes in it, side by side.
static PACKED: [[u32; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut slot) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask][slot] = lane;
                slot += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

// A value of this type exists only where `detect` has found the instructions: what SAFETY means by
// "found" below. Loads and stores are of the unaligned kind.
impl Avx2 {
    #[inline(always)]
    fn each(
        self,
        a: [__m256; 2],
        b: [__m256; 2],
        f: impl Fn(__m256, __m256) -> __m256,
    ) -> [__m256; 2] {
        [f(a[0], b[0]), f(a[1], b[1])]
    }

    #[inline(always)]
    fn permuted(self, ids: &[u32; 8], mask: u32) -> __m256i {
        // SAFETY: AVX2 was found; a row of the table and `ids` are eight numbers each.
        unsafe {
            let order = _mm256_loadu_si256(PACKED[(mask & 0xff) as usize].as_ptr().cast());
            _mm256_permutevar8x32_epi32(_mm256_loadu_si256(ids.as_ptr().cast()), order)
        }
    }
}

impl Wide for Avx2 {
    type Floats = [__m256; 2];

    #[inline(always)]
    fn all(self, x: f32) -> [__m256; 2] {
        // SAFETY: AVX was found.
        [unsafe { _mm256_set1_ps(x) }; 2]
    }

    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> [__m256; 2] {
        let (low, high) = from.split_at(HALF);
        // SAFETY: AVX was found; both halves of `from` have eight floats.
        unsafe { [_mm256_loadu_ps(low.as_ptr()), _mm256_loadu_ps(high.as_ptr())] }
    }

    #[inline(always)]
    fn load_two(self, low: &[f32; HALF], high: &[f32; HALF]) -> [__m256; 2] {
        // SAFETY: AVX was found; `low` and `high` have eight floats each.
        unsafe { [_mm256_loadu_ps(low.as_ptr()), _mm256_loadu_ps(high.as_ptr())] }
    }

    #[inline(always)]
    fn add(self, a: [__m256; 2], b: [__m256; 2]) -> [__m256; 2] {
        // SAFETY: AVX was found.
        self.each(a, b, |a, b| unsafe { _mm256_add_ps(a, b) })
    }

    #[inline(always)]
    fn sub(self, a: [__m256; 2], b: [__m256; 2]) -> [__m256; 2] {
        // SAFETY: AVX was found.
        self.each(a, b, |a, b| unsafe { _mm256_sub_ps(a, b) })
    }

    #[inline(always)]
    fn mul(self, a: [__m256; 2], b: [__m256; 2]) -> [__m256; 2] {
        // SAFETY: AVX was found.
        self.each(a, b, |a, b| unsafe { _mm256_mul_ps(a, b) })
    }

    #[inline(always)]
    fn mul_add(self, a: [__m256; 2], b: [__m256; 2], c: [__m256; 2]) -> [__m256; 2] {
        // SAFETY: FMA was found.
        unsafe { [_mm256_fmadd_ps(a[0], b[0], c[0]), _mm256_fmadd_ps(a[1], b[1], c[1])] }
    }

    #[inline(always)]
    fn max(self, a: [__m256; 2], b: [__m256; 2]) -> [__m256; 2] {
        // SAFETY: AVX was found.
        self.each(a, b, |a, b| unsafe { _mm256_max_ps(a, b) })
    }

    #[inline(always)]
    fn at_most(self, a: [__m256; 2], b: [__m256; 2]) -> u32 {
        // SAFETY: AVX was found.
        let half = |a, b| unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) } as u32;
        half(a[0], b[0]) | half(a[1], b[1]) << 8
    }

    #[inline(always)]
    fn pack(self, ids: &[u32; LANES], mask: u32, to: &mut [u32; HALF]) {
        let (low, high) = ids.split_at(HALF);
        // Both halves have eight lanes, by the split.
        let (Ok(low), Ok(high)) = (low.try_into(), high.try_into()) else { unreachable!() };
        self.pack_two(low, high, mask, to);
    }

    #[inline(always)]
    fn pack_two(self, low: &[u32; HALF], high: &[u32; HALF], mask: u32, to: &mut [u32; HALF]) {
        let first = (mask & 0xff).count_ones() as usize;
        let mut both = [0; LANES];
        // SAFETY: AVX was found; eight numbers from place 0 or `first` <= 8 are within the sixteen
        // of `both`, and `to` has eight.
        unsafe {
            _mm256_storeu_si256(both.as_mut_ptr().cast(), self.permuted(low, mask));
            _mm256_storeu_si256(
                both.as_mut_ptr().add(first).cast(),
                self.permuted(high, mask >> 8),
            );
            _mm256_storeu_si256(to.as_mut_ptr().cast(), _mm256_loadu_si256(both.as_ptr().cast()));
        }
    }

    #[inline(always)]
    fn pair(self, i: u32, ids: &[u32; HALF], to: &mut [[u32; 2]; HALF]) {
        // SAFETY: AVX2 was found; each half is four of the eight ids, and four of the eight pairs.
        unsafe {
            let i = _mm256_set1_epi64x(i64::from(i));
            for half in 0..2 {
                let four = _mm_loadu_si128(ids.as_ptr().add(4 * half).cast());
                let high = _mm256_slli_epi64::<32>(_mm256_cvtepu32_epi64(four));
                _mm256_storeu_si256(to.as_mut_ptr().add(4 * half).cast(), _mm256_or_si256(high, i));
            }
        }
    }

    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        // SAFETY: all features that `compiled` enables were found.
        unsafe { compiled(self, kernel) }
    }
}
