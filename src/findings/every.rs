//! The scenes of an experiment. A scene is one set of particles: another N, seed, order or
//! parameter makes another scene. Plans, coverage, contests and ratios all count scenes so.
//!
//! An answer shows every scene if they are few. Otherwise it shows the ends of each sweep, and the
//! table of details has all.

use std::collections::{BTreeMap, BTreeSet};

use crate::cells::label::{family, swept, title};
use crate::cells::{Cell, CellId};

/// The most scenes that an answer shows, unless the first and last of each sweep are more.
pub const ROWS: usize = 30;

/// The cells of one set of particles.
pub struct Scene<'a> {
    /// `packed, 3D, N = 1000`.
    pub title: String,
    /// Its particles.
    pub n: u64,
    /// All cells there.
    pub cells: Vec<&'a Cell>,
    /// Is it among the scenes that an answer shows?
    pub shown: bool,
}

/// Place of a scene in its sweep: parameters with order, then N, then seed.
type Place = ((BTreeMap<String, crate::record::value::AxisValue>, String), u64, u64);

fn place(id: &CellId) -> Place {
    ((id.params.clone(), id.order.clone()), id.n, id.seed)
}

/// All scenes, in the order of their sweeps.
pub fn every<'a>(cells: &[&'a Cell]) -> Vec<Scene<'a>> {
    let mut families: BTreeMap<_, BTreeMap<Place, Vec<&'a Cell>>> = BTreeMap::new();
    for &cell in cells {
        let scenes = families.entry(family(&cell.id)).or_default();
        scenes.entry(place(&cell.id)).or_default().push(cell);
    }
    let sweeps: Vec<Vec<&Place>> =
        families.values().map(|scenes| scenes.keys().collect()).collect();
    let chosen = chosen(&sweeps);
    let mut out = Vec::new();
    for (scenes, chosen) in families.values().zip(&chosen) {
        let own: Vec<&Cell> = scenes.values().flatten().copied().collect();
        let varied = swept(&own);
        for (k, (place, cells)) in scenes.iter().enumerate() {
            let (setting, n, seed) = place;
            let drawn = scenes.keys().filter(|other| (&other.0, other.1) == (setting, *n)).count();
            let mut title = title(&cells[0].id, &varied);
            if drawn > 1 {
                title += &format!(", seed = {seed}");
            }
            out.push(Scene { title, n: *n, cells: cells.clone(), shown: chosen.contains(&k) });
        }
    }
    out
}

/// Numbers of the scenes that are shown, for each sweep, at most [`ROWS`] in all: every scene; or
/// one for each value that is swept; or the smallest and largest N of each setting; or, at the
/// largest N, one for each value of a parameter; or the ends of the sweep, however many sweeps
/// there are.
fn chosen(sweeps: &[Vec<&Place>]) -> Vec<BTreeSet<usize>> {
    type Choice = fn(&[&Place]) -> BTreeSet<usize>;
    let choices: [Choice; 5] = [
        |places| (0..places.len()).collect(),
        |places| &values(places, 0..places.len()) | &ends(places),
        |places| &lasts(places) | &firsts(places),
        |places| &values(places, lasts(places)) | &ends(places),
        ends,
    ];
    let of = |choice: fn(&[&Place]) -> BTreeSet<usize>| -> Vec<BTreeSet<usize>> {
        sweeps.iter().map(|places| choice(places)).collect()
    };
    let few = |found: &Vec<BTreeSet<usize>>| found.iter().map(BTreeSet::len).sum::<usize>() <= ROWS;
    choices.into_iter().map(of).find(few).unwrap_or_else(|| of(ends))
}

/// Of these scenes those with a value that none before has: of N, or of a parameter.
fn values(places: &[&Place], of: impl IntoIterator<Item = usize>) -> BTreeSet<usize> {
    let (mut sizes, mut seen) = (BTreeSet::new(), BTreeSet::new());
    let mut is_new = |k: &usize| {
        let ((params, order), n, _) = places[*k];
        let mut new = sizes.insert(*n);
        for (name, value) in params {
            new |= seen.insert((name.as_str(), value.to_string()));
        }
        new | seen.insert(("", order.clone()))
    };
    of.into_iter().filter(|k| is_new(k)).collect()
}

/// Each setting at its smallest N.
fn firsts(places: &[&Place]) -> BTreeSet<usize> {
    let first = |k: &usize| *k == 0 || places[k - 1].0 != places[*k].0;
    (0..places.len()).filter(first).collect()
}

/// Each setting at its largest N, of several seeds the first.
fn lasts(places: &[&Place]) -> BTreeSet<usize> {
    let largest = |place: &Place| {
        let own = places.iter().filter(|other| other.0 == place.0);
        own.map(|other| other.1).max() == Some(place.1)
    };
    let first_seed =
        |k: usize| k == 0 || places[k - 1].0 != places[k].0 || places[k - 1].1 < places[k].1;
    (0..places.len()).filter(|&k| largest(places[k]) && first_seed(k)).collect()
}

/// The first and the last setting at their largest N; of a single one, its smallest and largest N.
fn ends(places: &[&Place]) -> BTreeSet<usize> {
    let lasts = lasts(places);
    let firsts = if lasts.len() > 1 { lasts.clone() } else { firsts(places) };
    firsts.first().into_iter().chain(lasts.last()).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;

    /// Number of scenes, and titles of those shown.
    fn shown(ratios: u64, sizes: &[u64], seeds: u64) -> (usize, Vec<String>) {
        let mut lab = Lab::new("e", "packed");
        for ratio in 1..=ratios {
            lab.param("size-ratio", ratio);
            for &n in sizes {
                for seed in 1..=seeds {
                    lab.n(n).seed(seed).detector("nbs").time(&[100; 5]);
                }
            }
        }
        let cells = cells::cells(&lab.rows());
        let scenes = every(&cells.iter().collect::<Vec<_>>());
        let titles = scenes.iter().filter(|scene| scene.shown).map(|scene| scene.title.clone());
        (scenes.len(), titles.collect())
    }

    #[test]
    fn every_swept_value_has_its_scene_or_the_ends_have() {
        let (all, titles) = shown(2, &[10, 100], 1);
        let title = |n: u64, ratio: u64| format!("packed, 2D, N = {n}, size_ratio = {ratio}");
        assert_eq!(all, 4);
        assert_eq!(titles, [title(10, 1), title(100, 1), title(10, 2), title(100, 2)]);
        // Three seeds are three scenes.
        assert_eq!(shown(1, &[10], 3).0, 3);
        assert!(shown(1, &[10], 3).1[2].ends_with(", seed = 3"));
        let counts = |ratios, sizes: &[u64]| {
            let (all, titles) = shown(ratios, sizes, 1);
            (all, titles.len())
        };
        assert_eq!(counts(8, &[10, 20, 30]), (24, 24));
        assert_eq!(counts(13, &[10, 20, 30]), (39, 16));
        assert_eq!(counts(30, &[10, 20]), (60, 30));
        assert_eq!(counts(40, &[10, 20]), (80, 2));
        let (all, titles) = shown(1, &(1..=35).collect::<Vec<_>>(), 1);
        assert_eq!(
            (all, titles),
            (35, vec!["packed, 2D, N = 1".into(), "packed, 2D, N = 35".into()])
        );
    }
}
