//! Bodies, and the force where two of them overlap.

/// Smaller bodies are as heavy and as stiff as those of this size, in diameters of the largest, or
/// steps of time would be as small as they are.
pub(super) const SMALLEST: f64 = 1.0 / 16.0;
/// Of an overlap no more counts, in sizes of the smaller body.
const DEEPEST: f64 = 0.1;
/// Of critical damping; bodies that meet head-on leave with exp(-π ζ / √(1 - ζ²)) = 0.70 of the
/// speed.
const DAMPING: f64 = 0.1128;
/// Coefficient of friction.
const FRICTION: f64 = 0.5;

/// A disc or a sphere.
#[derive(Clone, Debug)]
pub(super) struct Body<const D: usize> {
    pub at: [f64; D],
    pub radius: f64,
    pub velocity: [f64; D],
    pub force: [f64; D],
    /// Its diameter, for all but contacts.
    pub size: f64,
    pub mass: f64,
    /// Of the spring between it and one like it: in 2D the same for all, in 3D as its size, so that
    /// overlaps in diameters do not depend on sizes.
    pub stiffness: f64,
}

impl<const D: usize> Body<D> {
    /// At rest, with a stiffness in those of the largest.
    pub fn new(at: [f64; D], radius: f64) -> Body<D> {
        let size = (2.0 * radius).max(SMALLEST);
        let (mass, stiffness) =
            if D == 2 { (size * size, 1.0) } else { (size * size * size, size) };
        Body { at, radius, velocity: [0.0; D], force: [0.0; D], size, mass, stiffness }
    }

    /// Makes it no faster than `most`.
    pub fn slow_to(&mut self, most: f64) {
        let square = dot(&self.velocity, &self.velocity);
        if square > most * most {
            let part = most / square.sqrt();
            self.velocity = self.velocity.map(|v| v * part);
        }
    }
}

/// What the second does to the first, if they are nearer than their reach.
#[inline]
pub(super) fn between<const D: usize>(a: &Body<D>, b: &Body<D>, reach: f64) -> Option<[f64; D]> {
    let way: [f64; D] = std::array::from_fn(|k| a.at[k] - b.at[k]);
    let square = dot(&way, &way);
    if square >= reach * reach {
        return None;
    }
    let distance = square.sqrt();
    let normal = match distance > 0.0 {
        true => way.map(|x| x / distance),
        // Two in one place part along x.
        false => std::array::from_fn(|k| if k == 0 { -1.0 } else { 0.0 }),
    };
    let depth = (reach - distance).min(DEEPEST * a.size.min(b.size));
    let velocity = std::array::from_fn(|k| a.velocity[k] - b.velocity[k]);
    // Two springs in a row, each twice as stiff as the two together.
    let stiffness = 2.0 * a.stiffness * b.stiffness / (a.stiffness + b.stiffness);
    let mass = a.mass * b.mass / (a.mass + b.mass);
    Some(contact(&normal, depth, &velocity, stiffness, mass))
}

/// The force of a contact on a body, to which its normal points. Its velocity is that against the
/// other side, and the mass is that of the couple.
pub(super) fn contact<const D: usize>(
    normal: &[f64; D],
    depth: f64,
    velocity: &[f64; D],
    stiffness: f64,
    mass: f64,
) -> [f64; D] {
    let dashpot = 2.0 * DAMPING * (stiffness * mass).sqrt();
    let parting = dot(normal, velocity);
    let push = stiffness * depth - dashpot * parting;
    let mut slip = [0.0; D];
    for k in 0..D {
        slip[k] = velocity[k] - parting * normal[k];
    }
    let (most, speed) = (FRICTION * push.max(0.0), dot(&slip, &slip).sqrt());
    let drag = if dashpot * speed > most { most / speed } else { dashpot };
    let mut force = [0.0; D];
    for k in 0..D {
        force[k] = push * normal[k] - drag * slip[k];
    }
    force
}

pub(super) fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for k in 0..D {
        sum += a[k] * b[k];
    }
    sum
}
