//! Maps: who is the fastest over two variables of the cells, by how much, and where that is open.
//!
//! Each place of a map is a contest ([`crate::findings::winners`]) of the cells that have its two
//! values, and its answer is that contest's. Besides detectors in their plainest setting, trackers
//! over different detectors are told apart. A variable may be an axis of the cells (N, a parameter
//! of the scenes or of the detectors) or what was measured of the scene, such as its density;
//! measured numbers that are near each other share a place.
//!
//! Who has no such axis takes part at every value of it: a detector that is asked in every frame
//! beside lists with every skin, and one that cannot use threads beside those that use several.
//! What else varies within a place makes panels.

#[doc(hidden)]
pub mod testing;
mod variable;

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{bail, ensure};
use variable::{Place, Variable};

use crate::cells::{AxisValue, Cell, label, select};
use crate::experiment::{MapAxes, Where};
use crate::findings::every::Scene;
use crate::findings::noise::Noise;
use crate::findings::winners::{self, Contest};
use crate::record::id::{self, MACHINE, OVER, Projection, THREADS};
use crate::record::row::{Outcome, Pass};
use crate::stats::interval::Interval;

/// More panels than this are no answer at a glance.
pub const MOST_PANELS: usize = 12;
/// Where the factor to the next is at least so much, a winner is a step clearer.
pub const STEPS: [f64; 3] = [1.2, 1.5, 2.5];
/// What is in a panel's key whether it varies within places or not: these are never mixed.
const APART: [&str; 5] = ["experiment", "scene", "dim", "path", MACHINE];

#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    pub axes: [Axis; 2],
    /// One for each combination of what else varies.
    pub panels: Vec<Panel>,
    /// All who may be the fastest somewhere, in the order of their names.
    pub contenders: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub name: String,
    /// Its values, ascending, as they are shown; numbers before words.
    pub values: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    pub experiment: String,
    pub title: String,
    /// The places in which something was measured, by row, then column.
    pub spots: Vec<Spot>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    /// Which of the values across and upwards.
    pub at: [usize; 2],
    pub n: u64,
    pub contest: Option<Contest>,
    /// How it ended for those who have none: the first of them.
    pub outcome: Outcome,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// One is decidedly the fastest, by so many of [`STEPS`].
    Decided(usize),
    Undecided,
    /// Only one has a time.
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

    /// The time of the next over that of the fastest.
    pub fn factor(&self) -> Option<Interval> {
        self.contest.as_ref()?.others.first()?.ratio
    }

    /// Those who may be the fastest, the one with the shortest median first.
    pub fn front(&self) -> Vec<&str> {
        let Some(contest) = &self.contest else { return Vec::new() };
        let open = contest.others.iter().filter(|other| !other.slower);
        std::iter::once(&contest.first).chain(open).map(|it| it.name.as_str()).collect()
    }
}

impl Panel {
    /// Which of the values across (0) or upwards (1) have a place in it.
    pub fn values(&self, axis: usize) -> Vec<usize> {
        let used: BTreeSet<usize> = self.spots.iter().map(|spot| spot.at[axis]).collect();
        used.into_iter().collect()
    }

    pub fn at(&self, at: [usize; 2]) -> Option<&Spot> {
        self.spots.iter().find(|spot| spot.at == at)
    }
}

impl Map {
    /// From all cells of a record, of which `filter` takes some. An error, in one sentence, if a
    /// variable is none of theirs, nobody was timed, or more varies than panels can show.
    pub fn new(axes: &MapAxes, filter: &Where, cells: &[Cell]) -> anyhow::Result<Map> {
        let chosen = select::select(cells, filter)?;
        ensure!(!chosen.is_empty(), "no cell is left: none matches all that is asked for by where");
        let [x, y] = [&axes.x, &axes.y].map(|name| Variable::new(name, &chosen));
        let (x, y) = (x?, y?);
        ensure!(x.name != y.name, "both axes are {}; a map needs two", x.name);
        // Twins are no contenders, and may be left out; what they say holds all the same.
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
            "nobody has a time in these cells, and a map is one of times; run the experiment with \
             blocks"
        );
        let contenders = names.into_iter().map(String::from).collect();
        Ok(Map { axes: [x.axis(), y.axis()], panels, contenders })
    }
}

/// Who a contender is on a map: a detector, or a tracker over one; the rest are settings.
fn who(cell: &Cell, varied: &[&str]) -> String {
    let id = &cell.id;
    let settings = id.detector_params.keys().map(String::as_str).filter(|name| *name != OVER);
    let left_out: Vec<String> = settings.map(id::variable).collect();
    let left_out: Vec<&str> =
        left_out.iter().map(String::as_str).chain(varied.iter().copied()).collect();
    id.contender_without(&left_out)
}

fn spot(at: [usize; 2], cells: &[&Cell], noises: &BTreeMap<&str, Noise>, varied: &[&str]) -> Spot {
    // Of several seeds the first speaks, as where the fastest of a scene is named.
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
    let contender = ["detector", "arithmetic", THREADS];
    id.scene_id().without(&left_out.chain(contender).collect::<Vec<_>>())
}

/// The fields and parameters of scenes that differ within a place.
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

/// What varies, and how to choose.
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
        "{} x {} makes {panels} panels, and at most {MOST_PANELS} are drawn: there vary {}; \
         choose some of them by where, as in --where {example}",
        varied[0],
        varied[1],
        found.iter().map(said).collect::<Vec<_>>().join(", ")
    )
}

#[cfg(test)]
mod tests;
