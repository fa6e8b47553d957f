//! Room in lists that grow with the bytes of a file.

use anyhow::ensure;

use contactbench_core::memory;

/// Room for one more, a quarter at a time: a list doubled may be twice as large as needed, and this
/// is where the memory goes.
pub fn room<T>(list: &mut Vec<T>) -> anyhow::Result<()> {
    room_for(list, 1)
}

/// The same for some more.
pub(crate) fn room_for<T>(list: &mut Vec<T>, count: usize) -> anyhow::Result<()> {
    if list.capacity() - list.len() < count {
        let more = (list.len() / 4 + 1024).max(count);
        let bytes = ((list.len() + more) * size_of::<T>()) as u64;
        let fits = bytes <= memory::most_of_one() && list.try_reserve_exact(more).is_ok();
        ensure!(fits, "no memory for more than {} of them; split the file", list.len());
    }
    Ok(())
}

/// Refuses more particles than 32 bits can number.
pub(crate) fn numbered(n: u64, what: &str, place: &str) -> anyhow::Result<()> {
    let most = u32::MAX;
    ensure!(
        n <= u64::from(most),
        "{place}: {n} {what}; at most 2^32 - 1 = {most} can be numbered: split the file"
    );
    Ok(())
}
