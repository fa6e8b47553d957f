//! Particles with their numbers in the whole scene, and their transfer between ranks.

use nalgebra::Point;

use contactbench_ground::limits::refusal::reserve;
use contactbench_ground::scene::{Radii, Scene, SceneError, array};

use crate::rank::Failure;

/// Particles of a larger scene, each with its number in that scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbered<const D: usize> {
    ids: Vec<u32>,
    centres: Vec<Point<f64, D>>,
    /// Radii of the particles; empty if all have the same radius, which is stored elsewhere.
    radii: Vec<f64>,
}

impl<const D: usize> Numbered<D> {
    /// Collects the particles of a scene, numbered from `first`, with a radius each.
    ///
    /// # Errors
    /// [`SceneError::TooMany`] if a number would exceed 2^32 - 2; a refusal if memory is exhausted.
    pub fn new(scene: &Scene<'_, f64, D>, first: u64) -> Result<Numbered<D>, Failure> {
        let n = first.saturating_add(scene.len() as u64);
        if n > u64::from(u32::MAX) {
            return Err(SceneError::TooMany { n: n as usize }.into());
        }
        let mut particles = Numbered::default();
        particles.reserve(scene.len(), true)?;
        particles.ids.extend(first as u32..n as u32);
        particles.centres.extend_from_slice(scene.centres());
        particles.radii.extend((0..scene.len()).map(|k| scene.radius(k)));
        Ok(particles)
    }

    pub fn len(&self) -> usize {
        self.ids.len()
    }

    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    pub fn truncate(&mut self, len: usize) {
        self.ids.truncate(len);
        self.centres.truncate(len);
        self.radii.truncate(len);
    }

    fn reserve(&mut self, further: usize, radii: bool) -> Result<(), Failure> {
        reserve(&mut self.ids, further)?;
        reserve(&mut self.centres, further)?;
        Ok(reserve(&mut self.radii, if radii { further } else { 0 })?)
    }

    pub const fn bytes(radii: bool) -> usize {
        size_of::<u32>() + (D + radii as usize) * size_of::<f64>()
    }

    pub fn ids(&self) -> &[u32] {
        &self.ids
    }

    pub fn places(&self) -> impl Iterator<Item = &[f64; D]> {
        self.centres.iter().map(array)
    }

    pub fn at(&self, k: usize) -> &[f64; D] {
        array(&self.centres[k])
    }

    pub fn radii(&self) -> &[f64] {
        &self.radii
    }

    /// Returns the particles as a scene, with this radius, or with a radius each if it is `None`.
    pub fn scene(&self, radius: Option<f64>) -> Scene<'_, f64, D> {
        let each = || Radii::Each((&self.radii[..]).into());
        // This cannot fail: the particles are valid, and each has a radius unless all share one.
        Scene::new(&self.centres[..], radius.map_or_else(each, Radii::Uniform)).unwrap()
    }

    /// Packs a message for each rank; `to` calls its argument with each rank that gets particle k.
    pub fn letters(
        &self,
        ranks: usize,
        radii: bool,
        to: impl Fn(usize, &mut dyn FnMut(usize)),
    ) -> Result<Vec<Vec<u8>>, Failure> {
        // A single pass calls `to` once per particle, because `to` usually finds no rank.
        let mut chosen: Vec<Vec<u32>> = Vec::new();
        reserve(&mut chosen, ranks)?;
        chosen.resize_with(ranks, Vec::new);
        let mut room = Ok(());
        for k in 0..self.len() {
            to(k, &mut |rank| {
                let chosen = &mut chosen[rank];
                if room.is_ok() && chosen.len() == chosen.capacity() {
                    room = reserve(chosen, chosen.len().max(64));
                }
                if room.is_ok() {
                    // The capacity was reserved above; particle numbers are u32.
                    chosen.push(k as u32);
                }
            });
        }
        room?;
        let mut letters = Vec::new();
        reserve(&mut letters, ranks)?;
        for chosen in chosen {
            let mut letter: Vec<u8> = Vec::new();
            reserve(&mut letter, chosen.len() * Self::bytes(radii))?;
            for k in chosen {
                let k = k as usize;
                letter.extend_from_slice(&self.ids[k].to_le_bytes());
                for x in array(&self.centres[k]) {
                    letter.extend_from_slice(&x.to_le_bytes());
                }
                if radii {
                    letter.extend_from_slice(&self.radii[k].to_le_bytes());
                }
            }
            letters.push(letter);
        }
        Ok(letters)
    }

    pub fn read(&mut self, letters: &[Vec<u8>], radii: bool) -> Result<(), Failure> {
        let size = Self::bytes(radii);
        self.reserve(letters.iter().map(|letter| letter.len() / size).sum(), radii)?;
        for body in letters.iter().flat_map(|letter| letter.chunks_exact(size)) {
            let (id, numbers) = body.split_at(size_of::<u32>());
            let real = |k: usize| {
                let at = k * size_of::<f64>();
                // This cannot fail: `numbers` has D or D + 1 pieces of eight bytes.
                f64::from_le_bytes(*numbers[at..].first_chunk().unwrap())
            };
            self.ids.push(u32::from_le_bytes(*id.first_chunk().unwrap()));
            self.centres.push(Point::from(std::array::from_fn(real)));
            if radii {
                self.radii.push(real(D));
            }
        }
        Ok(())
    }
}
