//! Sorts particles by the cells of a grid, in rows, for locality; no result depends on the order.

use contactbench_ground::contact::Corners;
use contactbench_ground::filter::axes_by_length;
use contactbench_ground::limits::refusal::{Refusal, reserve};
use contactbench_ground::wide::fill;

/// Scratch space for the sort. Its i-th pair holds the cell of particle i, and the place of the
/// next particle that goes into cell i.
pub(super) type Room = Vec<[u32; 2]>;

pub(super) fn room(particles: usize) -> usize {
    if particles == 0 { 0 } else { particles + 1 }
}

/// Calls `put` with each particle and its place, such that the particles of a cell are adjacent.
/// There are at most as many cells as particles. Fails if memory runs out.
pub(super) fn places<const D: usize>(
    points: impl ExactSizeIterator<Item = [f64; D]>,
    (low, high): Corners<D>,
    taken: &mut Room,
    mut put: impl FnMut(u32, usize),
) -> Result<(), Refusal> {
    let n = points.len();
    // If coordinates overflow, all particles are in the first cell and keep their order.
    let extent: [f64; D] = fill(|k| high[k] - low[k]);
    let count = |edge: f64| extent.map(|extent| (extent / edge).floor() + 1.0);
    let mut edge = 2.0 * extent.iter().fold(0.0f64, |most, &extent| most.max(extent));
    while edge > f64::MIN_POSITIVE && edge < f64::INFINITY {
        if count(0.5 * edge).iter().product::<f64>() > n as f64 {
            break;
        }
        edge *= 0.5;
    }
    let counts = match edge > 0.0 && edge < f64::INFINITY {
        true => count(edge).map(|count| count as usize),
        false => [1; D],
    };
    // Cells are in layers across the longest axis, as in `streamed-nbs`: its pairs, and passes over
    // them, then stay within a few layers for a long time.
    let axes = axes_by_length(extent.map(|extent| -extent));
    taken.clear();
    reserve(taken, room(n))?;
    taken.resize(room(n), [0; 2]);
    for (i, point) in points.enumerate() {
        let cell = axes.iter().fold(0, |cell, &k| {
            let along = ((point[k] - low[k]) / edge) as usize;
            cell * counts[k] + along.min(counts[k] - 1)
        });
        taken[i][0] = cell as u32;
        taken[cell + 1][1] += 1;
    }
    for cell in 1..taken.len() {
        taken[cell][1] += taken[cell - 1][1];
    }
    for particle in 0..n {
        let [cell, _] = taken[particle];
        let [_, place] = &mut taken[cell as usize];
        put(particle as u32, *place as usize);
        *place += 1;
    }
    Ok(())
}
