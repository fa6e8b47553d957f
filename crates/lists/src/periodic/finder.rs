//! Finds the contacts of periodic scenes with any detector; buffers are kept between calls.

use super::crowded;
use super::images::Images;
use super::made::Made;
use super::stored::Copies;
use contactbench_ground::contact::{Arithmetic, Asked, Decided};
use contactbench_ground::detect::any::{AnyDetector, Of, Searched, Task};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::pair_list::{Allowance, PairList};
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::periodic::{ContactList, List};
use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_ground::probe::{Op, Probe, Silent, Tally};
use contactbench_ground::scene::{AnyScene, Scene};
use contactbench_ground::wide::{Kernel, Level, Slot, Wide};

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
        contacts: &mut ContactList,
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
        contacts: &mut ContactList,
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
    contacts: &'a mut ContactList,
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
        let (level, singles) = (Level::best(), [[0; 2]; BATCH]);
        let mut sorted = Sorted { made: &made, level, plain, shifted, singles, waiting: 0 };
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
        sorted.sort_singles();
        let Sorted { plain, shifted, .. } = sorted;
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
    /// Pairs that were found one by one; the first `waiting` are not handed on yet.
    singles: [[u32; 2]; BATCH],
    waiting: usize,
}

/// Number of pairs that are examined together, and copied together if none has an image.
const TOGETHER: usize = 8;
/// Number of pairs that are sorted before the images among them are looked up. Lookups of single
/// images would wait for memory one by one; those of a batch overlap.
const BATCH: usize = 256;

impl<const D: usize> Sink for Sorted<'_, D> {
    fn contact(&mut self, a: u32, b: u32) {
        let plain = self.made.are_as_given() && a.max(b) < self.made.particles();
        if plain || self.made.are_together(a, b) {
            return self.plain.contact(a, b);
        }
        self.singles[self.waiting % BATCH] = [a, b];
        self.waiting += 1;
        if self.waiting == BATCH {
            self.sort_singles();
        }
    }

    fn contacts(&mut self, pairs: &[[u32; 2]]) {
        for pairs in pairs.chunks(BATCH) {
            if self.made.are_as_given() {
                self.level.run(Sort::<D, false>(self, pairs));
            } else {
                self.level.run(Sort::<D, true>(self, pairs));
            }
        }
    }
}

impl<const D: usize> Sorted<'_, D> {
    fn sort_singles(&mut self) {
        let (singles, waiting) = (self.singles, std::mem::take(&mut self.waiting));
        self.contacts(&singles[..waiting]);
    }
}

/// Separates at most [`BATCH`] pairs. `MOVED`: whether particles were moved into the box.
struct Sort<'s, 'a, 'p, const D: usize, const MOVED: bool>(&'s mut Sorted<'a, D>, &'p [[u32; 2]]);

impl<const D: usize, const MOVED: bool> Kernel for Sort<'_, '_, '_, D, MOVED> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide>(self, _: W) {
        let Sort(Sorted { made, plain, shifted, .. }, pairs) = self;
        let n = made.particles();
        let is_plain = |[a, b]: [u32; 2]| {
            if MOVED { made.are_together(a, b) } else { (a < n) & (b < n) }
        };
        let [mut own, mut others] = [[Slot::uninit(); BATCH]; 2];
        let [mut keep, mut other] = [0; 2];
        let space = plain.space(BATCH).and_then(<[_]>::first_chunk_mut);
        let listed = space.is_some();
        let kept = space.unwrap_or(&mut own);
        let (together, rest) = pairs.as_chunks::<TOGETHER>();
        for some in together.iter().map(|some| &some[..]).chain([rest]) {
            if some.len() == TOGETHER && some.iter().fold(true, |all, &pair| all & is_plain(pair)) {
                kept[keep..keep + TOGETHER].write_copy_of_slice(some);
                keep += TOGETHER;
                continue;
            }
            // Without branches, because which pairs involve an image is unpredictable.
            for &pair in some {
                let plain = is_plain(pair);
                kept[keep % BATCH].write(pair);
                others[other % BATCH].write(pair);
                keep += usize::from(plain);
                // Pairs of two images are dropped.
                other += usize::from(!plain & ((pair[0] < n) | (pair[1] < n)));
            }
        }
        if listed {
            // SAFETY: the first `keep` pairs of the space were written.
            unsafe { plain.written(keep) };
        } else {
            // SAFETY: the first `keep` pairs were written.
            plain.contacts(unsafe { own[..keep].assume_init_ref() });
        }
        // SAFETY: as for `own`.
        let others = unsafe { others[..other].assume_init_ref() };
        if !MOVED {
            return shifted.append(others, |[a, b]| made.through(a, b));
        }
        for &[a, b] in others {
            match made.pair(a, b) {
                Some(ImagePair { i, j, image: [0, 0, 0] }) => plain.contact(i, j),
                Some(pair) => shifted.push(pair),
                None => {}
            }
        }
    }
}
