//! A contact list of another code, compared with the exact truth.

use std::borrow::Cow;
use std::collections::HashMap;

use anyhow::{Context, bail};

use crate::check::reading::{self, Reading};
use crate::contact::Arithmetic;
use crate::contact::depth::depth;
use crate::io::{self, Groups};
use crate::oracle::{self, Causes, Errors};
use crate::periodic::{Contacts, ImagePair};
use crate::run::judge::Judge;
use crate::scene::{AnyScene, Given, Real, array};
use crate::sink::normalise;
use crate::with_scene;

/// So many pairs of a kind are kept.
pub const WORST: usize = 100;
/// Bytes for each pair of list and truth that other readings of a list take at most.
pub(super) const READING_BYTES: u64 = 128;

/// What the numbers of a list mean.
#[derive(Clone, Debug)]
pub enum Naming {
    /// Places in the particle file, from this number on.
    Base(i64),
    /// Ids of the particles: the place of each.
    Ids(HashMap<i64, u32>),
}

/// A kind of [`Naming`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Meaning {
    /// Places in the particle file, from this number on.
    Base(i64),
    /// Ids of the particles.
    Ids,
}

/// What is not held against a list.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Allowed {
    /// Each pair stands there as i,j and as j,i, and is taken once.
    pub both_sides: bool,
    /// Pairs that are apart by no more than this length may be listed.
    pub skin: f64,
}

/// How a list is compared.
#[derive(Clone, Copy, Debug)]
pub struct Terms<'a> {
    /// Decides what touches.
    pub arithmetic: Arithmetic,
    /// Not held against the list.
    pub allowed: Allowed,
    /// Most bytes for a list of pairs.
    pub memory_limit: u64,
    /// Most pairs of a kind that are kept: [`WORST`], or more where all that is missed is wanted.
    pub kept: usize,
    /// Where the list differs, other ways to read it are tried.
    pub explain: bool,
    /// Contacts that are left out of truth and list.
    pub without: Option<&'a Groups>,
}

impl Terms<'_> {
    /// Is nothing left out, and nothing allowed that other ways to read a list do not know?
    pub(super) fn plain(&self) -> bool {
        self.allowed == Allowed::default() && self.without.is_none()
    }

    /// The places in a list of the pairs that are not left out.
    pub(super) fn kept_of(&self, list: &[Couple], naming: &Naming, n: usize) -> Option<Vec<usize>> {
        let groups = self.without?;
        let kept = |[i, j]: Couple| match (naming.place(i, n), naming.place(j, n)) {
            (Some(i), Some(j)) => !groups.leave_out(i, j),
            _ => true,
        };
        Some((0..list.len()).filter(|&k| kept(list[k])).collect())
    }
}

/// A pair of the list, by the numbers that stand there.
pub(super) type Couple = [i64; 2];

/// The pairs that touch, in order.
#[derive(Clone, Debug)]
pub enum Touching {
    /// In open space.
    Open(Vec<[u32; 2]>),
    /// Images, in a box that repeats.
    Boxed(Vec<ImagePair>),
}

impl Touching {
    /// The contacts of a pair i < j: none, one, or through several images.
    pub fn of(&self, [i, j]: [u32; 2]) -> Vec<ImagePair> {
        match self {
            Touching::Open(pairs) => {
                let found = pairs.binary_search(&[i, j]).is_ok();
                found.then(|| ImagePair::new(i, j, [0; 3])).into_iter().collect()
            }
            Touching::Boxed(pairs) => {
                let from = pairs.partition_point(|pair| [pair.i, pair.j] < [i, j]);
                let same = pairs[from..].iter().take_while(|pair| [pair.i, pair.j] == [i, j]);
                same.copied().collect()
            }
        }
    }
}

/// What of a list is compared with what touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Taken {
    /// Pairs: none touches through several images, or boundaries are open.
    #[default]
    Pairs,
    /// Pairs with the images that are named.
    Images,
    /// Pairs, each as often as images of it touch.
    Each,
    /// Pairs, each once, through how many images it touches.
    Once,
}

/// A list against the truth.
#[derive(Clone, Debug)]
pub struct Verification {
    /// The pairs that touch.
    pub contacts: u64,
    /// These.
    pub touching: Touching,
    /// Against them.
    pub errors: Errors,
    /// Pairs of the list that name no particle.
    pub unknown: Vec<[i64; 2]>,
    /// Pairs that are not listed and their overlap in mean radii, the deepest first, at most
    /// as many as are kept.
    pub missed: Vec<(ImagePair, f64)>,
    /// Pairs that are listed and do not touch, with their depth in mean radii, which is negative:
    /// the widest gap first, at most as many as are kept.
    pub spurious: Vec<(ImagePair, f64)>,
    /// Pairs of the list that are there from one side only, where both are expected.
    pub one_sided: Vec<[i64; 2]>,
    /// Pairs that do not touch and are within the skin.
    pub within_skin: u64,
    /// A better way to read the list, if there is one.
    pub reading: Option<Reading>,
    /// What was compared.
    pub taken: Taken,
    /// Contacts and pairs of the list that were left out.
    pub left_out: [u64; 2],
    /// The widest gap of a spurious pair in a box, a length.
    pub(super) gap: f64,
}

impl Naming {
    /// By these ids of the particles. An error if an id stands there twice.
    pub fn by_id(ids: &[i64]) -> anyhow::Result<Naming> {
        let mut places = HashMap::with_capacity(ids.len());
        for (k, &id) in ids.iter().enumerate() {
            if let Some(earlier) = places.insert(id, k as u32) {
                bail!(
                    "the id {id} stands twice in the file, at particles {earlier} and {k} (from \
                     0); mend it, or give --base"
                );
            }
        }
        Ok(Naming::Ids(places))
    }

    /// Its kind.
    pub fn meaning(&self) -> Meaning {
        match self {
            Naming::Base(base) => Meaning::Base(*base),
            Naming::Ids(_) => Meaning::Ids,
        }
    }

    /// The place of a particle in a file of so many, by its name.
    pub(super) fn place(&self, name: i64, n: usize) -> Option<u32> {
        match self {
            Naming::Base(base) => name
                .checked_sub(*base)
                .and_then(|k| u32::try_from(k).ok())
                .filter(|&k| (k as usize) < n),
            Naming::Ids(ids) => ids.get(&name).copied(),
        }
    }

    /// Pairs of places in the file, and the pairs that name no particle. An error where there is
    /// no memory for them.
    pub(super) fn apply(
        &self,
        list: &[[i64; 2]],
        n: usize,
    ) -> anyhow::Result<(Vec<[u32; 2]>, Vec<Couple>)> {
        let (mut known, mut unknown) = (room_for(list.len())?, Vec::new());
        for &[i, j] in list {
            match (self.place(i, n), self.place(j, n)) {
                (Some(i), Some(j)) => known.push([i, j]),
                _ => {
                    io::room(&mut unknown)?;
                    unknown.push([i, j]);
                }
            }
        }
        Ok((known, unknown))
    }
}

impl Verification {
    /// Compares `list` with the pairs that touch. Where it differs, other ways
    /// to read it are tried, among them the `others`; `bounds` is the box that the particles' file
    /// declares. An error if the truth cannot be found.
    pub fn new(
        scene: &AnyScene<'_>,
        list: &[[i64; 2]],
        naming: &Naming,
        others: &[Naming],
        terms: Terms,
        bounds: Option<&[[f64; 2]]>,
    ) -> anyhow::Result<Verification> {
        let Terms { arithmetic, allowed, memory_limit, kept, explain, without } = terms;
        let stored = scene.as_stored(arithmetic)?;
        let mut truth = oracle::truth_as_stored(&stored, arithmetic.test(), memory_limit)?.pairs;
        drop(stored);
        let mut left_out = [truth.len() as u64, list.len() as u64];
        if let Some(groups) = without {
            truth.retain(|&[i, j]| !groups.leave_out(i, j));
        }
        let part = terms.kept_of(list, naming, scene.len());
        let part: Option<Vec<Couple>> = part.map(|kept| kept.iter().map(|&k| list[k]).collect());
        let list = part.as_deref().unwrap_or(list);
        left_out = [left_out[0] - truth.len() as u64, left_out[1] - list.len() as u64];
        let (taken, one_sided) = match allowed.both_sides {
            true => one_side(list)?,
            false => (Cow::Borrowed(list), Vec::new()),
        };
        let (mut reported, unknown) = naming.apply(&taken, scene.len())?;
        normalise(&mut reported);
        let named = reported.len();
        if allowed.skin > 0.0 {
            let touches = |pair: &[u32; 2]| truth.binary_search(pair).is_ok();
            let near = |pair: &[u32; 2]| pair_gap(scene, *pair) <= allowed.skin;
            reported.retain(|pair| pair[0] == pair[1] || touches(pair) || !near(pair));
        }
        let errors = oracle::compare(&reported, &truth, scene);
        let mut found = Verification {
            contacts: truth.len() as u64,
            errors,
            unknown,
            missed: only(scene, &truth, &reported, kept),
            spurious: only(scene, &reported, &truth, kept),
            touching: Touching::Open(truth),
            one_sided,
            within_skin: (named - reported.len()) as u64,
            reading: None,
            taken: Taken::Pairs,
            left_out,
            gap: 0.0,
        };
        drop(reported);
        // A hint is not worth all the memory there is.
        let small = (list.len() as u64 + found.contacts) * READING_BYTES <= memory_limit;
        if let Touching::Open(truth) = &found.touching
            && explain
            && !found.is_same()
            && terms.plain()
            && small
        {
            let namings: Vec<&Naming> = std::iter::once(naming).chain(others).collect();
            found.reading = reading::explain(scene, list, &namings, truth, arithmetic, bounds)?;
        }
        Ok(found)
    }

    /// Are the two lists the same?
    pub fn is_same(&self) -> bool {
        self.errors == Errors::default() && self.unknown.is_empty() && self.one_sided.is_empty()
    }
}

/// The errors of a list by cause, whose contacts were decided in an arithmetic; none where no truth
/// is known. A list of contacts may take so many bytes.
///
/// # Errors
/// A box that does not suit the scene.
pub fn causes(
    given: &Given,
    contacts: &Contacts,
    arithmetic: Arithmetic,
    memory_limit: u64,
) -> anyhow::Result<Option<Causes>> {
    let (digest, fetch) = (contacts.digest(), || Ok(contacts.clone()));
    let said = (digest.contacts, &*digest.hex());
    let mut judge = Judge::new(given, memory_limit)?;
    Ok(judge.judge("list", arithmetic, said, fetch)?.causes)
}

/// An empty list with room for so many.
pub(super) fn room_for<T>(count: usize) -> anyhow::Result<Vec<T>> {
    let mut list = Vec::new();
    let room = list.try_reserve_exact(count);
    room.with_context(|| format!("no memory for {count} pairs; compare a part of the scene"))?;
    Ok(list)
}

/// The worst pairs of `these` that are not among `those`, both in order: the deepest overlap first,
/// or the widest gap.
fn only(
    scene: &AnyScene<'_>,
    these: &[[u32; 2]],
    those: &[[u32; 2]],
    kept: usize,
) -> Vec<(ImagePair, f64)> {
    let mut worst: Vec<([u32; 2], f64)> = Vec::new();
    let keep = |worst: &mut Vec<([u32; 2], f64)>| {
        worst.sort_by(|(_, a), (_, b)| b.abs().total_cmp(&a.abs()));
        worst.truncate(kept);
    };
    let mut last = None;
    for &pair in these {
        if last.replace(pair) == Some(pair)
            || pair[0] == pair[1]
            || those.binary_search(&pair).is_ok()
        {
            continue;
        }
        worst.push((pair, pair_depth(scene, pair)));
        if worst.len() >= kept.saturating_mul(2).max(1) {
            keep(&mut worst);
        }
    }
    keep(&mut worst);
    let unshifted = |([i, j], depth): ([u32; 2], f64)| (ImagePair::new(i, j, [0; 3]), depth);
    worst.into_iter().map(unshifted).collect()
}

/// Of pairs from both sides, one each; and those that are there from one side only.
fn one_side(list: &[Couple]) -> anyhow::Result<(Cow<'_, [Couple]>, Vec<Couple>)> {
    let mut sorted: Vec<[i64; 2]> = room_for(list.len())?;
    sorted.extend_from_slice(list);
    sorted.sort_unstable_by_key(|&[i, j]| (i.min(j), i.max(j)));
    let (mut taken, mut single) = (room_for(list.len())?, Vec::new());
    for same in
        sorted.chunk_by(|a, b| (a.iter().min(), a.iter().max()) == (b.iter().min(), b.iter().max()))
    {
        let forward = same.iter().filter(|&&[i, j]| i <= j).count();
        let backward = same.len() - forward;
        let pair = [same[0][0].min(same[0][1]), same[0][0].max(same[0][1])];
        taken.extend(std::iter::repeat_n(pair, forward.max(backward)));
        // A particle with itself has but one side.
        if forward != backward && pair[0] != pair[1] {
            io::room(&mut single)?;
            single.push(same[0]);
        }
    }
    Ok((taken.into(), single))
}

/// How far apart two particles are, in the units of the scene; negative where they overlap.
pub(super) fn pair_gap(scene: &AnyScene<'_>, pair: [u32; 2]) -> f64 {
    let [a, b] = pair.map(|k| particle(scene, k).1);
    -pair_depth(scene, pair) * 0.5 * (a + b)
}

/// The overlap of two particles in mean radii; negative where they are apart.
pub fn pair_depth(scene: &AnyScene<'_>, [i, j]: [u32; 2]) -> f64 {
    let (i, j) = (i as usize, j as usize);
    with_scene!(scene, scene => {
        let [a, b] = [i, j].map(|k| array(&scene.centres()[k]).map(Real::wide));
        depth(&a, &b, scene.radius(i).wide(), scene.radius(j).wide())
    })
}

/// Centre and radius of a particle, in the units of the scene.
pub fn particle(scene: &AnyScene<'_>, k: u32) -> (Vec<f64>, f64) {
    let k = k as usize;
    with_scene!(scene, scene => {
        let centre = array(&scene.centres()[k]).iter().map(|x| x.wide()).collect();
        (centre, scene.radius(k).wide())
    })
}

#[cfg(test)]
mod tests;
