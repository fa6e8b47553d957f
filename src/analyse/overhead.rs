//! What the harness adds to the times that it measures, from the record's own controls.
//!
//! The control `nothing` takes what is left of a measurement without a detector: clock, call, an emptied list. Its time over that of the
//! fastest detector is the largest share that the harness can have in any time at that N. The A/A twin is the same code again: how far its
//! ratio to the original is from 1 says what two places in the same run differ by.

use std::collections::BTreeMap;

use super::grid;
use super::interval::typical_ratio;
use super::summary::{twin_of, with_interval};
use super::text;
use super::value::{Cell, Key};
use crate::harness::record::Pass;

/// Less than this share is not worth a thought.
const LEAST: f64 = 0.01;

/// A sentence on `nothing`, and one on every twin; empty without controls.
pub fn sentences(cells: &[&Cell]) -> Vec<String> {
    floor(cells).into_iter().chain(twins(cells)).collect()
}

/// The share of the harness: by N, of all scenes the largest.
fn floor(cells: &[&Cell]) -> Option<String> {
    let mut floors: BTreeMap<Key, f64> = BTreeMap::new();
    for cell in cells.iter().filter(|cell| grid::is_nothing(&cell.key.detector)) {
        // Below a nanosecond the record has no numbers.
        let time = cell.time()?.median.max(1.0);
        let floor = floors.entry(scene(&cell.key)).or_insert(time);
        *floor = floor.max(time);
    }
    let mut shares: BTreeMap<u64, (f64, String)> = BTreeMap::new();
    for group in grid::groups(cells) {
        for n in group.sizes() {
            let Some((line, time)) = group.fastest(n) else { continue };
            let Some(first) = group.at(line, n).and_then(|cells| cells.first()) else { continue };
            let Some(floor) = floors.get(&scene(&first.key)).filter(|_| time > 0.0) else { continue };
            let share = floor / time;
            let place = format!("{}, {}", line.detector, group.title);
            let worst = shares.entry(n).or_insert((share, place.clone()));
            if share > worst.0 {
                *worst = (share, place);
            }
        }
    }
    let worst = shares.iter().max_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    let at = format!("{} of the fastest detector's time at N = {} ({})", text::percent(worst.1.0), worst.0, worst.1.1);
    let clear = shares.iter().rev().take_while(|(_, share)| share.0 < LEAST).last();
    Some(match clear {
        _ if worst.1.0 < LEAST => format!("The harness adds less than 1% to every time: the control that does nothing takes at most {at}."),
        Some((n, _)) => {
            format!("The harness adds up to {at}, and less than 1% from N = {n} on: that is what the control that does nothing takes.")
        }
        None => format!("The harness adds MORE than 1% at every N: the control that does nothing takes up to {at}."),
    })
}

/// A scene, whoever works on it.
fn scene(key: &Key) -> Key {
    key.clone().without("detector").without("threads").without("arithmetic").without("seed")
}

/// Every twin against its original: of each block the median over all cells.
fn twins(cells: &[&Cell]) -> Vec<String> {
    let by_key: BTreeMap<&Key, &Cell> = cells.iter().map(|cell| (&cell.key, *cell)).collect();
    let good = |cell: &Cell| cell.outcome(&[Pass::Time]).0.is_good();
    let mut couples: BTreeMap<(&str, &str), Vec<_>> = BTreeMap::new();
    for &cell in cells.iter().filter(|cell| good(cell)) {
        let Some(base) = twin_of(&cell.key.detector) else { continue };
        if let Some(original) = by_key.get(&Key { detector: base.into(), ..cell.key.clone() }).filter(|original| good(original)) {
            couples.entry((&cell.key.detector, base)).or_default().push((&cell.times, &original.times));
        }
    }
    let sentence = |((twin, base), couples): (&(&str, &str), &Vec<_>)| {
        let ratio = typical_ratio(couples)?;
        let apart = if ratio.low > 1.0 + LEAST || ratio.high < 1.0 - LEAST {
            "more than 1% apart, which is no difference of the code"
        } else {
            "equal, or less than 1% apart"
        };
        Some(format!(
            "{twin} takes {} times the time of {base}, the same code, over {}: {apart}.",
            with_interval(&ratio),
            text::plural(couples.len(), "cell")
        ))
    };
    couples.iter().filter_map(sentence).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{fake::Lab, value};
    use super::*;
    use crate::harness::record::Outcome;

    fn lab(floor: u64) -> Vec<Cell> {
        let mut lab = Lab::new("e", "packed");
        for n in [10_u64, 1000] {
            lab.n(n).detector("nbs").time(&[100 * n; 15]).detector("nbs-twin").time(&[101 * n; 15]);
            lab.detector("direct").time(&[n * n * 30; 15]);
            lab.detector("nothing").time(&[floor; 15]).edit(|row| row.outcome = Outcome::Control);
        }
        value::cells(&lab.rows())
    }

    #[test]
    fn the_share_of_the_harness_is_said_or_its_failure() {
        for (floor, words) in [
            (
                0,
                "adds less than 1% to every time: the control that does nothing takes at most 0.1% of the fastest detector's time at N = 10",
            ),
            (50, "adds up to 5.0% of the fastest detector's time at N = 10 (nbs, packed, 2D), and less than 1% from N = 1000 on"),
            (5000, "adds MORE than 1% at every N"),
        ] {
            let cells = lab(floor);
            let said = sentences(&cells.iter().collect::<Vec<_>>());
            assert!(said[0].contains(words), "{said:?}");
            assert!(said[1].contains("nbs-twin takes 1.01 (1.01 to 1.01) times the time of nbs, the same code, over 2 cells"), "{said:?}");
            assert_eq!(said.len(), 2);
        }
        let cells = lab(5);
        let none: Vec<&Cell> = cells.iter().filter(|cell| !cell.key.detector.starts_with('n')).collect();
        assert!(sentences(&none).is_empty());
    }
}
