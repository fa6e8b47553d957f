//! AVX2: two registers of 8 floats each. A permutation from a table packs ids.

use std::arch::x86_64::*;

use super::{HALF, Kernel, LANES, Spot, Wide};

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

    /// Computes the squared distances and the numbers of eight pairs, for [`Wide::squares`].
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
        // The split gives two halves of eight lanes each.
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

    type Pairs = [__m256i; 4];

    #[inline(always)]
    fn load_pairs(self, from: &[[u32; 2]; LANES]) -> [__m256i; 4] {
        // SAFETY: AVX was found; each quarter of the sixteen pairs is one vector.
        unsafe {
            let from: *const __m256i = from.as_ptr().cast();
            [
                _mm256_loadu_si256(from),
                _mm256_loadu_si256(from.add(1)),
                _mm256_loadu_si256(from.add(2)),
                _mm256_loadu_si256(from.add(3)),
            ]
        }
    }

    #[inline(always)]
    fn squares(self, spots: &[Spot], pairs: &[[u32; 2]; LANES]) -> ([__m256; 2], [__m256i; 4]) {
        let most = pairs.iter().flatten().fold(0, |most, &place| most.max(place));
        assert!((most as usize) < spots.len(), "a place beyond the spots");
        let (low, high) = pairs.split_at(HALF);
        // SAFETY: no place is above `most`, which is below the number of spots.
        let ((low, [p, q]), (high, [r, s])) =
            unsafe { (self.eight(spots, low), self.eight(spots, high)) };
        ([low, high], [p, q, r, s])
    }

    #[inline(always)]
    fn pack_pairs(self, pairs: [__m256i; 4], mask: u32, to: &mut [[u32; 2]; LANES]) {
        let to: *mut [u32; 2] = to.as_mut_ptr();
        let mut packed = 0;
        for (quarter, pairs) in pairs.into_iter().enumerate() {
            let mask = (mask >> (4 * quarter)) & 0xf;
            // SAFETY: AVX2 was found. `packed` is at most four per earlier quarter, so four pairs
            // from there are within the sixteen of `to`. A row of the table has eight numbers.
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
