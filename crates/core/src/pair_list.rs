//! Lists of pairs that stop growing at a limit.
//!
//! A scene whose radii are in another unit than its coordinates has up to N(N-1)/2 pairs: no list
//! holds them, and memory that cannot be had would end the program. Here a list grows within an
//! [`Allowance`]. Where that is spent it goes on counting and keeps nothing, so that the refusal
//! can say how many pairs there are. Detectors need not know: what a contact costs is what it
//! costs in a `Vec`, and the limit is looked at where a `Vec` would grow.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::parallel;
use crate::refusal::Refusal;
use crate::sink::Sink;

/// Bytes of a pair.
pub const PAIR_BYTES: u64 = size_of::<[u32; 2]>() as u64;

/// What lists of pairs may still take from the heap: one list, or those of several threads
/// together.
#[derive(Debug)]
pub struct Allowance(AtomicU64);

impl Allowance {
    /// So many bytes.
    pub fn new(bytes: u64) -> Allowance {
        Allowance(AtomicU64::new(bytes / PAIR_BYTES))
    }

    /// Room for up to so many pairs; for how many there is.
    fn take(&self, pairs: usize) -> usize {
        let pairs = pairs as u64;
        let rest = |left: u64| Some(left.saturating_sub(pairs));
        let left = self.0.fetch_update(Relaxed, Relaxed, rest).unwrap_or_else(|left| left);
        left.min(pairs) as usize
    }

    fn give_back(&self, pairs: usize) {
        self.0.fetch_add(pairs as u64, Relaxed);
    }
}

/// A list of pairs within an [`Allowance`].
///
/// Lists of several threads lie side by side, and each grows all the time: no two share a line of
/// the caches, nor the pair of lines that is fetched at once.
#[repr(align(128))]
pub struct PairList<'a> {
    pairs: Vec<[u32; 2]>,
    /// Pairs that were there before: they stay, whatever comes.
    before: usize,
    /// Pairs found that there was no room for.
    lost: u64,
    /// Bytes that the system would not give, or 0.
    exhausted: u64,
    allowance: &'a Allowance,
    /// Takes all pairs, if there is one: the list then has no room, so that only who finds it full
    /// need look.
    door: Option<&'a mut (dyn Sink + Send)>,
}

impl<'a> PairList<'a> {
    /// Goes on behind the pairs of a list, whose room is charged.
    pub fn behind(pairs: Vec<[u32; 2]>, allowance: &'a Allowance) -> PairList<'a> {
        allowance.take(pairs.capacity());
        PairList { before: pairs.len(), pairs, lost: 0, exhausted: 0, allowance, door: None }
    }

    /// An empty list.
    pub fn new(allowance: &'a Allowance) -> PairList<'a> {
        PairList::behind(Vec::new(), allowance)
    }

    /// None at all: everything goes on to `sink`, and no detector need be compiled for it.
    pub fn door(sink: &'a mut (dyn Sink + Send), allowance: &'a Allowance) -> PairList<'a> {
        PairList { door: Some(sink), ..PairList::new(allowance) }
    }

    /// How many pairs were there before.
    pub fn before(&self) -> usize {
        self.before
    }

    /// How many pairs have been found, whether there was room for them or not.
    pub fn found(&self) -> u64 {
        self.lost + (self.pairs.len() - self.before) as u64
    }

    /// Puts the list into `pairs`.
    ///
    /// # Errors
    /// [`Refusal::Pairs`] if there was no room for all of them; `pairs` is then as it was before
    /// the first. `particles` is the number of particles of the scene, for the message.
    pub fn end(self, particles: usize, pairs: &mut Vec<[u32; 2]>) -> Result<(), Refusal> {
        let all = refused(std::slice::from_ref(&self), particles);
        *pairs = self.pairs;
        if all.is_err() {
            pairs.truncate(self.before);
        }
        all
    }

    /// Room for `more` pairs; false if there is none. Then what was found so far is counted and
    /// dropped, and its room is used again and again.
    #[cold]
    #[inline(never)]
    fn grow(&mut self, more: usize) -> bool {
        let (len, capacity) = (self.pairs.len(), self.pairs.capacity());
        let least = (len + more).saturating_sub(capacity);
        if self.lost == 0 {
            let granted = self.allowance.take(least.max(capacity).max(4));
            let room = capacity + granted - len;
            if granted >= least {
                if self.pairs.try_reserve_exact(room).is_ok() {
                    return true;
                }
                self.exhausted = (len + room) as u64 * PAIR_BYTES;
            }
            self.allowance.give_back(granted);
        }
        self.lost += (len - self.before) as u64;
        self.pairs.truncate(self.before);
        more <= capacity - self.before
    }

    /// Room for these pairs; if there is none, they are counted, or handed on.
    #[cold]
    #[inline(never)]
    fn has_grown_for(&mut self, pairs: &[[u32; 2]]) -> bool {
        if let Some(sink) = &mut self.door {
            sink.contacts(pairs);
            return false;
        }
        let grown = self.grow(pairs.len());
        if !grown {
            self.lost += pairs.len() as u64;
        }
        grown
    }

    #[cold]
    #[inline(never)]
    fn grow_for(&mut self, pair: [u32; 2]) {
        if let Some(sink) = &mut self.door {
            sink.contact(pair[0], pair[1]);
        } else if self.grow(1) {
            self.pairs.push(pair);
        } else {
            self.lost += 1;
        }
    }
}

/// The lists of several threads.
///
/// # Errors
/// [`Refusal::Pairs`] if there was no room for one of them.
pub(crate) fn lists(
    lists: Vec<PairList<'_>>,
    particles: usize,
) -> Result<Vec<Vec<[u32; 2]>>, Refusal> {
    refused(&lists, particles)?;
    Ok(lists.into_iter().map(|list| list.pairs).collect())
}

fn refused(lists: &[PairList<'_>], particles: usize) -> Result<(), Refusal> {
    if lists.iter().all(|list| list.lost == 0) {
        return Ok(());
    }
    if let Some(bytes) = lists.iter().map(|list| list.exhausted).find(|&bytes| bytes > 0) {
        return Err(Refusal::Exhausted { bytes });
    }
    Err(Refusal::Pairs {
        found: lists.iter().map(PairList::found).sum(),
        particles: particles as u64,
        room: lists.iter().map(|list| list.pairs.capacity() as u64 * PAIR_BYTES).sum(),
    })
}

impl Sink for PairList<'_> {
    #[inline(always)]
    fn contact(&mut self, i: u32, j: u32) {
        // The compiler sees that there is room behind this, and leaves out what `push` would ask.
        if self.pairs.len() == self.pairs.capacity() {
            return self.grow_for([i, j]);
        }
        self.pairs.push([i, j]);
    }

    #[inline(always)]
    fn contacts(&mut self, pairs: &[[u32; 2]]) {
        if pairs.len() > self.pairs.capacity() - self.pairs.len() && !self.has_grown_for(pairs) {
            return;
        }
        self.pairs.extend_from_slice(pairs);
    }

    /// Copied by all threads at once.
    fn gather(&mut self, lists: &[&[[u32; 2]]]) {
        if let Some(sink) = &mut self.door {
            return sink.gather(lists);
        }
        let total = lists.iter().map(|list| list.len()).sum();
        if total > self.pairs.capacity() - self.pairs.len() && !self.grow(total) {
            self.lost += total as u64;
            return;
        }
        append(&mut self.pairs, lists);
    }
}

/// Copies lists behind `pairs`, by all threads at once.
pub(crate) fn append(pairs: &mut Vec<[u32; 2]>, lists: &[&[[u32; 2]]]) {
    let total = lists.iter().map(|list| list.len()).sum();
    pairs.reserve(total);
    let (mut room, mut pieces) = (pairs.spare_capacity_mut(), Vec::with_capacity(lists.len()));
    for &list in lists {
        let (piece, rest) = room.split_at_mut(list.len());
        pieces.push((piece, list));
        room = rest;
    }
    parallel::for_each(&mut pieces, |_, (piece, list)| {
        piece.write_copy_of_slice(list);
    });
    // SAFETY: the pieces are the first `total` places of the room, one after the other, and all
    // were written.
    unsafe { pairs.set_len(pairs.len() + total) };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(count: u32) -> Vec<[u32; 2]> {
        (0..count).map(|k| [k, k + 1]).collect()
    }

    /// One by one, many at once, and gathered: a list holds what a `Vec` does up to its limit, and
    /// beyond it knows how many there were and gives back what was there before.
    #[test]
    fn lists_grow_to_their_limit_and_then_count() {
        type Way = fn(&mut PairList<'_>, &[[u32; 2]]);
        let ways: [Way; 3] = [
            |list, pairs| pairs.iter().for_each(|&[i, j]| list.contact(i, j)),
            |list, pairs| pairs.chunks(7).for_each(|pairs| list.contacts(pairs)),
            |list, pairs| list.gather(&pairs.chunks(40).collect::<Vec<_>>()),
        ];
        for fill in ways {
            for (count, most) in [(0, 0), (1, 0), (99, 100), (100, 100), (101, 100), (5000, 64)] {
                for before in [0, 3] {
                    let earlier = pairs(before);
                    let bytes = (most + u64::from(before)) * PAIR_BYTES;
                    let allowance = Allowance::new(bytes);
                    let mut list = PairList::behind(earlier.clone(), &allowance);
                    let found = pairs(count);
                    fill(&mut list, &found);
                    let mut into = Vec::new();
                    let ended = list.end(9, &mut into);
                    assert!(into.capacity() as u64 * PAIR_BYTES <= bytes);
                    if u64::from(count) <= most {
                        assert_eq!((ended, into), (Ok(()), [earlier, found].concat()));
                        continue;
                    }
                    assert_eq!(into, earlier, "{count} of {most}");
                    let Err(Refusal::Pairs { found, particles: 9, room }) = ended else {
                        panic!("{ended:?}")
                    };
                    assert!(found == u64::from(count) && room <= bytes, "{found}, {room}");
                }
            }
        }
    }

    #[test]
    fn threads_share_an_allowance() {
        let allowance = Allowance::new(100 * PAIR_BYTES);
        let mut shared = [PairList::new(&allowance), PairList::new(&allowance)];
        shared[0].contacts(&pairs(60));
        shared[1].contacts(&pairs(40));
        let [a, b] = shared;
        assert_eq!(lists(vec![a, b], 1).unwrap(), [pairs(60), pairs(40)]);
        let allowance = Allowance::new(100 * PAIR_BYTES);
        let mut shared = [PairList::new(&allowance), PairList::new(&allowance)];
        shared[0].contacts(&pairs(60));
        shared[1].contacts(&pairs(41));
        let Err(Refusal::Pairs { found: 101, .. }) = lists(shared.into(), 1) else { panic!() };
    }
}
