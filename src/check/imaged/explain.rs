//! How a list in a box may be meant that differs from the truth, so that it agrees.

use super::{Listed, View};
use crate::check::listed::{Allowed, Naming, Terms, Verification, WORST};
use crate::check::reading::{Deviation, FAR, ImagesOf, ROUNDED, Reading, TANGENT, TakenBox};
use crate::contact::Arithmetic;
use crate::periodic::{self, ImagePair, Periodic, depth};
use crate::scene::touching::{contacts, resized};
use crate::scene::{Lattice, Radii};
use crate::with_scene;

/// The reading with the fewest pairs that differ, if it is better by half than the list as it
/// stands.
pub(super) fn explain(
    periodic: &Periodic<'_>,
    list: Listed<'_>,
    namings: &[&Naming],
    truth: &[ImagePair],
    terms: Terms,
) -> anyhow::Result<Option<Reading>> {
    // Nothing is explained by a list of nothing.
    if list.pairs.is_empty() {
        return Ok(None);
    }
    let view = View { periodic, truth, near: &[], kept: WORST };
    let mut best: Option<Found<'_>> = None;
    let mut given = None;
    for &naming in namings {
        let images = [ImagesOf::Second, ImagesOf::First, ImagesOf::Wrapped];
        for images in images.into_iter().filter(|of| list.images.is_some() || *of == images[0]) {
            let Some(shifts) = shifted(periodic, list, naming, images) else { continue };
            for both_sides in [false, true] {
                let list = Listed { images: shifts.as_deref(), ..list };
                let allowed = Allowed { both_sides, ..Allowed::default() };
                let found = view.compare(list, naming, allowed)?;
                given.get_or_insert(wrong(&found));
                if best.as_ref().is_none_or(|best| wrong(&found) < best.reading.wrong) {
                    let listed = list.pairs.len() as u64;
                    let reading = Reading {
                        both_sides,
                        images,
                        listed: if both_sides { listed.div_ceil(2) } else { listed },
                        wrong: wrong(&found),
                        ..Reading::plain(naming.meaning())
                    };
                    best = Some(Found { naming, shifts: shifts.clone(), reading, found });
                }
            }
        }
    }
    let (Some(given), Some(best)) = (given, best) else { return Ok(None) };
    let mut search = Search { list, naming: best.naming, best: best.reading.clone() };
    search.differently(&best, periodic, truth, terms)?;
    if search.best.wrong > 0 && list.images.is_some() {
        let images = ImagesOf::LeftOut;
        let left_out = Found { shifts: None, reading: Reading { images, ..best.reading }, ..best };
        search.consider(&left_out, periodic, truth, &[], left_out.reading.clone())?;
    }
    Ok(Some(search.best).filter(|reading| reading.wrong < given.div_ceil(2)))
}

/// Pairs that differ.
fn wrong(found: &Verification) -> u64 {
    found.errors.wrong() + (found.unknown.len() + found.one_sided.len()) as u64
}

/// The images of a list, taken otherwise; none where that is nothing else.
#[expect(clippy::option_option)]
fn shifted(
    periodic: &Periodic<'_>,
    list: Listed<'_>,
    naming: &Naming,
    of: ImagesOf,
) -> Option<Option<Vec<[i32; 3]>>> {
    let Some(images) = list.images else { return Some(None) };
    let turned = |image: &[i32; 3]| image.map(i32::wrapping_neg);
    match of {
        ImagesOf::Second => Some(Some(images.to_vec())),
        ImagesOf::First => Some(Some(images.iter().map(turned).collect())),
        ImagesOf::Wrapped => {
            let n = periodic.scene().len();
            let cells: Vec<[i32; 3]> = (0..n as u32).map(|k| cell(periodic, k)).collect();
            if cells.iter().all(|cell| *cell == [0; 3]) {
                return None;
            }
            let of = |name| naming.place(name, n).map_or([0; 3], |place| cells[place as usize]);
            let wrapped = list.pairs.iter().zip(images).map(|(&[i, j], image)| {
                let (a, b) = (of(i), of(j));
                std::array::from_fn(|v| image[v].wrapping_add(a[v]).wrapping_sub(b[v]))
            });
            Some(Some(wrapped.collect()))
        }
        ImagesOf::LeftOut => None,
    }
}

/// By how many vectors a particle is out of the box.
fn cell(periodic: &Periodic<'_>, particle: u32) -> [i32; 3] {
    let (centre, _) = super::super::listed::particle(periodic.scene(), particle);
    let lattice = periodic.lattice();
    std::array::from_fn(|v| {
        let from = centre.iter().zip(lattice.origin()).map(|(x, corner)| x - corner);
        let at: f64 = from.zip(lattice.dual(v)).map(|(x, dual)| x * dual).sum();
        if lattice.periodic()[v] { at.floor() as i32 } else { 0 }
    })
}

/// A way to read the list's numbers, and how it then differs.
struct Found<'a> {
    naming: &'a Naming,
    shifts: Option<Vec<[i32; 3]>>,
    reading: Reading,
    found: Verification,
}

/// The best reading up to now.
struct Search<'a> {
    list: Listed<'a>,
    naming: &'a Naming,
    best: Reading,
}

impl Search<'_> {
    /// Takes a reading if fewer pairs differ from what is true then.
    fn consider(
        &mut self,
        of: &Found<'_>,
        periodic: &Periodic<'_>,
        truth: &[ImagePair],
        near: &[ImagePair],
        reading: Reading,
    ) -> anyhow::Result<()> {
        let list = Listed { images: of.shifts.as_deref(), ..self.list };
        let allowed = Allowed { both_sides: reading.both_sides, ..Allowed::default() };
        let found =
            View { periodic, truth, near, kept: WORST }.compare(list, self.naming, allowed)?;
        let wrong = wrong(&found);
        if wrong < self.best.wrong {
            self.best = Reading { wrong, ..reading };
        }
        Ok(())
    }

    /// What else than its numbers may be different in the list.
    fn differently(
        &mut self,
        of: &Found<'_>,
        periodic: &Periodic<'_>,
        truth: &[ImagePair],
        terms: Terms,
    ) -> anyhow::Result<()> {
        self.partly(of, &of.reading, periodic, truth)?;
        self.decided(of, periodic, truth, terms)?;
        self.sized(of, periodic, truth, terms)?;
        if self.best.wrong > 0 {
            self.boxed(of, &of.reading, periodic, terms)?;
        }
        if self.best.wrong > 0 {
            self.sized_and_boxed(of, periodic, terms)?;
        }
        Ok(())
    }

    /// A part of the contacts.
    fn partly(
        &mut self,
        of: &Found<'_>,
        plain: &Reading,
        periodic: &Periodic<'_>,
        truth: &[ImagePair],
    ) -> anyhow::Result<()> {
        let only = |keep: &dyn Fn(&ImagePair) -> bool| -> Vec<ImagePair> {
            truth.iter().copied().filter(|pair| keep(pair)).collect()
        };
        let open = only(&|pair| pair.image == [0; 3]);
        let others = only(&|pair| pair.i != pair.j);
        let nearest: Vec<ImagePair> = others
            .chunk_by(|a, b| [a.i, a.j] == [b.i, b.j])
            .map(|same| {
                let deeper = |a: &&ImagePair, b: &&ImagePair| {
                    depth(periodic, **a).total_cmp(&depth(periodic, **b))
                };
                *same.iter().max_by(deeper).unwrap_or(&same[0])
            })
            .collect();
        for (part, taken) in
            [(open, TakenBox::Open), (others, TakenBox::WithoutOwn), (nearest, TakenBox::Nearest)]
        {
            if self.best.wrong > 0 && part.len() < truth.len() {
                self.consider(of, periodic, &part, &[], Reading { taken, ..plain.clone() })?;
            }
        }
        Ok(())
    }

    /// Other answers for pairs that just touch.
    fn decided(
        &mut self,
        of: &Found<'_>,
        periodic: &Periodic<'_>,
        truth: &[ImagePair],
        terms: Terms,
    ) -> anyhow::Result<()> {
        let errors = of.found.errors;
        let most = errors.deepest_miss.max(errors.widest_false);
        if self.best.wrong == 0 || errors.missed + errors.spurious == 0 || most > ROUNDED {
            return Ok(());
        }
        let with = |deviation| Reading { deviation: Some(deviation), ..of.reading.clone() };
        if errors.spurious == 0 && most == 0.0 {
            let strict: Vec<ImagePair> =
                truth.iter().copied().filter(|&pair| depth(periodic, pair) != 0.0).collect();
            self.consider(of, periodic, &strict, &[], with(Deviation::Strict))?;
        }
        for arithmetic in [Arithmetic::F64, Arithmetic::F32] {
            if self.best.wrong == 0 || terms.arithmetic != Arithmetic::Exact {
                break;
            }
            let rounded = periodic::truth(periodic, arithmetic, terms.memory_limit);
            let Ok(rounded) = rounded else { continue };
            let with = with(Deviation::Rounded(arithmetic));
            self.consider(of, periodic, &rounded.pairs, &[], with)?;
        }
        let left = of.reading.wrong - errors.missed - errors.spurious;
        if most < TANGENT && left < self.best.wrong {
            self.best = Reading { wrong: left, ..with(Deviation::Tangent) };
        }
        Ok(())
    }

    /// Other sizes, or a skin: only where that explains all.
    fn sized(
        &mut self,
        of: &Found<'_>,
        periodic: &Periodic<'_>,
        truth: &[ImagePair],
        terms: Terms,
    ) -> anyhow::Result<()> {
        let (errors, gap) = (of.found.errors, of.found.gap);
        let (missed, spurious) = (errors.missed, errors.spurious);
        let before = self.best.clone();
        let mut all = |pairs: &[ImagePair], deviation| -> anyhow::Result<bool> {
            let reading = Reading { deviation: Some(deviation), ..of.reading.clone() };
            self.consider(of, periodic, pairs, &[], reading)?;
            let all = self.best.wrong == 0;
            if !all {
                self.best = before.clone();
            }
            Ok(all)
        };
        let with_radii = |by: f64| -> Option<Vec<ImagePair>> {
            contacts(&resized(periodic, |r| (by * r).min(f64::MAX)).ok()?, terms.memory_limit).ok()
        };
        if before.wrong == 0 || missed > 0 && spurious > 0 {
        } else if spurious > 0 && errors.widest_false <= FAR {
            if errors.widest_false > 1.0
                && let Some(pairs) = with_radii(2.0)
                && all(&pairs, Deviation::Radii(2.0))?
            {
                return Ok(());
            }
            // One pair beside the others is no skin.
            if let (true, Ok(near)) =
                (spurious > 1, super::within_gap(periodic, gap, terms.memory_limit))
                && all(&near, Deviation::Skin(gap))?
            {
                return Ok(());
            }
            let by = 1.0 + 0.5 * errors.widest_false;
            let one_size =
                with_scene!(periodic.scene(), scene => matches!(scene.radii(), Radii::Uniform(_)));
            if let (true, false, Some(mut pairs)) =
                (spurious > 1, one_size, with_radii(by * (1.0 + 1e-9)))
            {
                pairs.retain(|&pair| -depth(periodic, pair) <= errors.widest_false);
                all(&pairs, Deviation::Radii(by))?;
            }
        } else if missed > 0 {
            if let Some(pairs) = with_radii(0.5)
                && !pairs.is_empty()
                && all(&pairs, Deviation::Radii(0.5))?
            {
                return Ok(());
            }
            let deeper = |&&pair: &&ImagePair| depth(periodic, pair) > errors.deepest_miss;
            let deep: Vec<ImagePair> = truth.iter().filter(deeper).copied().collect();
            let least = deep.iter().map(|&pair| depth(periodic, pair)).fold(2.0, f64::min);
            if missed > 1 && !deep.is_empty() {
                all(&deep, Deviation::Radii(1.0 - 0.5 * least))?;
            }
        }
        Ok(())
    }

    /// Another box: other axes, or edges along the axes.
    fn boxed(
        &mut self,
        of: &Found<'_>,
        plain: &Reading,
        periodic: &Periodic<'_>,
        terms: Terms,
    ) -> anyhow::Result<()> {
        let lattice = periodic.lattice();
        let (vectors, origin, axes) = (*lattice.vectors(), lattice.origin(), lattice.periodic());
        let flags = (1..8).map(|bits| [0, 1, 2].map(|k| bits >> k & 1 == 1));
        let other = flags.filter(|flags| *flags != axes && (!flags[2] || vectors[2] != [0.0; 3]));
        let other = other.filter(|flags| !flags[2] || periodic.scene().dim() == 3);
        let mut boxes: Vec<(Result<Lattice, _>, TakenBox)> = other
            .map(|flags| (Lattice::new(vectors, flags, origin), TakenBox::Along(flags)))
            .collect();
        let lower = (0..3).all(|a| (a + 1..3).all(|k| vectors[a][k] == 0.0));
        if lattice.is_tilted() && lower {
            let edges = [0, 1, 2].map(|k| vectors[k][k]);
            let [x, y, z] = edges;
            let straight = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
            let straight = Lattice::new(straight, axes, origin);
            boxes.insert(0, (straight, TakenBox::Straight(edges)));
        }
        for (lattice, taken) in boxes {
            let Ok(other) = lattice
                .map_err(anyhow::Error::from)
                .and_then(|lattice| Ok(Periodic::new(periodic.scene().clone(), lattice)?))
            else {
                continue;
            };
            let Ok(truth) = contacts(&other, terms.memory_limit) else { continue };
            self.consider(of, &other, &truth, &[], Reading { taken, ..plain.clone() })?;
            if self.best.wrong == 0 {
                break;
            }
        }
        Ok(())
    }

    /// Diameters taken for radii, or the other way, in another box or part of it: only where that
    /// explains all, and not of so many particles that some twenty detections would take long.
    fn sized_and_boxed(
        &mut self,
        of: &Found<'_>,
        periodic: &Periodic<'_>,
        terms: Terms,
    ) -> anyhow::Result<()> {
        if periodic.scene().len() > 100_000 {
            return Ok(());
        }
        let before = self.best.clone();
        for by in [0.5, 2.0] {
            let Ok(sized) = resized(periodic, |r| (by * r).min(f64::MAX)) else { continue };
            let Ok(truth) = contacts(&sized, terms.memory_limit) else { continue };
            let deviation = Some(Deviation::Radii(by));
            let plain = Reading { deviation, ..of.reading.clone() };
            self.partly(of, &plain, &sized, &truth)?;
            if self.best.wrong > 0 {
                self.boxed(of, &plain, &sized, terms)?;
            }
            if self.best.wrong == 0 {
                return Ok(());
            }
        }
        self.best = before;
        Ok(())
    }
}
