use super::Status::*;
use super::*;
use crate::cells::cells;
use crate::cells::testing::{self, Lab};
use crate::experiment::Planned;
use crate::record::row::Pass;

fn lab() -> Lab {
    let mut lab = Lab::new("e", "packed");
    for (k, n) in [100, 300, 1000, 3000, 10_000, 30_000].into_iter().enumerate() {
        lab.n(n);
        lab.detector("direct").count(&[("contact_test", n * (n - 1) / 2)]).time(&[n * n; 15]);
        lab.detector("nbs")
            .count(&[("list_push", 2 * n + k as u64), ("contact_test", 6 * n)])
            .memory(20 * n + 100, 20 * n + 100);
        lab.time(&[60 * n; 15]);
        lab.detector("nothing").fail(Pass::Time, Outcome::Control, "");
    }
    lab
}

fn judge(lab: &Lab, experiment: &Experiment) -> Vec<Verdict> {
    let cells = cells(&lab.rows());
    let own: Vec<&Cell> = cells.iter().collect();
    verdicts(experiment, &cells, &Coverage::new(experiment, &own))
}

fn one(lab: &Lab, claim: &str) -> Verdict {
    let experiment = testing::experiment(&format!("[[claim]]\nname = 'c'\n{claim}"));
    judge(lab, &experiment).remove(0)
}

/// Each line: kind; fields; detector; verdict.
const KINDS: &str = "
constant; value = 'list_push / n', within = 0.01; nbs; holds
constant; value = 'list_push / n', within = 0.001; nbs; FAILS
constant; value = 'list_step'; nbs; holds
constant; value = 'list_push - 200'; nbs; FAILS
equal; value = 'peak_bytes', to = '20 * n + 100'; nbs; holds
equal; value = 'peak_bytes', to = '20 * n', within = 0.01; nbs; FAILS
equal; value = 'peak_bytes', to = '0'; nbs; FAILS
at-most; value = 'list_push', to = '3 * n'; nbs; holds
at-most; value = 'list_push', to = '2 * n + 4'; nbs; FAILS
model; value = 'contact_test', model = 'N'; nbs; holds
model; value = 'contact_test', model = 'N^2'; nbs; FAILS
model; value = 'contact_test', model = 'N'; ; FAILS
model; value = 'n ^ 1.5', model = 'N log N'; nbs; FAILS
model; value = 'list_push * n ^ 0.3', model = 'N'; nbs; FAILS
model; value = 'list_push * n ^ 0.05', model = 'N'; nbs; FAILS
model; value = 'n ^ 1.5', model = 'N log N'; nbs', n = '<= 3000; not shown
faster; than = 'direct'; nbs; holds
faster; than = 'nbs'; direct; FAILS
faster; than = 'quick'; nbs; not shown
equal; value = 'n', to = 'n'; x; not shown
equal; value = 'n', to = 'n', where = { spin = 1 }; ; not shown
";

#[test]
fn each_kind_holds_and_fails() {
    for line in KINDS.trim().lines() {
        let [kind, fields, cells, status] = line.splitn(4, "; ").collect::<Vec<_>>()[..] else {
            panic!("{line}")
        };
        let mut claim = format!("kind = '{kind}'\n{}\n", fields.replace(", ", "\n"));
        if !cells.is_empty() {
            claim += &format!("where = {{ detector = '{cells}' }}");
        }
        let verdict = one(&lab(), &claim);
        assert_eq!(verdict.evidence.status.name(), status, "{line}: {:?}", verdict.evidence);
        assert_eq!(verdict.claim.is_check(), kind != "faster");
    }
}

#[test]
fn wrong_cells_fail_and_missing_ones_are_counted() {
    let claim = "kind = 'equal'\nvalue = 'contact_test'\nto = 'n * (n - 1) / 2'\nwhere = { \
                 detector = 'direct' }";
    let mut lab = lab();
    lab.detector("direct").n(100_000).fail(Pass::Count, Outcome::Timeout, "30 s");
    let verdict = one(&lab, claim);
    let Evidence { status, left_out, cells, .. } = verdict.evidence;
    assert_eq!((status, left_out, cells), (Holds, [(Some(Outcome::Timeout), 1)].into(), 7));
    lab.fail(Pass::Memory, Outcome::Wrong, "digest");
    assert!(any_failed(&[one(&lab, claim)]));
}

#[test]
fn intervals_of_times_decide() {
    let mut lab = Lab::new("e", "packed");
    for (n, times) in [(10, [1000, 1010, 1020, 1030, 1040, 1050]), (20, [2400; 6])] {
        lab.detector("nbs").n(n).time(&times);
    }
    // Per particle: 100 to 105 and 120, so the largest is 14% to 20% above the smallest.
    let constant = |within| format!("kind = 'constant'\nvalue = 'time_ns / n'\nwithin = {within}");
    let limit = |to| format!("kind = 'at-most'\nvalue = 'time_ns / n'\nto = {to}");
    for (claim, status) in [
        (constant("0.21"), Holds),
        (constant("0.17"), NotShown),
        (constant("0.14"), Fails),
        (limit("120"), Holds),
        (limit("119"), Fails),
        (limit("102") + "\nwhere = { n = 10 }", NotShown),
    ] {
        assert_eq!(
            one(&lab, &claim).evidence.status,
            status,
            "{claim}: {:?}",
            one(&lab, &claim).evidence
        );
    }
    lab.detector("few").time(&[1000; 4]);
    let few = one(&lab, &(limit("1e9") + "\nwhere = { detector = 'few' }"));
    assert_eq!(few.evidence.status, NotShown);
}

#[test]
fn a_limit_may_come_from_another_dimension() {
    let mut lab = Lab::new("e", "packed");
    for (dim, per_particle) in [(2, 100), (3, 131)] {
        lab.scene("packed", dim).param("lattice", if dim == 2 { "square" } else { "cubic" });
        for n in [10, 1000] {
            lab.detector("nbs").n(n).count(&[("list_step", n * per_particle)]);
        }
    }
    for (factor, status) in [("1.31", Holds), ("1.3", Fails)] {
        let claim = format!(
            "set = 'published'\nkind = 'at-most'\nvalue = 'list_step'\nto = '{factor} * \
             list_step'\nthan-dim = 2\nwhere = {{ dim = 3 }}"
        );
        let verdict = one(&lab, &claim);
        assert_eq!(verdict.evidence.status, status, "{:?}", verdict.evidence);
        assert!(!any_failed(&[verdict]));
        let own = one(&lab, &claim.replace("published", "before"));
        assert_eq!(any_failed(&[own]), status == Fails);
    }
}

#[test]
fn a_time_claim_needs_a_clear_ratio() {
    let mut lab = Lab::new("e", "packed");
    lab.detector("a").time(&[90, 110, 95, 105, 100, 100, 90, 110]).detector("b").time(&[100; 8]);
    lab.detector("c").time(&[25; 8]);
    for (name, by, status) in
        [("a", "1", NotShown), ("c", "0.1", Holds), ("c", "3.9", Holds), ("c", "4.1", Fails)]
    {
        let named = format!("where = {{ detector = '{name}' }}");
        let verdict = one(&lab, &format!("kind = 'faster'\nthan = 'b'\nby = {by}\n{named}"));
        assert_eq!(verdict.evidence.status, status, "{name} {by}");
        assert!(!any_failed(&[verdict]));
    }
}

#[test]
fn a_slower_cell_among_many_may_be_chance() {
    let evidence = |slow: u64, blocks: usize| {
        let mut lab = Lab::new("e", "packed");
        for n in 1..=30 {
            let time = if n > slow { 90 } else { 110 };
            // An undecided cell with a wider interval is not the evidence of a failure.
            let wide: Vec<u64> = (0..blocks as u64).map(|k| 40 + 120 * (k % 2)).collect();
            let times = if n == 30 { wide } else { vec![time; blocks] };
            lab.n(n).detector("a").time(&times).detector("b").time(&vec![100; blocks]);
        }
        one(&lab, "kind = 'faster'\nthan = 'b'\nwhere = { detector = 'a' }").evidence
    };
    for (slow, blocks, status) in
        [(0, 15, NotShown), (1, 8, NotShown), (1, 15, Fails), (2, 8, NotShown), (3, 8, Fails)]
    {
        let Evidence { status: found, found: words, .. } = evidence(slow, blocks);
        assert_eq!(found, status, "{slow} {blocks}: {words}");
        assert_eq!(words.contains("worst: 1.10 (1.10 to 1.10)"), slow > 0, "{words}");
    }
}

const ALL: [u64; 9] = [1, 2, 5, 10, 20, 50, 100, 150, 200];

/// A plan of nine spacings, two detectors and seven blocks.
fn planned(more: &str) -> Experiment {
    let text = format!(
        "blocks = 7\n{more}[[claim]]\nname = 'flat'\nkind = 'constant'\nvalue = \
         'list_push'\nwhere = {{ detector = 'nbs', s = '>= 2' }}\n[[claim]]\nname = \
         'fast'\nkind = 'faster'\nthan = 'sorting'\nwhere = {{ detector = 'nbs' }}\n"
    );
    let params = ALL.map(|s| [("s".to_string(), s.into())].into());
    let planned = testing::planned("pack-c", &["nbs", "sorting"], &params);
    Experiment { planned, ..testing::experiment(&text) }
}

fn measured(spacings: &[u64], blocks: usize) -> Lab {
    let mut lab = Lab::new("e", "pack-c");
    for &s in spacings {
        lab.param("s", s);
        for (name, time) in [("nbs", 100), ("sorting", 300)] {
            lab.detector(name).count(&[("list_push", 200)]).memory(9, 9).time(&vec![time; blocks]);
        }
    }
    lab
}

/// Returns the verdicts, and the numbers of missing, cut and short cells.
fn covered(lab: &Lab, experiment: &Experiment) -> ([Status; 2], [usize; 3]) {
    let cells = cells(&lab.rows());
    let gaps = Coverage::new(experiment, &cells.iter().collect::<Vec<_>>()).gaps();
    assert_eq!(gaps.of, 2 * ALL.len());
    let found = judge(lab, experiment);
    (
        [found[0].evidence.status, found[1].evidence.status],
        [gaps.missing.len(), gaps.cut, gaps.short],
    )
}

#[test]
fn a_claim_holds_over_all_that_is_planned() {
    let plan = planned("");
    assert_eq!(covered(&measured(&ALL, 7), &plan), ([Holds; 2], [0, 0, 0]));
    let part = &mut measured(&ALL[..5], 7);
    assert_eq!(covered(part, &plan), ([NotCovered; 2], [8, 0, 0]));
    let gaps = judge(part, &plan)[0].evidence.uncovered.clone().unwrap();
    assert_eq!((gaps.of, &*gaps.missing[0]), (8, "s = 50"));
    // A failure in the measured part is final.
    part.param("s", 50).detector("nbs").count(&[("list_push", 900)]);
    assert_eq!(covered(part, &plan).0, [Fails, NotCovered]);
    assert_eq!(covered(&measured(&ALL, 3), &plan), ([Holds, NotCovered], [0, 18, 18]));
    let budget = planned("block-budget-s = 1\n");
    assert_eq!(covered(&measured(&ALL, 6), &budget), ([Holds; 2], [0, 0, 18]));
    assert_eq!(covered(&measured(&ALL, 5), &budget), ([Holds, NotCovered], [0, 18, 18]));
    assert_eq!(covered(&measured(&[3, 4], 7), &plan), ([NotCovered; 2], [18, 0, 0]));
    // A refusal is an answer, but a subject that could not start is missing.
    let mut ended = measured(&ALL[..8], 7);
    ended.param("s", 200).detector("nbs").fail(Pass::Count, Outcome::Refused, "why");
    ended.detector("sorting").fail(Pass::Count, Outcome::Unavailable, "why");
    assert_eq!(covered(&ended, &plan), ([Holds, NotCovered], [1, 0, 0]));
}

/// File scenes are named from the folder of the experiment, and runners choose their arithmetic.
#[test]
fn files_and_runners_are_known_again() {
    let path = [("path".to_string(), "./data/discs.csv".into())].into();
    let planned = testing::planned("file", &["nbs", "theirs"], &[path]);
    let planned = Planned { own_n: ["file".into()].into(), ..planned };
    let experiment = Experiment { planned, ..testing::experiment("blocks = 0\n") };
    for (path, missing) in [("/home/a/./data/discs.csv", 0), ("/home/a/other/discs.csv", 2)] {
        let mut lab = Lab::new("e", "file");
        lab.n(77).param("path", path).detector("nbs").count(&[]).memory(1, 1);
        lab.detector("theirs").arithmetic("f64").count(&[]).memory(1, 1);
        let cells = cells(&lab.rows());
        let coverage = Coverage::new(&experiment, &cells.iter().collect::<Vec<_>>());
        assert_eq!((coverage.gaps().missing.len(), coverage.outside), (missing, 0));
    }
}
