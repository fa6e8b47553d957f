//! Output of `inspect`: radii, contacts and rounding errors.

use std::collections::{BTreeMap, HashSet};

use serde_json::json;

use crate::cli::shared::output::Output;
use contactbench_detectors::{near, table};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::crowd::Crowd;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::periodic::{self, ImagePair, Periodic};
use contactbench_ground::scene::{Real, array};
use contactbench_ground::with_scene;
use contactbench_io::RadiusSource;
use contactbench_io::write::counts;
use contactbench_scenes::doubts::crowded;
use contactbench_terms::number::{number, plural};

/// Pairs are near tangent if their distance differs from the sum of their radii by less than this
/// share of it.
const NEAR: f64 = 1e-9;
/// Maximum estimated number of contacts in open space; above it, `inspect` does not search them.
const MOST: f64 = 5e7;
/// How many numbers of contacts are printed; JSON has all.
const SHOWN: usize = 16;

pub(super) enum Contacts {
    Found {
        pairs: Vec<ImagePair>,
        /// Number of near-tangent pairs, touching or not.
        near: u64,
        /// Sum of the overlaps, in mean radii.
        overlap: f64,
    },
    /// Contacts per particle, if they are too many for a search or for a list.
    TooMany(f64),
    /// The reason why no detector takes the scene.
    Refused(String),
}

impl Contacts {
    /// Finds the contacts; their list may take `limit` bytes.
    pub fn new(periodic: &Periodic<'_>, limit: u64) -> Contacts {
        let n = periodic.scene().len();
        let each = Crowd::new(periodic.scene()).mean;
        if !periodic.lattice().repeats() && 0.5 * each * n as f64 > MOST {
            return Contacts::TooMany(each);
        }
        let pairs = match near::contacts(periodic, limit) {
            Ok(pairs) => pairs,
            Err(Refusal::Pairs { found, .. }) => {
                return Contacts::TooMany(2.0 * found as f64 / n as f64);
            }
            Err(Refusal::Crowd { each, .. }) => return Contacts::TooMany(each),
            Err(error) => return Contacts::Refused(error.to_string()),
        };
        let depths = pairs.iter().map(|&pair| periodic::depth(periodic, pair));
        let (near, overlap) = depths.fold((0, 0.0), |(near, sum), depth| {
            (near + u64::from(depth < 2.0 * NEAR), sum + depth)
        });
        let near = near + near::nearly(periodic, 2.0 * NEAR, limit).len() as u64;
        Contacts::Found { pairs, near, overlap }
    }

    pub fn exact(&self) -> Option<u64> {
        match self {
            Contacts::Found { pairs, .. } => Some(pairs.len() as u64),
            _ => None,
        }
    }
}

pub(super) fn report(
    periodic: &Periodic<'_>,
    source: &RadiusSource,
    contacts: &Contacts,
    out: &mut Output,
) {
    let scene = periodic.scene();
    let n = scene.len();
    if n == 0 {
        return;
    }
    let mean = radii(periodic, out);
    let each = match contacts {
        Contacts::Refused(reason) => {
            out.warn(format!("contacts were not searched: {reason}"));
            return;
        }
        Contacts::TooMany(each) => {
            let text = format!("about {each:.0} per particle, too many to list");
            out.line("contacts", text, json!({ "coordination": each }));
            *each
        }
        Contacts::Found { pairs, near, overlap } => {
            found(periodic, pairs, *near, *overlap, out);
            2.0 * pairs.len() as f64 / n as f64
        }
    };
    if let Some(doubt) = crowded(scene.dim(), each, source) {
        out.warn(doubt.to_string());
    }
    offset(periodic, mean, contacts, out);
}

/// Prints the range and the mean of the radii; returns the mean.
fn radii(periodic: &Periodic<'_>, out: &mut Output) -> f64 {
    let scene = periodic.scene();
    let radius = |k: usize| with_scene!(scene, scene => scene.radius(k).wide());
    let (mut least, mut most, mut mean) = (f64::INFINITY, 0.0f64, 0.0);
    for r in (0..scene.len()).map(radius) {
        (least, most, mean) = (least.min(r), most.max(r), mean + r / scene.len() as f64);
    }
    // Summing rounds, so the mean of equal radii is set to their value.
    mean = if least == most { least } else { mean };
    out.line(
        "radii",
        format!("smallest {}, mean {}, largest {}", number(least), number(mean), number(most)),
        json!({ "radius_min": least, "radius_mean": mean, "radius_max": most }),
    );
    mean
}

/// Prints the contacts that were found: `near` of them are near tangent, and `overlap` is the sum
/// of their overlaps.
fn found(periodic: &Periodic<'_>, pairs: &[ImagePair], near: u64, overlap: f64, out: &mut Output) {
    let count = pairs.len();
    let each = 2.0 * count as f64 / periodic.scene().len() as f64;
    let mean = if count == 0 { 0.0 } else { overlap / count as f64 };
    let across = pairs.iter().filter(|pair| pair.image != [0; 3]).count();
    let own = pairs.iter().filter(|pair| pair.i == pair.j).count();
    let boxed = periodic.lattice().repeats();
    let mut values = json!({
        "contacts": count,
        "coordination": each,
        "mean_overlap": mean,
        "boundaries": if boxed { "periodic" } else { "open" },
    });
    let mut of_box = String::new();
    if boxed {
        of_box =
            format!(", {across} of them across the box, {own} of a particle with its own image");
        (values["contacts_across"], values["contacts_own"]) = (json!(across), json!(own));
    }
    let text = format!(
        "{count} (exact; tangent particles touch){of_box}, {} per particle, mean overlap \
         {} radii",
        number(each),
        number(mean)
    );
    out.line("contacts", text, values);
    each_with(periodic.scene().len(), pairs, out);
    out.line(
        "near tangent",
        format!(
            "{} with a distance within 1e-9 of the sum of radii",
            plural(near as usize, "pair")
        ),
        json!({ "near_tangent": near }),
    );
    if near > 0 && 10 * near > count as u64 {
        out.warn(format!(
            "{} within 1e-9 of just touching: codes that round differently will disagree",
            plural(near as usize, "pair")
        ));
    }
}

/// Prints how many particles have 0, 1, 2, ... contacts.
fn each_with(n: usize, pairs: &[ImagePair], out: &mut Output) {
    // Without memory for the numbers, the line is left out, like other measures of a large scene.
    let Ok(counts) = counts(n, pairs.iter().copied()) else { return };
    let mut particles: BTreeMap<u32, usize> = BTreeMap::new();
    counts.into_iter().for_each(|count| *particles.entry(count).or_default() += 1);
    let shown = particles.iter().take(SHOWN).map(|(count, of)| format!("{of} with {count}"));
    let mut text = shown.collect::<Vec<_>>().join(", ");
    let more: usize = particles.values().skip(SHOWN).sum();
    if more > 0 {
        text += &format!(", {more} with more");
    }
    let all: Vec<_> = particles.into_iter().collect();
    out.line("per particle", text, json!({ "particles_by_contacts": all }));
}

/// Prints the distance from the origin, and the errors of f32 there.
fn offset(periodic: &Periodic<'_>, mean: f64, contacts: &Contacts, out: &mut Output) {
    let scene = periodic.scene();
    let largest = with_scene!(scene, scene => {
        let coordinates = scene.centres().iter().flat_map(array);
        coordinates.fold(0.0f64, |most, x| most.max(x.wide().abs()))
    });
    let diameters = largest / (2.0 * mean);
    if !diameters.is_finite() {
        return;
    }
    // The spacing of f32 numbers at the largest coordinate, in mean radii.
    let spacing = largest * 2f64.powi(-23) / mean;
    let mut text = format!(
        "at most {} mean diameters from the origin, where f32 numbers are {spacing:.1e} radii \
         apart",
        number(diameters)
    );
    let mut values = json!({ "offset_diameters": diameters, "f32_spacing_radii": spacing });
    if let Some([missed, spurious]) = in_f32(periodic, contacts) {
        text += &format!("; f32 would miss {} and add {spurious}", plural(missed, "contact"));
        (values["f32_missed"], values["f32_spurious"]) = (json!(missed), json!(spurious));
    }
    out.line("offset", text, values);
}

/// Returns the number of contacts that f32 would miss, and the number that it would add.
fn in_f32(periodic: &Periodic<'_>, contacts: &Contacts) -> Option<[usize; 2]> {
    let Contacts::Found { pairs, .. } = contacts else { return None };
    let (limit, mut detector) =
        (Options::default().memory_limit, table::robust(Options::default()));
    let rounded =
        contactbench_lists::periodic::contacts(periodic, &mut *detector, Arithmetic::F32, limit)
            .ok()?;
    let known: HashSet<&ImagePair> = pairs.iter().collect();
    let both = rounded.iter().filter(|pair| known.contains(pair)).count();
    Some([pairs.len() - both, rounded.len() - both])
}
