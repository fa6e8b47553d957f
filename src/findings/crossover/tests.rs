//! Crossovers of made-up detectors, whose laws are known.

use super::*;
use crate::cells;
use crate::cells::testing::Lab;

/// `direct` with 0.01 N^2 ns, `nbs` with 100 N + 1000 ns, `screening` with twice that: the first
/// two are equal at about 10^4, the first and the last at about 2 * 10^4.
fn cells(sizes: &[u64]) -> Vec<Cell> {
    let mut lab = Lab::new("e", "packed");
    for scene in ["packed", "loose", "clustered"] {
        for &n in sizes {
            lab.scene(scene, 2).n(n);
            lab.detector("direct").time(&[n * n / 100; 5]).count(&[("contact_test", n * n)]);
            lab.detector("nbs").time(&[100 * n + 1000; 5]).count(&[("list_push", 2 * n)]);
            lab.detector("screening").time(&[200 * n + 2000; 5]).count(&[("list_push", 2 * n)]);
        }
    }
    cells::cells(&lab.rows())
}

fn model(sizes: &[u64]) -> CostModel {
    let cells = cells(sizes);
    CostModel::new(&cells.iter().collect::<Vec<_>>(), &[]).unwrap()
}

#[test]
fn known_crossovers_are_found() {
    let found = model(&[1000, 3000, 30_000, 100_000]);
    assert_eq!((found.fits.len(), found.orders), (3, false));
    assert_eq!((found.right, found.couples), (36, 36));
    assert_eq!(found.predictions.len(), 3);
    for prediction in &found.predictions {
        // direct crosses nbs and screening; these two never meet
        assert_eq!((prediction.couples, prediction.uncrossed), (3, 1));
        let names: Vec<&str> = prediction.reign.iter().map(|(_, name)| &**name).collect();
        assert_eq!((names, prediction.reign[0].0), (vec!["direct", "nbs"], RANGE.0));
        assert!((prediction.reign[1].0 / 1e4 - 1.0).abs() < 0.05, "{prediction:?}");
        let [nbs, screening] = &*prediction.crossings else { panic!("{prediction:?}") };
        for (crossing, above, n) in [(nbs, "nbs", 1e4), (screening, "screening", 2e4)] {
            assert_eq!((&*crossing.below, &*crossing.above), ("direct", above));
            assert!((crossing.n / n - 1.0).abs() < 0.02, "{crossing:?}");
            assert!(crossing.range.0 <= crossing.n && crossing.n <= crossing.range.1);
            assert!(!crossing.extrapolated);
        }
    }
    assert_eq!(CostModel::new(&[], &[]), None);
}

#[test]
fn what_was_not_measured_is_marked() {
    let found = model(&[1000, 2000, 3000, 4000]);
    let crossings = found.predictions.iter().flat_map(|prediction| &prediction.crossings);
    let marks: Vec<bool> = crossings.map(|crossing| crossing.extrapolated).collect();
    assert!(marks.len() == 6 && marks.iter().all(|mark| *mark), "{found:?}");
}
