//! Figures of made-up rows.

use super::*;
use contactbench_record::cells;
use contactbench_record::cells::machine::Machine;
use contactbench_record::cells::testing;
use contactbench_record::cells::testing::Lab;
use contactbench_record::experiment::Where;
use contactbench_record::record::row::{Outcome, Pass};
use contactbench_terms::errors::{Causes, Errors};

/// Seven detectors on three scenes in two dimensions, with cells that have no value.
pub fn rows() -> Vec<contactbench_record::record::row::Row> {
    let mut lab = Lab::new("e", "packed");
    for (scene, dims, factor) in
        [("packed", [2, 3], 1.0), ("loose", [2, 3], 0.7), ("clustered", [2, 3], 0.9)]
    {
        for dim in dims {
            for n in [100_u64, 300, 1000, 3000, 10_000, 30_000, 100_000] {
                lab.scene(scene, dim).n(n);
                let x = n as f64;
                for (name, per) in [
                    ("direct", 0.9 * x),
                    ("binary-tree", 60.0 * x.log2()),
                    ("screening", 110.0 + 0.0006 * x),
                    ("sorting", 28.0 * x.log2()),
                    ("nbs", 150.0 + 0.0004 * x),
                    ("nbs-twin", 152.0 + 0.0004 * x),
                    ("nothing", 30.0 / x),
                ] {
                    lab.detector(name);
                    if name == "direct" && n > 10_000 {
                        lab.fail(Pass::Time, Outcome::Timeout, "30 s, the limit");
                    } else if name == "screening" && scene == "clustered" && n > 3000 {
                        lab.fail(
                            Pass::Time,
                            Outcome::Refused,
                            "the grid would need 6.1 GiB, the limit is 4 GiB",
                        );
                    } else {
                        let time = per * x * factor * f64::from(dim);
                        let blocks: Vec<u64> = (0..15_u64)
                            .map(|k| {
                                (time * (0.8 + 0.4 * (k as f64 * 7.7 + x).sin().abs())) as u64 + 20
                            })
                            .collect();
                        lab.time(&blocks).count(&[(
                            "contact_test",
                            if name == "nothing" { 0 } else { (per * x / 12.0) as u64 },
                        )]);
                        lab.memory(n * 24 + 4096, n * 24);
                    }
                }
            }
        }
    }
    lab.rows()
}

pub const FIGURES: &str = "
[[figure]]
name = 'time'
title = 'Time against N'
x = 'n'
x-label = 'number of particles N'
y = 'time_ns / 10^6'
y-label = 'time per detection (ms)'
slopes = true
[[figure]]
name = 'tests'
title = 'Contact tests'
x = 'n'
x-label = 'number of particles N'
y = 'contact_test'
y-label = 'contact tests'
slopes = true
[[figure]]
name = 'per'
title = 'Time per particle, packed'
x = 'n'
x-label = 'number of particles N'
y = 'time_ns / n'
y-label = 'time per particle (ns)'
log = false
where = { scene = 'packed', dim = 2, detector = ['nbs', 'screening'] }
";

fn drawn(rows: &[contactbench_record::record::row::Row], rest: &str) -> Vec<String> {
    let (experiment, cells) = (testing::experiment(rest), cells::cells(rows));
    let styles = style::Styles::new(cells.iter());
    let machine = Machine { caches: vec![("L2".into(), 64 << 10), ("L3".into(), 32 << 20)] };
    let draw = |figure| svg(&experiment, figure, &cells, &styles, &machine).unwrap().unwrap();
    experiment.figures.iter().map(draw).collect()
}

/// The contents of all text elements.
fn texts(svg: &str) -> Vec<&str> {
    svg.split("<text")
        .skip(1)
        .filter_map(|rest| rest.split_once('>')?.1.split_once('<').map(|pair| pair.0.trim()))
        .collect()
}

#[test]
fn a_figure_names_detectors_and_marks_what_is_missing() {
    let figures = drawn(&rows(), FIGURES);
    assert_eq!(figures.len(), 3);
    let found = texts(&figures[0]);
    for name in [
        "direct",
        "binary-tree",
        "screening",
        "sorting",
        "nbs",
        "nbs-twin",
        "nothing",
        "packed, 2D",
        "clustered, 3D",
        "10⁵",
        "N log N",
    ] {
        assert!(found.contains(&name), "{name} is not in {found:?}");
    }
    // two sizes of direct in six panels and the legend; three of screening in two panels and the
    // legend
    assert_eq!(found.iter().filter(|text| **text == "T").count(), 13);
    assert_eq!(found.iter().filter(|text| **text == "R").count(), 7);
    assert!(
        texts(&figures[1]).contains(&"0"),
        "a count of zero has its place on a logarithmic axis"
    );
    assert!(!texts(&figures[2]).contains(&"direct"));
}

#[test]
fn figures_are_the_same_each_time() {
    let mut shuffled = rows();
    shuffled.reverse();
    assert!(drawn(&rows(), FIGURES) == drawn(&shuffled, FIGURES));
}

#[test]
fn caches_are_marked_where_they_are_asked_for_and_threads_are_lines() {
    let mut lab = Lab::new("e", "packed");
    for n in [1000_u64, 100_000] {
        for threads in [1, 2] {
            lab.n(n).detector("direct").threads(threads).time(&[n * 100 / u64::from(threads); 15]);
        }
    }
    let figure = FIGURES.split("[[figure]]\nname = 'tests'").next().unwrap();
    let with = drawn(&lab.rows(), &format!("{figure}caches = true\n"));
    let (with, without) = (texts(&with[0]), drawn(&lab.rows(), figure));
    // 64 KiB are 4096 discs; 32 MiB are two million.
    for text in [
        "&gt; L2",
        "coordinates larger than",
        "L2 (64 KiB)",
        "L3 (32 MiB): no scene",
        "direct",
        "direct, 2 threads",
    ] {
        assert!(with.contains(&text), "{text} is not in {with:?}");
    }
    assert!(!with.contains(&"&gt; L3") && !without[0].contains("L2"));
}

#[test]
fn odd_data_do_not_break_a_figure() {
    for (n, time) in [(0, 0), (1, 1), (u64::MAX, u64::MAX)] {
        let mut lab = Lab::new("e", "<a & b>");
        lab.detector("my \"own\"").n(n).time(&[time]);
        for svg in
            drawn(&lab.rows(), FIGURES.split("[[figure]]\nname = 'tests'").next().unwrap_or(""))
        {
            assert!(svg.contains("&lt;a &amp; b&gt;"));
        }
    }
}

#[test]
fn seeds_are_one_point_with_their_range_and_arithmetics_are_lines() {
    let mut lab = Lab::new("e", "packed");
    for (seed, tests) in [(1, 10), (2, 40), (3, 20)] {
        lab.seed(seed)
            .arithmetic("exact")
            .count(&[("contact_test", tests)])
            .arithmetic("f32")
            .count(&[("contact_test", 5)]);
    }
    let experiment = testing::experiment(FIGURES);
    let FigureKind::Lines(options) = &experiment.figures[1].kind else { panic!("not of lines") };
    let cells = cells::cells(&lab.rows());
    let plot = lines::Plot::new(options, &Where::new(), &[], &cells).unwrap().unwrap();
    let lines: Vec<_> = plot.panels[0]
        .lines
        .iter()
        .map(|(key, line)| (key.variant.as_str(), line.points.clone()))
        .collect();
    let point = |y, low, high| vec![lines::data::Datum { x: 100.0, y, low, high }];
    assert_eq!(lines, [("exact", point(20.0, 10.0, 40.0)), ("f32", point(5.0, 5.0, 5.0))]);
    assert!(plot.over_seeds);
}

/// Two detectors, three arithmetics, two offsets; only f32 is wrong, and only at the second offset.
fn speed_error_rows() -> Vec<contactbench_record::record::row::Row> {
    let mut lab = Lab::new("e", "packed");
    for (offset, missed) in [(0, 0), (-1000, 25), (1_000_000, 250)] {
        lab.param("offset", offset);
        for (detector, scale) in [("nbs", 1), ("direct", 40), ("nbs-twin", 1)] {
            lab.detector(detector);
            for (arithmetic, time) in [("f32", 900), ("f64", 1000), ("exact", 1100)] {
                let errors = Errors {
                    missed: if arithmetic == "f32" { missed } else { 0 },
                    ..Errors::default()
                };
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
    lab.rows()
}

const SPEED_ERROR: &str = "
[[figure]]
name = 'given'
title = 'Given'
kind = 'speed-error'
columns = 'offset'
[[figure]]
name = 'stored'
title = 'Stored'
kind = 'speed-error'
against = 'stored'
";

fn speed_error_plot(figure: &Figure, cells: &[Cell]) -> Option<speed_error::Plot> {
    let FigureKind::SpeedError(options) = &figure.kind else { panic!("of lines") };
    speed_error::Plot::new(options, &figure.filter, &[], cells).unwrap()
}

#[test]
fn speed_stands_against_the_errors_asked_for() {
    let (experiment, cells) = (testing::experiment(SPEED_ERROR), cells::cells(&speed_error_rows()));
    let plot = |k: usize| speed_error_plot(&experiment.figures[k], &cells).unwrap();
    let given = plot(0);
    assert_eq!(given.arithmetics, ["f32", "f64", "exact"]);
    assert_eq!(given.detectors, ["direct", "nbs"]);
    assert_eq!(given.rows.len(), 1);
    let panels = &given.rows[0].panels;
    let titles: Vec<&str> = panels.iter().map(|panel| panel.title.as_str()).collect();
    assert_eq!(titles, ["offset = 0", "offset = -1000", "offset = 10⁶"]);
    assert_eq!(
        (panels[0].marks.len(), &*panels[0].missing),
        (3, [(); 3].map(|()| ("direct".to_string(), Outcome::Timeout)).as_slice())
    );
    let shown = |panel: &speed_error::data::Panel| -> Vec<(usize, f64, f64, bool)> {
        panel
            .marks
            .iter()
            .filter(|mark| mark.detector == "nbs")
            .map(|mark| (mark.arithmetic, mark.time, mark.rate, mark.front))
            .collect()
    };
    // without errors the fastest alone is the front
    assert_eq!(
        shown(&panels[0]),
        [(0, 9.0, 0.0, true), (1, 10.0, 0.0, false), (2, 11.0, 0.0, false)]
    );
    assert_eq!(
        shown(&panels[2]),
        [(0, 9.0, 100.0, true), (1, 10.0, 0.0, true), (2, 11.0, 0.0, false)]
    );
    assert!(
        plot(1).marks().all(|mark| mark.rate == 0.0),
        "storing is no error of the scene as stored"
    );
}

#[test]
fn a_figure_of_speed_against_error_has_a_place_for_none() {
    let figures = drawn(&speed_error_rows(), SPEED_ERROR);
    for svg in &figures {
        let found = texts(svg);
        for text in [
            "0",
            "packed, 2D",
            "offset = 10⁶",
            "f32",
            "exact",
            "nbs",
            "direct",
            "time limit",
            "not one pair wrong",
        ] {
            assert!(found.contains(&text), "{text} is not in {found:?}");
        }
        assert!(!found.contains(&"nbs-twin"));
    }
    let percents = |k: usize| texts(&figures[k]).iter().filter(|text| text.ends_with('%')).count();
    assert!(percents(0) >= 2, "{:?}", texts(&figures[0]));
    let mut shuffled = speed_error_rows();
    shuffled.reverse();
    assert!(drawn(&shuffled, SPEED_ERROR) == figures);
    // nothing to show: no figure, no failure
    let lines = testing::experiment(SPEED_ERROR);
    assert_eq!(speed_error_plot(&lines.figures[0], &cells::cells(&rows())), None);
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
    let cells = cells::cells(&lab.rows());
    let text = "[[figure]]\nname = 'b'\ntitle = 'Bars'\nkind = 'bars'\nto = 'nbs'\n";
    let experiment = testing::experiment(text);
    let picture = svg(
        &experiment,
        &experiment.figures[0],
        &cells,
        &style::Styles::new(cells.iter()),
        &Machine::default(),
    );
    let picture = picture.unwrap().unwrap();
    let document = roxmltree::Document::parse(&picture).unwrap();
    let texts: Vec<&str> = document
        .descendants()
        .filter(|node| node.has_tag_name("text"))
        .filter_map(|node| Some(node.text()?.trim()))
        .collect();
    let names = ["grid", "nbs", "kd", "far", "bad", "slow", "gone", "nbs-twin"];
    let drawn: Vec<&str> = texts.iter().copied().filter(|text| names.contains(text)).collect();
    assert_eq!(drawn, ["grid", "nbs", "kd", "far", "bad", "slow"]);
    for said in ["0.40 = 4 ns", "1 = 10 ns", "2.50 = 25 ns", "0.050, wrong", "time limit"] {
        assert!(texts.contains(&said), "{said} is not in {texts:?}");
    }
}

#[test]
fn a_map_names_the_fastest_and_stripes_what_is_undecided() {
    let mut lab = Lab::new("e", "packed");
    for (n, fraction, nbs) in [(100, 0.1, 1000), (100, 0.6, 2000), (1000, 0.6, 3000)] {
        lab.n(n).param("fraction", fraction).detector("nbs").time(&[nbs; 15]);
        lab.detector("sorting").time(&[2000; 15]);
    }
    let figure = "
[[figure]]
name = 'map'
title = 'Who <is> the fastest'
kind = 'map'
x = 'n'
x-label = 'particles N'
y = 'fraction'
";
    let drawn = drawn(&lab.rows(), figure);
    let found = texts(&drawn[0]);
    for text in [
        "Who &lt;is&gt; the fastest",
        "packed, 2D",
        "particles N",
        "fraction",
        "nbs",
        "2.00",
        "2.00 to 2.00",
        "or sorting",
        "sorting",
        "1.50",
        "1.5 to 2.5",
    ] {
        assert!(found.contains(&text), "{text} is not in {found:?}");
    }
    // Only the tile in which both take as long is striped; the place without cells is empty.
    let striped = |svg: &str| svg.matches("<polygon").count();
    let decided = drawn[0].replace("or sorting", "");
    assert!(striped(&decided) > 20, "{}", striped(&decided));
    let (experiment, cells) = (testing::experiment(figure), cells::cells(&lab.rows()[..0]));
    let (styles, machine) = (style::Styles::default(), Machine::default());
    let nothing = svg(&experiment, &experiment.figures[0], &cells, &styles, &machine);
    assert!(nothing.unwrap().is_none());
    lab.n(100).param("fraction", 0.6).detector("nbs").time(&[1500; 15]);
    let clear = self::drawn(&lab.rows(), figure);
    assert!(striped(&clear[0]) < striped(&drawn[0]) - 10);
    assert!(!texts(&clear[0]).contains(&"or sorting"));
}
