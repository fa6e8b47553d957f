//! Progress of a run or of a pass over frames: a line on a terminal, plain lines elsewhere.

use std::cell::{Cell, RefCell};
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use crate::cli::shared::terminal::say;
use contactbench_record::findings::winners::Contest;
use contactbench_run::run::stage::Progress;
use contactbench_terms::number::short;
use contactbench_terms::text::line;

/// Least time between two numbers of frames.
const TICK: Duration = Duration::from_millis(200);
/// Maximum number of characters of a line, so that a terminal does not wrap it.
const LONGEST: usize = 79;

/// A line on a terminal, replaced by the next and removed when dropped; elsewhere nothing.
pub struct Line {
    on_terminal: bool,
    shown: RefCell<String>,
}

impl Line {
    pub fn start() -> Line {
        Line { on_terminal: std::io::stderr().is_terminal(), shown: RefCell::default() }
    }

    pub fn show(&self, text: &str) {
        if self.on_terminal {
            let text: String = line(text).chars().take(LONGEST).collect();
            let _ = write!(std::io::stderr(), "\r\x1b[K{text}");
            *self.shown.borrow_mut() = text;
        }
    }

    /// Prints a text above the line.
    fn above(&self, text: &str) {
        let shown = self.shown.take();
        self.show("");
        say(text);
        self.show(&shown);
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.show("");
    }
}

/// Counts frames on a terminal; elsewhere prints nothing.
pub struct Counted {
    line: Line,
    /// Text after the number of a frame.
    of: String,
    last: Cell<Instant>,
}

impl Counted {
    /// Starts counting; `frames` is the total, if known.
    pub fn new(frames: Option<u64>) -> Counted {
        let of = frames.map_or(String::new(), |all| format!(" of {all}"));
        Counted { line: Line::start(), of, last: Cell::new(Instant::now()) }
    }

    pub fn frame(&self, k: u64) {
        if self.last.get().elapsed() > TICK {
            self.last.set(Instant::now());
            self.line.show(&format!("frame {k}{}", self.of));
        }
    }
}

pub struct Terminal {
    line: Line,
    started: Instant,
    /// Number of scenes that were complete at the start, and the time when this was known.
    complete: (usize, f64),
    /// Whether the table of scenes has its heads.
    headed: bool,
}

impl Terminal {
    pub fn start() -> Terminal {
        let (line, started) = (Line::start(), Instant::now());
        Terminal { line, started, complete: (0, 0.0), headed: false }
    }
}

/// Formats a line of the table of scenes: 80 columns, unless a name is long.
fn columns([scene, first, time, second, ratio, contacts, right]: [&str; 7]) -> String {
    format!("{scene:<26} {first:<12} {time:>6} {second:<12} {ratio:>5} {contacts:>8} {right:>5}")
}

impl Progress for Terminal {
    fn scene(&mut self, done: usize, total: usize, next: &str) {
        let time = self.started.elapsed().as_secs_f64();
        if self.line.on_terminal {
            // Scenes of an earlier run end at once.
            if done == self.complete.0 + 1 && time < self.complete.1 + 0.05 {
                self.complete = (done, time);
            }
            let (before, begun) = self.complete;
            let left = match done - before {
                0 => String::new(),
                some => {
                    let left = (time - begun) / some as f64 * (total - done) as f64;
                    format!(", about {left:.0} s left")
                }
            };
            self.line.show(&format!("{done}/{total} scenes, {time:.0} s{left}: {next}"));
        } else {
            say!("[{time:6.1} s] {done}/{total} {next}");
        }
    }

    fn found(&mut self, scene: &str, contest: &Contest, contacts: Option<u64>) {
        if !std::mem::replace(&mut self.headed, true) {
            let heads = ["scene", "fastest", "ns / N", "runner-up", "ratio", "contacts", "right"];
            self.note(&columns(heads));
        }
        let (first, second) = (&contest.first, contest.others.first());
        let ratio = second.and_then(|second| second.ratio);
        self.note(&columns([
            scene,
            &first.name,
            &short(first.per_particle),
            second.map_or("–", |second| &second.name),
            &ratio.map_or("–".into(), |ratio| short(ratio.median)),
            &contacts.map_or("–".into(), |count| count.to_string()),
            &(1 + contest.others.len()).to_string(),
        ]));
    }

    fn note(&mut self, text: &str) {
        self.line.above(text);
    }
}
