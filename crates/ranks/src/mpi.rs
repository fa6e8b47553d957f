//! Ranks that are processes of MPI.

use contactbench_ground::limits::refusal::reserve;
use mpi::collective::SystemOperation;
use mpi::datatype::{Partition, PartitionMut};
use mpi::environment::Universe;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives};

use crate::rank::{Failure, together};
use crate::world::World;

/// Maximum number of bytes that a rank sends at once, because MPI counts them in 32 bits.
const MOST: usize = 1 << 30;

/// The ranks that `mpirun` started. Dropping this value ends MPI.
pub struct Processes {
    world: SimpleCommunicator,
    _universe: Universe,
}

impl Processes {
    /// Starts MPI; returns `None` if it was initialized before.
    pub fn begin() -> Option<Processes> {
        let universe = mpi::initialize()?;
        Some(Processes { world: universe.world(), _universe: universe })
    }
}

/// A rank that panics aborts all ranks, because the others would wait for it.
impl Drop for Processes {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.world.abort(101);
        }
    }
}

impl World for Processes {
    fn rank(&self) -> usize {
        // MPI's rank numbers are not negative.
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

    /// Sends the parts in rounds, so that the bytes of a round fit MPI's counters.
    fn exchange(&self, parts: &mut [Vec<u8>]) -> Result<(), Failure> {
        assert_eq!(parts.len(), self.size(), "one part for each rank");
        let sizes: Vec<u64> = parts.iter().map(|part| part.len() as u64).collect();
        let mut coming = vec![0u64; parts.len()];
        self.world.all_to_all_into(&sizes[..], &mut coming[..]);
        let Room { mut received, mut sent, mut letters } =
            together(self, Room::new(&sizes, &coming))?;
        let mut longest = [sizes.iter().copied().max().unwrap_or(0) as f64];
        self.largest(&mut longest);
        let most = (MOST / parts.len()) as u64;
        for round in 0..(longest[0] as u64).div_ceil(most) {
            // Returns the start and the end of the piece that this round sends.
            let ends = |size: u64| [(round * most).min(size), ((round + 1) * most).min(size)];
            // Computes lengths and offsets in bytes; each is at most MOST.
            let places = |sizes: &[u64]| -> (Vec<i32>, Vec<i32>) {
                let mut begin = 0;
                let place = |&size: &u64| {
                    let [from, to] = ends(size);
                    let len = (to - from) as i32;
                    begin += len;
                    (len, begin - len)
                };
                sizes.iter().map(place).unzip()
            };
            sent.clear();
            for part in parts.iter() {
                let [from, to] = ends(part.len() as u64);
                sent.extend_from_slice(&part[from as usize..to as usize]);
            }
            // An empty list has the dangling address 1, which some MPIs define as MPI_IN_PLACE.
            sent.push(0);
            let (lens, begins) = places(&sizes);
            let (got, got_at) = places(&coming);
            letters.clear();
            letters.resize(got.iter().map(|&len| len as usize).sum::<usize>() + 1, 0);
            self.world.all_to_all_varcount_into(
                &Partition::new(&sent[..], lens, begins),
                &mut PartitionMut::new(&mut letters[..], &got[..], &got_at[..]),
            );
            for (of, (&len, &at)) in received.iter_mut().zip(got.iter().zip(&got_at)) {
                of.extend_from_slice(&letters[at as usize..][..len as usize]);
            }
        }
        parts.iter_mut().zip(received).for_each(|(part, got)| *part = got);
        Ok(())
    }
}

struct Room {
    received: Vec<Vec<u8>>,
    /// Bytes sent in one round of an exchange.
    sent: Vec<u8>,
    letters: Vec<u8>,
}

impl Room {
    fn new(going: &[u64], coming: &[u64]) -> Result<Room, Failure> {
        let some = |bytes: u64| {
            let mut room = Vec::new();
            reserve(&mut room, bytes as usize).map(|()| room).map_err(Failure::from)
        };
        let round = |sizes: &[u64]| some(sizes.iter().sum::<u64>().min(MOST as u64) + 1);
        Ok(Room {
            received: coming.iter().map(|&size| some(size)).collect::<Result<_, _>>()?,
            sent: round(going)?,
            letters: round(coming)?,
        })
    }
}
