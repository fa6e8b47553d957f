//! The part of a scene that each rank makes or reads.

use anyhow::{Context, ensure};

use contactbench::io::{self, Given};
use contactbench::scene::origin::Origin;
use contactbench::scene::spec::Spec;
use contactbench_ground::scene::{AnyScene, Radii, Real, Scene, array};

use crate::rank::together;
use crate::world::World;

/// Particles that one rank makes or reads, which other ranks may own later.
#[derive(Clone, Debug)]
pub struct Share {
    /// The particles, and the box of the whole scene.
    pub given: Given,
    /// Number that the first particle has in the whole scene.
    pub first: u64,
    /// Number of frames in the file; 1 for a generated scene.
    pub frames: u64,
}

pub trait Dealt {
    /// Returns the part of one rank. From an npy file it reads only the rows of this part. Other
    /// files and generated scenes are held as a whole for a moment.
    ///
    /// # Errors
    /// Fails as [`Origin::whole`] does.
    fn share(&self, rank: usize, ranks: usize) -> anyhow::Result<Share>;

    /// Makes a scene for each rank, with consecutive seeds, side by side along x. The whole scene
    /// grows with the number of ranks, and no rank makes more than its part.
    ///
    /// # Errors
    /// Fails as [`Origin::whole`] does, for a file, and for a periodic box.
    fn beside(&self, world: &impl World) -> anyhow::Result<Share>;

    /// Makes the scenes of [`Dealt::beside`] for this many ranks as one scene; fails as that does.
    fn row(&self, ranks: usize) -> anyhow::Result<Given>;
}

impl Dealt for Origin {
    fn share(&self, rank: usize, ranks: usize) -> anyhow::Result<Share> {
        let Origin::File(path, options) = self else {
            return Ok(Share::of(&self.whole()?, rank, ranks));
        };
        let part = Some([rank as u64, ranks as u64]);
        let (particles, about) = io::load(path, io::Options { part, ..**options })?;
        let first = particles.first;
        let given = particles.given(&path.display().to_string(), options.radius)?;
        let frames = about.frames;
        Ok(match first {
            Some(first) => Share { given, first, frames },
            None => Share { frames, ..Share::of(&given, rank, ranks) },
        })
    }

    fn beside(&self, world: &impl World) -> anyhow::Result<Share> {
        let given = together(world, seeded(self, world.rank()))?;
        let mut width = [width(&given)];
        world.largest(&mut width);
        let first = (given.scene.len() * world.rank()) as u64;
        let scene = together(world, moved(&given, width[0] * world.rank() as f64))?;
        Ok(Share { given: scene.into(), first, frames: 1 })
    }

    fn row(&self, ranks: usize) -> anyhow::Result<Given> {
        let all: Vec<Given> =
            (0..ranks).map(|rank| seeded(self, rank)).collect::<Result<_, _>>()?;
        let width = all.iter().map(width).fold(0.0, f64::max);
        let places = all.iter().zip(0..).map(|(given, k)| moved(given, width * f64::from(k)));
        one(&places.collect::<anyhow::Result<Vec<_>>>()?)
    }
}

fn seeded(origin: &Origin, rank: usize) -> anyhow::Result<Given> {
    let Origin::Made(spec) = origin else {
        anyhow::bail!(
            "--each makes a scene per rank, but a file is split between ranks; leave out --each"
        );
    };
    let seed = spec.seed.wrapping_add(rank as u64);
    let given = Spec { seed, ..spec.clone() }.given()?;
    ensure!(
        given.lattice.is_none(),
        "--each puts scenes side by side, but this one has a periodic box; leave out the box, or \
         --each"
    );
    Ok(given)
}

impl Share {
    pub fn of(given: &Given, rank: usize, ranks: usize) -> Share {
        let n = given.scene.len() as u64;
        let end = |k: usize| (n * k as u64 / ranks as u64) as u32;
        let rows: Vec<u32> = (end(rank)..end(rank + 1)).collect();
        let Given { lattice, has_box, notices, source, .. } = given;
        let (scene, notices) = (given.scene.reordered(&rows), notices.clone());
        let source = source.clone();
        let given = Given { scene, lattice: *lattice, has_box: *has_box, notices, source };
        Share { given, first: end(rank).into(), frames: 1 }
    }
}

/// Returns the distance along x to the next scene, which leaves 0.9 of the largest diameter between
/// the nearest centres.
fn width(given: &Given) -> f64 {
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    contactbench_ground::with_scene!(&given.scene, scene => for x in scene.centres() {
        let x = array(x)[0].wide();
        ends = [ends[0].min(x), ends[1].max(x)];
    });
    (ends[1] - ends[0]).max(0.0) + 1.8 * given.scene.largest_radius()
}

fn moved(given: &Given, by: f64) -> anyhow::Result<AnyScene<'static>> {
    fn of<const D: usize>(
        scene: &Scene<'_, f64, D>,
        by: f64,
    ) -> anyhow::Result<Scene<'static, f64, D>> {
        let centres = scene.centres().iter().map(|centre| {
            let mut centre = *centre;
            centre[0] += by;
            centre
        });
        let radii = match scene.radii() {
            Radii::Uniform(r) => Radii::Uniform(*r),
            Radii::Each(radii) => Radii::Each(radii.to_vec().into()),
        };
        Scene::new(centres.collect::<Vec<_>>(), radii).context("--each goes too far along x")
    }
    Ok(match &given.scene {
        AnyScene::Plane(stored) => of(&stored.widened(), by)?.into(),
        AnyScene::Space(stored) => of(&stored.widened(), by)?.into(),
    })
}

fn one(scenes: &[AnyScene<'static>]) -> anyhow::Result<Given> {
    fn of<const D: usize>(scenes: &[Scene<'_, f64, D>]) -> anyhow::Result<Scene<'static, f64, D>> {
        let centres = scenes.iter().flat_map(|scene| scene.centres()).copied();
        let radii = scenes.iter().flat_map(|scene| (0..scene.len()).map(|k| scene.radius(k)));
        Ok(Scene::new(centres.collect::<Vec<_>>(), Radii::Each(radii.collect::<Vec<_>>().into()))?)
    }
    let (mut plane, mut space) = (Vec::new(), Vec::new());
    for scene in scenes {
        match scene {
            AnyScene::Plane(stored) => plane.push(stored.widened().into_owned()),
            AnyScene::Space(stored) => space.push(stored.widened().into_owned()),
        }
    }
    Ok(if space.is_empty() { of::<2>(&plane)?.into() } else { of::<3>(&space)?.into() })
}
