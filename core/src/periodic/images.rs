//! Images as further bodies of an open scene: a periodic scene for any detector.
//!
//! **Half of the images.** Every particle j (an *owner*) is brought about into the box by whole
//! numbers Wj; let pj = xj + Wj·H be its true place. Owners are bodies, and so are the images pj +
//! T·H with T lexicographically positive that are near enough to some owner. Particle i touches the
//! image of j by S exactly if pi touches pj + T·H, T = S + Wi - Wj. Of T and -T, the same contact
//! from the other side, one is lexicographically positive, unless T = 0. So every contact is found
//! once, between two owners or between an owner and an image; pairs of two images are dropped. Any
//! Wj are right: they decide how many images there are, not what touches.
//!
//! **Which images.** Let y be the computed places of owners, fl(ga·y) their fractions ([`frame`]),
//! from lowa to higha along vector a, and E a bound for |y - p| over all owners. If the image of j
//! by T is within R of owner i, then by (1) on that page Ta differs from ga·(pi - pj) by at most
//! |ga| R + 2c off(a); ga·pi differs from fl(ga·yi) by at most |ga| E + 4u m, where m bounds the
//! sum of |ga| |y| by coordinates; likewise for j. So
//!
//! ```text
//! lowa - fj - M <= Ta <= higha - fj + M,    M = |ga| (R + 2E) + 8u m + 2c off(a),
//! ```
//!
//! and the roundings of these two sums are at most 3u (4m + M): we take 64u m for both terms in m,
//! and M(1 + 2^-40).
//!
//! **Reach.** In exact arithmetic R = rj + rmax. A rounded arithmetic of unit v accepts up to its
//! own reach ([`Slack::reach`]), and storing moves coordinates and radii by v, relatively
//! (f32-cell: by 2^-25 of a cell, that is of twice the largest diameter or of the extent in 2^19):
//! an owner, at most Y from the origin, by less than 2vY, an image at distance d from it by less
//! than 2v(Y + d). So d <= reach + 4vY + 2vd + ..., and R = (reach + 16v Y)(1 + 16v) is enough,
//! with the sum of the largest coordinates for Y. For f32-cell and points the extent is below 4Y +
//! 4R, and 2^-44 of it is nothing against 16v. What is beyond R is not accepted, so that answers do
//! not depend on which images are made.
//!
//! **What detectors see** in exact arithmetic are places that are rounded: every body is within E
//! of its true place, E now with the largest T in it. Distances of places and true ones differ by
//! at most 2E; so pairs at most s - 2E apart touch, and pairs more than s + 2E apart do not, where
//! s is the sum of the radii: a [`Slack`] of 2E. We take 2E(1 + 1/16), and a relative part of 8u,
//! which covers the roundings of those who compute with a slack: at most four of them, in s and in
//! the bound itself (`half` in the copies of detectors has three, [`Near`](crate::filter::Near)
//! four). What is between the two is decided from the numbers as given. For points, whose reach
//! would be less than a grid can address, the slack is about the distance between neighbours. Where
//! nothing is shifted there is none.

use super::ImagePair;
use super::frame::{Frame, MOST, U, off_by};
use crate::contact::image::{self, Shift};
use crate::contact::{Arithmetic, Slack};
use crate::filter::cells::spacing;
use crate::refusal::Refusal;
use crate::scene::{CellF32, Lattice, Radii, Real, Scene, Storage, array};

/// The bodies of an open scene that has the contacts of a periodic one.
pub struct Images<'a, const D: usize> {
    given: &'a Scene<'a, f64, D>,
    frame: Frame<D>,
    /// Owners in their order, then images.
    bodies: Vec<Body>,
    slack: Slack,
}

/// Which image of which particle.
#[derive(Clone, Copy, Debug)]
struct Body {
    owner: u32,
    image: [i32; 3],
}

impl<'a, const D: usize> Images<'a, D> {
    /// All images that can matter in an arithmetic, and the open scene that has them, first the
    /// particles of the periodic scene in their order. Both together may take `limit` bytes.
    ///
    /// # Errors
    /// [`Refusal::Images`] if they are more, before they are made; [`Refusal::Away`],
    /// [`Refusal::Skewed`], [`Refusal::Range`].
    pub fn new(
        given: &'a Scene<'a, f64, D>,
        lattice: &Lattice,
        arithmetic: Arithmetic,
        limit: u64,
    ) -> Result<(Images<'a, D>, Scene<'static, f64, D>), Refusal> {
        let frame = Frame::new(lattice)?;
        let n = given.len();
        let radius_bytes = if matches!(given.radii(), Radii::Each(_)) { 8.0 } else { 0.0 };
        let bytes = (size_of::<Body>() + 8 * D) as f64 + radius_bytes;
        // Places of owners are held beside their centres.
        let needed = |images: f64| (n as f64 + images) * bytes + (n * 8 * D) as f64;
        let most = (limit as f64).min(bytes * f64::from(u32::MAX));
        let too_many = |images: f64, reach: f64| {
            let needed = needed(images);
            Refusal::Images { particles: n as u64, images, reach, needed, limit }
        };
        let within = |images: f64, reach: f64| {
            (needed(images) <= most).then_some(()).ok_or_else(|| too_many(images, reach))
        };
        within(0.0, 0.0)?;
        let (mut bodies, mut places) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for (owner, centre) in given.centres().iter().enumerate() {
            let image = frame.wrap(owner as u32, array(centre))?;
            bodies.push(Body { owner: owner as u32, image });
            places.push(frame.place(array(centre), image));
        }
        let near = Near::new(given, &frame, &bodies, &places, arithmetic)?;
        if near.most >= MOST {
            // They cannot even be numbered.
            return Err(too_many(near.most, near.largest_reach));
        }
        let ranges = |owner: usize| near.ranges(&places[owner], given.radius(owner));
        let made = (0..n).map(|owner| half(ranges(owner))).sum::<f64>();
        within(made, near.largest_reach)?;
        let made = made as usize;
        let total = n + made;
        bodies.reserve_exact(made);
        let mut centres = Vec::with_capacity(total);
        centres.extend(places.iter().copied().map(nalgebra::Point::from));
        for owner in 0..n {
            let (wrapped, x) = (bodies[owner].image, array(&given.centres()[owner]));
            for_half(ranges(owner), |shift| {
                let image = std::array::from_fn(|a| wrapped[a] + shift[a]);
                bodies.push(Body { owner: owner as u32, image });
                centres.push(frame.place(x, image).into());
            });
        }
        let radii = match given.radii() {
            Radii::Uniform(r) => Radii::Uniform(*r),
            Radii::Each(radii) => {
                Radii::Each(bodies.iter().map(|body| radii[body.owner as usize]).collect())
            }
        };
        let scene = Scene::new(centres, radii).map_err(|_| Refusal::Range)?;
        let shifted = bodies.iter().any(|body| body.image != [0; 3]);
        let slack = if shifted { near.slack(&scene) } else { Slack::NONE };
        Ok((Images { given, frame, bodies, slack }, scene))
    }

    /// How many images were made, beside the particles themselves.
    pub fn ghosts(&self) -> u64 {
        (self.bodies.len() - self.given.len()) as u64
    }

    /// How near the places of the bodies are to the true ones, as a slack of the exact test.
    pub fn slack(&self) -> Slack {
        self.slack
    }

    /// Which contact that of two bodies is; `None` for two images.
    pub fn pair(&self, a: u32, b: u32) -> Option<ImagePair> {
        let owners = self.given.len() as u32;
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
        let [a, b] = [a, b].map(|body| self.bodies[body as usize]);
        ([a.owner, b.owner], std::array::from_fn(|k| b.image[k] - a.image[k]))
    }
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

/// From the lowest to the highest T along each vector.
type Ranges = [[i32; 2]; 3];

/// How many T of these ranges are lexicographically positive; exact below 2^53.
fn half(ranges: Ranges) -> f64 {
    let length = |[low, high]: [i32; 2]| f64::from((high - low + 1).max(0));
    let positive = |[low, high]: [i32; 2]| length([low.max(1), high]);
    let [x, y, z] = ranges;
    let zero = |[low, high]: [i32; 2]| f64::from(u8::from(low <= 0 && high >= 0));
    positive(x) * length(y) * length(z)
        + zero(x) * (positive(y) * length(z) + zero(y) * positive(z))
}

/// Each of them, in ascending order.
fn for_half([x, y, z]: Ranges, mut call: impl FnMut([i32; 3])) {
    for a in x[0].max(0)..=x[1] {
        for b in (if a > 0 { y[0] } else { y[0].max(0) })..=y[1] {
            for c in (if a > 0 || b > 0 { z[0] } else { z[0].max(1) })..=z[1] {
                call([a, b, c]);
            }
        }
    }
}

/// Which images are near enough to some owner.
struct Near<'a, const D: usize> {
    frame: &'a Frame<D>,
    /// Of fractions of owners.
    low: [f64; 3],
    high: [f64; 3],
    /// M without |ga| R.
    more: [f64; 3],
    /// R = (reach + storing)(1 + 16v).
    reach: Slack,
    storing: f64,
    unit: f64,
    largest_radius: f64,
    largest_reach: f64,
    /// No T is larger.
    most: f64,
    /// E of all bodies.
    off: f64,
}

impl<'a, const D: usize> Near<'a, D> {
    fn new(
        given: &Scene<'_, f64, D>,
        frame: &'a Frame<D>,
        bodies: &[Body],
        places: &[[f64; D]],
        arithmetic: Arithmetic,
    ) -> Result<Near<'a, D>, Refusal> {
        let largest_radius = given.largest_radius();
        let (unit, reach) = match arithmetic.storage() {
            Storage::F64 => (f64::UNIT, Slack::rounded::<f64>()),
            Storage::F32 => (f32::UNIT, Slack::rounded::<f32>()),
            Storage::Cell => {
                // In units of a cell, which is at most four radii wide.
                let slack = Slack::rounded::<CellF32>();
                let absolute = slack.absolute * (4.0 * largest_radius).max(f64::MIN_POSITIVE);
                (CellF32::UNIT, Slack { absolute, ..slack })
            }
        };
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        // The largest coordinates, as given and of places.
        let (mut x_most, mut y_most, mut wraps) = ([0.0f64; D], [0.0f64; D], [0.0f64; 3]);
        for (body, place) in bodies.iter().zip(places) {
            let x = array(&given.centres()[body.owner as usize]);
            for k in 0..D {
                if !place[k].is_finite() {
                    return Err(Refusal::Range);
                }
                (x_most[k], y_most[k]) = (x_most[k].max(x[k].abs()), y_most[k].max(place[k].abs()));
            }
            for a in 0..3 {
                let fraction = frame.fraction(a, place);
                (low[a], high[a]) = (low[a].min(fraction), high[a].max(fraction));
                wraps[a] = wraps[a].max(f64::from(body.image[a].unsigned_abs()));
            }
        }
        if bodies.is_empty() {
            (low, high) = ([0.0; 3], [0.0; 3]);
        }
        // E, with images by up to so many vectors.
        let off = |shift: f64| -> f64 {
            let along = |k: usize| {
                let size = |a: usize| frame.vectors[a][k].abs();
                let shifted: f64 = (0..3).map(|a| shift * size(a)).sum();
                let wrapped: f64 = (0..3).map(|a| wraps[a] * size(a)).sum();
                off_by(y_most[k] + shifted, x_most[k] + wrapped + shifted)
            };
            (0..D).map(along).sum()
        };
        let storing = 16.0 * unit * y_most.iter().sum::<f64>();
        let mut near = Near {
            frame,
            low,
            high,
            more: [0.0; 3],
            reach,
            storing,
            unit,
            largest_radius,
            largest_reach: 0.0,
            most: 0.0,
            off: 0.0,
        };
        near.largest_reach = near.reach_of(largest_radius);
        let owners_off = off(0.0);
        near.more = std::array::from_fn(|a| {
            2.0 * frame.lengths[a] * owners_off + 64.0 * U * frame.most(a, &y_most)
        });
        let spread = std::array::from_fn(|a| high[a] - low[a] + near.more[a]);
        let (coupling, most) = frame.coupling(spread, near.largest_reach);
        (0..3).for_each(|a| near.more[a] += coupling[a]);
        (near.most, near.off) = (most, off(most.min(MOST)));
        // Also where it is no number.
        if !(near.off < f64::INFINITY && near.most.is_finite()) {
            return Err(Refusal::Range);
        }
        Ok(near)
    }

    /// R for a particle of this radius and any other.
    fn reach_of(&self, radius: f64) -> f64 {
        let reach = self.reach.reach(radius, self.largest_radius);
        (reach + self.storing) * (1.0 + 16.0 * self.unit)
    }

    /// The T of an owner.
    fn ranges(&self, place: &[f64; D], radius: f64) -> Ranges {
        const GROW: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;
        let reach = self.reach_of(radius);
        std::array::from_fn(|a| {
            if !self.frame.periodic[a] {
                return [0, 0];
            }
            let fraction = self.frame.fraction(a, place);
            let margin = (self.frame.lengths[a] * reach + self.more[a]) * GROW;
            let (low, high) = (self.low[a] - fraction - margin, self.high[a] - fraction + margin);
            [low.ceil() as i32, high.floor() as i32]
        })
    }

    /// Of the exact test, for the places of all bodies.
    fn slack(&self, scene: &Scene<'_, f64, D>) -> Slack {
        let mut absolute = 2.125 * self.off;
        if 2.0 * self.largest_radius <= f64::UNDERFLOW {
            let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
            for centre in scene.centres() {
                for (k, &x) in array(centre).iter().enumerate() {
                    (low[k], high[k]) = (low[k].min(x), high[k].max(x));
                }
            }
            absolute = absolute.max(spacing(low, high, scene.len()));
        }
        Slack { relative: 8.0 * U, absolute }
    }
}
