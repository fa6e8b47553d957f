//! What the box says.

use serde_json::json;

use crate::cli::inspect::Line;
use crate::cli::shared::input::Input;
use contactbench_core::periodic::Periodic;
use contactbench_core::scene::Real;
use contactbench_core::with_scene;
use contactbench_io::boxes::{along, outside};
use contactbench_io::{About, Particles};
use contactbench_terms::number::{number, plural};

/// Prints the box of the file, and the one that counts.
pub(super) fn report(particles: &Particles, about: &About, input: &Input, lines: &mut Vec<Line>) {
    if let Some(bounds) = about.declared.as_ref().and_then(|it| it.ranges.as_ref()) {
        let text: Vec<String> =
            bounds.iter().map(|[lo, hi]| format!("{} to {}", number(*lo), number(*hi))).collect();
        lines.push(Line("box in the file", text.join(", "), vec![("declared_box", json!(bounds))]));
    } else if let Some(vectors) = about.declared.as_ref().and_then(|declared| declared.vectors) {
        let values = vec![("declared_vectors", json!(vectors))];
        lines.push(Line("box in the file", rows(&vectors), values));
    }
    let Some(lattice) = &particles.lattice else {
        let declared = about.declared.as_ref();
        let why = match declared.map(|declared| declared.periodic) {
            _ if input.boundaries.open => "open (--open)",
            _ if input.boundaries.periodic.is_some() => "open (--periodic none)",
            Some(Some(_)) => "open, as the file says",
            Some(None) if declared.is_some_and(|declared| declared.vectors.is_some()) => {
                "taken as open: the file does not say whether its box repeats"
            }
            _ => "open: there is no box in the file",
        };
        let periodic = json!([false; 3][..particles.dim()]);
        lines.push(Line("boundaries", why.into(), vec![("periodic", periodic)]));
        return;
    };
    let dim = particles.dim();
    let axes = lattice.periodic();
    let said = about.declared.as_ref().is_some_and(|declared| declared.periodic.is_some());
    let source = match input.boundaries.periodic {
        Some(_) => " (--periodic)",
        None if said => ", as the file says",
        None => " (--box)",
    };
    lines.push(Line(
        "boundaries",
        format!("the box repeats along {}{source}", along(axes)),
        vec![("periodic", json!(axes[..dim]))],
    ));
    let vectors = &lattice.vectors()[..dim];
    let lengths: Vec<f64> =
        vectors.iter().map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt()).collect();
    let heights: Vec<f64> = (0..dim).map(|k| lattice.height(k)).collect();
    let origin = &lattice.origin()[..dim];
    let shape = if lattice.is_tilted() { "tilted" } else { "edges along the axes" };
    let vectors: Vec<&[f64]> = vectors.iter().map(|vector| &vector[..dim]).collect();
    lines.push(Line(
        "box",
        format!(
            "vectors {}{}, lengths {}, {shape}; corner {}",
            rows(&vectors),
            if input.boundaries.edges.is_some() { " (--box)" } else { "" },
            list(&lengths),
            list(origin)
        ),
        vec![
            ("box_vectors", json!(vectors)),
            ("box_lengths", json!(lengths)),
            ("box_tilted", json!(lattice.is_tilted())),
            ("box_origin", json!(origin)),
            ("box_heights", json!(heights)),
        ],
    ));
    let outside = outside((0..particles.len()).map(|k| particles.centre(k)), lattice);
    let such = match outside.first() {
        Some(first) => format!(", such as particle {first} (from 0)"),
        None => String::new(),
    };
    lines.push(Line(
        "outside the box",
        format!("{}{such}", plural(outside.len(), "particle")),
        vec![("outside", json!(outside.len()))],
    ));
}

/// Prints the distances of the box's faces against the farthest that two bodies touch; warns of
/// boxes so small that the nearest image is not all.
pub(super) fn reach(periodic: &Periodic<'_>, lines: &mut Vec<Line>, warnings: &mut Vec<String>) {
    let (scene, lattice) = (periodic.scene(), periodic.lattice());
    let reach = 2.0 * with_scene!(scene, scene => scene.largest_radius().wide());
    let axes = (0..3).filter(|&k| lattice.periodic()[k]);
    let heights: Vec<(&str, f64)> = axes.map(|k| (["x", "y", "z"][k], lattice.height(k))).collect();
    let text: Vec<String> =
        heights.iter().map(|(axis, height)| format!("{axis} {}", number(*height))).collect();
    let least = heights.iter().map(|(_, height)| *height).fold(f64::INFINITY, f64::min) / reach;
    let times = if least.is_finite() {
        format!(": at least {} times as far", number(least))
    } else {
        String::new()
    };
    lines.push(Line(
        "between faces",
        format!("{}; bodies touch over {} at most{times}", text.join(", "), number(reach)),
        vec![("reach", json!(reach)), ("least_height_over_reach", json!(least))],
    ));
    // The last places of a height are rounded: nobody is warned wrongly for want of one.
    let narrow = |times: f64| {
        let axes = heights.iter().filter(|(_, height)| *height <= times * reach * (1.0 + 1e-12));
        axes.map(|(axis, _)| *axis).collect::<Vec<_>>().join(", ")
    };
    match (narrow(1.0), narrow(2.0)) {
        (own, _) if !own.is_empty() => warnings
            .push(format!("the box is so small along {own} that a body may touch its own image")),
        (_, several) if !several.is_empty() => warnings.push(format!(
            "the box is so small along {several} that two bodies may touch through several images, \
             of which codes that look at the nearest one see one"
        )),
        _ => {}
    }
}

/// Numbers with blanks between.
fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|&x| number(x)).collect::<Vec<_>>().join(" ")
}

/// Vectors in brackets.
fn rows<V: AsRef<[f64]>>(vectors: &[V]) -> String {
    let rows: Vec<String> = vectors.iter().map(|v| format!("({})", list(v.as_ref()))).collect();
    rows.join(" ")
}
