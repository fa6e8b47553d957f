//! Turns a periodic scene into an open scene with images as additional particles, for any detector.
//!
//! **Half of the images.** Every particle j (an *owner*) is brought approximately into the box by
//! integers Wj; let pj = xj + Wj·H be its true position. The open scene consists of the owners and
//! the images pj + T·H with T positive (the first nonzero number is positive, in upright boxes the
//! last) that are near enough to some owner. Particle i touches the image of j by S exactly if pi
//! touches pj + T·H, where T = S + Wi - Wj. T and -T are the same contact from both sides, and one
//! of the two is positive unless T = 0. So every contact is found once, between two owners or
//! between an owner and an image; pairs of two images are dropped. Any Wj are correct: they
//! determine the number of images, not what touches. So if no two fractions differ by much more
//! than 1, all Wj are 0, and owners are the given scene, not a copy.

use nalgebra::Point;

use super::frame::ReducedBox;
use super::made::{Instance, Made, tag};
use super::near::{Near, Reach};
use super::survey::{Candidate, survey};
use contactbench_ground::contact::{Arithmetic, Corners, Slack};
use contactbench_ground::limits::refusal::{Refusal, reserve};
use contactbench_ground::scene::{Lattice, Radii, Scene, Storage, array};
use contactbench_ground::wide::fill;

/// Makes images and keeps its buffers from one scene to the next.
#[derive(Default)]
pub struct Images<const D: usize> {
    /// Positions of particles, and in `wraps` their shifts; both empty if no particle was moved.
    places: Vec<Point<f64, D>>,
    wraps: Vec<[i32; 3]>,
    /// One-byte codes of `wraps`. Nearly all pairs have equal codes, which mean equal shifts.
    tags: Vec<u8>,
    candidates: Vec<Candidate<D>>,
    images: Vec<Instance>,
    centres: Vec<Point<f64, D>>,
    /// Radii of particles and images; empty if all radii are equal.
    radii: Vec<f64>,
}

/// Number of particles that are tested first for lying in an upright box.
const SAMPLE: usize = 1024;

struct Budget {
    particles: u64,
    limit: u64,
    /// Number of bytes that does not depend on the number of images.
    fixed: f64,
    /// Number of bytes for each image.
    each: f64,
    reach: f64,
}

impl Budget {
    fn new<const D: usize>(given: &Scene<'_, f64, D>, storage: Storage, limit: u64) -> Budget {
        let radii = matches!(given.radii(), Radii::Each(_));
        let numbers = D + usize::from(radii);
        let stored = match storage {
            Storage::F32 => size_of::<f32>() * numbers,
            Storage::F64 => 0,
        };
        let (particles, each) = (given.len() as u64, size_of::<Instance>() + 8 * numbers + stored);
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

    /// Refuses a scene if this many images do not fit in memory or cannot be numbered.
    fn holds(&self, images: f64) -> Result<(), Refusal> {
        let numbered = self.particles as f64 + images <= f64::from(u32::MAX);
        if self.needed(images) <= self.limit as f64 && numbered {
            return Ok(());
        }
        Err(self.refusal(images))
    }
}

impl<const D: usize> Images<D> {
    /// Makes all images that can matter in an arithmetic. Images and all data that go with them,
    /// including a copy of the scene in another storage, may take `limit` bytes.
    ///
    /// # Errors
    /// Returns [`Refusal::Images`] before allocating if the limit is too low, and
    /// [`Refusal::Away`], [`Refusal::Skewed`], [`Refusal::Range`] or [`Refusal::Exhausted`].
    pub fn make<'a>(
        &'a mut self,
        given: &'a Scene<'a, f64, D>,
        lattice: &Lattice,
        arithmetic: Arithmetic,
        limit: u64,
    ) -> Result<Made<'a, D>, Refusal> {
        let mut frame = ReducedBox::new(lattice)?;
        self.clear();
        let mut budget = Budget::new(given, arithmetic.storage(), limit);
        budget.holds(0.0)?;
        let (mut corners, mut slack) = (None, Slack::NONE);
        if frame.periodic != [false; 3] && !given.is_empty() {
            if matches!(given.radii(), Radii::Each(_)) {
                budget.fixed += 8.0 * given.len() as f64;
            }
            let reach = Reach::new(given, arithmetic);
            let upright = frame.upright();
            let near = self.look(given, &frame, upright.as_ref(), reach, &mut budget)?;
            corners = Some(self.fill(given, &near, &budget)?);
            slack = near.slack(corners, given.len() + self.images.len());
            frame = near.frame.clone();
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
            test: arithmetic.exact().test(),
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

    /// Determines which particles have images that are near enough and where these are, and moves
    /// particles into the box if necessary.
    fn look<'a>(
        &mut self,
        given: &Scene<'_, f64, D>,
        frame: &'a ReducedBox<D>,
        upright: Option<&'a ReducedBox<D>>,
        reach: Reach,
        budget: &mut Budget,
    ) -> Result<Near<'a, D>, Refusal> {
        let mut see = |centres: &[Point<f64, D>], frame: &'a ReducedBox<D>| {
            let below = reach.guess(frame);
            let found = survey(centres, frame, below, &mut self.candidates);
            (frame, below, found)
        };
        let all = given.centres();
        let some = &all[all.len().saturating_sub(SAMPLE)..];
        let upright = upright
            .filter(|frame| reach.boxes(frame).iter().all(|&boxes| boxes <= 1.0))
            .filter(|frame| see(some, frame).2.fit(frame))
            .map(|frame| see(all, frame))
            .filter(|(frame, _, found)| found.fit(frame));
        let (frame, below, mut found) = upright.unwrap_or_else(|| see(all, frame));
        let given_most = found.most();
        let wrap = !found.fit(frame);
        if wrap {
            budget.fixed += (given.len() * (8 * D + size_of::<[i32; 3]>() + 1)) as f64;
            budget.holds(0.0)?;
            self.wrap(given, frame)?;
            found = survey(&self.places, frame, below, &mut self.candidates);
        }
        let wraps = self
            .wraps
            .iter()
            .fold([0; 3], |most: [u32; 3], wrap| fill(|a| most[a].max(wrap[a].unsigned_abs())));
        let near = Near::new(frame, found, given_most, wraps, reach)?;
        budget.reach = near.largest_reach;
        if near.most >= super::frame::MOST {
            // The images are too many to be numbered.
            return Err(budget.refusal(near.about(given.len())));
        }
        self.survey_enough(given, &near, (below, found.candidates), budget)?;
        Ok(near)
    }

    /// Surveys the particles with wider bounds and more memory until no candidate is missing.
    fn survey_enough(
        &mut self,
        given: &Scene<'_, f64, D>,
        near: &Near<'_, D>,
        (mut below, mut candidates): ([f64; 3], usize),
        budget: &mut Budget,
    ) -> Result<(), Refusal> {
        loop {
            // If a file's box begins far from its particles, the guess of which particles are near
            // a face saves no work.
            let idle = candidates > given.len() / 8 && below != near.below;
            let enough = (0..3).all(|a| near.below[a] <= below[a]) && !idle;
            let room = candidates <= self.candidates.capacity();
            let bytes = (candidates * size_of::<Candidate<D>>()) as f64;
            if enough && room {
                budget.fixed += bytes;
                return Ok(());
            }
            if enough {
                Budget { fixed: budget.fixed + bytes, ..*budget }.holds(0.0)?;
                self.candidates = Vec::new();
                reserve(&mut self.candidates, candidates)?;
            } else {
                below = near.below;
            }
            let owners = if self.wraps.is_empty() { given.centres() } else { &self.places };
            candidates = survey(owners, near.frame, below, &mut self.candidates).candidates;
        }
    }

    fn wrap(&mut self, given: &Scene<'_, f64, D>, frame: &ReducedBox<D>) -> Result<(), Refusal> {
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

    /// Makes the images and returns the corners of the box around all particles and images.
    fn fill(
        &mut self,
        given: &Scene<'_, f64, D>,
        near: &Near<'_, D>,
        budget: &Budget,
    ) -> Result<Corners<D>, Refusal> {
        if near.reaches_far() {
            // Far too many images are refused before the loop below visits each.
            let fewest = self.candidates.iter().map(|Candidate { place, owner }| {
                near.fewest(place, &near.sums(given.radius(*owner as usize)))
            });
            budget.holds(fewest.sum())?;
        }
        loop {
            let room = self.images.capacity().min(self.centres.capacity());
            let (made, corners) = self.fill_as_far_as(room, given, near);
            budget.holds(made)?;
            // The conversion is exact, because the number is below 2^32.
            let made = made as usize;
            if made <= room {
                let finite = self.centres.iter().flat_map(array).all(|x| x.is_finite());
                return if finite { Ok(corners) } else { Err(Refusal::Range) };
            }
            (self.images, self.centres) = (Vec::new(), Vec::new());
            reserve(&mut self.images, made)?;
            reserve(&mut self.centres, made)?;
        }
    }

    /// Makes up to `room` images. Returns the number needed and, if all fit, the bounding corners.
    fn fill_as_far_as(
        &mut self,
        room: usize,
        given: &Scene<'_, f64, D>,
        near: &Near<'_, D>,
    ) -> (f64, Corners<D>) {
        let frame = near.frame;
        let (mut low, mut high) = near.found.corners;
        let mut made = 0.0;
        let mut sums = near.sums(given.largest_radius());
        let many = near.are_many();
        for Candidate { place, owner } in &self.candidates {
            let index = *owner as usize;
            if let Radii::Each(radii) = given.radii() {
                sums = near.sums(radii[index]);
            }
            let (wrap, x) = match self.wraps.get(index) {
                Some(wrap) => (*wrap, array(&given.centres()[index])),
                None => ([0; 3], place),
            };
            if many {
                let count = near.count(place, &sums);
                if made + count > room as f64 {
                    made += count;
                    continue;
                }
            }
            near.for_images(place, &sums, |shift| {
                made += 1.0;
                if made > room as f64 {
                    return;
                }
                // The conversion always succeeds, because larger numbers were refused before.
                let Ok(shift) = frame.given(shift) else { return };
                let image = fill(|a| wrap[a] + shift[a]);
                let place = frame.place(x, image);
                for k in 0..D {
                    (low[k], high[k]) = (low[k].min(place[k]), high[k].max(place[k]));
                }
                self.images.push(Instance { owner: *owner, image });
                self.centres.push(place.into());
            });
        }
        (made, (low, high))
    }
}
