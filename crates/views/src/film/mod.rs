//! Frames as one HTML page that plays them and needs nothing else: discs or a slice through spheres
//! with their contacts, when a tracker built its list, and what it missed.

mod page;

pub use page::html;

use std::collections::HashMap;

use anyhow::{bail, ensure};

use crate::draw::bodies::particles;
use crate::draw::plane::{Circle, Plane};
use crate::draw::{Highlighted, Slice};
use contactbench_core::periodic::{ImagePair, Periodic};
use contactbench_terms::number::{number, plural};

/// The largest page, in bytes: larger ones are slow to open.
pub const MOST_BYTES: usize = 5_000_000;
/// The most circles of a frame: their numbers have 16 bits, and more are not seen while they move.
pub const MOST_CIRCLES: usize = 20_000;
/// Bytes of the page for a circle whose radius stays, for one whose does not, and for a pair: 16
/// bits for each number, four letters for three bytes.
const CIRCLE: [usize; 2] = [6, 8];
const PAIR: usize = 6;
/// Bytes of the first frame's picture, as text, for a circle and for a pair; bytes of a frame; and
/// bytes of the page without frames.
const DRAWN: [usize; 2] = [64, 40];
const FRAME: usize = 64;
const EMPTY: usize = 20_000;

/// Frames that are to be played.
#[derive(Default)]
pub struct Film {
    title: String,
    motion: String,
    /// The tracker whose builds and misses are shown.
    tracker: String,
    slice: Option<Slice>,
    frames: Vec<Frame>,
    space: bool,
    /// Circles have other radii than in the first frame.
    own_radii: bool,
    particles: usize,
    factor: f64,
    /// Number of circles in all frames.
    circles: usize,
    /// Number of pairs in all frames.
    pairs: usize,
}

struct Frame {
    circles: Vec<Circle>,
    /// Pairs of places in that list: those that were reported, and behind them those that were
    /// missed.
    pairs: Vec<[u16; 2]>,
    /// How many of those were missed.
    missed_here: usize,
    /// Contacts of all particles, and those that were missed.
    contacts: usize,
    missed: usize,
    built: bool,
}

impl Film {
    /// Without frames. Spheres are cut where it is said, else through the middle of the first
    /// frame.
    pub fn new(title: &str, motion: &str, tracker: &str, slice: Option<Slice>) -> Film {
        let [title, motion, tracker] = [title, motion, tracker].map(String::from);
        Film { title, motion, tracker, slice, ..Film::default() }
    }

    /// One more frame, with its contacts and what was missed of them, and whether the list was
    /// built in it.
    ///
    /// # Errors
    /// A page of more than [`MOST_BYTES`], more than [`MOST_CIRCLES`] in a frame, a slice through
    /// discs, and a frame of another scale than the first.
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
            0 | 1 => bail!("two frames are a page of more than {megabytes} MB; take fewer bodies"),
            _ => bail!(
                "a page of at most {megabytes} MB holds {k} such frames; take --frames {k}, or \
                 fewer bodies"
            ),
        }
    }

    /// The size of the page, about.
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

    /// What there is to see, in a sentence.
    pub fn summary(&self) -> String {
        let Film { tracker, particles, motion, .. } = self;
        let bodies = if self.space { "spheres" } else { "discs" };
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
            "{particles} {bodies}{slice}, {motion}, {frames}. {tracker} built in {built} of them \
             and {missed}."
        )
    }
}
