//! Particles and images of a periodic scene, and the contact that each pair of them represents.

use nalgebra::Point;

use super::frame::ReducedBox;
use contactbench_ground::contact::image::{self, Shift};
use contactbench_ground::contact::{Corners, Decided, Imaged, Slack, Test, rule};
use contactbench_ground::limits::refusal::{Refusal, reserve};
use contactbench_ground::periodic::ImagePair;
use contactbench_ground::scene::{Radii, Scene, array};
use contactbench_ground::wide::fill;

/// Image of a particle, named by its owner and its shift from the owner's given position.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    pub owner: u32,
    pub image: [i32; 3],
}

/// An open scene that represents a periodic one: the particles in order, then their images.
pub struct Made<'a, const D: usize> {
    pub given: &'a Scene<'a, f64, D>,
    pub frame: ReducedBox<D>,
    pub owners: &'a [Point<f64, D>],
    /// Shift that brought each particle into the box; empty if no particle was moved.
    pub wraps: &'a [[i32; 3]],
    pub tags: &'a [u8],
    pub images: &'a [Instance],
    pub centres: &'a [Point<f64, D>],
    pub radii: Radii<'a, f64>,
    pub largest_radius: f64,
    pub corners: Option<Corners<D>>,
    pub slack: Slack,
    /// The test that decides contacts exactly for the given, unrounded numbers.
    pub test: Test,
    pub bytes: u64,
}

impl<'a, const D: usize> Made<'a, D> {
    /// Returns the number of images; the particles themselves are not counted.
    pub fn ghosts(&self) -> u64 {
        self.images.len() as u64
    }

    /// Returns the number of particles.
    pub fn particles(&self) -> u32 {
        self.given.len() as u32
    }

    /// Returns the bytes held for particles and images.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns whether no particle was moved. Contacts of two particles then have no shift.
    pub fn are_as_given(&self) -> bool {
        self.wraps.is_empty()
    }

    /// Returns true only if `a` and `b` are particles that were moved by the same shift, with
    /// numbers of at most 2, so that their contact has no shift. False decides nothing.
    #[inline(always)]
    pub fn are_together(&self, a: u32, b: u32) -> bool {
        let tag = |body: u32| self.tags.get(body as usize).copied().unwrap_or(FAR);
        (tag(a) == tag(b)) & (tag(a) != FAR)
    }

    /// Returns the contact of a particle and an image, in any order, if no particle was moved.
    #[inline]
    pub fn through(&self, a: u32, b: u32) -> ImagePair {
        let Instance { owner, image } = self.images[(a.max(b) - self.particles()) as usize];
        ImagePair::new(a.min(b), owner, image)
    }

    /// Returns the contact that a pair of particles or images represents, or `None` for two images.
    #[inline]
    pub fn pair(&self, a: u32, b: u32) -> Option<ImagePair> {
        let owners = self.particles();
        if a >= owners && b >= owners {
            return None;
        }
        let ([i, j], image) = self.shift(a, b);
        Some(ImagePair::new(i, j, image))
    }

    /// Returns whether two particles or images touch, exactly for the given numbers.
    pub fn touch(&self, a: u32, b: u32) -> bool {
        let ([i, j], image) = self.shift(a, b);
        touches(self.given, [i, j], Shift { image, vectors: &self.frame.vectors }, self.test)
    }

    /// Returns the owners of `a` and `b`, and the shift of the second relative to the first.
    #[inline]
    fn shift(&self, a: u32, b: u32) -> ([u32; 2], [i32; 3]) {
        let [a, b] = [a, b].map(|body| self.body(body as usize));
        ([a.owner, b.owner], fill(|k| b.image[k] - a.image[k]))
    }

    /// Returns the shift of a particle or image from the given position of its owner.
    pub fn image(&self, body: u32) -> [i32; 3] {
        self.body(body as usize).image
    }

    #[inline]
    fn body(&self, body: usize) -> Instance {
        match body.checked_sub(self.given.len()) {
            Some(image) => self.images[image],
            None => {
                let image = self.wraps.get(body).copied().unwrap_or_default();
                Instance { owner: body as u32, image }
            }
        }
    }

    /// Returns a view of particles and images for detectors.
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

    /// Returns the positions of the particles, then of the images.
    pub fn places(&self) -> impl ExactSizeIterator<Item = &[f64; D]> + Clone {
        (0..self.owners.len() + self.centres.len()).map(|body| self.place(body))
    }

    /// Returns the position of a particle or image.
    pub fn place(&self, body: usize) -> &[f64; D] {
        let image = body.checked_sub(self.owners.len());
        array(image.map_or_else(|| &self.owners[body], |image| &self.centres[image]))
    }

    /// Copies particles and images into an open scene. Fails if memory runs out.
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

/// Code for every shift with a number above 2 in magnitude.
const FAR: u8 = u8::MAX;

/// Returns a code that names the shift if its numbers are at most 2 in magnitude, else 255.
pub fn tag(wrap: [i32; 3]) -> u8 {
    if wrap.iter().any(|number| number.unsigned_abs() > 2) {
        return FAR;
    }
    wrap.iter().fold(0, |tag, number| 5 * tag + (number + 2) as u8)
}

/// Returns whether particle i touches this image of j, exactly for the given numbers.
pub fn touches<const D: usize>(
    scene: &Scene<'_, f64, D>,
    pair: [u32; 2],
    shift: Shift<'_, D>,
    test: Test,
) -> bool {
    let [i, j] = pair.map(|index| index as usize);
    let (a, b) = (array(&scene.centres()[i]), array(&scene.centres()[j]));
    rule::touches(test, image::compare(a, b, scene.radius(i), scene.radius(j), shift))
}
