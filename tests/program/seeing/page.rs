//! Tests `report.html`: its values are those of the record, and its script works in a browser.

use contactbench::record::folder::{copies, seal};
use contactbench_terms::number::short;
use serde_json::{Value, json};

use super::browser::in_browser;
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

pub fn report(at: &Place) {
    std::fs::create_dir_all(at.path("experiments")).unwrap();
    at.file("experiments/e.toml", EXPERIMENT);
    let sealed = |value: &Value| seal::sealed(&value.to_string()) + "\n";
    let mut provenance = json!({"command": "contactbench run e.toml <b>", "cpu": "A & B"});
    provenance[copies::FIELD] = copies::field([("e", EXPERIMENT)].into_iter());
    at.file("provenance.json", sealed(&provenance));
    at.file("samples.jsonl", rows().iter().map(sealed).collect::<String>());
    at.good("report .");
}

#[test]
fn a_page_has_every_result_and_takes_nothing_for_markup() {
    let at = Place::new();
    report(&at);
    let page = at.read("report.html");
    let escaped = "&lt;/script&gt;&lt;img src=x onerror=&quot;window.evil=1&quot;&gt;&lt;!--";
    assert!(page.contains(escaped) && !page.contains("<img") && !page.contains("{{"));
    for part in ["in 6 of 6", "<td>holds</td>", "30 s", "run e.toml &lt;b&gt;", "A &amp; B"] {
        assert!(page.contains(part), "{part}");
    }
    let (_, table) = page.split_once("<table class=\"results\">").unwrap();
    let (table, _) = table.split_once("</table>").unwrap();
    assert_eq!(table.matches("<tr>").count(), 1 + 8 * 4 * 2);
    // The median of seven times of nbs with 100 particles, in nanoseconds per particle.
    let mut times: Vec<u64> = (1..=7).map(|block| time(0, 100, block, 2)).collect();
    times.sort();
    let shown = format!("<td class=\"number\">{}</td>", short(times[3] as f64 / 100.0));
    assert!(table.contains(&shown), "{shown} is not in {table}");
    // A detector is named by its colour in the legend, and drawn with it.
    let (_, legend) = page.split_once("data-colour=\"").unwrap();
    let colour = legend.split('"').next().unwrap();
    assert!(page.contains(&format!("stroke=\"{colour}\"")), "{colour}");
}

#[test]
fn the_page_sorts_filters_and_highlights_in_a_browser() {
    let at = Place::new();
    report(&at);
    let html = at.read("report.html");
    let helpers = "const all = (css) => [...document.querySelectorAll(css)]; const count = (css) => \
                   all(css).length; const type = (text) => { const it = all('#words')[0]; it.value \
                   = text; it.dispatchEvent(new Event('input')); };";
    let run = |place: &str, code: &str| in_browser(&html, place, &(helpers.to_string() + code));
    let opened = "return [window.evil ?? null, count('figure svg'), count('.results tbody tr')]";
    let Some(opened) = run("", opened) else { return };
    assert_eq!(opened, json!([null, 1, 64]));
    let sorted = "return [1, 2].map(() => { all('.results th:nth-child(7) button')[0].click(); \
                  return all('.results tbody td:nth-child(7)').map((it) => it.textContent); })";
    let sorted: [Vec<String>; 2] = serde_json::from_value(run("", sorted).unwrap()).unwrap();
    for (sign, times) in [1.0, -1.0].into_iter().zip(sorted) {
        let numbers = times.into_iter().map_while(|text| text.parse::<f64>().ok());
        let numbers: Vec<f64> = numbers.map(|time| sign * time).collect();
        assert!(numbers.len() == 60 && numbers.is_sorted(), "{numbers:?}");
    }
    let typed = "type('nbs exact packed'); return [count('.results tbody tr'), \
                 all('#count')[0].textContent, location.hash]";
    let typed = run("", typed).unwrap();
    assert_eq!((&typed[0], &typed[1]), (&json!(6), &json!(" 6 of 64 rows")));
    let place = typed[2].as_str().unwrap();
    let chosen = "const button = all('.who button')[1]; const shown = () => \
                  [count('.results tbody tr'), count('.results tr.chosen'), count('figure svg \
                  .faded'), count('figure svg *')]; button.click(); const first = shown(); \
                  button.click(); return [first, shown()]";
    let chosen: [[usize; 4]; 2] = serde_json::from_value(run(place, chosen).unwrap()).unwrap();
    let [[rows, chosen, faded, parts], after] = chosen;
    assert_eq!((rows, chosen), (6, 6), "the address keeps the filter");
    assert!(faded > 0 && faded < parts);
    assert_eq!(after[1..3], [0, 0]);
}
