use crate::sections::claims::evidence;
use contactbench_record::cells;
use contactbench_record::cells::Cell;
use contactbench_record::cells::testing::{self, Lab};
use contactbench_record::findings::claim::*;
use contactbench_record::findings::trust::coverage::{Coverage, Scope};
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

fn judge(lab: &Lab, claim: &str) -> (Verdict, String) {
    let experiment = testing::experiment(&format!("[[claim]]\nname = 'c'\n{claim}"));
    let cells = cells::cells(&lab.rows());
    let own: Vec<&Cell> = cells.iter().collect();
    let coverage = Coverage::new(&experiment, &own, &Scope::default());
    let verdict = verdicts(&experiment, &cells, &coverage).remove(0);
    let words = evidence(&verdict.evidence);
    (verdict, words)
}

/// Each line: kind; fields; detector; verdict; part of the evidence.
const KINDS: &str = "
constant; value = 'list_push / n', within = 0.01; nbs; holds; from 2 to 2.003 (n = 100 to 30000)
constant; value = 'list_push / n', within = 0.001; nbs; FAILS; 2 at n = 100
constant; value = 'list_step'; nbs; holds; always 0
constant; value = 'list_push - 200'; nbs; FAILS; not positive
equal; value = 'peak_bytes', to = '20 * n + 100'; nbs; holds; all 6 cells
equal; value = 'peak_bytes', to = '20 * n', within = 0.01; nbs; FAILS; 2100, 5.0% off 2000
equal; value = 'peak_bytes', to = '0'; nbs; FAILS; off 0
at-most; value = 'list_push', to = '3 * n'; nbs; holds; 601 (limit 900), at n = 300
at-most; value = 'list_push', to = '2 * n + 4'; nbs; FAILS; above 60004
model; value = 'contact_test', model = 'N'; nbs; holds; exponent 1.000
model; value = 'contact_test', model = 'N^2'; nbs; FAILS; N fits, not N²
model; value = 'contact_test', model = 'N'; ; FAILS; direct: exponent
model; value = 'n ^ 1.5', model = 'N log N'; nbs; FAILS; has 1.118: 0.382 off, 0.03 allowed
model; value = 'list_push * n ^ 0.3', model = 'N'; nbs; FAILS; 0.300 off
model; value = 'list_push * n ^ 0.05', model = 'N'; nbs; FAILS; 0.050 off
model; value = 'n ^ 1.5', model = 'N log N'; nbs', n = '<= 3000; not shown; undecided
faster; than = 'direct'; nbs; holds; 0.60 (0.60 to 0.60) at n = 100
faster; than = 'nbs'; direct; FAILS; not faster in 6
faster; than = 'quick'; nbs; not shown; no cell has times
equal; value = 'list_pusch', to = 'n'; ; FAILS; unknown variable 'list_pusch'
equal; value = 'n', to = 'n'; x; not shown; no cell matches
equal; value = 'n', to = 'n', where = { spin = 1 }; ; FAILS; spin
";

#[test]
fn each_kind_holds_and_fails() {
    for line in KINDS.trim().lines() {
        let [kind, fields, cells, status, words] = line.splitn(5, "; ").collect::<Vec<_>>()[..]
        else {
            panic!("{line}")
        };
        let mut claim = format!("kind = '{kind}'\n{}\n", fields.replace(", ", "\n"));
        if !cells.is_empty() {
            claim += &format!("where = {{ detector = '{cells}' }}");
        }
        let (verdict, evidence) = judge(&lab(), &claim);
        assert_eq!(verdict.status.name(), status, "{line}: {evidence}");
        assert!(evidence.contains(words), "{line}: {evidence}");
        assert_eq!(verdict.machine_independent, kind != "faster");
    }
}

#[test]
fn wrong_cells_fail_and_missing_ones_are_named() {
    let claim = "kind = 'equal'\nvalue = 'contact_test'\nto = 'n * (n - 1) / 2'\nwhere = { \
                 detector = 'direct' }";
    let mut lab = lab();
    lab.detector("direct").n(100_000).fail(Pass::Count, Outcome::Timeout, "30 s");
    let (verdict, words) = judge(&lab, claim);
    assert!(words.contains("1 of 7 cells left out (timeout)"), "{words}");
    assert_eq!(verdict.status, Status::Holds);
    lab.fail(Pass::Memory, Outcome::Wrong, "digest");
    let (verdict, words) = judge(&lab, claim);
    assert!(words.contains("wrong answers in 1 cell"), "{words}");
    assert!(verdict.status == Status::Fails && any_failed(&[verdict]));
}

#[test]
fn a_straddling_ratio_cannot_tell() {
    let mut lab = Lab::new("e", "packed");
    lab.detector("a").time(&[90, 110, 95, 105, 100, 100, 90, 110]).detector("b").time(&[100; 8]);
    let (verdict, _) = judge(&lab, "kind = 'faster'\nthan = 'b'\nwhere = { detector = 'a' }");
    assert!(verdict.status == Status::NotShown && !any_failed(&[verdict]));
}

#[test]
fn how_many_times_as_fast_is_counted() {
    let mut lab = Lab::new("e", "packed");
    lab.detector("a").time(&[25; 8]).detector("b").time(&[100; 8]);
    for (by, status) in [("0.1", "holds"), ("3.9", "holds"), ("4.1", "FAILS"), ("1", "holds")] {
        let claim = format!("kind = 'faster'\nthan = 'b'\nby = {by}\nwhere = {{ detector = 'a' }}");
        let (verdict, words) = judge(&lab, &claim);
        assert_eq!(verdict.status.name(), status, "{by}");
        assert!(words.contains("0.25 (0.25 to 0.25) times the time of b"), "{words}");
        assert_eq!(words.contains("not 4.1 times as fast"), by == "4.1", "{words}");
    }
}
