//! Measures the current speed of the machine with a fixed loop that is bound by caches and memory.
//! The loop is timed before and after each sample, on the sample's processor.
//!
//! The speed of a machine changes for seconds at a time, because of a lower clock, another program
//! that uses the same memory, or a busy host. If the loop takes long, the sample probably did too;
//! see [`States`](contactbench_record::cells::state::States).

use std::hint::black_box;
use std::sync::LazyLock;
use std::time::Instant;

use crate::run::machine::processors;
use contactbench_terms::mix::splitmix64;

/// Memory that the loop reads, in bytes: more than the caches of one core on most machines. In a
/// debug build, whose times are not used, less memory keeps the loop shorter than the sample.
const BYTES: usize = if cfg!(debug_assertions) { 64 << 10 } else { 8 << 20 };
const WORDS: usize = BYTES / size_of::<u32>();
/// Number of dependent reads. They take about as long as reading all of the memory in order.
const HOPS: usize = 8192;

static PLACES: LazyLock<Vec<u32>> =
    LazyLock::new(|| (0..WORDS as u64).map(|k| (splitmix64(k) % WORDS as u64) as u32).collect());

/// Returns the time of the loop in nanoseconds, on `processor` if given; `None` if a thread cannot
/// be started.
pub fn pulse(processor: Option<usize>) -> Option<u64> {
    let places = &**PLACES;
    let beat = move || {
        processors::keep(None, processor);
        let sum = || black_box(places).iter().fold(0u32, |sum, &place| sum.wrapping_add(place));
        // This first sum is untimed; after it, the caches do not depend on the last sample.
        black_box(sum());
        let start = Instant::now();
        let all = sum();
        let mut at = black_box(all) as usize % WORDS;
        for hop in 0..HOPS {
            at = (places[at] as usize ^ hop) % WORDS;
        }
        black_box(at);
        start.elapsed().as_nanos() as u64
    };
    std::thread::scope(|scope| {
        std::thread::Builder::new().spawn_scoped(scope, beat).ok()?.join().ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No machine reads 8 MiB in ten microseconds, so a longer time shows that the loop was run.
    #[test]
    fn the_loop_is_done() {
        let fastest = (0..5).filter_map(|_| pulse(processors::in_block(1))).min().unwrap();
        assert!(fastest > 10_000, "{fastest} ns");
    }
}
