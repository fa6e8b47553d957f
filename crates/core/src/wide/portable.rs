//! Vectors for any processor: loops over arrays, which the compiler may vectorise.

use super::{HALF, Kernel, LANES, Spot, Wide, fill};

/// The instruction set of any processor: plain Rust.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

impl Wide for Portable {
    const NARROW: bool = true;

    type Floats = [f32; LANES];

    #[inline(always)]
    fn all(self, x: f32) -> [f32; LANES] {
        [x; LANES]
    }

    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> [f32; LANES] {
        *from
    }

    #[inline(always)]
    fn load_two(self, low: &[f32; HALF], high: &[f32; HALF]) -> [f32; LANES] {
        fill(|k| if k < HALF { low[k] } else { high[k - HALF] })
    }

    #[inline(always)]
    fn add(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        fill(|k| a[k] + b[k])
    }

    #[inline(always)]
    fn sub(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        fill(|k| a[k] - b[k])
    }

    #[inline(always)]
    fn mul(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        fill(|k| a[k] * b[k])
    }

    #[inline(always)]
    fn mul_add(self, a: [f32; LANES], b: [f32; LANES], c: [f32; LANES]) -> [f32; LANES] {
        fill(|k| a[k] * b[k] + c[k])
    }

    #[inline(always)]
    fn max(self, a: [f32; LANES], b: [f32; LANES]) -> [f32; LANES] {
        fill(|k| if a[k] > b[k] { a[k] } else { b[k] })
    }

    #[inline(always)]
    fn at_most(self, a: [f32; LANES], b: [f32; LANES]) -> u32 {
        // The bits go to an array first, because the compiler vectorises this form.
        let bits: [u32; LANES] = fill(|k| if a[k] <= b[k] { 1 << k } else { 0 });
        bits.iter().fold(0, |mask, bit| mask | bit)
    }

    #[inline(always)]
    fn pack(self, ids: &[u32; LANES], mut mask: u32, to: &mut [u32; HALF]) {
        for slot in to {
            if mask == 0 {
                break;
            }
            *slot = ids[mask.trailing_zeros() as usize % LANES];
            mask &= mask - 1;
        }
    }

    #[inline(always)]
    fn pack_two(self, low: &[u32; HALF], high: &[u32; HALF], mask: u32, to: &mut [u32; HALF]) {
        self.pack(&fill(|k| if k < HALF { low[k] } else { high[k - HALF] }), mask, to);
    }

    #[inline(always)]
    fn pair(self, i: u32, ids: &[u32; HALF], to: &mut [[u32; 2]; HALF]) {
        for (pair, &j) in to.iter_mut().zip(ids) {
            *pair = [i, j];
        }
    }

    type Pairs = [[u32; 2]; LANES];

    #[inline(always)]
    fn load_pairs(self, from: &[[u32; 2]; LANES]) -> [[u32; 2]; LANES] {
        *from
    }

    #[inline(always)]
    fn squares(
        self,
        spots: &[Spot],
        pairs: &[[u32; 2]; LANES],
    ) -> ([f32; LANES], [[u32; 2]; LANES]) {
        let both = |k: usize| pairs[k].map(|place| &spots[place as usize]);
        let squares = fill(|k| {
            let [a, b] = both(k);
            a.square(b)
        });
        (squares, fill(|k| both(k).map(|spot| spot.id)))
    }

    #[inline(always)]
    fn pack_pairs(self, pairs: [[u32; 2]; LANES], mask: u32, to: &mut [[u32; 2]; LANES]) {
        let mut packed = 0;
        // The loop has no branches, because the mask is unpredictable.
        for (k, pair) in pairs.into_iter().enumerate() {
            to[packed % LANES] = pair;
            packed += (mask >> k & 1) as usize;
        }
    }

    #[inline(never)]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
}
