//! Operation counters that cost nothing when nobody listens.
//!
//! A detector reports its elementary operations to a [`Probe`]. With [`Silent`] every report
//! compiles to nothing (shown by `benches/silent_probe.rs`: the same number of instructions as a
//! hand-written twin); with [`Tally`] the counts are exact and the same on every machine. The words
//! are the same for all detectors, so that their counts can be compared.

use crate::event::Event;

/// An elementary operation of contact detection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Op {
    /// One coordinate of one particle turned into a cell index.
    Integerise,
    /// A particle put on a list.
    ListPush,
    /// A step from one particle of a list to the next (the step that finds the end is not counted).
    ListStep,
    /// A head or a link set back to "empty".
    ListReset,
    /// A look at the head of a cell or list, to see whether it is empty or already visited.
    CellProbe,
    /// A look at cells of another class of sizes than the body's own.
    LevelProbe,
    /// A comparison of two keys (integerised coordinates), in a sort or a search.
    KeyCompare,
    /// A visit to a node of a tree.
    NodeVisit,
    /// A particle moved by a sort.
    Move,
    /// A test of two bounding volumes other than the bodies' own.
    BoundTest,
    /// A contact test of two bodies.
    ContactTest,
    /// A contact test that floating point could not decide and exact arithmetic did (also counted
    /// as a contact test).
    ExactTest,
    /// An image of a particle made, so that a periodic box becomes a scene.
    GhostMade,
    /// Two neighbours exchanged by an insertion sort that repairs the order of an earlier frame.
    Swap,
    /// A particle taken out of the list of an earlier frame and put on another (also counted as put
    /// on a list).
    Reinsert,
    /// A box of an earlier frame made again, because bodies have left it or a box in it has grown.
    Refit,
}

impl Op {
    /// All operations, in the order of their indices.
    pub const ALL: [Op; 16] = [
        Op::Integerise,
        Op::ListPush,
        Op::ListStep,
        Op::ListReset,
        Op::CellProbe,
        Op::LevelProbe,
        Op::KeyCompare,
        Op::NodeVisit,
        Op::Move,
        Op::BoundTest,
        Op::ContactTest,
        Op::ExactTest,
        Op::GhostMade,
        Op::Swap,
        Op::Reinsert,
        Op::Refit,
    ];

    /// The name used in records and claims.
    pub fn name(self) -> &'static str {
        match self {
            Op::Integerise => "integerise",
            Op::ListPush => "list_push",
            Op::ListStep => "list_step",
            Op::ListReset => "list_reset",
            Op::CellProbe => "cell_probe",
            Op::LevelProbe => "level_probe",
            Op::KeyCompare => "key_compare",
            Op::NodeVisit => "node_visit",
            Op::Move => "move",
            Op::BoundTest => "bound_test",
            Op::ContactTest => "contact_test",
            Op::ExactTest => "exact_test",
            Op::GhostMade => "ghost_made",
            Op::Swap => "swap",
            Op::Reinsert => "reinsert",
            Op::Refit => "refit",
        }
    }
}

/// Listens to the operations of a detector.
pub trait Probe {
    /// True if the probe hears nothing; lets a detector choose a form that cannot be counted
    /// (threads).
    const SILENT: bool;
    /// `n` operations of kind `op` happened.
    fn add(&mut self, op: Op, n: u64);
    /// One operation of kind `op` happened.
    #[inline(always)]
    fn count(&mut self, op: Op) {
        self.add(op, 1);
    }
    /// Something happened that can be shown. A probe that shows nothing never makes the event.
    #[inline(always)]
    fn note(&mut self, _: impl FnOnce() -> Event) {}
}

/// Hears nothing and costs nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Probe for Silent {
    const SILENT: bool = true;
    #[inline(always)]
    fn add(&mut self, _: Op, _: u64) {}
}

/// Exact counts of every operation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally([u64; Op::ALL.len()]);

impl Tally {
    /// How often `op` happened.
    pub fn get(&self, op: Op) -> u64 {
        self.0[op as usize]
    }

    /// Operations and their counts, in the order of [`Op::ALL`].
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
