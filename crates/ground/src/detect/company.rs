//! Estimates from a sample whether particles crowd in few cells of a grid that is coarser than
//! necessary.

use contactbench_terms::mix::splitmix64;

/// Mean number of other particles in a particle's cell above which the cells are too wide: a
/// particle then has a few hundred candidates.
pub const CROWD: f64 = 24.0;
/// Largest number of size classes.
pub const CLASSES: usize = 32;
/// Maximum number of particles in a sample; it has one particle in 32.
const SAMPLE: usize = 4096;
/// Maximum number of particles in the sample of a scene of up to 4096 particles.
const FEW: usize = 128;
/// In the sample of a class, up to this many ordered pairs in the same cell may be chance.
const CHANCE: usize = 8;

/// Estimates, for each size class, the mean number of other particles in a particle's cell. `place`
/// returns a particle's class and a number for its cell that few other cells share; `particles`
/// returns the size of a class. The estimate is 0 if the sample has too few pairs in the same cell.
pub fn company(
    n: usize,
    place: impl Fn(u32) -> (usize, u64),
    particles: impl Fn(usize) -> usize,
) -> [f64; CLASSES] {
    let mut company = [0.0; CLASSES];
    let count = (n / 32).min(SAMPLE);
    if count * count.saturating_sub(1) <= CHANCE {
        return company;
    }
    let estimate = &mut |sample: &mut [(usize, u64)]| {
        for (k, place_of) in (0..).zip(&mut *sample) {
            // Drawn at random, because equal strides could miss clusters that are stored together.
            *place_of = place((splitmix64(k) % n as u64) as u32);
        }
        sample.sort_unstable();
        for class in sample.chunk_by(|a, b| a.0 == b.0) {
            let pairs: usize =
                class.chunk_by(|a, b| a == b).map(|cell| cell.len() * (cell.len() - 1)).sum();
            if pairs > CHANCE {
                // Scale the pairs in the sample to the whole class.
                let (asked, all) = (class.len() as f64, particles(class[0].0) as f64);
                company[class[0].0] = pairs as f64 / asked * (all / asked);
            }
        }
    };
    if count <= FEW {
        in_room::<FEW>(count, estimate)
    } else {
        in_room::<SAMPLE>(count, estimate)
    }
    company
}

/// Calls `then` with an array on the stack. As a separate function, because the stack of a large
/// array takes longer to prepare than a few hundred particles to detect.
#[inline(never)]
fn in_room<const ROOM: usize>(count: usize, mut then: impl FnMut(&mut [(usize, u64)])) {
    then(&mut [(0, 0); ROOM][..count]);
}
