//! A short run of the campaign on moving particles (`crates/campaigns`).

use contactbench_campaigns::skin::pairs;
use contactbench_campaigns::tracking::trackers;
use contactbench_campaigns::{Plan, What};

const PLAN: Plan = Plan { pairs: 1, seed: 7 };

/// Runs each motion once in each dimension and arithmetic.
#[test]
fn safe_rules_miss_nothing_in_any_motion_and_the_control_does() {
    let table = trackers(PLAN);
    let of = |safe, what| table.total(safe).get(what);
    assert_eq!(table.errors(), 0, "\n{}", table.text());
    let (built, frames) = (of(true, What::Built), of(true, What::Frames));
    assert!(of(true, What::Pairs) > 4_000_000 && built < frames, "\n{}", table.text());
    let (missed, pairs) = (of(false, What::Missed), of(false, What::Pairs));
    assert!(missed > pairs / 100, "\n{}", table.text());
}

#[test]
fn pairs_at_the_limit_of_the_skin_are_found() {
    let table = pairs(PLAN);
    let of = |safe, what| table.total(safe).get(what);
    assert_eq!(table.errors(), 0, "\n{}", table.text());
    // Rules without a guarantee do miss contacts here.
    assert!(of(false, What::Missed) > 50, "\n{}", table.text());
    assert!(of(true, What::Built) < of(true, What::Frames), "\n{}", table.text());
    for name in ["line", "thin"] {
        assert!(table.0[&(name.into(), "pairs".into())].get(What::Came) > 500, "{name}");
    }
}
