//! Detects the contacts of one scene on several ranks, which are processes of MPI (feature `mpi`)
//! or threads. Measures the cost of each step and the traffic, and checks that the contacts are
//! those that one process finds.

#[cfg(feature = "mpi")]
pub mod mpi;
pub mod particles;
pub mod rank;
pub mod share;
pub mod slabs;
pub mod verb;
pub mod world;

use std::time::{Duration, Instant};

use serde::Serialize;

use crate::particles::Numbered;
use crate::rank::{Failure, Rank, Traffic, failed, together};
use crate::share::Share;
use crate::world::World;
use contactbench::io::Given;
use contactbench::record::origin::provenance;
use contactbench::stats::interval::median;
use contactbench_detectors::spec::DetectorSpec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::pairs::pair_list::PAIR_BYTES;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::periodic::{ContactList, IMAGE_PAIR_BYTES};
use contactbench_ground::scene::{AnyScene, Lattice, Scene};
use contactbench_lists::searcher::Searcher;

#[derive(Clone, Copy)]
pub struct Setting<'a> {
    pub spec: &'a DetectorSpec,
    /// Memory limit in bytes: for the detector's arrays, and again for a list of contacts.
    pub memory_limit: u64,
    /// Number of timed steps, after one warm-up step; at least 1.
    pub steps: usize,
}

/// Results of all ranks together. A count is the sum over the ranks, or the maximum if its name has
/// `most`. A time is that of the slowest rank, as the median over the steps.
#[derive(Clone, Debug, Serialize)]
pub struct RankResults {
    pub scene: String,
    pub n: u64,
    pub dim: usize,
    pub detector: String,
    /// Kind of the ranks: `mpi` or `threads`.
    pub kind: &'static str,
    pub ranks: usize,
    /// Index (from 0) of the axis, or of the box vector, along which slabs lie.
    pub along: usize,
    /// Whether slabs lie along a periodic vector, so that the last slab meets the first.
    pub around: bool,
    /// Smallest and largest number of particles that a rank owns.
    pub own: [u64; 2],
    /// Largest number of copies of other ranks' particles (its halo) that a rank holds.
    pub halo_most: u64,
    pub sent: u64,
    /// Bytes sent in a step: `sent` times the bytes of one particle.
    pub sent_bytes: u64,
    pub sent_bytes_most: u64,
    pub partners_most: u64,
    /// Time from the start of a step to the last contact.
    pub step_ms: f64,
    /// Part of `step_ms` until the particles of other ranks have arrived.
    pub exchange_ms: f64,
    /// Time of the search: the rest of `step_ms`.
    pub search_ms: f64,
    /// Time of the search when it is repeated after each step while all other ranks wait.
    pub alone_ms: f64,
    /// Largest memory of a rank in bytes, computed from array sizes: particles, buffers and
    /// contacts, without messages.
    pub memory_most: u64,
    #[serde(flatten)]
    pub found: Whole,
    /// Contacts that one process finds, if they were computed.
    pub whole: Option<Whole>,
    /// The commit that this program was built from.
    pub revision: Option<&'static str>,
    /// Whether the sources differed from that commit.
    pub dirty: Option<bool>,
    pub machine: String,
}

/// Contacts of the whole scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Whole {
    pub pairs: u64,
    pub digest: String,
}

impl Whole {
    fn of(digest: Digest) -> Whole {
        Whole { pairs: digest.contacts, digest: digest.hex() }
    }
}

impl RankResults {
    /// Returns whether the contacts are those of one process; `None` if not computed by one.
    pub fn is_right(&self) -> Option<bool> {
        Some(*self.whole.as_ref()? == self.found)
    }
}

/// Finds the contacts of the whole scene in one process; fails if the detector refuses.
pub fn whole(given: &Given, setting: Setting<'_>) -> anyhow::Result<Whole> {
    let loaded = given.loaded(Arithmetic::Exact)?;
    let mut contacts = ContactList::default();
    searcher(setting).list(&loaded, Arithmetic::Exact, &mut contacts)?;
    Ok(Whole::of(contacts.digest()))
}

/// Measures the steps as one of the ranks, and returns the same row in all ranks. Fails if any rank
/// refuses.
pub fn measure(
    world: &impl World,
    kind: &'static str,
    name: &str,
    share: Share,
    setting: Setting<'_>,
) -> Result<RankResults, Failure> {
    let Share { given: Given { scene, lattice, .. }, first, .. } = share;
    // If ranks read files of different lengths, their rows usually overlap or leave gaps, which is
    // checked here. Different contents only change the digest.
    let mut lens = vec![0; world.size()];
    lens[world.rank()] = scene.len() as u64;
    world.sum(&mut lens);
    let before: u64 = lens[..world.rank()].iter().sum();
    if failed(world, before != first).is_some() {
        return Err(Failure::Unlike("its number of particles"));
    }
    let mut row = match &scene {
        AnyScene::Plane(stored) => of(world, &stored.widened(), first, lattice, setting),
        AnyScene::Space(stored) => of(world, &stored.widened(), first, lattice, setting),
    }?;
    (row.kind, row.scene) = (kind, name.to_string());
    Ok(row)
}

fn searcher(setting: Setting<'_>) -> Searcher {
    Searcher::new(setting.spec.make(Options { memory_limit: setting.memory_limit, threads: 1 }))
}

/// Measures the steps of one rank in `D` dimensions.
fn of<const D: usize>(
    world: &impl World,
    scene: &Scene<'_, f64, D>,
    first: u64,
    lattice: Option<Lattice>,
    setting: Setting<'_>,
) -> Result<RankResults, Failure>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    let particles = together(world, Numbered::new(scene, first))?;
    let mut rank = Rank::new(world, particles, lattice)?;
    let mut searcher = searcher(setting);
    let mut contacts = ContactList::default();
    let (mut steps, mut traffic) = (Vec::<[f64; 4]>::new(), Traffic::default());
    for step in 0..=setting.steps {
        let times;
        (traffic, times) = timed(world, &mut rank, &mut searcher, &mut contacts)?;
        // The first step only warms up.
        steps.extend((step > 0).then_some(times));
    }
    let typical = |k: usize| median(&steps.iter().map(|it| it[k]).collect::<Vec<_>>());
    let [step_ms, exchange_ms, search_ms, alone_ms] =
        [0, 1, 2, 3].map(|k| typical(k).unwrap_or(0.0));
    let memory = rank.formula_bytes(&searcher)
        + contacts.plain.capacity() as u64 * PAIR_BYTES
        + contacts.shifted.capacity() as u64 * IMAGE_PAIR_BYTES;
    let Digest { contacts, sum } = rank.digest(&contacts);
    let [contacts, sum] = [contacts, sum].map(|number| Over::all(world, number).sum);
    let own = Over::all(world, rank.own() as u64);
    let bytes = Over::all(world, traffic.bytes);
    let (along, around) = rank.slabs().direction();
    Ok(RankResults {
        scene: String::new(),
        n: own.sum,
        dim: D,
        detector: setting.spec.to_string(),
        kind: "",
        ranks: world.size(),
        along,
        around,
        own: [own.least, own.most],
        halo_most: Over::all(world, rank.halo() as u64).most,
        sent: Over::all(world, traffic.particles).sum,
        sent_bytes: bytes.sum,
        sent_bytes_most: bytes.most,
        partners_most: Over::all(world, traffic.partners).most,
        step_ms,
        exchange_ms,
        search_ms,
        alone_ms,
        memory_most: Over::all(world, memory).most,
        found: Whole::of(Digest { contacts, sum }),
        whole: None,
        revision: provenance::revision(),
        dirty: provenance::dirty(),
        machine: provenance::machine(),
    })
}

/// Runs a step; returns this rank's traffic, and four times in milliseconds, each of the slowest
/// rank: step, exchange, search, and the search again while all other ranks wait.
fn timed<const D: usize>(
    world: &impl World,
    rank: &mut Rank<D>,
    searcher: &mut Searcher,
    contacts: &mut ContactList,
) -> Result<(Traffic, [f64; 4]), Failure>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    world.sum(&mut [0]);
    let begun = Instant::now();
    let traffic = rank.refresh(world)?;
    let arrived = Instant::now();
    let result = rank.search(searcher, contacts);
    let found = Instant::now();
    together(world, result)?;
    let (mut alone, mut again) = (Duration::ZERO, Ok(()));
    for turn in 0..world.size() {
        world.sum(&mut [0]);
        if turn == world.rank() {
            let begun = Instant::now();
            again = rank.search(searcher, contacts);
            alone = begun.elapsed();
        }
    }
    together(world, again)?;
    let times = [found - begun, arrived - begun, found - arrived, alone];
    let mut times = times.map(|time| time.as_secs_f64() * 1e3);
    world.largest(&mut times);
    Ok((traffic, times))
}

/// A number over all ranks.
struct Over {
    /// The sum, modulo 2^64.
    sum: u64,
    least: u64,
    most: u64,
}

impl Over {
    /// The extremes are exact for numbers below 2^53.
    fn all(world: &impl World, number: u64) -> Over {
        let (mut sum, mut ends) = ([number], [number as f64, -(number as f64)]);
        world.sum(&mut sum);
        world.largest(&mut ends);
        Over { sum: sum[0], least: -ends[1] as u64, most: ends[0] as u64 }
    }
}
