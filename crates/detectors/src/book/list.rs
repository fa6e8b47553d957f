//! Singly linked lists in arrays: the data structure of the book.
//!
//! A list has a head (the last particle pushed), and every particle links to the next one.
//! Particles are numbered from 0 and [`EMPTY`] ends a list; the book numbers from 1 and ends with
//! -1. A head can be *marked* as old: the book adds N to it, this code sets the highest bit. Each
//! way leaves room for 2^31 - 1 particles. This module counts all list operations.

use contactbench_ground::contact::Particles;
use contactbench_ground::limits::refusal::at_least;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::event::Event;
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;

/// End of a list, and head of an empty list.
pub const EMPTY: u32 = u32::MAX >> 1;
const OLD: u32 = 1 << 31;
/// Heads of a set of lists. All of them are [`EMPTY`] between detections.
#[derive(Clone, Debug, Default)]
pub struct Heads(Vec<u32>, char);

/// The next particle on a list for every particle, for `L` kinds of lists (NBS has z-, y- and
/// x-lists). The links of one particle are adjacent: a walk over lists of one kind that builds
/// lists of another touches one cache line per particle instead of `L`. Contents between detections
/// have no meaning.
#[derive(Clone, Debug, Default)]
pub struct Links<const L: usize>(Vec<[u32; L]>);

/// Number of a list: `u32` for a cell along one axis, `usize` for a cell of the whole domain.
pub trait Index: Copy {
    fn at(self) -> usize;
}

impl Index for u32 {
    #[inline(always)]
    fn at(self) -> usize {
        self as usize
    }
}

impl Index for usize {
    #[inline(always)]
    fn at(self) -> usize {
        self
    }
}

impl Heads {
    /// Creates an empty set of lists; recorded events refer to the set by `name`.
    pub fn named(name: char) -> Heads {
        Heads(Vec::new(), name)
    }

    /// Makes room for lists 0 to `count - 1`. This is the only loop over cells; it runs when the
    /// array is made or grows.
    pub fn prepare(&mut self, count: usize) {
        // All heads are empty here, so nothing need be copied.
        at_least(&mut self.0, count, EMPTY);
        debug_assert!(
            self.0.iter().take(1 << 16).all(|&head| head == EMPTY),
            "a list was not reset"
        );
    }

    /// Puts `particle` on `list`, which must not be marked as old, by its link of this `kind`.
    #[inline(always)]
    pub fn push<const L: usize, P: Probe>(
        &mut self,
        list: impl Index,
        particle: u32,
        links: &mut Links<L>,
        kind: usize,
        probe: &mut P,
    ) {
        probe.count(Op::ListPush);
        let next = std::mem::replace(&mut self.0[list.at()], particle);
        links.0[particle as usize][kind] = next;
        probe.note(|| Event::Push { heads: self.1, list: list.at(), particle, next: listed(next) });
    }

    /// Returns the first particle of `list`, or [`EMPTY`].
    #[inline(always)]
    pub fn first<P: Probe>(&self, list: impl Index, probe: &mut P) -> u32 {
        probe.count(Op::CellProbe);
        let head = self.0[list.at()];
        probe.note(|| Event::Look { heads: self.1, list: list.at(), first: listed(head) });
        head & !OLD
    }

    /// Returns the first particle of a list that will soon be needed, or [`EMPTY`] beyond the last.
    #[inline(always)]
    pub fn ahead(&self, list: impl Index) -> u32 {
        self.0.get(list.at()).map_or(EMPTY, |&head| head & !OLD)
    }

    /// Marks `list` as old and returns its first particle, or `None` if it is empty or was old.
    #[inline(always)]
    pub fn take_new<P: Probe>(&mut self, list: impl Index, probe: &mut P) -> Option<u32> {
        probe.count(Op::CellProbe);
        let head = &mut self.0[list.at()];
        let first = *head;
        probe.note(|| Event::Take {
            heads: self.1,
            list: list.at(),
            first: listed(first),
            old: first & OLD != 0,
        });
        // EMPTY is the largest number without the mark.
        if first >= EMPTY {
            return None;
        }
        *head |= OLD;
        Some(first)
    }

    #[inline(always)]
    pub fn reset<P: Probe>(&mut self, list: impl Index, probe: &mut P) {
        probe.count(Op::ListReset);
        self.0[list.at()] = EMPTY;
        probe.note(|| Event::Reset { heads: self.1, list: list.at() });
    }

    #[cfg(test)]
    pub fn raw(&self) -> &[u32] {
        &self.0
    }
}

fn listed(raw: u32) -> Option<u32> {
    (raw & !OLD != EMPTY).then_some(raw & !OLD)
}

impl<const L: usize> Links<L> {
    pub fn prepare(&mut self, count: usize) {
        at_least(&mut self.0, count, [EMPTY; L]);
    }

    #[inline(always)]
    pub fn set(&mut self, particle: u32, kind: usize, next: u32) {
        self.0[particle as usize][kind] = next;
    }

    /// Returns the particle after `particle` on its list, or [`EMPTY`].
    #[inline(always)]
    pub fn next<P: Probe>(&self, particle: u32, kind: usize, probe: &mut P) -> u32 {
        probe.count(Op::ListStep);
        self.0[particle as usize][kind]
    }

    /// Tests the particles of the list starting at `central` against each other and against those
    /// of the `mask` lists, each pair once.
    #[inline(always)]
    pub fn check<T: Real, const D: usize, const M: usize>(
        &self,
        kind: usize,
        particles: &impl Particles<T, D>,
        central: u32,
        mask: [u32; M],
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    ) {
        let mut i = central;
        while i != EMPTY {
            let rest = self.next(i, kind, probe);
            self.check_one(kind, particles, i, rest, probe, sink);
            for first in mask {
                self.check_one(kind, particles, i, first, probe, sink);
            }
            i = rest;
        }
    }

    #[inline(always)]
    fn check_one<T: Real, const D: usize>(
        &self,
        kind: usize,
        particles: &impl Particles<T, D>,
        i: u32,
        first: u32,
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    ) {
        let mut j = first;
        while j != EMPTY {
            let touching = particles.touch(i, j, probe);
            probe.note(|| Event::Test { i, j, touching });
            if touching {
                sink.contact(i, j);
            }
            j = self.next(j, kind, probe);
        }
    }

    #[cfg(test)]
    pub fn raw(&self, kind: usize) -> Vec<u32> {
        self.0.iter().map(|links| links[kind]).collect()
    }

    /// Clears a particle's link, as the book's screening does when it removes particles.
    #[inline(always)]
    pub fn reset<P: Probe>(&mut self, particle: u32, kind: usize, probe: &mut P) {
        probe.count(Op::ListReset);
        self.0[particle as usize][kind] = EMPTY;
        probe.note(|| Event::Unlink { particle });
    }
}

/// Converts an array to the numbers that the book prints: from 1, and -1 for empty.
#[cfg(test)]
pub fn as_printed(raw: &[u32]) -> Vec<i64> {
    raw.iter().map(|&e| if e & !OLD == EMPTY { -1 } else { i64::from(e & !OLD) + 1 }).collect()
}
