//! Radii for a wanted number of neighbours: the same places, the same ratios of sizes.
//!
//! All radii are multiplied by one factor. Two particles touch if the factor is at least their
//! distance over the sum of their radii. So the factor lies between two such quotients: those of
//! the last pair that should touch and of the next. Quotients that differ by rounding, as in the
//! shells of a lattice, are not separated, and no pair of the result just touches.

use anyhow::{bail, ensure};

use crate::generate::table::{Parameter, ParameterKind, optional};
use crate::stats::stats;
use crate::touching::{in_any_box, particle};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::pairs::pair_list::PAIR_BYTES;
use contactbench_ground::periodic::{ContactList, Periodic};
use contactbench_io::Given;
use contactbench_lists::periodic::Finder;
use contactbench_streamed::streamed;

pub const NEIGHBOURS: Parameter = optional(
    "neighbours",
    ParameterKind::POSITIVE,
    "mean number of contacts per particle: all radii are multiplied by one factor to get it",
);

/// Relative difference of squares below which distances count as equal.
const SHELL: f64 = 1e-9;
/// Quotient by which a search reaches further than the estimate.
const FURTHER: f64 = 1.05;
const MOST_SEARCHES: usize = 100;

/// Scales the radii so that the mean number of contacts per particle is as near as possible to
/// `wanted`; of two numbers equally near, the larger is taken.
///
/// # Errors
/// Fails if there are too few particles in open space, or if the pairs take too much memory.
pub fn scaled(given: Given, wanted: f64) -> anyhow::Result<Given> {
    let n = given.scene.len() as f64;
    if n == 0.0 {
        return Ok(given);
    }
    let (periodic, options) = (in_any_box(&given)?, Options::default());
    let (most, open) = (n - 1.0, periodic.lattice().periodic() == [false; 3]);
    ensure!(wanted <= most || !open, "neighbours is {wanted}; in open space at most {most}");
    let (pairs, limit) = (0.5 * wanted * n, options.memory_limit);
    ensure!(
        FURTHER * pairs * PAIR_BYTES as f64 <= limit as f64,
        "neighbours is {wanted}: {pairs:.3e} pairs take more than {limit} bytes; take fewer"
    );
    let factor = factor(&periodic, pairs, stats(&given, 0).packing_fraction, options)?;
    let (scene, _) = periodic.resized(|r| r * factor)?.into_parts();
    // The radii are no longer those of a file, so their size gives no reason for doubts.
    Ok(Given { scene, source: None, ..given })
}

/// Returns the factor for about this many pairs, found among the pairs of a scene with larger
/// radii.
fn factor(
    periodic: &Periodic<'_>,
    pairs: f64,
    fraction: f64,
    options: Options,
) -> anyhow::Result<f64> {
    let (mut detector, mut finder) =
        (streamed(None, None, options), Finder::new(options.memory_limit));
    // Random particles that fill this fraction have 4 or 8 times as many neighbours.
    let ratio = 2.0 * pairs / periodic.scene().len() as f64 / fraction;
    let reach =
        if periodic.scene().dim() == 2 { (ratio / 4.0).sqrt() } else { libm::cbrt(ratio) / 2.0 };
    let mut reach = if reach.is_finite() { reach * FURTHER } else { 1.0 };
    let last = (pairs.round() as usize).max(1) - 1;
    for _ in 0..MOST_SEARCHES {
        let (larger, mut found) = (periodic.resized(|r| r * reach)?, ContactList::default());
        finder.list(&larger, &mut *detector, Arithmetic::Exact, &mut found)?;
        let mut squares = squares(periodic, &found);
        let more = libm::cbrt(pairs / squares.len() as f64).clamp(1.0, 2.0) * FURTHER;
        if squares.len() > last {
            let shell = *squares.select_nth_unstable_by(last, f64::total_cmp).1;
            let [low, high] = [shell * (1.0 - SHELL), shell * (1.0 + SHELL)];
            let below = squares.iter().filter(|&&square| square < low).count() as f64;
            let within = squares.iter().filter(|&&square| square <= high).count() as f64;
            let border = if within - pairs <= pairs - below { high } else { low };
            let inside = squares.iter().copied().filter(|&it| it <= border).fold(0.0, f64::max);
            let outside =
                squares.iter().copied().filter(|&it| it > border).fold(reach * reach, f64::min);
            if outside > inside * (1.0 + SHELL) {
                return Ok((0.5 * (inside + outside)).sqrt());
            }
        }
        reach *= more;
    }
    bail!("no radii give {pairs:.3e} pairs; the largest radius must be over 0")
}

/// Returns the squares of distance over sum of radii of all contacts.
fn squares(periodic: &Periodic<'_>, contacts: &ContactList) -> Vec<f64> {
    let (scene, vectors) = (periodic.scene(), periodic.lattice().vectors());
    let square = |[i, j]: [u32; 2], image: [i32; 3]| {
        let [(a, ra), (b, rb)] = [i, j].map(|k| particle(scene, k));
        let shift = |k: usize| (0..3).map(|v| f64::from(image[v]) * vectors[v][k]).sum::<f64>();
        let square = (0..3).map(|k| a[k] - b[k] - shift(k)).map(|x| x * x).sum::<f64>();
        square / ((ra + rb) * (ra + rb))
    };
    let plain = contacts.plain.iter().map(|&pair| square(pair, [0; 3]));
    plain.chain(contacts.shifted.iter().map(|it| square([it.i, it.j], it.image))).collect()
}
