//! Delivers the kernel's pairs: certain contacts to the sink, the others to the contact test.

use crate::detect::modern::copies::Touch;
use crate::probe::{Op, Probe};
use crate::sink::Sink;

pub(super) trait PairSink {
    fn sure(&mut self, pairs: &[[u32; 2]]);
    /// Receives a pair that only the contact test can decide.
    fn unsure(&mut self, i: u32, j: u32);
    fn counts(&self) -> bool;
    /// Receives the share of the particles that have been swept.
    fn swept(&mut self, share: f64);
    /// Counts `n` operations, including the contact tests of uncertain pairs, made later.
    fn count(&mut self, op: Op, n: u64);
}

/// Passes pairs to a sink and operations to a probe.
pub(super) struct Deliver<'a, P, S> {
    touch: Touch<'a, P>,
    probe: &'a mut P,
    sink: &'a mut S,
    /// Contact tests counted by the kernel; `unsure` counts those that `touch` counts again.
    tests: u64,
    unsure: u64,
}

impl<'a, P: Probe, S: Sink> Deliver<'a, P, S> {
    pub fn new(touch: Touch<'a, P>, probe: &'a mut P, sink: &'a mut S) -> Self {
        Deliver { touch, probe, sink, tests: 0, unsure: 0 }
    }

    /// Counts the kernel's contact tests, without those that `touch` has counted.
    pub fn finish(self) {
        self.probe.add(Op::ContactTest, self.tests.saturating_sub(self.unsure));
    }
}

impl<P: Probe, S: Sink> PairSink for Deliver<'_, P, S> {
    fn sure(&mut self, pairs: &[[u32; 2]]) {
        self.sink.contacts(pairs);
    }

    fn unsure(&mut self, i: u32, j: u32) {
        self.unsure += 1;
        if (self.touch)(i, j, self.probe) {
            self.sink.contact(i, j);
        }
    }

    fn counts(&self) -> bool {
        !P::SILENT
    }

    fn swept(&mut self, share: f64) {
        self.sink.progress(share);
    }

    fn count(&mut self, op: Op, n: u64) {
        if op == Op::ContactTest { self.tests += n } else { self.probe.add(op, n) }
    }
}
