//! A short run of the near-tangent campaign (`crates/campaigns`): no error in exact
//! arithmetic, and many without it.

use contactbench::contact::Test;
use contactbench_campaigns::near_tangent::counts::What;
use contactbench_campaigns::near_tangent::{Plan, boxes, detectors, predicate, table, total};

const PLAN: Plan = Plan { pairs: 30_000, seed: 7, test: Test::Exact };

#[test]
fn the_contact_test_is_right_on_every_family() {
    let lines = predicate(PLAN);
    for line in &lines {
        assert_eq!(line.counts.errors(), 0, "\n{}", table(&lines));
        let (apart, overlap) = (line.counts.get(What::Apart), line.counts.get(What::Overlap));
        assert!(
            apart > 150 && overlap > 150,
            "{} in {}D is all of one kind\n{}",
            line.name,
            line.dim,
            table(&lines)
        );
    }
    let sum = total(&lines);
    assert!(sum.get(What::Pairs) >= PLAN.pairs && sum.get(What::Sampled) > 30);
    assert!(sum.get(What::Tangent) > 1_500, "\n{}", table(&lines));
    assert!(
        sum.get(What::Exact) > PLAN.pairs / 2,
        "these couples must reach exact arithmetic\n{}",
        table(&lines)
    );
    assert!(
        sum.get(What::RoundedWrong) > 3_000,
        "these couples must mislead f64\n{}",
        table(&lines)
    );
}

#[test]
fn detectors_neither_lose_nor_add_nor_repeat_a_couple_on_the_borders_of_cells() {
    let lines = detectors(Plan { pairs: 2 * PLAN.pairs, ..PLAN });
    let sum = total(&lines);
    assert_eq!(sum.errors(), 0, "\n{}", table(&lines));
    assert!(
        sum.get(What::Pairs) >= PLAN.pairs / 10 && sum.get(What::RoundedWrong) > 30,
        "\n{}",
        table(&lines)
    );
}

#[test]
fn detectors_in_boxes_neither_lose_nor_add_nor_repeat_a_couple() {
    let lines = boxes(Plan { pairs: 20 * PLAN.pairs, ..PLAN });
    let sum = total(&lines);
    assert_eq!(sum.errors(), 0, "\n{}", table(&lines));
    for line in &lines {
        let seen = [What::Tangent, What::Overlap, What::Apart].map(|what| line.counts.get(what));
        assert!(
            seen[0] > 20 && seen[1] > 100 && seen[2] > 100,
            "{} in {}D are all of one kind\n{}",
            line.name,
            line.dim,
            table(&lines)
        );
    }
    let wrong = sum.get(What::RoundedWrong);
    assert!(wrong > 1_000 && sum.get(What::Exact) > 50_000, "\n{}", table(&lines));
}

/// The campaign can fail: with rounded decisions it does, in all parts.
#[test]
fn rounded_decisions_are_found_out() {
    let plan = Plan { pairs: 10_000, test: Test::Rounded, ..PLAN };
    let (predicate, detectors) =
        (total(&predicate(plan)), total(&detectors(Plan { pairs: 2 * plan.pairs, ..plan })));
    assert!(predicate.get(What::Missed) > 500 && predicate.get(What::Spurious) > 500);
    assert!(detectors.get(What::Missed) > 20 && detectors.get(What::Spurious) > 500);
    let boxes = total(&boxes(Plan { pairs: 20 * plan.pairs, ..plan }));
    assert!(boxes.get(What::Missed) > 20 && boxes.get(What::Spurious) > 500);
}
