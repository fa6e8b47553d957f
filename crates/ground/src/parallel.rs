//! Divides work among several threads.
//!
//! All work passes through one function that is not generic, so that rayon's code is compiled once,
//! not for every detector. It costs one dynamic call per share, not per particle.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

use crate::limits::refusal::Refusal;
use crate::pairs::pair_list::{self, Allowance, PAIR_BYTES, PairList};

type Pairs = Vec<[u32; 2]>;

/// Number of shares per thread if shares may differ in cost; few enough to have no overhead.
pub const SHARES_PER_THREAD: usize = 16;

/// Returns share `k` of `count` items, divided into `shares` shares of about equal size.
pub fn share(count: usize, shares: usize, k: usize) -> Range<usize> {
    k * count / shares..(k + 1) * count / shares
}

/// Calls `work` with the index of every item and the item, in parallel on this thread and rayon's
/// threads. A single item is processed on this thread.
pub fn for_each<A: Send>(items: &mut [A], work: impl Fn(usize, &mut A) + Sync) {
    for_each_by(items.len(), items, work);
}

/// Works as [`for_each`] on at most `threads` threads.
pub fn for_each_by<A: Send>(threads: usize, items: &mut [A], work: impl Fn(usize, &mut A) + Sync) {
    if let [item] = items {
        return work(0, item);
    }
    // Each lock is taken only once, so no thread waits.
    let items: Vec<Mutex<&mut A>> = items.iter_mut().map(Mutex::new).collect();
    run(items.len(), threads, &|k| {
        work(k, &mut items[k].lock().unwrap_or_else(PoisonError::into_inner))
    });
}

/// Calls `work` with the number of every share. This thread takes shares, too, and starts at once,
/// because waking a thread takes longer than a small scene. A thread that wakes late finds no
/// shares left, but the call waits for it.
fn run(shares: usize, threads: usize, work: &(dyn Fn(usize) + Sync)) {
    let next = AtomicUsize::new(0);
    let take = || {
        loop {
            let k = next.fetch_add(1, Relaxed);
            if k >= shares {
                break;
            }
            work(k);
        }
    };
    let helpers = rayon::current_num_threads().min(shares).min(threads).saturating_sub(1);
    rayon::in_place_scope(|scope| {
        (0..helpers).for_each(|_| scope.spawn(|_| take()));
        take();
    });
}

/// Returns the contacts that `work` finds in ranges of `0..count`, in the order of the ranges. One
/// thread gets a single range. All lists together may take `limit` bytes; `particles` is used in
/// messages. Fails with [`Refusal::Pairs`] if the lists would be longer.
pub fn contacts(
    (count, particles): (usize, usize),
    threads: usize,
    limit: u64,
    work: &(dyn Fn(Range<usize>, &mut PairList<'_>) + Sync),
) -> Result<Vec<Pairs>, Refusal> {
    let shares = if threads > 1 { (SHARES_PER_THREAD * threads).min(count).max(1) } else { 1 };
    let allowance = Allowance::new(limit);
    let mut found: Vec<_> = (0..shares).map(|_| PairList::new(&allowance)).collect();
    for_each_by(threads, &mut found, |k, pairs| work(share(count, shares, k), pairs));
    pair_list::lists(found, particles)
}

pub fn bytes(lists: &[Pairs]) -> u64 {
    lists.iter().map(|pairs| pairs.capacity() as u64 * PAIR_BYTES).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pairs::sink::Sink;

    #[test]
    fn every_thing_is_in_one_share_and_results_are_in_order() {
        for (count, threads) in [(0, 1), (0, 4), (1, 4), (7, 1), (7, 3), (1000, 2), (1001, 5)] {
            let found = contacts((count, count), threads, 1 << 20, &|range, pairs| {
                range.for_each(|k| pairs.contact(k as u32, 0));
            });
            let found = found.unwrap();
            assert!(threads > 1 || found.len() == 1);
            let all: Vec<usize> = found.iter().flatten().map(|pair| pair[0] as usize).collect();
            assert_eq!(all, (0..count).collect::<Vec<_>>(), "{count} by {threads}");
        }
        let mut squares = [0; 5];
        for_each(&mut squares, |k, square| *square = k * k);
        assert_eq!(squares, [0, 1, 4, 9, 16]);
    }
}
