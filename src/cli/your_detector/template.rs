//! `new-detector`: what it does, in a line (author, year, "title", section).
//!
//! 1. The particles are sorted along x.
//! 2. Each is tested against the following ones within reach along x.
//!
//! * Cost: N log N key comparisons for N particles, and a bound test for every pair within reach
//!   along x: N^(2 - 1/D) in a box.
//! * Memory: `16N` bytes.
//! * Refuses scenes over the memory limit.
//! * Deviations from the source: none.

use contactbench_ground::contact::Particles;
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::filter;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;

/// Sorts along x, and tests the pairs within reach.
pub struct NewDetector {
    options: Options,
    /// x and number of each particle, sorted by x. Kept between calls, so that a second detection
    /// allocates nothing.
    order: Vec<(f64, u32)>,
}

/// Memory for `n` particles in bytes: 8 for x, 4 for the number, 4 for padding.
fn bytes(n: usize) -> u64 {
    16 * n as u64
}

impl Declare for NewDetector {
    fn with(options: Options) -> NewDetector {
        NewDetector { options, order: Vec::new() }
    }

    fn formula_bytes(&self) -> u64 {
        bytes(self.order.len())
    }
}

impl<T: Real, const D: usize> Detector<T, D> for NewDetector {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let n = particles.len();
        // This check comes before anything is allocated or reported.
        within(&self.options, "new-detector", bytes(n), || format!("{n} particles"))?;
        self.order.clear();
        self.order.reserve_exact(n);
        self.order.extend((0..n as u32).map(|id| (particles.position(id)[0], id)));
        self.order.sort_unstable_by(|a, b| {
            probe.count(Op::KeyCompare);
            a.0.total_cmp(&b.0)
        });
        for (k, &(x, i)) in self.order.iter().enumerate() {
            for &(further, j) in &self.order[k + 1..] {
                probe.count(Op::BoundTest);
                // Rounding loses no contact here; crate::filter has the proof, also for cells,
                // boxes and keys.
                if filter::beyond(x, further, particles.reach()) {
                    break;
                }
                if particles.touch(i, j, probe) {
                    sink.contact(i, j);
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_ground::contact::Test;
    use contactbench_ground::detect::any;
    use contactbench_ground::probe::Tally;
    use contactbench_ground::scene::Scene;

    /// Four tangent discs in a row, and one far away. Tests of all detectors include this one; here
    /// is the place for tests of its own.
    #[test]
    fn a_row_of_discs() {
        let scene = Scene::at([3.0, 0.0, 1.0, 1e6, 2.0].map(|x| [x, 0.5]), 0.5).unwrap();
        let (mut detector, mut tally, mut pairs) =
            (NewDetector::with(Options::default()), Tally::default(), Vec::<[u32; 2]>::new());
        any::run(&mut detector, &scene, Test::Exact, &mut tally, &mut pairs).unwrap();
        pairs.iter_mut().for_each(|pair| pair.sort_unstable());
        pairs.sort_unstable();
        assert_eq!(pairs, [[0, 4], [1, 2], [2, 4]]);
        assert_eq!((tally.get(Op::ContactTest), tally.get(Op::BoundTest)), (3, 7));
        assert_eq!(detector.formula_bytes(), 5 * 16);
    }
}
