//! `report.html`: the report in one file that needs no server, no network and no other file. Only
//! sorting, filtering and highlighting need JavaScript. Style and script are in
//! `crates/report/assets`. A content security policy in the page forbids every request.

use std::fmt::Write as _;

use crate::document;
use crate::facts::Facts;
use crate::figure::style::{Styles, ranked};
use crate::table::{self, Rows, Table};
use contactbench_record::cells::{Cell, errors, label};
use contactbench_record::record::column::Column;
use contactbench_record::record::row::{Outcome, Pass};
use contactbench_terms::number::short;
use contactbench_terms::text::{self, html as escape};

const TEMPLATE: &str = include_str!("../assets/report/page.html");
pub(crate) const STYLE: &str = include_str!("../assets/report/style.css");
pub(crate) const SCRIPT: &str = include_str!("../assets/report/page.js");

/// Returns the page: the report, and the table of all results.
pub fn html(facts: &Facts<'_>) -> String {
    let values = [
        ("title", escape(facts.title())),
        ("legend", legend(facts.cells, &facts.styles)),
        ("report", document::html(&facts.report())),
        ("results", results(facts.cells).html("results")),
        ("style", STYLE.into()),
        ("script", SCRIPT.into()),
    ];
    text::fill(TEMPLATE, &values)
}

/// Returns a button for each detector, with its colour in the figures.
pub(crate) fn legend(cells: &[Cell], styles: &Styles) -> String {
    let mut out = String::from("<div class=\"who\" role=\"group\" aria-label=\"Detectors\">");
    for name in ranked(cells, |cell| cell.id.subject()) {
        let (r, g, b) = styles.get(&name).colour;
        let colour = format!("#{r:02X}{g:02X}{b:02X}");
        let _ = write!(
            out,
            "<button type=\"button\" aria-pressed=\"false\" data-colour=\"{colour}\" \
             style=\"--c:{colour}\">{}</button>",
            escape(&name)
        );
    }
    out + "</div>\n"
}

/// Returns the table of all cells.
fn results(cells: &[Cell]) -> Table {
    let swept = label::swept(&cells.iter().collect::<Vec<_>>());
    let per = |cell: &Cell, name| Some(cell.variable(name, None)? / cell.id.n.max(1) as f64);
    let rows = Table::of("", cells)
        .left("scene", |it| label::title(it.id.scene_id(), &swept))
        .left("detector", |it| it.id.subject());
    measured(rows, |it| it)
        .right("contact tests / N", |it| per(it, "contact_test"))
        .right("operations / N", |it| operations(it) / it.id.n.max(1) as f64)
        .right("wrong / contact", errors::rate)
        .left("experiment", |it| &*it.id.experiment)
        .left("reason", |it| it.overall().1)
        .into()
}

/// Adds the columns that all tables of measurements share.
pub(crate) fn measured<'a, R: Copy>(rows: Rows<R>, cell: impl Fn(R) -> &'a Cell + Copy) -> Rows<R> {
    let per = move |row: R, name: &str| {
        let cell = cell(row);
        Some(cell.variable(name, None)? / cell.id.n.max(1) as f64)
    };
    // Times are known to three digits at best.
    let time = move |row: R| match cell(row).wrong_time() {
        Some(time) => table::Cell::from(short(time / cell(row).id.n.max(1) as f64)).wrong(),
        None => per(row, "time_ns").map(short).into(),
    };
    rows.right("threads", move |row| cell(row).id.threads())
        .left("arithmetic", move |row| &*cell(row).id.arithmetic)
        .left("answer", move |row| answer(cell(row)))
        .right("wrong pairs", move |row| wrong(cell(row)))
        .unit("time / N", "ns", time)
        .unit("time / pair", "ns", move |row| {
            cell(row).per_pair(cell(row).time()?.median).map(short)
        })
        .unit("memory / N", "bytes", move |row| per(row, "peak_bytes"))
}

fn answer(cell: &Cell) -> &'static str {
    match cell.overall().0 {
        Outcome::Ok | Outcome::Lossy if wrong(cell).is_some() => Outcome::Wrong.name(),
        Outcome::Ok => "right",
        outcome => outcome.name(),
    }
}

/// Returns the number of wrong pairs; `None` if there are none, or if they were not counted.
fn wrong(cell: &Cell) -> Option<u64> {
    cell.errors.map(|errors| errors.wrong()).filter(|&wrong| wrong > 0)
}

fn operations(cell: &Cell) -> f64 {
    let counted = Column::measured_by(Pass::Count);
    counted.filter_map(|column| cell.variable(&column.name, None)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_record::cells::cells;
    use contactbench_record::cells::testing::Lab;
    use contactbench_terms::moved::Moved;

    /// Times of trackers are times of a step, whatever the number of frames.
    #[test]
    fn time_per_particle_over_time_per_pair_is_pairs_per_particle() {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[5000; 6]);
        lab.scene("drum", 2).param("frames", 4).detector("verlet(nbs,rule=top-two,skin=0.1)");
        let moved = Moved { particles: 100, frames: 4, contacts: 1000, ..Moved::default() };
        lab.time(&[5000]).edit(|row| row.moved = Some(moved));
        let cells = cells(&lab.rows());
        let table: Table = measured(Table::of("", &cells), |it| it).into();
        // 100 particles with 250 contacts in a frame: 2.5 pairs per particle.
        for row in &table.rows {
            assert_eq!(row[4..6], ["50.0", "20.0"].map(table::Cell::from));
        }
        assert_eq!(table.rows.len(), 2);
    }
}
