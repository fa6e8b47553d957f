//! The contacts of a periodic scene, by any detector, call after call.

use super::contacts::{Contacts, List};
use super::images::Images;
use super::{ImagePair, Periodic};
use crate::contact::{Approximate, Arithmetic};
use crate::detect::any::AnyDetector;
use crate::pair_list::{Allowance, PairList};
use crate::probe::{Op, Probe, Tally};
use crate::refusal::Refusal;
use crate::scene::{AnyScene, Scene};
use crate::sink::Sink;

/// Finds contacts in boxes by a detector, call after call: it keeps its buffers.
pub struct Finder {
    /// In bytes.
    limit: u64,
    formula: u64,
    images: u64,
}

impl Finder {
    /// Images may take so many bytes, and each list of contacts as many.
    pub fn new(limit: u64) -> Finder {
        Finder { limit, formula: 0, images: 0 }
    }

    /// The complete list of contacts, appended: what is timed.
    ///
    /// # Errors
    /// What the detector refuses for the scene with its images, what
    /// [`Images::new`](super::images::Images::new) does, [`Refusal::Pairs`] if there are more
    /// contacts than a list may hold, [`Refusal::Stored`] if a rounded arithmetic cannot hold the
    /// images; `contacts` is then as it was.
    pub fn list(
        &mut self,
        periodic: &Periodic<'_>,
        detector: &mut dyn AnyDetector,
        arithmetic: Arithmetic,
        contacts: &mut Contacts,
    ) -> Result<(), Refusal> {
        self.count(periodic, detector, arithmetic, &mut Tally::default(), contacts)
    }

    /// As [`Finder::list`], and counts every operation, the images that are made among them.
    ///
    /// # Errors
    /// As [`Finder::list`].
    pub fn count(
        &mut self,
        periodic: &Periodic<'_>,
        detector: &mut dyn AnyDetector,
        arithmetic: Arithmetic,
        tally: &mut Tally,
        contacts: &mut Contacts,
    ) -> Result<(), Refusal> {
        let search = Search { finder: self, periodic, detector, arithmetic, tally, contacts };
        match periodic.scene() {
            AnyScene::Plane(scene) => search.among(&scene.widened()),
            AnyScene::Space(scene) => search.among(&scene.widened()),
        }
    }

    /// The bytes that images take by the formula, for the scene of the last call.
    pub fn formula_bytes(&self) -> u64 {
        self.formula
    }

    /// How many images were made in the last call.
    pub fn images(&self) -> u64 {
        self.images
    }
}

struct Search<'a> {
    finder: &'a mut Finder,
    periodic: &'a Periodic<'a>,
    detector: &'a mut dyn AnyDetector,
    arithmetic: Arithmetic,
    tally: &'a mut Tally,
    contacts: &'a mut Contacts,
}

impl Search<'_> {
    fn among<const D: usize>(self, scene: &Scene<'_, f64, D>) -> Result<(), Refusal>
    where
        AnyScene<'static>: From<Scene<'static, f64, D>>,
    {
        let Search { finder, periodic, detector, arithmetic, tally, contacts } = self;
        let (images, open) = Images::new(scene, periodic.lattice(), arithmetic, finder.limit)?;
        let open = AnyScene::from(open);
        finder.images = images.ghosts();
        tally.add(Op::GhostMade, images.ghosts());
        let allowance = Allowance::new(finder.limit);
        let plain = PairList::behind(std::mem::take(&mut contacts.plain), &allowance);
        let shifted = List::behind(std::mem::take(&mut contacts.shifted), finder.limit);
        let mut sorted = Sorted { images: &images, plain, shifted };
        let result = if arithmetic == Arithmetic::Exact {
            let decide = |a, b| images.touch(a, b);
            let (slack, owners) = (images.slack(), scene.len() as u32);
            let bodies = Approximate { scene: &open, slack, owners, decide: &decide };
            detector.approximate(bodies, tally, &mut sorted)
        } else {
            stored(&open, arithmetic)
                .and_then(|stored| detector.count(&stored, arithmetic.test(), tally, &mut sorted))
        };
        let Sorted { plain, shifted, .. } = sorted;
        contacts.end(plain, shifted, scene.len(), result)
    }
}

/// Contacts of bodies, sorted into those of particles and those with images.
struct Sorted<'a, const D: usize> {
    images: &'a Images<'a, D>,
    plain: PairList<'a>,
    shifted: List,
}

impl<const D: usize> Sink for Sorted<'_, D> {
    fn contact(&mut self, a: u32, b: u32) {
        match self.images.pair(a, b) {
            Some(ImagePair { i, j, image: [0, 0, 0] }) => self.plain.contact(i, j),
            Some(pair) => self.shifted.push(pair),
            None => {}
        }
    }
}

/// The scene with its images as a rounded arithmetic stores it.
pub(super) fn stored(
    open: &AnyScene<'_>,
    arithmetic: Arithmetic,
) -> Result<AnyScene<'static>, Refusal> {
    let arithmetic_name = arithmetic.name();
    open.stored(arithmetic).map_err(|error| Refusal::Stored { arithmetic: arithmetic_name, error })
}
