//! The share of the harness in measured times.
//!
//! The control `nothing` measures the harness alone: clock, call, and clearing the list. Its time
//! over that of the fastest detector is the largest possible share at that n.

use std::collections::BTreeMap;

use crate::cells::{Cell, CellId, series};
use crate::record::id::Projection;
use crate::record::role::Role;

/// Shares below this are not reported.
pub const LEAST: f64 = 0.01;

#[derive(Clone, Debug, PartialEq)]
pub struct Overhead {
    pub share: f64,
    pub n: u64,
    pub detector: String,
    pub scene: String,
    /// Smallest n from which the share of the harness stays below [`LEAST`] in all scenes.
    pub clear_from: Option<u64>,
}

impl Overhead {
    pub fn new(cells: &[&Cell]) -> Option<Overhead> {
        let mut idle: BTreeMap<Projection, f64> = BTreeMap::new();
        for cell in cells.iter().filter(|cell| cell.role == Role::Nothing) {
            // The record rounds times to whole nanoseconds, perhaps to 0.
            let time = cell.time()?.median.max(1.0);
            let known = idle.entry(scene(&cell.id)).or_insert(time);
            *known = known.max(time);
        }
        let mut shares: BTreeMap<u64, Overhead> = BTreeMap::new();
        for group in series::groups(cells) {
            for n in group.sizes() {
                let Some(&(line, time)) = group.ranked(n, |_| true).first() else { continue };
                let Some([first, ..]) = group.at(line, n).map(|cells| &**cells) else { continue };
                let Some(idle) = idle.get(&scene(&first.id)).filter(|_| time > 0.0) else {
                    continue;
                };
                let (detector, scene) = (line.detector.clone(), group.title.clone());
                let found = Overhead { share: idle / time, n, detector, scene, clear_from: None };
                let worst = shares.entry(n).or_insert_with(|| found.clone());
                if found.share > worst.share {
                    *worst = found;
                }
            }
        }
        let clear = shares.iter().rev().take_while(|(_, found)| found.share < LEAST).last();
        let clear_from = clear.map(|(n, _)| *n);
        let worst = shares.values().max_by(|a, b| a.share.total_cmp(&b.share))?;
        Some(Overhead { clear_from, ..worst.clone() })
    }
}

fn scene(id: &CellId) -> Projection {
    id.scene_id().without(&["seed"])
}
