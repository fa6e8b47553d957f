//! The pairs of a picture: contacts, and the errors of a list.

use std::collections::HashMap;

use anyhow::{Context, bail, ensure};

use contactbench_detectors::near::contacts;
use contactbench_ground::periodic::{ImagePair, Periodic, depth};
use contactbench_io::boxes;
use contactbench_io::pairs::List;
use contactbench_scenes::touching::nearest;

/// Pairs of particles by kind. Particles are numbered from 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pairs {
    /// Contacts, except missed ones.
    pub contacts: Vec<ImagePair>,
    pub missed: Vec<ImagePair>,
    /// Reported pairs that do not touch, or that join a particle with itself.
    pub spurious: Vec<ImagePair>,
    /// Repeated pairs of a list, once for each repetition.
    pub duplicates: Vec<ImagePair>,
}

impl Pairs {
    /// Finds the contacts of a scene, in exact arithmetic. Fails if they need more than `limit`
    /// bytes.
    pub fn from_scene(periodic: &Periodic<'_>, limit: u64) -> anyhow::Result<Pairs> {
        Ok(Pairs { contacts: contacts(periodic, limit)?, ..Pairs::default() })
    }

    /// Finds contacts as [`Pairs::from_scene`] does, and the errors of a list of pairs. In a
    /// list without images, a pair stands for all its contacts, or for the nearest image if it has
    /// none. Fails if the list names particles or images that the scene lacks.
    pub fn compare(periodic: &Periodic<'_>, list: &List, limit: u64) -> anyhow::Result<Pairs> {
        let pairs = Pairs::from_scene(periodic, limit)?;
        let reported = reported(periodic, list, &pairs.contacts)?;
        Ok(pairs.against(reported))
    }

    /// Compares reported contacts, in any order, with those of the scene.
    pub fn against(mut self, mut reported: Vec<ImagePair>) -> Pairs {
        reported.sort_unstable();
        for same in reported.chunk_by(|a, b| a == b) {
            if self.contacts.binary_search(&same[0]).is_err() {
                self.spurious.push(same[0]);
            }
            self.duplicates.extend_from_slice(&same[1..]);
        }
        let absent = |pair: &mut ImagePair| reported.binary_search(pair).is_err();
        self.missed = self.contacts.extract_if(.., absent).collect();
        self
    }

    pub fn all(&self) -> impl Iterator<Item = &ImagePair> {
        let Pairs { contacts, missed, spurious, duplicates } = self;
        [contacts, missed, spurious, duplicates].into_iter().flatten()
    }

    /// Returns the worst error: the deepest missed pair, else the spurious pair with the widest
    /// gap, else a repeated pair.
    pub fn worst(&self, periodic: &Periodic<'_>) -> Option<ImagePair> {
        let depth = |pair: &ImagePair| depth(periodic, *pair).abs();
        let by_depth = |a: &&ImagePair, b: &&ImagePair| depth(a).total_cmp(&depth(b));
        let missed = self.missed.iter().max_by(by_depth);
        let worst = missed.or_else(|| self.spurious.iter().max_by(by_depth));
        worst.or(self.duplicates.first()).copied()
    }
}

fn reported(
    periodic: &Periodic<'_>,
    list: &List,
    contacts: &[ImagePair],
) -> anyhow::Result<Vec<ImagePair>> {
    let (axes, n) = (periodic.lattice().periodic(), periodic.scene().len());
    if periodic.lattice().repeats() {
        list.understood(periodic.scene().dim(), axes)?;
        boxes::hold(axes, list.images.as_deref())?;
    } else if let Some(k) = list.images.iter().flatten().position(|image| *image != [0; 3]) {
        let [i, j] = list.pairs[k];
        bail!("the pair {i},{j} names an image, and boundaries are open here; give --box LX,LY,LZ");
    }
    let mut pairs = Vec::new();
    let room = pairs.try_reserve_exact(list.pairs.len());
    room.with_context(|| format!("no memory for {} pairs", list.pairs.len()))?;
    for (k, &[i, j]) in list.pairs.iter().enumerate() {
        let (Ok(a), Ok(b)) = (u32::try_from(i), u32::try_from(j)) else {
            bail!("the pair {i},{j}: particles are numbered from 0; verify reads other numbers")
        };
        ensure!(
            (a as usize) < n && (b as usize) < n,
            "the pair {i},{j}: the scene has {n} particles, numbered from 0"
        );
        let image = list.images.as_ref().map_or([0; 3], |images| images[k]);
        pairs.push(ImagePair::new(a, b, image));
    }
    if list.images.is_none() {
        pairs = through_images(periodic, pairs, contacts);
    }
    Ok(pairs)
}

/// Turns pairs without images into contacts: a pair stands for all its images that touch, or for
/// the nearest one if none touches. Only a pair that occurs again is a duplicate.
fn through_images(
    periodic: &Periodic<'_>,
    pairs: Vec<ImagePair>,
    contacts: &[ImagePair],
) -> Vec<ImagePair> {
    let mut counts = HashMap::<[u32; 2], usize>::new();
    pairs.iter().for_each(|pair| *counts.entry([pair.i, pair.j]).or_default() += 1);
    let mut reported = Vec::new();
    for (pair, count) in counts {
        let start = contacts.partition_point(|other| [other.i, other.j] < pair);
        let same = contacts[start..].iter().take_while(|other| [other.i, other.j] == pair);
        let mut images: Vec<ImagePair> = same.copied().collect();
        if images.is_empty() {
            images.push(nearest(periodic, pair));
        }
        reported.extend(std::iter::repeat_n(images[0], count.saturating_sub(images.len())));
        reported.append(&mut images);
    }
    reported
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_ground::scene::AnyScene;
    use contactbench_scenes::touching::in_open_space;

    #[test]
    fn a_list_is_taken_apart_or_refused() {
        let scene = AnyScene::at([0.0, 1.0, 2.0, 3.0000001].map(|x| [x, 0.0]), 0.5).unwrap();
        let scene = in_open_space(&scene).unwrap();
        let compare = |pairs: &[[i64; 2]]| {
            let list = List { pairs: pairs.to_vec(), ..List::default() };
            Pairs::compare(&scene, &list, 1 << 20)
        };
        let found = compare(&[[2, 1], [1, 2], [3, 0], [0, 0]]).unwrap();
        let names =
            |pairs: &[ImagePair]| pairs.iter().map(|pair| [pair.i, pair.j]).collect::<Vec<_>>();
        assert_eq!([&found.contacts, &found.missed].map(|it| names(it)), [[[1, 2]], [[0, 1]]]);
        assert_eq!(names(&found.duplicates), [[1, 2]]);
        assert_eq!(names(&found.spurious), [[0, 0], [0, 3]]);
        for (pair, words) in [
            ([-1, 2], "the pair -1,2: particles are numbered from 0"),
            ([1 << 32, 1], "the pair 4294967296,1: particles"),
            ([0, 4], "the pair 0,4: the scene has 4 particles"),
        ] {
            let error = compare(&[pair]).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
