//! Maps: the fastest detector over two variables, and by how much.
//!
//! Each place of a map is a contest ([`crate::findings::winners`]) among the cells with its two
//! values. Detectors compete in their plainest setting; trackers over different detectors are
//! different subjects. A variable is an axis of the cells or a measured property of the scene, such
//! as its density; near measured values share a place.
//!
//! A subject without an axis takes part at all its values: a detector without a list beside lists
//! with every skin, or one without threads beside those with several. Other axes that vary within a
//! place make panels.

#[doc(hidden)]
pub mod testing;
mod variable;

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{bail, ensure};
use variable::{Place, Variable};

use crate::cells::{AxisValue, Cell, label, select};
use crate::experiment::{MapAxes, Where};
use crate::findings::claim::every::Scene;
use crate::findings::trust::noise::Noise;
use crate::findings::winners::{self, Contest};
use crate::record::id::{self, MACHINE, OVER, Projection, THREADS};
use crate::record::row::{Outcome, Pass};
use crate::stats::interval::Interval;

pub const MOST_PANELS: usize = 12;
/// Factors between the runner-up and the fastest at which the colour changes.
pub const STEPS: [f64; 3] = [1.2, 1.5, 2.5];
const APART: [&str; 5] = ["experiment", "scene", "dim", "path", MACHINE];

#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    pub axes: [Axis; 2],
    pub panels: Vec<Panel>,
    pub subjects: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub name: String,
    /// Values of the variable as shown, ascending; numbers before words.
    pub values: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    pub experiment: String,
    pub title: String,
    pub spots: Vec<Spot>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    pub at: [usize; 2],
    pub n: u64,
    pub contest: Option<Contest>,
    /// The outcome of the first subject, if no subject has a time.
    pub outcome: Outcome,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// A subject is decidedly the fastest; its lead exceeds this many of [`STEPS`].
    Decided(usize),
    Undecided,
    Alone,
    Nobody,
}

impl Spot {
    pub fn answer(&self) -> Answer {
        match &self.contest {
            None => Answer::Nobody,
            Some(contest) if contest.others.is_empty() => Answer::Alone,
            Some(contest) if !contest.decided() => Answer::Undecided,
            Some(_) => {
                let factor = self.factor().map_or(1.0, |factor| factor.median);
                Answer::Decided(STEPS.iter().filter(|step| factor >= **step).count())
            }
        }
    }

    pub fn factor(&self) -> Option<Interval> {
        self.contest.as_ref()?.others.first()?.ratio
    }

    pub fn front(&self) -> Vec<&str> {
        let Some(contest) = &self.contest else { return Vec::new() };
        let open = contest.others.iter().filter(|other| !other.slower);
        std::iter::once(&contest.first).chain(open).map(|it| it.name.as_str()).collect()
    }
}

impl Panel {
    pub fn values(&self, axis: usize) -> Vec<usize> {
        let used: BTreeSet<usize> = self.spots.iter().map(|spot| spot.at[axis]).collect();
        used.into_iter().collect()
    }

    pub fn at(&self, at: [usize; 2]) -> Option<&Spot> {
        self.spots.iter().find(|spot| spot.at == at)
    }
}

impl Map {
    /// Builds the map of the cells that `filter` selects. Fails if a variable is unknown, no cell
    /// has a time, or there would be more than [`MOST_PANELS`] panels.
    pub fn new(axes: &MapAxes, filter: &Where, cells: &[Cell]) -> anyhow::Result<Map> {
        let chosen = select::select(cells, filter)?;
        ensure!(!chosen.is_empty(), "no cell is left: none matches all entries of where");
        let [x, y] = [&axes.x, &axes.y].map(|name| Variable::new(name, &chosen));
        let (x, y) = (x?, y?);
        ensure!(x.name != y.name, "both axes are {}; a map needs two", x.name);
        // Twins measure the noise even if the filter leaves them out.
        let mut noises: BTreeMap<&str, Noise> = BTreeMap::new();
        for cell in &chosen {
            noises.entry(&cell.id.experiment).or_insert_with_key(|name| {
                let of = |cell: &&Cell| cell.id.experiment == **name;
                Noise::new(&cells.iter().filter(of).collect::<Vec<_>>())
            });
        }
        let varied = [&*x.name, &*y.name];
        let apart = facets(&chosen, [&x, &y]);
        let key = |cell: &Cell| panel_key(cell, &apart, &varied);
        let mut panels: BTreeMap<Projection, BTreeMap<[usize; 2], Vec<&Cell>>> = BTreeMap::new();
        let mut everywhere: Vec<&Cell> = Vec::new();
        for &cell in &chosen {
            match (x.place(cell), y.place(cell)) {
                (Place::At(x), Place::At(y)) => {
                    panels.entry(key(cell)).or_default().entry([y, x]).or_default().push(cell);
                }
                (Place::Nowhere, _) | (_, Place::Nowhere) => {}
                _ => everywhere.push(cell),
            }
        }
        for cell in everywhere {
            let fits = |place: &Place, at: usize| !matches!(place, Place::At(k) if *k != at);
            let (x, y) = (x.place(cell), y.place(cell));
            for (at, there) in panels.get_mut(&key(cell)).into_iter().flatten() {
                if fits(&x, at[1]) && fits(&y, at[0]) {
                    there.push(cell);
                }
            }
        }
        if panels.len() > MOST_PANELS {
            bail!(too_many(&chosen, &apart, &varied, panels.len()));
        }
        let several = panels.keys().map(|key| key.axis("experiment")).collect::<BTreeSet<_>>();
        let panel = |(key, spots): (Projection, BTreeMap<[usize; 2], Vec<&Cell>>)| {
            let text = key.axis("experiment").map(|value| value.to_string()).unwrap_or_default();
            let title = label::title(&key, &apart);
            Panel {
                title: if several.len() > 1 { format!("{text}: {title}") } else { title },
                spots: spots
                    .into_iter()
                    .map(|([y, x], cells)| spot([x, y], &cells, &noises, &varied))
                    .collect(),
                experiment: text,
            }
        };
        let panels: Vec<Panel> = panels.into_iter().map(panel).collect();
        let spots = panels.iter().flat_map(|panel| &panel.spots);
        let names: BTreeSet<&str> = spots.flat_map(Spot::front).collect();
        ensure!(
            !names.is_empty(),
            "no detector has a time in these cells, and a map shows times; run the experiment with \
             blocks"
        );
        let subjects = names.into_iter().map(String::from).collect();
        Ok(Map { axes: [x.axis(), y.axis()], panels, subjects })
    }
}

/// The subject of a cell: a detector, or a tracker over a detector. Other parameters are settings.
fn who(cell: &Cell, varied: &[&str]) -> String {
    let id = &cell.id;
    let settings = id.detector_params.keys().map(String::as_str).filter(|name| *name != OVER);
    let left_out: Vec<String> = settings.map(id::variable).collect();
    let left_out: Vec<&str> =
        left_out.iter().map(String::as_str).chain(varied.iter().copied()).collect();
    id.subject_without(&left_out)
}

fn spot(at: [usize; 2], cells: &[&Cell], noises: &BTreeMap<&str, Noise>, varied: &[&str]) -> Spot {
    let seed = cells.iter().map(|cell| cell.id.seed).min();
    let own = cells.iter().copied().filter(|cell| Some(cell.id.seed) == seed);
    let scene = Scene { title: String::new(), n: cells[0].id.n, cells: own.collect(), shown: true };
    let named = |cell: &Cell| who(cell, varied);
    let noise = noises.get(cells[0].id.experiment.as_str());
    let contest = noise.and_then(|noise| winners::contest(&scene, noise, named, named));
    let ended = cells.iter().map(|cell| cell.outcome(&[Pass::Time]).0);
    let outcome = ended.filter(|outcome| !outcome.is_good()).min().unwrap_or(Outcome::Ok);
    Spot { at, n: scene.n, contest, outcome }
}

fn panel_key(cell: &Cell, apart: &[String], varied: &[&str]) -> Projection {
    let id = &cell.id;
    let kept = |name: &str| apart.iter().any(|known| known == name) || APART.contains(&name);
    let names: Vec<String> = id.names().filter(|name| !kept(name)).collect();
    let left_out = names.iter().map(String::as_str).chain(varied.iter().copied());
    let subject = ["detector", "arithmetic", THREADS];
    id.scene_id().without(&left_out.chain(subject).collect::<Vec<_>>())
}

fn facets(chosen: &[&Cell], [x, y]: [&Variable; 2]) -> Vec<String> {
    let mut places: BTreeMap<_, Vec<&Cell>> = BTreeMap::new();
    for &cell in chosen {
        if let (Place::At(a), Place::At(b)) = (x.place(cell), y.place(cell)) {
            let key = panel_key(cell, &[], &[&x.name, &y.name]);
            places.entry((key, a, b)).or_default().push(cell);
        }
    }
    let mut found = BTreeSet::new();
    for cells in places.values() {
        let names = cells.iter().flat_map(|cell| cell.id.parameters()).map(|(name, _)| name);
        let names: BTreeSet<String> = names.chain(["n".into(), "order".into()]).collect();
        found.extend(names.into_iter().filter(|name| {
            let own = |cell: &&Cell| cell.id.axis(name);
            ![&x.name, &y.name].contains(&name)
                && cells.iter().any(|cell| own(cell) != own(&cells[0]))
        }));
    }
    found.into_iter().collect()
}

fn too_many(chosen: &[&Cell], apart: &[String], varied: &[&str], panels: usize) -> String {
    let values = |name: &str| -> Vec<String> {
        let values = chosen.iter().filter_map(|cell| cell.id.axis(name));
        values.collect::<BTreeSet<_>>().iter().map(AxisValue::to_string).collect()
    };
    let names = APART.iter().copied().chain(apart.iter().map(String::as_str));
    let found = names.filter(|name| !varied.contains(name)).map(|name| (name, values(name)));
    let found: Vec<_> = found.filter(|(_, values)| values.len() > 1).collect();
    let said = |(name, values): &(&str, Vec<String>)| {
        let (first, more) = values.split_at(values.len().min(4));
        let more = if more.is_empty() { "" } else { ", ..." };
        format!("{name} ({}{more})", first.join(", "))
    };
    let example = found.iter().max_by_key(|(_, values)| values.len());
    let example = example.map_or(String::new(), |(name, values)| format!("{name}={}", values[0]));
    format!(
        "{} x {} makes {panels} panels, and at most {MOST_PANELS} are drawn; they differ in {}; \
         choose some of them, as in --where {example}",
        varied[0],
        varied[1],
        found.iter().map(said).collect::<Vec<_>>().join(", ")
    )
}

#[cfg(test)]
mod tests;
