//! Receivers of contacts: a list, a count, a digest or a closure.
//!
//! A detector reports every pair that touches once, as two particle numbers in any order. The
//! digest depends neither on the order of pairs nor on the order within a pair. Two detectors agree
//! exactly if count and digest agree (up to a collision of 64-bit sums).

pub use crate::pairs::normalise::{normalise, normalise_by, smaller_first};
pub use contactbench_terms::mix::splitmix64;

use std::mem::MaybeUninit;

use crate::pairs::pair_list::append;

/// Receives the contacts that a detector finds.
pub trait Sink {
    /// Receives the contact of particles `i` and `j`.
    fn contact(&mut self, i: u32, j: u32);

    /// Receives several contacts at once.
    #[inline]
    fn contacts(&mut self, pairs: &[[u32; 2]]) {
        for &[i, j] in pairs {
            self.contact(i, j);
        }
    }

    /// Returns space for at least `many` more contacts in the sink's own list, or `None` if it has
    /// no list with that much free space. A sink that has one also implements [`Sink::written`].
    #[inline]
    fn space(&mut self, _many: usize) -> Option<&mut [MaybeUninit<[u32; 2]>]> {
        None
    }

    /// Receives the first `many` contacts in the space that [`Sink::space`] has returned.
    ///
    /// # Safety
    /// They must be in that space and have been written, and no other method called since.
    #[inline]
    unsafe fn written(&mut self, many: usize) {
        assert_eq!(many, 0, "a sink without space for contacts");
    }

    /// Receives the share of its work that a detector has done, from which a list estimates its
    /// length. A smaller share than before begins new work.
    fn progress(&mut self, _share: f64) {}

    /// Receives the lists of contacts that several threads found.
    fn gather(&mut self, lists: &[&[[u32; 2]]]) {
        for list in lists {
            self.contacts(list);
        }
    }
}

impl<S: Sink + ?Sized> Sink for &mut S {
    #[inline(always)]
    fn contact(&mut self, i: u32, j: u32) {
        (**self).contact(i, j);
    }
    #[inline(always)]
    fn contacts(&mut self, pairs: &[[u32; 2]]) {
        (**self).contacts(pairs);
    }
    fn space(&mut self, many: usize) -> Option<&mut [MaybeUninit<[u32; 2]>]> {
        (**self).space(many)
    }
    unsafe fn written(&mut self, many: usize) {
        // SAFETY: the caller ensures it.
        unsafe { (**self).written(many) }
    }
    fn progress(&mut self, share: f64) {
        (**self).progress(share);
    }
    fn gather(&mut self, lists: &[&[[u32; 2]]]) {
        (**self).gather(lists);
    }
}

/// Collects all pairs without a limit; see [`crate::pairs::pair_list`] for lists with a limit.
impl Sink for Vec<[u32; 2]> {
    #[inline(always)]
    fn contact(&mut self, i: u32, j: u32) {
        self.push([i, j]);
    }
    #[inline(always)]
    fn contacts(&mut self, pairs: &[[u32; 2]]) {
        self.extend_from_slice(pairs);
    }
    fn space(&mut self, many: usize) -> Option<&mut [MaybeUninit<[u32; 2]>]> {
        Some(self.spare_capacity_mut()).filter(|space| space.len() >= many)
    }
    unsafe fn written(&mut self, many: usize) {
        // SAFETY: the caller has written these elements, in the spare capacity.
        unsafe { self.set_len(self.len() + many) }
    }
    fn gather(&mut self, lists: &[&[[u32; 2]]]) {
        append(self, lists);
    }
}

/// Counts contacts and stores none, for memory measurements that must not include a list.
#[derive(Clone, Copy, Debug, Default)]
pub struct Count(pub u64);

impl Sink for Count {
    #[inline(always)]
    fn contact(&mut self, _: u32, _: u32) {
        self.0 += 1;
    }
}

/// Calls a closure with every contact.
pub struct Visit<F>(pub F);

impl<F: FnMut(u32, u32)> Sink for Visit<F> {
    #[inline(always)]
    fn contact(&mut self, i: u32, j: u32) {
        (self.0)(i, j);
    }
}

/// The number of contacts and a 64-bit fingerprint of the set of pairs that does not depend on
/// their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Digest {
    /// Number of pairs reported, including duplicates.
    pub contacts: u64,
    /// Wrapping sum of `splitmix64(i << 32 | j)` over the pairs with i < j.
    pub sum: u64,
}

impl Digest {
    /// Returns the digest of a list of pairs.
    pub fn from_pairs(pairs: &[[u32; 2]]) -> Digest {
        let mut digest = Digest::default();
        for &[i, j] in pairs {
            digest.contact(i, j);
        }
        digest
    }

    /// Adds the contact of particle `i` with the image of `j` shifted by these vectors of a
    /// periodic box. Each image that touches is a separate contact. The order of `i` and `j` does
    /// not matter: the contact of `j` with the image of `i` by the negated shift is the same
    /// contact. Without a shift the result equals that of an open scene.
    pub fn image(&mut self, i: u32, j: u32, image: [i32; 3]) {
        self.contacts += 1;
        let reverse = image.map(i32::wrapping_neg);
        let swap = if i == j { image < reverse } else { j < i };
        let [x, y, z] = if swap { reverse } else { image }.map(|count| u64::from(count as u32));
        let mut hash = splitmix64(key(i, j));
        if image != [0; 3] {
            hash = splitmix64(splitmix64(hash ^ (x << 32 | y)) ^ z);
        }
        self.sum = self.sum.wrapping_add(hash);
    }

    /// Formats the fingerprint as in records: `0x` and 16 hexadecimal digits.
    pub fn hex(&self) -> String {
        format!("{:#018x}", self.sum)
    }
}

impl Sink for Digest {
    #[inline(always)]
    fn contact(&mut self, i: u32, j: u32) {
        self.contacts += 1;
        self.sum = self.sum.wrapping_add(splitmix64(key(i, j)));
    }
}

/// Packs a pair into one number, the smaller index in the upper half.
#[inline(always)]
pub fn key(i: u32, j: u32) -> u64 {
    let (i, j) = if i < j { (i, j) } else { (j, i) };
    u64::from(i) << 32 | u64::from(j)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_is_free_of_order_and_sees_one_changed_pair() {
        let a = Digest::from_pairs(&[[0, 1], [7, 3], [2, 5]]);
        assert_eq!(a, Digest::from_pairs(&[[5, 2], [1, 0], [3, 7]]));
        assert_ne!(a, Digest::from_pairs(&[[0, 1], [7, 4], [2, 5]]));
        assert_ne!(a, Digest::from_pairs(&[[0, 1], [7, 3], [2, 5], [2, 5]]));
    }

    #[test]
    fn images_are_contacts_of_their_own() {
        let of = |pairs: &[(u32, u32, [i32; 3])]| {
            let mut digest = Digest::default();
            pairs.iter().for_each(|&(i, j, image)| digest.image(i, j, image));
            digest
        };
        assert_eq!(of(&[(3, 1, [0; 3])]), Digest::from_pairs(&[[1, 3]]));
        assert_eq!(of(&[(1, 3, [0, -2, 1])]), of(&[(3, 1, [0, 2, -1])]));
        assert_eq!(of(&[(5, 5, [0, -2, 1])]), of(&[(5, 5, [0, 2, -1])]));
        let mut sums: Vec<u64> = Vec::new();
        for x in -1..2 {
            for y in -1..2 {
                for z in -1..2 {
                    sums.extend(
                        [(0, 1), (0, 2), (1, 2)].map(|(i, j)| of(&[(i, j, [x, y, z])]).sum),
                    );
                }
            }
        }
        sums.sort_unstable();
        sums.dedup();
        assert_eq!(sums.len(), 81);
        let both = of(&[(0, 1, [1, 0, 0]), (0, 1, [-1, 0, 0])]);
        assert_eq!(both, of(&[(1, 0, [1, 0, 0]), (0, 1, [1, 0, 0])]));
        assert_ne!(both, of(&[(0, 1, [1, 0, 0]), (0, 1, [1, 0, 0])]));
    }
}
