//! A short run of the near-tangent campaign (`crates/campaigns`): no error in exact
//! arithmetic, and many without it.

use contactbench_campaigns::boxes::{boxes, detectors};
use contactbench_campaigns::predicate::run as predicate;
use contactbench_campaigns::{Counts, Plan, Totals, What};

const PLAN: Plan = Plan { pairs: 30_000, seed: 7 };

/// Checks that no row has errors, and that each row has more than `least` overlapping and separate
/// pairs. Returns the sum of the rows.
fn right(table: &Totals, least: u64) -> Counts {
    assert_eq!(table.errors(), 0, "\n{}", table.text());
    for (row, counts) in &table.0 {
        let seen = [What::Overlap, What::Apart].map(|what| counts.get(what));
        assert!(seen.iter().all(|&seen| seen > least), "{row:?}\n{}", table.text());
    }
    table.total(true)
}

#[test]
fn the_contact_test_is_right_on_every_family() {
    let table = predicate(PLAN);
    let sum = right(&table, 150);
    assert!(sum.get(What::Pairs) >= PLAN.pairs && sum.get(What::Sampled) > 30);
    assert!(sum.get(What::Tangent) > 1_500, "\n{}", table.text());
    // Filters must leave most of these pairs to exact arithmetic, and f64 must decide some wrongly.
    assert!(sum.get(What::Exact) > PLAN.pairs / 2, "\n{}", table.text());
    assert!(sum.get(What::RoundedWrong) > 3_000, "\n{}", table.text());
}

#[test]
fn detectors_neither_lose_nor_add_nor_repeat_a_pair() {
    let table = detectors(Plan { pairs: 2 * PLAN.pairs, ..PLAN });
    let sum = right(&table, 10);
    let (pairs, wrong) = (sum.get(What::Pairs), sum.get(What::RoundedWrong));
    assert!(pairs >= PLAN.pairs && wrong > 30, "\n{}", table.text());
    let table = boxes(Plan { pairs: 10 * PLAN.pairs, ..PLAN });
    let sum = right(&table, 25);
    assert!(table.0.values().all(|counts| counts.get(What::Tangent) > 10), "\n{}", table.text());
    let (exact, wrong) = (sum.get(What::Exact), sum.get(What::RoundedWrong));
    assert!(wrong > 500 && exact > 50_000, "\n{}", table.text());
}
