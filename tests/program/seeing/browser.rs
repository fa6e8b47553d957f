//! A real browser for tests: Chromium, driven by chromedriver over the WebDriver protocol (JSON
//! over HTTP, on this machine alone).

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

const OPTIONS: [&str; 9] = [
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
];

/// A window of a browser; closed when dropped.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
    folder: tempfile::TempDir,
}

/// Whether a program can be started.
fn is_there(program: &str) -> bool {
    Command::new(program)
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

impl Browser {
    /// Opens a window of this size; none where Chromium or chromedriver are not installed, unless
    /// `CONTACTBENCH_BROWSER=required`.
    pub fn open(width: u32, height: u32) -> Option<Browser> {
        let chromium = ["chromium", "chromium-browser", "google-chrome"]
            .into_iter()
            .find(|name| is_there(name));
        let (Some(chromium), true) = (chromium, is_there("chromedriver")) else {
            let required =
                std::env::var("CONTACTBENCH_BROWSER").is_ok_and(|value| value == "required");
            assert!(
                !required,
                "CONTACTBENCH_BROWSER=required, but chromium and chromedriver are not there"
            );
            crate::common::untested("pages in a browser", "chromium with chromedriver");
            return None;
        };
        let mut driver = Command::new("chromedriver")
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let lines = BufReader::new(driver.stdout.take().unwrap()).lines();
        let port = lines.map_while(Result::ok).find_map(|line| {
            line.split_once("successfully on port ")?.1.trim_end_matches('.').parse().ok()
        });
        let folder = tempfile::tempdir().unwrap();
        let mut browser = Browser {
            driver,
            port: port.expect("chromedriver says its port"),
            session: String::new(),
            folder,
        };
        let path = std::env::split_paths(&std::env::var_os("PATH").unwrap())
            .map(|folder| folder.join(chromium))
            .find(|path| path.exists());
        let mut options: Vec<String> = OPTIONS.map(String::from).into();
        options.push(format!("--window-size={width},{height}"));
        options
            .push(format!("--user-data-dir={}", browser.folder.path().join("profile").display()));
        let wanted = json!({"capabilities": {"alwaysMatch": {
            "browserName": "chrome",
            "goog:loggingPrefs": {"browser": "ALL"},
            "goog:chromeOptions": {"binary": path, "args": options,
                "prefs": {"download.default_directory": browser.downloads(), "download.prompt_for_download": false}},
        }}});
        let opened = browser.send("POST", "/session", &wanted);
        browser.session = opened["sessionId"].as_str().expect("a session").to_string();
        Some(browser)
    }

    /// Where downloads go.
    pub fn downloads(&self) -> PathBuf {
        self.folder.path().join("downloads")
    }

    /// One request; the value of the answer.
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

    /// Opens a file.
    pub fn show(&self, file: &Path) {
        self.post(
            "/url",
            json!({"url": format!("file://{}", file.canonicalize().unwrap().display())}),
        );
    }

    /// What a piece of JavaScript returns.
    pub fn run(&self, code: &str) -> Value {
        self.post("/execute/sync", json!({"script": code, "args": []}))
    }

    fn find(&self, css: &str) -> String {
        let found = self.post("/element", json!({"using": "css selector", "value": css}));
        found
            .as_object()
            .and_then(|object| object.values().next()?.as_str().map(String::from))
            .expect("an element")
    }

    /// Clicks on the first element that this selector finds, as a mouse would: fails if something
    /// is in front of it.
    pub fn click(&self, css: &str) {
        let element = self.find(css);
        self.post(&format!("/element/{element}/click"), json!({}));
    }

    /// Types into the first element that this selector finds.
    pub fn keys(&self, css: &str, text: &str) {
        let element = self.find(css);
        self.post(&format!("/element/{element}/value"), json!({"text": text}));
    }

    /// Chooses the option with this text.
    pub fn choose(&self, select: &str, text: &str) {
        let k = self.run(&format!(
            "return [...document.querySelector({select:?}).options].findIndex((o) => o.text === \
             {text:?})"
        ));
        assert_ne!(k, -1, "{select} has no option {text}");
        self.click(&format!("{select} option:nth-child({})", k.as_u64().unwrap() + 1));
    }

    /// A command of the DevTools protocol.
    pub fn devtools(&self, command: &str, parameters: Value) -> Value {
        self.post("/goog/cdp/execute", json!({"cmd": command, "params": parameters}))
    }

    /// What stands in the console: warnings, errors, refused requests.
    pub fn log(&self) -> Vec<String> {
        let entries = self.post("/se/log", json!({"type": "browser"}));
        entries.as_array().unwrap().iter().map(|entry| entry.to_string()).collect()
    }

    /// The content of a downloaded file.
    pub fn downloaded(&self, name: &str) -> String {
        let (path, begun) = (self.downloads().join(name), Instant::now());
        while begun.elapsed() < Duration::from_secs(20) {
            match std::fs::read_to_string(&path) {
                Ok(text) if !text.is_empty() => return text,
                _ => std::thread::sleep(Duration::from_millis(50)),
            }
        }
        panic!("{name} was not downloaded");
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() && !std::thread::panicking() {
            self.send("DELETE", &format!("/session/{}", self.session), &Value::Null);
        }
        // A driver that is killed takes its browser along.
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
