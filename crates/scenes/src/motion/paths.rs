//! The positions of all particles in a frame.

use nalgebra::Point;

use super::boxed::{Boxed, brought};
use super::{Motion, MotionKind, diameter};
use crate::generate::draw::Draw;
use contactbench_ground::scene::{Lattice, Scene};

/// Number of frames after which a particle gets a new velocity in [`MotionKind::Brownian`].
const PERIOD: u64 = 100;

/// The values that, with the centres in frame 0, determine the positions in frame k.
pub(super) struct Paths<const D: usize> {
    kind: MotionKind,
    seed: u64,
    /// Speed, in length per frame.
    speed: f64,
    low: [f64; D],
    extent: [f64; D],
    /// Velocities of the particles, in length per frame.
    velocities: Vec<[f64; D]>,
    walk: Walk<D>,
    /// For [`MotionKind::Shear`]: velocity along x per unit of y, then the y where particles are at
    /// rest.
    slope: f64,
    still: f64,
    /// Box and walls of a periodic scene; `None` in open space.
    boxed: Option<Boxed<D>>,
}

/// State of a random walk: the displacements up to `frame`, ignoring walls.
struct Walk<const D: usize> {
    frame: u64,
    at: Vec<[f64; D]>,
    velocities: Vec<[f64; D]>,
}

impl<const D: usize> Paths<D> {
    pub fn new(
        scene: &Scene<'_, f64, D>,
        lattice: Option<&Lattice>,
        motion: Motion,
    ) -> anyhow::Result<Paths<D>> {
        let Motion { kind, speed, seed } = motion;
        let boxed = lattice.map(|lattice| Boxed::new(scene, lattice, kind)).transpose()?;
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for centre in scene.centres() {
            for k in 0..D {
                (low[k], high[k]) = (low[k].min(centre[k]), high[k].max(centre[k]));
            }
        }
        if scene.is_empty() {
            (low, high) = ([0.0; D], [0.0; D]);
        }
        let extent = std::array::from_fn(|k| high[k] - low[k]);
        let speed = speed * diameter(scene);
        let velocities = match kind {
            MotionKind::Drift | MotionKind::Brownian => {
                let mut draw = Draw::of_motion(seed, 0);
                scene.centres().iter().map(|_| in_ball(&mut draw, speed)).collect()
            }
            MotionKind::Bullet => {
                let mut velocities = vec![[0.0; D]; scene.len()];
                let bullet = velocities.iter_mut().take(1);
                bullet.for_each(|it| *it = on_ball(&mut Draw::of_motion(seed, 0), speed));
                velocities
            }
            _ => Vec::new(),
        };
        let walk = Walk { frame: 0, at: Vec::new(), velocities: Vec::new() };
        let height = boxed.as_ref().and_then(Boxed::height);
        let (most, still) = height.map_or_else(
            || {
                let still = low[1] + 0.5 * extent[1];
                let far = scene.centres().iter().map(|at| (at[1] - still).abs());
                (far.fold(0.0, f64::max), still)
            },
            |(height, corner)| (0.5 * height, corner),
        );
        let slope = if kind == MotionKind::Shear && most > 0.0 { speed / most } else { 0.0 };
        Ok(Paths { kind, seed, speed, low, extent, velocities, walk, slope, still, boxed })
    }

    pub fn lattice(&self, k: u64) -> anyhow::Result<Option<Lattice>> {
        let lattice = |boxed: &Boxed<D>| boxed.sheared(self.slope * k as f64);
        self.boxed.as_ref().map(lattice).transpose()
    }

    pub fn at(&mut self, k: u64, first: &[Point<f64, D>]) -> anyhow::Result<Vec<Point<f64, D>>> {
        let time = k as f64;
        let all = first.iter();
        Ok(match self.kind {
            MotionKind::Rest | MotionKind::Gone(_) => first.to_vec(),
            _ if k == 0 => first.to_vec(),
            MotionKind::Drift | MotionKind::Bullet => {
                let displacements = self.velocities.iter().map(|it| it.map(|v| v * time));
                all.zip(displacements).map(|(at, it)| self.gone(at, &it)).collect()
            }
            MotionKind::Brownian => {
                self.walk_to(k, first.len());
                all.zip(&self.walk.at).map(|(at, it)| self.gone(at, it)).collect()
            }
            MotionKind::Jitter => {
                let mut draw = Draw::of_motion(self.seed, k);
                let moved = all.map(|at| at.map(|x| x + self.speed * draw.normal()));
                match &self.boxed {
                    None => moved.collect(),
                    Some(boxed) => moved.map(|at| boxed.in_first(&at)).collect(),
                }
            }
            MotionKind::Shear => {
                let slid = all.map(|at| {
                    let mut at = *at;
                    at[0] += self.slope * (at[1] - self.still) * time;
                    at
                });
                match self.lattice(k)? {
                    None => slid.collect(),
                    Some(lattice) => slid.map(|at| brought(&lattice, &at)).collect(),
                }
            }
            MotionKind::Rotation | MotionKind::Vortex => self.whirled(time, first),
        })
    }

    /// Returns the positions after a rotation about the middle: as a rigid body, or in a vortex.
    fn whirled(&self, time: f64, first: &[Point<f64, D>]) -> Vec<Point<f64, D>> {
        let middle: [f64; D] = std::array::from_fn(|k| self.low[k] + 0.5 * self.extent[k]);
        let rigid = self.kind == MotionKind::Rotation;
        // Distance from the centre at which motion is fastest: that of the outermost particle in a
        // rotation, the edge of the core in a vortex.
        let most = match rigid {
            true => first.iter().map(|at| distance(at, &middle)).fold(0.0, f64::max),
            false => 0.125 * self.extent.iter().fold(0.0f64, |most, &edge| most.max(edge)),
        };
        if most == 0.0 {
            return first.to_vec();
        }
        let turn = |at: &Point<f64, D>| {
            let far = distance(at, &middle) / most;
            match rigid {
                true => self.speed / most * time,
                false => 2.0 * self.speed / most / (1.0 + far * far) * time,
            }
        };
        first.iter().map(|at| turned(at, &middle, turn(at))).collect()
    }

    fn gone(&self, first: &Point<f64, D>, displacement: &[f64; D]) -> Point<f64, D> {
        match &self.boxed {
            None => self.reflected(first, displacement),
            Some(boxed) => boxed.gone(first, displacement),
        }
    }

    /// Returns the position in open space after this displacement, reflected at the walls.
    fn reflected(&self, first: &Point<f64, D>, displacement: &[f64; D]) -> Point<f64, D> {
        let along = |k: usize| {
            let (low, extent) = (self.low[k], self.extent[k]);
            if displacement[k] == 0.0 || extent == 0.0 {
                return first[k];
            }
            let on = between_walls(first[k] - low + displacement[k], extent);
            (low + on).min(low + extent)
        };
        Point::from(std::array::from_fn(along))
    }

    fn walk_to(&mut self, k: u64, n: usize) {
        if self.walk.at.len() != n || k < self.walk.frame {
            let velocities = self.velocities.clone();
            self.walk = Walk { frame: 0, at: vec![[0.0; D]; n], velocities };
        }
        while self.walk.frame < k {
            let frame = self.walk.frame;
            // Particles k with k mod `PERIOD` = `turn` get a new velocity in this frame.
            let turn = (frame % PERIOD) as usize;
            let mut draw = Draw::of_motion(self.seed, frame + 1);
            let velocities = &mut self.walk.velocities;
            for velocity in velocities.iter_mut().skip(turn).step_by(PERIOD as usize) {
                *velocity = in_ball(&mut draw, self.speed);
            }
            for (at, velocity) in self.walk.at.iter_mut().zip(velocities) {
                for k in 0..D {
                    at[k] += velocity[k];
                }
            }
            self.walk.frame += 1;
        }
    }
}

/// Reflects the coordinate `on` between walls at 0 and `extent`.
pub(super) fn between_walls(on: f64, extent: f64) -> f64 {
    let period = 2.0 * extent;
    if period == f64::INFINITY {
        // The walls are too far apart for f64. The infinite coordinate makes the frame fail.
        return period;
    }
    if period == 0.0 {
        return 0.0;
    }
    let on = on % period;
    let on = if on < 0.0 { on + period } else { on };
    if on > extent { period - on } else { on }
}

/// Returns a uniform random vector in a ball around 0.
fn in_ball<const D: usize>(draw: &mut Draw, radius: f64) -> [f64; D] {
    loop {
        let at: [f64; D] = std::array::from_fn(|_| draw.symmetric());
        if at.iter().map(|x| x * x).sum::<f64>() <= 1.0 {
            return at.map(|x| x * radius);
        }
    }
}

/// Returns a vector of length `radius` in a random direction.
fn on_ball<const D: usize>(draw: &mut Draw, radius: f64) -> [f64; D] {
    loop {
        let at: [f64; D] = in_ball(draw, 1.0);
        let square = at.iter().map(|x| x * x).sum::<f64>();
        if square > 0.1 {
            return at.map(|x| x / square.sqrt() * radius);
        }
    }
}

/// Returns the distance from the line through `middle` along z.
fn distance<const D: usize>(at: &Point<f64, D>, middle: &[f64; D]) -> f64 {
    let (x, y) = (at[0] - middle[0], at[1] - middle[1]);
    (x * x + y * y).sqrt()
}

fn turned<const D: usize>(at: &Point<f64, D>, middle: &[f64; D], angle: f64) -> Point<f64, D> {
    let (sine, cosine) = libm::sincos(angle);
    let (x, y) = (at[0] - middle[0], at[1] - middle[1]);
    let mut turned = *at;
    turned[0] = middle[0] + (x * cosine - y * sine);
    turned[1] = middle[1] + (x * sine + y * cosine);
    turned
}
