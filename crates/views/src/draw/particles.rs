//! Circles of a picture: the particles, followed by those periodic images that are in a drawn pair.

use std::collections::HashMap;

use anyhow::ensure;

use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_scenes::touching::particle;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    pub particle: u32,
    /// Shift of the image in box vectors; 0 for the particle itself.
    pub image: [i32; 3],
    /// Centre; in 2D the third coordinate is 0.
    pub centre: [f64; 3],
    pub r: f64,
}

impl Particle {
    pub fn is_image(&self) -> bool {
        self.image != [0; 3]
    }
}

pub struct Particles {
    /// All particles, followed by the images.
    pub all: Vec<Particle>,
    images: HashMap<(u32, [i32; 3]), u32>,
}

impl Particles {
    /// Collects the particles and the images that these pairs need, at rounded positions. Fails for
    /// an image beyond the range of f64.
    pub fn new<'a>(
        periodic: &Periodic<'_>,
        pairs: impl Iterator<Item = &'a ImagePair>,
    ) -> anyhow::Result<Particles> {
        let body = |k: u32| {
            let (centre, r) = particle(periodic.scene(), k);
            Particle { particle: k, image: [0; 3], centre, r }
        };
        let mut all: Vec<Particle> = (0..periodic.scene().len() as u32).map(body).collect();
        let (mut images, vectors) = (HashMap::new(), periodic.lattice().vectors());
        for &ImagePair { i, j, image } in pairs.filter(|pair| pair.image != [0; 3]) {
            for (particle, image) in [(j, image), (i, image.map(i32::wrapping_neg))] {
                images.entry((particle, image)).or_insert_with(|| {
                    let mut body = Particle { image, ..all[particle as usize] };
                    for (vector, times) in vectors.iter().zip(image) {
                        let moved = |k: usize| body.centre[k] + f64::from(times) * vector[k];
                        body.centre = if times == 0 { body.centre } else { [0, 1, 2].map(moved) };
                    }
                    all.push(body);
                    (all.len() - 1) as u32
                });
            }
        }
        let finite = |body: &Particle| body.centre.iter().all(|x| x.is_finite());
        ensure!(all.iter().all(finite), "an image is beyond the range of f64; it cannot be drawn");
        Ok(Particles { all, images })
    }

    /// Returns the lines of a pair: one, or one on each side if the pair crosses a face of the box.
    pub fn lines(&self, pair: ImagePair) -> impl Iterator<Item = [u32; 2]> + use<> {
        let ImagePair { i, j, image } = pair;
        let to = |of: u32, image: [i32; 3]| self.images.get(&(of, image)).copied();
        let lines = match image {
            [0, 0, 0] => [Some([i, j]), None],
            _ => [
                to(j, image).map(|body| [i, body]),
                to(i, image.map(i32::wrapping_neg)).map(|body| [j, body]),
            ],
        };
        lines.into_iter().flatten()
    }
}
