//! Tests pages that step through a trace.

use contactbench::views::trace::{page, trace};

use super::ALL;

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
