//! SSE2: four floats. Every x86-64 processor has it, so it needs no detection.

use std::arch::x86_64::*;

use super::Kernel;
use super::register::{Register, instructions};

/// Four lanes of SSE2.
#[derive(Clone, Copy, Debug)]
pub struct Sse2;

/// Masks that pack four lanes: which lanes stay and which move by one, then by two.
#[repr(align(64))]
struct Moves([[u32; 4]; 4]);

static MOVES: [Moves; 16] = {
    let mut table = [const { Moves([[0; 4]; 4]) }; 16];
    let mut mask = 0;
    while mask < 16 {
        let (mut lane, mut slot) = (0, 0);
        while lane < 4 {
            if mask >> lane & 1 == 1 {
                let by = lane - slot;
                table[mask].0[by % 2][lane - by % 2] = !0;
                table[mask].0[2 + by / 2][slot] = !0;
                slot += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

// SAFETY: sizes are those that the trait names, and all results are initialised.
unsafe impl Register for Sse2 {
    const LANES: usize = 4;
    type Floats = __m128;
    type Ids = __m128i;
    type Pairs = [__m128i; 2];
    type Many<A: Copy> = [A; 4];

    fn many<A: Copy>(a: A) -> [A; 4] {
        [a; 4]
    }

    instructions! {
        all(x: f32) -> __m128 = _mm_set1_ps(x);
        add(a: __m128, b: __m128) -> __m128 = _mm_add_ps(a, b);
        sub(a: __m128, b: __m128) -> __m128 = _mm_sub_ps(a, b);
        mul(a: __m128, b: __m128) -> __m128 = _mm_mul_ps(a, b);
        mul_add(a: __m128, b: __m128, c: __m128) -> __m128 = _mm_add_ps(_mm_mul_ps(a, b), c);
        max(a: __m128, b: __m128) -> __m128 = _mm_max_ps(a, b);
        at_most(a: __m128, b: __m128) -> u32 = _mm_movemask_ps(_mm_cmple_ps(a, b)) as u32;
        pack(ids: __m128i, mask: u32) -> __m128i = {
            let moves = &MOVES[mask as usize % 16].0;
            // Each row has four numbers and is aligned to sixteen bytes.
            let row = |k: usize| _mm_load_si128(moves[k].as_ptr().cast());
            let by_one = _mm_and_si128(_mm_srli_si128::<4>(ids), row(1));
            let ids = _mm_or_si128(_mm_and_si128(ids, row(0)), by_one);
            let by_two = _mm_and_si128(_mm_srli_si128::<8>(ids), row(3));
            _mm_or_si128(_mm_and_si128(ids, row(2)), by_two)
        };
        pair(i: u32, ids: __m128i) -> [__m128i; 2] = {
            let i = _mm_set1_epi32(i as i32);
            [_mm_unpacklo_epi32(i, ids), _mm_unpackhi_epi32(i, ids)]
        };
    }

    #[inline(never)]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
}
