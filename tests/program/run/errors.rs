//! Tests the errors that a record counts: by cause, in every arithmetic, on hard cases with earlier
//! scenes or without a valid one.

use contactbench::record::row::{Outcome, Pass};
use contactbench_detectors::oracle::Errors;

use super::{EMPTY, rows};
use crate::common::{answers, runner, say};

#[test]
fn each_error_is_charged_to_its_cause() {
    let text = "detectors = [\"direct\", \"nbs\"]\n\
                arithmetics = [\"f32\", \"textbook\", \"f64\", \"exact\"]\n\
                [[scene]]\nname = \"couples\"\nn = 600\ndiameter = 0.1\noffset = -1000\n\
                [[scene]]\nname = \"loose\"\nn = 600\noffset = 1e6\n";
    // Textbook arithmetic may miss contacts without failing the run.
    let (_at, rows) = rows(text, 0);
    for row in rows.iter().filter(|row| !row.id.detector.ends_with("-twin")) {
        let (errors, causes) = (row.errors.unwrap(), row.causes.unwrap());
        let lossy = row.id.arithmetic == "textbook"
            && row.id.detector == "nbs"
            && row.id.scene == "couples";
        assert_eq!(row.outcome, if lossy { Outcome::Lossy } else { Outcome::Ok }, "{row:?}");
        assert_eq!(causes.search.missed > 0, lossy, "{row:?}");
        assert_eq!(causes.search.wrong(), causes.search.missed, "{row:?}");
        let coarse = row.id.arithmetic == "f32";
        assert_eq!(causes.representation.wrong() > 0, coarse, "{row:?}");
        assert_eq!(errors.wrong() > 0, coarse || lossy, "{row:?}");
        let predicate = causes.predicate.wrong();
        match (row.id.scene.as_str(), row.id.arithmetic.as_str()) {
            // f32 misses pairs one step from tangency, whose overlap is tiny.
            ("couples", "f32") => assert!(predicate > 0 && errors.deepest_miss < 1e-12, "{row:?}"),
            // A million diameters from the origin, a disc has 16 steps of f32 across.
            ("loose", "f32") => assert!(predicate == 0 && errors.deepest_miss > 1e-3, "{row:?}"),
            ("couples", "exact") => {
                assert_eq!((errors, row.contacts), (Errors::default(), Some(300)))
            }
            _ => assert_eq!(predicate, 0, "{row:?}"),
        }
    }
}

#[test]
fn the_steps_of_a_case_come_before_the_one_that_is_judged() {
    let count = format!(r#"{{"reply":"count","counts":{{}},"contacts":0,"digest":"{EMPTY}"}}"#);
    let refused = r#"{"reply":"refused","reason":"not that one"}"#;
    let log = |word: &str, line: &str| format!("echo {word} >> log; {}", say(line));
    let [load, sample, count] =
        [log("load", r#"{"reply":"loaded"}"#), log("sample", refused), log("count", &count)];
    let script = answers(&[("load", &load), ("sample", &sample), ("count", &count)]);
    let scene = "[[scene]]\nname = \"hard\"\ncase = \"shrink-then-grow\"\n";
    // The reply without contacts is wrong, so the run exits with code 1.
    let (at, _) = rows(&format!("detectors = []\n{scene}{}", runner("fake", "sh", &script)), 1);
    let log = at.read("log");
    let words: Vec<&str> = log.lines().collect();
    let steps = words.iter().take_while(|&&word| word != "count").count() / 2;
    assert!(steps > 1, "{words:?}");
    let expected = [["load", "sample"].repeat(steps), vec!["load", "count"]].concat();
    assert_eq!(words[..expected.len()], expected, "a refusal of an earlier step does not matter");
}

#[test]
fn an_invalid_case_is_refused_by_name_and_costs_no_other() {
    let text = "table = \"verdicts\"\ndetectors = [\"direct\", \"nbs\"]\n[[scene]]\nname = \
                \"hard\"\ndim = [2, 3]\ncase = [\"nan-coordinate\", \"negative-radius\", \
                \"two-in-touch\"]\n";
    let (at, rows) = rows(text, 0);
    for row in &rows {
        let valid = row.id.params["case"].to_string() == "two-in-touch";
        assert_eq!(row.outcome, if valid { Outcome::Ok } else { Outcome::Refused }, "{row:?}");
        assert_eq!(row.reason.contains("particle 3"), !valid, "{row:?}");
    }
    let detectors = rows.iter().filter(|row| !row.id.detector.ends_with("-twin"));
    assert_eq!(detectors.filter(|row| row.pass == Pass::Count).count(), 3 * 2 * 2);
    at.good("run t.toml --out result --resume");
    assert_eq!(at.rows("result").len(), rows.len(), "nothing is written twice");
}
