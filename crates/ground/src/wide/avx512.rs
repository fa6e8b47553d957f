//! AVX-512: one register of 16 floats, mask registers, and an instruction that packs ids.

use std::arch::x86_64::*;

use super::register::{Register, instructions};
use super::{Kernel, LANES, Spot};

/// Proof that the processor has AVX-512 F, BW, DQ and VL, FMA, BMI and POPCNT. Only
/// [`Avx512::detect`] creates it.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(());

impl Avx512 {
    /// Returns the proof if the processor has all these instructions.
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

// A value of this type exists only if `detect` found the instructions; SAFETY comments below call
// these instructions found. Loads and stores are unaligned, except for spots, which are aligned.
impl Avx512 {
    /// Loads the first or second points, by `side`, of pairs r, 4 + r, 8 + r and 12 + r. Four such
    /// vectors, transposed in blocks of 4x4 lanes, yield the pairs in order.
    ///
    /// # Safety
    /// The places of the pairs must be below the number of spots.
    #[inline(always)]
    unsafe fn four(self, spots: &[Spot], pairs: &[[u32; 2]], r: usize, side: usize) -> __m512 {
        // SAFETY: AVX-512 F was found; the caller ensures valid places, and a spot is sixteen
        // bytes, aligned to sixteen.
        unsafe {
            let at = |k: usize| _mm_load_ps(spots.as_ptr().add(pairs[k][side] as usize).cast());
            let four = _mm512_castps128_ps512(at(r));
            let four = _mm512_insertf32x4::<1>(four, at(4 + r));
            let four = _mm512_insertf32x4::<2>(four, at(8 + r));
            _mm512_insertf32x4::<3>(four, at(12 + r))
        }
    }
}

// SAFETY: sizes are those that the trait names, and all results are initialised.
unsafe impl Register for Avx512 {
    const LANES: usize = LANES;
    type Floats = __m512;
    type Ids = __m512i;
    type Pairs = [__m512i; 2];
    type Many<A: Copy> = [A; 1];

    fn many<A: Copy>(a: A) -> [A; 1] {
        [a]
    }

    instructions! {
        all(x: f32) -> __m512 = _mm512_set1_ps(x);
        add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        sub(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps(a, b);
        mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        mul_add(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fmadd_ps(a, b, c);
        max(a: __m512, b: __m512) -> __m512 = _mm512_max_ps(a, b);
        at_most(a: __m512, b: __m512) -> u32 = {
            u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b))
        };
        pack(ids: __m512i, mask: u32) -> __m512i = _mm512_maskz_compress_epi32(mask as u16, ids);
        pair(i: u32, ids: __m512i) -> [__m512i; 2] = {
            let i = _mm512_set1_epi32(i as i32);
            let low = _mm512_setr_epi32(16, 0, 17, 1, 18, 2, 19, 3, 20, 4, 21, 5, 22, 6, 23, 7);
            let high = _mm512_add_epi32(low, _mm512_set1_epi32(8));
            [_mm512_permutex2var_epi32(ids, low, i), _mm512_permutex2var_epi32(ids, high, i)]
        };
    }

    #[inline(always)]
    fn squares(self, spots: &[Spot], pairs: &[[u32; 2]]) -> (__m512, [__m512i; 2]) {
        assert!(pairs.len() >= LANES);
        let from: *const i32 = pairs.as_ptr().cast();
        // SAFETY: AVX-512 F was found; one assertion ensures that sixteen pairs can be read, the
        // other that places are below the number of spots.
        unsafe {
            let (low, high) = (_mm512_loadu_epi32(from), _mm512_loadu_epi32(from.add(LANES)));
            let most = _mm512_set1_epi32(u32::try_from(spots.len()).unwrap_or(u32::MAX) as i32);
            let within = [_mm512_cmplt_epu32_mask(low, most), _mm512_cmplt_epu32_mask(high, most)];
            assert!(within == [u16::MAX; 2], "a place beyond the spots");
            let (a0, b0) = (self.four(spots, pairs, 0, 0), self.four(spots, pairs, 0, 1));
            let (a1, b1) = (self.four(spots, pairs, 1, 0), self.four(spots, pairs, 1, 1));
            let (a2, b2) = (self.four(spots, pairs, 2, 0), self.four(spots, pairs, 2, 1));
            let (a3, b3) = (self.four(spots, pairs, 3, 0), self.four(spots, pairs, 3, 1));
            // The fourth lane of each difference keeps the number of particle b.
            let off0 = _mm512_mask_sub_ps(b0, 0x7777, a0, b0);
            let off1 = _mm512_mask_sub_ps(b1, 0x7777, a1, b1);
            let off2 = _mm512_mask_sub_ps(b2, 0x7777, a2, b2);
            let off3 = _mm512_mask_sub_ps(b3, 0x7777, a3, b3);
            let (xy0, xy2) = (_mm512_unpacklo_ps(off0, off1), _mm512_unpacklo_ps(off2, off3));
            let (zb0, zb2) = (_mm512_unpackhi_ps(off0, off1), _mm512_unpackhi_ps(off2, off3));
            let (za0, za2) = (_mm512_unpackhi_ps(a0, a1), _mm512_unpackhi_ps(a2, a3));
            let x = _mm512_shuffle_ps::<0b0100_0100>(xy0, xy2);
            let y = _mm512_shuffle_ps::<0b1110_1110>(xy0, xy2);
            let z = _mm512_shuffle_ps::<0b0100_0100>(zb0, zb2);
            let of_a = _mm512_castps_si512(_mm512_shuffle_ps::<0b1110_1110>(za0, za2));
            let of_b = _mm512_castps_si512(_mm512_shuffle_ps::<0b1110_1110>(zb0, zb2));
            let square = _mm512_add_ps(
                _mm512_add_ps(_mm512_mul_ps(x, x), _mm512_mul_ps(y, y)),
                _mm512_mul_ps(z, z),
            );
            let low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
            let high = _mm512_add_epi32(low, _mm512_set1_epi32(8));
            let pairs = [
                _mm512_permutex2var_epi32(of_a, low, of_b),
                _mm512_permutex2var_epi32(of_a, high, of_b),
            ];
            (square, pairs)
        }
    }

    #[inline(always)]
    fn pack_pairs(self, pairs: [__m512i; 2], mask: u32, to: &mut [[u32; 2]]) {
        assert!(to.len() >= LANES);
        let first = (mask as u8).count_ones() as usize;
        let to: *mut i64 = to.as_mut_ptr().cast();
        // SAFETY: AVX-512 F was found; eight pairs from place 0 or `first` <= 8 are within the
        // sixteen of `to`.
        unsafe {
            _mm512_storeu_epi64(to, _mm512_maskz_compress_epi64(mask as u8, pairs[0]));
            let second = _mm512_maskz_compress_epi64((mask >> 8) as u8, pairs[1]);
            _mm512_storeu_epi64(to.add(first), second);
        }
    }

    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        // SAFETY: all features that `compiled` enables were found.
        unsafe { compiled(self, kernel) }
    }
}
