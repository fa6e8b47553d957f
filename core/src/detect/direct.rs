//! `direct`: direct checking (Munjiza 2004, section 3.2).
//!
//! Every pair of elements is tested once.
//!
//! * Cost: exactly N(N-1)/2 contact tests for N elements, whatever their places. Memory: none.
//! * Deviation from the book: none. With several threads, rows of the triangle are shared out and their contacts collected
//!   (memory: the contacts); counting passes run on one thread, since the counts are the same.

use rayon::prelude::*;

use super::{Declare, Detector, Options, Refusal};
use crate::contact::{Bodies, Real};
use crate::probe::{Probe, Silent};
use crate::sink::Sink;

/// Tests every pair.
pub struct Direct {
    options: Options,
}

impl Declare for Direct {
    fn with(options: Options) -> Direct {
        Direct { options }
    }

    fn formula_bytes(&self) -> u64 {
        0
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Direct {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(&mut self, bodies: B, probe: &mut P, sink: &mut S) -> Result<(), Refusal> {
        let n = bodies.len() as u32;
        if self.options.threads > 1 && P::SILENT {
            let rows: Vec<Vec<[u32; 2]>> = (0..n)
                .into_par_iter()
                .fold(Vec::new, |mut found, i| {
                    row(&bodies, i, n, &mut Silent, &mut found);
                    found
                })
                .collect();
            for [i, j] in rows.into_iter().flatten() {
                sink.contact(i, j);
            }
        } else {
            for i in 0..n {
                row(&bodies, i, n, probe, sink);
            }
        }
        Ok(())
    }
}

#[inline(always)]
fn row<T: Real, const D: usize>(bodies: &impl Bodies<T, D>, i: u32, n: u32, probe: &mut impl Probe, sink: &mut impl Sink) {
    for j in i + 1..n {
        if bodies.touch(i, j, probe) {
            sink.contact(i, j);
        }
    }
}
