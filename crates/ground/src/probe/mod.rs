//! Operation counters that compile to nothing unless a probe counts.
//!
//! A detector reports its elementary operations to a [`Probe`]. For [`Silent`] every report
//! compiles to nothing; `crates/campaigns/src/bin/silent_probe.rs` checks that the number of
//! instructions equals that of a hand-written twin. The counts of [`Tally`] are exact and equal on
//! every machine. All detectors use the same set of operations, so that counts are comparable.

pub mod event;

pub use contactbench_terms::op::Op;

use crate::probe::event::Event;

/// Receives the operations of a detector.
pub trait Probe {
    /// Whether the probe ignores all operations. A detector may then use code that cannot be
    /// counted, such as threads.
    const SILENT: bool;
    /// Receives `n` operations of kind `op`.
    fn add(&mut self, op: Op, n: u64);
    /// Receives one operation of kind `op`.
    #[inline(always)]
    fn count(&mut self, op: Op) {
        self.add(op, 1);
    }
    /// Receives an event: a step of a detector. It is created only if the probe uses events.
    #[inline(always)]
    fn note(&mut self, _: impl FnOnce() -> Event) {}
}

/// A probe that ignores everything and costs nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Probe for Silent {
    const SILENT: bool = true;
    #[inline(always)]
    fn add(&mut self, _: Op, _: u64) {}
}

/// A probe that counts every operation exactly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally([u64; Op::ALL.len()]);

impl Tally {
    /// Returns the number of operations of this kind.
    pub fn get(&self, op: Op) -> u64 {
        self.0[op as usize]
    }

    /// Returns all kinds of operations with their counts, in the order of [`Op::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Op, u64)> + '_ {
        Op::ALL.into_iter().map(|op| (op, self.get(op)))
    }
}

impl Probe for Tally {
    const SILENT: bool = false;
    #[inline(always)]
    fn add(&mut self, op: Op, n: u64) {
        self.0[op as usize] += n;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_operation_has_its_own_slot_and_name() {
        let mut tally = Tally::default();
        for (k, op) in Op::ALL.into_iter().enumerate() {
            assert_eq!(op as usize, k);
            tally.add(op, k as u64 + 1);
        }
        for (k, op) in Op::ALL.into_iter().enumerate() {
            assert_eq!(tally.get(op), k as u64 + 1);
        }
        let names: std::collections::HashSet<_> = Op::ALL.iter().map(|op| op.name()).collect();
        assert_eq!(names.len(), Op::ALL.len());
    }
}
