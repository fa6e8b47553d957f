//! Tests positions on the page of a report in a browser, on a wide screen and on a phone.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::browser::Browser;
use super::page::report;
use crate::common::Place;

/// Returns the position of a side of an element; `None` if it is hidden.
fn side(browser: &Browser, selector: &str, side: &str) -> Option<f64> {
    let script = format!(
        "const it = document.querySelector('{selector}'); return it.checkVisibility() ? \
         it.getBoundingClientRect().{side} : null"
    );
    browser.run(&script).as_f64()
}

#[test]
fn axes_and_results_are_seen_at_every_width() {
    let at = Place::new();
    let page = report(&at);
    let Some(browser) = Browser::open(1280, 1000) else { return };
    browser.show(&page);
    // The axis of the table overlaps neither its heading nor the next column.
    let end = side(&browser, "table.answer thead text:last-of-type", "right").unwrap();
    let next = side(&browser, "table.answer th:nth-child(6)", "left").unwrap();
    assert!(end <= next, "{end} {next}");
    let head = side(&browser, "table.answer th:nth-child(5) span", "bottom").unwrap();
    let axis = side(&browser, "table.answer thead svg", "top").unwrap();
    assert!(head <= axis + 1.0, "{head} {axis}");
    assert_eq!(side(&browser, ".strip.own", "top"), None, "one axis is enough");

    browser.phone();
    browser.show(&page);
    assert!(side(&browser, ".strip.own", "top").is_some(), "each strip has its axis");
    // The labels, which replace the heads, are those of their columns.
    let labels = browser.run(
        "const at = (tag, k) => document.querySelector(`table.answer ${tag}:nth-child(${k})`);
         return [[4, '::after'], [6, '::before']].map(([k, side]) =>
             at('th', k).textContent + getComputedStyle(at('td', k), side).content)",
    );
    assert_eq!(labels, json!(["time / pair (ns)\" ns per pair\"", "runner-up\"runner-up: \""]));
    let heads = browser.run(
        "return [...document.querySelectorAll('#cells th')].slice(0, 3).map(it => it.textContent)",
    );
    assert_eq!(heads, json!(["detector", "ns / N", "N"]));
    assert!(side(&browser, "#cells th:nth-child(2)", "right").unwrap() <= 390.0);
    let scrolled = "document.querySelector('.scroll.tall').scrollLeft = 300; return 0";
    assert_eq!(browser.run(scrolled), Value::from(0));
    assert!(side(&browser, "#cells td:first-child", "left").unwrap() >= 0.0, "it stays");
}

/// The page of a report is complete without the folder of figures.
#[test]
fn a_page_that_was_moved_still_gives_pictures() {
    let at = Place::new();
    let page = report(&at);
    let Some(browser) = Browser::open(1280, 1000) else { return };
    at.remove("figures");
    browser.show(&page);
    browser.run(
        "window.made = [];
         HTMLAnchorElement.prototype.click = function () { made.push(this.href.slice(0, 22)); }",
    );
    // Clicks again until the figure is drawn.
    let click = "
        const link = document.querySelector('a[data-kind=PNG]');
        link.dispatchEvent(new MouseEvent('click', { cancelable: true, bubbles: true }));
        return made[0] ?? null";
    let begun = Instant::now();
    while browser.run(click).is_null() && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(100));
    }
    assert_eq!(browser.run(click), "data:image/png;base64,");
}
