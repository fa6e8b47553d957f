//! AVX-512: one register of 16 floats, masks in registers of their own, ids packed by one
//! instruction.

use std::arch::x86_64::*;

use super::{HALF, Kernel, LANES, Wide};

/// A processor with AVX-512 F, BW, DQ and VL, and with FMA, BMI and POPCNT. Made by
/// [`Avx512::detect`] only.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(());

impl Avx512 {
    /// `Some` on a processor that has the instructions.
    pub fn detect() -> Option<Avx512> {
        (is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("popcnt"))
        .then_some(Avx512(()))
    }
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,fma,bmi1,bmi2,popcnt")]
#[inline(never)]
fn compiled<K: Kernel>(wide: Avx512, kernel: K) -> K::Output {
    kernel.run(wide)
}

// A value of this type exists only where `detect` has found the instructions: what SAFETY means by
// "found" below. Loads and stores are of the unaligned kind.
impl Avx512 {
    #[inline(always)]
    fn packed(self, ids: __m512i, mask: u32, to: &mut [u32; HALF]) {
        // SAFETY: AVX-512 F and VL were found; of the sixteen packed lanes the first eight are
        // stored, and `to` has eight.
        unsafe {
            let packed = _mm512_maskz_compress_epi32(mask as u16, ids);
            _mm256_storeu_epi32(to.as_mut_ptr().cast(), _mm512_castsi512_si256(packed));
        }
    }
}

impl Wide for Avx512 {
    type Floats = __m512;

    #[inline(always)]
    fn all(self, x: f32) -> __m512 {
        // SAFETY: AVX-512 F was found.
        unsafe { _mm512_set1_ps(x) }
    }

    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> __m512 {
        // SAFETY: AVX-512 F was found; `from` has sixteen floats.
        unsafe { _mm512_loadu_ps(from.as_ptr()) }
    }

    #[inline(always)]
    fn load_two(self, low: &[f32; HALF], high: &[f32; HALF]) -> __m512 {
        // SAFETY: AVX-512 DQ was found; `low` and `high` have eight floats each.
        unsafe {
            _mm512_insertf32x8::<1>(
                _mm512_castps256_ps512(_mm256_loadu_ps(low.as_ptr())),
                _mm256_loadu_ps(high.as_ptr()),
            )
        }
    }

    #[inline(always)]
    fn add(self, a: __m512, b: __m512) -> __m512 {
        // SAFETY: AVX-512 F was found.
        unsafe { _mm512_add_ps(a, b) }
    }

    #[inline(always)]
    fn sub(self, a: __m512, b: __m512) -> __m512 {
        // SAFETY: AVX-512 F was found.
        unsafe { _mm512_sub_ps(a, b) }
    }

    #[inline(always)]
    fn mul(self, a: __m512, b: __m512) -> __m512 {
        // SAFETY: AVX-512 F was found.
        unsafe { _mm512_mul_ps(a, b) }
    }

    #[inline(always)]
    fn mul_add(self, a: __m512, b: __m512, c: __m512) -> __m512 {
        // SAFETY: AVX-512 F was found.
        unsafe { _mm512_fmadd_ps(a, b, c) }
    }

    #[inline(always)]
    fn max(self, a: __m512, b: __m512) -> __m512 {
        // SAFETY: AVX-512 F was found.
        unsafe { _mm512_max_ps(a, b) }
    }

    #[inline(always)]
    fn at_most(self, a: __m512, b: __m512) -> u32 {
        // SAFETY: AVX-512 F was found.
        u32::from(unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b) })
    }

    #[inline(always)]
    fn pack(self, ids: &[u32; LANES], mask: u32, to: &mut [u32; HALF]) {
        // SAFETY: AVX-512 F was found; there are sixteen ids.
        self.packed(unsafe { _mm512_loadu_epi32(ids.as_ptr().cast()) }, mask, to);
    }

    #[inline(always)]
    fn pack_two(self, low: &[u32; HALF], high: &[u32; HALF], mask: u32, to: &mut [u32; HALF]) {
        // SAFETY: AVX-512 F, DQ and VL were found; `low` and `high` have eight ids each.
        let both = unsafe {
            let low = _mm512_castsi256_si512(_mm256_loadu_epi32(low.as_ptr().cast()));
            _mm512_inserti32x8::<1>(low, _mm256_loadu_epi32(high.as_ptr().cast()))
        };
        self.packed(both, mask, to);
    }

    #[inline(always)]
    fn pair(self, i: u32, ids: &[u32; HALF], to: &mut [[u32; 2]; HALF]) {
        // SAFETY: AVX-512 F and VL were found; eight ids are read, and the eight pairs written.
        unsafe {
            let high = _mm512_slli_epi64::<32>(_mm512_cvtepu32_epi64(_mm256_loadu_epi32(
                ids.as_ptr().cast(),
            )));
            _mm512_storeu_epi64(
                to.as_mut_ptr().cast(),
                _mm512_or_si512(high, _mm512_set1_epi64(i64::from(i))),
            );
        }
    }

    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        // SAFETY: all features that `compiled` enables were found.
        unsafe { compiled(self, kernel) }
    }
}
