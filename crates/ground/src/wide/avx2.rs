//! AVX2: eight floats. A permutation from a table packs ids.

use std::arch::x86_64::*;

use super::register::{Register, instructions};
use super::{Kernel, Spot};

/// Proof that the processor has AVX2, FMA, BMI and POPCNT. Only [`Avx2::detect`] creates it.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    /// Returns the proof if the processor has all these instructions.
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

/// Order of lanes for each mask of 8 lanes: the selected lanes come first.
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

/// Order of lanes for each mask of four pairs: the lanes of the selected pairs come first.
static PACKED_PAIRS: [[u32; 8]; 16] = {
    let mut table = [[0; 8]; 16];
    let mut mask = 0;
    while mask < 16 {
        // The mask selects both lanes of a pair, or neither.
        let spread = mask & 1 | (mask & 2) << 1 | (mask & 4) << 2 | (mask & 8) << 3;
        table[mask] = PACKED[3 * spread];
        mask += 1;
    }
    table
};

// A value of this type exists only if `detect` found the instructions; SAFETY comments below call
// these instructions found. Loads and stores are unaligned, except for spots, which are aligned.
impl Avx2 {
    /// Loads the first or second points, by `side`, of pairs r and 4 + r. Four such vectors,
    /// transposed in blocks of 4x4 lanes, yield the pairs in order.
    ///
    /// # Safety
    /// The places of the pairs must be below the number of spots.
    #[inline(always)]
    unsafe fn two(self, spots: &[Spot], eight: &[[u32; 2]], r: usize, side: usize) -> __m256 {
        // SAFETY: AVX was found; the caller ensures valid places, and a spot is sixteen bytes,
        // aligned to sixteen.
        unsafe {
            let at = |k: usize| _mm_load_ps(spots.as_ptr().add(eight[k][side] as usize).cast());
            _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(at(r)), at(4 + r))
        }
    }

    /// Returns the squared distances of eight pairs of points, and the numbers of the points.
    ///
    /// # Safety
    /// The places must be below the number of spots.
    #[inline(always)]
    unsafe fn eight(self, spots: &[Spot], eight: &[[u32; 2]]) -> (__m256, [__m256i; 2]) {
        // SAFETY: AVX2 was found; the caller ensures valid places.
        unsafe {
            let two = |r: usize, side: usize| self.two(spots, eight, r, side);
            let (a0, b0) = (two(0, 0), two(0, 1));
            let (a1, b1) = (two(1, 0), two(1, 1));
            let (a2, b2) = (two(2, 0), two(2, 1));
            let (a3, b3) = (two(3, 0), two(3, 1));
            // The fourth lane of each difference keeps the number of particle b.
            let off0 = _mm256_blend_ps::<0b1000_1000>(_mm256_sub_ps(a0, b0), b0);
            let off1 = _mm256_blend_ps::<0b1000_1000>(_mm256_sub_ps(a1, b1), b1);
            let off2 = _mm256_blend_ps::<0b1000_1000>(_mm256_sub_ps(a2, b2), b2);
            let off3 = _mm256_blend_ps::<0b1000_1000>(_mm256_sub_ps(a3, b3), b3);
            let (xy0, xy2) = (_mm256_unpacklo_ps(off0, off1), _mm256_unpacklo_ps(off2, off3));
            let (zb0, zb2) = (_mm256_unpackhi_ps(off0, off1), _mm256_unpackhi_ps(off2, off3));
            let (za0, za2) = (_mm256_unpackhi_ps(a0, a1), _mm256_unpackhi_ps(a2, a3));
            let x = _mm256_shuffle_ps::<0b0100_0100>(xy0, xy2);
            let y = _mm256_shuffle_ps::<0b1110_1110>(xy0, xy2);
            let z = _mm256_shuffle_ps::<0b0100_0100>(zb0, zb2);
            let of_a = _mm256_castps_si256(_mm256_shuffle_ps::<0b1110_1110>(za0, za2));
            let of_b = _mm256_castps_si256(_mm256_shuffle_ps::<0b1110_1110>(zb0, zb2));
            let square = _mm256_add_ps(
                _mm256_add_ps(_mm256_mul_ps(x, x), _mm256_mul_ps(y, y)),
                _mm256_mul_ps(z, z),
            );
            let (low, high) =
                (_mm256_unpacklo_epi32(of_a, of_b), _mm256_unpackhi_epi32(of_a, of_b));
            let pairs = [
                _mm256_permute2x128_si256::<0x20>(low, high),
                _mm256_permute2x128_si256::<0x31>(low, high),
            ];
            (square, pairs)
        }
    }
}

// SAFETY: sizes are those that the trait names, and all results are initialised.
unsafe impl Register for Avx2 {
    const LANES: usize = 8;
    type Floats = __m256;
    type Ids = __m256i;
    type Pairs = [__m256i; 2];
    type Many<A: Copy> = [A; 2];

    fn many<A: Copy>(a: A) -> [A; 2] {
        [a; 2]
    }

    instructions! {
        all(x: f32) -> __m256 = _mm256_set1_ps(x);
        add(a: __m256, b: __m256) -> __m256 = _mm256_add_ps(a, b);
        sub(a: __m256, b: __m256) -> __m256 = _mm256_sub_ps(a, b);
        mul(a: __m256, b: __m256) -> __m256 = _mm256_mul_ps(a, b);
        mul_add(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmadd_ps(a, b, c);
        max(a: __m256, b: __m256) -> __m256 = _mm256_max_ps(a, b);
        at_most(a: __m256, b: __m256) -> u32 = {
            _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32
        };
        pack(ids: __m256i, mask: u32) -> __m256i = {
            let order = _mm256_loadu_si256(PACKED[mask as usize % 256].as_ptr().cast());
            _mm256_permutevar8x32_epi32(ids, order)
        };
        pair(i: u32, ids: __m256i) -> [__m256i; 2] = {
            let i = _mm256_set1_epi32(i as i32);
            let (low, high) = (_mm256_unpacklo_epi32(i, ids), _mm256_unpackhi_epi32(i, ids));
            [
                _mm256_permute2x128_si256::<0x20>(low, high),
                _mm256_permute2x128_si256::<0x31>(low, high),
            ]
        };
    }

    #[inline(always)]
    fn squares(self, spots: &[Spot], pairs: &[[u32; 2]]) -> (__m256, [__m256i; 2]) {
        let most = pairs.iter().flatten().fold(0, |most, &place| most.max(place));
        assert!((most as usize) < spots.len(), "a place beyond the spots");
        // SAFETY: no place is above `most`, which is below the number of spots.
        unsafe { self.eight(spots, pairs) }
    }

    #[inline(always)]
    fn pack_pairs(self, pairs: [__m256i; 2], mask: u32, to: &mut [[u32; 2]]) {
        assert!(to.len() >= 8);
        let to: *mut [u32; 2] = to.as_mut_ptr();
        let mut packed = 0;
        for (half, pairs) in pairs.into_iter().enumerate() {
            let mask = (mask >> (4 * half)) & 0xf;
            // SAFETY: AVX2 was found. `packed` is at most four, so four pairs from there are within
            // the eight of `to`. A row of the table has eight numbers.
            unsafe {
                let order = _mm256_loadu_si256(PACKED_PAIRS[mask as usize].as_ptr().cast());
                let four = _mm256_permutevar8x32_epi32(pairs, order);
                _mm256_storeu_si256(to.add(packed).cast(), four);
            }
            packed += mask.count_ones() as usize;
        }
    }

    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        // SAFETY: all features that `compiled` enables were found.
        unsafe { compiled(self, kernel) }
    }
}
