//! Data of a figure of speed against error: a panel per scene and swept parameters, and a mark per
//! detector and arithmetic. The front of a panel consists of the marks that no other mark beats in
//! both speed and errors.

use std::collections::{BTreeMap, BTreeSet};

use crate::figure::style::ranked;
use crate::figure::{About, axis};
use contactbench_record::cells::{AxisValue, Cell, errors, label, select};
use contactbench_record::experiment::{Against, SpeedError};
use contactbench_record::record::row::{Outcome, Pass};
use contactbench_terms::arithmetic::Arithmetic;

#[derive(Default)]
pub struct Mark {
    pub detector: String,
    pub arithmetic: usize,
    /// Skin of a tracker. Trackers with the same rule share a colour.
    pub skin: Option<String>,
    /// Median time per particle, in nanoseconds.
    pub time: f64,
    pub low: f64,
    pub high: f64,
    pub rate: f64,
    /// True if no other mark is both faster and more accurate.
    pub front: bool,
}

#[derive(Default)]
pub struct Panel {
    pub title: String,
    pub marks: Vec<Mark>,
    pub missing: Vec<(String, Outcome)>,
}

pub struct PanelRow {
    pub title: String,
    pub panels: Vec<Panel>,
}

pub struct Plot {
    pub rows: Vec<PanelRow>,
    /// Arithmetics, from the least to the most accurate.
    pub arithmetics: Vec<String>,
    pub detectors: Vec<String>,
}

impl Plot {
    /// Collects the data of a figure; `None` if no cell has both a time and errors.
    pub fn new(about: &About<'_>, options: &SpeedError) -> anyhow::Result<Option<Plot>> {
        let mut chosen = select::select(about.cells, &about.figure.filter);
        chosen.retain(|cell| !cell.role.is_control());
        let names: BTreeSet<&str> = chosen.iter().map(|cell| &*cell.id.arithmetic).collect();
        let known = |name: &str| Arithmetic::ALL.iter().position(|known| known.name() == name);
        let mut arithmetics: Vec<String> = names.into_iter().map(String::from).collect();
        arithmetics.sort_by_key(|name| known(name).unwrap_or(Arithmetic::ALL.len()));
        let across = across(options, &chosen);
        let plain = ["experiment", "scene", "dim", "detector", "arithmetic"];
        let mut fields = label::varying(&chosen);
        fields.retain(|name| Some(name) != across.as_ref() && !plain.contains(&name.as_str()));
        let mut rows: BTreeMap<_, BTreeMap<_, Vec<&Cell>>> = BTreeMap::new();
        for &cell in &chosen {
            let others: Vec<_> = fields.iter().map(|name| cell.id.axis(name)).collect();
            let value = across.as_ref().and_then(|name| cell.id.axis(name));
            // Columns are sorted by absolute value, so that all rows begin with 0.
            let size: Option<AxisValue> =
                value.as_ref().and_then(AxisValue::number).map(|size| size.abs().into());
            let row = rows.entry((about.place(cell), cell.id.dim, others)).or_default();
            row.entry((size, value)).or_default().push(cell);
        }
        let rows = rows.into_values().map(|columns| {
            let title = columns.values().flatten().next().map_or(String::new(), |cell| {
                let scene = format!("{}, {}D", cell.id.scene, cell.id.dim);
                match label::place(&cell.id, &fields) {
                    more if fields.is_empty() || more.is_empty() => scene,
                    more => format!("{scene}, {more}"),
                }
            });
            let name = across.as_deref().unwrap_or_default();
            let panels = columns.iter().map(|((_, value), cells)| {
                let shown =
                    |it: &AxisValue| it.number().map_or_else(|| it.to_string(), axis::plain);
                let title = value.as_ref().map(|value| format!("{name} = {}", shown(value)));
                Panel::new(title.unwrap_or_default(), cells, options.against, &arithmetics)
            });
            PanelRow { title, panels: panels.collect() }
        });
        let rows: Vec<PanelRow> = rows.collect();
        let detectors = ranked(chosen, detector);
        let plot = Plot { rows, arithmetics, detectors };
        let some = plot.marks().next().is_some();
        Ok(some.then_some(plot))
    }

    fn panels(&self) -> impl Iterator<Item = &Panel> + Clone {
        self.rows.iter().flat_map(|row| &row.panels)
    }

    pub fn marks(&self) -> impl Iterator<Item = &Mark> + Clone {
        self.panels().flat_map(|panel| &panel.marks)
    }

    pub fn skins(&self) -> bool {
        self.marks().any(|mark| mark.skin.is_some())
    }

    pub fn columns(&self) -> f64 {
        self.rows.iter().map(|row| row.panels.len()).max().unwrap_or(1).max(1) as f64
    }

    pub fn outcomes(&self) -> BTreeSet<Outcome> {
        self.panels().flat_map(|panel| &panel.missing).map(|missing| missing.1).collect()
    }
}

impl Panel {
    fn new(title: String, cells: &[&Cell], against: Against, arithmetics: &[String]) -> Panel {
        let mut panel = Panel { title, ..Panel::default() };
        for cell in cells {
            match mark(cell, against, arithmetics) {
                Some(mark) => panel.marks.push(mark),
                None => panel.missing.push((detector(cell), cell.outcome(&[Pass::Time]).0)),
            }
        }
        panel.missing.retain(|(_, outcome)| !outcome.is_good());
        find_front(&mut panel.marks);
        panel
    }
}

/// Returns the parameter that makes the columns: the requested one, or the one with the most
/// values.
fn across(options: &SpeedError, cells: &[&Cell]) -> Option<String> {
    if !options.columns.is_empty() {
        return Some(options.columns.replace('-', "_"));
    }
    let values = |name: &String| {
        cells.iter().filter_map(|cell| cell.id.axis(name)).collect::<BTreeSet<_>>().len()
    };
    label::swept(cells).into_iter().max_by_key(values)
}

/// Returns the name that decides the colour of a mark.
fn detector(cell: &Cell) -> String {
    cell.id.subject_without(&["skin"])
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

/// Marks the front. If several marks have equal errors, only the fastest is on it; if several have
/// equal times, only the most accurate.
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
    use super::{Mark, find_front};

    #[test]
    fn the_front_has_neither_slower_nor_worse() {
        // The points have equal errors or times, or are identical, dominated, or slow without errors.
        let points = [(5, 3), (4, 3), (4, 9), (2, 7), (2, 7), (3, 8), (9, 0), (12, 0)];
        let points = points.map(|(time, rate)| (f64::from(time), f64::from(rate)));
        let mut marks = points.map(|(time, rate)| Mark { time, rate, ..Mark::default() });
        find_front(&mut marks);
        let front = marks.iter().filter(|mark| mark.front).map(|mark| (mark.time, mark.rate));
        assert_eq!(front.collect::<Vec<_>>(), [(2.0, 7.0), (4.0, 3.0), (9.0, 0.0)]);
    }
}
