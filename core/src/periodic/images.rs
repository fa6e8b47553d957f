//! Images as further bodies of an open scene: a periodic scene for any detector.
//!
//! **Half of the images.** Every particle j (an *owner*) is brought about into the box by whole
//! numbers Wj; let pj = xj + Wj·H be its true place. Owners are bodies, and so are the images pj +
//! T·H with T lexicographically positive that are near enough to some owner. Particle i touches the
//! image of j by S exactly if pi touches pj + T·H, T = S + Wi - Wj. Of T and -T, the same contact
//! from the other side, one is lexicographically positive, unless T = 0. So every contact is found
//! once, between two owners or between an owner and an image; pairs of two images are dropped. Any
//! Wj are right: they decide how many images there are, not what touches. So where no fraction
//! differs from another by much more than 1 all Wj are 0, and owners are the scene as given, not a
//! copy of it.

use nalgebra::Point;

use super::ImagePair;
use super::frame::Frame;
use super::near::{Candidate, Near, Reach, for_half, half, one_step, survey};
use crate::contact::image::{self, Shift};
use crate::contact::{Arithmetic, Corners, Decided, Imaged, Slack};
use crate::refusal::Refusal;
use crate::scene::{CellF32, Lattice, Radii, Scene, Storage, array};

/// Makes images, and keeps its buffers from one scene to the next.
#[derive(Default)]
pub struct Images<const D: usize> {
    /// Places of particles, and by how many vectors they were moved there; none where all are as
    /// given.
    places: Vec<Point<f64, D>>,
    wraps: Vec<[i32; 3]>,
    /// A byte for those numbers: nearly all pairs have the same, and need not look for more.
    tags: Vec<u8>,
    /// Particles that may have images.
    candidates: Vec<Candidate<D>>,
    images: Vec<Body>,
    /// Places of images.
    centres: Vec<Point<f64, D>>,
    /// Of particles and images, where each has its own.
    radii: Vec<f64>,
}

/// Which image of which particle.
#[derive(Clone, Copy, Debug)]
struct Body {
    owner: u32,
    image: [i32; 3],
}

/// A step along each vector.
const STEPS: [[i32; 3]; 3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/// What may be taken, and for what.
struct Budget {
    particles: u64,
    limit: u64,
    /// Bytes whatever the number of images.
    fixed: f64,
    /// Bytes of one image.
    each: f64,
    /// For the message.
    reach: f64,
}

impl Budget {
    fn new<const D: usize>(given: &Scene<'_, f64, D>, storage: Storage, limit: u64) -> Budget {
        let radii = matches!(given.radii(), Radii::Each(_));
        let numbers = D + usize::from(radii);
        let stored = match storage {
            Storage::F32 => size_of::<f32>() * numbers,
            Storage::Cell => size_of::<CellF32>() * numbers,
            Storage::F64 => 0,
        };
        let (particles, each) = (given.len() as u64, size_of::<Body>() + 8 * numbers + stored);
        let fixed = (particles * stored as u64) as f64;
        Budget { particles, limit, fixed, each: each as f64, reach: 0.0 }
    }

    fn needed(&self, images: f64) -> f64 {
        self.fixed + images * self.each
    }

    fn refusal(&self, images: f64) -> Refusal {
        let (particles, reach, limit) = (self.particles, self.reach, self.limit);
        Refusal::Images { particles, images, reach, needed: self.needed(images), limit }
    }

    /// There is room for so many, and they can be numbered.
    fn holds(&self, images: f64) -> Result<(), Refusal> {
        let numbered = self.particles as f64 + images <= f64::from(u32::MAX);
        if self.needed(images) <= self.limit as f64 && numbered {
            return Ok(());
        }
        Err(self.refusal(images))
    }
}

/// Makes room in a list for so many more.
///
/// # Errors
/// [`Refusal::Exhausted`].
pub(super) fn reserve<T>(list: &mut Vec<T>, more: usize) -> Result<(), Refusal> {
    let bytes = (more as u64).saturating_mul(size_of::<T>() as u64);
    list.try_reserve_exact(more).map_err(|_| Refusal::Exhausted { bytes })
}

impl<const D: usize> Images<D> {
    /// All images that can matter in an arithmetic. They and what else is held for them, a copy of
    /// the scene in another storage included, may take `limit` bytes.
    ///
    /// # Errors
    /// [`Refusal::Images`] if they are more, before they are made; [`Refusal::Away`],
    /// [`Refusal::Skewed`], [`Refusal::Range`], [`Refusal::Exhausted`].
    pub fn make<'a>(
        &'a mut self,
        given: &'a Scene<'a, f64, D>,
        lattice: &Lattice,
        arithmetic: Arithmetic,
        limit: u64,
    ) -> Result<Made<'a, D>, Refusal> {
        let frame = Frame::new(lattice)?;
        self.clear();
        let mut budget = Budget::new(given, arithmetic.storage(), limit);
        budget.holds(0.0)?;
        let (mut corners, mut slack) = (None, Slack::NONE);
        if frame.periodic != [false; 3] && !given.is_empty() {
            if matches!(given.radii(), Radii::Each(_)) {
                budget.fixed += 8.0 * given.len() as f64;
            }
            let reach = Reach::new(given, arithmetic);
            let near = self.look(given, &frame, reach, &mut budget)?;
            corners = Some(self.fill(given, &near, &budget)?);
            slack = near.slack(corners, given.len() + self.images.len());
            if let Radii::Each(radii) = given.radii() {
                reserve(&mut self.radii, radii.len() + self.images.len())?;
                self.radii.extend_from_slice(radii);
                self.radii.extend(self.images.iter().map(|body| radii[body.owner as usize]));
            }
        }
        let Images { places, wraps, tags, images, centres, radii, .. } = self;
        let shifted = !wraps.is_empty() || !images.is_empty();
        let owners = if wraps.is_empty() { given.centres() } else { places };
        let radii = match given.radii() {
            Radii::Each(_) if shifted => Radii::Each(radii.as_slice().into()),
            as_given => as_given.clone(),
        };
        Ok(Made {
            given,
            frame,
            owners,
            wraps,
            tags,
            images,
            centres,
            radii,
            largest_radius: given.largest_radius(),
            corners,
            slack: if shifted { slack } else { Slack::NONE },
            bytes: budget.needed(images.len() as f64) as u64,
        })
    }

    fn clear(&mut self) {
        self.places.clear();
        self.wraps.clear();
        self.tags.clear();
        self.candidates.clear();
        self.images.clear();
        self.centres.clear();
        self.radii.clear();
    }

    /// Finds out which images are near, and by which particles, and moves those into the box if
    /// need be.
    fn look<'a>(
        &mut self,
        given: &Scene<'_, f64, D>,
        frame: &'a Frame<D>,
        reach: Reach,
        budget: &mut Budget,
    ) -> Result<Near<'a, D>, Refusal> {
        let mut below = reach.guess(frame);
        let mut found = survey(given.centres(), frame, below, &mut self.candidates);
        let given_most = found.most();
        let wrap = !found.fit(frame);
        if wrap {
            budget.fixed += (given.len() * (8 * D + size_of::<[i32; 3]>() + 1)) as f64;
            budget.holds(0.0)?;
            self.wrap(given, frame)?;
            found = survey(&self.places, frame, below, &mut self.candidates);
        }
        let wraps = self.wraps.iter().fold([0; 3], |most: [u32; 3], wrap| {
            std::array::from_fn(|a| most[a].max(wrap[a].unsigned_abs()))
        });
        let near = Near::new(frame, &found, given_most, wraps, reach)?;
        budget.reach = near.largest_reach;
        if near.most >= super::frame::MOST {
            // They cannot even be numbered.
            return Err(budget.refusal(near.about(given.len())));
        }
        loop {
            // The box of a file may begin elsewhere than its particles; then the guess is worth
            // nothing either way.
            let idle = found.candidates > given.len() / 8 && below != near.below;
            let enough = (0..3).all(|a| near.below[a] <= below[a]) && !idle;
            let room = found.candidates <= self.candidates.capacity();
            let bytes = (found.candidates * size_of::<Candidate<D>>()) as f64;
            if enough && room {
                budget.fixed += bytes;
                return Ok(near);
            }
            if enough {
                let fixed = budget.fixed;
                budget.fixed += bytes;
                budget.holds(0.0)?;
                budget.fixed = fixed;
                self.candidates = Vec::new();
                reserve(&mut self.candidates, found.candidates)?;
            } else {
                below = near.below;
            }
            let owners = if wrap { &self.places } else { given.centres() };
            found = survey(owners, frame, below, &mut self.candidates);
        }
    }

    fn wrap(&mut self, given: &Scene<'_, f64, D>, frame: &Frame<D>) -> Result<(), Refusal> {
        reserve(&mut self.places, given.len())?;
        reserve(&mut self.wraps, given.len())?;
        reserve(&mut self.tags, given.len())?;
        for (index, centre) in given.centres().iter().enumerate() {
            let wrap = frame.wrap(index as u32, array(centre))?;
            let x = array(centre);
            let place = if wrap == [0; 3] { *x } else { frame.place(x, wrap) };
            if !place.iter().all(|x| x.is_finite()) {
                return Err(Refusal::Range);
            }
            self.places.push(place.into());
            self.wraps.push(wrap);
            self.tags.push(tag(wrap));
        }
        Ok(())
    }

    /// Makes the images; the corners of all bodies.
    fn fill(
        &mut self,
        given: &Scene<'_, f64, D>,
        near: &Near<'_, D>,
        budget: &Budget,
    ) -> Result<Corners<D>, Refusal> {
        loop {
            let room = self.images.capacity().min(self.centres.capacity());
            let (made, corners) = self.fill_as_far_as(room, given, near);
            budget.holds(made)?;
            // Exact: it is at most as large as the number of bodies.
            let made = made as usize;
            if made <= room {
                return if self.are_finite() { Ok(corners) } else { Err(Refusal::Range) };
            }
            (self.images, self.centres) = (Vec::new(), Vec::new());
            reserve(&mut self.images, made)?;
            reserve(&mut self.centres, made)?;
        }
    }

    fn are_finite(&self) -> bool {
        self.centres.iter().all(|place| array(place).iter().all(|x| x.is_finite()))
    }

    /// How many images there are, and the corners of all bodies if all could be made.
    fn fill_as_far_as(
        &mut self,
        room: usize,
        given: &Scene<'_, f64, D>,
        near: &Near<'_, D>,
    ) -> (f64, Corners<D>) {
        let frame = near.frame;
        let (mut low, mut high) = near.corners;
        let mut made = 0.0;
        let mut sums = near.sums(given.largest_radius());
        // Then a sum of two is as near to the place as `Frame::place` is, and is told without a
        // branch that depends on the face.
        let by_steps = self.wraps.is_empty() && frame.is_as_given();
        for Candidate { place, owner } in &self.candidates {
            let index = *owner as usize;
            if let Radii::Each(radii) = given.radii() {
                sums = near.sums(radii[index]);
            }
            let ranges = near.ranges(place, &sums);
            made += half(ranges);
            if made > room as f64 {
                continue;
            }
            let (wrap, x) = match self.wraps.get(index) {
                Some(wrap) => (*wrap, array(&given.centres()[index])),
                None => ([0; 3], place),
            };
            let mut add = |image: [i32; 3], place: [f64; D]| {
                for k in 0..D {
                    (low[k], high[k]) = (low[k].min(place[k]), high[k].max(place[k]));
                }
                self.images.push(Body { owner: *owner, image });
                self.centres.push(place.into());
            };
            if let (Some(a), true) = (one_step(ranges), by_steps) {
                add(STEPS[a], std::array::from_fn(|k| x[k] + frame.vectors[a][k]));
                continue;
            }
            for_half(ranges, |shift| {
                // Always: so large numbers were refused.
                let Some(shift) = frame.given(shift) else { return };
                let image = std::array::from_fn(|a| wrap[a] + shift[a]);
                add(image, frame.place(x, image));
            });
        }
        (made, (low, high))
    }
}

/// The bodies of an open scene that has the contacts of a periodic one: first the particles in
/// their order, then images.
pub struct Made<'a, const D: usize> {
    given: &'a Scene<'a, f64, D>,
    frame: Frame<D>,
    owners: &'a [Point<f64, D>],
    /// None if no particle was moved.
    wraps: &'a [[i32; 3]],
    tags: &'a [u8],
    images: &'a [Body],
    centres: &'a [Point<f64, D>],
    radii: Radii<'a, f64>,
    largest_radius: f64,
    corners: Option<Corners<D>>,
    slack: Slack,
    bytes: u64,
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
fn tag(wrap: [i32; 3]) -> u8 {
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
