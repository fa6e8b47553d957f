//! How near a detection comes to what the memory of the machine allows.
//!
//! Whatever the algorithm, it reads every coordinate at least once (and every radius, unless all
//! are the same) and writes every pair:
//!
//! ```text
//! bytes = w N (D + [radii differ])  +  8 pairs
//! bound = bytes / triad bandwidth, measured with the same number of threads
//! fraction reached = bound / time
//! ```
//!
//! A number has w = 8 bytes, in f32 4; a pair is two u32. The triad has two reads for a write and
//! stands for both. Its arrays are larger than the last cache (or as large as [`bandwidth`]
//! allows): a scene that fits a cache can be read faster, and its fraction says what would be left
//! to gain if it came from memory.
//!
//! [`bandwidth`]: crate::run::bandwidth

use std::collections::BTreeSet;

use crate::cells::machine::{Machine, number_bytes};
use crate::cells::series::{BySize, Group, Line};
use crate::cells::{Cell, series};
use crate::record::id::CellId;
use crate::record::provenance::Bandwidth;
use crate::record::role::Role;
use crate::record::row::Pass;
use crate::stats::interval::Interval;

/// How near every contender comes to the bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// What was measured, and the last cache: where the arrays hardly exceed it, part of the
    /// bandwidth may be its own.
    pub machine: Machine,
    /// One per scene.
    pub scenes: Vec<SceneBound>,
    /// One per cell with a time.
    pub cells: Vec<CellBound>,
}

/// A scene at all its N.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneBound {
    /// Nanoseconds of the bound by number of threads, for each N of the fractions.
    pub bounds: Vec<(u32, Vec<Option<f64>>)>,
    /// The fraction of the bound that contenders reach, of the first seed.
    pub fractions: BySize<Interval>,
}

/// A cell against its bound.
#[derive(Clone, Debug, PartialEq)]
pub struct CellBound {
    /// Which cell.
    pub id: CellId,
    /// What any detection must read and write.
    pub bytes: u64,
    /// How long that takes, in nanoseconds.
    pub bound_ns: f64,
    /// The median time, in nanoseconds.
    pub time_ns: f64,
    /// The bound over the time.
    pub fraction: Interval,
}

/// Bytes that any detection of this cell's scene must read and write; none without an answer.
pub fn bytes(cell: &Cell) -> Option<u64> {
    let equal = cell.stats.radius_ratio == Some(1.0);
    let numbers = u64::from(cell.id.dim) + u64::from(!equal);
    let contacts = cell.variable("contacts", None)?;
    Some(number_bytes(&cell.id.arithmetic) * cell.id.n * numbers + 8 * contacts as u64)
}

/// The least nanoseconds of a detection with this bandwidth.
pub fn nanoseconds(cell: &Cell, bandwidth: &Bandwidth) -> Option<f64> {
    Some(1e9 * bytes(cell)? as f64 / bandwidth.triad)
}

impl Bound {
    /// Compares times with the bound; none without a measured bandwidth or without times.
    pub fn new(cells: &[&Cell], machine: &Machine) -> Option<Bound> {
        let scenes: Vec<SceneBound> = series::groups(cells)
            .iter()
            .map(|group| scene(group, machine, |line| series::label(line, cells)))
            .filter(|scene| !scene.fractions.lines.is_empty())
            .collect();
        let compared = cells.iter().filter(|cell| cell.role != Role::Nothing).filter_map(|cell| {
            Some(CellBound {
                id: cell.id.clone(),
                bytes: bytes(cell)?,
                bound_ns: nanoseconds(cell, machine.bandwidth(cell.id.threads())?)?,
                time_ns: cell.time()?.median,
                fraction: fraction(cell, machine)?,
            })
        });
        let cells = compared.collect();
        (!scenes.is_empty()).then(|| Bound { machine: machine.clone(), scenes, cells })
    }
}

fn scene(group: &Group<'_>, machine: &Machine, label: impl Fn(&Line) -> String) -> SceneBound {
    // Of several seeds the first: they differ in the places of the particles, not in their number.
    let value = |line: &Line, n| fraction(group.at(line, n)?.first()?, machine);
    let fractions = group.by_size(label, value, |fraction| Some(-fraction.median));
    let threads: BTreeSet<u32> = group.lines.keys().map(|line| line.threads).collect();
    let bound = |threads, n| nanoseconds(answered(group, threads, n)?, machine.bandwidth(threads)?);
    let bounds = threads
        .into_iter()
        .map(|threads| (threads, fractions.sizes.iter().map(|&n| bound(threads, n)).collect()))
        .collect();
    SceneBound { bounds, fractions }
}

/// A cell at this N with a right answer, for the number of pairs.
fn answered<'a>(group: &Group<'a>, threads: u32, n: u64) -> Option<&'a Cell> {
    let lines = group.lines.iter().filter(|(line, _)| line.threads == threads);
    let mut cells = lines.filter_map(|(_, sizes)| sizes.get(&n)).flatten().copied();
    cells.find(|cell| {
        cell.outcome(&[Pass::Time]).0.is_good() && cell.variable("contacts", None).is_some()
    })
}

fn fraction(cell: &Cell, machine: &Machine) -> Option<Interval> {
    let bound = nanoseconds(cell, machine.bandwidth(cell.id.threads())?)?;
    Some(cell.time()?.under(bound))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;

    #[test]
    fn the_bound_is_bytes_over_bandwidth() {
        let mut lab = Lab::new("e", "packed");
        // 100 discs: 1600 bytes of coordinates, 250 pairs: 2000 bytes; in f32 half the coordinates;
        // mixed radii 800 bytes more
        lab.time(&[7200; 15]);
        lab.arithmetic("f32").time(&[5600; 15]);
        // with two threads the median is half the bound, the interval is not
        let times: Vec<u64> = (0..15).map(|k| if k < 7 { 1800 } else { 3600 }).collect();
        lab.arithmetic("exact").detector("direct").threads(2).time(&times);
        let mut rows = lab.rows();
        rows.iter_mut().for_each(|row| row.stats.radius_ratio = Some(1.0));
        let cells = cells::cells(&rows);
        let all: Vec<&Cell> = cells.iter().collect();
        let bandwidth = |threads: usize, triad: f64| Bandwidth {
            threads,
            array_bytes: 1 << 28,
            read: 1.0,
            write: 1.0,
            triad,
        };
        let machine = Machine {
            caches: vec![("L3".into(), 1 << 20)],
            bandwidths: vec![bandwidth(1, 1e9), bandwidth(2, 2e9)],
        };
        let found = Bound::new(&all, &machine).unwrap();
        let [scene] = &*found.scenes else { panic!("{found:?}") };
        assert_eq!(scene.bounds, [(1, vec![Some(3600.0)]), (2, vec![Some(1800.0)])]);
        let names: Vec<&str> = scene.fractions.lines.iter().map(|line| &*line.name).collect();
        assert_eq!(names.len(), 3);
        for line in &scene.fractions.lines {
            let found = line.values[0].unwrap();
            let high = if line.name == "direct (exact) (2 threads)" { 1.0 } else { 0.5 };
            assert_eq!((found.low, found.median, found.high), (0.5, 0.5, high), "{}", line.name);
        }
        assert_eq!(found.cells.len(), 3);
        let two = found.cells.iter().find(|cell| cell.id.threads() == 2).unwrap();
        assert_eq!((two.bytes, two.bound_ns, two.time_ns), (3600, 1800.0, 3600.0));
        let mut mixed = cells[0].clone();
        mixed.stats.radius_ratio = Some(3.0);
        assert_eq!((bytes(&cells[0]), bytes(&mixed)), (Some(3600), Some(4400)));
        assert!(Bound::new(&all, &Machine::default()).is_none());
    }
}
