//! Motion: the frames of a scene whose particles move.
//!
//! Frame 0 is the scene. Frame k is a function of the scene, the motion and k alone, with the same
//! bits on every machine: a frame may be asked for by itself and again. Speeds are in diameters of
//! the largest body per frame. Particles fly through each other, so that a motion stays what its
//! name says for as long as it lasts. In a periodic box some motions go on through its faces, and a
//! shear is one of the box.

mod boxed;
mod paths;

use std::fmt;
use std::str::FromStr;

use anyhow::{Context, bail, ensure};

use self::paths::Paths;
use contactbench_core::scene::{AnyScene, Scene, Storage, Stored};
use contactbench_io::Given;
use contactbench_terms::grammar::Spec;
use contactbench_terms::nearest::hint;

/// A kind of motion, with its line in the list of motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// All stay where they are.
    Rest,
    /// Straight flight.
    Drift,
    /// Layers that slide.
    Shear,
    /// The whole turns.
    Rotation,
    /// The inner turns faster than the outer.
    Vortex,
    /// About the first place.
    Jitter,
    /// A new velocity now and then.
    Brownian,
    /// One flies, the others rest.
    Bullet,
    /// A motion of an earlier version, one of `GONE`: records have it, and it cannot be made.
    Gone(&'static str),
}

/// Motions that records until 26 November 2026 have, and this program does not make.
const GONE: [&str; 3] = ["collapse", "drum", "penetration"];

impl Kind {
    /// All that can be made.
    pub const ALL: [Kind; 8] = [
        Kind::Rest,
        Kind::Drift,
        Kind::Shear,
        Kind::Rotation,
        Kind::Vortex,
        Kind::Jitter,
        Kind::Brownian,
        Kind::Bullet,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Rest => "rest",
            Kind::Drift => "drift",
            Kind::Shear => "shear",
            Kind::Rotation => "rotation",
            Kind::Vortex => "vortex",
            Kind::Jitter => "jitter",
            Kind::Brownian => "brownian",
            Kind::Bullet => "bullet",
            Kind::Gone(name) => name,
        }
    }

    /// Fails for motions of earlier versions.
    pub fn made(self) -> anyhow::Result<()> {
        let Kind::Gone(name) = self else { return Ok(()) };
        bail!(
            "this program does not make the motion '{name}' of earlier versions; take one of {}",
            Kind::ALL.map(Kind::name).join(", ")
        )
    }

    /// What it does, and which speed is meant.
    pub fn summary(self) -> &'static str {
        match self {
            Kind::Rest => "nothing moves",
            Kind::Drift => {
                "straight flight between walls that reflect the centres, as far out as those of \
                 frame 0, or on through the faces of a box that repeats; velocities are uniform in \
                 a ball, and speed is the largest"
            }
            Kind::Shear => {
                "layers slide along x, as fast as they are far from the middle along y; speed is \
                 that of the outermost. A box that repeats along y is sheared (after Lees and \
                 Edwards): its corner stays, and its upper face goes with twice the speed"
            }
            Kind::Rotation => {
                "all turn as one body about the middle, around z; speed is that of the outermost"
            }
            Kind::Vortex => {
                "all turn about the middle, around z, the inner in less time than the outer; speed \
                 is the largest, at an eighth of the widest edge from the middle"
            }
            Kind::Jitter => {
                "in each frame each particle is somewhere else about its place in frame 0; speed \
                 is the standard deviation along each axis (PointNeighbors.jl moves points so to \
                 compare updates of lists)"
            }
            Kind::Brownian => {
                "as drift, and each particle gets a new velocity in every 100th frame, in turn \
                 (after Broadmark, Computer Graphics Forum 39:436, 2020, where bodies outside the \
                 box are frozen instead)"
            }
            Kind::Bullet => {
                "the first particle flies straight through the box of drift, whose walls reflect \
                 it, and all others rest; speed is its own"
            }
            Kind::Gone(_) => "soft spheres, which this program does not make",
        }
    }
}

/// A motion and its speed: written `drift:speed=0.001,seed=2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// How they move.
    pub kind: Kind,
    /// In diameters of the largest body per frame.
    pub speed: f64,
    /// Of the draws.
    pub seed: u64,
}

/// Where none is given: a particle needs some hundred frames for its diameter.
pub const SPEED: f64 = 0.01;
/// The same of draws.
pub const SEED: u64 = 1;

impl FromStr for Motion {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> anyhow::Result<Motion> {
        let given = Spec::parse(text);
        let name = given.name;
        let mut all = Kind::ALL.into_iter().chain(GONE.map(Kind::Gone));
        let Some(kind) = all.find(|kind| kind.name() == name) else {
            bail!(
                "there is no motion '{name}'{}; the motions are: {}",
                hint(name, Kind::ALL.map(Kind::name)),
                Kind::ALL.map(Kind::name).join(", ")
            );
        };
        given.keys(&["speed", "seed"], "a motion takes speed=NUMBER and seed=NUMBER")?;
        let speed = given.get("speed").map_or(Ok(SPEED), |value| {
            let number = value.parse().ok().filter(|speed| (0.0..=1e6).contains(speed));
            let allowed = "a number from 0 to 1e6, in diameters per frame";
            number.ok_or_else(|| given.wrong("speed", value, &[], allowed))
        })?;
        let seed = given.get("seed").map_or(Ok(SEED), |value| {
            value.parse().map_err(|_| given.wrong("seed", value, &[], "a whole number"))
        })?;
        Ok(Motion { kind, speed, seed })
    }
}

impl fmt::Display for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Motion { kind, speed, seed } = self;
        match kind {
            Kind::Rest => f.write_str(kind.name()),
            _ => write!(f, "{}:speed={speed},seed={seed}", kind.name()),
        }
    }
}

/// The frames of a scene in motion.
pub struct Frames(Of);

enum Of {
    Plane(Scene<'static, f64, 2>, Paths<2>),
    Space(Scene<'static, f64, 3>, Paths<3>),
}

impl Frames {
    /// Of this scene, in its box if it has one.
    ///
    /// # Errors
    /// The scene cannot be stored in f64, or has no diameter for speeds to be measured in; the
    /// motion is none for its box, or is [`Kind::Gone`].
    pub fn new(given: &Given, motion: Motion) -> anyhow::Result<Frames> {
        motion.kind.made()?;
        let (scene, lattice) = (&given.scene, given.lattice.as_ref());
        let moves = motion.kind != Kind::Rest && motion.speed > 0.0 && !scene.is_empty();
        ensure!(
            !moves || scene.largest_radius() > 0.0,
            "speeds are in diameters of the largest body, and all bodies of this scene are points; \
             give them a radius, or take --motion rest"
        );
        Ok(Frames(match scene.stored(Storage::F64)? {
            AnyScene::Plane(Stored::F64(scene)) => {
                let paths = Paths::new(&scene, lattice, motion)?;
                Of::Plane(scene, paths)
            }
            AnyScene::Space(Stored::F64(scene)) => {
                let paths = Paths::new(&scene, lattice, motion)?;
                Of::Space(scene, paths)
            }
            _ => bail!("a scene stored in f64 is in f64"),
        }))
    }

    /// Frame k, with its periodic box. Frames of [`Kind::Brownian`] cost as many frames as lie
    /// between this one and the one asked for before, or the first; all others cost one.
    ///
    /// # Errors
    /// A particle has flown beyond the numbers of f64.
    pub fn at(&mut self, k: u64) -> anyhow::Result<Given> {
        match &mut self.0 {
            Of::Plane(scene, paths) => moved(scene, paths, k),
            Of::Space(scene, paths) => moved(scene, paths, k),
        }
    }
}

fn moved<const D: usize>(
    scene: &Scene<'static, f64, D>,
    paths: &mut Paths<D>,
    k: u64,
) -> anyhow::Result<Given>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    let beyond = || format!("frame {k}; take fewer frames, or a smaller speed");
    let lattice = paths.lattice(k).with_context(beyond)?;
    let centres = paths.at(k, scene.centres())?;
    let scene = Scene::new(centres, scene.radii().clone()).with_context(beyond)?;
    match lattice {
        None => Ok(scene.into()),
        Some(lattice) => Given::in_box(scene.into(), lattice),
    }
}

/// The largest diameter of a scene.
fn diameter<const D: usize>(scene: &Scene<'_, f64, D>) -> f64 {
    2.0 * scene.largest_radius()
}

#[cfg(test)]
mod box_tests;
#[cfg(test)]
mod tests;
