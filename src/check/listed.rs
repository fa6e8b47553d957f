//! A contact list of another code, compared with the exact truth.

use std::collections::HashMap;

use anyhow::bail;

use crate::contact::Arithmetic;
use crate::contact::depth::depth;
use crate::oracle::{self, Errors};
use crate::scene::{AnyScene, Real, array};
use crate::sink::normalise;
use crate::with_scene;

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

/// Another meaning of the numbers, which would make more of the list right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Hint {
    /// Pairs that would differ all the same.
    pub wrong: u64,
    /// What the numbers would mean.
    pub meaning: Meaning,
}

/// A list against the truth.
#[derive(Clone, Debug)]
pub struct Verification {
    /// The pairs that touch.
    pub contacts: u64,
    /// Against them.
    pub errors: Errors,
    /// Pairs of the list that name no particle.
    pub unknown: Vec<[i64; 2]>,
    /// Pairs that are not listed and their overlap in mean radii, the deepest first.
    pub missed: Vec<([u32; 2], f64)>,
    /// Pairs that are listed and do not touch, with their depth in mean radii, which is negative:
    /// the widest gap first.
    pub spurious: Vec<([u32; 2], f64)>,
    /// A better meaning of the numbers, if there is one.
    pub hint: Option<Hint>,
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

    /// Pairs of places in the file, and the pairs that name no particle.
    fn apply(&self, list: &[[i64; 2]], n: usize) -> (Vec<[u32; 2]>, Vec<[i64; 2]>) {
        let place = |name: i64| match self {
            Naming::Base(base) => name
                .checked_sub(*base)
                .and_then(|k| u32::try_from(k).ok())
                .filter(|&k| (k as usize) < n),
            Naming::Ids(ids) => ids.get(&name).copied(),
        };
        let (mut known, mut unknown) = (Vec::with_capacity(list.len()), Vec::new());
        for &[i, j] in list {
            match (place(i), place(j)) {
                (Some(i), Some(j)) => known.push([i, j]),
                _ => unknown.push([i, j]),
            }
        }
        (known, unknown)
    }
}

impl Verification {
    /// Compares `list` with the pairs that touch by this arithmetic. Where it differs, the `others`
    /// are tried, too. An error if the truth cannot be found.
    pub fn new(
        scene: &AnyScene<'_>,
        list: &[[i64; 2]],
        naming: &Naming,
        others: &[Naming],
        arithmetic: Arithmetic,
    ) -> anyhow::Result<Verification> {
        let truth = oracle::truth(scene, arithmetic)?;
        let (reported, unknown) = naming.apply(list, scene.len());
        let errors = oracle::compare(&reported, &truth.pairs, scene);
        let mut found = Verification {
            contacts: truth.pairs.len() as u64,
            errors,
            unknown,
            missed: only(scene, &truth.pairs, &reported),
            spurious: only(scene, &reported, &truth.pairs),
            hint: None,
        };
        if !found.is_same() {
            let hint = |naming: &Naming| {
                let (reported, unknown) = naming.apply(list, scene.len());
                let errors = oracle::compare(&reported, &truth.pairs, scene);
                Hint { wrong: errors.wrong() + unknown.len() as u64, meaning: naming.meaning() }
            };
            let wrong = errors.wrong() + found.unknown.len() as u64;
            found.hint = others.iter().map(hint).filter(|hint| hint.wrong < wrong / 2).min();
        }
        Ok(found)
    }

    /// Are the two lists the same?
    pub fn is_same(&self) -> bool {
        self.errors == Errors::default() && self.unknown.is_empty()
    }
}

/// The pairs of `these` that are not among `those`, the deepest overlap first, or the widest gap.
fn only(scene: &AnyScene<'_>, these: &[[u32; 2]], those: &[[u32; 2]]) -> Vec<([u32; 2], f64)> {
    let (mut these, mut those) = (these.to_vec(), those.to_vec());
    normalise(&mut these);
    normalise(&mut those);
    these.dedup();
    these.retain(|pair| pair[0] != pair[1] && those.binary_search(pair).is_err());
    let mut list: Vec<_> = these.into_iter().map(|pair| (pair, pair_depth(scene, pair))).collect();
    list.sort_by(|(_, a), (_, b)| b.abs().total_cmp(&a.abs()));
    list
}

fn pair_depth(scene: &AnyScene<'_>, [i, j]: [u32; 2]) -> f64 {
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
mod tests {
    use super::*;
    use crate::io;

    fn scene() -> AnyScene<'static> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.csv");
        std::fs::write(&path, "x,y,r\n0,0,1\n1,0,1\n3,0,1\n10,0,1\n20,0,1\n").unwrap();
        let (particles, _) = io::load(&path, io::Options::default()).unwrap();
        particles.scene("p", None).unwrap()
    }

    fn verified(list: &[[i64; 2]], naming: Naming, others: &[Naming]) -> Verification {
        Verification::new(&scene(), list, &naming, others, Arithmetic::Exact).unwrap()
    }

    #[test]
    fn every_kind_of_difference_is_found() {
        // True are 0,1 (overlap of one radius) and 1,2 (tangent).
        let list = [[2, 1], [1, 2], [3, 3], [2, 3], [0, 4], [1, 9]];
        let found = verified(&list, Naming::Base(0), &[]);
        let Errors { missed, spurious, duplicate, self_pairs, .. } = found.errors;
        assert_eq!((missed, spurious, duplicate, self_pairs, found.contacts), (1, 2, 1, 1, 2));
        assert_eq!((found.unknown.as_slice(), found.is_same()), (&[[1, 9]][..], false));
        assert_eq!(found.missed, [([0, 1], 1.0)]);
        assert_eq!(found.spurious, [([0, 4], -18.0), ([2, 3], -5.0)]);
        assert!(verified(&[[0, 1], [2, 1]], Naming::Base(0), &[]).is_same());
    }

    #[test]
    fn a_better_meaning_is_found() {
        let ids = Naming::by_id(&[7, 8, 9, 10, 11]).unwrap();
        let others = [ids.clone(), Naming::Base(1)];
        let found = verified(&[[1, 2], [2, 3]], Naming::Base(0), &others);
        assert_eq!(found.hint, Some(Hint { wrong: 0, meaning: Meaning::Base(1) }));
        let found = verified(&[[7, 8], [8, 9]], Naming::Base(0), &others);
        assert_eq!(found.hint, Some(Hint { wrong: 0, meaning: Meaning::Ids }));
        assert!(verified(&[[7, 8], [8, 9]], ids, &[]).is_same());
        let twice = Naming::by_id(&[7, 8, 7]).unwrap_err().to_string();
        assert!(
            twice.contains("the id 7 stands twice in the file, at particles 0 and 2"),
            "{twice}"
        );
    }
}
