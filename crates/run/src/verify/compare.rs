//! Compares a contact list with the true contacts.

use crate::tracking::nearest;
use crate::verify::Verification;
use crate::verify::listing::Listing;
use contactbench_detectors::oracle::loaded::{Difference, differences};
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic, depth};
use contactbench_scenes::touching::gap;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Taken {
    /// Each entry is a pair, and no pair touches through several images.
    #[default]
    Pairs,
    Images,
    /// Each entry is a pair, listed once for each of its images that touches.
    Each,
    /// Each entry is a pair, listed once, however many of its images touch.
    Once,
}

#[derive(Clone, Copy)]
pub(super) struct Against<'a> {
    pub space: &'a Periodic<'a>,
    pub truth: &'a ContactList,
    /// All pairs within the skin; empty if there is no skin.
    pub near: &'a ContactList,
    /// Largest gap of a pair that may be listed without being a contact, as a length.
    pub skin: f64,
    pub kept: usize,
}

impl Against<'_> {
    /// Compares the contacts of a list. Without images, a list may name each pair once or as often
    /// as its images touch; the interpretation with fewer errors is used.
    pub fn hold(&self, listing: &Listing) -> Verification {
        let listed = &listing.contacts;
        if listing.has_images {
            return Verification { taken: Taken::Images, ..self.compare(listed, self.truth) };
        }
        if !self.space.lattice().repeats() && self.truth.shifted.is_empty() {
            return self.compare(listed, self.truth);
        }
        let several = several(self.truth) || several(self.near);
        let truth = if several { &self.deepest() } else { self.truth };
        let once = self.compare(&self.with_images(listed, true), truth);
        if !several {
            return once;
        }
        let each = self.compare(&self.with_images(listed, false), self.truth);
        match once.errors.wrong() < each.errors.wrong() {
            true => Verification { taken: Taken::Once, ..once },
            false => Verification { taken: Taken::Each, ..each },
        }
    }

    fn compare(&self, listed: &ContactList, truth: &ContactList) -> Verification {
        let mut found = Verification::default();
        differences(&listed.plain, &truth.plain, |kind, [i, j]| {
            self.note(&mut found, kind, ImagePair::new(i, j, [0; 3]));
        });
        differences(&listed.shifted, &truth.shifted, |kind, pair| {
            self.note(&mut found, kind, pair);
        });
        worst_first(&mut found.missed, self.kept);
        worst_first(&mut found.spurious, self.kept);
        found
    }

    fn note(&self, found: &mut Verification, kind: Difference, pair: ImagePair) {
        let own = pair.i == pair.j && pair.image == [0; 3];
        let errors = &mut found.errors;
        match kind {
            Difference::Repeated => {
                errors.duplicate += 1;
                found.repeated.extend((found.repeated.len() < self.kept).then_some(pair));
            }
            Difference::Missed => {
                errors.missed += 1;
                self.add(&mut found.missed, &mut errors.deepest_miss, pair);
            }
            Difference::Added if own => {
                errors.self_pairs += 1;
                found.selves.extend((found.selves.len() < self.kept).then_some(pair));
            }
            Difference::Added if self.skin > 0.0 && gap(self.space, pair) <= self.skin => {
                found.within_skin += 1;
            }
            Difference::Added => {
                errors.spurious += 1;
                self.add(&mut found.spurious, &mut errors.widest_false, pair);
                found.widest_gap = found.widest_gap.max(gap(self.space, pair));
            }
        }
    }

    /// Adds a wrong pair to the worst ones, and updates the largest depth.
    fn add(&self, worst: &mut Vec<(ImagePair, f64)>, largest: &mut f64, pair: ImagePair) {
        let depth = depth(self.space, pair);
        *largest = largest.max(depth.abs());
        worst.push((pair, depth));
        if worst.len() >= self.kept.saturating_mul(2).max(1) {
            worst_first(worst, self.kept);
        }
    }

    /// Returns, for each touching pair, the image with the largest overlap.
    fn deepest(&self) -> ContactList {
        let mut pairs: Vec<[u32; 2]> = self.truth.iter().map(|pair| [pair.i, pair.j]).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let deepest = |pair| self.deepest_first(self.truth.of(pair)).into_iter().next();
        pairs.into_iter().filter_map(deepest).collect()
    }

    fn deepest_first(&self, pairs: impl Iterator<Item = ImagePair>) -> Vec<ImagePair> {
        let mut pairs: Vec<ImagePair> = pairs.collect();
        pairs.sort_by(|&a, &b| depth(self.space, b).total_cmp(&depth(self.space, a)));
        pairs
    }

    /// Assigns images to a list without images. Each pair gets its touching images, the deepest
    /// first; then images within the skin; if it has neither, its nearest image.
    fn with_images(&self, listed: &ContactList, once: bool) -> ContactList {
        let mut resolved = Vec::new();
        for same in listed.plain.chunk_by(|a, b| a == b) {
            let pair = same[0];
            let touching = self.deepest_first(self.truth.of(pair));
            let mut known = touching.clone();
            known.sort();
            let beside = self.near.of(pair).filter(|it| known.binary_search(it).is_err());
            let mut images: Vec<ImagePair> = touching.iter().copied().chain(beside).collect();
            if once {
                images.truncate(1);
            }
            let last = images.last().copied().unwrap_or_else(|| match pair {
                [i, j] if i == j => ImagePair::new(i, i, [0; 3]),
                _ => nearest(self.space, pair),
            });
            // If a pair is listed more often than it has such images, the last one is repeated.
            let images = images.into_iter().chain(std::iter::repeat(last));
            resolved.extend(images.take(same.len()));
        }
        let mut resolved: ContactList = resolved.into_iter().collect();
        resolved.sort();
        resolved
    }
}

fn several(contacts: &ContactList) -> bool {
    let ContactList { plain, shifted } = contacts;
    let same = |w: &[ImagePair]| (w[0].i, w[0].j) == (w[1].i, w[1].j);
    shifted.windows(2).any(same)
        || shifted.iter().any(|pair| plain.binary_search(&[pair.i, pair.j]).is_ok())
}

fn worst_first(pairs: &mut Vec<(ImagePair, f64)>, kept: usize) {
    pairs.sort_by(|(p, a), (q, b)| b.abs().total_cmp(&a.abs()).then(p.cmp(q)));
    pairs.truncate(kept);
}
