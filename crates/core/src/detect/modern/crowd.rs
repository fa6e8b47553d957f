//! Do bodies crowd in few of the cells of a grid that is coarser than it need be? A sample tells.

use crate::sink::splitmix64;

/// Other bodies in the cell of a body, in the mean, from which such cells are not used: some
/// hundred candidates.
pub const CROWD: f64 = 24.0;
/// Classes of sizes, at most.
pub const CLASSES: usize = 32;
/// Bodies looked at: one in 32, but at most so many.
const SAMPLE: usize = 4096;
/// Enough for 4096 bodies.
const FEW: usize = 128;
/// So few couples of bodies in one cell may be chance.
const CHANCE: usize = 8;

/// For each class of sizes the number of other bodies in the cell of a body, in the mean: of `n`
/// bodies, whose class and cell (as a number that other cells hardly have) `place` tells, and of
/// which `bodies` are in a class. 0 where the sample has too few to know.
pub fn company(
    n: usize,
    place: impl Fn(u32) -> (usize, u64),
    bodies: impl Fn(usize) -> usize,
) -> [f64; CLASSES] {
    let mut company = [0.0; CLASSES];
    // Clearing room for many takes longer than finding the contacts of a few hundred bodies.
    let (mut few, mut many);
    let sample = match (n / 32).clamp(1, SAMPLE) {
        count @ ..=FEW => {
            few = [(0, 0); FEW];
            &mut few[..count]
        }
        count => {
            many = [(0, 0); SAMPLE];
            &mut many[..count]
        }
    };
    if n == 0 {
        return company;
    }
    for (k, place_of) in (0..).zip(&mut *sample) {
        // By chance: a sample at equal strides would miss clusters whose bodies are stored side by
        // side.
        *place_of = place((splitmix64(k) % n as u64) as u32);
    }
    sample.sort_unstable();
    for class in sample.chunk_by(|a, b| a.0 == b.0) {
        let couples: usize =
            class.chunk_by(|a, b| a == b).map(|cell| cell.len() * (cell.len() - 1)).sum();
        if couples > CHANCE {
            // Each of those looked at sees so many of the class, but for one drawn twice.
            let (asked, all) = (class.len() as f64, bodies(class[0].0) as f64);
            company[class[0].0] = couples as f64 / asked * (all / asked);
        }
    }
    company
}
