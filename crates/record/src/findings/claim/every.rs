//! The scenes of an experiment. Each value of n, seed, order or parameter makes another scene.
//! Plans, coverage and ratios count scenes by [`key`].
//!
//! A report shows all scenes if they are few, otherwise the ends of each sweep. The table of
//! details has all.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use crate::cells::label::{family, swept, title};
use crate::cells::{AxisValue, Cell, CellId};
use crate::record::id::Projection;

/// Largest number of scenes that a report shows. It shows the ends of all sweeps even if these
/// are more.
pub const ROWS: usize = 30;

pub struct Scene<'a> {
    pub title: String,
    pub n: u64,
    pub cells: Vec<&'a Cell>,
    pub shown: bool,
}

#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    params: BTreeMap<String, AxisValue>,
    order: String,
    n: u64,
    seed: u64,
}

impl Place {
    fn is_same_setting(&self, other: &Place) -> bool {
        (&self.params, &self.order) == (&other.params, &other.order)
    }
}

/// The identity of a cell's scene. Equal keys mean equal particles.
pub fn key(id: &CellId) -> Projection {
    id.scene_id().without(&["experiment"])
}

pub fn count<'a>(cells: impl IntoIterator<Item = &'a Cell>) -> usize {
    cells.into_iter().map(|cell| key(&cell.id)).collect::<HashSet<_>>().len()
}

pub fn every<'a>(cells: &[&'a Cell]) -> Vec<Scene<'a>> {
    let mut families: BTreeMap<_, BTreeMap<Place, Vec<&'a Cell>>> = BTreeMap::new();
    for &cell in cells {
        let scenes = families.entry(family(&cell.id)).or_default();
        let CellId { params, order, n, seed, .. } = cell.id.clone();
        scenes.entry(Place { params, order, n, seed }).or_default().push(cell);
    }
    let sweeps: Vec<Vec<&Place>> =
        families.values().map(|scenes| scenes.keys().collect()).collect();
    let chosen = chosen(&sweeps);
    let mut out = Vec::new();
    for (scenes, chosen) in families.values().zip(&chosen) {
        let own: Vec<&Cell> = scenes.values().flatten().copied().collect();
        let varied = swept(&own);
        let seeds: BTreeSet<u64> = scenes.keys().map(|place| place.seed).collect();
        for (k, (place, cells)) in scenes.iter().enumerate() {
            let mut title = title(&cells[0].id, &varied);
            if seeds.len() > 1 {
                title += &format!(", seed = {}", place.seed);
            }
            let (n, shown) = (place.n, chosen.contains(&k));
            out.push(Scene { title, n, cells: cells.clone(), shown });
        }
    }
    out
}

/// Chooses the scenes to show from each sweep, at most [`ROWS`] in all. The first choice that fits
/// is used: every scene; one for each swept value; the smallest and largest n of each setting; one
/// for each parameter value at the largest n; the ends of the sweep.
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

fn values(places: &[&Place], of: impl IntoIterator<Item = usize>) -> BTreeSet<usize> {
    let (mut sizes, mut seen) = (BTreeSet::new(), BTreeSet::new());
    let mut is_new = |k: &usize| {
        let Place { params, order, n, .. } = places[*k];
        let mut new = sizes.insert(*n);
        for (name, value) in params {
            new |= seen.insert((name.as_str(), value.to_string()));
        }
        new | seen.insert(("", order.clone()))
    };
    of.into_iter().filter(|k| is_new(k)).collect()
}

fn firsts(places: &[&Place]) -> BTreeSet<usize> {
    let first = |k: &usize| *k == 0 || !places[k - 1].is_same_setting(places[*k]);
    (0..places.len()).filter(first).collect()
}

fn lasts(places: &[&Place]) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    let mut start = 0;
    for own in places.chunk_by(|a, b| a.is_same_setting(b)) {
        let largest = own.last().map(|place| place.n);
        found.extend(own.iter().position(|place| Some(place.n) == largest).map(|k| start + k));
        start += own.len();
    }
    found
}

/// Returns the first and last setting at their largest n; a single setting at its smallest and
/// largest n.
fn ends(places: &[&Place]) -> BTreeSet<usize> {
    let lasts = lasts(places);
    let firsts = if lasts.len() > 1 { lasts.clone() } else { firsts(places) };
    firsts.first().into_iter().chain(lasts.last()).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::testing::Lab;

    fn shown(ratios: u64, sizes: u64, seeds: u64) -> (usize, Vec<String>) {
        let mut lab = Lab::new("e", "packed");
        for (ratio, n) in (1..=ratios).flat_map(|ratio| (1..=sizes).map(move |n| (ratio, n))) {
            for seed in 1..=seeds {
                lab.param("size-ratio", ratio).n(n).seed(seed).time(&[100; 5]);
            }
        }
        lab.find(|cells| {
            let scenes = every(cells);
            assert_eq!(count(cells.iter().copied()), scenes.len());
            let shown = scenes.iter().filter(|scene| scene.shown);
            (scenes.len(), shown.map(|scene| scene.title.clone()).collect())
        })
    }

    #[test]
    fn every_swept_value_has_its_scene_or_the_ends_have() {
        let title = |n: u64, ratio: u64| format!("packed, 2D, N = {n}, size_ratio = {ratio}");
        assert_eq!(shown(2, 2, 1), (4, vec![title(1, 1), title(2, 1), title(1, 2), title(2, 2)]));
        let (all, titles) = shown(1, 1, 3);
        assert!(all == 3 && titles[2].ends_with(", seed = 3"), "{titles:?}");
        // One number of particles has one seed, another has two: all three titles name the seed.
        let mut lab = Lab::new("e", "packed");
        for (n, seed) in [(1, 1), (2, 1), (2, 2)] {
            lab.n(n).seed(seed).time(&[1]);
        }
        let named = lab.find(|cells| {
            every(cells).into_iter().filter(|scene| scene.title.contains("seed = ")).count()
        });
        assert_eq!(named, 3);
        for (ratios, sizes, expected) in
            [(8, 3, (24, 24)), (13, 3, (39, 16)), (30, 2, (60, 30)), (40, 2, (80, 2))]
        {
            let (all, titles) = shown(ratios, sizes, 1);
            assert_eq!((all, titles.len()), expected);
        }
        let ends = ["packed, 2D, N = 1", "packed, 2D, N = 35"].map(String::from);
        assert_eq!(shown(1, 35, 1), (35, ends.into()));
    }
}
