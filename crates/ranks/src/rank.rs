//! One scene over several ranks, each with a slab of it: processes of MPI, or threads.
//!
//! ```text
//! rows of the file ─> owners of slabs ─> own particles ─┬─> any detector ─> contacts ─> sums
//!                      (exchange)                       │
//!                                   halo from above  ───┘
//!                                     (exchange)
//! ```
//!
//! * **Every contact is found once.** A contact of particles of two ranks belongs to the lower one.
//!   So each rank sends its particles near a border downwards, and those below look among their own
//!   and what they were sent, for contacts with at least one of their own.
//! * **The halo** is what may touch something in the slab below, or in those below that, where
//!   bodies are larger than slabs: no size is refused. It is proved in [`crate::slabs`].
//! * **In a box that repeats** the first slab is the last one's neighbour, and ranks get particles
//!   as they were given, with the box: each makes the images that it needs, as in one process, and
//!   a contact is decided for the given numbers.
//! * **Exact arithmetic only.** There a contact depends on its two particles alone. What rounded
//!   filters lose, and what images are made, depends on where cells and boxes begin, and would
//!   depend on the number of ranks.
//!
//! Numbers of contacts and digests of the ranks add up to those of one process ([`Rank::digest`]).

use contactbench_core::contact::Arithmetic;
use contactbench_core::periodic::{Contacts, ImagePair, Periodic, PeriodicError};
use contactbench_core::refusal::Refusal;
use contactbench_core::scene::{AnyScene, Lattice, Radii, Scene, SceneError};
use contactbench_core::searcher::{Loaded, Searcher};
use contactbench_core::sink::Digest;

use crate::bodies::Numbered;
use crate::slabs::Slabs;
use crate::world::World;

/// Why ranks do not answer. All of them end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// This rank will not.
    #[error(transparent)]
    Here(#[from] Refusal),
    /// Another one will not, and says why.
    #[error("rank {0} has refused; it says why")]
    Elsewhere(usize),
    /// More particles than can be numbered.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The box does not suit the scene.
    #[error(transparent)]
    Boxed(#[from] PeriodicError),
    /// What they bring does not belong together.
    #[error(
        "the ranks do not work on one scene: {0} differs from rank to rank; give all of them the \
         same file and the same options"
    )]
    Unlike(&'static str),
}

/// The highest rank that has failed, if any has: all ranks say whether they have.
pub fn failed(world: &impl World, here: bool) -> Option<usize> {
    let mut highest = [if here { world.rank() as f64 } else { -1.0 }];
    world.largest(&mut highest);
    (highest[0] >= 0.0).then_some(highest[0] as usize)
}

/// The result of each rank, if none has failed: what is refused in one is not waited for by others.
///
/// # Errors
/// That of this rank, or the number of the highest that has failed.
pub fn together<T, E: From<Failure>>(world: &impl World, result: Result<T, E>) -> Result<T, E> {
    let failed = failed(world, result.is_err());
    let result = result?;
    failed.map_or(Ok(result), |rank| Err(Failure::Elsewhere(rank).into()))
}

/// Are these numbers, none of which is NaN, the same in all ranks?
pub fn alike<const N: usize>(world: &impl World, numbers: [f64; N]) -> bool {
    let mut ends = numbers.map(|number| [number, -number]);
    world.largest(ends.as_flattened_mut());
    ends.iter().all(|[most, least]| *most == -least)
}

/// What a rank has sent to be able to begin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Particles, each as often as it was sent.
    pub particles: u64,
    /// Bytes of them: 4 for the number, 8 for each coordinate, 8 for the radius where they differ.
    pub bytes: u64,
    /// Ranks that were sent any.
    pub partners: u64,
}

/// One of the ranks at work: its slab of the scene, and what it knows of those above.
pub struct Rank<const D: usize> {
    slabs: Slabs<D>,
    lattice: Option<Lattice>,
    /// The radius of all, if there is one.
    radius: Option<f64>,
    /// Own particles first.
    bodies: Numbered<D>,
    own: usize,
}

impl<const D: usize> Rank<D>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    /// Brings the particles that each rank has made or read, of a scene that repeats in a box or
    /// not, to their owners. Numbers must be given once each.
    ///
    /// # Errors
    /// A box that does not suit them; dimensions or boxes that differ from rank to rank;
    /// [`Refusal::Skewed`], [`Refusal::Exhausted`], in any rank.
    pub fn new(
        world: &impl World,
        bodies: Numbered<D>,
        lattice: Option<Lattice>,
    ) -> Result<Rank<D>, Failure> {
        let boxed = |lattice| -> Result<Lattice, Failure> {
            let empty = Scene::<f64, D>::new(Vec::new(), Radii::Uniform(0.0))?;
            Ok(Periodic::new(empty.into(), lattice)?.into_parts().1)
        };
        // As many numbers whatever the dimension.
        let told = |lattice: Lattice| {
            let axes = [lattice.periodic().map(f64::from), lattice.origin()];
            [lattice.vectors().as_flattened(), axes.as_flattened()].concat()
        };
        let told = lattice.map_or_else(|| vec![-1.0; 15], told);
        if !alike(world, [D as f64]) {
            return Err(Failure::Unlike("its dimension"));
        }
        if !alike(world, std::array::from_fn::<_, 15, _>(|k| told[k])) {
            return Err(Failure::Unlike("its box"));
        }
        let lattice = lattice.map(boxed).transpose()?.filter(Lattice::repeats);
        let mut ends = bodies
            .radii()
            .iter()
            .fold([f64::NEG_INFINITY; 2], |[most, least], &r| [most.max(r), least.max(-r)]);
        world.largest(&mut ends);
        // Without any particle: minus infinity, and so no radius of all.
        let radius = (ends[0] == -ends[1]).then_some(ends[0]);
        let sizes = radius.is_none();
        let mut slabs = Slabs::new(world, &bodies, ends[0].max(0.0), lattice.as_ref())?;
        let owner = |k: usize, to: &mut dyn FnMut(usize)| {
            to(slabs.owner(bodies.at(k)));
        };
        let mut letters = together(world, bodies.letters(world.size(), sizes, owner))?;
        drop(bodies);
        world.exchange(&mut letters)?;
        let mut own = Numbered::default();
        let read = own.read(&letters, sizes);
        together(world, read)?;
        let largest = match radius {
            Some(radius) if !own.is_empty() => radius,
            _ => own.radii().iter().copied().fold(f64::NEG_INFINITY, f64::max),
        };
        slabs.settle(world, largest);
        Ok(Rank { slabs, lattice, radius, own: own.len(), bodies: own })
    }

    /// Gets the particles of other ranks that may touch own ones, in the place of those that it
    /// has. Says what this rank has sent.
    ///
    /// # Errors
    /// [`Refusal::Exhausted`], in any rank.
    pub fn refresh(&mut self, world: &impl World) -> Result<Traffic, Failure> {
        self.bodies.truncate(self.own);
        let (bodies, slabs, radius) = (&self.bodies, &self.slabs, self.radius);
        // Asked once: MPI takes longer to say it than a particle takes.
        let rank = world.rank();
        let reached = |k: usize, to: &mut dyn FnMut(usize)| {
            let r = radius.unwrap_or_else(|| bodies.radii()[k]);
            slabs.reached(rank, bodies.at(k), r, to);
        };
        let sizes = radius.is_none();
        let mut letters = together(world, bodies.letters(world.size(), sizes, reached))?;
        let bytes: usize = letters.iter().map(Vec::len).sum();
        let traffic = Traffic {
            particles: (bytes / Numbered::<D>::bytes(sizes)) as u64,
            bytes: bytes as u64,
            partners: letters.iter().filter(|letter| !letter.is_empty()).count() as u64,
        };
        world.exchange(&mut letters)?;
        let read = self.bodies.read(&letters, sizes);
        together(world, read)?;
        Ok(traffic)
    }

    pub fn own(&self) -> usize {
        self.own
    }

    pub fn halo(&self) -> usize {
        self.bodies.len() - self.own
    }

    pub fn slabs(&self) -> &Slabs<D> {
        &self.slabs
    }

    /// The number in the whole scene of particle `k` of this rank.
    pub fn id(&self, k: u32) -> u32 {
        self.bodies.ids()[k as usize]
    }

    /// The contacts that belong to this rank, exactly, in the place of what is in the lists; in the
    /// rank's own numbers, own particles first ([`Rank::id`]).
    ///
    /// # Errors
    /// The refusals of the detector.
    pub fn search(&self, searcher: &mut Searcher, contacts: &mut Contacts) -> Result<(), Failure> {
        let loaded = self.loaded();
        searcher.list(&loaded, Arithmetic::Exact, contacts).map_err(|refusal| match refusal {
            // In the numbers of the whole scene, as it is told to users.
            Refusal::Away { particle, vector, boxes } => {
                Refusal::Away { particle: self.id(particle), vector, boxes }
            }
            other => other,
        })?;
        // At most 2^32 - 1, as the scene.
        let own = self.own as u32;
        contacts.plain.retain(|&[i, j]| i.min(j) < own);
        contacts.shifted.retain(|&ImagePair { i, .. }| i < own);
        Ok(())
    }

    /// The bytes of particles and of the searcher's last detection here, by their formulas, without
    /// the lists of contacts.
    pub fn formula_bytes(&self, searcher: &Searcher) -> u64 {
        let each = size_of::<u32>() + size_of::<f64>() * (D + usize::from(self.radius.is_none()));
        (self.bodies.len() * each) as u64 + searcher.formula_bytes()
    }

    /// Number and digest of contacts of this rank, in the numbers of the whole scene. Both add up.
    pub fn digest(&self, contacts: &Contacts) -> Digest {
        let mut digest = Digest::default();
        for &[i, j] in &contacts.plain {
            digest.image(self.id(i), self.id(j), [0; 3]);
        }
        for pair in &contacts.shifted {
            digest.image(self.id(pair.i), self.id(pair.j), pair.image);
        }
        digest
    }

    fn loaded(&self) -> Loaded<'_> {
        let scene = self.bodies.scene(self.radius);
        match self.lattice {
            None => Loaded::Open(scene.into()),
            // It suited an empty scene of this dimension, stored in f64 as this one.
            Some(lattice) => Loaded::InBox(Periodic::new(scene.into(), lattice).unwrap()),
        }
    }
}
