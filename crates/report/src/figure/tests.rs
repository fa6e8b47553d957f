//! Figures of made-up rows, for situations that occur in no committed record.

use super::*;
use contactbench_record::cells;
use contactbench_record::cells::testing::{self, Lab};
use contactbench_record::record::row::{Outcome, Pass, Row};
use contactbench_terms::errors::{Causes, Errors};

/// Draws the named figure of `figures.toml`; `None` if it has nothing to show.
fn drawn(rows: &[Row], name: &str) -> Option<String> {
    let experiment = &testing::experiment(include_str!("figures.toml"));
    let figure = experiment.figures.iter().find(|figure| figure.name == name).unwrap();
    let (cells, caches) =
        (&*cells::cells(rows), &[("L2".into(), 64 << 10), ("L3".into(), 32 << 20)]);
    let styles = &style::Styles::new(cells.iter());
    About { experiment, figure, cells, styles, caches }.svg().unwrap()
}

fn texts(svg: &Option<String>) -> Vec<String> {
    let document = roxmltree::Document::parse(svg.as_ref().unwrap()).unwrap();
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    texts.filter_map(|node| Some(node.text()?.trim().to_string())).collect()
}

fn all_in(found: &[String], wanted: &[&str]) {
    for text in wanted {
        assert!(found.iter().any(|it| it == text), "{text} is not in {found:?}");
    }
}

#[test]
fn threads_and_arithmetics_are_lines_and_failures_marks() {
    let mut lab = Lab::new("e", "packed");
    for n in [1000_u64, 100_000] {
        for threads in [1, 2] {
            lab.n(n).detector("direct").threads(threads).time(&[n * 100 / u64::from(threads); 15]);
        }
    }
    lab.threads(1).detector("nbs").fail(Pass::Time, Outcome::OutOfMemory, "6 GiB");
    let found = texts(&drawn(&lab.rows(), "time"));
    // The coordinates of 4096 discs fill 64 KiB; those of two million fill 32 MiB.
    let caches = ["> L2", "L2 (64 KiB)", "L3 (32 MiB): no scene"];
    all_in(&found, &caches);
    all_in(&found, &["direct", "direct, 2 threads", "dashed: several threads", "memory limit"]);
    assert_eq!(found.iter().filter(|text| *text == "M").count(), 2, "in the panel and the legend");
    let mut lab = Lab::new("e", "packed");
    for (seed, time) in [(1, 10), (2, 40), (3, 20)] {
        lab.seed(seed).arithmetic("exact").time(&[time; 5]).arithmetic("f32").time(&[time; 5]);
    }
    all_in(&texts(&drawn(&lab.rows(), "time")), &["nbs, f32", "bars: range over seeds"]);
}

#[test]
fn a_tracker_that_missed_contacts_has_hollow_marks() {
    for (lossy, outcome) in [(false, Outcome::Ok), (true, Outcome::Lossy)] {
        let mut lab = Lab::new("e", "packed");
        lab.detector("verlet(nbs,rule=every-20,skin=0.1)").time(&[10; 5]);
        lab.edit(|row| row.outcome = outcome);
        let note = "hollow: missed contacts".to_string();
        assert_eq!(texts(&drawn(&lab.rows(), "time")).contains(&note), lossy);
    }
}

#[test]
fn odd_data_do_not_break_a_figure() {
    for (n, time) in [(0, 0), (1, 1), (u32::MAX.into(), u64::MAX)] {
        let mut lab = Lab::new("e", "<a & b>");
        lab.detector("my \"own\"").n(n).time(&[time]);
        all_in(&texts(&drawn(&lab.rows(), "time")), &["<a & b>, 2D", "my \"own\""]);
    }
}

/// Two detectors, three arithmetics, three offsets; only f32 is wrong, and not at the first offset.
#[test]
fn speed_error_has_a_place_for_none_and_order_does_not_matter() {
    let mut lab = Lab::new("e", "packed");
    for (offset, missed) in [(0, 0), (-1000, 25), (1_000_000, 250)] {
        lab.param("offset", offset);
        for (detector, scale) in [("nbs", 1), ("direct", 40), ("nbs-twin", 1)] {
            lab.detector(detector);
            for (arithmetic, time) in [("f32", 900), ("f64", 1000), ("exact", 1100)] {
                let missed = if arithmetic == "f32" { missed } else { 0 };
                let errors = Errors { missed, ..Errors::default() };
                lab.arithmetic(arithmetic);
                if detector == "direct" && offset == 0 {
                    lab.fail(Pass::Time, Outcome::Timeout, "30 s, the limit");
                } else {
                    lab.time(&[time * scale; 15])
                        .errors(errors, Causes { representation: errors, ..Causes::default() });
                }
            }
        }
    }
    let figure = drawn(&lab.rows(), "given");
    let found = texts(&figure);
    all_in(&found, &["offset = 0", "offset = -1000", "offset = 10⁶", "f32", "exact", "time limit"]);
    assert!(!found.contains(&"nbs-twin".to_string()) && found.iter().any(|it| it.ends_with('%')));
    let mut shuffled = lab.rows();
    shuffled.reverse();
    assert!(drawn(&shuffled, "given") == figure);
    let times: Vec<Row> = shuffled.into_iter().filter(|row| row.errors.is_none()).collect();
    assert_eq!(drawn(&times, "given"), None, "nothing to show is no failure");
}

#[test]
fn bars_are_the_fastest_first_and_nothing_stands_at_an_edge() {
    let mut lab = Lab::new("e", "packed");
    for (name, time) in [("nbs", 1000), ("kd", 2500), ("grid", 400), ("far", 900_000)] {
        lab.detector(name).time(&[time; 15]);
    }
    lab.detector("bad").time(&[50; 15]).edit(|row| row.outcome = Outcome::Wrong);
    lab.detector("slow").fail(Pass::Time, Outcome::Timeout, "20 s");
    lab.detector("gone").fail(Pass::Time, Outcome::Unavailable, "install it");
    lab.detector("nbs-twin").time(&[1001; 15]);
    let found = texts(&drawn(&lab.rows(), "b"));
    let names = ["grid", "nbs", "kd", "far", "bad", "slow", "gone", "nbs-twin"];
    let drawn: Vec<&String> = found.iter().filter(|text| names.contains(&text.as_str())).collect();
    assert_eq!(drawn, ["grid", "nbs", "kd", "far", "bad", "slow"]);
    all_in(&found, &["0.40 = 4 ns", "1 = 10 ns", "2.50 = 25 ns", "0.050, wrong", "time limit"]);
}
