//! Twins in a comparison, and ratios over all cells of a detector.

use std::collections::BTreeMap;

use super::{Compared, Judgement, Record};
use crate::stats::interval::{Interval, at_least, interval};

/// If a twin moved by more than this factor, no verdict is given, because a comparison must be able
/// to detect a slowdown of this size.
pub const SEEN: f64 = 1.25;
/// If chance explains the number of moved twins with at most this probability, all verdicts are
/// void.
const LUCK: f64 = 0.25;

/// Voids verdicts if a twin, which is equal code, is slower or faster. If it moved far, or in more
/// cells than chance explains, all verdicts are void, otherwise those of its scene. Returns the
/// twin that moved most, and its factor.
pub(super) fn void(found: &mut [Compared], record: &Record) -> Option<(String, f64)> {
    use Judgement::{Faster, Slower};
    let twins = |cell: &&Compared| {
        let known = record.cells.get(&cell.id);
        known.is_some_and(|known| known.role.twin_of().is_some())
    };
    let timed: Vec<(&Compared, f64, f64)> = found
        .iter()
        .filter(twins)
        .filter_map(|cell| {
            let timing = cell.timing.as_ref().filter(|timing| timing.is_decidable())?;
            let moved = matches!(timing.judgement, Slower | Faster);
            let factor = timing.ratio.median.max(1.0 / timing.ratio.median);
            Some((cell, if moved { factor } else { 1.0 }, 1.0 - timing.ratio.coverage))
        })
        .collect();
    let moved: Vec<_> = timed.iter().filter(|(_, factor, _)| *factor > 1.0).collect();
    let (worst, most, _) = moved.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let worst = (worst.id.subject(), *most);
    let by_chance = timed.iter().map(|(.., share)| share).sum::<f64>() / timed.len() as f64;
    let all = *most > SEEN || at_least(moved.len(), timed.len(), by_chance) <= LUCK;
    let scenes: Vec<_> = moved.iter().map(|(cell, ..)| cell.id.scene_id()).collect();
    for cell in found.iter_mut().filter(|cell| all || scenes.contains(&cell.id.scene_id())) {
        if let Some(timing) = cell.timing.as_mut().filter(|timing| timing.is_decidable()) {
            timing.judgement = Judgement::NotJudged;
        }
    }
    Some(worst)
}

pub fn pooled(cells: &[Compared]) -> Vec<(String, Interval)> {
    let mut ratios: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for cell in cells {
        if let Some(timing) = cell.timing.as_ref().filter(|timing| timing.is_decidable()) {
            ratios.entry(cell.id.subject()).or_default().push(timing.ratio.median);
        }
    }
    let several = ratios.into_iter().filter(|(_, ratios)| ratios.len() > 1);
    several.filter_map(|(name, ratios)| Some((name, interval(&ratios)?))).collect()
}
