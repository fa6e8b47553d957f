//! Claims of every kind, holding and failing, on made-up rows.

use crate::sections::claims::evidence;
use contactbench_record::cells;
use contactbench_record::cells::Cell;
use contactbench_record::cells::testing;
use contactbench_record::cells::testing::Lab;
use contactbench_record::experiment::Document;
use contactbench_record::experiment::Experiment;
use contactbench_record::findings::claim::*;
use contactbench_record::findings::coverage::Coverage;
use contactbench_record::findings::coverage::Scope;
use contactbench_record::record::row::{Outcome, Pass};

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

fn judge(lab: &Lab, claim: &str) -> Verdict {
    let experiment = testing::experiment(&format!("[[claim]]\nname = 'c'\n{claim}"));
    of_claims(&experiment, &cells::cells(&lab.rows())).remove(0)
}

#[test]
fn each_kind_holds_and_fails() {
    use Status::*;
    let nbs = "where = { detector = 'nbs' }";
    for (claim, status, words) in [
        (
            format!("kind = 'constant'\nvalue = 'list_push / n'\nwithin = 0.01\n{nbs}"),
            Holds,
            "2 to 2.003 over n = 100..30000 (0.2%)",
        ),
        (
            format!("kind = 'constant'\nvalue = 'list_push / n'\nwithin = 0.001\n{nbs}"),
            Fails,
            "lowest at n = 100, highest at n = 300",
        ),
        (format!("kind = 'constant'\nvalue = 'list_step'\n{nbs}"), Holds, "0 to 0"),
        (format!("kind = 'constant'\nvalue = 'list_push - 200'\n{nbs}"), Fails, "not positive"),
        (
            format!("kind = 'equal'\nvalue = 'peak_bytes'\nto = '20 * n + 100'\n{nbs}"),
            Holds,
            "exactly, in 6 cells",
        ),
        (
            format!("kind = 'equal'\nvalue = 'peak_bytes'\nto = '20 * n'\nwithin = 0.01\n{nbs}"),
            Fails,
            "worst: 2100 differs from 2000 by 5.0% at n = 100",
        ),
        (format!("kind = 'equal'\nvalue = 'peak_bytes'\nto = '0'\n{nbs}"), Fails, "differs from 0"),
        (
            format!("kind = 'at-most'\nvalue = 'list_push'\nto = '3 * n'\n{nbs}"),
            Holds,
            "nearest: 601 against 900 at n = 300",
        ),
        (
            format!("kind = 'at-most'\nvalue = 'list_push'\nto = '2 * n + 4'\n{nbs}"),
            Fails,
            "in 1 of 6 cells; worst: 60005 exceeds 60004",
        ),
        (
            format!("kind = 'model'\nvalue = 'contact_test'\nmodel = 'N'\n{nbs}"),
            Holds,
            "exponent 1.000",
        ),
        (
            format!("kind = 'model'\nvalue = 'contact_test'\nmodel = 'N^2'\n{nbs}"),
            Fails,
            "N fits, not N²",
        ),
        ("kind = 'model'\nvalue = 'contact_test'\nmodel = 'N'".into(), Fails, "direct: exponent"),
        (
            format!("kind = 'model'\nvalue = 'n ^ 1.5'\nmodel = 'N log N'\n{nbs}"),
            Fails,
            "1.500 over n = 1000..30000, where N log N has 1.118: 0.382 off, 0.03 allowed",
        ),
        (
            format!("kind = 'model'\nvalue = 'list_push * n ^ 0.3'\nmodel = 'N'\n{nbs}"),
            Fails,
            "0.300 off",
        ),
        (
            format!("kind = 'model'\nvalue = 'list_push * n ^ 0.05'\nmodel = 'N'\n{nbs}"),
            Fails,
            "0.050 off",
        ),
        (
            "kind = 'model'\nvalue = 'n ^ 1.5'\nmodel = 'N log N'\n\
             where = { detector = 'nbs', n = '<= 3000' }"
                .into(),
            NotShown,
            "undecided",
        ),
        (
            "kind = 'faster'\nthan = 'direct'\nwhere = { detector = 'nbs' }".into(),
            Holds,
            "nearest to the limit 0.60 (0.60 to 0.60) at n = 100",
        ),
        (
            "kind = 'faster'\nthan = 'nbs'\nwhere = { detector = 'direct' }".into(),
            Fails,
            "not faster in 6 of them",
        ),
        (
            "kind = 'faster'\nthan = 'quick'\nwhere = { detector = 'nbs' }".into(),
            NotShown,
            "no cell has times",
        ),
        (
            "kind = 'equal'\nvalue = 'list_pusch'\nto = 'n'".into(),
            Fails,
            "unknown variable 'list_pusch'",
        ),
        (
            "kind = 'equal'\nvalue = 'n'\nto = 'n'\nwhere = { detector = 'x' }".into(),
            NotShown,
            "no cell matches",
        ),
        ("kind = 'equal'\nvalue = 'n'\nto = 'n'\nwhere = { spin = 1 }".into(), Fails, "spin"),
    ] {
        let verdict = judge(&lab(), &claim);
        assert_eq!(verdict.status, status, "{claim}: {}", evidence(&verdict.evidence));
        assert!(
            evidence(&verdict.evidence).contains(words),
            "{claim}: {}",
            evidence(&verdict.evidence)
        );
        assert_eq!(verdict.machine_independent, !claim.contains("faster"));
    }
}

#[test]
fn wrong_cells_fail_and_missing_ones_are_named() {
    let claim = "kind = 'equal'\nvalue = 'contact_test'\nto = 'n * (n - 1) / 2'\nwhere = { \
                 detector = 'direct' }";
    let mut lab = lab();
    lab.detector("direct").n(100_000).fail(Pass::Count, Outcome::Timeout, "30 s");
    let verdict = judge(&lab, claim);
    assert_eq!(verdict.status, Status::Holds);
    assert!(
        evidence(&verdict.evidence).contains("without 1 of 7 cells: 1 timeout"),
        "{}",
        evidence(&verdict.evidence)
    );
    lab.fail(Pass::Memory, Outcome::Wrong, "digest");
    let verdict = judge(&lab, claim);
    assert_eq!(verdict.status, Status::Fails);
    assert!(
        evidence(&verdict.evidence).contains("wrong answers in 1 cell"),
        "{}",
        evidence(&verdict.evidence)
    );
    assert!(any_failed(&[verdict]));
}

#[test]
fn a_straddling_ratio_cannot_tell() {
    let mut lab = Lab::new("e", "packed");
    lab.detector("a").time(&[90, 110, 95, 105, 100, 100, 90, 110]).detector("b").time(&[100; 8]);
    let verdict = judge(&lab, "kind = 'faster'\nthan = 'b'\nwhere = { detector = 'a' }");
    assert_eq!(verdict.status, Status::NotShown);
    assert!(!any_failed(&[verdict]));
}

/// Four times as fast is so many times as fast, and no more.
#[test]
fn how_many_times_as_fast_is_counted() {
    let mut lab = Lab::new("e", "packed");
    lab.detector("a").time(&[25; 8]).detector("b").time(&[100; 8]);
    for (by, status) in [
        ("0.1", Status::Holds),
        ("3.9", Status::Holds),
        ("4.1", Status::Fails),
        ("1", Status::Holds),
    ] {
        let claim = format!("kind = 'faster'\nthan = 'b'\nby = {by}\nwhere = {{ detector = 'a' }}");
        let verdict = judge(&lab, &claim);
        assert_eq!(verdict.status, status, "{by}");
        let words = evidence(&verdict.evidence);
        assert!(words.contains("0.25 to 0.25 times the time of b"), "{words}");
        assert_eq!(words.contains("not 4.1 times as fast in 1"), by == "4.1", "{words}");
    }
    for by in ["0", "-1", "inf", "nan"] {
        let head = "name = 'e'\ntitle = 't'\nquestion = '?'\nreading = '-'\ndetectors = ['nbs']\n";
        let scene = "[[scene]]\nname = 'packed'\nn = 10\n";
        let text = format!(
            "{head}{scene}[[claim]]\nname = 'c'\nkind = 'faster'\nthan = 'nbs'\nby = {by}\n"
        );
        let error = Document::read(&text).err().unwrap();
        assert!(format!("{error:#}").contains("it must be a finite number over 0"), "{error:#}");
    }
}

fn of_claims(experiment: &Experiment, cells: &[Cell]) -> Vec<Verdict> {
    let own: Vec<&Cell> = cells.iter().collect();
    verdicts(experiment, cells, &Coverage::new(experiment, &own, &Scope::default()))
}
