//! Random numbers with the same bits on every machine.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, UnitDisc};

/// ChaCha8 has 2^64 independent streams per seed. Each purpose uses another stream.
const GENERATOR_STREAM: u64 = 0;
const SHUFFLE_STREAM: u64 = 1;
const SIZES_STREAM: u64 = 2;
const ORDER_OF_SIZES_STREAM: u64 = 3;
/// First stream for frames of a motion; each frame has its own.
const MOTION_STREAM: u64 = 1 << 32;

pub struct Draw {
    rng: ChaCha8Rng,
    spare: Option<f64>,
}

impl Draw {
    pub fn new(seed: u64) -> Draw {
        Draw { rng: stream(seed, GENERATOR_STREAM), spare: None }
    }

    /// Returns the source for radii that the generator does not draw itself.
    pub fn of_sizes(seed: u64) -> Draw {
        Draw { rng: stream(seed, SIZES_STREAM), spare: None }
    }

    pub fn of_motion(seed: u64, frame: u64) -> Draw {
        Draw { rng: stream(seed, MOTION_STREAM.wrapping_add(frame)), spare: None }
    }

    /// Returns a uniform number in [0, 1), a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        self.rng.random()
    }

    pub fn symmetric(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Returns a normally distributed number with mean 0 and standard deviation 1, by the polar
    /// method, which makes two at a time (Marsaglia and Bray 1964, doi:10.1137/1006063).
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let [u, v]: [f64; 2] = UnitDisc.sample(&mut self.rng);
            let s = u * u + v * v;
            if s > 0.0 {
                let factor = (-2.0 * libm::log(s) / s).sqrt();
                self.spare = Some(v * factor);
                return u * factor;
            }
        }
    }
}

/// Returns the source for the order of particles, independent of the generator's draws.
pub fn shuffler(seed: u64) -> ChaCha8Rng {
    stream(seed, SHUFFLE_STREAM)
}

/// Returns the source for the assignment of radii to particles.
pub fn sizes(seed: u64) -> ChaCha8Rng {
    stream(seed, ORDER_OF_SIZES_STREAM)
}

fn stream(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stream);
    rng
}
