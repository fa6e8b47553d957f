//! Pictures of scenes as SVG: discs, or a slice through spheres, with their contacts and the errors
//! of a list of pairs.
//!
//! ```
//! use contactbench_ground::periodic::ImagePair;
//! use contactbench_scenes::spec::Spec;
//! use contactbench_scenes::touching::in_any_box;
//! use contactbench_views::draw::{self, Look, Pairs};
//!
//! let scene = in_any_box(&Spec::parse("packed:n=50")?.given()?)?;
//! let pairs = Pairs { missed: vec![ImagePair::new(0, 1, [0; 3])], ..Pairs::default() };
//! let picture = draw::svg(&scene, &pairs, &Look { title: "example".into(), ..Look::default() })?;
//! assert!(picture.contains("missed"));
//! # Ok::<(), anyhow::Error>(())
//! ```
//!
//! * `pairs`: the pairs that are drawn; `particles`: particles, and the images that a pair touches.
//! * `plane`: circles in the drawn plane; `sheet`: the picture.

mod pairs;
mod particles;
mod plane;
mod sheet;

use anyhow::{bail, ensure};
pub use pairs::Pairs;
use particles::Particles;
use plane::Plane;
pub use plane::Slice;
use sheet::Sheet;

use contactbench_ground::periodic::Periodic;
use contactbench_terms::number::number;

/// Maximum number of particles in a picture, because few viewers could open a larger file.
pub const MOST_PARTICLES: usize = 200_000;
/// Maximum number of lines between particles.
pub const MOST_LINES: usize = 2_000_000;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    pub title: String,
    /// Plane that cuts spheres; by default through the worst error of a list, else through the
    /// middle along z.
    pub slice: Option<Slice>,
    /// Shows the whole scene, even if the worst error is too small to be seen.
    pub whole: bool,
}

/// Returns the picture as SVG. Fails for more than [`MOST_PARTICLES`] particles or [`MOST_LINES`]
/// pairs in the plane, for a slice of discs, and for a slice that meets no sphere.
pub fn svg(periodic: &Periodic<'_>, pairs: &Pairs, look: &Look) -> anyhow::Result<String> {
    let (dim, count) = (periodic.scene().dim(), periodic.scene().len());
    ensure!(dim == 3 || look.slice.is_none(), "a slice cuts spheres, not discs; leave out --slice");
    if let Some(pair) = pairs.all().find(|pair| pair.j as usize >= count) {
        bail!("the pair {pair}: the scene has {count} particles, numbered from 0");
    }
    let particles = Particles::new(periodic, pairs.all())?;
    let worst = pairs.worst(periodic).and_then(|pair| particles.lines(pair).last());
    let through = worst.map(|pair| Slice::through(pair.map(|k| &particles.all[k as usize])));
    let mut plane = Plane::new(&particles.all, dim, look.slice.or(through), count);
    if let (Some(slice), 0, 1..) = (look.slice, plane.circles().count(), count) {
        let [low, high] = slice.range(&particles.all).map(number);
        let Slice { at, .. } = slice;
        bail!("no sphere meets the slice {0}={at}; {0} goes from {low} to {high}", slice.name());
    }
    let detail = worst.filter(|pair| !look.whole && sheet::too_small(&plane, *pair));
    if let Some(pair) = detail {
        plane.zoom(pair);
    }
    let lines = pairs.all().flat_map(|pair| particles.lines(*pair));
    let lines = lines.filter(|pair| pair.iter().all(|&k| plane.circle(k).is_some())).count();
    for (number, most, what) in
        [(plane.circles().count(), MOST_PARTICLES, "particles"), (lines, MOST_LINES, "pairs")]
    {
        ensure!(
            number <= most,
            "{number} {what} are too many to be seen; at most {most} are drawn: draw a part of the \
             scene, and check the unit of the radii"
        );
    }
    let (particles, plane) = (&particles, &plane);
    Ok(Sheet { periodic, particles, plane, pairs, look, detail }.svg())
}
