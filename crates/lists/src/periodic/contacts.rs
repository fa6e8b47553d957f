//! Finds the contacts of one periodic scene.

use super::Finder;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic};

/// Returns all contacts in ascending order. Images and the list may take `limit` bytes each.
///
/// # Errors
/// Fails as [`Finder::list`], and with [`Refusal::Pairs`] if there are more contacts than fit.
pub fn contacts(
    periodic: &Periodic<'_>,
    detector: &mut dyn AnyDetector,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Vec<ImagePair>, Refusal> {
    let mut contacts = ContactList::default();
    Finder::new(limit).list(periodic, detector, arithmetic, &mut contacts)?;
    contacts.sorted(periodic.scene().len(), limit)
}
