//! Compares a contact list of another program with the exact truth, and explains differences.
//!
//! A list with images names each contact once, as (i, j, S). A list without images names pairs. In
//! a box, it may name each pair once, or as often as its images touch. Both are accepted, and
//! [`Verification::taken`] states which; they are the same if every pair touches through one image.
//! In open space, each contact has image 0.

mod compare;
pub mod frame;
pub mod frames;
mod listing;
mod mistake;
pub mod paired;

use compare::Against;
pub use compare::Taken;
use listing::Listing;
pub use listing::{Listed, Meaning, NamedPair, Naming};
pub use mistake::{Mistake, Reading, explain};

use crate::run::judge::{Judge, Said};
use crate::run::runner::protocol::Found;
use contactbench_detectors::near::contacts;
use contactbench_detectors::oracle::{self, Causes, Errors, NoTruth};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic};
use contactbench_io::{Given, Groups, boxes};
use contactbench_scenes::touching::gap;

/// Maximum number of kept pairs of each kind, missed or spurious, by default.
pub const WORST: usize = 100;

/// Differences between list and truth that are not errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Allowed {
    /// Whether each pair is listed as i,j and as j,i, which count as one.
    pub both_sides: bool,
    /// Largest gap of a pair that may be listed without being a contact, as a length.
    pub skin: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct Terms<'a> {
    pub arithmetic: Arithmetic,
    pub allowed: Allowed,
    pub memory_limit: u64,
    pub kept: usize,
    /// Groups of particles whose contacts are removed from truth and list.
    pub without: Option<&'a Groups>,
}

#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The particles in their box; in open space, the box has no periodic axis.
    pub space: &'a Periodic<'a>,
    pub list: Listed<'a>,
    pub naming: &'a Naming,
    /// Other interpretations of the list's numbers, which [`explain`] tries.
    pub others: &'a [Naming],
    pub terms: Terms<'a>,
}

#[derive(Clone, Debug, Default)]
pub struct Verification {
    pub truth: ContactList,
    pub errors: Errors,
    pub unknown: Vec<NamedPair>,
    /// Contacts that are not listed, with their overlap in mean radii, the deepest first.
    pub missed: Vec<(ImagePair, f64)>,
    /// Listed pairs that do not touch, with their depth in mean radii (negative), the widest gap
    /// first.
    pub spurious: Vec<(ImagePair, f64)>,
    /// Repeated pairs, at most `kept`.
    pub repeated: Vec<ImagePair>,
    /// Particles that are listed with themselves, at most `kept`.
    pub selves: Vec<ImagePair>,
    /// Pairs listed in one direction only, although both are expected.
    pub one_sided: Vec<NamedPair>,
    /// Widest gap of a spurious pair, as a length.
    pub widest_gap: f64,
    /// Number of listed pairs that do not touch but are within the skin.
    pub within_skin: u64,
    pub taken: Taken,
    pub left_out: [u64; 2],
    /// Number of particles, if the list has each of them with itself, and these pairs are left out.
    pub selves_left_out: u64,
}

impl Verification {
    pub fn is_same(&self) -> bool {
        self.wrong() == 0
    }

    pub fn wrong(&self) -> u64 {
        self.errors.wrong() + (self.unknown.len() + self.one_sided.len()) as u64
    }
}

/// Compares a list with the true contacts.
///
/// # Errors
/// Fails if there is no truth, no memory for the pairs, or an image along an open axis.
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
    let Terms { allowed: Allowed { both_sides, skin }, kept, .. } = terms;
    let listing = Listing::new(job, naming, both_sides, &truth)?;
    left_out = [left_out[0] - truth.len(), listing.left_out];
    let near = match boxed && skin > 0.0 && !listing.has_images {
        true => within(space, skin, terms.memory_limit)?,
        false => ContactList::default(),
    };
    let against = Against { space, truth: &truth, near: &near, skin, kept };
    let found = against.hold(&listing);
    let Listing { unknown, one_sided, selves: selves_left_out, .. } = listing;
    Ok(Verification { truth, unknown, one_sided, left_out, selves_left_out, ..found })
}

/// Returns errors by cause of a list whose contacts were decided in `arithmetic`; `None` without a
/// truth. A contact list may use `memory_limit` bytes. Fails if the box does not fit the scene.
pub fn causes(
    given: &Given,
    contacts: &ContactList,
    arithmetic: Arithmetic,
    memory_limit: u64,
) -> anyhow::Result<Option<Causes>> {
    let found = &Found::from(contacts.digest());
    let said = Said { arithmetic, may_miss: false, found };
    let mut judge = Judge::new(given, memory_limit)?;
    Ok(judge.judge("list", said, |_| Ok(contacts.clone()))?.0.causes)
}

/// Returns the true contacts in an arithmetic, sorted; lists may use `limit` bytes.
fn truth(space: &Periodic<'_>, arithmetic: Arithmetic, limit: u64) -> Result<ContactList, NoTruth> {
    if space.lattice().repeats() {
        return Ok(oracle::boxes::truth(space, arithmetic, limit)?.pairs.into_iter().collect());
    }
    let stored = space.scene().as_stored(arithmetic)?;
    let plain = oracle::truth_as_stored(&stored, arithmetic.test(), limit)?.pairs;
    Ok(ContactList { plain, ..ContactList::default() })
}

/// Returns all pairs whose gap is at most `most` (a length), sorted.
fn within(space: &Periodic<'_>, most: f64, limit: u64) -> anyhow::Result<ContactList> {
    // At these radii, particles touch if the gap between them is at most `most`.
    let wide = space.resized(|r| ((r + most / 2.0) * (1.0 + 1e-9)).min(f64::MAX))?;
    let near = contacts(&wide, limit)?;
    Ok(near.into_iter().filter(|&pair| gap(space, pair) <= most).collect())
}

#[cfg(test)]
mod tests;
