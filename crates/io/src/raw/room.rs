//! Growth of lists in proportion to the bytes of a file.

use anyhow::ensure;

use contactbench_ground::limits::memory;

/// Makes room for one more value. The list grows by a quarter instead of doubling, because it takes
/// most of the memory.
pub fn room<T>(list: &mut Vec<T>) -> anyhow::Result<()> {
    room_for(list, 1)
}

pub(crate) fn room_for<T>(list: &mut Vec<T>, count: usize) -> anyhow::Result<()> {
    if list.capacity() - list.len() < count {
        let more = (list.len() / 4 + 1024).max(count);
        let bytes = ((list.len() + more) * size_of::<T>()) as u64;
        let fits = bytes <= memory::most_of_one() && list.try_reserve_exact(more).is_ok();
        ensure!(fits, "no memory for more than {} of them; split the file", list.len());
    }
    Ok(())
}

pub(crate) fn numbered(n: u64, what: &str) -> anyhow::Result<()> {
    let most = u32::MAX;
    ensure!(n <= most.into(), "{n} {what}, and at most 2^32 - 1 = {most} are read; split the file");
    Ok(())
}
