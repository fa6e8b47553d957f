//! Walls, and the speeds that there are between them.

use super::Play;
use super::body::{Body, contact, dot};

/// Gravity is the unit of acceleration.
const GRAVITY: f64 = 1.0;
/// How far the next wall is from the column, in its heights.
const RUNOUT: f64 = 3.0;
/// What the drum's wall has in place of gravity (its Froude number).
const FROUDE: f64 = 0.1;
/// The square of the ball's speed, in gravity times its diameter: 5 m/s of 20 mm are 127.
const IMPACT: f64 = 128.0;

/// Where bodies may be: the scene's low corner is the origin.
#[derive(Clone, Debug)]
pub(super) struct Stage<const D: usize> {
    low: [f64; D],
    high: [f64; D],
    drum: Option<Drum>,
    pub gravity: f64,
    /// The speed of the play.
    pub speed: f64,
    /// Of a fall from top to bottom.
    fall: f64,
}

/// A circle in the plane of the first and the last axis.
#[derive(Clone, Debug)]
struct Drum {
    middle: [f64; 2],
    radius: f64,
    /// Radians in a unit of time, from the first axis to the last.
    turn: f64,
}

impl<const D: usize> Stage<D> {
    pub fn new(play: Play, extent: [f64; D], bodies: &[Body<D>]) -> Stage<D> {
        let (low, mut high) = ([0.0; D], extent);
        let height = extent[D - 1];
        let fall = (2.0 * GRAVITY * height).sqrt();
        let gravity = GRAVITY;
        match play {
            Play::Collapse => {
                high[0] += RUNOUT * height;
                high[D - 1] = f64::INFINITY;
                Stage { low, high, drum: None, gravity, speed: fall, fall }
            }
            Play::Drum => {
                let (middle, radius) = around(bodies, [0.5 * extent[0], 0.5 * height]);
                let speed = (FROUDE * GRAVITY * radius).sqrt();
                let (mut low, mut high) = ([f64::NEG_INFINITY; D], [f64::INFINITY; D]);
                if D == 3 {
                    (low[1], high[1]) = (0.0, extent[1]);
                }
                let drum = Some(Drum { middle, radius, turn: speed / radius });
                Stage { low, high, drum, gravity, speed, fall: (4.0 * GRAVITY * radius).sqrt() }
            }
            Play::Penetration => {
                high[D - 1] = f64::INFINITY;
                let speed = (IMPACT * GRAVITY).sqrt();
                Stage { low, high, drum: None, gravity, speed, fall }
            }
        }
    }

    /// The fastest speed that is to be expected.
    pub fn fastest(&self) -> f64 {
        self.speed.max(self.fall)
    }

    /// No walls and no gravity.
    #[cfg(test)]
    pub fn open(&mut self) {
        (self.low, self.high) = ([f64::NEG_INFINITY; D], [f64::INFINITY; D]);
        (self.drum, self.gravity) = (None, 0.0);
    }

    /// The drum's middle and radius.
    #[cfg(test)]
    pub fn circle(&self) -> Option<([f64; 2], f64)> {
        self.drum.as_ref().map(|drum| (drum.middle, drum.radius))
    }

    /// Adds what walls do to a body: they are as stiff as one like it, and heavy.
    pub fn push(&self, body: &mut Body<D>) {
        for k in 0..D {
            let inside = [body.at[k] - self.low[k], self.high[k] - body.at[k]];
            for (inside, side) in inside.into_iter().zip([1.0, -1.0]) {
                if inside < body.radius {
                    let mut normal = [0.0; D];
                    normal[k] = side;
                    touch(body, &normal, body.radius - inside, &[0.0; D]);
                }
            }
        }
        let Some(Drum { middle, radius, turn }) = self.drum else { return };
        let way = [body.at[0] - middle[0], body.at[D - 1] - middle[1]];
        let (room, square) = (radius - body.radius, dot(&way, &way));
        if square > room * room {
            let distance = square.sqrt();
            let (mut normal, mut wall) = ([0.0; D], [0.0; D]);
            (normal[0], normal[D - 1]) = (-way[0] / distance, -way[1] / distance);
            (wall[0], wall[D - 1]) = (normal[D - 1] * radius * turn, -normal[0] * radius * turn);
            touch(body, &normal, distance - room, &wall);
        }
    }
}

fn touch<const D: usize>(body: &mut Body<D>, normal: &[f64; D], depth: f64, wall: &[f64; D]) {
    let velocity = std::array::from_fn(|k| body.velocity[k] - wall[k]);
    let force = contact(normal, depth, &velocity, body.stiffness, body.mass);
    body.force.iter_mut().zip(force).for_each(|(sum, force)| *sum += force);
}

/// A circle around all bodies, nearly the smallest: its middle goes to the farthest body by ever
/// smaller parts of the way (Badoiu and Clarkson 2003, doi:10.5555/644108.644240).
fn around<const D: usize>(bodies: &[Body<D>], mut middle: [f64; 2]) -> ([f64; 2], f64) {
    const ROUNDS: u32 = 256;
    let farthest = |middle: [f64; 2]| {
        bodies.iter().fold(([0.0; 2], 0.0), |most, body| {
            let way = [body.at[0] - middle[0], body.at[D - 1] - middle[1]];
            let reach = dot(&way, &way).sqrt() + body.radius;
            if reach > most.1 { (way, reach) } else { most }
        })
    };
    for round in 1..=ROUNDS {
        let (way, _) = farthest(middle);
        for k in 0..2 {
            middle[k] += way[k] / f64::from(round + 1);
        }
    }
    (middle, farthest(middle).1)
}

/// The largest body, the first particle of them; of equal ones the topmost.
pub(super) fn ball<const D: usize>(bodies: &[Body<D>], particles: &[u32]) -> usize {
    let is_of_one_size = bodies.iter().all(|body| body.radius == bodies[0].radius);
    let rank = |k: usize| if is_of_one_size { bodies[k].at[D - 1] } else { bodies[k].radius };
    let order = |a: &usize, b: &usize| {
        rank(*a).total_cmp(&rank(*b)).then(particles[*b].cmp(&particles[*a]))
    };
    (0..bodies.len()).max_by(order).unwrap_or(0)
}
