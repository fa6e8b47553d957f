//! Boxes smaller than the reach of the contact test: estimates the number of contacts, and searches
//! without pairs of two images.
//!
//! A detector that gets all particles and images also finds pairs of two images, which are dropped.
//! In a box smaller than the reach a particle has many images, and the pairs of two images grow
//! with the square of their number. Each particle is then compared with all particles and images
//! instead. That takes n·B tests for n particles, where B is the number of particles and images. It
//! is linear in the size of the result, since most of these pairs touch in such a box. The choice
//! depends on the scene only, and does not change the contacts.

use super::made::Made;
use contactbench_ground::contact::{Particles, StoredParticles};
use contactbench_ground::detect::Detector;
use contactbench_ground::detect::any::{Of, Searched};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::periodic::IMAGE_PAIR_BYTES;
use contactbench_ground::probe::Probe;
use contactbench_ground::scene::Real;
use contactbench_terms::mix::splitmix64;

/// Least number of images for an estimate; for fewer it would cost more than it saves.
const FEW: u64 = 1024;
/// Largest number of images per particle in a box that is at least as large as the reach.
const EACH: u64 = 16;
/// Number of pairs of two images that a detector tests in the time of one test here.
const CHEAPER: f64 = 8.0;
/// Largest number of random pairs that are tested for an estimate.
const DRAWN: u64 = 1 << 16;
/// Number of standard errors that are subtracted from an estimate for a safe lower bound.
const SURE: f64 = 4.0;

/// Returns whether pairs of two images may cost more than all other pairs in this box.
pub fn is_small<const D: usize>(made: &Made<'_, D>) -> bool {
    made.ghosts() >= FEW && made.ghosts() > EACH * u64::from(made.particles())
}

/// Refuses a scene whose contacts with images will almost certainly take more than `limit` bytes,
/// estimated from a sample of pairs, and only in small boxes.
/// [`contactbench_ground::limits::crowd::within`] does the same for contacts without images. Fails
/// with [`Refusal::Crowd`].
pub fn within<const D: usize>(made: &Made<'_, D>, limit: u64) -> Result<(), Refusal> {
    let (n, images) = (u64::from(made.particles()), made.ghosts());
    let (pairs, most) = (n as f64 * images as f64, (limit / IMAGE_PAIR_BYTES) as f64);
    if !is_small(made) || pairs <= most {
        return Ok(());
    }
    let drawn = ((64.0 * pairs / most.max(1.0)) as u64).clamp(FEW, DRAWN);
    let body = |k: u64| splitmix64(k);
    let touching = (0..drawn)
        .filter(|&k| made.overlap(body(2 * k) % n, n + body(2 * k + 1) % images))
        .count() as f64;
    let (scale, least) = (pairs / drawn as f64, touching - SURE * touching.sqrt());
    if least * scale <= most {
        return Ok(());
    }
    Err(Refusal::Crowd { particles: n, each: 2.0 * touching * scale / n as f64, limit })
}

/// Returns whether testing each particle against all particles and images costs less than a
/// detector's tests of two images, whose number is estimated from a sample.
pub fn spares_images<const D: usize>(made: &Made<'_, D>) -> bool {
    if !is_small(made) {
        return false;
    }
    let (n, images) = (u64::from(made.particles()), made.ghosts());
    let body = |k: u64| n + splitmix64(k) % images;
    let touching = (0..FEW).filter(|&k| made.overlap(body(2 * k), body(2 * k + 1))).count() as f64;
    let wasted = touching / FEW as f64 * 0.5 * images as f64 * images as f64;
    wasted > CHEAPER * n as f64 * (n + images) as f64
}

impl<const D: usize> Made<'_, D> {
    /// Returns whether two particles or images touch in rounded arithmetic, for estimates.
    fn overlap(&self, a: u64, b: u64) -> bool {
        let (p, q) = (self.place(a as usize), self.place(b as usize));
        let square: f64 = (0..D).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum();
        let reach = self.radii.get(a as usize) + self.radii.get(b as usize);
        square <= reach * reach
    }
}

/// Tests each particle (numbers below `owners`) against all particles and images with higher
/// numbers, and passes contacts to `sink`.
pub fn search(
    searched: &Searched<'_>,
    owners: u32,
    probe: &mut impl Probe,
    sink: &mut impl Sink,
) -> Result<(), Refusal> {
    let mut direct = OfOwners(owners);
    match searched {
        Searched::Plane(Of::Images(images)) => direct.detect(images.particles()?, probe, sink),
        Searched::Space(Of::Images(images)) => direct.detect(images.particles()?, probe, sink),
        Searched::Plane(Of::Scene(scene, test)) => {
            direct.detect(StoredParticles::<2, false>::new(scene, *test)?, probe, sink)
        }
        Searched::Space(Of::Scene(scene, test)) => {
            direct.detect(StoredParticles::<3, false>::new(scene, *test)?, probe, sink)
        }
    }
}

struct OfOwners(u32);

impl<T: Real, const D: usize> Detector<T, D> for OfOwners {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        for i in 0..self.0 {
            for j in i + 1..particles.len() as u32 {
                if particles.touch(i, j, probe) {
                    sink.contact(i, j);
                }
            }
        }
        Ok(())
    }
}
