use crate::sections::claims::evidence;
use crate::sections::trust::coverage::{partial, whole_or_partial};
use contactbench_record::cells;
use contactbench_record::cells::Cell;
use contactbench_record::cells::testing::{self, Lab};
use contactbench_record::experiment::{Claim, Experiment, Planned};
use contactbench_record::findings::claim::Status::{self, *};
use contactbench_record::findings::claim::{Verdict, verdicts};
use contactbench_record::findings::trust::coverage::*;
use contactbench_record::record::row::{Outcome, Pass};
use serde_json::{Value, json};

const ALL: [u64; 9] = [1, 2, 5, 10, 20, 50, 100, 150, 200];

/// A plan of nine spacings (a quick run takes four), two detectors and seven blocks.
fn experiment(more: &str) -> Experiment {
    let text = format!(
        "name = 'e'\ntitle = 't'\nquestion = '?'\nreading = '-'\nblocks = 7\ndetectors = ['nbs', \
         'sorting']\n{more}[[scene]]\nname = 'pack-c'\nn = 100\ns = [1, 2, 5, 10, 20, 50, 100, \
         150, 200]\nquick.s = [1, 2, 50, 200]\n[[claim]]\nname = 'flat'\nkind = 'constant'\nvalue \
         = 'list_push'\nwhere = {{ detector = 'nbs', s = '>= 2' }}\n[[claim]]\nname = \
         'fast'\nkind = 'faster'\nthan = 'sorting'\nwhere = {{ detector = 'nbs' }}\n"
    );
    let scene = |&s: &u64| [("diameter", 1), ("s", s)].map(|(k, v)| (k.into(), v.into())).into();
    let of = |all: &[u64]| {
        let params: Vec<_> = all.iter().map(scene).collect();
        testing::planned("pack-c", &["nbs", "sorting"], &params)
    };
    let planned = Planned { quick: of(&[1, 2, 50, 200]).quick, ..of(&ALL) };
    Experiment { planned, ..testing::read(&text) }
}

fn lab(spacings: &[u64], blocks: usize) -> Lab {
    let mut lab = Lab::new("e", "pack-c");
    for &s in spacings {
        lab.param("diameter", 1).param("s", s);
        for (name, time) in [("nbs", 100), ("sorting", 300)] {
            lab.detector(name).count(&[("list_push", 200)]).memory(9, 9).time(&vec![time; blocks]);
        }
    }
    lab
}

struct Held {
    summary: Summary,
    verdicts: Vec<Verdict>,
    words: String,
}

impl Held {
    fn new(lab: &Lab, experiment: &Experiment, provenance: Value) -> Held {
        let cells = cells::cells(&lab.rows());
        let own: Vec<&Cell> = cells.iter().collect();
        let scope = Scope::new(Some(&provenance), std::slice::from_ref(experiment));
        let coverage = Coverage::new(experiment, &own, &scope);
        let summary = coverage.summary();
        let words = partial(&summary).unwrap_or_default();
        Held { summary, verdicts: verdicts(experiment, &cells, &coverage), words }
    }

    fn plain(lab: &Lab) -> Held {
        Held::new(lab, &experiment(""), Value::Null)
    }

    fn statuses(&self) -> Vec<Status> {
        self.verdicts.iter().map(|verdict| verdict.status).collect()
    }

    fn evidence(&self, claim: usize) -> String {
        evidence(&self.verdicts[claim].evidence)
    }
}

#[test]
fn a_claim_holds_over_all_that_is_planned() {
    let mut lab = lab(&ALL, 7);
    lab.param("s", 5).detector("nbs-twin").time(&[100; 7]);
    let Held { summary, words, .. } = &Held::plain(&lab);
    assert_eq!(Held::plain(&lab).statuses(), [Holds; 2]);
    assert_eq!((summary.scenes, summary.cells, summary.twins), ([9, 9], [18, 18], 1));
    assert_eq!(words, "");
    let whole = whole_or_partial([summary].into_iter()).0.unwrap();
    assert!(whole.contains("9 scenes, 18 cells; 1 cell of twins"), "{whole}");
}

#[test]
fn a_part_is_not_covered_and_says_which() {
    let part = &mut lab(&ALL[..5], 7);
    let held = Held::plain(part);
    assert_eq!(held.statuses(), [NotCovered; 2]);
    let evidence = held.evidence(0);
    for words in
        ["s = 50 to 200 of 2 to 200", "4 of 8 cells (run in part)", "always 200 (s = 2 to 20)"]
    {
        assert!(evidence.contains(words), "{evidence}");
    }
    for words in ["5 of 9 scenes and 10 of 18 cells", "missing: 8 cells (run in part)"] {
        assert!(held.words.contains(words), "{}", held.words);
    }
    // A claim about the measured part is fully covered.
    let near = "name = 'n'\nkind = { constant = { value = 'list_push' } }\nwhere = { s = '<= 20' }";
    let filter = toml::from_str::<Claim>(near).unwrap().filter;
    let near = experiment("");
    let claims = vec![Claim { filter, ..near.claims[0].clone() }];
    let near = Experiment { claims, ..near };
    assert_eq!(Held::new(part, &near, Value::Null).statuses(), [Holds]);
    part.param("s", 50).detector("nbs").count(&[("list_push", 900)]);
    assert_eq!(Held::plain(part).statuses()[0], Fails);
}

#[test]
fn a_scene_that_is_half_done_and_its_blocks_are_said() {
    let mut lab = lab(&ALL[..8], 7);
    lab.param("s", 200).detector("nbs").count(&[("list_push", 200)]).memory(9, 9).time(&[100; 3]);
    let held = Held::plain(&lab);
    assert_eq!(held.statuses(), [Holds, NotCovered]);
    let shown = "missing: 1 cell (run in part); 1 cell got 3 of its 7 blocks (run in part)";
    for words in ["8 of 9 scenes and 17 of 18 cells", shown] {
        assert!(held.words.contains(words), "{}", held.words);
    }
    let words = held.evidence(1);
    assert!(words.contains(": s = 200 of 1 to 200; 2 of 18 cells"), "{words}");
}

#[test]
fn quick_runs_shards_and_budgets_are_told_apart() {
    let quick = json!({"quick": true});
    let held = Held::new(&lab(&[1, 2, 50, 200], 3), &experiment(""), quick.clone());
    assert_eq!(held.statuses(), [NotCovered; 2]);
    let words = "missing: 10 cells (quick run); 8 cells got 3 of their 7 blocks";
    assert!(held.words.contains(words), "{}", held.words);
    let words = held.evidence(0);
    assert!(words.contains("5, 10, 20") || words.contains("5 of 8 values of s"), "{words}");
    for (provenance, words) in [
        (json!({"shard": "1/9"}), "missing: 16 cells (other shard)."),
        (json!({"merged_from": ["a", "b"]}), "missing: 16 cells (not merged)."),
    ] {
        let held = Held::new(&lab(&[1], 7), &experiment(""), provenance);
        assert!(held.words.contains(words), "{}", held.words);
    }
    let budget = experiment("block-budget-s = 1\n");
    let held = Held::new(&lab(&ALL, 6), &budget, Value::Null);
    assert_eq!((held.statuses(), &*held.words), (vec![Holds; 2], ""));
    let short = Short { cells: 18, blocks: [6, 6] };
    assert_eq!(held.summary.short, [(Why::Budget, short)].into());
    assert_eq!(Held::new(&lab(&ALL, 5), &budget, Value::Null).statuses()[1], NotCovered);
    let held = Held::new(&lab(&[3, 4], 7), &experiment(""), quick);
    assert_eq!((held.summary.scenes[0], held.summary.outside), (0, 2));
    assert_eq!(held.statuses(), [NotCovered; 2]);
    let words = "not in this record: all 8 cells (run in part, quick run); in its own cells";
    assert!(held.evidence(0).starts_with(words), "{}", held.evidence(0));
}

#[test]
fn what_ended_badly_is_there_and_what_could_not_start_is_not() {
    let mut some = lab(&ALL[..8], 7);
    some.param("s", 200).detector("nbs").fail(Pass::Count, Outcome::Refused, "why");
    some.detector("sorting").fail(Pass::Count, Outcome::Unavailable, "why");
    let held = Held::plain(&some);
    assert_eq!((held.statuses(), held.summary.scenes), (vec![Holds, NotCovered], [9, 9]));
    assert!(held.words.contains("missing: 1 cell (unavailable)"), "{}", held.words);
    let words = held.evidence(1);
    assert!(words.contains("1 of 18 cells (sorting could not be started)"), "{words}");
    let mut none = lab(&[3, 4], 3);
    for s in [3, 4] {
        let none = none.param("s", s).detector("sorting");
        none.fail(Pass::Count, Outcome::Unavailable, "no feature");
    }
    let held = Held::new(&none, &experiment(""), json!({"quick": true}));
    assert_eq!(held.summary.missing[&Why::Unavailable], 9);
    assert!(held.words.contains("not started: sorting: no feature"), "{}", held.words);
}

/// File scenes are named from the folder of the experiment, and runners choose their arithmetic. A
/// grading curve may be a file or its points.
#[test]
fn files_runners_and_grading_curves_are_known_again() {
    let text = "name = 'e'\ntitle = 't'\nquestion = '?'\nreading = '-'\nblocks = 0\ndetectors = \
                ['nbs']\n[[scene]]\nname = 'file'\npath = './data/discs.csv'\n[[runner]]\nname = \
                'theirs'\ncommand = ['x']\n";
    let path = [("path".to_string(), "./data/discs.csv".into())].into();
    let planned = testing::planned("file", &["nbs", "theirs"], &[path]);
    let planned = Planned { own_n: ["file".into()].into(), ..planned };
    let experiment = Experiment { planned, ..testing::read(text) };
    let mut lab = Lab::new("e", "file");
    lab.n(77).param("path", "/home/a/./data/discs.csv");
    lab.detector("nbs").count(&[]).memory(1, 1);
    lab.detector("theirs").arithmetic("f64").count(&[]).memory(1, 1);
    let Held { summary, .. } = Held::new(&lab, &experiment, Value::Null);
    assert_eq!((summary.cells, summary.outside), ([2, 2], 0));
    let mut other = Lab::new("e", "file");
    other.param("path", "/home/a/other/discs.csv").count(&[]).memory(1, 1);
    assert_eq!(Held::new(&other, &experiment, Value::Null).summary.cells, [0, 2]);

    let mut lab = Lab::new("e", "loose");
    for path in ["/home/a/sand.csv", "1 0, 2 100"] {
        lab.param("grading", path).count(&[]).memory(1, 1);
    }
    let curve = |path: &str| [("grading".to_string(), path.into())].into();
    let planned = testing::planned("loose", &["nbs"], &["sand.csv", "1 0, 2 100"].map(curve));
    let experiment = Experiment { planned, blocks: 0, ..testing::experiment("") };
    let Held { summary, .. } = Held::new(&lab, &experiment, Value::Null);
    assert_eq!((summary.cells, summary.outside), ([2, 2], 0));
}
