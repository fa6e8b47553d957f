//! Partitions items in place, by the digits of a number.
//!
//! The algorithm is the American flag sort of McIlroy, Bostic and McIlroy 1993, Engineering radix
//! sort, Computing Systems 6(1), 5-27. Unlike in that article, a displaced item waits until its
//! part is scanned, so that no swap waits for the one before.

/// Largest number of bits of a digit: 2^10 write positions are not too many for caches and pages.
pub const DIGIT: u32 = 10;

/// Prefetches an element that will be written soon.
#[inline(always)]
pub fn prefetch_to_write<A>(array: &[A], at: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_ET0, _mm_prefetch};
        // SAFETY: a prefetch reads and writes nothing, and any address is allowed.
        unsafe { _mm_prefetch::<_MM_HINT_ET0>(array.as_ptr().wrapping_add(at).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (array, at);
}

/// Prefetches an element that will be read soon, with both of its cache lines if it straddles two.
#[inline(always)]
pub fn prefetch_to_read<A>(array: &[A], at: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let (first, next) = (array.as_ptr().wrapping_add(at), array.as_ptr().wrapping_add(at + 1));
        // SAFETY: a prefetch reads and writes nothing, and any address is allowed.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(first.cast());
            _mm_prefetch::<_MM_HINT_T0>(next.cast::<i8>().wrapping_sub(1));
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (array, at);
}

/// Partitions items by a digit of this many bits and returns where each part ends.
pub fn part<T>(things: &mut [T], bits: u32, digit: impl Fn(&T) -> usize) -> [usize; 1 << DIGIT] {
    let mut ends = [0; 1 << DIGIT];
    let mut next = ends;
    things.iter().for_each(|thing| ends[digit(thing)] += 1);
    let mut sum = 0;
    for (next, end) in next.iter_mut().zip(&mut ends).take(1 << bits) {
        *next = sum;
        sum += *end;
        *end = sum;
    }
    // Each swap moves one item to its part.
    let mut left = true;
    while left {
        left = false;
        for k in 0..1 << bits {
            for at in next[k]..ends[k] {
                let to = digit(&things[at]);
                let place = next[to];
                things.swap(at, place);
                next[to] = place + 1;
                if place & 7 == 0 {
                    prefetch_to_write(things, place + 8);
                }
            }
            left |= next[k] < ends[k];
        }
    }
    ends
}
