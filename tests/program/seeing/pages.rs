//! Pages that step through a trace.

use contactbench::views::trace::{Algorithm, page, still, trace};

use super::ALL;
use crate::common::file;

/// No address of anything else, no name that becomes markup, and all data readable.
#[test]
fn a_page_needs_nothing_else_and_holds_any_name() {
    let name = "</script><script>alert(1)</script>&\"'@@DATA@@.csv";
    for algorithm in ALL {
        let trace = trace(algorithm, None).unwrap();
        let html = page::html(&trace, name);
        assert!(html.len() < 5_000_000);
        for outside in
            ["http:", "https:", "src=", "href=", "url(", "@import", "fetch(", "alert(1)</script>"]
        {
            assert!(!html.contains(outside), "{algorithm:?}: {outside}");
        }
        assert_eq!(html.matches("@@").count(), 4, "places were not filled, or a name was");
        assert!(html.contains(
            "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;&#39;@@DATA@@.csv"
        ));
        assert_eq!(html.matches("</script>").count(), 2);
        let data = html
            .split("<script type=\"application/json\" id=\"data\">")
            .nth(1)
            .unwrap()
            .split("</script>")
            .next()
            .unwrap();
        let data: serde_json::Value = serde_json::from_str(data).unwrap();
        assert_eq!(data["steps"].as_array().unwrap().len(), trace.steps.len());
        let svg = still::Stills::new(&trace, name).svg(trace.steps.len() - 1).unwrap();
        assert!(svg.contains("&lt;/script&gt;") && !svg.contains("<script"));
    }
}

/// The page in a browser: it shows the step of its address, and keys, buttons and the bar step.
/// Without Chromium nothing is tested.
#[test]
fn a_page_steps_in_a_browser() {
    let script = r#"<script>
        const seen = [$("step").textContent];
        const press = (key) => { dispatchEvent(new KeyboardEvent("keydown", { key })); seen.push(at); };
        ["ArrowRight", " ", "PageDown", "ArrowLeft", "ArrowUp", "ArrowDown", "End", "ArrowRight", "Home", "ArrowLeft"].forEach(press);
        $("next").click(); seen.push(at);
        $("bar").value = 20; $("bar").dispatchEvent(new Event("input")); seen.push(at, location.hash);
        seen.push($("counts").textContent, $("words").textContent, $("contacts").getAttribute("d").split("M").length - 1, $("arrays").textContent.length > 100);
        document.documentElement.dataset.seen = JSON.stringify(seen);
    </script>"#;
    let folder = tempfile::tempdir().unwrap();
    let trace = trace(Algorithm::Screening, None).unwrap();
    let html = page::html(&trace, "in a browser").replace("</body>", &format!("{script}</body>"));
    let page = file(folder.path(), "page.html", html);
    let mut command = std::process::Command::new("chromium");
    command.args([
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--virtual-time-budget=3000",
        "--dump-dom",
    ]);
    command
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("file://{}#45", page.display()));
    let Ok(output) = command.output() else { return };
    let dom = String::from_utf8_lossy(&output.stdout).into_owned();
    let seen = dom
        .split("data-seen=\"")
        .nth(1)
        .unwrap_or_else(|| panic!("{dom}"))
        .split('"')
        .next()
        .unwrap()
        .replace("&quot;", "\"");
    let seen: serde_json::Value = serde_json::from_str(&seen).unwrap();
    let parts = |step: usize| trace.steps[step].part;
    let begins = |part: usize| trace.steps.iter().position(|step| step.part == part).unwrap();
    let here = begins(parts(47));
    let expected = [46, 47, 48, 47, here, begins(parts(here) + 1), 69, 69, 0, 0, 1, 20];
    assert_eq!(seen[0], "step 45 of 69");
    assert_eq!(seen.as_array().unwrap()[1..13], expected.map(serde_json::Value::from));
    assert_eq!(seen[13], "#20");
    let tests = trace.steps[20].tally.get(contactbench::probe::Op::ContactTest);
    assert!(seen[14].as_str().unwrap().ends_with(&format!("contact test {tests}")), "{}", seen[14]);
    assert_eq!(seen[15], trace.steps[20].words);
    assert_eq!(
        (seen[16].as_u64(), seen[17].as_bool()),
        (Some(trace.steps[20].state.contacts.len() as u64), Some(true))
    );
}
