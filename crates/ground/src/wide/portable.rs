//! Four floats in plain Rust, for any processor.

use super::register::{Register, instructions};
use super::{Kernel, fill};

/// Four lanes in plain Rust.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

// SAFETY: sizes are those that the trait names, and all results are initialised.
unsafe impl Register for Portable {
    const LANES: usize = 4;
    type Floats = [f32; 4];
    type Ids = [u32; 4];
    type Pairs = [[u32; 2]; 4];
    type Many<A: Copy> = [A; 4];

    fn many<A: Copy>(a: A) -> [A; 4] {
        [a; 4]
    }

    instructions! {
        all(x: f32) -> [f32; 4] = [x; 4];
        add(a: [f32; 4], b: [f32; 4]) -> [f32; 4] = fill(|k| a[k] + b[k]);
        sub(a: [f32; 4], b: [f32; 4]) -> [f32; 4] = fill(|k| a[k] - b[k]);
        mul(a: [f32; 4], b: [f32; 4]) -> [f32; 4] = fill(|k| a[k] * b[k]);
        mul_add(a: [f32; 4], b: [f32; 4], c: [f32; 4]) -> [f32; 4] = fill(|k| a[k] * b[k] + c[k]);
        max(a: [f32; 4], b: [f32; 4]) -> [f32; 4] = fill(|k| if a[k] > b[k] { a[k] } else { b[k] });
        at_most(a: [f32; 4], b: [f32; 4]) -> u32 = {
            (0..4).fold(0, |mask, k| mask | u32::from(a[k] <= b[k]) << k)
        };
        pack(ids: [u32; 4], mask: u32) -> [u32; 4] = {
            let (mut packed, mut len) = ([0; 4], 0);
            for (k, id) in ids.into_iter().enumerate() {
                packed[len % 4] = id;
                len += (mask >> k & 1) as usize;
            }
            packed
        };
        pair(i: u32, ids: [u32; 4]) -> [[u32; 2]; 4] = ids.map(|id| [i, id]);
    }

    #[inline(never)]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
}
