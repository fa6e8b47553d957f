//! Pictures of scenes: discs, or a slice through spheres, with their contacts, and what a detector
//! got wrong.
//!
//! ```
//! use contactbench::present::draw::{self, Highlighted, Look};
//! use contactbench::scene::spec::Spec;
//!
//! let scene = Spec::parse("packed:n=50")?.make()?;
//! let reported = vec![[0, 1]]; // by some detector, in any order
//! let pairs = Highlighted::compare(&scene, reported, 1 << 30)?;
//! let picture = draw::svg(&scene, &pairs, &Look::titled("what it missed"))?;
//! assert!(picture.contains("missed"));
//! # Ok::<(), anyhow::Error>(())
//! ```
//!
//! Lengths in the picture are relative to the scene's extent, so that offsets and scales do not
//! matter. Particles count from 0.
//!
//! * `flat`: spheres become circles in the plane of the slice; `pairs`: what is drawn between them,
//!   and where it comes from.
//! * `boxed`: a scene that repeats, with the images that something touches; `outline`: its box.
//! * [`film`]: frames, as a page that plays them.
//! * `page_coordinates`: from lengths of the scene to pixels; `sheet`: the picture.

mod boxed;
pub mod film;
mod flat;
mod outline;
mod page_coordinates;
mod pairs;
mod sheet;

use anyhow::{bail, ensure};
pub use boxed::Boxed;
pub use flat::Slice;
pub use pairs::{Highlighted, find, without_images};

use crate::contact::Arithmetic;
use crate::number::number;
use crate::scene::AnyScene;

/// The largest number of particles that is drawn: more are a grey surface, and a file that no
/// viewer opens.
pub const MOST_PARTICLES: usize = 200_000;
/// The largest number of lines between particles.
pub const MOST_LINES: usize = 2_000_000;
/// Up to here particles are labelled with their numbers.
pub const LABELLED: usize = 60;

/// What a picture shows beside particles and pairs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    /// Stands above the picture.
    pub title: String,
    /// The numbers of the particles; if not said, up to [`LABELLED`] particles.
    pub labels: Option<bool>,
    /// The cells of a detector.
    pub grid: bool,
    /// Where spheres are cut; if not said, through the worst pair that a list got wrong, else
    /// through the middle along z.
    pub slice: Option<Slice>,
    /// All of the scene, also where what a list got wrong is too small to be seen.
    pub whole: bool,
}

impl Look {
    /// With a title, and nothing else said.
    pub fn titled(title: impl Into<String>) -> Look {
        Look { title: title.into(), ..Look::default() }
    }
}

/// The picture as SVG. Refuses more than [`MOST_PARTICLES`] particles in the plane or the slice,
/// more than [`MOST_LINES`] pairs of them, pairs of particles that the scene does not have, and a
/// slice through discs.
pub fn svg(scene: &AnyScene<'_>, pairs: &Highlighted, look: &Look) -> anyhow::Result<String> {
    pairs.check(scene.len())?;
    picture(&scene.stored(Arithmetic::F64)?, pairs, look, None)
}

/// The same of a scene in its box. Refuses the cells, which are those of an open scene.
pub fn svg_in_box(boxed: &Boxed<'_>, look: &Look) -> anyhow::Result<String> {
    ensure!(
        !look.grid,
        "--grid shows the cells of open boundaries, and the box repeats; leave it out, or give \
         --open"
    );
    picture(&boxed.scene, &boxed.pairs, look, Some(boxed))
}

fn picture(
    scene: &AnyScene<'_>,
    pairs: &Highlighted,
    look: &Look,
    boxed: Option<&Boxed<'_>>,
) -> anyhow::Result<String> {
    ensure!(
        scene.dim() == 3 || look.slice.is_none(),
        "a slice was asked for, but the scene is of discs; leave out --slice"
    );
    let worst = pairs.worst(scene);
    let through = worst.filter(|_| scene.dim() == 3).map(|pair| Slice::through(scene, pair));
    let count = boxed.map_or(scene.len(), |boxed| boxed.periodic.scene().len());
    let mut flat = flat::Flat::new(scene, look.slice.or(through), count);
    if let (Some(slice), true, 1..) = (look.slice, flat.circles.is_empty(), scene.len()) {
        let axis = ["x", "y", "z"][slice.axis.min(2)];
        let [low, high] = slice.range(scene);
        bail!(
            "no sphere meets the slice {axis}={}; {axis} goes from {} to {}",
            slice.at,
            number(low),
            number(high)
        );
    }
    let detail = worst.filter(|pair| !look.whole && sheet::too_small(&flat, *pair));
    if let Some(pair) = detail {
        flat.zoom(pair);
    }
    ensure!(
        flat.circles.len() <= MOST_PARTICLES,
        "{} particles are too many to be seen; at most {MOST_PARTICLES} are drawn: draw a part of \
         the scene{}",
        flat.circles.len(),
        if scene.dim() == 3 { ", or another slice" } else { "" }
    );
    let Highlighted { contacts, near, missed, spurious, duplicates } = pairs;
    let lines = [contacts, near, missed, spurious, duplicates].into_iter().flatten();
    let lines = lines.filter(|pair| pair.iter().all(|&k| flat.circle(k).is_some())).count();
    ensure!(
        lines <= MOST_LINES,
        "{lines} pairs are too many to be seen; at most {MOST_LINES} are drawn: draw a part of the \
         scene, or are the radii in another unit than the coordinates?"
    );
    Ok(sheet::Sheet::new(scene, &flat, pairs, look, detail, boxed).draw())
}
