//! A contact list of another code, compared with the exact truth; and how it may be meant where it
//! differs.
//!
//! A list with images names each contact once, as (i, j, S). A list without them names pairs, and
//! in a box there are two kinds: each pair as often as images of it touch, or once. Both are taken,
//! and [`Verification::taken`] says which; where all pairs touch through one image they are the
//! same. In open space each contact has the image 0.

mod compare;
mod guess;
mod listing;
mod mistake;
pub mod paired;
mod rows;
mod search;

pub use compare::Taken;
use compare::{Against, Compared};
pub use listing::{Couple, Listed, Meaning, Naming};
use listing::{ImagesOf, Listing, Taking};
pub use mistake::{Mistake, Reading, rounded_up};
use search::Search;

use crate::run::judge::{Judge, Said};
use crate::run::protocol::Found;
use contactbench_core::contact::Arithmetic;
use contactbench_core::oracle::{self, Causes, Errors, NoTruth};
use contactbench_core::periodic::{self, Contacts, ImagePair, Periodic};
use contactbench_io::Given;
use contactbench_io::{Groups, boxes};
use contactbench_scenes::touching::{contacts, gap, resized};

/// Number of pairs of each kind that are kept, unless all that is missed is wanted.
pub const WORST: usize = 100;
/// Bytes for each pair of list and truth that other readings of a list take at most.
const READING_BYTES: u64 = 128;

/// What is not held against a list.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Allowed {
    /// Each pair stands there as i,j and as j,i, and is taken once.
    pub both_sides: bool,
    /// Pairs that are apart by no more than this length may be listed.
    pub skin: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct Terms<'a> {
    pub arithmetic: Arithmetic,
    pub allowed: Allowed,
    /// Most bytes for a list of pairs.
    pub memory_limit: u64,
    /// Number of pairs of each kind that are kept.
    pub kept: usize,
    /// Contacts that are left out of truth and list.
    pub without: Option<&'a Groups>,
}

#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The particles in their box; in open space it repeats along no vector.
    pub space: &'a Periodic<'a>,
    pub list: Listed<'a>,
    pub naming: &'a Naming,
    /// What its numbers may mean instead.
    pub others: &'a [Naming],
    pub terms: Terms<'a>,
}

#[derive(Clone, Debug)]
pub struct Verification {
    /// The contacts, sorted.
    pub truth: Contacts,
    /// Against them.
    pub errors: Errors,
    /// Pairs of the list that name no particle.
    pub unknown: Vec<Couple>,
    /// Contacts that are not listed and their overlap in mean radii, the deepest first, at most
    /// as many as are kept.
    pub missed: Vec<(ImagePair, f64)>,
    /// Pairs that are listed and do not touch, with their depth in mean radii, which is negative:
    /// the widest gap first, at most as many as are kept.
    pub spurious: Vec<(ImagePair, f64)>,
    /// Pairs of the list that are there from one side only, where both are expected.
    pub one_sided: Vec<Couple>,
    /// Pairs that do not touch and are within the skin.
    pub within_skin: u64,
    pub taken: Taken,
    /// Contacts and pairs of the list that were left out.
    pub left_out: [u64; 2],
}

impl Verification {
    pub fn is_same(&self) -> bool {
        self.wrong() == 0
    }

    pub fn wrong(&self) -> u64 {
        self.errors.wrong() + (self.unknown.len() + self.one_sided.len()) as u64
    }
}

/// Compares a list with the contacts that are true.
///
/// # Errors
/// The truth cannot be found; there is no memory for the pairs; the list names images along an axis
/// that is open.
pub fn verify(job: &Job<'_>) -> anyhow::Result<Verification> {
    let Job { space, list, naming, terms, .. } = *job;
    let boxed = space.lattice().repeats();
    if boxed {
        boxes::hold(space.lattice().periodic(), list.images)?;
    }
    let mut truth = truth(space, terms.arithmetic, terms.memory_limit)?;
    let mut left_out = [truth.len(), 0];
    if let Some(groups) = terms.without {
        truth.plain.retain(|&[i, j]| !groups.leave_out(i, j));
        truth.shifted.retain(|pair| !groups.leave_out(pair.i, pair.j));
    }
    let Terms { allowed: Allowed { both_sides, skin }, without, kept, .. } = terms;
    let taking = Taking { naming, images: ImagesOf::Second, both_sides, without };
    let listing = Listing::new(list, taking, space.scene().len())?;
    left_out = [left_out[0] - truth.len(), listing.left_out];
    // Through how many images a pair may be listed; other lists are measured pair by pair.
    let near = match boxed && skin > 0.0 && !listing.has_images {
        true => within(space, skin, terms.memory_limit)?,
        false => Contacts::default(),
    };
    let against = Against { space, truth: &truth, near: &near, skin, kept };
    let Compared { taken, errors, missed, spurious, within_skin } = against.hold(&listing);
    let Listing { unknown, one_sided, .. } = listing;
    let (missed, spurious) = (missed.pairs, spurious.pairs);
    Ok(Verification {
        truth,
        errors,
        unknown,
        missed,
        spurious,
        one_sided,
        within_skin,
        taken,
        left_out,
    })
}

/// How a list that differs may be meant, so that it agrees: the reading with the fewest pairs that
/// differ, if it is better by half than the list as it stands. `declared` is the box that the file
/// of the particles declares, where boundaries are open.
///
/// # Errors
/// No memory for the pairs.
pub fn explain(
    job: &Job<'_>,
    found: &Verification,
    declared: Option<&Periodic<'_>>,
) -> anyhow::Result<Option<Reading>> {
    let plain = job.terms.allowed == Allowed::default() && job.terms.without.is_none();
    let pairs = job.list.pairs.len() as u64 + found.truth.len();
    // A hint is not worth all the memory there is, and a list of nothing explains nothing.
    if found.is_same()
        || !plain
        || pairs * READING_BYTES > job.terms.memory_limit
        || job.list.pairs.is_empty()
    {
        return Ok(None);
    }
    let reading = Search::best(job, &found.truth, declared.is_none())?;
    let explained = reading.as_ref().is_some_and(|reading| reading.wrong == 0);
    let Some(declared) = declared.filter(|_| !explained) else { return Ok(reading) };
    let job = Job { space: declared, ..*job };
    // A hint is not worth an error.
    let in_box = in_declared(&job).unwrap_or_default();
    Ok(in_box.or(reading))
}

/// How a list agrees entirely in the box that the file declares.
fn in_declared(job: &Job<'_>) -> anyhow::Result<Option<Reading>> {
    let found = verify(job)?;
    let reading = match found.is_same() {
        true => Some(Reading::plain(job.list.pairs.len() as u64)),
        false => Search::best(job, &found.truth, false)?,
    };
    let reading = reading.filter(|it| it.wrong == 0 && !it.mistakes.contains(&Mistake::Open));
    Ok(reading.map(|reading| reading.declared(job.space.lattice().periodic())))
}

/// The errors of a list by cause, whose contacts were decided in an arithmetic; none where no truth
/// is known. A list of contacts may take `memory_limit` bytes.
///
/// # Errors
/// A box that does not suit the scene.
pub fn causes(
    given: &Given,
    contacts: &Contacts,
    arithmetic: Arithmetic,
    memory_limit: u64,
) -> anyhow::Result<Option<Causes>> {
    let found = &Found::from(contacts.digest());
    let said = Said { arithmetic, may_miss: false, found };
    let mut judge = Judge::new(given, memory_limit)?;
    Ok(judge.judge("list", said, |_| Ok(contacts.clone()))?.0.causes)
}

/// The truth in an arithmetic, sorted; lists may take `limit` bytes.
fn truth(space: &Periodic<'_>, arithmetic: Arithmetic, limit: u64) -> Result<Contacts, NoTruth> {
    if space.lattice().repeats() {
        return Ok(periodic::truth(space, arithmetic, limit)?.pairs.into_iter().collect());
    }
    let stored = space.scene().as_stored(arithmetic)?;
    let plain = oracle::truth_as_stored(&stored, arithmetic.test(), limit)?.pairs;
    Ok(Contacts { plain, ..Contacts::default() })
}

/// All pairs that are apart by no more than a length, sorted.
fn within(space: &Periodic<'_>, most: f64, limit: u64) -> anyhow::Result<Contacts> {
    let near = contacts(&resized(space, |r| with_skin(r, most))?, limit)?;
    Ok(near.into_iter().filter(|&pair| gap(space, pair) <= most).collect())
}

/// Returns a radius at which particles touch if the gap between them is at most `skin`.
fn with_skin(r: f64, skin: f64) -> f64 {
    ((r + skin / 2.0) * (1.0 + 1e-9)).min(f64::MAX)
}

#[cfg(test)]
mod tests;
