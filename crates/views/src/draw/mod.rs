//! Pictures of scenes: discs, or a slice through spheres, with their contacts and the errors of a
//! detector.
//!
//! ```
//! use contactbench_io::pairs::List;
//! use contactbench_scenes::spec::Spec;
//! use contactbench_scenes::touching::in_any_box;
//! use contactbench_views::draw::{self, Highlighted, Look};
//!
//! let scene = in_any_box(&Spec::parse("packed:n=50")?.given()?)?;
//! let list = List { pairs: vec![[0, 1]], ..List::default() }; // by some detector, in any order
//! let pairs = Highlighted::compare(&scene, &list, 1 << 30)?;
//! let picture = draw::svg(&scene, &pairs, &Look::titled("what it missed"))?;
//! assert!(picture.contains("missed"));
//! # Ok::<(), anyhow::Error>(())
//! ```
//!
//! Open space is drawn as a box that is periodic along no vector. Lengths in the picture are
//! relative to the scene's extent, so that offsets and scales do not matter. Particles are numbered
//! from 0.
//!
//! * `pairs`: pairs to be drawn; `bodies`: particles, and the images that a pair touches.
//! * `plane`: spheres become circles in the plane of the slice; `outline`: the faces of the box.
//! * `page_coordinates`: from lengths of the scene to pixels; `sheet`: the picture.

pub(super) mod bodies;
mod outline;
pub(super) mod page_coordinates;
mod pairs;
pub(super) mod plane;
mod sheet;

use anyhow::{bail, ensure};
use bodies::Bodies;
pub use pairs::Highlighted;
use plane::Plane;
pub use plane::Slice;
use sheet::Sheet;

use contactbench_ground::periodic::Periodic;
use contactbench_terms::number::number;

/// Maximum number of particles in a picture. More would look like a grey surface, and few viewers
/// could open the file.
pub const MOST_PARTICLES: usize = 200_000;
/// Maximum number of lines between particles.
pub const MOST_LINES: usize = 2_000_000;
/// Maximum number of particles that are labelled by default.
pub const LABELLED: usize = 60;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    pub title: String,
    /// Whether particles are labelled; by default only if there are at most [`LABELLED`].
    pub labels: Option<bool>,
    pub grid: bool,
    /// Plane that cuts spheres; by default through the worst error of a list, else through the
    /// middle along z.
    pub slice: Option<Slice>,
    /// Shows the whole scene, even if the worst error is too small to be seen.
    pub whole: bool,
}

impl Look {
    pub fn titled(title: impl Into<String>) -> Look {
        Look { title: title.into(), ..Look::default() }
    }
}

/// Returns the picture as SVG. Fails for more than [`MOST_PARTICLES`] particles or [`MOST_LINES`]
/// pairs in the plane, for a slice of discs, for a slice that meets no sphere, and for the grid of
/// a periodic box.
pub fn svg(periodic: &Periodic<'_>, pairs: &Highlighted, look: &Look) -> anyhow::Result<String> {
    ensure!(
        !look.grid || !periodic.lattice().repeats(),
        "--grid shows the cells of open boundaries, and the box repeats; leave it out, or give \
         --open"
    );
    let (dim, count) = (periodic.scene().dim(), periodic.scene().len());
    ensure!(
        dim == 3 || look.slice.is_none(),
        "a slice was asked for, but the scene is of discs; leave out --slice"
    );
    if let Some(pair) = pairs.all().find(|pair| pair.j as usize >= count) {
        bail!("the pair {pair}: the scene has {count} particles, numbered from 0");
    }
    let bodies = Bodies::new(periodic, pairs.all())?;
    let worst = pairs.worst(periodic).and_then(|pair| bodies.lines(pair).last());
    let through = worst.map(|pair| Slice::through(pair.map(|k| &bodies.all[k as usize])));
    let mut plane = Plane::new(&bodies.all, dim, look.slice.or(through), count);
    if let (Some(slice), true, 1..) = (look.slice, plane.circles().next().is_none(), count) {
        let [low, high] = slice.range(&bodies.all).map(number);
        bail!(
            "no sphere meets the slice {axis}={}; {axis} goes from {low} to {high}",
            slice.at,
            axis = slice.name()
        );
    }
    let detail = worst.filter(|pair| !look.whole && sheet::too_small(&plane, *pair));
    if let Some(pair) = detail {
        plane.zoom(pair);
    }
    ensure!(
        plane.circles().count() <= MOST_PARTICLES,
        "{} particles are too many to be seen; at most {MOST_PARTICLES} are drawn: draw a part of \
         the scene{}",
        plane.circles().count(),
        if dim == 3 { ", or another slice" } else { "" }
    );
    let lines = pairs.all().flat_map(|pair| bodies.lines(*pair));
    let lines = lines.filter(|pair| pair.iter().all(|&k| plane.circle(k).is_some())).count();
    ensure!(
        lines <= MOST_LINES,
        "{lines} pairs are too many to be seen; at most {MOST_LINES} are drawn: draw a part of the \
         scene, or are the radii in another unit than the coordinates?"
    );
    let (bodies, plane) = (&bodies, &plane);
    Ok(Sheet { periodic, bodies, plane, pairs, look, detail }.svg())
}
