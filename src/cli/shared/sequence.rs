//! Frames named on the command line: those of a file, or of a scene moved by a motion.

use std::path::Path;

use anyhow::{Context, ensure};

use crate::cli::shared::input;
use crate::cli::shared::scene::Source;
use contactbench_io as io;
use contactbench_io::{FrameChoice, Given};
use contactbench_run::tracking::Recorded;
use contactbench_scenes::motion::{self, Frames, Motion, MotionKind};

pub struct Sequence<'a> {
    /// Name of the scene or the file.
    pub name: &'a str,
    pub motion: &'a str,
    pub particles: usize,
    /// Maximum number of frames.
    pub count: u64,
    /// Returns the next frame, whose number is the argument; `None` after the last.
    pub next: &'a mut dyn FnMut(u64) -> anyhow::Result<Option<Given>>,
}

/// Default number of frames of a motion.
pub const FRAMES: u64 = 100;

const DRIFT: Motion = Motion { kind: MotionKind::Drift, speed: motion::SPEED, seed: motion::SEED };

/// Passes at most `frames` frames to `body`. A scene of one frame is moved by `motion`, by default
/// a drift. A file is read once.
pub fn sequence<T>(
    source: &Source,
    motion: Option<Motion>,
    frames: Option<u64>,
    body: impl FnOnce(Sequence<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    ensure!(frames != Some(0), "--frames 0: give at least 1");
    let Source { scene, input } = source;
    // If a motion is given or one frame chosen, the motion moves that frame.
    let all = motion.is_none() && matches!(input.frame, None | Some(FrameChoice::All));
    if let Some(path) = scene.as_deref().map(Path::new).filter(|path| all && io::exists(path)) {
        let options = io::Options { ids: true, ..input.options() };
        return input::frames(path, options, |of_file| {
            recorded(source, path, frames, of_file, body)
        });
    }
    let (name, given) = source.given()?;
    moved(&name, &given, motion.unwrap_or(DRIFT), frames, body)
}

fn moved<T>(
    name: &str,
    given: &Given,
    motion: Motion,
    frames: Option<u64>,
    body: impl FnOnce(Sequence<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let mut all = Frames::new(given, motion)?;
    body(Sequence {
        name,
        motion: &motion.to_string(),
        particles: given.scene.len(),
        count: frames.unwrap_or(FRAMES),
        next: &mut |k| all.at(k).map(Some),
    })
}

fn recorded<T>(
    source: &Source,
    path: &Path,
    most: Option<u64>,
    mut frames: io::Frames<'_>,
    body: impl FnOnce(Sequence<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let (text, radius) = (path.display().to_string(), source.input.radius);
    let name = path.file_name().map_or(text.clone(), |name| name.to_string_lossy().into_owned());
    let none = || format!("{text} holds no frame of particles; check its --format");
    let first = frames.next().transpose()?.with_context(none)?;
    input::tell(&text, &first.0.notices);
    // An unreadable second frame is an error only when the caller reads it.
    let Some(second) = frames.next() else {
        let given = first.0.given(&text, radius)?;
        say!("{text}: there is one frame, so the motion is made up: {DRIFT}");
        return moved(&name, &given, DRIFT, most, body);
    };
    let particles = first.0.len();
    let steps = [first.1.step, second.as_ref().ok().and_then(|second| second.1.step)];
    if let [Some(a), Some(b)] = steps
        && a.abs_diff(b) > 1
    {
        say!(
            "{text}: the first two frames are {} steps apart, but trackers take each frame for one \
             step: what they miss here, a code with these settings need not miss; write every step",
            a.abs_diff(b)
        );
    }
    let all = [Ok(first), second].into_iter().chain(frames);
    let mut recorded = Recorded::new(all, &text, radius);
    body(Sequence {
        name: &name,
        motion: "as recorded",
        particles,
        count: most.unwrap_or(u64::MAX),
        next: &mut |_| recorded.next_frame(),
    })
}
