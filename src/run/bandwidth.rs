//! How fast this machine reads and writes memory: the bound that no detection can be faster than.
//!
//! Three loops over arrays of doubles, as in the STREAM benchmark (J. D. McCalpin): *read* adds up
//! one array, *write* fills one, *triad* sets a to b + s c. Bytes are those that the program asks
//! for: 8 per element read or written, so 24 for a triad; that a cache may read a line before it is
//! written over is not counted. The best of several rounds stands, because whatever disturbs makes
//! it slower.
//!
//! The arrays together should not fit the last cache, but must not fill the memory either: see
//! `elements`. With several threads each has arrays of its own, all begin a loop together, and the
//! slowest ends it.

use std::collections::BTreeSet;
use std::hint::black_box;
use std::sync::Barrier;
use std::time::Instant;

use crate::experiment::Experiment;
use crate::record::hardware::Hardware;
use crate::record::provenance::Bandwidth;

/// Rounds, of which the best counts.
const ROUNDS: usize = 7;
/// Each of the three arrays has at least so many bytes, over all threads,
const LEAST_BYTES: u64 = 64 << 20;
/// and at most so many.
const MOST_BYTES: u64 = 256 << 20;

/// Elements of each array of one thread: over all threads as large as the last cache, from 64 to
/// 256 MiB. The three of them are then more than it holds, up to a cache of 768 MiB; the report
/// says so where they are less than twice as much.
fn elements(last_cache: u64, threads: usize) -> usize {
    (last_cache.clamp(LEAST_BYTES, MOST_BYTES) / 8) as usize / threads.max(1)
}

/// With every number of threads for which an experiment asks for a bound.
pub fn asked(experiments: &[Experiment]) -> Vec<Bandwidth> {
    let asked = experiments
        .iter()
        .filter(|experiment| experiment.bound)
        .flat_map(|experiment| experiment.threads.to_vec());
    let asked: BTreeSet<usize> = asked.collect();
    if asked.is_empty() {
        return Vec::new();
    }
    eprintln!("measuring the memory bandwidth");
    let last_cache = Hardware::here().last_cache();
    asked.into_iter().filter_map(|threads| measure(threads, last_cache)).collect()
}

/// Measures with so many threads on a machine whose last cache has `last_cache` bytes (0: unknown).
/// `None` where there is no memory for the arrays.
pub fn measure(threads: usize, last_cache: u64) -> Option<Bandwidth> {
    measured(threads, elements(last_cache, threads))
}

fn measured(threads: usize, n: usize) -> Option<Bandwidth> {
    let gate = Barrier::new(threads);
    let rounds: Vec<Option<Vec<[f64; 3]>>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(|| work(n, &gate))).collect();
        workers.into_iter().map(|worker| worker.join().ok().flatten()).collect()
    });
    let rounds = rounds.into_iter().collect::<Option<Vec<_>>>()?;
    // The slowest thread of a round, the best round.
    let seconds = |k: usize| {
        let slowest =
            |round: usize| rounds.iter().map(|thread| thread[round][k]).fold(0.0, f64::max);
        (0..ROUNDS).map(slowest).fold(f64::INFINITY, f64::min)
    };
    let bytes = (8 * n * threads) as f64;
    let rate =
        |factor: f64, k: usize| Some(factor * bytes / seconds(k)).filter(|rate| rate.is_finite());
    Some(Bandwidth {
        threads,
        array_bytes: (8 * n * threads) as u64,
        read: rate(1.0, 0)?,
        write: rate(1.0, 1)?,
        triad: rate(3.0, 2)?,
    })
}

/// The seconds of each loop in each round, for one thread. All threads come to the gate equally
/// often, with memory or without.
fn work(n: usize, gate: &Barrier) -> Option<Vec<[f64; 3]>> {
    let array = |value: f64| {
        let mut array = Vec::new();
        array.try_reserve_exact(n).ok()?;
        array.resize(n, value);
        Some(array)
    };
    let mut arrays = (|| Some((array(0.0)?, array(1.0)?, array(2.0)?)))();
    let mut rounds = Vec::new();
    for round in 0..ROUNDS {
        let mut seconds = [0.0; 3];
        for (k, seconds) in seconds.iter_mut().enumerate() {
            gate.wait();
            let Some((a, b, c)) = arrays.as_mut() else { continue };
            let start = Instant::now();
            match k {
                0 => {
                    black_box(sum(black_box(b)));
                }
                1 => black_box(&mut *a).fill(round as f64),
                _ => triad(black_box(a), black_box(b), black_box(c), 3.0),
            }
            black_box(&mut *a);
            *seconds = start.elapsed().as_secs_f64();
        }
        rounds.push(seconds);
    }
    arrays.map(|_| rounds)
}

/// In sixteen partial sums: one alone waits for each addition to end before the next.
fn sum(values: &[f64]) -> f64 {
    let mut sums = [0.0; 16];
    let (chunks, rest) = values.as_chunks::<16>();
    for chunk in chunks {
        for (sum, value) in sums.iter_mut().zip(chunk) {
            *sum += value;
        }
    }
    sums.iter().chain(rest).sum()
}

fn triad(a: &mut [f64], b: &[f64], c: &[f64], s: f64) {
    for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
        *a = b + s * c;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loops_do_what_they_say() {
        assert_eq!(sum(&(0..1003).map(f64::from).collect::<Vec<_>>()), 1003.0 * 1002.0 / 2.0);
        let mut a = [0.0; 3];
        triad(&mut a, &[1.0, 2.0, 3.0], &[10.0, 20.0, 30.0], 3.0);
        assert_eq!(a, [31.0, 62.0, 93.0]);
    }

    #[test]
    fn a_measurement_is_plausible_and_bounded() {
        assert_eq!(
            (elements(0, 1), elements(96 << 20, 2), elements(1 << 40, 1)),
            (8 << 20, 6 << 20, 32 << 20)
        );
        for threads in [1, 3] {
            let found = measured(threads, 1 << 16).unwrap();
            assert_eq!((found.threads, found.array_bytes), (threads, (threads as u64) << 19));
            // between a tape drive and a light beam
            for rate in [found.read, found.write, found.triad] {
                assert!((1e6..1e14).contains(&rate), "{found:?}");
            }
        }
    }
}
