//! How far a run has come: a bar with the remaining time on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use crate::run::stage::Progress;

/// Writes to standard error.
pub struct Terminal {
    bar: Option<ProgressBar>,
    started: Instant,
}

impl Default for Terminal {
    fn default() -> Terminal {
        let bar = std::io::stderr().is_terminal().then(|| {
            // The template is constant; were it wrong, the default style would do.
            let style = ProgressStyle::with_template(
                "{bar:30} {pos}/{len} scenes, {elapsed} done, about {eta} left  {msg}",
            );
            let bar = ProgressBar::no_length()
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.enable_steady_tick(std::time::Duration::from_millis(500));
            bar
        });
        Terminal { bar, started: Instant::now() }
    }
}

impl Drop for Terminal {
    /// What is printed next begins on a line of its own.
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Progress for Terminal {
    fn scene(&mut self, done: usize, total: usize, next: &str) {
        match &self.bar {
            Some(bar) if done == total => bar.finish_and_clear(),
            Some(bar) => {
                bar.set_length(total as u64);
                bar.set_position(done as u64);
                bar.set_message(next.to_string());
            }
            None => {
                eprintln!("[{:6.1} s] {done}/{total} {next}", self.started.elapsed().as_secs_f64())
            }
        }
    }

    fn note(&mut self, text: &str) {
        match &self.bar {
            Some(bar) => bar.println(text),
            None => eprintln!("{text}"),
        }
    }
}
