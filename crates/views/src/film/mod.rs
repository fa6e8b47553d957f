//! Writes frames as one self-contained HTML page that plays them: discs, or a slice through
//! spheres, with contacts, a tracker's builds, and the contacts that it missed.

mod page;

pub use page::html;

use std::collections::HashMap;

use anyhow::{bail, ensure};

use crate::draw::bodies::particles;
use crate::draw::plane::{Circle, Plane};
use crate::draw::{Highlighted, Slice};
use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_terms::number::{number, plural};

/// Maximum size of a page in bytes, because larger pages open slowly.
pub const MOST_BYTES: usize = 5_000_000;
/// Maximum number of circles in a frame, because the page numbers them with 16 bits.
pub const MOST_CIRCLES: usize = 20_000;
/// Bytes on the page: for a circle of constant radius and any other circle, then for a pair. A
/// number has 16 bits; base64 needs four letters for three bytes.
const CIRCLE: [usize; 2] = [6, 8];
const PAIR: usize = 6;
/// Further bytes on the page: for a circle and a pair of the first picture, for a frame, and for a
/// page without frames.
const DRAWN: [usize; 2] = [64, 40];
const FRAME: usize = 64;
const EMPTY: usize = 20_000;

#[derive(Default)]
pub struct Film {
    title: String,
    motion: String,
    /// The tracker whose builds and misses are shown.
    tracker: String,
    slice: Option<Slice>,
    frames: Vec<Frame>,
    space: bool,
    /// True if radii change after the first frame.
    own_radii: bool,
    particles: usize,
    factor: f64,
    circles: usize,
    pairs: usize,
}

struct Frame {
    circles: Vec<Circle>,
    /// Indices into `circles`: the reported pairs, then the missed ones.
    pairs: Vec<[u16; 2]>,
    missed_here: usize,
    /// Numbers of contacts and of missed contacts, of all particles.
    contacts: usize,
    missed: usize,
    built: bool,
}

impl Film {
    /// Makes a film without frames. Spheres are cut at the given plane, else through the middle of
    /// the first frame.
    pub fn new(title: &str, motion: &str, tracker: &str, slice: Option<Slice>) -> Film {
        let [title, motion, tracker] = [title, motion, tracker].map(String::from);
        Film { title, motion, tracker, slice, ..Film::default() }
    }

    /// Adds a frame with its contacts, the missed contacts, and whether the list was built in it.
    /// Fails beyond [`MOST_BYTES`] or [`MOST_CIRCLES`], for a slice of discs, and for a frame whose
    /// scale differs from that of the first.
    pub fn take(
        &mut self,
        periodic: &Periodic<'_>,
        pairs: &Highlighted,
        built: bool,
    ) -> anyhow::Result<()> {
        let (k, scene) = (self.frames.len(), periodic.scene());
        self.space = scene.dim() == 3;
        ensure!(
            self.space || self.slice.is_none(),
            "a slice was asked for, but the scene is of discs; leave out --slice"
        );
        let plane = Plane::new(&particles(scene), scene.dim(), self.slice, scene.len());
        self.slice = plane.slice;
        if k == 0 {
            (self.particles, self.factor) = (scene.len(), plane.factor);
        }
        ensure!(
            plane.factor == self.factor,
            "frame {k} is of another scale than the first; take the frames before (--frames)"
        );
        let circles = plane.circles().count();
        ensure!(
            circles <= MOST_CIRCLES,
            "{circles} particles are too many to be seen moving; at most {MOST_CIRCLES} are \
             played: take fewer{}",
            if self.space { ", or another slice" } else { "" }
        );
        let first = self.frames.first();
        let radii = plane.circles().map(|circle| circle.r);
        let others = first.is_some_and(|first| !first.circles.iter().map(|it| it.r).eq(radii));
        self.own_radii |= self.space || others;
        let places: HashMap<u32, u16> = plane.circles().map(|circle| circle.id).zip(0..).collect();
        let place = |particle: u32| places.get(&particle).copied();
        let shown = |pairs: &[ImagePair]| -> Vec<[u16; 2]> {
            pairs.iter().filter_map(|pair| Some([place(pair.i)?, place(pair.j)?])).collect()
        };
        let (shown_contacts, shown_missed) = (shown(&pairs.contacts), shown(&pairs.missed));
        self.circles += circles;
        self.pairs += shown_contacts.len() + shown_missed.len();
        self.frames.push(Frame {
            missed_here: shown_missed.len(),
            pairs: [shown_contacts, shown_missed].concat(),
            circles: plane.circles().copied().collect(),
            contacts: pairs.contacts.len() + pairs.missed.len(),
            missed: pairs.missed.len(),
            built,
        });
        let megabytes = MOST_BYTES / 1_000_000;
        match k {
            _ if self.bytes() <= MOST_BYTES => Ok(()),
            0 | 1 => {
                bail!("two frames are a page of more than {megabytes} MB; take fewer particles")
            }
            _ => bail!(
                "a page of at most {megabytes} MB holds {k} such frames; take --frames {k}, or \
                 fewer particles"
            ),
        }
    }

    fn bytes(&self) -> usize {
        let circle = CIRCLE[usize::from(self.own_radii)];
        let first = self.frames.first();
        let drawn = first.map_or([0, 0], |first| [first.circles.len(), first.pairs.len()]);
        EMPTY
            + FRAME * self.frames.len()
            + circle * self.circles
            + PAIR * self.pairs
            + DRAWN[0] * drawn[0]
            + DRAWN[1] * drawn[1]
    }

    pub fn summary(&self) -> String {
        let Film { tracker, particles, motion, .. } = self;
        let what = if self.space { "spheres" } else { "discs" };
        let built = self.frames.iter().filter(|frame| frame.built).count();
        let missed: usize = self.frames.iter().map(|frame| frame.missed).sum();
        let slice = self.slice.filter(|_| self.space).map_or(String::new(), |slice| {
            format!(", slice {} = {}", slice.name(), number(slice.at))
        });
        let frames = plural(self.frames.len(), "frame");
        let missed = match self.frames.iter().position(|frame| frame.missed > 0) {
            None => "missed no contact".into(),
            Some(first) => format!("missed {} since frame {first}", plural(missed, "contact")),
        };
        format!(
            "{particles} {what}{slice}, {motion}, {frames}. {tracker} built in {built} of them \
             and {missed}."
        )
    }
}
