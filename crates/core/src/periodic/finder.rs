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
use crate::wide::{Kernel, Level, Wide};

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
        let mut sorted = Sorted { made: &made, level: Level::best(), plain, shifted };
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
    /// Contacts with a shift. If no particle was moved, it holds the numbers of a particle and an
    /// image until the detection ends. The images are then looked up in order, because a lookup
    /// during detection misses the cache.
    shifted: List,
}

/// Number of pairs that are examined together, and copied together if none has an image.
const TOGETHER: usize = 8;

impl<const D: usize> Sink for Sorted<'_, D> {
    fn contact(&mut self, a: u32, b: u32) {
        let (n, made) = (self.made.particles(), self.made);
        if made.are_as_given() && a.max(b) < n || made.are_together(a, b) {
            return self.plain.contact(a, b);
        }
        self.other(a, b);
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
            let plain = |pairs: &[[u32; 2]]| {
                !pairs.as_flattened().iter().fold(false, |image, &body| image | (body >= n))
            };
            sorted.sort(pairs, plain);
        } else {
            sorted.sort(pairs, |pairs| {
                pairs.iter().fold(true, |plain, &[a, b]| plain & made.are_together(a, b))
            });
        }
    }
}

impl<'a, const D: usize> Sorted<'a, D> {
    /// Copies runs of pairs that are `plain`, those of two particles, and separates other groups.
    #[inline(always)]
    fn sort(&mut self, pairs: &[[u32; 2]], plain: impl Fn(&[[u32; 2]]) -> bool) {
        let (together, rest) = pairs.as_chunks::<TOGETHER>();
        // Start of the present run: all pairs from here on are pairs of two particles.
        let mut from = 0;
        for (k, some) in together.iter().enumerate() {
            if !plain(some) {
                self.plain.contacts(&pairs[from..k * TOGETHER]);
                self.part(some, &plain);
                from = (k + 1) * TOGETHER;
            }
        }
        if plain(rest) {
            return self.plain.contacts(&pairs[from..]);
        }
        self.plain.contacts(&pairs[from..pairs.len() - rest.len()]);
        self.part(rest, &plain);
    }

    /// Separates the pairs of a group by `plain`, without branches, because which pairs involve an
    /// image is unpredictable.
    #[inline(always)]
    fn part(&mut self, some: &[[u32; 2]], plain: impl Fn(&[[u32; 2]]) -> bool) {
        let n = self.made.particles();
        let (mut kept, mut others) = ([[0; 2]; TOGETHER], [[0; 2]; TOGETHER]);
        let [mut keep, mut other] = [0; 2];
        for pair in some.iter().take(TOGETHER) {
            let plain = plain(std::slice::from_ref(pair));
            (kept[keep], others[other]) = (*pair, *pair);
            keep += usize::from(plain);
            // Pairs of two images are dropped.
            other += usize::from(!plain & ((pair[0] < n) | (pair[1] < n)));
        }
        self.plain.contacts(&kept[..keep]);
        others[..other].iter().for_each(|&[a, b]| self.other(a, b));
    }

    fn other(&mut self, a: u32, b: u32) {
        if self.made.are_as_given() {
            if a.min(b) < self.made.particles() {
                self.shifted.push(ImagePair { i: a.min(b), j: a.max(b), image: [0; 3] });
            }
            return;
        }
        match self.made.pair(a, b) {
            Some(ImagePair { i, j, image: [0, 0, 0] }) => self.plain.contact(i, j),
            Some(pair) => self.shifted.push(pair),
            None => {}
        }
    }

    fn end(mut self) -> (PairList<'a>, List) {
        if self.made.are_as_given() {
            for pair in self.shifted.added() {
                *pair = self.made.through(pair.i, pair.j);
            }
        }
        (self.plain, self.shifted)
    }
}
