//! Tests pages that step through a trace.

use contactbench::views::trace::{Algorithm, page, trace};

use super::ALL;
use super::browser::Browser;
use crate::common::Place;

/// The page of a trace loads no other files, escapes any name, and contains readable data.
#[test]
fn a_page_needs_nothing_else_and_holds_any_name() {
    let name = "</script><script>alert(1)</script>&\"'{{data}}.csv";
    let outside =
        ["http:", "https:", "src=", "href=", "url(", "@import", "fetch(", "alert(1)</script>"];
    for algorithm in ALL {
        let trace = trace(algorithm, None).unwrap();
        let html = page::html(&trace, name);
        assert!(html.len() < 5_000_000);
        assert!(outside.iter().all(|outside| !html.contains(outside)), "{algorithm:?}");
        assert_eq!(html.matches("{{").count(), 2, "places were not filled, or a name was");
        assert!(html.contains(
            "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;&#39;{{data}}.csv"
        ));
        assert_eq!(html.matches("</script>").count(), 2);
        let data = html.split("<script type=\"application/json\" id=\"data\">").nth(1).unwrap();
        let data = data.split("</script>").next().unwrap();
        let data: serde_json::Value = serde_json::from_str(data).unwrap();
        assert_eq!(data["steps"].as_array().unwrap().len(), trace.steps.len());
    }
}

/// A page opens at the step in its address; keys, buttons and the bar change the step.
#[test]
fn a_page_steps_in_a_browser() {
    let Some(browser) = Browser::open(1200, 900) else { return };
    let at = Place::new();
    let trace = trace(Algorithm::Screening, None).unwrap();
    browser.show(&at.file("page.html", page::html(&trace, "in a browser")));
    let text = |id: &str| browser.run(&format!("return $('{id}').textContent"));
    browser.run("location.hash = '#45'; show(45)");
    assert_eq!(text("step"), "step 45 of 69");
    for (key, step) in [
        ("ArrowRight", 46),
        (" ", 47),
        ("PageDown", 48),
        ("ArrowLeft", 47),
        ("End", 69),
        ("ArrowRight", 69),
        ("Home", 0),
        ("ArrowLeft", 0),
    ] {
        browser.run(&format!("dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}' }}))"));
        assert_eq!(browser.run("return at"), step, "{key}");
    }
    browser.click("#next");
    assert_eq!(browser.run("return at"), 1);
    browser.run("$('bar').value = 20; $('bar').dispatchEvent(new Event('input'))");
    assert_eq!(browser.run("return location.hash"), "#20");
    let step = &trace.steps[20];
    assert_eq!(text("words"), step.words);
    let tests = step.tally.get(contactbench_ground::probe::Op::ContactTest);
    let counts = text("counts");
    assert!(counts.as_str().unwrap().ends_with(&format!("contact test {tests}")), "{counts}");
    let contacts = browser.run("return $('contacts').getAttribute('d').split('M').length - 1");
    assert_eq!(contacts, step.state.contacts.len());
    assert!(browser.run("return $('arrays').textContent.length").as_u64() > Some(100));
    assert!(browser.log().is_empty(), "{:?}", browser.log());
}
