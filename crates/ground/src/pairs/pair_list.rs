//! Lists of pairs that stop growing at a limit.
//!
//! A scene whose radii and coordinates have different units may have N(N-1)/2 pairs. These may not
//! fit in memory, and running out of memory would abort the program. A list therefore grows within
//! an [`Allowance`]. When that is spent, the list continues to count but stores nothing, so that
//! the refusal can state the number of pairs. Adding a contact costs as much as in a `Vec`: the
//! limit is checked only when a `Vec` would grow.

use std::mem::MaybeUninit;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::limits::pages;
use crate::limits::refusal::Refusal;
use crate::pairs::sink::Sink;
use crate::parallel;

/// Size of a pair in bytes.
pub const PAIR_BYTES: u64 = size_of::<[u32; 2]>() as u64;

/// Bytes that a list of pairs, or several threads' lists together, may still allocate.
#[derive(Debug)]
pub struct Allowance {
    /// Number of pairs that still fit, and number that fit at first.
    left: AtomicU64,
    all: u64,
    /// Number of lists made so far.
    lists: AtomicU64,
}

impl Allowance {
    /// Creates an allowance of this many bytes.
    pub fn new(bytes: u64) -> Allowance {
        let all = bytes / PAIR_BYTES;
        Allowance { left: AtomicU64::new(all), all, lists: AtomicU64::new(0) }
    }

    /// Takes space for up to this many pairs and returns the number of pairs that was granted.
    fn take(&self, pairs: usize) -> usize {
        let pairs = pairs as u64;
        let rest = |left: u64| Some(left.saturating_sub(pairs));
        let left = self.left.fetch_update(Relaxed, Relaxed, rest).unwrap_or_else(|left| left);
        left.min(pairs) as usize
    }

    fn give_back(&self, pairs: usize) {
        self.left.fetch_add(pairs as u64, Relaxed);
    }
}

/// A list of pairs that grows within an [`Allowance`].
///
/// The lists of several threads are adjacent and grow all the time. The alignment keeps them on
/// separate pairs of cache lines, because processors fetch such pairs together.
#[repr(align(128))]
pub struct PairList<'a> {
    pairs: Vec<[u32; 2]>,
    /// Number of pairs that were in the list at the start; these are never dropped.
    before: usize,
    /// Number of pairs that were found but not stored.
    lost: u64,
    /// Bytes that the system refused to allocate, or 0.
    exhausted: u64,
    allowance: &'a Allowance,
    /// Share of the work in which the pairs from `from` on were found.
    share: f64,
    from: usize,
    /// Estimated length of the list, or 0.
    total: usize,
    /// Whether the list has grown to an estimated length.
    estimated: bool,
    /// Sink that receives all pairs instead of the list, if set. The list then has no space, so
    /// that only the slow path of a full list checks for a sink.
    door: Option<&'a mut (dyn Sink + Send)>,
}

impl<'a> PairList<'a> {
    /// Creates a list that begins with `pairs`, whose capacity counts against the allowance.
    pub fn behind(pairs: Vec<[u32; 2]>, allowance: &'a Allowance) -> PairList<'a> {
        allowance.take(pairs.capacity());
        allowance.lists.fetch_add(1, Relaxed);
        let before = pairs.len();
        let (share, estimated) = (0.0, false);
        let (lost, exhausted, door) = (0, 0, None);
        let (from, total) = (before, 0);
        PairList { pairs, before, lost, exhausted, allowance, share, from, total, estimated, door }
    }

    /// Creates an empty list.
    pub fn new(allowance: &'a Allowance) -> PairList<'a> {
        PairList::behind(Vec::new(), allowance)
    }

    /// Creates a list that stores nothing and passes all pairs to `sink`, so that detectors need
    /// not be compiled separately for other sinks.
    pub fn door(sink: &'a mut (dyn Sink + Send), allowance: &'a Allowance) -> PairList<'a> {
        PairList { door: Some(sink), ..PairList::new(allowance) }
    }

    /// Returns the number of pairs that were in the list at the start.
    pub fn before(&self) -> usize {
        self.before
    }

    /// Returns the number of pairs found, including pairs that were not stored.
    pub fn found(&self) -> u64 {
        self.lost + (self.pairs.len() - self.before) as u64
    }

    /// Moves the list into `pairs`.
    ///
    /// # Errors
    /// Returns [`Refusal::Pairs`] if not all pairs were stored, or [`Refusal::Exhausted`] if memory
    /// ran out; `pairs` then holds only its first pairs. `particles` is the scene's number of
    /// particles, for the message.
    pub fn end(self, particles: usize, pairs: &mut Vec<[u32; 2]>) -> Result<(), Refusal> {
        let all = refused(std::slice::from_ref(&self), particles);
        let before = self.before;
        *pairs = self.into_pairs();
        if all.is_err() {
            pairs.truncate(before);
        }
        all
    }

    /// Makes space for `more` pairs and returns true if they fit. If the allowance is spent, the
    /// pairs found so far are counted and dropped, and their space is reused.
    #[cold]
    #[inline(never)]
    fn grow(&mut self, more: usize) -> bool {
        let (len, capacity) = (self.pairs.len(), self.pairs.capacity());
        let least = (len + more).saturating_sub(capacity);
        if self.lost == 0 {
            // Number of expected pairs beyond the capacity.
            let expected = self.total.saturating_sub(capacity).min(64 * capacity);
            self.estimated |= expected > capacity;
            // Other threads' lists need the rest of the allowance.
            let parts = if self.allowance.lists.load(Relaxed) > 1 { 8 } else { 1 };
            let most = self.allowance.left.load(Relaxed) as usize / parts;
            let granted = self.allowance.take(least.max(capacity.max(expected).max(4).min(most)));
            let room = capacity + granted - len;
            if granted >= least {
                if self.reserve(room) {
                    return true;
                }
                self.exhausted = (len + room) as u64 * PAIR_BYTES;
            }
            self.allowance.give_back(granted);
        }
        self.lost += (len - self.before) as u64;
        self.pairs.truncate(self.before);
        more <= self.pairs.capacity() - self.before
    }

    /// Reserves space for `more` pairs and returns true, or returns false if memory runs out.
    fn reserve(&mut self, more: usize) -> bool {
        let bytes = (self.pairs.len() + more) * size_of::<[u32; 2]>();
        // A list that grows much is copied to an array that has large pages before it is written.
        let copied = pages::is_large(bytes) && more > 4 * self.pairs.len();
        if self.pairs.is_empty() {
            // The old and the new array do not coexist.
            self.pairs = Vec::new();
        }
        let old = if copied { std::mem::take(&mut self.pairs) } else { Vec::new() };
        if self.pairs.try_reserve_exact(old.len() + more).is_err() {
            if copied {
                self.pairs = old;
            }
            return false;
        }
        pages::request(self.pairs.as_ptr().cast(), bytes, more * size_of::<[u32; 2]>());
        self.pairs.extend_from_slice(&old);
        true
    }

    /// Returns the pairs, in an array of at most twice their size if it grew by an estimate.
    fn into_pairs(mut self) -> Vec<[u32; 2]> {
        if self.estimated && self.pairs.capacity() > 2 * self.pairs.len() {
            self.pairs.shrink_to_fit();
        }
        self.pairs
    }

    /// Makes space for these pairs and returns true, or counts them or passes them to the sink.
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

/// Returns the lists of several threads, or [`Refusal::Pairs`] if not all pairs were stored.
pub fn lists(lists: Vec<PairList<'_>>, particles: usize) -> Result<Vec<Vec<[u32; 2]>>, Refusal> {
    refused(&lists, particles)?;
    Ok(lists.into_iter().map(PairList::into_pairs).collect())
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
        room: lists.first().map_or(0, |list| list.allowance.all * PAIR_BYTES),
    })
}

impl Sink for PairList<'_> {
    #[inline(always)]
    fn contact(&mut self, i: u32, j: u32) {
        // The compiler infers from this check that `push` need not grow the list.
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

    fn space(&mut self, many: usize) -> Option<&mut [MaybeUninit<[u32; 2]>]> {
        self.pairs.space(many)
    }

    unsafe fn written(&mut self, many: usize) {
        // SAFETY: the caller ensures it.
        unsafe { self.pairs.written(many) }
    }

    fn progress(&mut self, share: f64) {
        // Bundles of layers differ, so estimates from a small share are poor.
        const ENOUGH: f64 = 1.0 / 64.0;
        const MARGIN: f64 = 1.05;
        if share < self.share {
            self.from = self.pairs.len();
        }
        self.share = share;
        if share >= ENOUGH {
            let found = self.pairs.len().saturating_sub(self.from) as f64;
            self.total = self.from + (found / share * MARGIN) as usize;
        }
    }

    /// Appends lists, which all threads copy at once.
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

/// Appends lists to `pairs`. All threads copy at once.
pub fn append(pairs: &mut Vec<[u32; 2]>, lists: &[&[[u32; 2]]]) {
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
    // SAFETY: the pieces are the first `total` places of the spare capacity, one after the other,
    // and all were written.
    unsafe { pairs.set_len(pairs.len() + total) };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(count: u32) -> Vec<[u32; 2]> {
        (0..count).map(|k| [k, k + 1]).collect()
    }

    /// Up to its limit a list behaves like a `Vec` (for single pairs, many at once, and gathered
    /// lists). Beyond it, the list counts pairs and keeps only its first ones.
    #[test]
    fn lists_grow_to_their_limit_and_then_count() {
        type Fill = fn(&mut PairList<'_>, &[[u32; 2]]);
        let fills: [Fill; 5] = [
            |list, pairs| pairs.iter().for_each(|&[i, j]| list.contact(i, j)),
            |list, pairs| pairs.chunks(7).for_each(|pairs| list.contacts(pairs)),
            |list, pairs| {
                for (k, chunk) in pairs.chunks(7).enumerate() {
                    list.contacts(chunk);
                    list.progress(7.0 * (k + 1) as f64 / pairs.len() as f64);
                }
            },
            |list, pairs| list.gather(&pairs.chunks(40).collect::<Vec<_>>()),
            |list, pairs| {
                for chunk in pairs.chunks(7) {
                    let Some(space) = list.space(7) else {
                        list.contacts(chunk);
                        continue;
                    };
                    space[..chunk.len()].write_copy_of_slice(chunk);
                    // SAFETY: these pairs were just written.
                    unsafe { list.written(chunk.len()) };
                }
            },
        ];
        for fill in fills {
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

    /// 1,000 pairs in a twentieth of the work are 20,000 in all. If no more follow, the list
    /// shrinks; new work has an estimate of its own.
    #[test]
    fn lists_grow_to_their_estimated_length() {
        let allowance = Allowance::new(1 << 30);
        let mut list = PairList::new(&allowance);
        list.contacts(&pairs(1000));
        list.progress(0.05);
        list.contacts(&pairs(1000));
        assert!((20_000..22_000).contains(&list.pairs.capacity()));
        let mut into = Vec::new();
        list.end(9, &mut into).unwrap();
        assert!(into.len() == 2000 && into.capacity() <= 4000, "{}", into.capacity());
        let mut list = PairList::new(&allowance);
        list.contacts(&pairs(1000));
        [0.9, 0.02].iter().for_each(|&share| list.progress(share));
        list.contacts(&pairs(1000));
        assert_eq!(list.pairs.capacity(), 2000);
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
