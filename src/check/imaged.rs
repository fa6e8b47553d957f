//! A contact list of another code in a box that repeats, compared with the exact truth.
//!
//! A list with images names each contact once, as (i, j, S). A list without them names pairs, and
//! there are two kinds: each pair as often as images of it touch, or once. Both are taken, and it
//! is said which; where all pairs touch through one image they are the same.

use std::collections::HashMap;

use anyhow::Context;

use crate::check::listed::{
    Allowed, Couple, Naming, READING_BYTES, Taken, Terms, Touching, Verification, room_for,
};
use crate::check::reading::{Reading, TakenBox};
use crate::io;
use crate::oracle::Errors;
use crate::periodic::{self, ImagePair, Periodic, depth};
use crate::scene::touching::{contacts, gap, nearest, resized};

mod explain;

/// A list as it was read: pairs, and the image of the second, if there is one.
#[derive(Clone, Copy, Debug)]
pub struct Listed<'a> {
    /// By the numbers that stand there.
    pub pairs: &'a [[i64; 2]],
    /// Of each pair.
    pub images: Option<&'a [[i32; 3]]>,
}

impl Verification {
    /// As [`Verification::new`], in a box. An error also where the list names images along an axis
    /// that is open.
    pub fn in_box(
        periodic: &Periodic<'_>,
        list: Listed<'_>,
        naming: &Naming,
        others: &[Naming],
        terms: Terms,
    ) -> anyhow::Result<Verification> {
        io::boxes::hold(periodic.lattice().periodic(), list.images)?;
        let mut truth = periodic::truth(periodic, terms.arithmetic, terms.memory_limit)?.pairs;
        let mut left_out = [truth.len() as u64, list.pairs.len() as u64];
        if let Some(groups) = terms.without {
            truth.retain(|pair| !groups.leave_out(pair.i, pair.j));
        }
        let part = terms.kept_of(list.pairs, naming, periodic.scene().len()).map(|kept| {
            let pairs: Vec<Couple> = kept.iter().map(|&k| list.pairs[k]).collect();
            let images = list.images.map(|of| kept.iter().map(|&k| of[k]).collect::<Vec<_>>());
            (pairs, images)
        });
        let list = match &part {
            Some((pairs, images)) => Listed { pairs, images: images.as_deref() },
            None => list,
        };
        left_out = [left_out[0] - truth.len() as u64, left_out[1] - list.pairs.len() as u64];
        let near = match terms.allowed.skin {
            skin if skin > 0.0 => within_gap(periodic, skin, terms.memory_limit)?,
            _ => Vec::new(),
        };
        let view = View { periodic, truth: &truth, near: &near, kept: terms.kept };
        let mut found = view.compare(list, naming, terms.allowed)?;
        found.contacts = truth.len() as u64;
        found.left_out = left_out;
        let small = (list.pairs.len() + truth.len()) as u64 * READING_BYTES <= terms.memory_limit;
        if terms.explain && !found.is_same() && terms.plain() && small {
            let namings: Vec<&Naming> = std::iter::once(naming).chain(others).collect();
            found.reading = explain::explain(periodic, list, &namings, &truth, terms)?;
        }
        found.touching = Touching::Boxed(truth);
        Ok(found)
    }
}

impl Verification {
    /// Where a list of an open scene differs: it may be right in the box that the file declares.
    pub fn try_declared(
        &mut self,
        periodic: &Periodic<'_>,
        pairs: &[[i64; 2]],
        naming: &Naming,
        others: &[Naming],
        terms: Terms,
    ) {
        let small = pairs.len() as u64 * READING_BYTES <= terms.memory_limit;
        let none = self.reading.as_ref().is_none_or(|reading| reading.wrong > 0)
            || self.reading.as_ref().is_some_and(|reading| reading.periodic.is_some());
        if !terms.plain() || !small || !none {
            return;
        }
        let list = Listed { pairs, images: None };
        // A hint is not worth an error.
        let Ok(found) = Verification::in_box(periodic, list, naming, others, terms) else { return };
        let as_it_stands =
            Reading { listed: pairs.len() as u64, ..Reading::plain(naming.meaning()) };
        let reading = if found.is_same() { Some(as_it_stands) } else { found.reading };
        if let Some(reading) =
            reading.filter(|reading| reading.wrong == 0 && reading.taken != TakenBox::Open)
        {
            let declared = Some(periodic.lattice().periodic());
            self.reading = Some(Reading { declared, ..reading });
        }
    }
}

/// All pairs that are apart by no more than a length, in order.
fn within_gap(periodic: &Periodic<'_>, most: f64, limit: u64) -> anyhow::Result<Vec<ImagePair>> {
    let larger = |r: f64| ((r + most / 2.0) * (1.0 + 1e-9)).min(f64::MAX);
    let mut near = contacts(&resized(periodic, larger)?, limit)?;
    near.retain(|&pair| gap(periodic, pair) <= most);
    Ok(near)
}

/// Against which a list is compared.
struct View<'a> {
    periodic: &'a Periodic<'a>,
    truth: &'a [ImagePair],
    /// What may be there, beside.
    near: &'a [ImagePair],
    /// Pairs of a kind that are kept.
    kept: usize,
}

impl View<'_> {
    fn compare(
        &self,
        list: Listed<'_>,
        naming: &Naming,
        allowed: Allowed,
    ) -> anyhow::Result<Verification> {
        match list.images {
            Some(images) => self.with_images(list.pairs, images, naming, allowed.both_sides),
            None => self.without_images(list.pairs, naming, allowed.both_sides),
        }
    }

    fn with_images(
        &self,
        pairs: &[Couple],
        images: &[[i32; 3]],
        naming: &Naming,
        both_sides: bool,
    ) -> anyhow::Result<Verification> {
        let n = self.periodic.scene().len();
        let (mut known, mut unknown) = (room_for(pairs.len())?, Vec::new());
        for (&[i, j], &image) in pairs.iter().zip(images) {
            match (naming.place(i, n), naming.place(j, n)) {
                (Some(a), Some(b)) => {
                    let pair = ImagePair::new(a, b, image);
                    // Of a particle with itself, unshifted, there is but one side.
                    let forward = (pair.i, pair.j, pair.image) == (a, b, image);
                    known.push((pair, forward, [i, j]));
                }
                _ => {
                    io::room(&mut unknown)?;
                    unknown.push([i, j]);
                }
            }
        }
        known.sort_unstable();
        let (mut reported, mut one_sided) = (room_for(known.len())?, Vec::new());
        for same in known.chunk_by(|a, b| a.0 == b.0) {
            let forward = same.iter().filter(|(_, forward, _)| *forward).count();
            let backward = same.len() - forward;
            let count = if both_sides { forward.max(backward) } else { same.len() };
            reported.extend(std::iter::repeat_n(same[0].0, count));
            if both_sides && forward != backward {
                io::room(&mut one_sided)?;
                one_sided.push(same[0].2);
            }
        }
        let mut errors = Errors::default();
        let (mut missed, mut spurious) = (Worst::new(self.kept), Worst::new(self.kept));
        let mut within_skin = 0;
        for same in reported.chunk_by(|a, b| a == b) {
            let pair = same[0];
            errors.duplicate += same.len() as u64 - 1;
            if self.truth.binary_search(&pair).is_ok() {
            } else if self.near.binary_search(&pair).is_ok() {
                within_skin += 1;
            } else if pair.i == pair.j && pair.image == [0; 3] {
                errors.self_pairs += 1;
            } else {
                spurious.apart(self.periodic, pair);
            }
        }
        for &pair in self.truth.iter().filter(|pair| reported.binary_search(pair).is_err()) {
            missed.add(pair, depth(self.periodic, pair));
        }
        Ok(verification(Taken::Images, errors, missed, spurious, unknown, one_sided, within_skin))
    }

    fn without_images(
        &self,
        pairs: &[Couple],
        naming: &Naming,
        both_sides: bool,
    ) -> anyhow::Result<Verification> {
        let (known, unknown) = naming.apply(pairs, self.periodic.scene().len())?;
        // How often a pair is there, as i,j and as j,i.
        let mut counts: HashMap<[u32; 2], [usize; 2]> = HashMap::new();
        counts.try_reserve(known.len()).context("no memory for the pairs; compare a part")?;
        for [i, j] in known {
            counts.entry([i.min(j), i.max(j)]).or_default()[usize::from(j < i)] += 1;
        }
        let (mut one_sided, mut reported) = (Vec::new(), Vec::new());
        for (pair, [forward, backward]) in counts {
            let count = match both_sides {
                false => forward + backward,
                // The image at the other side is listed as the same pair.
                true if pair[0] == pair[1] => forward.div_ceil(2),
                true => {
                    if forward != backward {
                        let [i, j] = pair.map(i64::from);
                        io::room(&mut one_sided)?;
                        one_sided.push(if forward > backward { [i, j] } else { [j, i] });
                    }
                    forward.max(backward)
                }
            };
            io::room(&mut reported)?;
            reported.push((pair, count));
        }
        reported.sort_unstable();
        one_sided.sort_unstable();
        let twice = |w: &[ImagePair]| (w[0].i, w[0].j) == (w[1].i, w[1].j);
        let several = [self.truth, self.near].iter().any(|list| list.windows(2).any(twice));
        let once = self.counted(&reported, true);
        let best = if several {
            let each = self.counted(&reported, false);
            if once.0.wrong() < each.0.wrong() { (Taken::Once, once) } else { (Taken::Each, each) }
        } else {
            (Taken::Pairs, once)
        };
        let (taken, (errors, missed, spurious, within_skin)) = best;
        Ok(verification(taken, errors, missed, spurious, unknown, one_sided, within_skin))
    }

    /// Against the pairs: each as often as images of it touch, or once.
    fn counted(&self, reported: &[([u32; 2], usize)], once: bool) -> (Errors, Worst, Worst, u64) {
        let of = |images: &[ImagePair]| -> HashMap<[u32; 2], Vec<ImagePair>> {
            let mut of: HashMap<[u32; 2], Vec<ImagePair>> = HashMap::new();
            images.iter().for_each(|&pair| of.entry([pair.i, pair.j]).or_default().push(pair));
            of
        };
        let (mut touching, near) = (of(self.truth), of(self.near));
        let (mut errors, mut within_skin) = (Errors::default(), 0);
        let (mut missed, mut spurious) = (Worst::new(self.kept), Worst::new(self.kept));
        for &(pair, count) in reported {
            let mut images = touching.remove(&pair).unwrap_or_default();
            let beside = near.get(&pair).map_or(0, Vec::len).saturating_sub(images.len());
            let (expected, may) = match once {
                true => (images.len().min(1), usize::from(images.is_empty() && beside > 0)),
                false => (images.len(), beside),
            };
            within_skin += count.saturating_sub(expected).min(may) as u64;
            let more = count.saturating_sub(expected + may) as u64;
            if expected + may == 0 && pair[0] == pair[1] {
                errors.self_pairs += 1;
                errors.duplicate += more - 1;
            } else if expected + may == 0 {
                let nearest = nearest(self.periodic, pair);
                spurious.apart(self.periodic, nearest);
                errors.duplicate += more - 1;
            } else {
                errors.duplicate += more;
            }
            // Which ones are there is not known: the deepest, to be fair.
            images.sort_by(|a, b| depth(self.periodic, *b).total_cmp(&depth(self.periodic, *a)));
            images.truncate(expected);
            for &pair in images.iter().skip(count) {
                missed.add(pair, depth(self.periodic, pair));
            }
        }
        for images in touching.values() {
            let count = if once { 1 } else { images.len() };
            for &pair in images.iter().take(count) {
                missed.add(pair, depth(self.periodic, pair));
            }
        }
        errors.missed = missed.count;
        errors.spurious = spurious.count;
        (errors, missed, spurious, within_skin)
    }
}

/// The worst of many pairs, and how many there are.
struct Worst {
    kept: usize,
    pairs: Vec<(ImagePair, f64)>,
    count: u64,
    largest: f64,
    /// The widest gap, a length.
    gap: f64,
}

impl Worst {
    fn new(kept: usize) -> Worst {
        Worst { kept, pairs: Vec::new(), count: 0, largest: 0.0, gap: 0.0 }
    }

    fn apart(&mut self, periodic: &Periodic<'_>, pair: ImagePair) {
        self.gap = self.gap.max(gap(periodic, pair));
        self.add(pair, depth(periodic, pair));
    }

    fn add(&mut self, pair: ImagePair, depth: f64) {
        self.count += 1;
        self.largest = self.largest.max(depth.abs());
        self.pairs.push((pair, depth));
        if self.pairs.len() == self.kept.saturating_mul(2) {
            self.keep();
        }
    }

    fn keep(&mut self) {
        self.pairs.sort_by(|(p, a), (q, b)| b.abs().total_cmp(&a.abs()).then(p.cmp(q)));
        self.pairs.truncate(self.kept);
    }
}

fn verification(
    taken: Taken,
    errors: Errors,
    mut missed: Worst,
    mut spurious: Worst,
    unknown: Vec<Couple>,
    one_sided: Vec<Couple>,
    within_skin: u64,
) -> Verification {
    missed.keep();
    spurious.keep();
    let errors = Errors {
        missed: missed.count,
        spurious: spurious.count,
        deepest_miss: missed.largest,
        widest_false: spurious.largest,
        ..errors
    };
    Verification {
        contacts: 0,
        touching: Touching::Boxed(Vec::new()),
        errors,
        unknown,
        missed: missed.pairs,
        spurious: spurious.pairs,
        one_sided,
        within_skin,
        reading: None,
        taken,
        left_out: [0; 2],
        gap: spurious.gap,
    }
}

#[cfg(test)]
mod tests;
