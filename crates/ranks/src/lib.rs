//! One scene over several ranks: what each step costs, what is sent, and whether the contacts are
//! those of one process. Ranks are processes of MPI (the feature `mpi`) or threads.

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
use contactbench::record::provenance;
use contactbench::stats::interval::{Interval, interval, median};
use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::Options;
use contactbench_core::detect::spec::DetectorSpec;
use contactbench_core::pair_list::PAIR_BYTES;
use contactbench_core::periodic::{Contacts, IMAGE_PAIR_BYTES};
use contactbench_core::scene::{AnyScene, Lattice, Scene};
use contactbench_core::searcher::Searcher;
use contactbench_core::sink::Digest;

/// How it is measured.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// Who searches in each rank.
    pub spec: &'a DetectorSpec,
    /// For its arrays, and for a list of contacts, in bytes.
    pub memory_limit: u64,
    /// Steps that are timed, after one that is not; at least 1.
    pub steps: usize,
}

/// What the ranks have done together. Numbers are sums, or of the rank that has the most; times are
/// of the rank that takes longest, the median over the steps.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The scene, as it was asked for.
    pub scene: String,
    /// Particles of all ranks.
    pub n: u64,
    /// 2 or 3.
    pub dim: usize,
    /// Who searches.
    pub detector: String,
    /// `mpi` or `threads`.
    pub kind: &'static str,
    /// How many there are.
    pub ranks: usize,
    /// Along which axis slabs lie, or along which vector of the box, from 0.
    pub along: usize,
    /// Is it a vector of a box that repeats? Then the last slab meets the first.
    pub around: bool,
    /// Fewest and most own particles of a rank.
    pub own: [u64; 2],
    /// Most particles of others in a rank.
    pub halo_most: u64,
    /// Particles sent in a step.
    pub sent: u64,
    /// Bytes sent in a step, as they were counted; `sent` times those of one.
    pub sent_bytes: u64,
    /// Most bytes that a rank sends.
    pub sent_bytes_most: u64,
    /// Most ranks that a rank sends to.
    pub partners_most: u64,
    /// From the start of a step to the last contact.
    pub step_ms: f64,
    /// The part of it until particles of others are there.
    pub exchange_ms: f64,
    /// The other part.
    pub search_ms: f64,
    /// The same search while no other rank does anything, after each step.
    pub alone_ms: f64,
    /// That over the longest step of any rank, within each: the part of a step that an undisturbed
    /// search takes, of own particles and halo.
    pub alone_over_step: Option<Interval>,
    /// That over the longest search of the step: about what sharing memory and cores leaves, since
    /// the later search finds warm caches.
    pub alone_over_search: Option<Interval>,
    /// Most bytes of particles, buffers and contacts in a rank, by their formulas; without what is
    /// on its way.
    pub memory_most: u64,
    /// Contacts of all ranks.
    pub pairs: u64,
    /// Their digest.
    pub digest: String,
    /// Those of one process, where they were looked for.
    pub whole: Option<Whole>,
    /// The commit that this program was built from, and whether its sources differed.
    pub revision: Option<&'static str>,
    /// Did they?
    pub dirty: Option<bool>,
    /// Where the first rank ran.
    pub machine: String,
}

/// What one process finds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Whole {
    /// Contacts.
    pub pairs: u64,
    /// Their digest.
    pub digest: String,
}

impl Whole {
    fn of(digest: Digest) -> Whole {
        Whole { pairs: digest.contacts, digest: digest.hex() }
    }
}

impl Row {
    /// Are the contacts those of one process? Unknown where that was not asked.
    pub fn is_right(&self) -> Option<bool> {
        let whole = self.whole.as_ref()?;
        Some(whole.pairs == self.pairs && whole.digest == self.digest)
    }
}

/// What one process finds in the whole scene.
///
/// # Errors
/// What the detector refuses.
pub fn whole(given: &Given, setting: Setting<'_>) -> anyhow::Result<Whole> {
    let loaded = given.loaded(Arithmetic::Exact)?;
    let mut contacts = Contacts::default();
    searcher(setting).list(&loaded, Arithmetic::Exact, &mut contacts)?;
    Ok(Whole::of(contacts.digest()))
}

/// Measures, as one of the ranks: all of them get the same row.
///
/// # Errors
/// What any rank refuses.
pub fn measure(
    world: &impl World,
    kind: &'static str,
    name: &str,
    share: Share,
    setting: Setting<'_>,
) -> Result<Row, Failure> {
    let Share { given: Given { scene, lattice, .. }, first, .. } = share;
    // Files of other lengths mostly show in rows that overlap or are missing. Contents are not
    // compared: the digest is.
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
    Searcher::new(setting.spec, Options { memory_limit: setting.memory_limit, threads: 1 })
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
    let mut contacts = Contacts::default();
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
    // Numbers below 2^53.
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
