//! Ranks that are processes of MPI.

use contactbench_core::ranks::World;
use mpi::collective::SystemOperation;
use mpi::datatype::{Partition, PartitionMut};
use mpi::environment::Universe;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives};

/// Most bytes that a rank sends at once: MPI counts them in 32 bits.
const MOST: usize = 1 << 30;

/// The ranks that `mpirun` has started. MPI ends when it is dropped.
pub struct Processes {
    world: SimpleCommunicator,
    _universe: Universe,
}

impl Processes {
    /// None if MPI was begun before.
    pub fn begin() -> Option<Processes> {
        let universe = mpi::initialize()?;
        Some(Processes { world: universe.world(), _universe: universe })
    }
}

/// A rank that panics ends all: the others would wait for it, and MPI for them.
impl Drop for Processes {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.world.abort(101);
        }
    }
}

impl World for Processes {
    fn rank(&self) -> usize {
        // Not negative.
        self.world.rank() as usize
    }

    fn size(&self) -> usize {
        self.world.size() as usize
    }

    fn sum(&self, numbers: &mut [u64]) {
        let mine = numbers.to_vec();
        self.world.all_reduce_into(&mine[..], numbers, SystemOperation::sum());
    }

    fn largest(&self, numbers: &mut [f64]) {
        let mine = numbers.to_vec();
        self.world.all_reduce_into(&mine[..], numbers, SystemOperation::max());
    }

    /// In rounds, in which each sends so many bytes to each at most that their sum can be counted.
    fn exchange(&self, parts: &mut [Vec<u8>]) {
        let most = MOST / parts.len();
        let longest = parts.iter().map(Vec::len).max().unwrap_or(0);
        let mut rounds = [longest.div_ceil(most) as f64];
        self.largest(&mut rounds);
        let mut received: Vec<Vec<u8>> = vec![Vec::new(); parts.len()];
        for round in 0..rounds[0] as usize {
            let pieces: Vec<&[u8]> = parts
                .iter()
                .map(|part| {
                    let end = |k: usize| (k * most).min(part.len());
                    &part[end(round)..end(round + 1)]
                })
                .collect();
            let counts = |lens: &mut dyn Iterator<Item = usize>| -> (Vec<i32>, Vec<i32>) {
                let mut begin = 0;
                lens.map(|len| {
                    let place = (len as i32, begin);
                    begin += len as i32;
                    place
                })
                .unzip()
            };
            let (sent, sent_at) = counts(&mut pieces.iter().map(|piece| piece.len()));
            let mut told = vec![0i32; parts.len()];
            self.world.all_to_all_into(&sent[..], &mut told[..]);
            let (got, got_at) = counts(&mut told.iter().map(|&len| len as usize));
            // An empty list would begin at address 1, which is MPI_IN_PLACE to some.
            let mut out =
                Vec::with_capacity(pieces.iter().map(|piece| piece.len()).sum::<usize>() + 1);
            pieces.iter().for_each(|piece| out.extend_from_slice(piece));
            out.push(0);
            let total: usize = got.iter().map(|&len| len as usize).sum();
            let mut letters = vec![0u8; total + 1];
            self.world.all_to_all_varcount_into(
                &Partition::new(&out[..], sent, sent_at),
                &mut PartitionMut::new(&mut letters[..], got.clone(), got_at.clone()),
            );
            for (of, (&len, &at)) in received.iter_mut().zip(got.iter().zip(&got_at)) {
                of.extend_from_slice(&letters[at as usize..][..len as usize]);
            }
        }
        parts.iter_mut().zip(received).for_each(|(part, got)| *part = got);
    }
}
