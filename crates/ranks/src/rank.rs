//! One scene over several ranks, each with a slab of it: processes of MPI, or threads.
//!
//! ```text
//! rows of the file ─> owners of slabs ─> own particles ─┬─> any detector ─> contacts ─> sums
//!                      (exchange)                       │
//!                                   halo from above  ───┘
//!                                     (exchange)
//! ```
//!
//! * **Every contact is found once.** A contact of particles of two ranks belongs to the lower
//!   rank. Each rank sends its particles near a border downwards. The lower rank searches its own
//!   and the received particles for contacts that involve at least one of its own.
//! * **The halo** is what may touch a particle in the slab below, or in lower ones if particles are
//!   larger than slabs: no size is refused. The proof is in [`crate::slabs`].
//! * **In a periodic box** the first slab is the last one's neighbour. Ranks get particles with
//!   their given coordinates, and the box. Each makes the images that it needs, as one process
//!   does, and decides contacts for the given numbers.
//! * **Exact arithmetic only**, because there a contact depends on its two particles alone. Rounded
//!   filters and images depend on the corners of cells and boxes, and so on the number of ranks.
//!
//! Numbers of contacts and digests of the ranks add up to those of one process ([`Rank::digest`]).

use contactbench_ground::contact::Arithmetic;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::periodic::Loaded;
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic, PeriodicError};
use contactbench_ground::scene::{AnyScene, Lattice, Radii, Scene, SceneError};
use contactbench_lists::searcher::Searcher;

use crate::particles::Numbered;
use crate::slabs::Slabs;
use crate::world::World;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    #[error(transparent)]
    Here(#[from] Refusal),
    /// Another rank has refused, and prints the reason.
    #[error("rank {0} has failed; it prints why")]
    Elsewhere(usize),
    /// There are more particles than u32 can number.
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Boxed(#[from] PeriodicError),
    #[error(
        "ranks do not agree on one scene: {0} differs between ranks; give all of them the \
         same file and the same options"
    )]
    Unlike(&'static str),
}

/// Returns the highest rank that has failed, or `None`. Collective: all ranks must call it.
pub fn failed(world: &impl World, here: bool) -> Option<usize> {
    let mut highest = [if here { world.rank() as f64 } else { -1.0 }];
    world.largest(&mut highest);
    (highest[0] >= 0.0).then_some(highest[0] as usize)
}

/// Returns this rank's result if no rank has failed, so that none waits for one that ended.
///
/// # Errors
/// The error of this rank, or the number of the highest rank that failed.
pub fn together<T, E: From<Failure>>(world: &impl World, result: Result<T, E>) -> Result<T, E> {
    let failed = failed(world, result.is_err());
    let result = result?;
    failed.map_or(Ok(result), |rank| Err(Failure::Elsewhere(rank).into()))
}

/// Returns whether every rank has the same numbers. None may be NaN.
pub fn alike<const N: usize>(world: &impl World, numbers: [f64; N]) -> bool {
    let mut ends = numbers.map(|number| [number, -number]);
    world.largest(ends.as_flattened_mut());
    ends.iter().all(|[most, least]| *most == -least)
}

/// Messages that a rank sends for one step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Number of particles sent; a particle counts once for each rank that gets it.
    pub particles: u64,
    /// Bytes: 4 for a particle's number, 8 per coordinate, 8 for the radius if radii differ.
    pub bytes: u64,
    pub partners: u64,
}

/// A rank: the particles of its slab, and copies of particles of other slabs that may touch them.
pub struct Rank<const D: usize> {
    slabs: Slabs<D>,
    lattice: Option<Lattice>,
    radius: Option<f64>,
    particles: Numbered<D>,
    own: usize,
}

impl<const D: usize> Rank<D>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    /// Sends the particles that each rank has made or read to the owners of their slabs. No two
    /// particles may have the same number.
    ///
    /// # Errors
    /// Fails if the box does not fit the scene, if dimensions or boxes differ between ranks, and
    /// with [`Refusal::Skewed`] or [`Refusal::Exhausted`] in any rank.
    pub fn new(
        world: &impl World,
        particles: Numbered<D>,
        lattice: Option<Lattice>,
    ) -> Result<Rank<D>, Failure> {
        let boxed = |lattice| -> Result<Lattice, Failure> {
            let empty = Scene::<f64, D>::new(Vec::new(), Radii::Uniform(0.0))?;
            Ok(Periodic::new(empty.into(), lattice)?.into_parts().1)
        };
        // The list has the same length in 2D and 3D.
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
        let mut ends = particles
            .radii()
            .iter()
            .fold([f64::NEG_INFINITY; 2], |[most, least], &r| [most.max(r), least.max(-r)]);
        world.largest(&mut ends);
        // Without particles the largest radius is minus infinity, and `radius` is `None`.
        let radius = (ends[0] == -ends[1]).then_some(ends[0]);
        let sizes = radius.is_none();
        let mut slabs = Slabs::new(world, &particles, ends[0].max(0.0), lattice.as_ref())?;
        let owner = |k: usize, to: &mut dyn FnMut(usize)| {
            to(slabs.owner(particles.at(k)));
        };
        let mut letters = together(world, particles.letters(world.size(), sizes, owner))?;
        drop(particles);
        world.exchange(&mut letters)?;
        let mut own = Numbered::default();
        let read = own.read(&letters, sizes);
        together(world, read)?;
        let largest = match radius {
            Some(radius) if !own.is_empty() => radius,
            _ => own.radii().iter().copied().fold(f64::NEG_INFINITY, f64::max),
        };
        slabs.settle(world, largest);
        Ok(Rank { slabs, lattice, radius, own: own.len(), particles: own })
    }

    /// Replaces the copies of other ranks' particles by current ones, and returns this rank's
    /// traffic.
    ///
    /// # Errors
    /// Fails if any rank runs out of memory ([`Refusal::Exhausted`]).
    pub fn refresh(&mut self, world: &impl World) -> Result<Traffic, Failure> {
        self.particles.truncate(self.own);
        let (particles, slabs, radius) = (&self.particles, &self.slabs, self.radius);
        // The number is read once, because a call of MPI takes longer than the work for a particle.
        let rank = world.rank();
        let reached = |k: usize, to: &mut dyn FnMut(usize)| {
            let r = radius.unwrap_or_else(|| particles.radii()[k]);
            slabs.reached(rank, particles.at(k), r, to);
        };
        let sizes = radius.is_none();
        let mut letters = together(world, particles.letters(world.size(), sizes, reached))?;
        let bytes: usize = letters.iter().map(Vec::len).sum();
        let traffic = Traffic {
            particles: (bytes / Numbered::<D>::bytes(sizes)) as u64,
            bytes: bytes as u64,
            partners: letters.iter().filter(|letter| !letter.is_empty()).count() as u64,
        };
        world.exchange(&mut letters)?;
        let read = self.particles.read(&letters, sizes);
        together(world, read)?;
        Ok(traffic)
    }

    pub fn own(&self) -> usize {
        self.own
    }

    pub fn halo(&self) -> usize {
        self.particles.len() - self.own
    }

    pub fn slabs(&self) -> &Slabs<D> {
        &self.slabs
    }

    /// Returns the number that particle `k` of this rank has in the whole scene.
    pub fn id(&self, k: u32) -> u32 {
        self.particles.ids()[k as usize]
    }

    /// Replaces the contents of `contacts` by the exact contacts that belong to this rank.
    /// Particles have the rank's own numbers, with own particles first ([`Rank::id`] converts
    /// them). Fails if the detector refuses.
    pub fn search(
        &self,
        searcher: &mut Searcher,
        contacts: &mut ContactList,
    ) -> Result<(), Failure> {
        let loaded = self.loaded();
        searcher.list(&loaded, Arithmetic::Exact, contacts).map_err(|refusal| match refusal {
            // The refusal must name the particle by its number in the whole scene.
            Refusal::Away { particle, vector, boxes } => {
                Refusal::Away { particle: self.id(particle), vector, boxes }
            }
            other => other,
        })?;
        // The cast is lossless, because the scene has at most 2^32 - 1 particles.
        let own = self.own as u32;
        contacts.plain.retain(|&[i, j]| i.min(j) < own);
        contacts.shifted.retain(|&ImagePair { i, .. }| i < own);
        Ok(())
    }

    /// Returns the bytes of the particles and of the searcher's last detection, computed from array
    /// sizes. The lists of contacts are not included.
    pub fn formula_bytes(&self, searcher: &Searcher) -> u64 {
        let each = size_of::<u32>() + size_of::<f64>() * (D + usize::from(self.radius.is_none()));
        (self.particles.len() * each) as u64 + searcher.formula_bytes()
    }

    /// Returns number and digest of this rank's contacts, with the particle numbers of the whole
    /// scene. Both can be added over ranks.
    pub fn digest(&self, contacts: &ContactList) -> Digest {
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
        let scene = self.particles.scene(self.radius);
        match self.lattice {
            None => Loaded::Open(scene.into()),
            // This cannot fail: the box was checked with an empty f64 scene of this dimension.
            Some(lattice) => Loaded::InBox(Periodic::new(scene.into(), lattice).unwrap()),
        }
    }
}
