//! Finds the contacts of periodic scenes with any detector; buffers are kept between calls.

use super::contacts::{Contacts, List};
use super::crowded;
use super::images::Images;
use super::made::Made;
use super::stored::Copies;
use super::{ImagePair, Periodic};
use crate::contact::{Arithmetic, Asked, Decided};
use crate::detect::any::{AnyDetector, Of, Searched, Task};
use crate::pair_list::{Allowance, PairList};
use crate::probe::{Op, Probe, Silent, Tally};
use crate::refusal::Refusal;
use crate::scene::{AnyScene, Scene};
use crate::sink::Sink;
use crate::wide::{Kernel, LANES, Level, Wide, fill};

/// Finds contacts in periodic boxes with any detector, and keeps its buffers between calls.
pub struct Finder {
    /// Limit in bytes for the images, and for each list of contacts.
    limit: u64,
    plane: Buffers<2>,
    space: Buffers<3>,
    bytes: u64,
    images: u64,
    found: u64,
}

#[derive(Default)]
struct Buffers<const D: usize> {
    images: Images<D>,
    copies: Copies<D>,
}

impl Finder {
    /// Creates a finder. Images, and each list of contacts, may take `limit` bytes each.
    pub fn new(limit: u64) -> Finder {
        let (plane, space) = (Buffers::default(), Buffers::default());
        Finder { limit, plane, space, bytes: 0, images: 0, found: 0 }
    }

    /// Appends all contacts to `contacts`. Benchmarks time this call. A second call for a scene of
    /// the same shape allocates nothing beyond what the detector allocates.
    ///
    /// # Errors
    /// Returns the refusals of the detector for the scene with its images and those of
    /// [`Images::make`](super::images::Images::make). Returns [`Refusal::Pairs`] if a list would
    /// exceed its limit; in small boxes [`Refusal::Crowd`], before the search. Returns
    /// [`Refusal::Stored`] if a rounded arithmetic cannot hold the images. On an error `contacts`
    /// is unchanged.
    pub fn list(
        &mut self,
        periodic: &Periodic<'_>,
        detector: &mut dyn AnyDetector,
        arithmetic: Arithmetic,
        contacts: &mut Contacts,
    ) -> Result<(), Refusal> {
        self.find(periodic, detector, arithmetic, None, contacts)
    }

    /// Returns the bytes for images in the last call, computed by a formula; 0 if the scene was
    /// refused. The formula counts `16 + 8D` per image and `8D + 8` per particle near the lower
    /// faces of the box; `8D + 13` per particle if some are outside the box (and outside the
    /// upright box of a tilted one); 8 per particle and image for individual radii; and a copy of
    /// positions and radii if the arithmetic does not store f64.
    pub fn formula_bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the number of images in the last call; 0 if the scene was refused.
    pub fn images(&self) -> u64 {
        self.images
    }

    /// Returns the number of contacts found in the last call, even if the list was then refused.
    pub fn found(&self) -> u64 {
        self.found
    }

    /// Appends all contacts as [`Finder::list`] does. If a tally is given, all operations are
    /// counted, including the images made.
    pub fn find(
        &mut self,
        periodic: &Periodic<'_>,
        detector: &mut dyn AnyDetector,
        arithmetic: Arithmetic,
        tally: Option<&mut Tally>,
        contacts: &mut Contacts,
    ) -> Result<(), Refusal> {
        let Finder { limit, plane, space, bytes, images, found } = self;
        (*bytes, *images, *found) = (0, 0, 0);
        let search =
            Search { periodic, detector, arithmetic, limit: *limit, tally, contacts, found };
        (*bytes, *images) = match periodic.scene() {
            AnyScene::Plane(scene) => search.among(&scene.widened(), plane),
            AnyScene::Space(scene) => search.among(&scene.widened(), space),
        }?;
        Ok(())
    }
}

struct Search<'a> {
    periodic: &'a Periodic<'a>,
    detector: &'a mut dyn AnyDetector,
    arithmetic: Arithmetic,
    limit: u64,
    tally: Option<&'a mut Tally>,
    contacts: &'a mut Contacts,
    found: &'a mut u64,
}

impl Search<'_> {
    /// Appends the contacts of the scene. Returns the bytes held and the number of images.
    fn among<const D: usize>(
        self,
        scene: &Scene<'_, f64, D>,
        buffers: &mut Buffers<D>,
    ) -> Result<(u64, u64), Refusal>
    where
        for<'x> Searched<'x>: From<Of<'x, D>>,
    {
        let Search { periodic, detector, arithmetic, limit, tally, contacts, found } = self;
        let made = buffers.images.make(scene, periodic.lattice(), arithmetic, limit)?;
        crowded::within(&made, limit)?;
        let (test, decide) = (arithmetic.test(), |a, b| made.touch(a, b));
        let stored = buffers.copies.of(&made, arithmetic)?;
        let searched = Searched::from(match &stored {
            Some(stored) => Of::Scene(stored, test),
            None if arithmetic.is_exact() => {
                let (slack, owners) = (made.slack, made.particles());
                let asked = Asked { slack, owners, decide: &decide };
                Of::Images(made.imaged(Decided::Asked(asked)))
            }
            None => Of::Images(made.imaged(Decided::Test(test))),
        });
        let allowance = Allowance::new(limit);
        let plain = PairList::behind(std::mem::take(&mut contacts.plain), &allowance);
        let shifted = List::behind(std::mem::take(&mut contacts.shifted), limit);
        let level = Level::best();
        let waiting = Pairs { pairs: [[0; 2]; WAITING + 1], len: 0 };
        let mut sorted = Sorted { made: &made, level, plain, shifted, waiting };
        let (owners, spared) = (made.particles(), crowded::spares_images(&made));
        let result = match tally {
            None if spared => crowded::search(&searched, owners, &mut Silent, &mut sorted),
            None => {
                // The list has no allowance, so it passes all pairs on to the sink.
                let none = Allowance::new(0);
                let mut door = PairList::door(&mut sorted, &none);
                detector.search(&searched, Task::List(&mut door))
            }
            Some(tally) => {
                tally.add(Op::GhostMade, made.ghosts());
                match spared {
                    true => crowded::search(&searched, owners, tally, &mut sorted),
                    false => detector.search(&searched, Task::Count(tally, &mut sorted)),
                }
            }
        };
        let (plain, shifted) = sorted.end();
        *found = plain.found() + shifted.found();
        contacts.end(plain, shifted, scene.len(), result)?;
        Ok((made.bytes(), made.ghosts()))
    }
}

/// Sorts the pairs that a detector finds into contacts without and with a shift.
struct Sorted<'a, const D: usize> {
    made: &'a Made<'a, D>,
    level: Level,
    plain: PairList<'a>,
    shifted: List,
    /// Pairs with an image, or of particles that were moved differently. They are looked up
    /// together, because single lookups during the detection wait for memory.
    waiting: Pairs<{ WAITING + 1 }>,
}

struct Pairs<const N: usize> {
    pairs: [[u32; 2]; N],
    len: usize,
}

impl<const N: usize> Pairs<N> {
    /// Adds a pair if `flag` is set, without a branch, because flags are unpredictable.
    #[inline(always)]
    fn add(&mut self, pair: [u32; 2], flag: bool) {
        self.pairs[self.len] = pair;
        self.len += usize::from(flag);
    }

    #[inline(always)]
    fn add_all(&mut self, pairs: &[[u32; 2]; LANES]) {
        self.pairs[self.len..][..LANES].copy_from_slice(pairs);
        self.len += LANES;
    }
}

/// Number of pairs that are copied together if none of them must be looked up.
const TOGETHER: usize = 4 * LANES;
const WAITING: usize = 16 * LANES;

impl<const D: usize> Sink for Sorted<'_, D> {
    fn contact(&mut self, a: u32, b: u32) {
        let (n, made) = (self.made.particles(), self.made);
        if made.are_as_given() && a.max(b) < n || made.are_together(a, b) {
            return self.plain.contact(a, b);
        }
        self.look_up([a, b]);
    }

    fn contacts(&mut self, pairs: &[[u32; 2]]) {
        self.level.run(Sort(self, pairs));
    }
}

struct Sort<'s, 'a, 'p, const D: usize>(&'s mut Sorted<'a, D>, &'p [[u32; 2]]);

impl<const D: usize> Kernel for Sort<'_, '_, '_, D> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide>(self, _: W) {
        let Sort(sorted, pairs) = self;
        let (n, made) = (sorted.made.particles(), sorted.made);
        if made.are_as_given() {
            sorted.sort(pairs, |[a, b]| (a < n) & (b < n));
        } else {
            sorted.sort(pairs, |[a, b]| made.are_together(a, b));
        }
    }
}

impl<'a, const D: usize> Sorted<'a, D> {
    /// Copies pairs that are `plain` (two particles moved alike), keeps pairs that must be looked
    /// up, and drops pairs of two images. Most groups hold pairs of one kind.
    #[inline(always)]
    fn sort(&mut self, pairs: &[[u32; 2]], plain: impl Fn([u32; 2]) -> bool) {
        let n = self.made.particles();
        for some in pairs.chunks(TOGETHER) {
            if some.iter().fold(true, |all, &pair| all & plain(pair)) {
                self.plain.contacts(some);
                continue;
            }
            if self.waiting.len > WAITING - TOGETHER {
                self.settle();
            }
            let mut kept = Pairs { pairs: [[0; 2]; TOGETHER + 1], len: 0 };
            let (groups, rest) = some.as_chunks::<LANES>();
            // No body has this number, so it is dropped like an image.
            let mut last = [[u32::MAX; 2]; LANES];
            last[..rest.len()].copy_from_slice(rest);
            for group in groups.iter().chain([&last]) {
                let plains: [bool; LANES] = fill(|k| plain(group[k]));
                let others: [bool; LANES] = fill(|k| {
                    let [a, b] = group[k];
                    !plains[k] & ((a < n) | (b < n))
                });
                let count =
                    |flags: &[bool; LANES]| flags.iter().fold(0, |n, &flag| n + u8::from(flag));
                match (usize::from(count(&plains)), usize::from(count(&others))) {
                    (0, 0) => {}
                    (LANES, _) => kept.add_all(group),
                    (_, LANES) => self.waiting.add_all(group),
                    _ => {
                        for k in 0..LANES {
                            kept.add(group[k], plains[k]);
                            self.waiting.add(group[k], others[k]);
                        }
                    }
                }
            }
            self.plain.contacts(&kept.pairs[..kept.len]);
        }
    }

    #[inline(never)]
    fn settle(&mut self) {
        for k in 0..std::mem::take(&mut self.waiting.len) {
            self.look_up(self.waiting.pairs[k]);
        }
    }

    fn look_up(&mut self, [a, b]: [u32; 2]) {
        match self.made.pair(a, b) {
            Some(ImagePair { i, j, image: [0, 0, 0] }) => self.plain.contact(i, j),
            Some(pair) => self.shifted.push(pair),
            None => {}
        }
    }

    fn end(mut self) -> (PairList<'a>, List) {
        self.settle();
        (self.plain, self.shifted)
    }
}
