//! Sorts lists of pairs into the order in which they are written and compared.
//!
//! A detector's list is ordered in space, with particle numbers in any order, so sorting it moves
//! pairs far. The pairs are first partitioned in place by the leading bits of their first index,
//! until each part fits in a cache. In each part, pairs are then placed by counting the first
//! indices, and only the few second indices of each first index are compared.

use crate::limits::refusal::reserve;
use crate::parallel;
use crate::radix::{DIGIT, part};
use crate::wide::{Kernel, Level, Wide};

/// Lists up to this length are sorted by comparison.
const FEW: usize = 1024;
/// Lists up to this length are sorted by one thread.
const FEW_FOR_THREADS: usize = 1 << 17;
/// Largest, and then preferred, number of bits of first indices that are counted at once.
const COUNTED: u32 = 14;
const WELL_COUNTED: u32 = 12;
/// Largest number of pairs that are counted at once.
const TOGETHER: usize = 1 << 16;

/// Puts the smaller index of each pair first and sorts the pairs in ascending order.
pub fn normalise(pairs: &mut [[u32; 2]]) {
    normalise_by(1, pairs);
}

/// Works as [`normalise`], with up to `threads` of rayon's threads if there are many pairs.
pub fn normalise_by(threads: usize, pairs: &mut [[u32; 2]]) {
    let most = Level::best().run(Turn(pairs));
    let bits = u32::BITS - most.leading_zeros();
    if threads <= 1 || pairs.len() <= FEW_FOR_THREADS || bits <= WELL_COUNTED {
        return sort_in(&mut Room::default(), pairs, bits);
    }
    let (digit, ends) = parts(pairs, bits);
    let ends = &ends[..1 << digit];
    let count = (parallel::SHARES_PER_THREAD * threads).min(ends.len());
    let (mut shares, mut rest, mut begin) = (Vec::new(), pairs, 0);
    for share in 0..count {
        let ends = &ends[parallel::share(ends.len(), count, share)];
        let Some(&end) = ends.last() else { continue };
        let (pairs, after) = rest.split_at_mut(end - begin);
        shares.push((pairs, begin, ends));
        (rest, begin) = (after, end);
    }
    parallel::for_each_by(threads, &mut shares, |_, (pairs, begin, ends)| {
        // Each thread has buffers that it reuses for its parts.
        let (mut room, mut from) = (Room::default(), 0);
        for end in ends.iter().map(|end| end - *begin) {
            sort_in(&mut room, &mut pairs[from..end], bits - digit);
            from = end;
        }
    });
}

/// Sorts pairs whose first indices differ only in the last `bits` bits. Allocates the buffers if
/// needed; without memory for them, sorts by comparison.
fn sort_in(room: &mut Room, pairs: &mut [[u32; 2]], bits: u32) {
    match pairs.len() > FEW && (!room.seconds.is_empty() || room.is_made()) {
        true => sort(pairs, bits, room),
        false => pairs.sort_unstable(),
    }
}

/// Puts the smaller index of each pair first and does not reorder the pairs.
pub fn smaller_first(pairs: &mut [[u32; 2]]) {
    Level::best().run(Turn(pairs));
}

/// Puts the smaller index of each pair first and returns the largest of the smaller indices.
struct Turn<'a>(&'a mut [[u32; 2]]);

impl Kernel for Turn<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<W: Wide>(self, _: W) -> u32 {
        let mut most = 0;
        for pair in self.0 {
            let [i, j] = *pair;
            *pair = [i.min(j), i.max(j)];
            most = most.max(pair[0]);
        }
        most
    }
}

#[derive(Default)]
struct Room {
    /// Place at which the pairs of each first index start and, after they are placed, end.
    places: Vec<u32>,
    seconds: Vec<u32>,
}

impl Room {
    /// Allocates the buffers; returns false if memory runs out.
    fn is_made(&mut self) -> bool {
        let sizes = [(&mut self.places, 1 << COUNTED), (&mut self.seconds, TOGETHER)];
        sizes.into_iter().all(|(list, size)| {
            let made = reserve(list, size).is_ok();
            list.resize(if made { size } else { 0 }, 0);
            made
        })
    }
}

/// Sorts pairs whose first indices differ only in the last `bits` bits.
fn sort(pairs: &mut [[u32; 2]], bits: u32, room: &mut Room) {
    if pairs.len() <= FEW || bits == 0 {
        return pairs.sort_unstable();
    }
    if bits <= COUNTED && pairs.len() <= TOGETHER {
        // Counting visits all possible first indices, so it pays only for enough pairs.
        return match pairs.len() >> (bits - bits.min(2)) {
            0 => pairs.sort_unstable(),
            _ => count(pairs, bits, room),
        };
    }
    let (digit, ends) = parts(pairs, bits);
    let mut begin = 0;
    for &end in &ends[..1 << digit] {
        sort(&mut pairs[begin..end], bits - digit, room);
        begin = end;
    }
}

/// Partitions pairs whose first indices differ only in the last `bits` bits, by the leading ones of
/// these bits. Returns the number of leading bits and the ends of the parts.
fn parts(pairs: &mut [[u32; 2]], bits: u32) -> (u32, [usize; 1 << DIGIT]) {
    let digit = if bits > WELL_COUNTED { bits - WELL_COUNTED } else { bits }.min(DIGIT);
    let (shift, last) = (bits - digit, (1 << digit) - 1);
    (digit, part(pairs, digit, |pair| (pair[0] >> shift) as usize & last))
}

fn count(pairs: &mut [[u32; 2]], bits: u32, room: &mut Room) {
    let Some(&[some, _]) = pairs.first() else { return };
    let mask = (1 << bits) - 1;
    let places = &mut room.places[..1 << bits];
    places.fill(0);
    pairs.iter().for_each(|pair| places[(pair[0] & mask) as usize] += 1);
    let mut sum = 0;
    for place in &mut *places {
        sum += std::mem::replace(place, sum);
    }
    for &[i, j] in &*pairs {
        let place = &mut places[(i & mask) as usize];
        room.seconds[*place as usize] = j;
        *place += 1;
    }
    let mut begin = 0;
    for (k, &end) in (0..).zip(&*places) {
        let seconds = &mut room.seconds[begin..end as usize];
        match seconds.len() {
            0 | 1 => {}
            2 => network::<2>(seconds, [[0, 1]]),
            3 => network::<3>(seconds, [[0, 1], [1, 2], [0, 1]]),
            4 => network::<4>(seconds, [[0, 1], [2, 3], [0, 2], [1, 3], [1, 2]]),
            5 => network::<5>(
                seconds,
                [[0, 1], [3, 4], [2, 4], [2, 3], [1, 4], [0, 3], [0, 2], [1, 3], [1, 2]],
            ),
            _ => seconds.sort_unstable(),
        }
        for (pair, &j) in pairs[begin..].iter_mut().zip(&*seconds) {
            *pair = [some & !mask | k, j];
        }
        begin = end as usize;
    }
}

/// Sorts the first `N` values by a sorting network without branches, which could not be predicted
/// (Knuth, The Art of Computer Programming 3, section 5.3.4).
#[inline(always)]
fn network<const N: usize>(list: &mut [u32], pairs: impl IntoIterator<Item = [usize; 2]>) {
    let Some(list) = list.first_chunk_mut::<N>() else { return };
    for [a, b] in pairs {
        (list[a], list[b]) = (list[a].min(list[b]), list[a].max(list[b]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_terms::mix::splitmix64;

    /// Compares with the standard library on many kinds of lists: indices near each other or not,
    /// few or many pairs per first index, one index in all pairs, duplicates, and sorted lists.
    #[test]
    fn every_list_is_sorted() {
        let mut ways = [0; 3];
        for (case, count) in (0..).zip([0, 1, 2, 1024, 1025, 3000, 40_000, 70_000, 150_000]) {
            for bits in [1, 3, 8, 12, 14, 15, 20, 24, 27, 32] {
                for giant in [false, true] {
                    let index = |k: u64| splitmix64(k ^ case << 40) >> (64 - bits);
                    let pair = |k: u64| {
                        let i = if giant && k.is_multiple_of(2) { 1 } else { index(2 * k) };
                        [i as u32, index(2 * k + 1) as u32]
                    };
                    let mut pairs: Vec<[u32; 2]> = (0..count).map(pair).collect();
                    let mut sorted = pairs.clone();
                    sorted.iter_mut().for_each(|pair| pair.sort_unstable());
                    sorted.sort_unstable();
                    for threads in [1, 1, 3] {
                        if threads > 1 {
                            pairs.reverse();
                            pairs.iter_mut().for_each(|pair| pair.reverse());
                        }
                        normalise_by(threads, &mut pairs);
                        assert!(pairs == sorted, "{count} pairs, {bits} bits, {giant}, {threads}");
                    }
                    let len = pairs.len();
                    ways[usize::from(len > FEW) + usize::from(len > TOGETHER)] += 1;
                }
            }
        }
        assert!(ways.into_iter().all(|count| count > 20), "{ways:?}");
    }
}
