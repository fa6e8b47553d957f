//! Two modes of a machine: it may run at one speed in some blocks and at another in others. Ratios
//! within blocks then differ from the ratio of the medians, and twins have different medians.

use crate::cells::{Cell, CellId};
use crate::findings::claim::every::every;
use crate::findings::trust::noise::SURE;
use crate::findings::winners::{by_ratio, time};
use crate::stats::interval::Interval;

/// Ratio of medians that shows two modes, if it should be that within blocks, or 1 for twins.
const APART: f64 = 1.15;
/// A record is doubtful if more than one in this many scenes shows two modes.
const ONE_IN: usize = 10;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Modes {
    /// Number of scenes that show two modes.
    pub scenes: usize,
    /// Number of scenes in which two times can be compared.
    pub of: usize,
}

fn is_apart(ratio: f64) -> bool {
    ratio.ln().abs() >= APART.ln()
}

impl Modes {
    pub fn new(cells: &[&Cell]) -> Modes {
        let timed = |cells: &[&Cell]| -> Vec<bool> {
            let timed: Vec<&Cell> =
                cells.iter().filter(|cell| cell.time().is_some()).copied().collect();
            let twins = timed.iter().filter_map(|twin| {
                let id = CellId { detector: twin.role.twin_of()?.into(), ..twin.id.clone() };
                let original = timed.iter().find(|cell| cell.id == id)?;
                Some(is_apart(time(twin) / time(original)))
            });
            let twins: Vec<bool> = twins.collect();
            let others = timed.iter().filter(|cell| !cell.role.is_control()).copied();
            let order = by_ratio(others.collect());
            let apart = order.split_first().into_iter().flat_map(|(first, others)| {
                let ratio = |other: &&Cell| other.ratio(first).map(|it| (it, time(other)));
                let ratios = others.iter().filter_map(ratio);
                let sure = ratios.filter(|(ratio, _)| ratio.coverage >= SURE);
                let beside = |it: &Interval, of: f64| {
                    (of < it.low || of > it.high) && is_apart(of / it.median)
                };
                sure.map(move |(ratio, other)| beside(&ratio, other / time(first)))
            });
            apart.chain(twins).collect()
        };
        let scenes = every(cells);
        let scenes = scenes.iter().map(|scene| timed(&scene.cells)).filter(|it| !it.is_empty());
        scenes.fold(Modes::default(), |sum, scene| Modes {
            scenes: sum.scenes + usize::from(scene.contains(&true)),
            of: sum.of + 1,
        })
    }

    pub fn are_many(&self) -> bool {
        self.scenes * ONE_IN > self.of
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::testing::Lab;

    #[test]
    fn two_modes_show_in_medians_that_ratios_do_not_explain_and_in_twins() {
        let found = |nbs: &[u64], sorting: &[u64], twin: &[u64]| {
            let mut lab = Lab::new("e", "packed");
            lab.detector("nbs").time(nbs).detector("sorting").time(sorting);
            lab.detector("nbs-twin").time(twin).find(Modes::new).scenes
        };
        let (slowly, twice) = ([100, 200, 300, 400, 500], [200, 400, 600, 800, 1000]);
        assert_eq!(found(&slowly, &twice, &slowly), 0);
        // Eight of nine blocks have a ratio of 2, but the medians are equal.
        let nbs = [100, 100, 100, 100, 200, 200, 200, 200, 200];
        let sorting = [200, 200, 200, 200, 400, 400, 400, 400, 100];
        assert_eq!(found(&nbs, &sorting, &nbs), 1);
        // Here the medians have a ratio of 1.85: outside the interval, but not by 15%.
        let [nbs, sorting] =
            [nbs, sorting].map(|times| times.map(|t| if t == 200 { 108 } else { t }));
        assert_eq!(found(&nbs, &sorting.map(|t| if t == 400 { 216 } else { t }), &nbs), 0);
        assert_eq!(found(&[100; 5], &[200; 5], &[114; 5]), 0);
        assert_eq!(found(&[100; 5], &[200; 5], &[85; 5]), 1);
        assert!(!Modes { scenes: 2, of: 20 }.are_many() && Modes { scenes: 3, of: 20 }.are_many());
    }
}
