//! Runs Chromium for tests, through chromedriver on this machine and the WebDriver protocol.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::common::{starts, untested};

const OPTIONS: &str = "--headless=new --no-sandbox --disable-gpu --disable-quic --no-first-run \
                       --disable-background-networking --disable-component-update --disable-sync \
                       --disable-dev-shm-usage";

pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
    /// Deleted at the end.
    _folder: tempfile::TempDir,
}

impl Browser {
    /// Opens a window of this size. Without Chromium and chromedriver it returns `None`, or panics
    /// if `CONTACTBENCH_BROWSER=required`.
    pub fn open(width: u32, height: u32) -> Option<Browser> {
        let names = ["chromium", "chromium-browser", "google-chrome"];
        let chromium = names.into_iter().find(|name| starts(name, "--version"));
        let (Some(chromium), true) = (chromium, starts("chromedriver", "--version")) else {
            let required = std::env::var("CONTACTBENCH_BROWSER").is_ok_and(|it| it == "required");
            assert!(!required, "CONTACTBENCH_BROWSER=required: no chromium or chromedriver");
            untested("pages in a browser", "chromium with chromedriver");
            return None;
        };
        let folder = tempfile::tempdir().unwrap();
        let mut driver = Command::new("chromedriver");
        driver.arg("--port=0").env("HOME", folder.path()).env("LC_ALL", "C.UTF-8");
        driver.stdout(Stdio::piped()).stderr(Stdio::null());
        let mut driver = driver.spawn().unwrap();
        let lines = BufReader::new(driver.stdout.take().unwrap()).lines();
        let port = lines.map_while(Result::ok).find_map(|line| {
            line.split_once("successfully on port ")?.1.trim_end_matches('.').parse().ok()
        });
        let port = port.expect("chromedriver prints its port");
        let path = std::env::split_paths(&std::env::var_os("PATH").unwrap())
            .map(|folder| folder.join(chromium))
            .find(|path| path.exists());
        let mut options: Vec<String> = OPTIONS.split(' ').map(String::from).collect();
        options.push(format!("--window-size={width},{height}"));
        options.push(format!("--user-data-dir={}", folder.path().join("profile").display()));
        let mut browser = Browser { driver, port, session: String::new(), _folder: folder };
        let wanted = json!({"capabilities": {"alwaysMatch": {
            "browserName": "chrome",
            "goog:loggingPrefs": {"browser": "ALL"},
            "goog:chromeOptions": {"binary": path, "args": options},
        }}});
        let opened = browser.send("POST", "/session", &wanted);
        browser.session = opened["sessionId"].as_str().expect("a session").to_string();
        Some(browser)
    }

    fn send(&self, method: &str, path: &str, body: &Value) -> Value {
        let body = if method == "POST" { body.to_string() } else { String::new() };
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: localhost\r\nContent-Type: \
             application/json\r\nContent-Length: {}\r\n\r\n",
            body.len()
        );
        stream.write_all((head + &body).as_bytes()).unwrap();
        let (mut reader, mut length, mut line) = (BufReader::new(stream), 0, String::new());
        while reader.read_line(&mut line).unwrap() > 2 {
            if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
                length = value.trim().parse().unwrap();
            }
            line.clear();
        }
        let mut answer = vec![0; length];
        reader.read_exact(&mut answer).unwrap();
        let value = serde_json::from_slice::<Value>(&answer).unwrap()["value"].take();
        assert!(value.get("error").is_none(), "{method} {path}: {value}");
        value
    }

    fn post(&self, path: &str, body: Value) -> Value {
        self.send("POST", &format!("/session/{}{path}", self.session), &body)
    }

    pub fn show(&self, file: &Path) {
        let file = file.canonicalize().unwrap();
        self.post("/url", json!({"url": format!("file://{}", file.display())}));
    }

    /// Runs JavaScript, and returns its result as JSON.
    pub fn run(&self, code: &str) -> Value {
        self.post("/execute/sync", json!({"script": code, "args": []}))
    }

    /// Runs JavaScript, and returns its result as a `T`.
    pub fn get<T: DeserializeOwned>(&self, code: &str) -> T {
        serde_json::from_value(self.run(code)).unwrap_or_else(|error| panic!("{code}: {error}"))
    }

    /// Returns the text of the first element that matches the selector.
    pub fn text(&self, css: &str) -> String {
        self.get(&format!("return document.querySelector({css:?}).textContent"))
    }

    /// Applies an action to the first element that matches the selector.
    fn act(&self, css: &str, action: &str, body: Value) {
        let found = self.post("/element", json!({"using": "css selector", "value": css}));
        let element = found.as_object().and_then(|it| it.values().next()?.as_str());
        self.post(&format!("/element/{}/{action}", element.expect("an element")), body);
    }

    /// Clicks the element as a mouse does; fails if something covers it.
    pub fn click(&self, css: &str) {
        self.act(css, "click", json!({}));
    }

    pub fn keys(&self, css: &str, text: &str) {
        self.act(css, "value", json!({"text": text}));
    }

    /// Returns the lines of the console: warnings, errors, refused requests.
    pub fn log(&self) -> Vec<String> {
        let entries = self.post("/se/log", json!({"type": "browser"}));
        entries.as_array().unwrap().iter().map(|entry| entry.to_string()).collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() {
            // Closes the browser, which would go on without its driver; ignores errors.
            let end = || self.send("DELETE", &format!("/session/{}", self.session), &Value::Null);
            let _ = std::panic::catch_unwind(std::panic::AssertUnwindSafe(end));
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
