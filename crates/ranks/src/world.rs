//! Communication between ranks, and ranks that are threads.

use std::any::Any;
use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::{io, thread};

use crate::rank::Failure;

/// The ranks of one scene, as seen by one of them. All must call the same functions in the
/// same order, as in MPI.
pub trait World {
    /// This rank's number, from 0.
    fn rank(&self) -> usize;
    /// Number of ranks, at least 1.
    fn size(&self) -> usize;
    /// Replaces each number by its sum over all ranks, modulo 2^64.
    fn sum(&self, numbers: &mut [u64]);
    /// Replaces each number by its maximum over all ranks; none may be NaN.
    fn largest(&self, numbers: &mut [f64]);
    /// Sends part k to rank k, and replaces part k by the one received from rank k.
    ///
    /// # Errors
    /// [`Refusal::Exhausted`](contactbench_ground::limits::refusal::Refusal) if any rank lacks
    /// memory for the parts.
    fn exchange(&self, parts: &mut [Vec<u8>]) -> Result<(), Failure>;
}

/// A rank that is a thread of this process, for tests and trials. Each pair of ranks has a channel
/// for either direction.
pub struct Thread {
    rank: usize,
    to: Vec<Sender<Vec<u8>>>,
    from: Vec<Receiver<Vec<u8>>>,
}

const ENDED: &str = "another rank has ended, and this one waits for it";

/// Calls `work` in this many threads, one per rank, and returns the results in the order of ranks.
///
/// # Errors
/// Fails if the system cannot start that many threads.
///
/// # Panics
/// Panics if the work of a rank does. Ranks that wait for a rank that has panicked or returned
/// panic, too; the panic of another rank goes before theirs.
pub fn threads<R: Send>(size: usize, work: impl Fn(&Thread) -> R + Sync) -> io::Result<Vec<R>> {
    let rank = |rank| Thread { rank, to: Vec::new(), from: Vec::new() };
    let mut ranks: Vec<Thread> = (0..size).map(rank).collect();
    for (a, b) in (0..size).flat_map(|a| (0..size).map(move |b| (a, b))) {
        let (sender, receiver) = channel();
        ranks[a].to.push(sender);
        ranks[b].from.push(receiver);
    }
    let work = &work;
    thread::scope(|scope| {
        let start = |rank| thread::Builder::new().spawn_scoped(scope, move || work(&rank));
        // A rank that cannot be started has ended, so the others do not wait for it.
        let started: Vec<io::Result<_>> = ranks.into_iter().map(start).collect();
        let ended: Vec<io::Result<_>> =
            started.into_iter().map(|thread| Ok(thread?.join())).collect();
        let ended = ended.into_iter().collect::<io::Result<Vec<_>>>()?;
        let waited = |cause: &Box<dyn Any + Send>| cause.downcast_ref() == Some(&ENDED);
        let (mut done, mut lost) = (Vec::new(), None);
        for end in ended {
            match end {
                Ok(result) => done.push(result),
                Err(cause) if lost.as_ref().is_none_or(waited) => lost = Some(cause),
                Err(_) => {}
            }
        }
        lost.map_or(Ok(done), |cause| resume_unwind(cause))
    })
}

impl Thread {
    fn swap(&self, parts: &mut [Vec<u8>]) {
        for (part, to) in parts.iter_mut().zip(&self.to) {
            // If the other rank has ended, receiving from it panics.
            let _ = to.send(std::mem::take(part));
        }
        for (part, from) in parts.iter_mut().zip(&self.from) {
            *part = from.recv().unwrap_or_else(|_| std::panic::panic_any(ENDED));
        }
    }

    /// Calls `take` with the numbers of all ranks, each with its index in the list.
    fn all(&self, mine: impl Iterator<Item = u64>, mut take: impl FnMut(usize, u64)) {
        let letter: Vec<u8> = mine.flat_map(u64::to_le_bytes).collect();
        let mut letters = vec![letter; self.size()];
        self.swap(&mut letters);
        for letter in &letters {
            let numbers = letter.as_chunks().0.iter().enumerate();
            numbers.for_each(|(k, bytes)| take(k, u64::from_le_bytes(*bytes)));
        }
    }
}

impl World for Thread {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn sum(&self, numbers: &mut [u64]) {
        let mine = numbers.to_vec();
        numbers.fill(0);
        self.all(mine.into_iter(), |k, number| numbers[k] = numbers[k].wrapping_add(number));
    }

    fn largest(&self, numbers: &mut [f64]) {
        let mine: Vec<u64> = numbers.iter().map(|x| x.to_bits()).collect();
        self.all(mine.into_iter(), |k, bits| numbers[k] = numbers[k].max(f64::from_bits(bits)));
    }

    fn exchange(&self, parts: &mut [Vec<u8>]) -> Result<(), Failure> {
        self.swap(parts);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_ranks_get_equal_sums_and_their_own_parts() {
        for size in [1, 2, 5] {
            let seen = threads(size, |world| {
                let me = world.rank();
                let mut numbers = [me as u64, u64::MAX];
                let mut reals = [me as f64, -(me as f64)];
                let mut parts: Vec<Vec<u8>> =
                    (0..size).map(|to| vec![10 * me as u8 + to as u8; me]).collect();
                for _ in 0..3 {
                    (numbers, reals) = ([me as u64, u64::MAX], [me as f64, -(me as f64)]);
                    world.sum(&mut numbers);
                    world.largest(&mut reals);
                }
                world.exchange(&mut parts).unwrap();
                (numbers, reals, parts)
            })
            .unwrap();
            for (me, (numbers, reals, parts)) in seen.into_iter().enumerate() {
                let sum = (size * (size - 1) / 2) as u64;
                assert_eq!(numbers, [sum, 0u64.wrapping_sub(size as u64)]);
                assert_eq!(reals, [(size - 1) as f64, 0.0]);
                for (from, part) in parts.iter().enumerate() {
                    assert_eq!(*part, vec![10 * from as u8 + me as u8; from]);
                }
            }
        }
    }

    #[test]
    fn a_panic_in_one_rank_ends_all() {
        let panics = std::panic::catch_unwind(|| {
            threads(3, |world| {
                assert!(world.rank() != 1, "on purpose");
                world.sum(&mut [1]);
            })
        });
        // The result is the first panic, not that of a rank that waits.
        assert_eq!(panics.unwrap_err().downcast_ref::<&str>(), Some(&"on purpose"));
    }

    #[test]
    fn a_rank_that_returns_early_is_not_waited_for() {
        let panics = std::panic::catch_unwind(|| {
            threads(3, |world| {
                world.sum(&mut [1]);
                if world.rank() != 1 {
                    world.sum(&mut [1]);
                }
            })
        });
        assert_eq!(panics.unwrap_err().downcast_ref(), Some(&ENDED));
    }
}
