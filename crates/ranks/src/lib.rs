//! Detects the contacts of one scene on several ranks, which are processes of MPI (feature `mpi`)
//! or threads. Measures the cost of each step and the traffic, and checks that the contacts are
//! those that one process finds.

pub mod bodies;
pub mod model;
#[cfg(feature = "mpi")]
pub mod mpi;
pub mod rank;
pub mod share;
pub mod slabs;
pub mod verb;
pub mod world;

use std::iter::zip;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::bodies::Numbered;
use crate::rank::{Failure, Rank, failed, together};
use crate::share::Share;
use crate::world::World;
use contactbench::io::Given;
use contactbench::record::origin::provenance;
use contactbench::stats::interval::{Interval, interval, median};
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
pub struct Row {
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
    /// Ratio of `alone_ms` to the longest step of any rank, per step: the part of a step that an
    /// undisturbed search takes.
    pub alone_over_step: Option<Interval>,
    /// Ratio of `alone_ms` to the longest search. It shows how far shared memory and cores slow the
    /// search down, approximately, because the repeated search finds warm caches.
    pub alone_over_search: Option<Interval>,
    /// Largest memory of a rank in bytes, computed from array sizes: particles, buffers and
    /// contacts, without messages.
    pub memory_most: u64,
    pub pairs: u64,
    pub digest: String,
    /// Contacts that one process finds, if they were computed.
    pub whole: Option<Whole>,
    /// The commit that this program was built from.
    pub revision: Option<&'static str>,
    /// Whether the sources differed from that commit.
    pub dirty: Option<bool>,
    pub machine: String,
}

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

impl Row {
    /// Returns whether the contacts are those of one process; `None` if not computed by one.
    pub fn is_right(&self) -> Option<bool> {
        let whole = self.whole.as_ref()?;
        Some(whole.pairs == self.pairs && whole.digest == self.digest)
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
) -> Result<Row, Failure> {
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

fn of<const D: usize>(
    world: &impl World,
    scene: &Scene<'_, f64, D>,
    first: u64,
    lattice: Option<Lattice>,
    setting: Setting<'_>,
) -> Result<Row, Failure>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    let bodies = together(world, Numbered::new(scene, first))?;
    let mut rank = Rank::new(world, bodies, lattice)?;
    let mut searcher = searcher(setting);
    let mut contacts = ContactList::default();
    let mut steps = [const { Vec::new() }; 4];
    let mut traffic = Default::default();
    for step in 0..=setting.steps {
        world.sum(&mut [0]);
        let begun = Instant::now();
        traffic = rank.refresh(world)?;
        let known = Instant::now();
        let result = rank.search(&mut searcher, &mut contacts);
        let found = Instant::now();
        together(world, result)?;
        let mut alone = Duration::ZERO;
        let mut again = Ok(());
        for turn in 0..world.size() {
            world.sum(&mut [0]);
            if turn == world.rank() {
                let begun = Instant::now();
                again = rank.search(&mut searcher, &mut contacts);
                alone = begun.elapsed();
            }
        }
        together(world, again)?;
        let times = [found - begun, known - begun, found - known, alone];
        let mut times = times.map(|time| time.as_secs_f64() * 1e3);
        world.largest(&mut times);
        if step > 0 {
            steps.iter_mut().zip(times).for_each(|(of, time)| of.push(time));
        }
    }
    let memory = rank.formula_bytes(&searcher)
        + contacts.plain.capacity() as u64 * PAIR_BYTES
        + contacts.shifted.capacity() as u64 * IMAGE_PAIR_BYTES;
    let digest = rank.digest(&contacts);
    let own = rank.own() as u64;
    let mut sums = [own, traffic.particles, traffic.bytes, digest.contacts, digest.sum];
    world.sum(&mut sums);
    let most = [own, rank.halo() as u64, traffic.bytes, traffic.partners, memory];
    // The conversion is exact, because the numbers are below 2^53.
    let [own_most, halo, bytes, partners, memory] = most.map(|number| number as f64);
    let mut most = [own_most, -own_most, halo, bytes, partners, memory];
    world.largest(&mut most);
    let (along, around) = rank.slabs().direction();
    let [n, sent, sent_bytes, contacts, sum] = sums;
    let digest = Whole::of(Digest { contacts, sum });
    let alone_over = |times: &[f64]| {
        let told = zip(&steps[3], times).filter(|(_, time)| **time > 0.0);
        let ratios: Vec<f64> = told.map(|(alone, time)| alone / time).collect();
        interval(&ratios)
    };
    let (alone_over_step, alone_over_search) = (alone_over(&steps[0]), alone_over(&steps[2]));
    let [step_ms, exchange_ms, search_ms, alone_ms] =
        steps.map(|times| median(&times).unwrap_or(0.0));
    Ok(Row {
        scene: String::new(),
        n,
        dim: D,
        detector: setting.spec.to_string(),
        kind: "",
        ranks: world.size(),
        along,
        around,
        own: [-most[1] as u64, most[0] as u64],
        halo_most: most[2] as u64,
        sent,
        sent_bytes,
        sent_bytes_most: most[3] as u64,
        partners_most: most[4] as u64,
        step_ms,
        exchange_ms,
        search_ms,
        alone_ms,
        alone_over_step,
        alone_over_search,
        memory_most: most[5] as u64,
        pairs: digest.pairs,
        digest: digest.digest,
        whole: None,
        revision: provenance::revision(),
        dirty: provenance::dirty(),
        machine: provenance::machine(),
    })
}
