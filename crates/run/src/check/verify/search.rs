//! Searches for the common mistakes that explain a list, by trying [`ROWS`] in turn.

use crate::check::verify::compare::{Against, Compared};
use crate::check::verify::listing::{ImagesOf, Listing, Taking};
use crate::check::verify::mistake::{Mistake, Reading};
use crate::check::verify::rows::{At, Each, Kind, ROWS};
use crate::check::verify::{Job, Naming, WORST, with_skin};
use contactbench_detectors::near::contacts;
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic};
use contactbench_ground::scene::Lattice;
use contactbench_scenes::touching::particle;

/// Largest overlap or gap, in mean radii, that may be due to rounding to f32.
const ROUNDED: f64 = 1e-3;
/// Largest overlap or gap of a tangent pair, in mean radii.
const TANGENT: f64 = 1e-9;
/// Maximum number of particles for trying two mistakes at once (about twenty detections).
const FEW: usize = 100_000;

pub(super) struct Search<'a> {
    pub job: &'a Job<'a>,
    pub may_guess: bool,
    /// The list, in the interpretation of numbers and images with the fewest differences.
    pub listing: Listing,
    /// The mistakes that `listing` assumes.
    of_list: Vec<Mistake>,
    pub found: Compared,
    best: Reading,
}

impl<'a> Search<'a> {
    pub fn best(
        job: &'a Job<'a>,
        truth: &ContactList,
        may_guess: bool,
    ) -> anyhow::Result<Option<Reading>> {
        let (mut search, given) = Search::of_list(job, truth, may_guess)?;
        let at = At { space: job.space, truth };
        search.try_all(at, &[], &[Kind::Part, Kind::Tie, Kind::Size, Kind::Box]);
        if search.best.wrong > 0 && job.space.scene().len() <= FEW {
            search.two_at_once(job.space);
        }
        if search.best.wrong > 0 && job.list.images.is_some() {
            search.without_images(at)?;
        }
        Ok(Some(search.best).filter(|reading| reading.wrong < given.div_ceil(2)))
    }

    /// Tries all interpretations of numbers, directions and images. Also returns how many pairs
    /// differ if no mistake is assumed.
    fn of_list(
        job: &'a Job<'a>,
        truth: &ContactList,
        may_guess: bool,
    ) -> anyhow::Result<(Search<'a>, u64)> {
        let mut search = Search {
            job,
            may_guess,
            listing: Listing::default(),
            of_list: Vec::new(),
            found: Compared::default(),
            best: Reading { wrong: u64::MAX, ..Reading::plain(0) },
        };
        let cells = cells(job.space);
        let mut images = vec![(None, ImagesOf::Second)];
        if job.list.images.is_some() {
            images.push((Some(Mistake::ImagesOfFirst), ImagesOf::First));
            if cells.iter().any(|cell| *cell != [0; 3]) {
                images.push((Some(Mistake::ImagesWrapped), ImagesOf::Wrapped(&cells)));
            }
        }
        let mut given = None;
        for naming in std::iter::once(job.naming).chain(job.others) {
            for &(mistake, images) in &images {
                for both_sides in [false, true] {
                    let taking = Taking { naming, images, both_sides, without: None };
                    let listing = Listing::new(job.list, taking, job.space.scene().len())?;
                    let found = search.against(job.space, truth).hold(&listing);
                    let wrong = found.errors.wrong() + listing.faults();
                    given.get_or_insert(wrong);
                    if wrong < search.best.wrong {
                        let meaning = naming.meaning();
                        let other = (meaning != job.naming.meaning()).then_some(meaning);
                        search.of_list = [
                            other.map(Mistake::Numbers),
                            both_sides.then_some(Mistake::BothSides),
                            mistake,
                        ]
                        .into_iter()
                        .flatten()
                        .collect();
                        let listed = job.list.pairs.len() as u64;
                        let listed = if both_sides { listed.div_ceil(2) } else { listed };
                        let mistakes = search.of_list.clone();
                        search.best = Reading { mistakes, listed, wrong };
                        (search.listing, search.found) = (listing, found);
                    }
                }
            }
        }
        Ok((search, given.unwrap_or_default()))
    }

    /// Tries the mistakes of these kinds, each together with those in `before`, until all
    /// differences are explained.
    fn try_all(&mut self, at: At<'_>, before: &[Mistake], kinds: &[Kind]) {
        let errors = self.found.errors;
        let near = errors.duplicate + errors.self_pairs + self.listing.faults();
        let small = errors.missed + errors.spurious > 0 && self.largest() <= ROUNDED;
        for row in ROWS.iter().filter(|row| kinds.contains(&row.kind)) {
            if row.kind == Kind::Tie && !small {
                continue;
            }
            let most = match row.kind {
                Kind::Size => near + self.found.spurious.far,
                _ if before.is_empty() => u64::MAX,
                _ => 0,
            };
            for tries in row.tries {
                let mut better = Vec::new();
                tries(self, at, &mut |mistake, contacts| {
                    let found = self.against(self.job.space, &contacts).hold(&self.listing);
                    let wrong = found.errors.wrong() + self.listing.faults();
                    better.push((mistake, wrong));
                    wrong > 0
                });
                for (mistake, wrong) in better.into_iter().filter(|(_, wrong)| *wrong <= most) {
                    self.consider(before, mistake, wrong);
                }
                if self.best.wrong == 0 {
                    return;
                }
            }
        }
        if small && before.is_empty() && self.largest() < TANGENT {
            self.consider(before, Mistake::Tangent, near);
        }
    }

    fn consider(&mut self, before: &[Mistake], mistake: Mistake, wrong: u64) {
        if wrong < self.best.wrong {
            let mistakes = [&self.of_list, before, &[mistake]].concat();
            self.best = Reading { mistakes, wrong, ..self.best };
        }
    }

    /// Tries two mistakes at once: one about sizes (a skin, or diameters and radii mixed up) and
    /// one about the box.
    fn two_at_once(&mut self, space: &Periodic<'_>) {
        let limit = self.job.terms.memory_limit;
        let Compared { spurious, .. } = &self.found;
        // A single spurious pair does not suggest a skin.
        let skin = (spurious.count - spurious.far > 1).then_some(Mistake::Skin(spurious.gap));
        for mistake in [0.5, 2.0].map(Mistake::Radii).into_iter().chain(skin) {
            let size = |r: f64| match mistake {
                Mistake::Skin(gap) => with_skin(r, gap),
                Mistake::Radii(by) => (by * r).min(f64::MAX),
                _ => r,
            };
            let Ok(sized) = space.resized(size) else { continue };
            let Ok(truth) = contacts(&sized, limit) else { continue };
            let at = At { space: &sized, truth: &truth.into_iter().collect() };
            self.try_all(at, &[mistake], &[Kind::Part, Kind::Box]);
            if self.best.wrong == 0 {
                return;
            }
        }
    }

    fn without_images(&mut self, at: At<'_>) -> anyhow::Result<()> {
        let numbers = self.of_list.iter().find_map(|mistake| match mistake {
            Mistake::Numbers(meaning) => Some(*meaning),
            _ => None,
        });
        let meant = |naming: &&Naming| Some(naming.meaning()) == numbers;
        let naming = self.job.others.iter().find(meant).unwrap_or(self.job.naming);
        let both_sides = self.of_list.contains(&Mistake::BothSides);
        let taking = Taking { naming, images: ImagesOf::LeftOut, both_sides, without: None };
        let listing = Listing::new(self.job.list, taking, at.space.scene().len())?;
        let found = self.against(at.space, at.truth).hold(&listing);
        let zero = self.job.list.images.into_iter().flatten().all(|image| *image == [0; 3]);
        let of_images = [Mistake::ImagesOfFirst, Mistake::ImagesWrapped];
        self.of_list.retain(|mistake| !of_images.contains(mistake));
        let wrong = found.errors.wrong() + listing.faults();
        self.consider(&[], Mistake::ImagesLeftOut { zero }, wrong);
        Ok(())
    }

    pub fn against<'b>(&self, space: &'b Periodic<'b>, truth: &'b ContactList) -> Against<'b> {
        const NONE: &ContactList = &ContactList { plain: Vec::new(), shifted: Vec::new() };
        Against { space, truth, near: NONE, skin: 0.0, kept: WORST }
    }

    /// Returns the largest overlap or gap of a differing pair, in mean radii.
    pub fn largest(&self) -> f64 {
        self.found.errors.deepest_miss.max(self.found.errors.widest_false)
    }

    /// Returns whether at least `least` spurious pairs are not distant, and no contact is missed.
    pub fn is_larger(&self, least: u64) -> bool {
        let Compared { errors, spurious, .. } = &self.found;
        errors.missed == 0 && spurious.count - spurious.far >= least
    }

    /// Returns whether at least `least` contacts are missed, and all spurious pairs are distant.
    pub fn is_smaller(&self, least: u64) -> bool {
        let Compared { errors, spurious, .. } = &self.found;
        errors.missed >= least && spurious.count == spurious.far
    }

    /// Tries radii multiplied by `by` and a margin `more`, with the contacts that `keep` selects.
    pub fn with_radii(
        &self,
        at: At<'_>,
        by: f64,
        more: f64,
        keep: impl Fn(ImagePair) -> bool,
        each: Each<'_>,
    ) {
        let sized = at.space.resized(|r| (by * more * r).min(f64::MAX));
        let found = sized.ok().and_then(|sized| contacts(&sized, self.job.terms.memory_limit).ok());
        if let Some(contacts) = found.filter(|contacts| !contacts.is_empty()) {
            let kept = contacts.into_iter().filter(|&pair| keep(pair)).collect();
            each(Mistake::Radii(by), kept);
        }
    }

    pub fn in_box(
        &self,
        at: At<'_>,
        mistake: Mistake,
        (vectors, axes): ([[f64; 3]; 3], [bool; 3]),
        each: Each<'_>,
    ) -> bool {
        let lattice = Lattice::new(vectors, axes, at.space.lattice().origin());
        let Ok(lattice) = lattice else { return true };
        let Ok(boxed) = Periodic::new(at.space.scene().clone(), lattice) else { return true };
        let found = contacts(&boxed, self.job.terms.memory_limit);
        found.map_or(true, |found| each(mistake, found.into_iter().collect()))
    }
}

/// Returns the periodic copy of the box in which each particle lies.
fn cells(space: &Periodic<'_>) -> Vec<[i32; 3]> {
    let lattice = space.lattice();
    let cell = |k: u32| {
        let (centre, _) = particle(space.scene(), k);
        std::array::from_fn(|v| {
            let (dual, corner) = (lattice.dual(v), lattice.origin());
            let at: f64 = (0..3).map(|k| (centre[k] - corner[k]) * dual[k]).sum();
            if lattice.periodic()[v] { at.floor() as i32 } else { 0 }
        })
    };
    (0..space.scene().len() as u32).map(cell).collect()
}
