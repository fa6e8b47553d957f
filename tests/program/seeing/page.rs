//! Tests `report.html` in a browser: it opens without errors, its controls work, and its numbers
//! are those of the record.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use contactbench::record::folder::{copies, seal};
use serde_json::{Value, json};

use super::browser::Browser;
use crate::common::Place;

/// A detector's name that would run a script if it were not escaped.
const EVIL: &str = "</script><img src=x onerror=\"window.evil=1\"><!--";

const EXPERIMENT: &str = include_str!("../experiments/page.toml");

/// Returns the made-up time of a block, with a fixed noise of a few percent.
fn time(detector: usize, n: u64, block: u64, dim: u64) -> u64 {
    let noise = (block * 7919 + n * 31 + detector as u64 * 17) % 97;
    n * (50 + 60 * detector as u64 + 10 * dim) * (1000 + noise) / 1000
}

/// Returns the rows of a made-up record.
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
            let mut params = json!({"diameter": 1, "offset": 0, "size-ratio": 1});
            if scene == "packed" {
                let lattice = if dim == 2 { "hexagonal" } else { "fcc" };
                (params["lattice"], params["jitter"]) = (lattice.into(), 0.05.into());
                params["spacing"] = 0.99.into();
            } else {
                params["fraction"] = 0.05.into();
            }
            let role = match detector {
                "nothing" => "nothing",
                EVIL => "runner",
                _ => "detector",
            };
            let row = json!({"schema": 4, "machine": "here", "role": role,
                "resources": {"threads": 1}, "experiment": "e", "scene": scene, "params": params, "dim": dim, "n": n,
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

pub fn report(at: &Place) -> PathBuf {
    std::fs::create_dir_all(at.path("experiments")).unwrap();
    at.file("experiments/e.toml", EXPERIMENT);
    let sealed = |value: &Value| seal::sealed(&value.to_string()) + "\n";
    let mut provenance = json!({"command": "contactbench run e.toml <b>", "cpu": "A & B"});
    provenance[copies::FIELD] = copies::field([("e", EXPERIMENT)].into_iter());
    at.file("provenance.json", sealed(&provenance));
    at.file("samples.jsonl", rows().iter().map(sealed).collect::<String>());
    at.good("report .");
    at.path("report.html")
}

/// Returns the medians of the rows by scene, dimension, detector, arithmetic and N.
fn medians() -> BTreeMap<(String, u64, String, String, u64), f64> {
    let mut times: BTreeMap<_, Vec<u64>> = BTreeMap::new();
    for row in rows().iter().filter(|row| row["time_ns"].is_u64()) {
        let text = |name: &str| row[name].as_str().unwrap().to_string();
        let number = |name: &str| row[name].as_u64().unwrap();
        let (detector, arithmetic) = (text("detector"), text("arithmetic"));
        let key = (text("scene"), number("dim"), detector, arithmetic, number("n"));
        times.entry(key).or_default().push(number("time_ns"));
    }
    let median = |mut all: Vec<u64>| {
        all.sort();
        assert_eq!(all.len(), 7);
        all[3] as f64
    };
    times.into_iter().map(|(key, all)| (key, median(all))).collect()
}

/// Returns the visible series of the chart by their labels.
fn series(browser: &Browser) -> BTreeMap<String, Vec<f64>> {
    let code = "const u = document.getElementById('chart').chart; return \
                u.series.slice(1).map((s, k) => [s.label, s.show, [...u.data[k + 1]]])";
    let found: Vec<(String, bool, Vec<Option<f64>>)> = browser.get(code);
    let shown = found.into_iter().filter(|(_, show, _)| *show);
    shown.map(|(label, _, values)| (label, values.into_iter().flatten().collect())).collect()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

fn table(browser: &Browser) -> Vec<Vec<String>> {
    browser.get(
        "return [...document.querySelectorAll('#cells tbody tr')].map((row) => \
         [...row.cells].map((cell) => cell.textContent))",
    )
}

#[test]
fn the_page_works_in_a_browser() {
    let at = Place::new();
    let page = report(&at);
    let Some(browser) = Browser::open(1400, 1000) else { return };
    browser.show(&page);
    assert_eq!(browser.log(), [""; 0]);
    opens_safely(&browser);
    charts(&browser);
    results(&browser);
    narrow(&browser, &page);
    assert_eq!(browser.log(), [""; 0], "after all clicks");
}

/// The answer is visible, markup in a name stays text, and the page does not use the network.
fn opens_safely(browser: &Browser) {
    assert_eq!(browser.run("return window.evil ?? null"), Value::Null);
    assert_eq!(browser.run("return document.title"), "Who is fast? <b>");
    let said = browser.text(".card.speed");
    assert!(said.contains("in 6 of 6 scenes"), "{said}");
    let body = browser.text("body");
    let license = "Permission is hereby granted";
    for part in ["1 of 1 claim hold", "30 s", "contactbench run e.toml <b>", "A & B", EVIL, license]
    {
        assert!(body.contains(part), "{part}");
    }
    // `decode` waits until an image is loaded.
    let images: Vec<u32> = browser.get(
        "return Promise.all([...document.querySelectorAll('img')].map((it) => { it.loading = 'eager'; \
         return it.decode().then(() => it.naturalWidth) }))",
    );
    assert!(images.len() == 1 && images[0] > 100, "the figure, and no image of a name: {images:?}");
    let requests: Vec<String> = browser.get(
        "return performance.getEntriesByType('resource').map((e) => e.name).filter((n) => \
         !n.startsWith('data:'))",
    );
    assert_eq!(requests, [""; 0]);
}

fn charts(browser: &Browser) {
    let medians = medians();
    let expected = |scene: &str, dim: u64, detector: &str, arithmetic: &str| -> Vec<(f64, f64)> {
        let found = medians.iter().filter(|((s, d, who, how, _), _)| {
            s == scene && *d == dim && who == detector && how == arithmetic
        });
        found.map(|((.., n), time)| (*time, *n as f64)).collect()
    };
    let per = |times: Vec<(f64, f64)>| times.into_iter().map(|(time, n)| time / n).collect();
    let same = |label: &str, expected: Vec<f64>| {
        let found = &series(browser)[label];
        let equal = found.iter().zip(&expected).all(|(a, b)| close(*a, *b));
        assert!(equal && found.len() == expected.len(), "{label}: {found:?} {expected:?}");
    };
    // At first the chart shows packed scenes in 3D and exact arithmetic, without controls.
    assert_eq!(series(browser).into_keys().collect::<Vec<_>>(), [EVIL, "nbs", "sorting"]);
    for detector in ["nbs", "sorting", EVIL] {
        same(detector, per(expected("packed", 3, detector, "exact")));
    }
    let toggle = "#legend button:nth-child(2)";
    browser.click(toggle);
    assert!(!series(browser).contains_key("nbs"));
    let pressed = format!("return document.querySelector('{toggle}').ariaPressed");
    assert_eq!(browser.run(&pressed), "false");
    browser.choose("#by-dim", "2D");
    assert!(!series(browser).contains_key("nbs"), "what is hidden stays hidden");
    browser.click(toggle);
    same("nbs", per(expected("packed", 2, "nbs", "exact")));
    browser.choose("#by-arithmetic", "all");
    same("sorting (f64)", per(expected("packed", 2, "sorting", "f64")));
    browser.choose("#by-arithmetic", "f64");
    browser.choose("#by-scene", "loose");
    same("nbs", per(expected("loose", 2, "nbs", "f64")));
    browser.click("#per-particle");
    same("nbs", expected("loose", 2, "nbs", "f64").into_iter().map(|it| it.0).collect());
    let scales = || -> [u32; 2] {
        browser.get(
            "const it = document.getElementById('chart').chart.scales; return [it.x.distr, \
             it.y.distr]",
        )
    };
    assert_eq!(scales(), [3, 3]);
    browser.click("#log-x");
    browser.click("#log-y");
    assert_eq!(scales(), [1, 1]);
    for (metric, values) in [
        ("Memory (peak)", [1200.0, 12000.0]),
        ("Operations (all)", [400.0, 4000.0]),
        ("Contact tests", [300.0, 3000.0]),
        ("Error", [1.0 / 200.0, 10.0 / 2000.0]),
    ] {
        browser.choose("#metric", metric);
        same("nbs", values.into());
    }
    browser.choose("#by-arithmetic", "exact");
    same("nbs", vec![0.0, 0.0]);
    browser.click("#log-y");
    let note = browser.text("#chart-note");
    assert!(note.contains("values of 0"), "{note}");
    // Arrow keys move the cursor, which shows values.
    browser.choose("#metric", "Time");
    browser.keys("#chart", "\u{e014}");
    let tip = browser.text("#tip:not([hidden])").replace(',', "");
    let value = expected("loose", 2, "nbs", "exact")[0].0;
    assert!(tip.contains("N = 100") && tip.contains(&value.to_string()), "{tip}: no {value}");
}

fn results(browser: &Browser) {
    let heads: Vec<String> = browser.get(
        "return [...document.querySelectorAll('#cells thead button')].map((button) => \
         button.textContent.replace(/ [▲▼]$/, ''))",
    );
    assert_eq!(table(browser).len(), 8 * 4 * 2);
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let [n, time, detector, scene, dim] =
        ["N", "ns / N", "detector", "scene", "dimension"].map(column);
    let number = |text: &str| text.replace(',', "").parse::<f64>().ok();
    let head = format!("#cells th:nth-child({})", time + 1);
    for (said, sign) in [("ascending", 1.0), ("descending", -1.0)] {
        browser.click(&format!("{head} button"));
        assert_eq!(browser.run(&format!("return document.querySelector('{head}').ariaSort")), said);
        let times: Vec<Option<f64>> = table(browser).iter().map(|row| number(&row[time])).collect();
        let values: Vec<f64> = times.iter().flatten().map(|time| sign * time).collect();
        assert!(values.len() == 60 && values.is_sorted(), "{values:?}");
        assert!(times[60..].iter().all(Option::is_none), "what has no time comes last");
    }
    browser.choose("#only-detector", "nbs");
    browser.keys("#words", "packed exact");
    let shown = table(browser);
    assert_eq!((shown.len(), browser.text("#count")), (6, "6 of 64 rows".into()));
    for row in &shown {
        assert!(row[detector] == "nbs" && row.iter().any(|cell| cell == "exact"), "{row:?}");
    }
    browser.click("#csv");
    let text = browser.downloaded("results.csv");
    let lines = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
    let lines: Vec<Vec<String>> = lines.into_deserialize().map(Result::unwrap).collect();
    assert_eq!((lines.len(), &lines[0]), (7, &heads));
    let medians = medians();
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
        let (scene, dim) = (line[scene].clone(), line[dim].parse().unwrap());
        let median = medians[&(scene, dim, "nbs".into(), "exact".into(), size)];
        assert!(close(line[time].parse().unwrap(), median / size as f64), "{line:?}");
    }
}

/// On a phone, the page is not wider than the screen, and the answer is visible without scrolling.
fn narrow(browser: &Browser, page: &Path) {
    for (scheme, ground) in [("light", "rgb(255, 255, 255)"), ("dark", "rgb(22, 24, 29)")] {
        browser.phone();
        let features = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        browser.devtools("Emulation.setEmulatedMedia", features);
        browser.show(page);
        assert_eq!(browser.run("return document.documentElement.scrollWidth"), 390, "{scheme}");
        assert_eq!(browser.run("return getComputedStyle(document.body).backgroundColor"), ground);
        let bottom: f64 = browser
            .get("return document.querySelector('.card.speed').getBoundingClientRect().bottom");
        assert!(bottom < 500.0, "the answer ends at {bottom}");
    }
}
