//! Large pages for large arrays.
//!
//! The system clears each page at its first use. 512 small pages take about five times as long as
//! one large page of 2 MiB. If no large page is free, the system first moves other memory to make
//! one, which takes longer than all of this saves. So large pages are requested only if enough of
//! them are free.

use std::alloc::{Layout, alloc, dealloc};
use std::mem::MaybeUninit;
use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;

use super::refusal::out_of_memory;

/// Size of a large page in bytes.
const LARGE: usize = 1 << 21;

/// An array whose elements have no values at first. From half a large page on, it fills whole ones.
pub struct Array<A> {
    begin: NonNull<MaybeUninit<A>>,
    len: usize,
}

// SAFETY: the array belongs to this value alone, like the array of a `Vec`.
unsafe impl<A: Send> Send for Array<A> {}
// SAFETY: as above; a shared `Array` gives shared references only.
unsafe impl<A: Sync> Sync for Array<A> {}

impl<A> Drop for Array<A> {
    fn drop(&mut self) {
        if let Some(layout) = Array::<A>::layout(self.len).filter(|_| self.len > 0) {
            // SAFETY: `at_least` allocated the memory with this layout.
            unsafe { dealloc(self.begin.as_ptr().cast(), layout) }
        }
    }
}

impl<A> Array<A> {
    pub const EMPTY: Array<A> = Array { begin: NonNull::dangling(), len: 0 };

    /// Returns the memory of an array for `len` elements.
    fn layout(len: usize) -> Option<Layout> {
        let layout = Layout::array::<A>(len).ok()?;
        if layout.size() < LARGE / 2 {
            return Some(layout);
        }
        layout.align_to(LARGE).ok().map(|layout| layout.pad_to_align())
    }

    /// Returns the size in bytes of an array for `len` elements.
    pub fn bytes(len: usize) -> u64 {
        Array::<A>::layout(len).map_or(u64::MAX, |layout| layout.size() as u64)
    }

    /// Makes the array at least `len` long; if it grows, its elements lose their values. Panics as
    /// [`super::refusal::must_reserve`] if memory runs out.
    pub fn at_least(&mut self, len: usize) {
        if len <= self.len {
            return;
        }
        // The old and the new array do not coexist.
        *self = Array::EMPTY;
        let layout = Array::<A>::layout(len).filter(|layout| layout.size() > 0);
        // SAFETY: the size of the layout is not 0.
        let begin = layout.and_then(|layout| NonNull::new(unsafe { alloc(layout) }));
        let Some(begin) = begin else { out_of_memory(Array::<A>::bytes(len)) };
        let bytes = Array::<A>::bytes(len) as usize;
        request(begin.as_ptr(), bytes, bytes);
        *self = Array { begin: begin.cast(), len };
    }
}

impl<A> Deref for Array<A> {
    type Target = [MaybeUninit<A>];

    fn deref(&self) -> &[MaybeUninit<A>] {
        // SAFETY: the memory has room for `len` elements, which need no values.
        unsafe { std::slice::from_raw_parts(self.begin.as_ptr(), self.len) }
    }
}

impl<A> DerefMut for Array<A> {
    fn deref_mut(&mut self) -> &mut [MaybeUninit<A>] {
        // SAFETY: as in `deref`; the exclusive reference passes to the slice.
        unsafe { std::slice::from_raw_parts_mut(self.begin.as_ptr(), self.len) }
    }
}

/// Returns whether an array of this many bytes requests large pages.
pub fn is_large(bytes: usize) -> bool {
    bytes >= LARGE
}

/// Requests large pages for an array of this many bytes, `more` of them new, if it is large.
#[cfg(target_os = "linux")]
pub fn request(begin: *const u8, bytes: usize, more: usize) {
    use std::ffi::{c_int, c_long, c_void};
    unsafe extern "C" {
        fn madvise(begin: *mut c_void, bytes: usize, advice: c_int) -> c_int;
        fn sysconf(name: c_int) -> c_long;
    }
    const PAGE_SIZE: c_int = 30;
    const HUGE_PAGE: c_int = 14;
    if bytes < LARGE || more == 0 {
        return;
    }
    // SAFETY: the call only returns a number.
    let page = unsafe { sysconf(PAGE_SIZE) } as usize;
    let text = std::fs::read_to_string("/proc/buddyinfo").unwrap_or_default();
    if free_bytes(&text, page) < 2 * more as u64 {
        return;
    }
    // The advice covers whole pages, because advice for a part splits a mapping, and the system
    // moves no split mapping: an array that grows would be copied into small pages.
    let before = begin.addr() % page;
    let bytes = (before + bytes).next_multiple_of(page);
    // SAFETY: the range is the pages of the allocation, whose ends other memory of the heap may
    // share, and the advice changes no content.
    unsafe { madvise(begin.cast_mut().wrapping_sub(before).cast(), bytes, HUGE_PAGE) };
}

/// Does nothing: other systems choose their pages themselves.
#[cfg(not(target_os = "linux"))]
pub fn request(_: *const u8, _: usize, _: usize) {}

/// Returns the bytes in free blocks of at least [`LARGE`] bytes. A line of `text` names a zone and
/// then the numbers of free blocks of 1, 2, 4 and more pages: `Node 0, zone Normal 5 3 0 1`.
#[cfg(target_os = "linux")]
fn free_bytes(text: &str, page: usize) -> u64 {
    let blocks = text.lines().flat_map(|line| {
        line.split_whitespace().skip(4).enumerate().filter_map(|(k, count)| {
            let block = (page as u64).checked_shl(k as u32).filter(|&b| b >= LARGE as u64)?;
            count.parse::<u64>().ok()?.checked_mul(block)
        })
    });
    blocks.fold(0, u64::saturating_add)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn only_free_blocks_of_two_mebibytes_count() {
        let text = "Node 0, zone      DMA      7      0      0      0      0      0      0      0 \
                         1      1      3 \nNode 0, zone   Normal     46     49     42     40 \
                        29     22     23     55    107      5      0 \nNode 1, zone\n";
        assert_eq!(free_bytes(text, 4096), (1 + 3 * 2 + 5) << 21);
        // 32 pages of 64 KiB have this size, too: the sixth number of a zone is the first to count.
        assert_eq!(free_bytes(text, 65536), 1344 << 21);
        assert_eq!(free_bytes("", 4096), 0);
    }

    #[test]
    fn arrays_keep_what_is_written_and_large_ones_are_aligned() {
        let mut array = Array::<[u32; 4]>::EMPTY;
        for len in [0, 1, 100, 70_000, 300_000, 5] {
            array.at_least(len);
            assert!(array.len() >= len);
            for (k, element) in array.iter_mut().enumerate() {
                element.write([k as u32; 4]);
            }
            // SAFETY: all elements were written.
            let all = unsafe { array.assume_init_ref() };
            assert!(all.iter().enumerate().all(|(k, element)| *element == [k as u32; 4]));
        }
        assert_eq!((array.len(), array.as_ptr().addr() % LARGE), (300_000, 0));
        let bytes = [0, 10, (1 << 16) - 1, 1 << 16, (1 << 17) + 1].map(Array::<[u32; 4]>::bytes);
        assert_eq!(bytes, [0, 160, (1 << 20) - 16, 1 << 21, 1 << 22]);
    }
}
