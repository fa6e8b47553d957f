//! Tests pages that step through a trace.

use std::collections::BTreeMap;

use contactbench::views::trace::{Algorithm, page, trace};
use serde_json::{Value, json};

use super::ALL;
use super::browser::in_browser;

/// The page of a trace loads no other files, escapes any name, and contains readable data.
#[test]
fn a_page_needs_nothing_else_and_holds_any_name() {
    let name = "</script><script>alert(1)</script>&\"'{{data}}.csv";
    let outside =
        ["http:", "https:", "src=", "href=", "url(", "@import", "fetch(", "alert(1)</script>"];
    for algorithm in ALL {
        let trace = trace(algorithm, None).unwrap();
        let html = page::html(&trace, name);
        assert!(html.len() < 100_000);
        assert!(outside.iter().all(|outside| !html.contains(outside)), "{algorithm:?}");
        assert_eq!(html.matches("{{").count(), 2, "places were not filled, or a name was");
        assert!(html.contains(
            "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;&#39;{{data}}.csv"
        ));
        assert_eq!(html.matches("</script>").count(), 2);
        let data = html.split("<script type=\"application/json\" id=\"data\">").nth(1).unwrap();
        let data = data.split("</script>").next().unwrap();
        let data: Value = serde_json::from_str(data).unwrap();
        let told = data["steps"].as_array().unwrap();
        assert_eq!(told.len(), trace.steps.len());
        // What the steps change, one after the other, gives the arrays of each step.
        let mut arrays: BTreeMap<char, Vec<Value>> = BTreeMap::new();
        for (step, told) in trace.steps.iter().zip(told) {
            for change in told[3].as_array().unwrap() {
                let letter = change[0].as_str().unwrap().chars().next().unwrap();
                let (at, slots) = (change[1].as_u64().unwrap(), arrays.entry(letter).or_default());
                slots.resize(slots.len().max(at as usize + 1), Value::Null);
                slots[at as usize] = change[2].clone();
            }
            for (letter, slots) in &arrays {
                assert_eq!(json!(step.state.array(*letter)), json!(slots), "{algorithm:?}");
            }
        }
    }
}

/// A page opens at the step in its address; keys, buttons and the bar change the step.
#[test]
fn a_page_steps_in_a_browser() {
    let trace = trace(Algorithm::Screening, None).unwrap();
    let html = page::html(&trace, "in a browser");
    let keys =
        ["ArrowRight", " ", "PageDown", "ArrowLeft", "End", "ArrowRight", "Home", "ArrowLeft"];
    let code = "const text = (id) => $(id).textContent; const opened = text('step'); const reached \
                = keys.map((key) => { dispatchEvent(new KeyboardEvent('keydown', { key })); return \
                at; }); $('next').click(); reached.push(at); $('bar').value = 20; \
                $('bar').dispatchEvent(new Event('input')); return [opened, reached, location.hash, \
                text('words'), text('counts'), $('contacts').getAttribute('d').split('M').length - \
                1, text('arrays').length > 100]";
    let Some(found) = in_browser(&html, "#45", &format!("const keys = {keys:?}; {code}")) else {
        return;
    };
    let step = &trace.steps[20];
    let counts = found[4].as_str().unwrap();
    let tests = step.tally.get(contactbench_ground::probe::Op::ContactTest);
    assert!(counts.ends_with(&format!("contact test {tests}")), "{counts}");
    let reached = [46, 47, 48, 47, 69, 69, 0, 0, 1];
    let contacts = step.state.contacts.len();
    let expected = json!(["step 45 of 69", reached, "#20", step.words, counts, contacts, true]);
    assert_eq!(found, expected);
}
