//! `direct`: direct checking (Munjiza 2004, section 3.2).
//!
//! Every pair of particles is tested once.
//!
//! * Cost: exactly N(N-1)/2 contact tests for N particles. Memory: none.
//! * Each thread tests the pairs of its share of first particles and collects contacts, 8 bytes
//!   each, in arrays of at most twice the length needed. Counting passes use one thread; the counts
//!   are the same.
//! * Refuses a scene only if the contacts collected by several threads exceed the memory limit.
//! * Deviations from the book: none.

use contactbench_ground::contact::Particles;
use contactbench_ground::detect::{Declare, Detector, Options};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::parallel;
use contactbench_ground::probe::{Probe, Silent};
use contactbench_ground::scene::Real;

/// The `direct` detector: tests every pair.
pub struct Direct {
    options: Options,
    /// Bytes of the contacts that threads have collected.
    collected: u64,
}

impl Declare for Direct {
    fn with(options: Options) -> Direct {
        Direct { options, collected: 0 }
    }

    fn formula_bytes(&self) -> u64 {
        self.collected
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Direct {
    // Not inlined and with `particles` by value: in a large caller, the compiler loads two values
    // from the stack for each pair.
    #[inline(never)]
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let n = particles.len() as u32;
        self.collected = 0;
        if self.options.threads > 1 && P::SILENT {
            return self.by_threads(particles, sink);
        }
        for i in 0..n {
            row(&particles, i, n, probe, sink);
        }
        Ok(())
    }
}

impl Direct {
    /// Not inlined and with `particles` by value: a reference would be dereferenced for each pair.
    #[inline(never)]
    fn by_threads<T: Real, const D: usize, B: Particles<T, D>, S: Sink>(
        &mut self,
        particles: B,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let Options { threads, memory_limit } = self.options;
        let n = particles.len();
        let found = parallel::contacts((n, n), threads, memory_limit, &|rows, pairs| {
            for i in rows {
                row(&particles, i as u32, n as u32, &mut Silent, pairs);
            }
        })?;
        self.collected = parallel::bytes(&found);
        sink.gather(&found.iter().map(Vec::as_slice).collect::<Vec<_>>());
        Ok(())
    }
}

#[inline(always)]
fn row<T: Real, const D: usize>(
    particles: &impl Particles<T, D>,
    i: u32,
    n: u32,
    probe: &mut impl Probe,
    sink: &mut impl Sink,
) {
    for j in i + 1..n {
        if particles.touch(i, j, probe) {
            sink.contact(i, j);
        }
    }
}
