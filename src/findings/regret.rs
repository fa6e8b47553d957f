//! Regret: what it costs to follow printed advice, in times of the best.
//!
//! Advice is data, in `advice.toml`: rules over the variables of cells, which name a detector. In
//! each scene, at each N, its time is held to that of the fastest there; who that is, and what
//! is noise, is the answer of a contest ([`crate::findings::winners`]). Each detector takes part in
//! its plainest setting, with the parameters that are the fastest. The fastest is chosen from the
//! times that then measure the regret, which makes that a little larger than it is.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use crate::cells::label::{swept, title};
use crate::cells::{Cell, select};
use crate::experiment::Where;
use crate::findings::every::Scene;
use crate::findings::noise::Noise;
use crate::findings::winners;
use crate::record::row::{Outcome, Pass};
use crate::stats::interval::Interval;

/// All advice of `advice.toml`.
pub static ADVICE: LazyLock<Vec<Advice>> = LazyLock::new(|| {
    let file: File = toml::from_str(include_str!("advice.toml")).unwrap_or_default();
    file.advice
});

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    advice: Vec<Advice>,
}

/// Which detector somebody recommends for which scene.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Advice {
    /// What it says.
    pub name: String,
    /// Where it says so.
    pub source: String,
    /// What is ours about it; may be empty.
    #[serde(default)]
    pub note: String,
    /// The first that holds names the detector.
    rule: Vec<Rule>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Rule {
    /// In which scenes; in all without.
    #[serde(default)]
    when: Where,
    /// The detector.
    r#use: String,
    /// Not where it was refused for want of memory.
    #[serde(default)]
    where_it_fits: bool,
}

/// What following a piece of advice costs.
#[derive(Clone, Debug)]
pub struct Followed {
    /// The advice.
    pub advice: Advice,
    /// Each scene in which its detector was measured, least regret first.
    pub places: Vec<Place>,
}

/// A scene at one N.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The experiment.
    pub experiment: String,
    /// `loose, 3D, N = 1000, fraction = 0.1`.
    pub title: String,
    /// Particles.
    pub n: u64,
    /// The detector that is advised.
    pub advised: String,
    /// The fastest.
    pub fastest: String,
    /// What the advice costs.
    pub regret: Regret,
}

/// The time of the advised over that of the fastest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regret {
    /// It is the fastest.
    None,
    /// So many times as long; is it slower by more than the noise?
    Times(Interval, bool),
    /// It has no time, and this is why.
    Endless(Outcome),
}

impl Regret {
    /// The ratio; infinite without an answer.
    pub fn times(&self) -> f64 {
        match self {
            Regret::None => 1.0,
            Regret::Times(ratio, _) => ratio.median,
            Regret::Endless(_) => f64::INFINITY,
        }
    }
}

/// The regret of all advice whose detectors were measured somewhere in these cells of one
/// experiment. Scenes that move, and those in which fewer than two have a time, are left out.
pub fn followed(cells: &[&Cell]) -> Vec<Followed> {
    let noise = Noise::new(cells);
    let swept = swept(cells);
    let mut scenes: BTreeMap<_, Vec<&Cell>> = BTreeMap::new();
    for &cell in cells.iter().filter(|cell| !cell.values.contains_key("mean_way")) {
        scenes.entry(cell.id.scene_id().without(&["seed"])).or_default().push(cell);
    }
    let mut found: Vec<Followed> = ADVICE
        .iter()
        .map(|advice| Followed { advice: advice.clone(), places: Vec::new() })
        .collect();
    for (id, mut all) in scenes {
        // The first seed speaks, as where the fastest of a scene is named.
        let seed = all.iter().map(|cell| cell.id.seed).min();
        all.retain(|cell| Some(cell.id.seed) == seed);
        let scene = Scene { title: title(&id, &swept), n: all[0].id.n, cells: all, shown: true };
        let name = |cell: &Cell| cell.id.detector.clone();
        let Some(contest) = winners::contest(&scene, &noise, name, name) else { continue };
        if contest.others.is_empty() {
            continue;
        }
        for one in &mut found {
            let Some(advised) = one.advice.detector(&scene.cells) else { continue };
            let other = contest.others.iter().find(|other| other.name == advised);
            let regret = match other {
                _ if contest.first.name == advised => Regret::None,
                Some(other) => match other.ratio {
                    Some(ratio) => Regret::Times(ratio, other.slower),
                    None => continue,
                },
                None => match ended(&scene.cells, advised) {
                    Some(outcome) if !outcome.is_good() => Regret::Endless(outcome),
                    _ => continue,
                },
            };
            one.places.push(Place {
                experiment: scene.cells[0].id.experiment.clone(),
                title: scene.title.clone(),
                n: scene.n,
                advised: advised.into(),
                fastest: contest.first.name.clone(),
                regret,
            });
        }
    }
    found.retain(|one| !one.places.is_empty());
    for one in &mut found {
        one.places.sort_by(|a, b| a.regret.times().total_cmp(&b.regret.times()));
    }
    found
}

/// How a detector's times ended in a scene: in its best setting.
fn ended(cells: &[&Cell], detector: &str) -> Option<Outcome> {
    let own = cells.iter().filter(|cell| cell.id.detector == detector);
    own.map(|cell| cell.outcome(&[Pass::Time]).0)
        .min_by_key(|outcome| (!outcome.is_good(), *outcome))
}

impl Advice {
    /// The detector that it names for a scene.
    fn detector(&self, cells: &[&Cell]) -> Option<&str> {
        let scene = cells.first()?;
        let fits = |rule: &&Rule| {
            let want = [Some(Outcome::Refused), Some(Outcome::OutOfMemory)];
            !rule.where_it_fits || !want.contains(&ended(cells, &rule.r#use))
        };
        let holds = |rule: &&Rule| select::matches(scene, &rule.when);
        self.rule.iter().filter(fits).find(holds).map(|rule| rule.r#use.as_str())
    }
}

impl Followed {
    /// The median regret: infinite where in half of the scenes there is no answer.
    pub fn typical(&self) -> f64 {
        let middle = self.places.len() / 2;
        let at = |k: usize| self.places[k].regret.times();
        if self.places.len() % 2 == 1 { at(middle) } else { (at(middle - 1) * at(middle)).sqrt() }
    }

    /// Where it costs most, as far as there is a time.
    pub fn worst(&self) -> Option<(&Place, Interval)> {
        self.places.iter().rev().find_map(|place| match place.regret {
            Regret::Times(ratio, _) => Some((place, ratio)),
            _ => None,
        })
    }

    /// In how many scenes it names the fastest; one of which it is undecided; one that is slower
    /// for sure; one without an answer.
    pub fn tally(&self) -> [usize; 4] {
        let count = |wanted: fn(&Regret) -> bool| {
            self.places.iter().filter(|place| wanted(&place.regret)).count()
        };
        [
            count(|regret| matches!(regret, Regret::None)),
            count(|regret| matches!(regret, Regret::Times(_, false))),
            count(|regret| matches!(regret, Regret::Times(_, true))),
            count(|regret| matches!(regret, Regret::Endless(_))),
        ]
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;
    use crate::detect::table::TABLE;

    /// Two scenes: one of equal bodies, dense; one of sizes ten to one, sparse, for which there is
    /// no room for screening, and one grid takes too long.
    pub(crate) fn made_up() -> Vec<Followed> {
        let mut lab = Lab::new("e", "loose");
        lab.param("fraction", 0.5).filled(0.5).ratio(1.0);
        for (detector, time) in
            [("screening", 200), ("nbs", 300), ("cell-grid", 100), ("bvh", 400), ("hgrid", 102)]
        {
            lab.detector(detector).time(&[time; 15]);
        }
        lab.detector("cell-grid-twin").time(&[105; 15]);
        lab.param("fraction", 0.01).filled(0.01).ratio(10.0);
        for (detector, time) in [("nbs", 2000), ("bvh", 400), ("hgrid", 100)] {
            lab.detector(detector).time(&[time; 15]);
        }
        lab.detector("screening").fail(Pass::Time, Outcome::Refused, "the grid needs 9 GiB");
        lab.detector("cell-grid").fail(Pass::Time, Outcome::Timeout, "4 s, the limit");
        let cells = cells::cells(&lab.rows());
        followed(&cells.iter().collect::<Vec<_>>())
    }

    #[test]
    fn advice_costs_what_its_detector_takes_longer_than_the_fastest() {
        let found = made_up();
        let said = |k: usize| {
            let place = |place: &Place| (place.advised.clone(), place.regret.times());
            let one = &found[k];
            (one.places.iter().map(place).collect::<Vec<_>>(), one.tally())
        };
        let of = |list: &[(&str, f64)]| -> Vec<(String, f64)> {
            list.iter().map(|&(name, times)| (name.into(), times)).collect()
        };
        let near = |a: &[(String, f64)], b: &[(String, f64)]| {
            a.len() == b.len()
                && a.iter()
                    .zip(b)
                    .all(|(a, b)| a.0 == b.0 && (a.1 == b.1 || (a.1 / b.1 - 1.0).abs() < 1e-9))
        };
        let endless = f64::INFINITY;
        for (k, places, tally) in [
            // Screening was refused where there was no room: then NBS is meant.
            (0, of(&[("screening", 2.0), ("nbs", 20.0)]), [0, 0, 2, 0]),
            (1, of(&[("cell-grid", 1.0), ("bvh", 4.0)]), [1, 0, 1, 0]),
            (2, of(&[("hgrid", 1.0), ("cell-grid", 1.0)]), [2, 0, 0, 0]),
            (3, of(&[("cell-grid", 1.0), ("cell-grid", endless)]), [1, 0, 0, 1]),
            (4, of(&[("cell-grid", 1.0), ("bvh", 4.0)]), [1, 0, 1, 0]),
        ] {
            let (found, counted) = said(k);
            assert!(near(&found, &places) && counted == tally, "{k}: {found:?} {counted:?}");
        }
        // Nobody measured the last one.
        assert_eq!(found.len(), 5);
        assert!((found[0].typical() - 40_f64.sqrt()).abs() < 1e-9);
        assert!(found[3].typical().is_infinite());
        let (place, ratio) = found[0].worst().unwrap();
        assert!(place.title.contains("fraction = 0.01") && ratio.count == 15, "{place:?}");
        assert!(found[3].worst().is_none());
    }

    #[test]
    fn what_is_within_the_noise_is_not_told_from_the_fastest() {
        let mut lab = Lab::new("e", "loose");
        lab.filled(0.5).ratio(1.0).detector("cell-grid").time(&[102; 15]);
        lab.detector("cell-grid-twin").time(&[107; 15]).detector("hgrid").time(&[100; 15]);
        let cells = cells::cells(&lab.rows());
        let found = followed(&cells.iter().collect::<Vec<_>>());
        let one_grid = found.iter().find(|one| one.advice.name.starts_with("one grid")).unwrap();
        assert_eq!(one_grid.tally(), [0, 1, 0, 0]);
        assert!(matches!(one_grid.places[0].regret, Regret::Times(_, false)));
    }

    #[test]
    fn the_file_names_detectors_and_variables_that_exist() {
        assert!(ADVICE.len() >= 6, "{}", ADVICE.len());
        for advice in ADVICE.iter() {
            assert!(!advice.source.is_empty(), "{}", advice.name);
            let last = advice.rule.last().unwrap();
            assert!(
                last.when.is_empty() && !last.where_it_fits,
                "{}: no rule is left",
                advice.name
            );
            for rule in &advice.rule {
                assert!(TABLE.iter().any(|entry| entry.name == rule.r#use), "{}", rule.r#use);
                for name in rule.when.keys() {
                    let column = crate::record::column::Column::find(&name.replace('-', "_"));
                    assert!(column.is_some_and(|column| column.pass.is_none()), "{name}");
                }
            }
        }
    }
}
