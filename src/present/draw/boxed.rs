//! A scene that repeats as it is drawn: its particles, behind them the images that something
//! touches, and every pair with an image from both sides.

use std::collections::HashMap;

use anyhow::{Context, bail, ensure};

use crate::check::imaged::{self, Measure};
use crate::io::pairs::List;
use crate::periodic::{ImagePair, Periodic};
use crate::present::draw::pairs::{Highlighted, NEAR, places};
use crate::scene::{AnyScene, Radii, Scene, Stored};

/// A scene in its box.
pub struct Boxed<'a> {
    pub(super) periodic: &'a Periodic<'a>,
    /// The particles, and behind them the images.
    pub(super) scene: AnyScene<'static>,
    /// Of that scene.
    pub(super) pairs: Highlighted,
    /// Of which particle each image is, and which one.
    images: Vec<(u32, [i32; 3])>,
    /// All contacts.
    pub contacts: usize,
    /// Those of them that are across the box.
    pub across: usize,
    /// What a list has wrong: missed, spurious, repeated.
    pub wrong: [usize; 3],
}

impl<'a> Boxed<'a> {
    /// The contacts, decided exactly, and what is wrong with a list. Lists of pairs may take
    /// `limit` bytes.
    pub fn new(
        periodic: &'a Periodic<'a>,
        list: Option<&List>,
        limit: u64,
    ) -> anyhow::Result<Boxed<'a>> {
        let mut contacts = imaged::contacts(periodic, limit)?;
        let count = contacts.len();
        let across = contacts.iter().filter(|pair| pair.image != [0; 3]).count();
        let near = imaged::nearly(periodic, NEAR, limit);
        let [mut missed, mut spurious, mut duplicates] = [const { Vec::new() }; 3];
        if let Some(list) = list {
            let reported = reported(periodic, list, &contacts)?;
            for same in reported.chunk_by(|a, b| a == b) {
                if contacts.binary_search(&same[0]).is_err() {
                    spurious.push(same[0]);
                }
                duplicates.extend_from_slice(&same[1..]);
            }
            let absent = |pair: &ImagePair| reported.binary_search(pair).is_err();
            missed = contacts.extract_if(.., |pair| absent(pair)).collect();
        }
        let mut of: HashMap<(u32, [i32; 3]), u32> = HashMap::new();
        let mut images = Vec::new();
        let n = periodic.scene().len() as u32;
        let mut drawn = |pairs: &[ImagePair]| {
            let mut drawn = Vec::new();
            for &ImagePair { i, j, image } in pairs {
                if image == [0; 3] {
                    drawn.push([i, j]);
                    continue;
                }
                for (a, b, image) in [(i, j, image), (j, i, image.map(i32::wrapping_neg))] {
                    let body = *of.entry((b, image)).or_insert_with(|| {
                        images.push((b, image));
                        n + (images.len() - 1) as u32
                    });
                    drawn.push([a, body]);
                }
            }
            drawn
        };
        let wrong = [missed.len(), spurious.len(), duplicates.len()];
        let pairs = Highlighted {
            contacts: drawn(&contacts),
            near: drawn(&near),
            missed: drawn(&missed),
            spurious: drawn(&spurious),
            duplicates: drawn(&duplicates),
        };
        let scene = match periodic.scene() {
            AnyScene::Plane(Stored::F64(scene)) => extended(scene, periodic, &images)?.into(),
            AnyScene::Space(Stored::F64(scene)) => extended(scene, periodic, &images)?.into(),
            _ => bail!("a scene in a box is in f64"),
        };
        Ok(Boxed { periodic, scene, pairs, images, contacts: count, across, wrong })
    }

    /// Of which particle a body is, and which image: none of the particle itself.
    pub(super) fn body(&self, body: u32) -> (u32, [i32; 3]) {
        let image = (body as usize).checked_sub(self.periodic.scene().len());
        image.and_then(|k| self.images.get(k)).copied().unwrap_or((body, [0; 3]))
    }

    /// The contact that a pair of bodies shows.
    pub(super) fn contact(&self, pair: [u32; 2]) -> ImagePair {
        let [(i, s), (j, t)] = pair.map(|body| self.body(body));
        ImagePair::new(i, j, std::array::from_fn(|k| t[k].wrapping_sub(s[k])))
    }
}

/// The contacts that a list names, in order. A pair without an image stands for all of its
/// contacts; where it has none, for the nearest one.
fn reported(
    periodic: &Periodic<'_>,
    list: &List,
    contacts: &[ImagePair],
) -> anyhow::Result<Vec<ImagePair>> {
    let n = periodic.scene().len();
    list.understood(periodic.scene().dim(), periodic.lattice().periodic())?;
    imaged::along_axes(periodic, list.images.as_deref())?;
    let (mut reported, mut counts) = (Vec::new(), HashMap::<[u32; 2], usize>::new());
    for (k, [i, j]) in places(&list.pairs)?.into_iter().enumerate() {
        ensure!(
            (i as usize) < n && (j as usize) < n,
            "the pair {i},{j}: the scene has {n} particles, numbered from 0; the list belongs to \
             another scene"
        );
        match &list.images {
            Some(images) => reported.push(ImagePair::new(i, j, images[k])),
            None => {
                let pair = [i.min(j), i.max(j)];
                let count = counts.entry(pair).or_default();
                *count += 1;
                if *count > 1 {
                    continue;
                }
                let of = |pair: &ImagePair| [pair.i, pair.j];
                let start = contacts.partition_point(|other| of(other) < pair);
                let same = contacts[start..].iter().take_while(|other| of(other) == pair);
                let before = reported.len();
                reported.extend(same);
                if reported.len() == before {
                    reported.push(periodic.nearest(pair));
                }
            }
        }
    }
    reported.sort_unstable();
    if list.images.is_none() {
        // As often as images touch, or once: nothing is repeated that may be an image.
        let mut kept = Vec::new();
        for same in reported.chunk_by(|a, b| [a.i, a.j] == [b.i, b.j]) {
            let count = counts.get(&[same[0].i, same[0].j]).copied().unwrap_or(1);
            let mut once = same.to_vec();
            once.dedup();
            let repeated = count.saturating_sub(once.len());
            kept.extend(std::iter::repeat_n(once[0], repeated));
            kept.append(&mut once);
        }
        kept.sort_unstable();
        return Ok(kept);
    }
    Ok(reported)
}

/// The particles and the images behind them, whose places are rounded.
fn extended<const D: usize>(
    scene: &Scene<'_, f64, D>,
    periodic: &Periodic<'_>,
    images: &[(u32, [i32; 3])],
) -> anyhow::Result<Scene<'static, f64, D>> {
    let vectors = periodic.lattice().vectors();
    let mut centres = scene.centres().to_vec();
    for &(particle, image) in images {
        let mut centre = centres[particle as usize];
        for (vector, times) in vectors.iter().zip(image).filter(|(_, times)| *times != 0) {
            (0..D).for_each(|k| centre[k] += f64::from(times) * vector[k]);
        }
        centres.push(centre);
    }
    let radii = match scene.radii() {
        Radii::Uniform(r) => Radii::Uniform(*r),
        Radii::Each(radii) => {
            let more = images.iter().map(|(particle, _)| radii[*particle as usize]);
            Radii::Each(radii.iter().copied().chain(more).collect())
        }
    };
    Scene::new(centres, radii).context("the images cannot be drawn")
}
