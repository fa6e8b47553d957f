//! Progress of a run or of a pass over frames: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::shared::terminal::say;
use contactbench_run::run::stage::Progress;
use contactbench_terms::text::line;

/// A progress bar on a terminal, removed when dropped; elsewhere nothing.
struct Bar(Option<ProgressBar>);

impl Bar {
    fn new(length: Option<u64>, template: &str) -> Bar {
        Bar(std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template(template);
            let bar = length.map_or_else(ProgressBar::no_length, ProgressBar::new);
            let bar = bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.enable_steady_tick(std::time::Duration::from_millis(500));
            bar
        }))
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.iter().for_each(ProgressBar::finish_and_clear);
    }
}

pub struct Terminal {
    bar: Bar,
    started: Instant,
}

impl Default for Terminal {
    fn default() -> Terminal {
        let template = "{bar:30} {pos}/{len} scenes, {elapsed} done, about {eta} left  {msg}";
        Terminal { bar: Bar::new(None, template), started: Instant::now() }
    }
}

/// Counts frames on a terminal; elsewhere prints nothing.
pub struct Counted(Bar);

impl Counted {
    /// Starts counting; `frames` is the total, if known.
    pub fn new(frames: Option<u64>) -> Counted {
        let of = if frames.is_some() { " of {len}" } else { "" };
        Counted(Bar::new(frames, &format!("frame {{pos}}{of}, {{elapsed}}")))
    }

    pub fn frame(&self, k: u64) {
        self.0.0.iter().for_each(|bar| bar.set_position(k));
    }
}

impl Progress for Terminal {
    fn scene(&mut self, done: usize, total: usize, next: &str) {
        match &self.bar.0 {
            Some(bar) if done == total => bar.finish_and_clear(),
            Some(bar) => {
                bar.set_length(total as u64);
                bar.set_position(done as u64);
                bar.set_message(line(next).into_owned());
            }
            None => {
                say!("[{:6.1} s] {done}/{total} {next}", self.started.elapsed().as_secs_f64())
            }
        }
    }

    fn note(&mut self, text: &str) {
        match &self.bar.0 {
            Some(bar) => bar.println(line(text)),
            None => say(text),
        }
    }
}
