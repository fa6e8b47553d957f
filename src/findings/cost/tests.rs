//! The cost model on times made of known costs.

use super::*;
use crate::cells;
use crate::cells::testing::Lab;

/// Three scenes with 2, 4 and 8 tests per particle, at four N; `time` of (N, tests).
fn lab(time: impl Fn(u64, u64) -> f64) -> Vec<Cell> {
    lab_of(&[1000, 10_000, 100_000, 1_000_000], time)
}

fn lab_of(sizes: &[u64], time: impl Fn(u64, u64) -> f64) -> Vec<Cell> {
    let mut lab = Lab::new("e", "packed");
    for (scene, per) in [("packed", 8), ("loose", 2), ("clustered", 4)] {
        for &n in sizes {
            let (tests, time) = (per * n, time(n, per * n).round() as u64);
            // Pushes, resets and probes go with N; pairs with tests, nearly.
            lab.scene(scene, 2).n(n).detector("nbs").time(&[time; 5]);
            lab.count(&[
                ("list_push", 2 * n),
                ("list_reset", 2 * n),
                ("cell_probe", n),
                ("contact_test", tests),
                ("move", 0),
            ]);
            lab.edit(|row| row.contacts = Some(tests / 2));
        }
    }
    let mut rows = lab.rows();
    let pairs: BTreeMap<_, _> = rows
        .iter()
        .filter(|row| row.pass == Pass::Count)
        .map(|row| ((row.id.scene.clone(), row.id.n), row.contacts))
        .collect();
    rows.iter_mut().for_each(|row| row.contacts = pairs[&(row.id.scene.clone(), row.id.n)]);
    cells::cells(&rows)
}

fn operations(term: &Term) -> &[&'static str] {
    if let Kind::Operations(names) = &term.kind { names } else { &[] }
}

fn fitted(cells: &[Cell]) -> Vec<Fit> {
    fits(&series(&cells.iter().collect::<Vec<_>>()), &[])
}

#[test]
fn known_costs_are_found_again() {
    // 5 N operations of 3 ns each, 1.5 N-fold tests and pairs of 4 ns, 20 us per detection
    let cells = lab(|n, tests| 20_000.0 + 15.0 * n as f64 + 6.0 * tests as f64);
    let found = fitted(&cells);
    assert_eq!(found.len(), 1);
    let terms: Vec<(&[&str], f64)> =
        found[0].terms.iter().map(|term| (operations(term), term.ns)).collect();
    let expected: [(&[&str], f64); 3] = [
        (&["list_push", "list_reset", "cell_probe"], 3.0),
        (&["contact_test", PAIRS], 4.0),
        (&[], 20_000.0),
    ];
    assert_eq!(terms.len(), 3, "{terms:?}");
    for ((operations, ns), (wanted, cost)) in terms.iter().zip(expected) {
        let mut sorted = operations.to_vec();
        sorted.sort_unstable();
        let mut wanted = wanted.to_vec();
        wanted.sort_unstable();
        assert_eq!(sorted, wanted);
        assert!((ns / cost - 1.0).abs() < 1e-3, "{operations:?}: {ns}, not {cost}");
    }
    assert!(found[0].worst < 1e-3 && found[0].cells == 12, "{found:?}");
    let term = &found[0].terms[1];
    assert!(term.low <= term.ns && term.ns <= term.high && term.high / term.low < 1.01, "{term:?}");
}

#[test]
fn noise_is_in_the_residuals_and_costs_stay_near() {
    let wobble = |n: u64, tests: u64| 1.0 + 0.1 * ((n as f64).ln() * 7.3 + tests as f64).sin();
    let cells =
        lab(|n, tests| (20_000.0 + 15.0 * n as f64 + 6.0 * tests as f64) * wobble(n, tests));
    let found = &fitted(&cells)[0];
    assert!((0.01..0.1).contains(&found.typical) && found.worst < 0.25, "{found:?}");
    for (term, cost) in found.terms.iter().zip([3.0, 4.0, 20_000.0]) {
        assert!((term.ns / cost - 1.0).abs() < 0.3, "{term:?} is not about {cost}");
    }
}

#[test]
fn a_cost_that_would_be_negative_is_none_and_what_does_not_fit_is_seen() {
    // Fewer nanoseconds the more tests there are.
    let found = &fitted(&lab(|n, tests| 100.0 * n as f64 - 5.0 * tests as f64))[0];
    assert!(found.terms.iter().all(|term| term.ns >= 0.0) && found.terms[1].ns == 0.0, "{found:?}");
    assert!(found.worst > 0.05, "{found:?}");
    // A quadratic term that no count has.
    let found = &fitted(&lab(|n, _| 1e-3 * (n * n) as f64))[0];
    assert!(found.worst > 0.5 && found.worst_at.1 == 1_000_000, "{found:?}");
}

#[test]
fn too_few_cells_are_not_fitted() {
    let cells = lab(|n, tests| (n + tests) as f64);
    let few: Vec<Cell> = cells.into_iter().filter(|cell| cell.id.n == 1000).collect();
    assert!(fitted(&few).is_empty());
}

#[test]
fn what_outgrows_a_cache_costs_more_and_the_largest_n_is_foretold() {
    // A footprint of 16 bytes and some pairs per particle, against caches of 2^16 and 2^20 bytes.
    let caches = [("L2".to_string(), 1 << 16), ("L3".to_string(), 1 << 20)];
    let slow = |n: u64, tests: u64| {
        let footprint = (16 * n + 4 * tests) as f64;
        let doublings = |bytes: f64| (footprint / bytes).log2().max(0.0);
        let operations = (5 * n + tests) as f64;
        operations * (3.0 + doublings(65_536.0) + 4.0 * doublings(1_048_576.0))
    };
    let cells = lab_of(&[300, 1000, 3000, 10_000, 30_000, 100_000], slow);
    let cells: Vec<&Cell> = cells.iter().collect();
    let [with, without] = [&caches[..], &[]].map(|caches| fits(&series(&cells), caches).remove(0));
    let worst = |fit: &Fit| fit.held_out.iter().copied().fold(1.0, f64::max);
    assert_eq!(with.held_out.len(), 3);
    assert!(with.worst < 0.01 && worst(&with) < 1.3, "{with:?}");
    assert!(without.worst > 0.3 && worst(&without) > 1.5, "{without:?}");
    assert!(
        with.terms.iter().any(|term| matches!(&term.kind, Kind::Beyond(name, _) if name == "L3"))
    );
}
