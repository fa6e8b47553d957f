//! One scene divided among several ranks, each with a slab: MPI processes or threads.
//!
//! ```text
//! rows of the file ─> owners of slabs ─> own particles ─┬─> any detector ─> contacts ─> sums
//!                      (exchange)                       │
//!                                   halo from above  ───┘
//!                                     (exchange)
//! ```
//!
//! * **Every contact is found once.** A contact of particles of two ranks belongs to the lower
//!   rank. Each rank sends its particles near a border downwards. The ranks below search their own
//!   and the received particles for contacts with at least one own particle.
//! * **The halo** contains every particle that may touch one in the slab below, or in several slabs
//!   below if particles are larger than slabs: no size is refused. [`crate::slabs`] has the proof.
//! * **In a periodic box** the first slab is adjacent to the last. Ranks get particles as they were
//!   given, with the box. Each rank makes the images that it needs, as one process would, and
//!   contacts are decided for the given numbers.
//! * **Exact arithmetic only.** There a contact depends on its two particles alone. What rounded
//!   filters lose, and which images are made, depends on where cells and boxes begin, and would
//!   depend on the number of ranks.
//!
//! Counts and digests of the ranks add up to those of one process ([`Rank::digest`]).

use contactbench_core::contact::Arithmetic;
use contactbench_core::periodic::{Contacts, ImagePair, Periodic, PeriodicError};
use contactbench_core::refusal::Refusal;
use contactbench_core::scene::{AnyScene, Lattice, Radii, Scene, SceneError};
use contactbench_core::searcher::{Loaded, Searcher};
use contactbench_core::sink::Digest;

use crate::bodies::Numbered;
use crate::slabs::Slabs;
use crate::world::World;

/// Why ranks fail. All of them then end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// This rank's detector refuses.
    #[error(transparent)]
    Here(#[from] Refusal),
    /// Another rank failed and reports the reason.
    #[error("rank {0} has refused; it says why")]
    Elsewhere(usize),
    /// There are more particles than can be numbered.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The box does not fit the scene.
    #[error(transparent)]
    Boxed(#[from] PeriodicError),
    /// The ranks were given different scenes or options.
    #[error(
        "the ranks do not work on one scene: {0} differs from rank to rank; give all of them the \
         same file and the same options"
    )]
    Unlike(&'static str),
}

/// Returns the highest rank that failed, if any; every rank takes part.
pub fn failed(world: &impl World, here: bool) -> Option<usize> {
    let mut highest = [if here { world.rank() as f64 } else { -1.0 }];
    world.largest(&mut highest);
    (highest[0] >= 0.0).then_some(highest[0] as usize)
}

/// Returns the result of each rank if none failed, so that no rank waits for one that refused.
///
/// # Errors
/// Returns the error of this rank, or the number of the highest failed rank.
pub fn together<T, E: From<Failure>>(world: &impl World, result: Result<T, E>) -> Result<T, E> {
    let failed = failed(world, result.is_err());
    let result = result?;
    failed.map_or(Ok(result), |rank| Err(Failure::Elsewhere(rank).into()))
}

/// Returns whether these numbers, without NaN, are equal in all ranks.
pub fn alike<const N: usize>(world: &impl World, numbers: [f64; N]) -> bool {
    let mut ends = numbers.map(|number| [number, -number]);
    world.largest(ends.as_flattened_mut());
    ends.iter().all(|[most, least]| *most == -least)
}

/// Data that a rank sent before its search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Particles, counted as often as sent.
    pub particles: u64,
    /// Bytes of these particles: 4 for the number, 8 per coordinate, 8 for an individual radius.
    pub bytes: u64,
    /// Number of ranks that received any.
    pub partners: u64,
}

/// A rank: its slab of the scene and its halo.
pub struct Rank<const D: usize> {
    slabs: Slabs<D>,
    lattice: Option<Lattice>,
    /// The radius of all particles, if they share one.
    radius: Option<f64>,
    /// Own particles first, then the halo.
    bodies: Numbered<D>,
    own: usize,
}

impl<const D: usize> Rank<D>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    /// Sends the particles that each rank made or read to their owners, in a periodic box if there
    /// is one. Particle numbers must be unique.
    ///
    /// # Errors
    /// Fails in all ranks if, in any of them, the box does not fit, dimensions or boxes differ,
    /// [`Refusal::Skewed`] occurs or memory runs out ([`Refusal::Exhausted`]).
    pub fn new(
        world: &impl World,
        bodies: Numbered<D>,
        lattice: Option<Lattice>,
    ) -> Result<Rank<D>, Failure> {
        let boxed = |lattice| -> Result<Lattice, Failure> {
            let empty = Scene::<f64, D>::new(Vec::new(), Radii::Uniform(0.0))?;
            Ok(Periodic::new(empty.into(), lattice)?.into_parts().1)
        };
        // The same number of values in any dimension.
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
        // Without particles the values are minus infinity, so there is no common radius.
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

    /// Replaces the halo by the particles of other ranks that may touch own ones. Returns the data
    /// that this rank sent.
    ///
    /// # Errors
    /// Returns [`Refusal::Exhausted`] if memory runs out in any rank.
    pub fn refresh(&mut self, world: &impl World) -> Result<Traffic, Failure> {
        self.bodies.truncate(self.own);
        let (bodies, slabs, radius) = (&self.bodies, &self.slabs, self.radius);
        // Called once, because in MPI this call takes longer than a particle.
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

    /// Returns the number in the whole scene of particle `k` of this rank.
    pub fn id(&self, k: u32) -> u32 {
        self.bodies.ids()[k as usize]
    }

    /// Finds the contacts that belong to this rank, exactly, and replaces the contents of the
    /// lists. Particles have the rank's own numbers, own particles first ([`Rank::id`]).
    ///
    /// # Errors
    /// Returns the refusals of the detector.
    pub fn search(&self, searcher: &mut Searcher, contacts: &mut Contacts) -> Result<(), Failure> {
        let loaded = self.loaded();
        searcher.list(&loaded, Arithmetic::Exact, contacts).map_err(|refusal| match refusal {
            // Convert to numbers of the whole scene, which users know.
            Refusal::Away { particle, vector, boxes } => {
                Refusal::Away { particle: self.id(particle), vector, boxes }
            }
            other => other,
        })?;
        // At most 2^32 - 1, like the scene.
        let own = self.own as u32;
        contacts.plain.retain(|&[i, j]| i.min(j) < own);
        contacts.shifted.retain(|&ImagePair { i, .. }| i < own);
        Ok(())
    }

    /// Returns the bytes of particles and of the searcher's last detection, by formula, without the
    /// lists of contacts.
    pub fn formula_bytes(&self, searcher: &Searcher) -> u64 {
        let each = size_of::<u32>() + size_of::<f64>() * (D + usize::from(self.radius.is_none()));
        (self.bodies.len() * each) as u64 + searcher.formula_bytes()
    }

    /// Returns number and digest of this rank's contacts, in numbers of the whole scene. Both add
    /// up over ranks.
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
            // Valid, because the box was checked with an empty scene of the same dimension and
            // storage.
            Some(lattice) => Loaded::InBox(Periodic::new(scene.into(), lattice).unwrap()),
        }
    }
}
