//! What was made of a periodic scene: bodies, and which contact a pair of them is.

use nalgebra::Point;

use super::ImagePair;
use super::frame::Frame;
use crate::contact::image::{self, Shift};
use crate::contact::{Corners, Decided, Imaged, Slack};
use crate::refusal::{Refusal, reserve};
use crate::scene::{Radii, Scene, array};

/// Which image of which particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub owner: u32,
    pub image: [i32; 3],
}

/// The bodies of an open scene that has the contacts of a periodic one: first the particles in
/// their order, then images.
pub struct Made<'a, const D: usize> {
    pub(super) given: &'a Scene<'a, f64, D>,
    pub(super) frame: Frame<D>,
    pub(super) owners: &'a [Point<f64, D>],
    /// None if no particle was moved.
    pub(super) wraps: &'a [[i32; 3]],
    pub(super) tags: &'a [u8],
    pub(super) images: &'a [Body],
    pub(super) centres: &'a [Point<f64, D>],
    pub(super) radii: Radii<'a, f64>,
    pub(super) largest_radius: f64,
    pub(super) corners: Option<Corners<D>>,
    pub(super) slack: Slack,
    pub(super) bytes: u64,
}

impl<'a, const D: usize> Made<'a, D> {
    /// How many images there are, beside the particles themselves.
    pub fn ghosts(&self) -> u64 {
        self.images.len() as u64
    }

    /// How many particles there are.
    pub fn particles(&self) -> u32 {
        self.given.len() as u32
    }

    /// What is held for this scene, in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// How near the places of the bodies are to the true ones, as a slack of the exact test.
    pub fn slack(&self) -> Slack {
        self.slack
    }

    /// Was no particle moved? Then contacts of two particles are without a shift.
    pub fn are_as_given(&self) -> bool {
        self.wraps.is_empty()
    }

    /// Are these two particles, moved alike? Then their contact is without a shift. If not so,
    /// nothing is known.
    #[inline(always)]
    pub fn are_together(&self, a: u32, b: u32) -> bool {
        let tag = |body: u32| self.tags.get(body as usize).copied().unwrap_or(FAR);
        (tag(a) == tag(b)) & (tag(a) != FAR)
    }

    /// Which contact that of a particle and an image is, in any order, where particles are as
    /// given.
    #[inline]
    pub fn through(&self, a: u32, b: u32) -> ImagePair {
        let Body { owner, image } = self.images[(a.max(b) - self.particles()) as usize];
        ImagePair::new(a.min(b), owner, image)
    }

    /// Which contact that of two bodies is; `None` for two images.
    pub fn pair(&self, a: u32, b: u32) -> Option<ImagePair> {
        let owners = self.particles();
        if a >= owners && b >= owners {
            return None;
        }
        let ([i, j], image) = self.shift(a, b);
        Some(ImagePair::new(i, j, image))
    }

    /// Do two bodies touch, in exact arithmetic, for the numbers as given?
    pub fn touch(&self, a: u32, b: u32) -> bool {
        let ([i, j], image) = self.shift(a, b);
        touches(self.given, [i, j], Shift { image, vectors: &self.frame.vectors })
    }

    /// Their owners, and by which shift of the second the first meets it.
    fn shift(&self, a: u32, b: u32) -> ([u32; 2], [i32; 3]) {
        let [a, b] = [a, b].map(|body| self.body(body as usize));
        ([a.owner, b.owner], std::array::from_fn(|k| b.image[k] - a.image[k]))
    }

    /// By how many vectors a body was moved from where its owner was given.
    pub fn image(&self, body: u32) -> [i32; 3] {
        self.body(body as usize).image
    }

    fn body(&self, body: usize) -> Body {
        match body.checked_sub(self.given.len()) {
            Some(image) => self.images[image],
            None => {
                let image = self.wraps.get(body).copied().unwrap_or_default();
                Body { owner: body as u32, image }
            }
        }
    }

    /// For detectors.
    pub fn imaged<'b>(&'b self, decided: Decided<'b>) -> Imaged<'b, D> {
        Imaged {
            owners: self.owners,
            images: self.centres,
            radii: &self.radii,
            largest_radius: self.largest_radius,
            corners: self.corners,
            decided,
        }
    }

    /// The places of all bodies.
    pub fn places(&self) -> impl ExactSizeIterator<Item = &[f64; D]> + Clone {
        let (owners, n) = (self.owners, self.owners.len());
        (0..n + self.centres.len()).map(move |body| match body.checked_sub(n) {
            Some(image) => array(&self.centres[image]),
            None => array(&owners[body]),
        })
    }

    /// The radii of all bodies.
    pub fn radii(&self) -> &Radii<'a, f64> {
        &self.radii
    }

    /// The largest of them.
    pub fn largest_radius(&self) -> f64 {
        self.largest_radius
    }

    /// A copy of all bodies.
    ///
    /// # Errors
    /// [`Refusal::Exhausted`].
    pub fn open(&self) -> Result<Scene<'static, f64, D>, Refusal> {
        let places = self.places();
        let mut centres = Vec::new();
        reserve(&mut centres, places.len())?;
        centres.extend(places.copied().map(Point::from));
        let radii = match &self.radii {
            Radii::Uniform(r) => Radii::Uniform(*r),
            Radii::Each(radii) => {
                let mut copy = Vec::new();
                reserve(&mut copy, radii.len())?;
                copy.extend_from_slice(radii);
                Radii::Each(copy.into())
            }
        };
        Scene::new(centres, radii).map_err(|_| Refusal::Range)
    }
}

/// The tag of numbers that have none.
const FAR: u8 = u8::MAX;

/// One for each three numbers of at most 2 in magnitude, and one for all others.
pub(super) fn tag(wrap: [i32; 3]) -> u8 {
    if wrap.iter().any(|number| number.unsigned_abs() > 2) {
        return FAR;
    }
    wrap.iter().fold(0, |tag, number| 5 * tag + (number + 2) as u8)
}

/// Does particle i touch an image of j? Exactly, for the numbers as given.
pub(super) fn touches<const D: usize>(
    scene: &Scene<'_, f64, D>,
    pair: [u32; 2],
    shift: Shift<'_, D>,
) -> bool {
    let [i, j] = pair.map(|index| index as usize);
    let (a, b) = (array(&scene.centres()[i]), array(&scene.centres()[j]));
    image::compare(a, b, scene.radius(i), scene.radius(j), shift).is_le()
}
