//! The part of a scene that each rank makes or reads.

use anyhow::{Context, ensure};

use contactbench::io::{self, Given};
use contactbench::scene::origin::Origin;
use contactbench::scene::spec::Spec;
use contactbench::scene::touching::particle;
use contactbench_ground::scene::AnyScene;

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

/// Returns the part of one rank. From an npy file it reads only the rows of this part. Other files
/// and generated scenes are held as a whole for a moment.
///
/// # Errors
/// Fails as [`Origin::whole`] does.
pub fn part(origin: &Origin, rank: usize, ranks: usize) -> anyhow::Result<Share> {
    let Origin::File(path, options) = origin else {
        return Ok(Share::of(&origin.whole()?, rank, ranks));
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

/// Makes a scene for each rank, with consecutive seeds, side by side along x. The whole scene grows
/// with the number of ranks, and no rank makes more than its part.
///
/// # Errors
/// Fails as [`Origin::whole`] does, for a file, and for a periodic box.
pub fn beside(origin: &Origin, world: &impl World) -> anyhow::Result<Share> {
    let given = together(world, seeded(origin, world.rank()))?;
    let mut width = [width(&given)];
    world.largest(&mut width);
    let first = (given.scene.len() * world.rank()) as u64;
    let scene = together(world, joined(&[(&given, width[0] * world.rank() as f64)]))?;
    Ok(Share { given: scene.into(), first, frames: 1 })
}

/// Makes the scenes of [`beside`] for this many ranks as one scene; fails as that does.
pub fn row(origin: &Origin, ranks: usize) -> anyhow::Result<Given> {
    let all: Vec<Given> = (0..ranks).map(|rank| seeded(origin, rank)).collect::<Result<_, _>>()?;
    let width = all.iter().map(width).fold(0.0, f64::max);
    let places: Vec<_> =
        all.iter().zip(0..).map(|(given, k)| (given, width * f64::from(k))).collect();
    Ok(joined(&places)?.into())
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
    let x = (0..given.scene.len() as u32).map(|k| particle(&given.scene, k).0[0]);
    let ends = x.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    (ends[1] - ends[0]).max(0.0) + 1.8 * given.scene.largest_radius()
}

/// Joins scenes, each moved along x by its number, to one.
fn joined(scenes: &[(&Given, f64)]) -> anyhow::Result<AnyScene<'static>> {
    let moved = |&(given, by): &(&Given, f64)| {
        let scene = given.scene.clone();
        (0..scene.len() as u32).map(move |k| {
            let ([x, y, z], r) = particle(&scene, k);
            ([x + by, y, z], r)
        })
    };
    let (centres, radii): (Vec<[f64; 3]>, Vec<f64>) = scenes.iter().flat_map(moved).unzip();
    match scenes.iter().any(|(given, _)| given.scene.dim() == 3) {
        false => AnyScene::at(centres.iter().map(|&[x, y, _]| [x, y]), radii),
        true => AnyScene::at(centres, radii),
    }
    .context("--each goes too far along x")
}
