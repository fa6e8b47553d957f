//! The contacts of a periodic scene, by any detector.

use super::images::Images;
use super::{IMAGE_PAIR_BYTES, ImagePair, Periodic};
use crate::contact::{Approximate, Arithmetic};
use crate::detect::any::AnyDetector;
use crate::probe::{Op, Probe, Tally};
use crate::refusal::Refusal;
use crate::scene::{AnyScene, Scene};
use crate::sink::{Digest, Visit};

/// Hands every contact to `contact`, each once, in any order, and counts every operation, the
/// images that are made among them. They may take `limit` bytes.
///
/// # Errors
/// What the detector refuses for the scene with its images, and what [`Images::new`] does;
/// [`Refusal::Stored`] if a rounded arithmetic cannot hold it.
pub fn visit(
    periodic: &Periodic<'_>,
    detector: &mut dyn AnyDetector,
    arithmetic: Arithmetic,
    limit: u64,
    tally: &mut Tally,
    contact: &mut dyn FnMut(ImagePair),
) -> Result<(), Refusal> {
    match periodic.scene() {
        AnyScene::Plane(scene) => {
            let scene = scene.widened();
            Search { periodic, detector, arithmetic, limit, tally, contact }.among(&scene)
        }
        AnyScene::Space(scene) => {
            let scene = scene.widened();
            Search { periodic, detector, arithmetic, limit, tally, contact }.among(&scene)
        }
    }
}

/// All contacts, in ascending order. Images may take `limit` bytes, and the list as many.
///
/// # Errors
/// As [`visit`], and [`Refusal::Pairs`] if there are more contacts than that.
pub fn contacts(
    periodic: &Periodic<'_>,
    detector: &mut dyn AnyDetector,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Vec<ImagePair>, Refusal> {
    let mut list = List::new(limit);
    let mut push = |pair| list.push(pair);
    visit(periodic, detector, arithmetic, limit, &mut Tally::default(), &mut push)?;
    list.end(periodic.scene().len())
}

/// The number of contacts, their fingerprint, and the operations that it took to find them.
///
/// # Errors
/// As [`visit`].
pub fn count(
    periodic: &Periodic<'_>,
    detector: &mut dyn AnyDetector,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<(Digest, Tally), Refusal> {
    let (mut digest, mut tally) = (Digest::default(), Tally::default());
    let mut add = |ImagePair { i, j, image }| digest.image(i, j, image);
    visit(periodic, detector, arithmetic, limit, &mut tally, &mut add)?;
    Ok((digest, tally))
}

struct Search<'a> {
    periodic: &'a Periodic<'a>,
    detector: &'a mut dyn AnyDetector,
    arithmetic: Arithmetic,
    limit: u64,
    tally: &'a mut Tally,
    contact: &'a mut dyn FnMut(ImagePair),
}

impl Search<'_> {
    fn among<const D: usize>(self, scene: &Scene<'_, f64, D>) -> Result<(), Refusal>
    where
        AnyScene<'static>: From<Scene<'static, f64, D>>,
    {
        let Search { periodic, detector, arithmetic, limit, tally, contact } = self;
        let (images, open) = Images::new(scene, periodic.lattice(), arithmetic, limit)?;
        let open = AnyScene::from(open);
        tally.add(Op::GhostMade, images.ghosts());
        let mut sink = Visit(|a, b| {
            if let Some(pair) = images.pair(a, b) {
                contact(pair);
            }
        });
        if arithmetic == Arithmetic::Exact {
            let decide = |a, b| images.touch(a, b);
            let (slack, owners) = (images.slack(), scene.len() as u32);
            let bodies = Approximate { scene: &open, slack, owners, decide: &decide };
            return detector.approximate(bodies, tally, &mut sink);
        }
        let stored = stored(&open, arithmetic)?;
        detector.count(&stored, arithmetic.test(), tally, &mut sink)
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

/// A list of contacts that ends at a limit and then only counts.
pub struct List {
    pairs: Vec<ImagePair>,
    found: u64,
    /// In bytes.
    limit: u64,
}

impl List {
    /// Of so many bytes.
    pub fn new(limit: u64) -> List {
        List { pairs: Vec::new(), found: 0, limit }
    }

    /// One more.
    pub fn push(&mut self, pair: ImagePair) {
        self.found += 1;
        if self.found != self.pairs.len() as u64 + 1 {
            return;
        }
        if self.pairs.len() == self.pairs.capacity() {
            let most = usize::try_from(self.limit / IMAGE_PAIR_BYTES).unwrap_or(usize::MAX);
            let more = self.pairs.len().max(4).min(most.saturating_sub(self.pairs.len()));
            if more == 0 || self.pairs.try_reserve_exact(more).is_err() {
                self.pairs = Vec::new();
                return;
            }
        }
        self.pairs.push(pair);
    }

    /// In ascending order, of a scene of so many particles.
    ///
    /// # Errors
    /// [`Refusal::Pairs`] if there were more than fit.
    pub fn end(mut self, particles: usize) -> Result<Vec<ImagePair>, Refusal> {
        if self.found != self.pairs.len() as u64 {
            return Err(Refusal::Pairs {
                found: self.found,
                particles: particles as u64,
                room: self.limit,
            });
        }
        self.pairs.sort_unstable();
        Ok(self.pairs)
    }
}
