//! What a figure shows: panels of lines and of marks for cells without a value, from the cells of
//! an experiment.
//!
//! A panel is a scene (with those parameters, besides x, that are swept) in one dimension. A line
//! is a detector (with its arithmetic and threads, where there are several). Several seeds are one
//! point: their median, with a bar from the smallest to the largest; one seed has the interval over
//! blocks, if y is a time.

use std::collections::{BTreeMap, BTreeSet};

use contactbench_record::cells::{Cell, CellId, Expression, Reading, select};
use contactbench_record::experiment::{Lines, Where};
use contactbench_record::record::row::Outcome;
use contactbench_record::stats::interval::median;

/// A point of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Datum {
    /// Place on the x axis.
    pub x: f64,
    pub y: f64,
    /// Lower end of the bar.
    pub low: f64,
    /// Upper end of the bar.
    pub high: f64,
}

/// Which line: detector, and what tells it from others of the same detector.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CurveKey {
    /// The place in the legend.
    pub rank: usize,
    pub detector: String,
    /// Arithmetic, where there are several, and threads, where they are not one.
    pub variant: String,
    /// More than one thread, where others have one.
    pub parallel: bool,
}

/// A line: its points, and the x of cells without a value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    pub points: Vec<Datum>,
    pub marks: Vec<(f64, Outcome)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The column's heading: scene and parameters.
    pub scene: String,
    /// 2 or 3.
    pub dim: u32,
    pub lines: BTreeMap<CurveKey, Curve>,
}

/// All panels of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    pub panels: Vec<Panel>,
    /// True if points have bars for seeds, false for blocks.
    pub over_seeds: bool,
}

impl Plot {
    /// Collects the figure's data from the experiment's cells, its scenes in this order; none if
    /// there is nothing to show.
    pub fn new(
        options: &Lines,
        filter: &Where,
        scenes: &[&str],
        cells: &[Cell],
    ) -> anyhow::Result<Option<Plot>> {
        let chosen = select::select(cells, filter)?;
        let x_name = options.x.replace('-', "_");
        let (x, y) = (Expression::parse(&x_name)?, &options.y);
        x.check(cells)?;
        y.check(cells)?;
        let several = |name: &str| {
            chosen.iter().map(|cell| cell.id.axis(name)).collect::<BTreeSet<_>>().len() > 1
        };
        let (arithmetic, threads, order) =
            (several("arithmetic"), several("threads"), several("order"));
        // What lies along x makes no line, nor a skin that all lists have.
        let mut common = vec![x_name.as_str()];
        let skins: BTreeSet<_> =
            chosen.iter().filter_map(|cell| cell.id.detector_params.get("skin")).collect();
        common.extend((skins.len() == 1).then_some("skin"));
        let line_of = |cell: &Cell| {
            let key = &cell.id;
            let mut variant = if arithmetic { key.arithmetic.clone() } else { String::new() };
            if threads && key.threads() > 1 {
                variant += &format!(" {} threads", key.threads());
            }
            CurveKey {
                rank: crate::figure::style::rank(cell),
                detector: match key.axis(&x_name).is_some_and(|at| at.number().is_none()) {
                    true => key.contender(),
                    false => key.contender_without(&common),
                },
                variant: variant.trim().into(),
                parallel: threads && key.threads() > 1,
            }
        };
        // every parameter, besides x, that takes more than one value in a scene and dimension
        // becomes part of the panel
        let mut values: BTreeMap<(&str, u32, String), BTreeSet<_>> = BTreeMap::new();
        for cell in &chosen {
            for name in cell.id.names() {
                let value = cell.id.axis(&name);
                values.entry((&cell.id.scene, cell.id.dim, name)).or_default().insert(value);
            }
        }
        let scene_of = |key: &CellId| {
            let mut label = key.scene.clone();
            let params = key.parameters().into_iter().chain([("n".to_string(), key.n.into())]);
            for (name, value) in params.filter(|(name, _)| *name != x_name) {
                let known = values.get(&(key.scene.as_str(), key.dim, name.clone()));
                if known.is_some_and(|values| values.len() > 1) {
                    label += &format!(", {name} = {value}");
                }
            }
            if order {
                label += &format!(", {}", key.order);
            }
            label
        };
        // Who has no such parameter, where others have it, is the same along all of it.
        let of_some = chosen.iter().any(|cell| cell.id.detector_params.contains_key(&x_name));
        let xs = || chosen.iter().filter(|_| of_some).filter_map(|cell| x.at(cell, None));
        let ends = match (xs().reduce(f64::min), xs().reduce(f64::max)) {
            (Some(low), Some(high)) if low < high => vec![low, high],
            _ => Vec::new(),
        };
        type Gathered<'a> =
            BTreeMap<(u32, usize, usize, String), BTreeMap<CurveKey, Vec<(f64, &'a Cell)>>>;
        let (mut gathered, mut places): (Gathered, Vec<String>) = (BTreeMap::new(), Vec::new());
        let places_of = |cell: &Cell| match x.at(cell, None) {
            Some(at) => vec![at],
            // Without a number on this axis (a skin of auto, or none at all).
            None => ends.clone(),
        };
        for cell in &chosen {
            let at = places_of(cell);
            if at.is_empty() {
                continue;
            }
            let scene = scene_of(&cell.id);
            let place = places.iter().position(|known| *known == scene).unwrap_or_else(|| {
                places.push(scene.clone());
                places.len() - 1
            });
            let first =
                scenes.iter().position(|known| *known == cell.id.scene).unwrap_or(scenes.len());
            let lines = gathered.entry((cell.id.dim, first, place, scene)).or_default();
            let line: &mut Vec<_> = lines.entry(line_of(cell)).or_default();
            line.extend(at.into_iter().map(|at| (at, *cell)));
        }
        let mut over_seeds = false;
        let mut panels = Vec::new();
        for ((dim, _, _, scene), lines) in gathered {
            let mut panel = Panel { scene, dim, lines: BTreeMap::new() };
            for (key, mut found) in lines {
                found.sort_by(|a, b| a.0.total_cmp(&b.0));
                let mut line = Curve::default();
                for same in found.chunk_by(|a, b| a.0 == b.0) {
                    let cells: Vec<&Cell> = same.iter().map(|(_, cell)| *cell).collect();
                    over_seeds |= line.add(same[0].0, &cells, y);
                }
                if !line.points.is_empty() || !line.marks.is_empty() {
                    panel.lines.insert(key, line);
                }
            }
            panels.push(panel);
        }
        panels.retain(|panel| !panel.lines.is_empty());
        Ok((!panels.is_empty()).then_some(Plot { panels, over_seeds }))
    }

    pub fn points(&self) -> impl Iterator<Item = &Datum> {
        self.panels.iter().flat_map(|panel| panel.lines.values()).flat_map(|line| &line.points)
    }

    /// All places on the x axis, of marks too.
    pub fn xs(&self) -> impl Iterator<Item = f64> {
        let marks = self
            .panels
            .iter()
            .flat_map(|panel| panel.lines.values())
            .flat_map(|line| line.marks.iter().map(|mark| mark.0));
        self.points().map(|point| point.x).chain(marks)
    }

    /// The lines of all panels, in the order of the legend.
    pub fn keys(&self) -> BTreeSet<&CurveKey> {
        self.panels.iter().flat_map(|panel| panel.lines.keys()).collect()
    }

    /// The outcomes that are marked.
    pub fn outcomes(&self) -> BTreeSet<Outcome> {
        self.panels
            .iter()
            .flat_map(|panel| panel.lines.values())
            .flat_map(|line| line.marks.iter().map(|mark| mark.1))
            .collect()
    }
}

impl Curve {
    /// Adds the cells at one x; true if their bar is over seeds. A failed seed is marked even if
    /// others have a value.
    fn add(&mut self, x: f64, cells: &[&Cell], y: &Expression) -> bool {
        let mut values = Vec::new();
        let mut failed: Option<Outcome> = None;
        for cell in cells {
            match y.read(cell) {
                Reading::Value(value) => values.push((value, *cell)),
                Reading::Not(outcome) => failed = failed.max(Some(outcome)),
                Reading::Missing => {}
            }
        }
        self.marks.extend(failed.map(|outcome| (x, outcome)));
        let all: Vec<f64> = values.iter().map(|value| value.0).collect();
        let Some(middle) = median(&all) else { return false };
        let (mut low, mut high) =
            all.iter().fold((middle, middle), |(low, high), &v| (low.min(v), high.max(v)));
        let single = match values.as_slice() {
            [(_, cell)] => cell.time().filter(|_| y.uses_time()),
            _ => None,
        };
        if let (Some(time), [(_, cell)]) = (single, values.as_slice()) {
            for end in [time.low, time.high].into_iter().filter_map(|time| y.at(cell, Some(time))) {
                (low, high) = (low.min(end), high.max(end));
            }
        }
        self.points.push(Datum { x, y: middle, low, high });
        values.len() > 1
    }
}
