//! Output of `inspect`: the motion from frame to frame.

use serde_json::json;

use crate::cli::inspect::Inspect;
use crate::cli::shared::output::Output;
use crate::cli::shared::progress::Counted;
use crate::cli::shared::{input, tracking};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::limits::memory;
use contactbench_io as io;
use contactbench_run::tracking::{Check, Moved, Question, Recorded, follow};
use contactbench_terms::number::plural;

/// Prints the motion from frame to frame, or warns if it cannot be read.
pub(super) fn report(options: &Inspect, [particles, frames]: [usize; 2], out: &mut Output) {
    match moved(options, particles, frames as u64) {
        Ok(moved) if moved.steps() == 0 => {
            out.line("motion", "none: the file has one frame", json!({}));
        }
        Ok(moved) => {
            let all = plural(moved.frames as usize, "frame");
            let particles = plural(moved.particles as usize, "particle");
            let text = format!("{all} of {particles}: {}", tracking::motion(&moved, Check::All));
            out.line(
                "motion",
                text,
                json!({ "motion": tracking::moved_as_json(&moved, Check::All) }),
            );
        }
        Err(error) => out.warn(format!("the motion is not described: {error:#}")),
    }
}

fn moved(options: &Inspect, particles: usize, frames: u64) -> anyhow::Result<Moved> {
    let (input, name) = (&options.input, options.file.display().to_string());
    let all = io::Options { ids: true, ..input.options() };
    input::frames(&options.file, all, |of_file| {
        let mut recorded = Recorded::new(of_file, &name, input.radius);
        let progress = Counted::new(Some(frames));
        let frame = |k| {
            progress.frame(k);
            recorded.next_frame()
        };
        let memory_limit = memory::limit_for(particles);
        let arithmetic = Arithmetic::Exact;
        let (frames, check) = (u64::MAX, Check::All);
        let question = Question { trackers: &[], arithmetic, frames, memory_limit, check };
        Ok(follow(frame, &question)?.moved)
    })
}
