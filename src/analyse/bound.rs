//! How near a detection comes to what the memory of the machine allows.
//!
//! Whatever the algorithm, it reads every coordinate at least once (and every radius, unless all are the same) and writes every pair:
//!
//! ```text
//! bytes = w N (D + [radii differ])  +  8 pairs            w = 8 bytes per number, 4 in f32; a pair is two u32
//! bound = bytes / triad bandwidth, measured with the same number of threads
//! fraction reached = bound / time
//! ```
//!
//! The triad has two reads for a write and stands for both. Its arrays are larger than the last cache (or as large as [`bandwidth`] allows):
//! a scene that fits a cache can be read faster, and its fraction says what would be left to gain if it came from memory.
//!
//! [`bandwidth`]: crate::harness::bandwidth

use std::fmt::Write as _;

use super::grid::{self, Group, Line};
use super::machine::{Machine, number_bytes};
use super::summary::Table;
use super::text;
use super::threads::percents;
use super::value::Cell;
use crate::harness::bandwidth::Bandwidth;
use crate::harness::record::Pass;

/// The columns of `bound.csv`.
const HEAD: &str = "experiment,scene,dim,order,n,seed,detector,arithmetic,threads,bytes,bound_ns,time_ns_median,fraction,low,high\n";

/// How near everybody comes.
pub struct Bound {
    /// The bandwidths, and what the arrays were, in a sentence.
    pub measured: String,
    /// A table per scene.
    pub tables: Vec<Table>,
    /// As CSV, without a head.
    pub lines: String,
}

/// `bound.csv` of these lines.
pub fn csv(lines: &str) -> String {
    HEAD.to_string() + lines
}

/// Bytes that any detection of this cell's scene must read and write; none without an answer.
pub fn bytes(cell: &Cell) -> Option<u64> {
    let equal = cell.stats.radius_ratio == Some(1.0);
    let numbers = u64::from(cell.key.dim) + u64::from(!equal);
    Some(number_bytes(&cell.key.arithmetic) * cell.key.n * numbers + 8 * cell.contacts?)
}

/// The least nanoseconds of a detection with this bandwidth.
pub fn nanoseconds(cell: &Cell, bandwidth: &Bandwidth) -> Option<f64> {
    Some(1e9 * bytes(cell)? as f64 / bandwidth.triad)
}

/// Compares times with the bound; none without a measured bandwidth or without times.
pub fn of(cells: &[&Cell], machine: &Machine) -> Option<Bound> {
    let mut tables = Vec::new();
    for group in grid::groups(cells) {
        let bounds = |threads: u32| -> Vec<String> {
            let bound = |n: u64| {
                let cell = answered(&group, threads, n)?;
                Some(text::number(nanoseconds(cell, machine.bandwidth(threads)?)? / n.max(1) as f64) + " ns / N")
            };
            let name = if threads == 1 { "the bound".into() } else { format!("the bound ({threads} threads)") };
            std::iter::once(name).chain(group.sizes().into_iter().map(|n| bound(n).unwrap_or("–".into()))).collect()
        };
        let mut threads: Vec<u32> = group.lines.keys().map(|line| line.threads).collect();
        threads.sort_unstable();
        threads.dedup();
        let first: Vec<Vec<String>> = threads.into_iter().map(bounds).collect();
        tables.extend(group.table(&first, |line| grid::label(line, cells), |line, n| entry(&group, line, n, machine)));
    }
    if tables.is_empty() {
        return None;
    }
    Some(Bound { measured: measured(machine), tables, lines: csv_lines(cells, machine) })
}

/// A cell at this N with a right answer, for the number of pairs.
fn answered<'a>(group: &Group<'a>, threads: u32, n: u64) -> Option<&'a Cell> {
    let lines = group.lines.iter().filter(|(line, _)| line.threads == threads);
    let mut cells = lines.filter_map(|(_, sizes)| sizes.get(&n)).flatten().copied();
    cells.find(|cell| cell.outcome(&[Pass::Time]).0.is_good() && cell.contacts.is_some())
}

fn entry(group: &Group<'_>, line: &Line, n: u64, machine: &Machine) -> Option<(String, Option<f64>)> {
    // Of several seeds the first: they differ in the places of the bodies, not in their number.
    let cell = group.at(line, n)?.first()?;
    let (time, bound) = (cell.time()?, nanoseconds(cell, machine.bandwidth(line.threads)?)?);
    let fraction = super::interval::Interval { median: bound / time.median, low: bound / time.high, high: bound / time.low, ..time };
    Some((percents(&fraction), Some(-fraction.median)))
}

fn measured(machine: &Machine) -> String {
    let mut out = String::new();
    for found in &machine.bandwidths {
        let giga = |rate: f64| text::number(rate / 1e9);
        let _ = write!(
            out,
            "With {}: triad {} GB/s, read {} GB/s, write {} GB/s, three arrays of {} MiB each{}. ",
            text::plural(found.threads, "thread"),
            giga(found.triad),
            giga(found.read),
            giga(found.write),
            found.array_bytes >> 20,
            match machine.caches.last() {
                Some((name, bytes)) if 3 * found.array_bytes < 2 * bytes =>
                    format!(", which is less than twice the {name} cache: part of it may come from there"),
                _ => String::new(),
            }
        );
    }
    out.trim_end().into()
}

fn csv_lines(cells: &[&Cell], machine: &Machine) -> String {
    let mut out = String::new();
    for cell in cells.iter().filter(|cell| !grid::is_nothing(&cell.key.detector)) {
        let key = &cell.key;
        let bound = machine.bandwidth(key.threads).and_then(|bandwidth| nanoseconds(cell, bandwidth));
        let (Some(time), Some(bound), Some(bytes)) = (cell.time(), bound, bytes(cell)) else { continue };
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{bytes},{bound:.1},{},{:.4},{:.4},{:.4}",
            text::quote(&key.experiment),
            text::quote(&key.scene),
            key.dim,
            key.order,
            key.n,
            key.seed,
            text::quote(&key.detector),
            key.arithmetic,
            key.threads,
            time.median,
            bound / time.median,
            bound / time.high,
            bound / time.low
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::{fake::Lab, value};
    use super::*;

    #[test]
    fn the_bound_is_bytes_over_bandwidth() {
        let mut lab = Lab::new("e", "packed");
        // 100 discs: 1600 bytes of coordinates, 250 pairs: 2000 bytes; in f32 half the coordinates; mixed radii 800 bytes more
        lab.time(&[7200; 15]).edit(|_| ());
        lab.arithmetic("f32").time(&[5600; 15]);
        lab.arithmetic("exact").detector("direct").threads(2).time(&[3600; 15]);
        let mut rows = lab.rows();
        rows.iter_mut().for_each(|row| row.stats.radius_ratio = Some(1.0));
        let cells = value::cells(&rows);
        let all: Vec<&Cell> = cells.iter().collect();
        let bandwidth = |threads: usize, triad: f64| Bandwidth { threads, array_bytes: 1 << 28, read: 1.0, write: 1.0, triad };
        let machine = Machine { caches: vec![("L3".into(), 1 << 20)], bandwidths: vec![bandwidth(1, 1e9), bandwidth(2, 2e9)] };
        let found = of(&all, &machine).unwrap();
        let table = &found.tables[0].markdown;
        // bound 3600 ns of 7200; 2800 of 5600; with two threads 1800 of 3600
        assert!(table.contains("| the bound | 36 ns / N |") && table.contains("| the bound (2 threads) | 18 ns / N |"), "{table}");
        for line in ["nbs (exact)", "nbs (f32)", "direct (exact) (2 threads)"] {
            assert!(table.contains(&format!("| {line} | 50% (50% to 50%) |")), "{table}");
        }
        assert!(found.measured.contains("triad 1 GB/s") && !found.measured.contains("less than"), "{}", found.measured);
        assert_eq!(found.lines.lines().count(), 3);
        let mut mixed = cells[0].clone();
        mixed.stats.radius_ratio = Some(3.0);
        assert_eq!((bytes(&cells[0]), bytes(&mixed)), (Some(3600), Some(4400)));
        assert!(of(&all, &Machine::default()).is_none());
    }
}
