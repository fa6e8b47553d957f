//! A short run of the campaign on bodies that move (`crates/campaigns`).

use contactbench_campaigns::moving::{Plan, couples, courses};

/// One course of each motion, in each dimension and arithmetic.
#[test]
fn safe_rules_miss_nothing_in_any_motion_and_the_control_does() {
    let table = courses(Plan { pair_steps: 1, seed: 7 });
    let (safe, control) = (table.total(true), table.total(false));
    assert_eq!(table.errors(), 0, "\n{}", table.text());
    assert!(safe.pair_steps > 4_000_000 && safe.built < safe.frames, "\n{}", table.text());
    assert!(control.missed > control.pair_steps / 100, "\n{}", table.text());
}

#[test]
fn couples_at_the_limit_of_the_skin_are_found() {
    let table = couples(Plan { pair_steps: 1, seed: 7 });
    let (safe, control) = (table.total(true), table.total(false));
    assert_eq!(table.errors(), 0, "\n{}", table.text());
    // Safe but for rounding.
    assert!(control.missed > 50, "\n{}", table.text());
    assert!(safe.built < safe.frames, "\n{}", table.text());
    assert!(["line", "thin"].iter().all(|name| table.came[name] > 500), "{:?}", table.came);
}
