//! Data of a figure: panels of lines and of marks for cells without a value, from the cells of
//! an experiment.
//!
//! A panel is a scene in one dimension, with each swept parameter except x. A line is a detector,
//! with its arithmetic and threads if these vary. Several seeds make one point: their median, with
//! a bar from the smallest to the largest value. If there is one seed and y is a time, the bar is
//! the interval over blocks.

use std::collections::{BTreeMap, BTreeSet};

use crate::figure::About;
use contactbench_record::cells::{AxisValue, Cell, CellId, Expression, Reading, select};
use contactbench_record::experiment::Lines;
use contactbench_record::record::row::Outcome;
use contactbench_record::stats::interval::median;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Datum {
    pub x: f64,
    pub y: f64,
    pub low: f64,
    pub high: f64,
    /// Whether a tracker missed contacts.
    pub lossy: bool,
}

/// Key of a line, in the order of the legend.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CurveKey {
    control: bool,
    pub detector: String,
    /// Names the arithmetic if several are shown, and the threads if there is more than one.
    pub variant: String,
    /// True for more than one thread, if other lines have one.
    pub parallel: bool,
}

#[derive(Default)]
pub struct Curve {
    pub points: Vec<Datum>,
    pub marks: Vec<(f64, Outcome)>,
}

pub struct Panel {
    pub scene: String,
    pub dim: u32,
    pub lines: BTreeMap<CurveKey, Curve>,
}

pub struct Plot {
    pub panels: Vec<Panel>,
    /// True if bars show the range over seeds, false for the interval over blocks.
    pub over_seeds: bool,
}

impl Plot {
    /// Collects the data of a figure; `None` if there is nothing to show.
    pub fn new(about: &About<'_>, options: &Lines) -> anyhow::Result<Option<Plot>> {
        let chosen = select::select(about.cells, &about.figure.filter);
        let x_name = options.x.replace('-', "_");
        let x = Expression::parse(&x_name).map_err(anyhow::Error::msg)?;
        let names = Names::new(&chosen, &x_name);
        // A subject that lacks the parameter x, while others have it, is a horizontal line.
        let of_some = chosen.iter().any(|cell| cell.id.detector_params.contains_key(&x_name));
        let xs = || chosen.iter().filter(|_| of_some).filter_map(|cell| x.at(cell, None));
        let ends = match (xs().reduce(f64::min), xs().reduce(f64::max)) {
            (Some(low), Some(high)) if low < high => vec![low, high],
            _ => Vec::new(),
        };
        let mut scenes: Vec<String> = Vec::new();
        let mut panels = BTreeMap::<_, BTreeMap<CurveKey, Vec<(f64, &Cell)>>>::new();
        for &cell in &chosen {
            // A subject without a number for x (such as `skin=auto`) spans the axis.
            let at = x.at(cell, None).map_or_else(|| ends.clone(), |at| vec![at]);
            if at.is_empty() {
                continue;
            }
            let scene = names.scene(&cell.id);
            let k = scenes.iter().position(|known| *known == scene).unwrap_or(scenes.len());
            if k == scenes.len() {
                scenes.push(scene);
            }
            let lines = panels.entry((cell.id.dim, about.place(cell), k)).or_default();
            let line = lines.entry(names.line(cell)).or_default();
            line.extend(at.into_iter().map(|at| (at, cell)));
        }
        let mut over_seeds = false;
        let mut panel = |((dim, _, k), lines): ((u32, usize, usize), BTreeMap<CurveKey, _>)| {
            let line = |(key, found)| (key, Curve::new(found, &options.y, &mut over_seeds));
            let mut lines: BTreeMap<CurveKey, Curve> = lines.into_iter().map(line).collect();
            lines.retain(|_, line| !line.points.is_empty() || !line.marks.is_empty());
            Panel { scene: scenes[k].clone(), dim, lines }
        };
        let mut panels: Vec<Panel> = panels.into_iter().map(&mut panel).collect();
        panels.retain(|panel| !panel.lines.is_empty());
        Ok((!panels.is_empty()).then_some(Plot { panels, over_seeds }))
    }

    fn lines(&self) -> impl Iterator<Item = &Curve> {
        self.panels.iter().flat_map(|panel| panel.lines.values())
    }

    pub fn points(&self) -> impl Iterator<Item = &Datum> {
        self.lines().flat_map(|line| &line.points)
    }

    fn marks(&self) -> impl Iterator<Item = &(f64, Outcome)> {
        self.lines().flat_map(|line| &line.marks)
    }

    pub fn xs(&self) -> impl Iterator<Item = f64> {
        self.points().map(|point| point.x).chain(self.marks().map(|mark| mark.0))
    }

    pub fn keys(&self) -> BTreeSet<&CurveKey> {
        self.panels.iter().flat_map(|panel| panel.lines.keys()).collect()
    }

    pub fn outcomes(&self) -> BTreeSet<Outcome> {
        self.marks().map(|mark| mark.1).collect()
    }
}

struct Names<'a> {
    x: &'a str,
    arithmetic: bool,
    threads: bool,
    order: bool,
    /// Detector parameters that distinguish lines: all except x and a skin that all lists share.
    common: Vec<&'a str>,
    /// Values of each parameter, by scene and dimension.
    values: BTreeMap<(&'a str, u32, String), BTreeSet<Option<AxisValue>>>,
}

impl<'a> Names<'a> {
    fn new(chosen: &[&'a Cell], x: &'a str) -> Names<'a> {
        let several = |name: &str| {
            chosen.iter().map(|cell| cell.id.axis(name)).collect::<BTreeSet<_>>().len() > 1
        };
        let skins: BTreeSet<_> =
            chosen.iter().filter_map(|cell| cell.id.detector_params.get("skin")).collect();
        let mut values: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
        for id in chosen.iter().map(|cell| &cell.id) {
            for name in id.names() {
                let value = id.axis(&name);
                values.entry((&*id.scene, id.dim, name)).or_default().insert(value);
            }
        }
        let [arithmetic, threads, order] = ["arithmetic", "threads", "order"].map(several);
        let common = [x].into_iter().chain((skins.len() == 1).then_some("skin")).collect();
        Names { x, arithmetic, threads, order, common, values }
    }

    fn line(&self, cell: &Cell) -> CurveKey {
        let id = &cell.id;
        let parallel = self.threads && id.threads() > 1;
        let arithmetic = self.arithmetic.then(|| id.arithmetic.clone());
        let threads = parallel.then(|| format!("{} threads", id.threads()));
        CurveKey {
            control: cell.role.is_control(),
            detector: match id.axis(self.x).is_some_and(|at| at.number().is_none()) {
                true => id.subject(),
                false => id.subject_without(&self.common),
            },
            variant: Vec::from_iter(arithmetic.into_iter().chain(threads)).join(" "),
            parallel,
        }
    }

    /// Returns the scene, with each parameter except x that has several values in it.
    fn scene(&self, id: &CellId) -> String {
        let mut label = id.scene.clone();
        for (name, value) in id.parameters().into_iter().chain([("n".into(), id.n.into())]) {
            let known = self.values.get(&(&*id.scene, id.dim, name.clone()));
            if name != self.x && known.is_some_and(|values| values.len() > 1) {
                label += &format!(", {name} = {value}");
            }
        }
        if self.order { format!("{label}, {}", id.order) } else { label }
    }
}

impl Curve {
    fn new(mut found: Vec<(f64, &Cell)>, y: &Expression, over_seeds: &mut bool) -> Curve {
        let mut line = Curve::default();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            *over_seeds |= line.add(same, y);
        }
        line
    }

    /// Adds the cells at one x, and returns whether their bar shows the range over seeds. A failed
    /// seed is marked even if others have a value.
    fn add(&mut self, cells: &[(f64, &Cell)], y: &Expression) -> bool {
        let (x, mut values, mut failed) = (cells[0].0, Vec::new(), None);
        for (_, cell) in cells {
            match y.read(cell) {
                Reading::Value(value) => values.push((value, *cell)),
                Reading::Not(outcome) => failed = failed.max(Some(outcome)),
                Reading::Missing => {}
            }
        }
        self.marks.extend(failed.map(|outcome| (x, outcome)));
        let mut all: Vec<f64> = values.iter().map(|value| value.0).collect();
        let Some(middle) = median(&all) else { return false };
        if let [(_, cell)] = &values[..]
            && let Some(time) = cell.time().filter(|_| y.uses_time())
        {
            all.extend([time.low, time.high].into_iter().filter_map(|end| y.at(cell, Some(end))));
        }
        let (low, high) =
            all.iter().fold((middle, middle), |(low, high), &v| (low.min(v), high.max(v)));
        let lossy = values.iter().any(|(_, cell)| cell.misses_by_rule());
        self.points.push(Datum { x, y: middle, low, high, lossy });
        values.len() > 1
    }
}
