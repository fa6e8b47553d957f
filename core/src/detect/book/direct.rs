//! `direct`: direct checking (Munjiza 2004, section 3.2).
//!
//! Every pair of particles is tested once.
//!
//! * Cost: exactly N(N-1)/2 contact tests for N particles, whatever their places. Memory: none.
//! * Deviation from the book: none. With several threads, rows of the triangle are shared out and
//!   their contacts collected (memory: the contacts); counting passes run on one thread, since the
//!   counts are the same.

use crate::contact::Bodies;
use crate::detect::{Declare, Detector, Options, Refusal};
use crate::parallel;
use crate::probe::{Probe, Silent};
use crate::scene::Real;
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
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let n = bodies.len() as u32;
        if self.options.threads > 1 && P::SILENT {
            let found = parallel::contacts(n as usize, self.options.threads, &|rows, pairs| {
                for i in rows {
                    row(&bodies, i as u32, n, &mut Silent, pairs);
                }
            });
            sink.gather(&found.iter().map(Vec::as_slice).collect::<Vec<_>>());
        } else {
            for i in 0..n {
                row(&bodies, i, n, probe, sink);
            }
        }
        Ok(())
    }
}

/// Tests a particle against all after it.
#[inline(always)]
fn row<T: Real, const D: usize>(
    bodies: &impl Bodies<T, D>,
    i: u32,
    n: u32,
    probe: &mut impl Probe,
    sink: &mut impl Sink,
) {
    for j in i + 1..n {
        if bodies.touch(i, j, probe) {
            sink.contact(i, j);
        }
    }
}
