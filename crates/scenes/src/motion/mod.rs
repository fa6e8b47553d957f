//! Motion: the frames of a scene whose particles move.
//!
//! Frame 0 is the scene. Frame k depends only on the scene, the motion and k, and has the same bits
//! on every machine, so frames can be made in any order. Speeds are in diameters of the largest
//! particle per frame. Particles fly through each other, so that a motion never changes its
//! character. Some motions continue through the faces of a periodic box; a shear also shears the
//! box.

mod boxed;
mod paths;

use std::fmt;
use std::str::FromStr;

use anyhow::{Context, bail, ensure};

use self::paths::Paths;
use contactbench_ground::scene::{AnyScene, Lattice, Scene, Storage, Stored};
use contactbench_io::Given;
use contactbench_terms::grammar::Spec;
use contactbench_terms::nearest::hint;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    Rest,
    Drift,
    Shear,
    Rotation,
    Vortex,
    Jitter,
    Brownian,
    Bullet,
    /// A motion of an earlier version, one of `GONE`. Records may name it; it cannot be made.
    Gone(&'static str),
}

/// Motions in records until 26 November 2026, which this program does not make.
const GONE: [&str; 3] = ["collapse", "drum", "penetration"];

/// Name of each motion on the command line, and summary with the meaning of the speed, in the order
/// of [`MotionKind::ALL`].
const TABLE: &str = include_str!("kinds.txt");

impl MotionKind {
    pub const ALL: [MotionKind; 8] = {
        use MotionKind::*;
        [Rest, Drift, Shear, Rotation, Vortex, Jitter, Brownian, Bullet]
    };

    /// Returns the name and the summary.
    fn row(self) -> (&'static str, &'static str) {
        let rows = TABLE.lines().filter_map(|line| line.split_once(": "));
        match self {
            MotionKind::Gone(name) => (name, "soft spheres, which this program does not make"),
            _ => MotionKind::ALL
                .into_iter()
                .zip(rows)
                .find(|row| row.0 == self)
                .map_or(("", ""), |it| it.1),
        }
    }

    pub fn name(self) -> &'static str {
        self.row().0
    }

    pub fn summary(self) -> &'static str {
        self.row().1
    }

    /// Checks that this program can make the motion; fails for those of earlier versions.
    pub fn made(self) -> anyhow::Result<()> {
        let MotionKind::Gone(name) = self else { return Ok(()) };
        bail!(
            "this program does not make the motion '{name}' of earlier versions; take one of {}",
            MotionKind::ALL.map(MotionKind::name).join(", ")
        )
    }
}

/// A motion and its speed, written as in `drift:speed=0.001,seed=2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    pub kind: MotionKind,
    /// Speed in diameters of the largest particle per frame.
    pub speed: f64,
    pub seed: u64,
}

/// Default speed: a particle needs about a hundred frames to move by its diameter.
pub const SPEED: f64 = 0.01;
pub const SEED: u64 = 1;

impl FromStr for Motion {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> anyhow::Result<Motion> {
        let given = Spec::parse(text);
        let name = given.name;
        let mut all = MotionKind::ALL.into_iter().chain(GONE.map(MotionKind::Gone));
        let Some(kind) = all.find(|kind| kind.name() == name) else {
            bail!(
                "there is no motion '{name}'{}; the motions are: {}",
                hint(name, MotionKind::ALL.map(MotionKind::name)),
                MotionKind::ALL.map(MotionKind::name).join(", ")
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
            MotionKind::Rest => f.write_str(kind.name()),
            _ => write!(f, "{}:speed={speed},seed={seed}", kind.name()),
        }
    }
}

pub struct Frames(Box<dyn FnMut(u64) -> anyhow::Result<Given>>);

impl Frames {
    /// Prepares the frames of a scene, in its box if it has one.
    ///
    /// # Errors
    /// Fails if f64 cannot store the scene, if speeds have no meaning because all radii are 0, if
    /// the motion does not work in the box, or if it is [`MotionKind::Gone`].
    pub fn new(given: &Given, motion: Motion) -> anyhow::Result<Frames> {
        motion.kind.made()?;
        let (scene, lattice) = (&given.scene, given.lattice.as_ref());
        let moves = motion.kind != MotionKind::Rest && motion.speed > 0.0 && !scene.is_empty();
        ensure!(
            !moves || scene.largest_radius() > 0.0,
            "speeds are in diameters of the largest particle, but all radii of this scene are 0; \
             give a radius, or take --motion rest"
        );
        match scene.stored(Storage::F64)? {
            AnyScene::Plane(Stored::F64(scene)) => Frames::of(scene, lattice, motion),
            AnyScene::Space(Stored::F64(scene)) => Frames::of(scene, lattice, motion),
            _ => bail!("a scene stored in f64 is in f64"),
        }
    }

    fn of<const D: usize>(
        scene: Scene<'static, f64, D>,
        lattice: Option<&Lattice>,
        motion: Motion,
    ) -> anyhow::Result<Frames>
    where
        AnyScene<'static>: From<Scene<'static, f64, D>>,
    {
        let mut paths = Paths::new(&scene, lattice, motion)?;
        Ok(Frames(Box::new(move |k| {
            let beyond = || format!("frame {k}; take fewer frames, or a smaller speed");
            let lattice = paths.lattice(k).with_context(beyond)?;
            let centres = paths.at(k, scene.centres())?;
            let scene = Scene::new(centres, scene.radii().clone()).with_context(beyond)?;
            match lattice {
                None => Ok(scene.into()),
                Some(lattice) => Given::in_box(scene.into(), lattice),
            }
        })))
    }

    /// Makes frame `k`, with its periodic box. Frames of [`MotionKind::Brownian`] are computed one
    /// after the other, from the last frame made or, if `k` is smaller, from frame 0.
    ///
    /// # Errors
    /// Fails if a coordinate overflows f64.
    pub fn at(&mut self, k: u64) -> anyhow::Result<Given> {
        (self.0)(k)
    }
}

fn diameter<const D: usize>(scene: &Scene<'_, f64, D>) -> f64 {
    2.0 * scene.largest_radius()
}

#[cfg(test)]
mod box_tests;
#[cfg(test)]
mod tests;
