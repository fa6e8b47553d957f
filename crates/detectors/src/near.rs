//! Finds the contacts of any scene, and pairs that nearly touch.

use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::crowd;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::periodic::{ImagePair, Periodic, depth};
use contactbench_lists::periodic;

use crate::table::robust;

/// Finds all contacts in exact arithmetic, with a detector for any sizes and positions. The contact
/// list and the periodic images may take `limit` bytes each.
///
/// # Errors
/// Fails before the search if the estimated contacts exceed the limit, or if the detector refuses.
pub fn contacts(periodic: &Periodic<'_>, limit: u64) -> Result<Vec<ImagePair>, Refusal> {
    crowd::within(periodic.scene(), limit)?;
    let options = Options { memory_limit: limit, ..Options::default() };
    periodic::contacts(periodic, &mut *robust(options), Arithmetic::Exact, limit)
}

/// Returns the pairs with a positive gap of at most `part` mean radii, in order. Empty if they
/// cannot be found.
pub fn nearly(periodic: &Periodic<'_>, part: f64, limit: u64) -> Vec<ImagePair> {
    let Ok(swollen) = periodic.resized(|r| r * (1.0 + part)) else { return Vec::new() };
    let mut near = contacts(&swollen, limit).unwrap_or_default();
    near.retain(|&pair| (-part..0.0).contains(&depth(periodic, pair)));
    near
}
