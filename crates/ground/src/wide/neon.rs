//! NEON: four floats. Every aarch64 processor has it, so it needs no detection.

use std::arch::aarch64::*;

use super::Kernel;
use super::register::{Register, instructions};

/// Four lanes of NEON.
#[derive(Clone, Copy, Debug)]
pub struct Neon;

/// Order of bytes for each mask of four lanes: the selected lanes come first.
static PACKED: [[u8; 16]; 16] = {
    let mut table = [[0; 16]; 16];
    let mut mask = 0;
    while mask < 16 {
        let (mut byte, mut slot) = (0, 0);
        while byte < 16 {
            if mask >> (byte / 4) & 1 == 1 {
                table[mask][slot] = byte;
                slot += 1;
            }
            byte += 1;
        }
        mask += 1;
    }
    table
};

// SAFETY: sizes are those that the trait names, and all results are initialised.
unsafe impl Register for Neon {
    const LANES: usize = 4;
    type Floats = float32x4_t;
    type Ids = uint32x4_t;
    type Pairs = uint32x4x2_t;
    type Many<A: Copy> = [A; 4];

    fn many<A: Copy>(a: A) -> [A; 4] {
        [a; 4]
    }

    instructions! {
        all(x: f32) -> float32x4_t = vdupq_n_f32(x);
        add(a: float32x4_t, b: float32x4_t) -> float32x4_t = vaddq_f32(a, b);
        sub(a: float32x4_t, b: float32x4_t) -> float32x4_t = vsubq_f32(a, b);
        mul(a: float32x4_t, b: float32x4_t) -> float32x4_t = vmulq_f32(a, b);
        mul_add(a: float32x4_t, b: float32x4_t, c: float32x4_t) -> float32x4_t = vfmaq_f32(c, a, b);
        max(a: float32x4_t, b: float32x4_t) -> float32x4_t = vbslq_f32(vcgtq_f32(a, b), a, b);
        at_most(a: float32x4_t, b: float32x4_t) -> u32 = {
            vaddvq_u32(vandq_u32(vcleq_f32(a, b), vld1q_u32([1, 2, 4, 8].as_ptr())))
        };
        pack(ids: uint32x4_t, mask: u32) -> uint32x4_t = {
            let order = vld1q_u8(PACKED[mask as usize % 16].as_ptr());
            vreinterpretq_u32_u8(vqtbl1q_u8(vreinterpretq_u8_u32(ids), order))
        };
        pair(i: u32, ids: uint32x4_t) -> uint32x4x2_t = vzipq_u32(vdupq_n_u32(i), ids);
    }

    #[inline(never)]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
}
