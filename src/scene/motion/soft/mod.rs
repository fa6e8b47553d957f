//! Soft spheres: a small model that makes contacts come and go as they do in granular matter.
//!
//! Bodies are discs or spheres of one density that push each other where they overlap: a linear
//! spring and dashpot along the normal, and a dashpot along the surface that a coefficient of
//! friction limits (Cundall and Strack 1979, doi:10.1680/geot.1979.29.1.47; LAMMPS's `gran/hooke`
//! without its torques). Bodies do not turn, and contacts have no memory. The units are the largest
//! diameter, the mass of that body, and gravity.
//!
//! ```text
//! collapse            drum               penetration
//! |                     .-----.          |   O   |
//! |o o                .'       '.        |   v   |
//! |oooo              /  o o      \       |       |
//! |oooo  ->          \ ooooo o <-/       |o o o o|
//! |oooo_________|     '.ooooo_.'         |ooooooo|
//! ```
//!
//! A frame is the same bits on every machine: the list of near pairs holds, whoever finds them, the
//! same pairs in ascending order, forces are summed in that order, and only + - * / and roots are
//! used. A step costs O(N), and needs some 250 bytes for each body and 24 for each listed couple.

mod body;
mod near;
mod stage;

use anyhow::{Context, ensure};
use nalgebra::Point;

use self::body::Body;
use self::near::{Couple, Near};
use self::stage::Stage;
use crate::detect::{Options, table};
use crate::memory::limit_for;
use crate::scene::order::morton;
use crate::scene::{AnyScene, Scene};

/// What is played.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Play {
    /// A column whose right wall is taken away.
    Collapse,
    /// A drum that turns.
    Drum,
    /// A ball that flies into the others.
    Penetration,
}

impl Play {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Play::Collapse => "collapse",
            Play::Drum => "drum",
            Play::Penetration => "penetration",
        }
    }

    /// What it does, and which speed is meant.
    pub fn summary(self) -> &'static str {
        match self {
            Play::Collapse => {
                "soft spheres: a column whose right wall is taken away; the next wall is three \
                 heights further; speed is that of a free fall from the height of the scene"
            }
            Play::Drum => {
                "soft spheres in a drum around the scene, which turns about the middle (in 3D \
                 about y, between two ends) with a tenth of gravity at its wall; speed is the \
                 wall's"
            }
            Play::Penetration => {
                "soft spheres in a box: the largest (the first of them; of equal ones the topmost) \
                 is sent down into the others with the root of 128 g d (as in Dosta et al. 2024, \
                 doi:10.1016/j.cpc.2023.109066); speed is that"
            }
        }
    }
}

/// A frame has no more steps of time.
const MOST_STEPS: f64 = 1e5;
/// Edges of the scene in diameters of the largest body, at most: places are known to 1e-7 then.
const WIDEST: f64 = 1e9;
/// Steps in the shortest collision of two bodies.
const STEPS_PER_COLLISION: f64 = 25.0;
/// The spring of two of the largest bodies, in m v²/d² for the fastest speed v that there is: at
/// that speed they overlap by 4%.
const STIFFNESS: f64 = 250.0;
/// No body is faster than so many times that speed.
const FASTEST: f64 = 2.0;

/// The frames of a play.
pub(super) struct Soft<const D: usize> {
    stage: Stage<D>,
    /// As in frame 0, near one another in memory where they are near in space.
    first: Vec<Body<D>>,
    /// Which particle each of them is.
    order: Vec<u32>,
    /// Of the scene, and its unit of length.
    low: [f64; D],
    diameter: f64,
    /// Of a frame, and how long each is.
    steps: u64,
    time: f64,
    /// No body is faster.
    fastest: f64,
    near: Near<D>,
    /// The frame that was made last, and its bodies.
    last: Option<(u64, Vec<Body<D>>)>,
}

impl<const D: usize> Soft<D>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    /// Of a scene with bodies, the largest of which is no point; a body with the speed of the play
    /// goes `speed` diameters in a frame.
    ///
    /// # Errors
    /// The scene is too wide, or a frame would take too many steps.
    pub fn new(scene: &Scene<'_, f64, D>, play: Play, speed: f64) -> anyhow::Result<Soft<D>> {
        let diameter = super::diameter(scene);
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for (k, centre) in scene.centres().iter().enumerate() {
            for axis in 0..D {
                low[axis] = low[axis].min(centre[axis] - scene.radius(k));
                high[axis] = high[axis].max(centre[axis] + scene.radius(k));
            }
        }
        let extent: [f64; D] = std::array::from_fn(|k| (high[k] - low[k]) / diameter);
        let near = |x: f64| x.abs() <= WIDEST * diameter;
        ensure!(
            extent.iter().all(|&edge| edge <= WIDEST) && low.into_iter().chain(high).all(near),
            "the scene is wider than {WIDEST:e} diameters of its largest body, or as far from the \
             origin, and soft spheres know no places so far away; remove far-away particles, move \
             the others to the origin, or take --motion drift"
        );
        let order = morton(&scene.clone().into());
        let place = |k: u32| {
            let (at, r) = (scene.centres()[k as usize], scene.radius(k as usize));
            Body::new(std::array::from_fn(|k| (at[k] - low[k]) / diameter), r / diameter)
        };
        let mut first: Vec<Body<D>> = near::room(order.len())?;
        first.extend(order.iter().map(|&k| place(k)));
        let stage = Stage::new(play, extent, &first);
        let stiffness = STIFFNESS * stage.fastest() * stage.fastest();
        first.iter_mut().for_each(|body| body.stiffness *= stiffness);
        if play == Play::Penetration {
            let ball = stage::ball(&first, &order);
            first[ball].velocity[D - 1] = -stage.speed;
        }
        let smallest = first.iter().fold(1.0f64, |least, body| least.min(body.size));
        let shortest = std::f64::consts::PI * smallest / (2.0 * stiffness).sqrt();
        let frame = speed / stage.speed;
        let steps = (frame / (shortest / STEPS_PER_COLLISION)).ceil().max(1.0);
        ensure!(
            steps <= MOST_STEPS,
            "with speed={speed} a frame of {} takes {steps:.1e} steps of time, and {MOST_STEPS:e} \
             are the most; take a smaller speed",
            play.name()
        );
        let options = Options { memory_limit: limit_for(scene.len()), threads: 1 };
        let detector = table::fast(options);
        let near = Near::new(detector, smallest);
        let fastest = FASTEST * stage.fastest();
        let (steps, time, last) = (steps as u64, frame / steps, None);
        Ok(Soft { stage, first, order, low, diameter, steps, time, fastest, near, last })
    }

    /// The centres in frame `k`.
    ///
    /// # Errors
    /// More are near each other than a list may hold.
    pub fn at(&mut self, k: u64) -> anyhow::Result<Vec<Point<f64, D>>> {
        let (mut frame, mut bodies) = match self.last.take() {
            Some(last) if last.0 <= k => last,
            _ => {
                let mut bodies = near::room(self.first.len())?;
                bodies.extend_from_slice(&self.first);
                self.near.begin(&bodies).context("frame 0")?;
                (0, bodies)
            }
        };
        while frame < k {
            for _ in 0..self.steps {
                self.step(&mut bodies).with_context(|| format!("frame {}", frame + 1))?;
            }
            frame += 1;
        }
        let mut centres = vec![Point::origin(); bodies.len()];
        for (body, &particle) in bodies.iter().zip(&self.order) {
            centres[particle as usize] =
                Point::from(std::array::from_fn(|k| self.low[k] + body.at[k] * self.diameter));
        }
        self.last = Some((frame, bodies));
        Ok(centres)
    }

    /// Velocities stand for the time between two places (leapfrog).
    fn step(&mut self, bodies: &mut [Body<D>]) -> anyhow::Result<()> {
        for body in bodies.iter_mut() {
            for k in 0..D {
                body.at[k] += body.velocity[k] * self.time;
            }
            body.force = [0.0; D];
        }
        for &Couple { pair, reach } in self.near.couples(bodies)? {
            let [i, j] = pair.map(|k| k as usize);
            if let Some(force) = body::between(&bodies[i], &bodies[j], reach) {
                for (k, force) in force.into_iter().enumerate() {
                    bodies[i].force[k] += force;
                    bodies[j].force[k] -= force;
                }
            }
        }
        for body in bodies {
            self.stage.push(body);
            let per_mass = self.time / body.mass;
            for k in 0..D {
                body.velocity[k] += body.force[k] * per_mass;
            }
            body.velocity[D - 1] -= self.stage.gravity * self.time;
            body.slow_to(self.fastest);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
