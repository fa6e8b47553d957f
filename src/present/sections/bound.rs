//! How near everybody comes to the bound that the memory sets.

use super::by_size::{self, per_particle};
use super::threads::percents;
use crate::cells::machine::Machine;
use crate::findings::bound::{Bound, CellBound, SceneBound};
use crate::number::{number, plural};
use crate::present::document::{Block, Text};
use crate::present::table::{Cell, Column, Table};
use crate::record::provenance::Bandwidth;

/// The section of a report.
pub fn blocks(found: &Bound) -> Vec<Block> {
    let how = Text::from(
        "No detection can take less than the bound: every coordinate is read once (8 bytes, 4 in \
         f32; radii too, unless all are the same), every pair is written once (8 bytes), at the \
         triad's bandwidth with the same number of threads. The other lines are the fraction of \
         it that is reached: bound over time. A scene that fits a cache is not bound by the \
         memory, and could pass 100%. All numbers are in ",
    );
    let how = how.link("bound.csv", "bound.csv").plain(".");
    let measured: Vec<String> =
        found.machine.bandwidths.iter().map(|rates| sentence(rates, &found.machine)).collect();
    let mut out = vec![Block::Paragraph(how), Block::paragraph(measured.join(" "))];
    out.extend(found.scenes.iter().map(|scene| Block::Table(table(scene))));
    out
}

fn sentence(found: &Bandwidth, machine: &Machine) -> String {
    let giga = |rate: f64| number(rate / 1e9);
    let cached = match machine.caches.last() {
        Some((name, bytes)) if 3 * found.array_bytes < 2 * bytes => {
            format!(", which is less than twice the {name} cache: part of it may come from there")
        }
        _ => String::new(),
    };
    format!(
        "With {}: triad {} GB/s, read {} GB/s, write {} GB/s, three arrays of {} MiB each{cached}.",
        plural(found.threads, "thread"),
        giga(found.triad),
        giga(found.read),
        giga(found.write),
        found.array_bytes >> 20,
    )
}

fn table(scene: &SceneBound) -> Table {
    let bounds = scene.bounds.iter().map(|(threads, bounds)| {
        let name = match threads {
            1 => "the bound".to_string(),
            threads => format!("the bound ({threads} threads)"),
        };
        let cell = |(&n, ns): (&u64, &Option<f64>)| match ns {
            Some(ns) => format!("{} ns / N", number(per_particle(*ns, n))).into(),
            None => Cell::absent(),
        };
        let cells = scene.fractions.sizes.iter().zip(bounds).map(cell);
        std::iter::once(name.into()).chain(cells).collect()
    });
    by_size::table(&scene.fractions, bounds.collect(), |_, fraction| percents(fraction))
}

/// `bound.csv`: a line per cell.
pub fn rows(found: &Bound) -> Table {
    let columns = [
        "experiment",
        "scene",
        "dim",
        "order",
        "n",
        "seed",
        "detector",
        "arithmetic",
        "threads",
        "bytes",
        "bound_ns",
        "time_ns_median",
        "fraction",
        "low",
        "high",
    ];
    let row = |CellBound { id, bytes, bound_ns, time_ns, fraction }: &CellBound| {
        vec![
            id.experiment.as_str().into(),
            id.scene.as_str().into(),
            Cell::count(id.dim.into()),
            id.order.as_str().into(),
            Cell::count(id.n),
            Cell::count(id.seed),
            id.contender().into(),
            id.arithmetic.as_str().into(),
            Cell::count(id.threads().into()),
            Cell::count(*bytes),
            Cell::number(*bound_ns),
            Cell::number(*time_ns),
            Cell::number(fraction.median),
            Cell::number(fraction.low),
            Cell::number(fraction.high),
        ]
    };
    Table::new("", columns.map(Column::left).into()).with(found.cells.iter().map(row))
}
