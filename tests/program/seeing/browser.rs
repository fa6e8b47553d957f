//! Runs scripts in pages, in Chromium.

use std::process::Command;

use serde_json::Value;

use crate::common::{starts, untested};

const OPTIONS: &str = "--headless=new --no-sandbox --disable-gpu --no-first-run --disable-sync \
                       --disable-background-networking --disable-component-update \
                       --disable-dev-shm-usage --window-size=1280,1000 --enable-logging=stderr";

/// Runs JavaScript in a page that is loaded at this place in it, and returns what it returns. The
/// console must be empty. Without Chromium it returns `None`, or panics if
/// `CONTACTBENCH_BROWSER=required`.
pub fn in_browser(html: &str, place: &str, code: &str) -> Option<Value> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let Some(chromium) = names.into_iter().find(|name| starts(name, "--version")) else {
        let required = std::env::var("CONTACTBENCH_BROWSER").is_ok_and(|it| it == "required");
        assert!(!required, "CONTACTBENCH_BROWSER=required: no chromium");
        untested("pages in a browser", "chromium");
        return None;
    };
    let folder = tempfile::tempdir().unwrap();
    let script = format!(
        "<script nonce=\"contactbench\">{{ const it = document.createElement('script'); it.type = \
         'text/json'; it.textContent = JSON.stringify((() => {{ {code} }})()); \
         document.body.append(it); }}</script>"
    );
    let page = folder.path().join("page.html");
    std::fs::write(&page, html.to_string() + &script).unwrap();
    let mut browser = Command::new(chromium);
    browser.args(OPTIONS.split(' ')).arg("--dump-dom");
    browser.arg(format!("--user-data-dir={}", folder.path().join("profile").display()));
    browser.arg(format!("file://{}{place}", page.display()));
    let output = browser.env("HOME", folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains(":CONSOLE"), "{said}");
    let shown = String::from_utf8(output.stdout).unwrap();
    let (_, answer) = shown.rsplit_once("<script type=\"text/json\">").expect("an answer");
    Some(serde_json::from_str(answer.split("</script>").next().unwrap()).unwrap())
}
