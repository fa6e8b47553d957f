//! The columns of a written contact: two particles by index or id, the image, and extra columns.

use anyhow::Context;

use crate::raw::room::room;
use contactbench_ground::contact::depth::depth;
use contactbench_ground::periodic::{self, ImagePair, Periodic};
use contactbench_ground::scene::{AnyScene, Real, array};
use contactbench_ground::with_scene;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extra {
    /// The overlap as a length and, as `depth`, in mean radii of the two particles.
    Overlap,
    Normal,
    Ids,
    Count,
}

impl Extra {
    pub const ALL: [(Extra, &'static str, &'static str); 4] = [
        (
            Extra::Overlap,
            "overlap",
            "The overlap as a length and, as `depth`, in mean radii of the two particles",
        ),
        (Extra::Normal, "normal", "The unit vector from the first particle to the second"),
        (Extra::Ids, "ids", "The ids of the two particles"),
        (Extra::Count, "count", "The number of contacts of each of the two particles"),
    ];
}

#[derive(Clone, Copy, Debug)]
pub struct Style<'a> {
    pub scene: &'a AnyScene<'a>,
    pub periodic: Option<&'a Periodic<'a>>,
    pub ids: Option<&'a [i64]>,
    /// Whether contacts use ids, smaller first, and are sorted by them.
    pub by_id: bool,
    pub extras: &'a [Extra],
    /// Number of contacts of each particle, for [`Extra::Count`].
    pub counts: &'a [u32],
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Number {
    Whole(i64),
    Real(f64),
}

/// Returns the number of contacts of each of `n` particles. A contact of a particle with its own
/// image counts twice. Fails if memory runs out.
pub fn counts(n: usize, contacts: impl Iterator<Item = ImagePair>) -> anyhow::Result<Vec<u32>> {
    let mut counts = Vec::new();
    let room = counts.try_reserve_exact(n);
    room.with_context(|| format!("no memory for the number of contacts of {n} particles"))?;
    counts.resize(n, 0);
    for k in contacts.flat_map(|pair| [pair.i, pair.j]) {
        counts.get_mut(k as usize).into_iter().for_each(|count: &mut u32| *count += 1);
    }
    Ok(counts)
}

/// Reverses a contact. Written contacts may have either direction, unlike reported ones; the image
/// belongs to the second particle, `j`.
pub(super) fn turned(ImagePair { i, j, image }: ImagePair) -> ImagePair {
    ImagePair { i: j, j: i, image: image.map(i32::wrapping_neg) }
}

impl<'a> Style<'a> {
    pub fn plain(scene: &'a AnyScene<'a>) -> Style<'a> {
        Style { scene, periodic: None, ids: None, by_id: false, extras: &[], counts: &[] }
    }

    pub(super) fn images(&self) -> usize {
        self.periodic.map_or(0, |_| self.scene.dim())
    }

    pub(super) fn has(&self, extra: Extra) -> bool {
        self.extras.contains(&extra)
    }

    pub(super) fn names(&self) -> Vec<&'static str> {
        let mut names = if self.by_id { vec!["id1", "id2"] } else { vec!["i", "j"] };
        names.extend(["sx", "sy", "sz"].into_iter().take(self.images()));
        if self.has(Extra::Overlap) {
            names.extend(["overlap", "depth"]);
        }
        if self.has(Extra::Normal) {
            names.extend(["nx", "ny", "nz"].into_iter().take(self.scene.dim()));
        }
        if self.has(Extra::Ids) && !self.by_id {
            names.extend(["id1", "id2"]);
        }
        if self.has(Extra::Count) {
            names.extend(["count1", "count2"]);
        }
        names
    }

    pub(super) fn id(&self, k: u32) -> i64 {
        self.ids.and_then(|ids| ids.get(k as usize)).copied().unwrap_or(i64::from(k))
    }

    pub(super) fn count(&self, k: u32) -> u32 {
        self.counts.get(k as usize).copied().unwrap_or_default()
    }

    pub(super) fn directed(
        &self,
        contacts: impl Iterator<Item = ImagePair>,
    ) -> anyhow::Result<Vec<ImagePair>> {
        let mut all = Vec::new();
        for pair in contacts {
            room(&mut all)?;
            all.push(pair);
        }
        if self.by_id {
            for contact in &mut all {
                if self.id(contact.i) > self.id(contact.j) {
                    *contact = turned(*contact);
                }
            }
            all.sort_unstable_by_key(|it| (self.id(it.i), self.id(it.j), it.image));
        }
        Ok(all)
    }

    /// Calls `put` with the number of each column.
    pub(super) fn row(&self, contact: ImagePair, mut put: impl FnMut(Number)) {
        let ImagePair { i, j, image } = contact;
        for k in [i, j] {
            put(Number::Whole(if self.by_id { self.id(k) } else { k.into() }));
        }
        image[..self.images()].iter().for_each(|&s| put(Number::Whole(s.into())));
        if self.has(Extra::Overlap) {
            self.overlap(contact).into_iter().for_each(|x| put(Number::Real(x)));
        }
        if self.has(Extra::Normal) {
            self.normal(contact)[..self.scene.dim()].iter().for_each(|&x| put(Number::Real(x)));
        }
        if self.has(Extra::Ids) && !self.by_id {
            [i, j].iter().for_each(|&k| put(Number::Whole(self.id(k))));
        }
        if self.has(Extra::Count) {
            [i, j].iter().for_each(|&k| put(Number::Whole(self.count(k).into())));
        }
    }

    pub(super) fn overlap(&self, ImagePair { i, j, image }: ImagePair) -> [f64; 2] {
        with_scene!(self.scene, scene => {
            let [a, b] = [i as usize, j as usize];
            let radii = [a, b].map(|k| scene.radius(k).wide());
            let [at, to] = [a, b].map(|k| array(&scene.centres()[k]).map(|x| x.wide()));
            let depth = match self.periodic {
                None => depth(&at, &to, radii[0], radii[1]),
                Some(periodic) => periodic::depth(periodic, ImagePair::new(i, j, image)),
            };
            [depth * 0.5 * (radii[0] + radii[1]), depth]
        })
    }

    /// Returns the unit vector from the first particle to the second; 0 if their centres coincide.
    pub(super) fn normal(&self, ImagePair { i, j, image }: ImagePair) -> [f64; 3] {
        let mut direction = [0.0; 3];
        with_scene!(self.scene, scene => {
            let [a, b] = [i, j].map(|k| array(&scene.centres()[k as usize]).map(|x| x.wide()));
            direction.iter_mut().zip(a.iter().zip(&b)).for_each(|(x, (a, b))| *x = b - a);
        });
        if let Some(periodic) = self.periodic {
            for (vector, times) in periodic.lattice().vectors().iter().zip(image) {
                (0..3).for_each(|k| direction[k] += f64::from(times) * vector[k]);
            }
        }
        // Dividing by the largest component prevents overflow and underflow of squares.
        let most = direction.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        if most == 0.0 || !most.is_finite() {
            return [0.0; 3];
        }
        let unit = direction.map(|x| x / most);
        let length = unit.iter().map(|x| x * x).sum::<f64>().sqrt();
        unit.map(|x| x / length)
    }
}
