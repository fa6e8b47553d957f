//! Pictures of scenes: discs, or a slice through spheres, with their contacts, and what a detector
//! got wrong.
//!
//! ```
//! use contactbench::present::draw::{self, Highlighted, Look};
//! use contactbench::scene::spec::Spec;
//!
//! let scene = Spec::parse("packed:n=50")?.make()?;
//! let reported = [[0, 1]]; // by some detector, in any order
//! let pairs = Highlighted::compare(&scene, &reported)?;
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
//! * `page_coordinates`: from lengths of the scene to pixels; `sheet`: the picture.

mod flat;
mod page_coordinates;
mod pairs;
mod sheet;

use anyhow::ensure;
pub use flat::Slice;
pub use pairs::{Highlighted, find, read};

use crate::contact::Arithmetic;
use crate::scene::AnyScene;

/// The largest number of particles that is drawn: more are a grey surface, and a file that no
/// viewer opens.
pub const MOST_PARTICLES: usize = 200_000;
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
    /// Where spheres are cut; if not said, through the middle along z.
    pub slice: Option<Slice>,
}

impl Look {
    /// With a title, and nothing else said.
    pub fn titled(title: impl Into<String>) -> Look {
        Look { title: title.into(), ..Look::default() }
    }
}

/// The picture as SVG. Refuses more than [`MOST_PARTICLES`] particles in the plane or the
/// slice, pairs of particles that the scene does not have, and a slice through discs.
pub fn svg(scene: &AnyScene<'_>, pairs: &Highlighted, look: &Look) -> anyhow::Result<String> {
    ensure!(
        scene.dim() == 3 || look.slice.is_none(),
        "a slice was asked for, but the scene is of discs; leave out --slice"
    );
    pairs.check(scene.len())?;
    let scene = scene.stored(Arithmetic::F64)?;
    let flat = flat::Flat::new(&scene, look.slice);
    ensure!(
        flat.circles.len() <= MOST_PARTICLES,
        "{} particles are too many to be seen; at most {MOST_PARTICLES} are drawn: draw a part of \
         the scene{}",
        flat.circles.len(),
        if scene.dim() == 3 { ", or another slice" } else { "" }
    );
    Ok(sheet::Sheet::new(&scene, &flat, pairs, look).draw())
}
