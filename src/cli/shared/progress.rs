//! Progress of a run or of a pass over frames: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::shared::terminal::say;
use contactbench_run::run::stage::{Found, Progress};
use contactbench_terms::number::number;
use contactbench_terms::text::line;

const TICK: Duration = Duration::from_millis(500);

/// A progress bar on a terminal, removed when dropped; elsewhere nothing.
struct Bar(Option<ProgressBar>);

impl Bar {
    fn new(length: Option<u64>, template: &str) -> Bar {
        Bar(std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template(template);
            let bar = length.map_or_else(ProgressBar::no_length, ProgressBar::new);
            bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        }))
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.iter().for_each(ProgressBar::finish_and_clear);
    }
}

/// Returns the time after which a run writes its first report: 20 seconds, or what a test sets.
fn first() -> Duration {
    let set = std::env::var("CONTACTBENCH_FIRST_REPORT").ok().and_then(|text| text.parse().ok());
    Duration::from_secs(set.unwrap_or(20))
}

pub struct Terminal<'a> {
    bar: Bar,
    started: Instant,
    /// Whether the table of scenes has its heads.
    headed: bool,
    /// Whether the first report has been written.
    reported: bool,
    /// Writes a report of what has been measured, and returns where it is.
    report: &'a mut dyn FnMut() -> String,
}

impl<'a> Terminal<'a> {
    pub fn new(report: &'a mut dyn FnMut() -> String) -> Terminal<'a> {
        let template = "{bar:10} {pos}/{len} scenes, {elapsed} done, about {eta} left  {wide_msg}";
        let bar = Bar::new(None, template);
        Terminal { bar, started: Instant::now(), headed: false, reported: false, report }
    }
}

/// Formats a line of the table of scenes: 80 columns, unless a name is long.
fn columns([scene, first, time, second, ratio, contacts, right]: [&str; 7]) -> String {
    format!("{scene:<27} {first:<12} {time:>5} {second:<12} {ratio:>5} {contacts:>8} {right:>5}")
}

/// Counts frames on a terminal; elsewhere prints nothing.
pub struct Counted(Bar);

impl Counted {
    /// Starts counting; `frames` is the total, if known.
    pub fn new(frames: Option<u64>) -> Counted {
        let of = if frames.is_some() { " of {len}" } else { "" };
        let bar = Bar::new(frames, &format!("frame {{pos}}{of}, {{elapsed}}"));
        bar.0.iter().for_each(|bar| bar.enable_steady_tick(TICK));
        Counted(bar)
    }

    pub fn frame(&self, k: u64) {
        self.0.0.iter().for_each(|bar| bar.set_position(k));
    }
}

impl Progress for Terminal<'_> {
    fn scene(&mut self, done: usize, total: usize, next: &str) {
        match &self.bar.0 {
            Some(bar) if done == total => bar.finish_and_clear(),
            Some(bar) => {
                bar.enable_steady_tick(TICK);
                bar.set_length(total as u64);
                bar.set_position(done as u64);
                bar.set_message(line(next).into_owned());
            }
            None => {
                say!("[{:6.1} s] {done}/{total} {next}", self.started.elapsed().as_secs_f64())
            }
        }
    }

    fn found(&mut self, found: &Found) {
        if !std::mem::replace(&mut self.headed, true) {
            let heads = ["scene", "fastest", "ns/N", "second", "times", "contacts", "right"];
            self.note(&columns(heads));
        }
        self.note(&columns([
            &found.scene,
            &found.fastest,
            &number(found.per_particle),
            found.second.as_deref().unwrap_or("–"),
            &found.ratio.map_or("–".into(), number),
            &found.contacts.map_or("–".into(), |count| count.to_string()),
            &found.right.to_string(),
        ]));
        if !self.reported && self.started.elapsed() > first() {
            self.reported = true;
            let text = (self.report)();
            self.note(&text);
        }
    }

    fn note(&mut self, text: &str) {
        match &self.bar.0 {
            Some(bar) => bar.println(line(text)),
            None => say(text),
        }
    }
}
