use serde_json::json;

use super::*;
use crate::cells::testing::Lab;
use crate::record::folder::ledger::Process;

/// One row per span: seconds, cores used by others, cores taken by the host.
fn timed(spans: &[(f64, f64, f64)]) -> (Vec<Row>, Ledger) {
    let (mut rows, mut ledger) = (Vec::new(), Ledger::default());
    for (k, &(seconds, others, stolen)) in spans.iter().enumerate() {
        let id = format!("{k:08x}");
        let mut lab = Lab::new("e", "packed");
        lab.n(100 + k as u64).time(&[1, 2, 3]);
        rows.extend(lab.rows().into_iter().map(|row| Row { span: Some(id.clone()), ..row }));
        let span = Span {
            id: id.clone(),
            scene: format!("scene {k}"),
            seconds,
            cores: 2,
            others_s: others * seconds,
            stolen_s: stolen * seconds,
            ..Span::default()
        };
        ledger.spans.insert(id, span);
    }
    (rows, ledger)
}

#[test]
fn a_span_is_disturbed_by_a_tenth_of_a_core_or_more() {
    let span = |seconds, others_s| Span { seconds, others_s, cores: 2, ..Span::default() };
    let found = [span(2.0, 0.1), span(2.0, 1.0), span(0.5, 0.5)].map(|it| disturbance(&it));
    assert_eq!(found, [None, Some(0.5), None]);
}

fn doubts(spans: &[(f64, f64, f64)]) -> Vec<String> {
    let (rows, ledger) = timed(spans);
    Conditions::new([], &ledger, &rows).doubts
}

const DIRTY: &str = "the program was built from sources that were not committed";
const DEBUG: &str = "the program is a debug build";

#[test]
fn a_busy_machine_is_doubted_and_an_idle_one_is_not() {
    let others = "other processes used";
    let none: [String; 0] = [];
    assert_eq!(doubts(&[(5.0, 0.03, 0.01), (5.0, 0.05, 0.01)]), none);
    let words = format!("{others} 30% of a core (30% during scene 0)");
    assert_eq!(doubts(&[(5.0, 0.3, 0.0)]), [words]);
    assert_eq!(doubts(&[(5.0, 0.2, 0.0)]), [format!("{others} 20% of a core")]);
    let mut spans = vec![(5.0, 0.0, 0.0); 20];
    spans[3] = (5.0, 0.9, 0.1);
    let busy = format!("{others} 4.5% of a core (90% during scene 3)");
    let stolen = "the host took away 0.5% of a core (10% during scene 3)".to_string();
    assert_eq!(doubts(&spans), [busy, stolen]);
    // Clocks with 100 ticks per second cannot resolve a tenth of a second.
    assert_eq!(doubts(&[(0.1, 0.5, 0.1)]), none);
    let (rows, ledger) = timed(&[(2.0, 0.5, 0.1)]);
    let load = Conditions::new([], &ledger, &rows).load;
    assert_eq!(load, Load::Watched { seconds: 2.0, others: 0.5, stolen: 0.1 });
}

#[test]
fn a_short_run_is_judged_by_the_load_before_it_and_counts_are_not() {
    let (mut rows, ledger) = timed(&[(0.3, 0.9, 0.0), (0.3, 0.9, 0.0)]);
    let new = |rows: &[Row], load: &str| {
        let fields = json!({"dirty": false, "profile": "release", "load_average": load});
        let found = Conditions::new([&fields], &ledger, rows);
        (found.doubts, found.load)
    };
    assert_eq!(
        new(&rows, "7.5 3.1 1.0"),
        (vec!["the machine was busy before the run (load 7.5)".into()], Load::Before(7.5))
    );
    assert_eq!(new(&rows, "0.2 3.1 1.0"), (vec![], Load::Before(0.2)));
    rows.iter_mut().for_each(|row| (row.pass, row.time_ns) = (Pass::Count, None));
    assert_eq!(new(&rows, "7.5 3.1 1.0").0.len(), 0);
}

#[test]
fn a_quiet_machine_does_not_excuse_a_busy_one() {
    let (mut rows, ledger) = timed(&[(2.0, 0.24, 0.0), (100.0, 0.0, 0.0)]);
    for row in &mut rows {
        row.id.machine = Some(if row.id.n == 100 { "a" } else { "b" }.into());
    }
    let found = Conditions::new([], &ledger, &rows).doubts;
    assert_eq!(found, ["other processes used 24% of a core"]);
}

#[test]
fn rows_of_a_killed_run_have_no_known_load() {
    let (rows, mut ledger) = timed(&[(5.0, 0.0, 0.0), (5.0, 0.0, 0.0)]);
    ledger.spans.remove("00000001");
    let new = |ledger: &Ledger| Conditions::new([], ledger, &rows);
    let words = |rows| format!("what else the machine did is not known of {rows} rows of 6 timed");
    assert_eq!(new(&ledger).doubts, [words(3)]);
    assert_eq!(new(&Ledger::default()).doubts, [words(6)]);
}

#[test]
fn sources_and_builds_are_doubted() {
    let rows = Lab::new("e", "packed").time(&[1]).rows();
    let clean = json!({"dirty": false, "profile": "release", "revision": "a",
        "load_average": "0.56 1.34 1.29"});
    let with = |name: &str, value: Value| {
        let mut fields = clean.clone();
        fields[name] = value;
        Conditions::new([&clean, &fields], &Ledger::default(), &rows)
    };
    let good = with("revision", "b".into());
    assert_eq!((good.doubts, good.load), (vec![], Load::Before(0.56)));
    assert_eq!(with("dirty", true.into()).doubts, [DIRTY]);
    let debug = with("profile", "debug, release".into()).doubts;
    assert_eq!(debug, [DEBUG]);
    assert_eq!(
        with("load_average", "1.8 0.2 0.1".into()).doubts,
        ["the machine was busy before the run (load 1.8)"]
    );
    let merged = json!({"merged_from": ["x"], "revision": "a"});
    let found = Conditions::new([&merged, &clean], &Ledger::default(), &rows);
    assert_eq!(found.doubts.len(), 0);
    assert_eq!(Conditions::new([], &Ledger::default(), &rows), Conditions::default());
}

#[test]
fn another_build_at_work_is_doubted() {
    let mut rows = Lab::new("e", "packed").time(&[1, 2, 3]).rows();
    rows[0].process = Some("a".into());
    let build = [("profile", "debug"), ("sources", "changed")]
        .map(|(name, value)| (name.to_string(), value.to_string()))
        .into();
    let (id, mut ledger) = ("a".to_string(), Ledger::default());
    ledger.processes.insert(id.clone(), Process { id, build, ..Process::default() });
    let fields = json!({"dirty": false, "profile": "release"});
    let found = Conditions::new([&fields], &ledger, &rows).doubts;
    assert_eq!(found, [DIRTY, DEBUG]);
    rows[0].role = Role::Runner;
    assert_eq!(Conditions::new([&fields], &ledger, &rows).doubts.len(), 0);
}
