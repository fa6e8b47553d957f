//! `report.html` in a real browser: it opens without a word in the console, its controls do what
//! they say, and its numbers are those of the record.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::browser::Browser;
use crate::common::Place;

/// A name that would do harm if it became markup.
const EVIL: &str = "</script><img src=x onerror=\"window.evil=1\"><!--";

const EXPERIMENT: &str = r#"
name = "e"
title = "Who is fast? <b>"
question = "Which is the fastest?"
reading = "Lower is better."
detectors = ["nbs", "sorting", "nothing"]
arithmetics = ["f64", "exact"]
ratios-to = "nbs"
[[scene]]
name = "packed"
dim = [2, 3]
n = [100, 1000, 10000]
[[scene]]
name = "loose"
n = 1000
[[claim]]
name = "NBS makes three tests per particle"
kind = "equal"
value = "contact_test"
to = "3 * n"
where = { detector = "nbs" }
[[figure]]
name = "time"
title = "Time per particle"
x = "n"
x-label = "N"
y = "time_ns / n"
y-label = "ns"
"#;

/// Nanoseconds in a block: noise of a few percent, the same at every run.
fn time(detector: usize, n: u64, block: u64, dim: u64) -> u64 {
    let noise = (block * 7919 + n * 31 + detector as u64 * 17) % 97;
    n * (50 + 60 * detector as u64 + 10 * dim) * (1000 + noise) / 1000
}

/// The rows of a made-up record, in schema 3, whose lines have no check.
fn rows() -> Vec<Value> {
    let mut rows = Vec::new();
    let scenes: [(&str, u64, u32); 3] = [("packed", 2, 3), ("packed", 3, 3), ("loose", 2, 2)];
    let detectors = ["nbs", "sorting", EVIL, "nothing"].into_iter().enumerate();
    for ((scene, dim, sizes), (k, detector)) in
        scenes.iter().flat_map(|it| detectors.clone().map(move |d| (*it, d)))
    {
        for (n, arithmetic) in
            (2..2 + sizes).flat_map(|e| ["exact", "f64"].map(|a| (10_u64.pow(e), a)))
        {
            let (rounded, control) = (arithmetic == "f64", detector == "nothing");
            let role = match detector {
                "nothing" => "nothing",
                EVIL => "runner",
                _ => "detector",
            };
            let row = json!({"schema": 3, "machine": "here", "role": role,
                "resources": {"threads": 1}, "experiment": "e", "scene": scene, "params": {}, "dim": dim, "n": n,
                "seed": 1, "order": "shuffled", "detector": detector, "arithmetic": arithmetic,
                "pass": "time", "block": 0, "calls": 1,
                "outcome": if control { "control" } else { "ok" }, "reason": "",
                "contacts": if rounded && !control { 2 * n - n / 100 } else { 2 * n },
                "digest": "0x0000000000000000", "counts": {},
                "errors": {"missed": if rounded { n / 100 } else { 0 }, "spurious": 0, "duplicate": 0},
                "stats": {"packing_fraction": 0.5, "coordination": 4.0, "radius_ratio": 1.0,
                    "box_diameters": null, "scene_hash": ""}});
            let mut push = |changes: Value| {
                let mut row = row.clone();
                row.as_object_mut().unwrap().extend(changes.as_object().unwrap().clone());
                rows.push(row);
            };
            let pushes = n * (k as u64 + 1);
            push(json!({"pass": "count", "counts": {"contact_test": 3 * n, "list_push": pushes}}));
            push(json!({"pass": "memory", "peak_bytes": 12 * pushes, "formula_bytes": 12 * n}));
            if detector == EVIL && n == 10_000 {
                let reason = format!("30 s {EVIL}");
                push(json!({"outcome": "timeout", "reason": reason, "contacts": null}));
                continue;
            }
            for block in 1..=7 {
                let time = time(k, n, block, dim);
                push(json!({"block": block, "time_ns": time, "elapsed_ns": time}));
            }
        }
    }
    rows
}

/// A result folder, and its report.
pub fn report(at: &Place) -> PathBuf {
    std::fs::create_dir_all(at.path("experiments")).unwrap();
    at.file("experiments/e.toml", EXPERIMENT);
    let provenance = json!({"command": "contactbench run e.toml <b>", "cpu": "A & B"});
    at.file("provenance.json", provenance.to_string());
    at.file("samples.jsonl", rows().iter().map(|row| format!("{row}\n")).collect::<String>());
    at.good("report .");
    at.path("report.html")
}

/// The medians of the record by scene, dimension, N, detector and arithmetic: by sorting, from the
/// rows alone.
fn medians() -> BTreeMap<(String, u64, u64, String, String), f64> {
    let mut times: BTreeMap<_, Vec<u64>> = BTreeMap::new();
    for row in rows().iter().filter(|row| row["time_ns"].is_u64()) {
        let text = |name: &str| row[name].as_str().unwrap().to_string();
        let number = |name: &str| row[name].as_u64().unwrap();
        let (detector, arithmetic) = (text("detector"), text("arithmetic"));
        let key = (text("scene"), number("dim"), number("n"), detector, arithmetic);
        times.entry(key).or_default().push(number("time_ns"));
    }
    let median = |mut all: Vec<u64>| {
        all.sort();
        assert_eq!(all.len(), 7);
        all[3] as f64
    };
    times.into_iter().map(|(key, all)| (key, median(all))).collect()
}

/// Shown series of the chart: label to its values.
fn series(browser: &Browser) -> BTreeMap<String, Vec<Option<f64>>> {
    let code = "const u = document.getElementById('chart').chart; return \
                u.series.slice(1).map((s, k) => [s.label, s.show, [...u.data[k + 1]]])";
    let found = browser.run(code);
    let values = |list: &Value| list.as_array().unwrap().iter().map(Value::as_f64).collect();
    let shown = found.as_array().unwrap().iter().filter(|series| series[1] == true);
    shown.map(|series| (series[0].as_str().unwrap().to_string(), values(&series[2]))).collect()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

/// The cells of the table, as text.
fn table(browser: &Browser) -> Vec<Vec<String>> {
    let code = "return [...document.querySelectorAll('#cells tbody tr')].map((row) => \
                [...row.cells].map((cell) => cell.textContent))";
    serde_json::from_value(browser.run(code)).unwrap()
}

fn heads(browser: &Browser) -> Vec<String> {
    let code = "return [...document.querySelectorAll('#cells thead button')].map((button) => \
                button.textContent.replace(/ [▲▼]$/, ''))";
    serde_json::from_value(browser.run(code)).unwrap()
}

#[test]
fn the_page_works_in_a_browser() {
    let at = Place::new();
    let page = report(&at);
    let Some(browser) = Browser::open(1400, 1000) else { return };
    browser.show(&page);
    assert_eq!(browser.log(), Vec::<String>::new());
    opens_safely(&browser);
    charts(&browser);
    results(&browser);
    narrow(&browser, &page);
    assert_eq!(browser.log(), Vec::<String>::new(), "after all clicks");
}

/// The answer is there; a name with markup in it stayed text; nothing was asked of the network.
fn opens_safely(browser: &Browser) {
    assert_eq!(browser.run("return window.evil ?? null"), Value::Null);
    assert_eq!(browser.run("return document.title"), "Who is fast? <b>");
    let said = browser.run("return document.querySelector('.card.speed').textContent");
    assert!(
        said.as_str().unwrap().contains("nbs is faster than the fastest library in 6 of 6 scenes"),
        "{said}"
    );
    let body = browser.run("return document.body.textContent").as_str().unwrap().to_string();
    for part in [
        "1 of 1 claim hold",
        "30 s",
        "contactbench run e.toml <b>",
        "A & B",
        EVIL,
        "Permission is hereby granted",
    ] {
        assert!(body.contains(part), "{part}");
    }
    assert_eq!(
        browser.run("return document.querySelectorAll('img').length"),
        1,
        "the figure, and no image of a name"
    );
    let size = browser.run("return document.querySelector('figure img').naturalWidth").as_u64();
    assert!(size > Some(100), "the figure is drawn");
    let requests = browser.run(
        "return performance.getEntriesByType('resource').map((e) => e.name).filter((n) => \
         !n.startsWith('data:'))",
    );
    assert_eq!(requests, json!([]));
}

/// Values, toggles, scales, metric, scene, dimension, arithmetic, hovering, keys.
fn charts(browser: &Browser) {
    let medians = medians();
    let expected =
        |scene: &str, dim: u64, detector: &str, arithmetic: &str, per: bool| -> Vec<f64> {
            let found = medians.iter().filter(|((s, d, _, who, how), _)| {
                s == scene && *d == dim && who == detector && how == arithmetic
            });
            found.map(|((_, _, n, ..), time)| if per { time / *n as f64 } else { *time }).collect()
        };
    let same = |found: &[Option<f64>], expected: &[f64]| {
        assert_eq!(found.iter().flatten().count(), expected.len());
        assert!(
            found.iter().flatten().zip(expected).all(|(a, b)| close(*a, *b)),
            "{found:?} {expected:?}"
        );
    };
    // packed, 3D, exact
    let shown = series(browser);
    assert_eq!(
        shown.keys().map(String::as_str).collect::<Vec<_>>(),
        [EVIL, "nbs", "sorting"],
        "controls begin hidden"
    );
    for detector in ["nbs", "sorting", EVIL] {
        same(&shown[detector], &expected("packed", 3, detector, "exact", true));
    }
    browser.click("#legend button:nth-child(2)");
    assert!(!series(browser).contains_key("nbs"));
    assert_eq!(
        browser.run(
            "return document.querySelector('#legend \
             button:nth-child(2)').getAttribute('aria-pressed')"
        ),
        "false"
    );
    browser.choose("#by-dim", "2D");
    assert!(!series(browser).contains_key("nbs"), "what is hidden stays hidden");
    browser.click("#legend button:nth-child(2)");
    same(&series(browser)["nbs"], &expected("packed", 2, "nbs", "exact", true));
    browser.choose("#by-arithmetic", "all");
    same(&series(browser)["sorting (f64)"], &expected("packed", 2, "sorting", "f64", true));
    browser.choose("#by-arithmetic", "f64");
    browser.choose("#by-scene", "loose");
    same(&series(browser)["nbs"], &expected("loose", 2, "nbs", "f64", true));
    browser.click("#per-particle");
    same(&series(browser)["nbs"], &expected("loose", 2, "nbs", "f64", false));
    let scale = |axis: &str| {
        browser.run(&format!("return document.getElementById('chart').chart.scales.{axis}.distr"))
    };
    assert_eq!((scale("x"), scale("y")), (json!(3), json!(3)));
    browser.click("#log-x");
    browser.click("#log-y");
    assert_eq!((scale("x"), scale("y")), (json!(1), json!(1)));
    for (metric, values) in [
        ("Memory (peak)", [1200.0, 12000.0]),
        ("Operations (all)", [400.0, 4000.0]),
        ("Contact tests", [300.0, 3000.0]),
    ] {
        browser.choose("#metric", metric);
        same(&series(browser)["nbs"], &values);
    }
    browser.choose("#metric", "Error");
    same(&series(browser)["nbs"], &[1.0 / 200.0, 10.0 / 2000.0]);
    browser.choose("#by-arithmetic", "exact");
    same(&series(browser)["nbs"], &[0.0, 0.0]);
    browser.click("#log-y");
    let note = browser.run("return document.getElementById('chart-note').textContent");
    assert!(note.as_str().unwrap().contains("values of 0 cannot be shown"), "{note}");
    // values at the cursor, by keys
    browser.choose("#metric", "Time");
    browser.keys("#chart", "\u{e014}");
    let tip = browser
        .run("const tip = document.getElementById('tip'); return tip.hidden ? '' : tip.innerText")
        .as_str()
        .unwrap()
        .to_string();
    let value = expected("loose", 2, "nbs", "exact", false)[0];
    assert!(
        tip.contains("N = 100, ns") && tip.replace(',', "").contains(&format!("{value}")),
        "{tip} has no {value}"
    );
}

/// Sorting, filters, download.
fn results(browser: &Browser) {
    let (heads, all) = (heads(browser), table(browser));
    assert_eq!(all.len(), 8 * 4 * 2);
    let column = |name: &str| {
        heads
            .iter()
            .position(|head| head == name)
            .unwrap_or_else(|| panic!("no {name} in {heads:?}"))
    };
    let (n, time_column, detector) = (column("N"), column("ns / N"), column("detector"));
    let number = |text: &str| text.replace(',', "").parse::<f64>().ok();
    let button = format!("#cells th:nth-child({}) button", time_column + 1);
    let order = || {
        browser.run(&format!(
            "return document.querySelector('#cells th:nth-child({})').ariaSort",
            time_column + 1
        ))
    };
    for (said, sign) in [("ascending", 1.0), ("descending", -1.0)] {
        browser.click(&button);
        assert_eq!(order(), said);
        let times: Vec<Option<f64>> =
            table(browser).iter().map(|row| number(&row[time_column])).collect();
        let values: Vec<f64> = times.iter().flatten().copied().collect();
        assert!(
            values.len() == 60 && values.windows(2).all(|pair| sign * (pair[1] - pair[0]) >= 0.0),
            "{values:?}"
        );
        assert!(times[60..].iter().all(Option::is_none), "what has no time comes last");
    }
    browser.choose("#only-detector", "nbs");
    browser.keys("#words", "packed exact");
    let shown = table(browser);
    assert_eq!(shown.len(), 6);
    assert!(shown.iter().all(|row| row[detector] == "nbs"
        && row.contains(&"packed".into())
        && row.contains(&"exact".into())));
    let count = browser.run("return document.getElementById('count').textContent");
    assert_eq!(count, "6 of 64 rows");
    browser.click("#csv");
    let text = browser.downloaded("results.csv");
    let table = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
    let lines: Vec<Vec<String>> = table.into_deserialize().map(Result::unwrap).collect();
    assert_eq!((lines.len(), &lines[0]), (7, &heads));
    let medians = medians();
    let (scene, dim) = (column("scene"), column("dimension"));
    for (line, row) in lines[1..].iter().zip(&shown) {
        for (exact, seen) in line.iter().zip(row) {
            match (number(exact), number(seen)) {
                (Some(exact), Some(seen)) => {
                    assert!((exact - seen).abs() <= 1e-3 * exact.abs(), "{exact} {seen}")
                }
                _ => assert_eq!(if exact.is_empty() { "–" } else { exact }, seen),
            }
        }
        let size: u64 = line[n].parse().unwrap();
        let median = medians[&(
            line[scene].clone(),
            line[dim].parse().unwrap(),
            size,
            "nbs".into(),
            "exact".into(),
        )];
        assert!(close(line[time_column].parse().unwrap(), median / size as f64), "{line:?}");
    }
}

/// On a phone nothing is wider than the screen, and every control is large enough for a finger.
fn narrow(browser: &Browser, page: &Path) {
    for (scheme, ground) in [("light", "rgb(255, 255, 255)"), ("dark", "rgb(22, 24, 29)")] {
        browser.devtools(
            "Emulation.setDeviceMetricsOverride",
            json!({"width": 390, "height": 800, "deviceScaleFactor": 2, "mobile": true}),
        );
        browser.devtools(
            "Emulation.setEmulatedMedia",
            json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]}),
        );
        browser.show(page);
        assert_eq!(browser.run("return document.documentElement.scrollWidth"), 390, "{scheme}");
        assert_eq!(browser.run("return getComputedStyle(document.body).backgroundColor"), ground);
        let bottom = browser
            .run(
                "return Math.round(document.querySelector('.card.speed').getBoundingClientRect().\
                 bottom)",
            )
            .as_u64()
            .unwrap();
        assert!(bottom < 500, "the answer is seen at once: it ends at {bottom}");
    }
}
