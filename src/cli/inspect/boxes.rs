//! Output of `inspect`: the box of a file.

use serde_json::json;

use crate::cli::shared::input::Input;
use crate::cli::shared::output::Output;
use contactbench_ground::periodic::Periodic;
use contactbench_ground::scene::{Lattice, Real};
use contactbench_ground::with_scene;
use contactbench_io::boxes::{along, outside};
use contactbench_io::{About, Particles};
use contactbench_terms::number::{number, plural};

/// Prints the box in the file, and the box that is used.
pub(super) fn report(particles: &Particles, about: &About, input: &Input, out: &mut Output) {
    let declared = about.declared.as_ref();
    let vectors = declared.and_then(|declared| declared.vectors);
    if let Some(bounds) = declared.and_then(|declared| declared.ranges.as_ref()) {
        let text: Vec<String> =
            bounds.iter().map(|[lo, hi]| format!("{} to {}", number(*lo), number(*hi))).collect();
        out.line("box in the file", text.join(", "), json!({ "declared_box": bounds }));
    } else if let Some(vectors) = vectors {
        out.line("box in the file", rows(&vectors), json!({ "declared_vectors": vectors }));
    }
    let (dim, flags) = (particles.dim(), declared.map(|declared| declared.periodic));
    let Some(lattice) = &particles.lattice else {
        let why = match flags {
            _ if input.boundaries.open => "open (--open)",
            _ if input.boundaries.periodic.is_some() => "open (--periodic none)",
            Some(Some(_)) => "open, as in the file",
            Some(None) if vectors.is_some() => {
                "taken as open: the file does not define whether its box repeats"
            }
            _ => "open: there is no box in the file",
        };
        out.line("boundaries", why, json!({ "periodic": vec![false; dim] }));
        return;
    };
    let axes = lattice.periodic();
    let source = match input.boundaries.periodic {
        Some(_) => " (--periodic)",
        None if matches!(flags, Some(Some(_))) => ", as in the file",
        None => " (--box)",
    };
    let text = format!("the box repeats along {}{source}", along(axes));
    out.line("boundaries", text, json!({ "periodic": axes[..dim] }));
    lattice_of(particles, lattice, input, out);
}

fn lattice_of(particles: &Particles, lattice: &Lattice, input: &Input, out: &mut Output) {
    let dim = particles.dim();
    let all = lattice.vectors();
    let vectors: Vec<&[f64]> = all[..dim].iter().map(|vector| &vector[..dim]).collect();
    let length = |v: &&[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let lengths: Vec<f64> = vectors.iter().map(length).collect();
    let heights: Vec<f64> = (0..dim).map(|k| lattice.height(k)).collect();
    let origin = &lattice.origin()[..dim];
    let shape = if lattice.is_tilted() { "tilted" } else { "edges along the axes" };
    out.line(
        "box",
        format!(
            "vectors {}{}, lengths {}, {shape}; corner {}",
            rows(&vectors),
            if input.boundaries.edges.is_some() { " (--box)" } else { "" },
            list(&lengths),
            list(origin)
        ),
        json!({
            "box_vectors": vectors,
            "box_lengths": lengths,
            "box_tilted": lattice.is_tilted(),
            "box_origin": origin,
            "box_heights": heights,
        }),
    );
    let outside = outside((0..particles.len()).map(|k| particles.centre(k)), lattice);
    let first = outside.first().map(|first| format!(", such as particle {first} (from 0)"));
    let such = first.unwrap_or_default();
    let text = format!("{}{such}", plural(outside.len(), "particle"));
    out.line("outside the box", text, json!({ "outside": outside.len() }));
}

/// Prints the distances between the faces of the box, and the reach of contacts. Warns of a box so
/// small that a particle touches several images of another.
pub(super) fn reach(periodic: &Periodic<'_>, out: &mut Output) {
    let (scene, lattice) = (periodic.scene(), periodic.lattice());
    let reach = 2.0 * with_scene!(scene, scene => scene.largest_radius().wide());
    let axes = (0..3).filter(|&k| lattice.periodic()[k]);
    let heights: Vec<(&str, f64)> = axes.map(|k| (["x", "y", "z"][k], lattice.height(k))).collect();
    let text: Vec<String> =
        heights.iter().map(|(axis, height)| format!("{axis} {}", number(*height))).collect();
    let least = heights.iter().map(|(_, height)| *height).fold(f64::INFINITY, f64::min) / reach;
    let times = format!(" (ratio at least {})", number(least));
    let times = if least.is_finite() { &times } else { "" };
    out.line(
        "between faces",
        format!("{}; contacts reach {} at most{times}", text.join(", "), number(reach)),
        json!({ "reach": reach, "least_height_over_reach": least }),
    );
    // The heights of the box are rounded, so a small tolerance avoids a false warning.
    let narrow = |times: f64| {
        let axes = heights.iter().filter(|(_, height)| *height <= times * reach * (1.0 + 1e-12));
        axes.map(|(axis, _)| *axis).collect::<Vec<_>>().join(", ")
    };
    match (narrow(1.0), narrow(2.0)) {
        (own, _) if !own.is_empty() => out.warn(format!(
            "the box is so small along {own} that a particle may touch its own image"
        )),
        (_, several) if !several.is_empty() => out.warn(format!(
            "the box is so small along {several} that two particles may touch through several \
             images; codes that test only the nearest image miss some"
        )),
        _ => {}
    }
}

fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|&x| number(x)).collect::<Vec<_>>().join(" ")
}

fn rows<V: AsRef<[f64]>>(vectors: &[V]) -> String {
    let rows: Vec<String> = vectors.iter().map(|v| format!("({})", list(v.as_ref()))).collect();
    rows.join(" ")
}
