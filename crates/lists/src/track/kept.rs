//! State kept between frames: particles in spatial order, and the list of near pairs.

use nalgebra::Point;

use super::answer::{Boxed, Open, PairReceiver};
use super::around::Around;
use super::cells::{self, Room};
use super::pass::{Each, Pass, Reach, Same};
use super::places::Unit;
use super::radii::KeptRadii;
use super::rule::{Displacements, Looks, Rule};
use super::travel::{TopTwo, at_most, square};
use crate::searcher::Searcher;
use contactbench_ground::contact::{Arithmetic, Corners, Particles, Slack, Test};
use contactbench_ground::limits::refusal::{Refusal, reserve};
use contactbench_ground::pairs::pair_list::{PAIR_BYTES, PairList};
use contactbench_ground::periodic::Searchable;
use contactbench_ground::periodic::{ContactList, List, Periodic};
use contactbench_ground::probe::{Op, Probe, Tally};
use contactbench_ground::radix::prefetch_to_read;
use contactbench_ground::scene::{AnyScene, Lattice, Radii, Real, Scene, array};
use contactbench_ground::wide::{Kernel, Level, Spot, Wide};

const BLOCK: usize = 128;

/// Particles and their neighbour list between frames. Particles that are near each other in space
/// have adjacent places in memory; listed pairs are numbered by places.
#[derive(Default)]
pub(super) struct Kept<const D: usize> {
    /// Number of the particle at each place, and its position in the last frame in f32.
    spots: Vec<Spot>,
    unit: Unit<D>,
    then: Vec<Point<f64, D>>,
    /// Positions in the last frame, in f64, for rules that need displacements from frame to frame.
    last: Vec<Point<f64, D>>,
    radii: KeptRadii,
    listed: Room,
    /// Half of the list's skin, as a length.
    half: f64,
    /// Largest rounding that the contact test may add to its reach without making the list invalid.
    rounding: f64,
    /// Frames since the list was built, or `None` without a list.
    age: Option<u32>,
    /// Sum over the frames since the list was built of each frame's largest displacement.
    summed: f64,
    around: Around<D>,
}

impl<const D: usize> Kept<D> {
    pub fn forget(&mut self) {
        self.age = None;
    }

    /// Returns the bytes of all arrays; spare capacity of the list is not included.
    pub fn bytes(&self) -> u64 {
        let n = self.spots.len();
        let radii = match self.radii {
            KeptRadii::Each { .. } => 16 * n as u64,
            KeptRadii::Uniform(_) => 0,
        };
        let pairs = self.listed.len().max(cells::room(n)) as u64;
        (n + self.last.len()) as u64 * POINT * D as u64
            + n as u64 * SPOT
            + radii
            + pairs * PAIR_BYTES
            + self.around.bytes()
    }

    /// Updates the particles to this frame. Returns the age of the list in frames and the
    /// displacements, or `None` if the list is missing, or if it was built for other particles, for
    /// another kind of box, or for a contact test that rounds less.
    pub fn follow<T: Real>(
        &mut self,
        scene: &Scene<'_, T, D>,
        lattice: Option<&Lattice>,
        rule: Rule,
        rounding: f64,
    ) -> Option<(u32, Displacements)> {
        let age = self.age?.saturating_add(1);
        let same = scene.len() == self.spots.len() && self.radii.are(scene);
        if !same || rounding > self.rounding || !self.around.serves(lattice) {
            return None;
        }
        let (centres, looks) = (scene.centres(), rule.looks(age));
        let (top, step) = Level::best().run(Follow { kept: self, centres, looks });
        if 2.0 * self.around.off() > self.rounding {
            return None;
        }
        let (first, second) = (at_most(top.first), at_most(top.second));
        // The sum is at least the largest displacement, as in real numbers.
        self.summed = (self.summed + at_most(step.first)).next_up().max(first);
        self.age = Some(age);
        Some((age, Displacements { square: top.first, first, second, summed: self.summed }))
    }

    /// Lists all pairs of this frame whose gap is at most twice `half` plus the rounding of the
    /// contact test. All centres are within `corners`. Returns false if the box is so long that
    /// rounding makes a list useless.
    pub fn build<T: Real>(
        &mut self,
        scene: &Scene<'_, T, D>,
        corners: Corners<D>,
        list: &Wanted<'_>,
        search: &mut Searcher,
        mut tally: Option<&mut Tally>,
    ) -> Result<bool, Refusal>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        self.age = None;
        let Wanted { half, rounding, rule, lattice } = *list;
        let (n, skin, limit) = (scene.len(), 2.0 * half, search.memory_limit());
        let rounding = rounding + self.around.begin(lattice, n, corners)?;
        let largest = scene.largest_radius().wide();
        if rounding > 4.0 * (largest + half) {
            return Ok(false);
        }
        let margin = if rounding == 0.0 { half } else { (half + 0.5 * rounding).next_up() };
        let larger = |r: f64| (r + margin).next_up();
        if !(2.0 * larger(largest)).is_finite() {
            return Err(Refusal::Skin { skin, diameter: 2.0 * largest });
        }
        let last = if rule.looks(1) == Looks::SinceFrame { n } else { 0 };
        let needed = needed(scene, last, lattice.is_some());
        if needed > limit {
            let shape = format!("{n} particles, without the list");
            return Err(Refusal::Memory { detector: "verlet", needed, limit, shape });
        }
        self.place(scene, corners, last)?;
        if let Some(tally) = tally.as_deref_mut() {
            tally.add(Op::Integerise, (n * D) as u64);
            tally.add(Op::Move, n as u64);
        }
        let radii = self.radii.each(larger)?;
        self.list(radii, lattice, search, tally).map_err(|refusal| match refusal {
            Refusal::Pairs { found, particles, room } if skin > 0.0 => {
                Refusal::Listed { found, particles, room, skin }
            }
            other => other,
        })?;
        (self.age, self.summed) = (Some(0), 0.0);
        (self.half, self.rounding) = (half, rounding);
        Ok(true)
    }

    /// Lists the pairs that touch if the particles in their places have these radii.
    fn list(
        &mut self,
        radii: Radii<'_, f64>,
        lattice: Option<&Lattice>,
        search: &mut Searcher,
        tally: Option<&mut Tally>,
    ) -> Result<(), Refusal>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let wider: AnyScene<'_> =
            Scene::new(&self.then[..], radii).map_err(|_| Refusal::Range)?.into();
        self.listed.clear();
        let mut contacts = ContactList {
            plain: std::mem::take(&mut self.listed),
            shifted: std::mem::take(&mut self.around.through),
        };
        let listed = match lattice {
            None => search.find(Searchable::Open(&wider, Test::Exact), tally, &mut contacts),
            Some(lattice) => {
                Periodic::new(wider, *lattice).map_err(|_| Refusal::Range).and_then(|wider| {
                    search.find(Searchable::Boxed(&wider, Arithmetic::Exact), tally, &mut contacts)
                })
            }
        };
        (self.listed, self.around.through) = (contacts.plain, contacts.shifted);
        listed.map(drop)
    }

    /// Puts the scene's particles into their places, and keeps `last` positions of this frame.
    fn place<T: Real>(
        &mut self,
        scene: &Scene<'_, T, D>,
        corners: Corners<D>,
        last: usize,
    ) -> Result<(), Refusal> {
        let (n, centres) = (scene.len(), scene.centres());
        self.spots.clear();
        reserve(&mut self.spots, n)?;
        self.spots.resize(n, Spot::default());
        for (points, len) in [(&mut self.then, n), (&mut self.last, last)] {
            points.clear();
            reserve(points, len)?;
        }
        let points = centres.iter().map(|centre| array(centre).map(Real::wide));
        cells::places(points, corners, &mut self.listed, |particle, place| {
            self.spots[place].id = particle;
        })?;
        self.then.extend(self.spots.iter().map(|spot| wide(&centres[spot.id as usize])));
        self.last.extend_from_slice(&self.then[..last]);
        self.unit = Unit::new(corners, 2.0 * scene.largest_radius().wide());
        for (spot, at) in self.spots.iter_mut().zip(&self.then) {
            self.unit.put(spot, at);
        }
        self.radii.take(scene, &self.spots)
    }

    pub fn skin(&self) -> f64 {
        2.0 * self.half
    }

    /// Returns the number of listed pairs, including pairs with images.
    pub fn listed(&self) -> u64 {
        self.listed.len() as u64 + self.around.through.len() as u64
    }

    /// Appends the listed pairs that touch in this frame to `pairs`. Returns the number of tests
    /// that used exact arithmetic.
    pub fn pass<T: Real, B: Particles<T, D>>(&self, particles: B, pairs: &mut PairList<'_>) -> u64 {
        let mut tally = Tally::default();
        let touch = |i, j| particles.touch(i, j, &mut tally);
        self.pass_to(particles.slack(), &mut Open { touch, pairs });
        tally.get(Op::ExactTest)
    }

    pub fn pass_in_box(
        &self,
        scene: &Scene<'_, f64, D>,
        test: Test,
        plain: &mut PairList<'_>,
        shifted: &mut List,
    ) -> u64 {
        let (spots, around) = (&self.spots, &self.around);
        let mut boxed = Boxed { scene, test, spots, around, plain, shifted, exact: 0 };
        self.pass_to(self.around.slack(), &mut boxed);
        self.around.through.iter().for_each(|&triple| boxed.decide_image(triple));
        boxed.exact
    }

    fn pass_to(&self, slack: Slack, answer: &mut impl PairReceiver) {
        let near = self.unit.near(slack);
        match &self.radii {
            KeptRadii::Each { placed, .. } => self.pass_by(Each { placed, near }, answer),
            KeptRadii::Uniform(r) => self.pass_by(Same(near(r + r)), answer),
        }
    }

    fn pass_by<A: PairReceiver>(&self, reach: impl Reach, answer: &mut A) {
        let (spots, listed) = (&self.spots[..], &self.listed[..]);
        Level::best().run(Pass { spots, listed, reach, answer });
    }
}

struct Follow<'a, T: Real, const D: usize> {
    kept: &'a mut Kept<D>,
    centres: &'a [Point<T, D>],
    looks: Looks,
}

impl<T: Real, const D: usize> Kernel for Follow<'_, T, D> {
    /// Largest two displacements since the list was built, and since the last frame.
    type Output = (TopTwo, TopTwo);

    #[inline(always)]
    fn run<W: Wide>(self, _: W) -> (TopTwo, TopTwo) {
        let Follow { kept, centres, looks } = self;
        let (top, step, unit) = (TopTwo::default(), TopTwo::default(), kept.unit.begun());
        let mut seen = Seen { unit, top, step, looks, last: &mut kept.last };
        if kept.around.is_box() {
            let mut block = [Point::origin(); BLOCK];
            let blocks = kept.spots.chunks_mut(BLOCK).zip(kept.then.chunks(BLOCK));
            for (k, (spots, then)) in blocks.enumerate() {
                // This loop only reads memory, so that many reads wait at the same time.
                for (at, spot) in block.iter_mut().zip(&*spots) {
                    *at = wide(&centres[spot.id as usize]);
                }
                let at = &mut block[..spots.len()];
                kept.around.bring(at, then, k * BLOCK);
                for (j, ((spot, at), then)) in spots.iter_mut().zip(&*at).zip(then).enumerate() {
                    seen.put(spot, at, then, k * BLOCK + j);
                }
            }
        } else {
            /// Number of particles that are fetched while one is updated, to hide the latency of
            /// memory.
            const AHEAD: usize = 16;
            for (place, then) in kept.then.iter().enumerate().take(kept.spots.len()) {
                if let Some(next) = kept.spots.get(place + AHEAD) {
                    prefetch_to_read(centres, next.id as usize);
                }
                let spot = &mut kept.spots[place];
                seen.put(spot, &wide(&centres[spot.id as usize]), then, place);
            }
        }
        let Seen { unit, top, step, .. } = seen;
        kept.unit = unit;
        (top, step)
    }
}

/// Particles of a frame that were stored so far.
struct Seen<'a, const D: usize> {
    unit: Unit<D>,
    top: TopTwo,
    step: TopTwo,
    looks: Looks,
    last: &'a mut [Point<f64, D>],
}

impl<const D: usize> Seen<'_, D> {
    /// Stores a particle, and measures its displacement if the rule needs it.
    #[inline(always)]
    fn put(&mut self, spot: &mut Spot, at: &Point<f64, D>, then: &Point<f64, D>, place: usize) {
        self.unit.put(spot, at);
        if self.looks != Looks::Nowhere {
            self.top.take(square(array(at), array(then)));
        }
        if self.looks == Looks::SinceFrame {
            self.step.take(square(array(at), array(&self.last[place])));
            self.last[place] = *at;
        }
    }
}

const POINT: u64 = size_of::<f64>() as u64;

const SPOT: u64 = size_of::<Spot>() as u64;

/// Properties of a list that is to be built.
pub(super) struct Wanted<'a> {
    pub half: f64,
    /// Largest amount that rounding adds to the reach of the contact test, as a length.
    pub rounding: f64,
    pub rule: Rule,
    pub lattice: Option<&'a Lattice>,
}

/// Returns the bytes needed to build a list, without the list.
fn needed<T: Real, const D: usize>(scene: &Scene<'_, T, D>, last: usize, boxed: bool) -> u64 {
    let n = scene.len();
    let each = match scene.radii() {
        // Bytes of three radii per particle: in the scene's order, by place, and enlarged.
        Radii::Each(_) => 24,
        Radii::Uniform(_) => 0,
    };
    (n + last) as u64 * POINT * D as u64
        + n as u64 * (SPOT + each)
        + cells::room(n) as u64 * PAIR_BYTES
        + if boxed { 8 * n.div_ceil(64) as u64 } else { 0 }
}

fn wide<T: Real, const D: usize>(centre: &Point<T, D>) -> Point<f64, D> {
    Point::from(array(centre).map(Real::wide))
}
