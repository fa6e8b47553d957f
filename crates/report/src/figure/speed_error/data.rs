//! What a figure of speed against error shows: a panel per scene and swept parameters, a mark per
//! detector and arithmetic.
//!
//! The front of a panel are the marks than which no other is both as fast and as right: the stairs
//! from the fastest answer to the best.

use std::collections::{BTreeMap, BTreeSet};

use contactbench_record::cells::{AxisValue, Cell, CellId, errors, label, select};
use contactbench_record::experiment::{Against, SpeedError, Where};
use contactbench_record::record::row::{Outcome, Pass};
use contactbench_terms::arithmetic::Arithmetic;

/// A detector in an arithmetic.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub detector: String,
    /// Index into [`Plot::arithmetics`].
    pub arithmetic: usize,
    /// Of a tracker, its skin: those of one rule have one colour.
    pub skin: Option<String>,
    /// Median time per particle, ns.
    pub time: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end of its interval.
    pub high: f64,
    /// Wrong pairs per true contact, in percent.
    pub rate: f64,
    /// No other mark is as fast with as few errors.
    pub front: bool,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// The value of the parameter that makes the columns.
    pub title: String,
    pub marks: Vec<Mark>,
    pub missing: Vec<(String, Outcome)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Scene, dimension and the other parameters.
    pub title: String,
    /// In the order of the columns.
    pub panels: Vec<Panel>,
}

/// All panels of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    pub rows: Vec<Row>,
    /// Those of the chosen cells, from the least to the most accurate.
    pub arithmetics: Vec<String>,
    /// In the order of the legend.
    pub detectors: Vec<String>,
}

impl Plot {
    /// Collects the figure's data from the experiment's cells, its scenes in this order; none if no
    /// cell has time and errors.
    pub fn new(
        options: &SpeedError,
        filter: &Where,
        scenes: &[&str],
        cells: &[Cell],
    ) -> anyhow::Result<Option<Plot>> {
        let mut chosen = select::select(cells, filter)?;
        chosen.retain(|cell| !cell.role.is_control());
        let names: BTreeSet<&str> = chosen.iter().map(|cell| cell.id.arithmetic.as_str()).collect();
        let rank = |name: &str| {
            Arithmetic::ALL
                .iter()
                .position(|known| known.name() == name)
                .unwrap_or(Arithmetic::ALL.len())
        };
        let mut arithmetics: Vec<String> = names.into_iter().map(String::from).collect();
        arithmetics.sort_by_key(|name| rank(name));
        let ranked: BTreeSet<(usize, String)> =
            chosen.iter().map(|cell| (crate::figure::style::rank(cell), detector(cell))).collect();
        let detectors: Vec<String> = ranked.into_iter().map(|(_, name)| name).collect();

        let across = across(options, &chosen);
        let mut fields: Vec<String> = label::varying(&chosen)
            .into_iter()
            .filter(|name| Some(name) != across.as_ref())
            .collect();
        fields.retain(|name| {
            !["experiment", "scene", "dim", "detector", "arithmetic"].contains(&name.as_str())
        });
        let title = |key: &CellId| {
            let more = if fields.is_empty() { String::new() } else { label::place(key, &fields) };
            [format!("{}, {}D", key.scene, key.dim), more]
                .into_iter()
                .filter(|part| !part.is_empty())
                .collect::<Vec<_>>()
                .join(", ")
        };
        type Row<'a> = BTreeMap<Column, Vec<&'a Cell>>;
        let mut rows: BTreeMap<(usize, u32, Vec<Option<AxisValue>>), Row> = BTreeMap::new();
        for &cell in &chosen {
            let scene =
                scenes.iter().position(|known| *known == cell.id.scene).unwrap_or(scenes.len());
            let others = fields.iter().map(|name| cell.id.axis(name)).collect();
            let column = Column::new(across.as_ref().and_then(|name| cell.id.axis(name)));
            rows.entry((scene, cell.id.dim, others))
                .or_default()
                .entry(column)
                .or_default()
                .push(cell);
        }
        let panel = |(column, cells): (&Column, &Vec<&Cell>)| {
            let name = across.as_deref().unwrap_or_default();
            let title = column
                .value
                .as_ref()
                .map_or(String::new(), |value| format!("{name} = {}", shown(value)));
            let mut panel = Panel { title, ..Panel::default() };
            for cell in cells {
                match mark(cell, options.against, &arithmetics) {
                    Some(mark) => panel.marks.push(mark),
                    None => panel.missing.push((detector(cell), cell.outcome(&[Pass::Time]).0)),
                }
            }
            panel.missing.retain(|(_, outcome)| !outcome.is_good());
            find_front(&mut panel.marks);
            panel
        };
        let row = |columns: &Row| {
            let title =
                columns.values().flatten().next().map_or(String::new(), |cell| title(&cell.id));
            self::Row { title, panels: columns.iter().map(panel).collect() }
        };
        let rows: Vec<self::Row> = rows.values().map(row).collect();
        let some = rows.iter().flat_map(|row| &row.panels).any(|panel| !panel.marks.is_empty());
        Ok(some.then_some(Plot { rows, arithmetics, detectors }))
    }

    pub fn marks(&self) -> impl Iterator<Item = &Mark> {
        self.rows.iter().flat_map(|row| &row.panels).flat_map(|panel| &panel.marks)
    }

    /// The outcomes of cells without a mark.
    pub fn outcomes(&self) -> BTreeSet<Outcome> {
        self.rows
            .iter()
            .flat_map(|row| &row.panels)
            .flat_map(|panel| panel.missing.iter().map(|missing| missing.1))
            .collect()
    }
}

/// The place of a panel in its row: numbers by size, so that all begin with none, whatever their
/// sign.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Column {
    size: Option<AxisValue>,
    value: Option<AxisValue>,
}

impl Column {
    fn new(value: Option<AxisValue>) -> Column {
        let size = value.as_ref().and_then(AxisValue::number).map(|size| size.abs().into());
        Column { size, value }
    }
}

/// The parameter that makes the columns: the one asked for, or the one with the most values.
fn across(options: &SpeedError, cells: &[&Cell]) -> Option<String> {
    if !options.columns.is_empty() {
        return Some(options.columns.replace('-', "_"));
    }
    let values = |name: &String| {
        cells.iter().filter_map(|cell| cell.id.axis(name)).collect::<BTreeSet<_>>().len()
    };
    label::swept(cells).into_iter().max_by_key(values)
}

fn shown(value: &AxisValue) -> String {
    value.number().map_or_else(|| value.to_string(), crate::figure::axis::plain)
}

/// Who is shown in one colour.
fn detector(cell: &Cell) -> String {
    cell.id.contender_without(&["skin"])
}

fn mark(cell: &Cell, against: Against, arithmetics: &[String]) -> Option<Mark> {
    let (time, n) = (cell.time()?, cell.id.n.max(1) as f64);
    let rate = match against {
        Against::Given => errors::rate(cell)?,
        Against::Stored => errors::stored_rate(cell)?,
    };
    Some(Mark {
        detector: detector(cell),
        skin: cell.id.detector_params.get("skin").map(AxisValue::to_string),
        arithmetic: arithmetics.iter().position(|name| *name == cell.id.arithmetic)?,
        time: time.median / n,
        low: time.low / n,
        high: time.high / n,
        rate: 100.0 * rate,
        front: false,
    })
}

/// Sorts by time. Of marks with the same errors only the fastest is on the front, of those with the
/// same time only the best.
fn find_front(marks: &mut [Mark]) {
    marks.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.rate.total_cmp(&b.rate)));
    let mut best = f64::INFINITY;
    for mark in marks {
        mark.front = mark.rate < best;
        best = best.min(mark.rate);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_has_neither_slower_nor_worse() {
        let mark = |(time, rate): &(f64, f64)| Mark {
            detector: "nbs".into(),
            arithmetic: 0,
            skin: None,
            time: *time,
            low: *time,
            high: *time,
            rate: *rate,
            front: false,
        };
        // equal errors, equal times, a twin, dominated ones, and the slow one without errors
        let points = [
            (5.0, 3.0),
            (4.0, 3.0),
            (4.0, 9.0),
            (2.0, 7.0),
            (2.0, 7.0),
            (3.0, 8.0),
            (9.0, 0.0),
            (12.0, 0.0),
        ];
        let mut marks: Vec<Mark> = points.iter().map(mark).collect();
        find_front(&mut marks);
        let front: Vec<(f64, f64)> =
            marks.iter().filter(|mark| mark.front).map(|mark| (mark.time, mark.rate)).collect();
        assert_eq!(front, [(2.0, 7.0), (4.0, 3.0), (9.0, 0.0)]);
    }
}
