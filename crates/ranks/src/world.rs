//! Communication between ranks, and ranks that are threads.

use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

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

/// A rank that is a thread of this process, for tests and trials.
pub struct Thread {
    rank: usize,
    shared: Arc<Shared>,
}

struct Shared {
    size: usize,
    table: Mutex<Board>,
    turned: Condvar,
}

/// Data shared by all threads. Each list has an entry per rank.
struct Board {
    arrived: usize,
    round: u64,
    /// The first rank that returned; others must not wait for it.
    left: Option<usize>,
    /// The first rank that panicked.
    lost: Option<usize>,
    numbers: Vec<Vec<u64>>,
    mail: Vec<Vec<Vec<u8>>>,
}

/// Calls `work` in this many threads, one per rank, and returns the results in the order of ranks.
///
/// # Errors
/// Fails if the system cannot start that many threads.
///
/// # Panics
/// Panics if the work of a rank does, with the panic of the first such rank. Ranks that wait for a
/// rank that has panicked or returned panic, too.
pub fn threads<R: Send>(size: usize, work: impl Fn(&Thread) -> R + Sync) -> io::Result<Vec<R>> {
    let table = Board {
        arrived: 0,
        round: 0,
        left: None,
        lost: None,
        numbers: vec![Vec::new(); size],
        mail: vec![Vec::new(); size],
    };
    let shared = Arc::new(Shared { size, table: Mutex::new(table), turned: Condvar::new() });
    thread::scope(|scope| {
        let start = |rank| {
            let (world, work) = (Thread { rank, shared: Arc::clone(&shared) }, &work);
            thread::Builder::new().spawn_scoped(scope, move || work(&world))
        };
        // A rank that cannot be started has ended, so the others do not wait for it.
        let started: Vec<io::Result<_>> = (0..size).map(start).collect();
        let mut ended: Vec<io::Result<_>> =
            started.into_iter().map(|thread| Ok(thread?.join())).collect();
        if let Some(lost) = shared.table().lost.filter(|_| ended.iter().all(Result::is_ok))
            && let Ok(Err(cause)) = ended.swap_remove(lost)
        {
            std::panic::resume_unwind(cause);
        }
        // Here no rank has panicked, unless another could not be started.
        ended.into_iter().filter_map(|end| end.map(Result::ok).transpose()).collect()
    })
}

impl Shared {
    fn table(&self) -> MutexGuard<'_, Board> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Thread {
    fn wait(&self) {
        let mut table = self.shared.table();
        let round = table.round;
        table.arrived += 1;
        if table.arrived == self.shared.size {
            (table.arrived, table.round) = (0, round + 1);
            self.shared.turned.notify_all();
        }
        while table.round == round {
            if let Some(rank) = table.left {
                drop(table);
                panic!("rank {rank} has ended, and rank {} waits for it", self.rank);
            }
            let turned = self.shared.turned.wait(table);
            table = turned.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Calls `put`, waits until all ranks have done so, and calls `take`.
    fn meet<R>(
        &self,
        put: impl FnOnce(&mut Board, usize),
        take: impl FnOnce(&mut Board, usize) -> R,
    ) -> R {
        put(&mut self.shared.table(), self.rank);
        self.wait();
        let taken = take(&mut self.shared.table(), self.rank);
        self.wait();
        taken
    }

    /// Calls `take` with the numbers of all ranks, each with its index in the list.
    fn all(&self, mine: Vec<u64>, mut take: impl FnMut(usize, u64)) {
        self.meet(
            |table, rank| table.numbers[rank] = mine,
            |table, _| {
                let all = table.numbers.iter().flat_map(|of| of.iter().enumerate());
                all.for_each(|(k, &number)| take(k, number));
            },
        );
    }
}

impl Drop for Thread {
    fn drop(&mut self) {
        let mut table = self.shared.table();
        table.left.get_or_insert(self.rank);
        if thread::panicking() {
            table.lost.get_or_insert(self.rank);
        }
        self.shared.turned.notify_all();
    }
}

impl World for Thread {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.shared.size
    }

    fn sum(&self, numbers: &mut [u64]) {
        let mine = numbers.to_vec();
        numbers.fill(0);
        self.all(mine, |k, number| numbers[k] = numbers[k].wrapping_add(number));
    }

    fn largest(&self, numbers: &mut [f64]) {
        let mine = numbers.iter().map(|x| x.to_bits()).collect();
        self.all(mine, |k, bits| numbers[k] = numbers[k].max(f64::from_bits(bits)));
    }

    fn exchange(&self, parts: &mut [Vec<u8>]) -> Result<(), Failure> {
        let mine = parts.iter_mut().map(std::mem::take).collect();
        self.meet(
            |table, rank| table.mail[rank] = mine,
            |table, rank| {
                for (part, of) in parts.iter_mut().zip(&mut table.mail) {
                    *part = std::mem::take(&mut of[rank]);
                }
            },
        );
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
        let words = panics.unwrap_err().downcast::<String>().unwrap();
        assert!(words.starts_with("rank 1 has ended"), "{words}");
    }
}
