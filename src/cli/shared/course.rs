//! Frames as named on the command line: those of a file that has several, or of a scene that a
//! motion moves.

use std::path::Path;

use anyhow::{bail, ensure};

use crate::cli::shared::input;
use crate::cli::shared::scene::Source;
use crate::io::boxes::along;
use crate::io::{self, Frame, Place};
use crate::moving::Recorded;
use crate::scene::motion::{Frames, Motion};
use crate::scene::{AnyScene, Given};

/// Frames of the same particles.
pub struct Course<'a> {
    /// Of the scene or the file.
    pub name: &'a str,
    /// How it moves.
    pub motion: &'a str,
    /// They are those of a file.
    pub recorded: bool,
    /// In each frame.
    pub particles: usize,
    /// Frames at most.
    pub count: u64,
    /// Gives the frame of each number in turn, and none after the last.
    pub next: &'a mut dyn FnMut(u64) -> anyhow::Result<Option<AnyScene<'static>>>,
}

/// Hands the frames to `body`; none if there is one frame and no motion. Of a file there are at
/// most `count`, if nobody says how many.
pub fn course<T>(
    source: &Source,
    motion: Option<Motion>,
    frames: Option<u64>,
    count: u64,
    body: impl FnOnce(Course<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<Option<T>> {
    ensure!(frames != Some(0), "--frames 0: at least one is needed");
    let count = frames.unwrap_or(count);
    let Source { scene, input } = source;
    if let Some(motion) = motion {
        let Some((name, given)) = source.given()? else { return Ok(None) };
        let scene = open(given, &name)?;
        let mut frames = Frames::new(&scene, motion)?;
        let course = Course {
            name: &name,
            motion: &motion.to_string(),
            recorded: false,
            particles: scene.len(),
            count,
            next: &mut |k| frames.at(k).map(Some),
        };
        return body(course).map(Some);
    }
    // Whoever names a frame wants that one.
    let all = matches!(input.frame, None | Some(Frame::All));
    let path = scene.as_deref().map(Path::new).filter(|path| all && path.exists());
    let Some(path) = path else {
        ensure!(frames.is_none(), "--frames says how many, and nothing moves; add --motion drift");
        return Ok(None);
    };
    let options = io::Options { ids: true, ..input.options() };
    let several = |frames: io::Frames<'_>| of_file(source, path, count, frames, body);
    let done = input::frames(path, options, several)?;
    let moves = done.is_some() || frames.is_none();
    ensure!(moves, "--frames says how many, and the file has one frame; add --motion drift");
    Ok(done)
}

fn of_file<T>(
    source: &Source,
    path: &Path,
    count: u64,
    mut frames: io::Frames<'_>,
    body: impl FnOnce(Course<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<Option<T>> {
    let text = path.display().to_string();
    let name = path.file_name().map_or(text.clone(), |name| name.to_string_lossy().into_owned());
    let Some(first) = frames.next().transpose()? else { return Ok(None) };
    let Some(second) = frames.next().transpose()? else { return Ok(None) };
    input::tell(&text, first.0.notices(), Place::Argument);
    let particles = first.0.len();
    let all = [Ok(first), Ok(second)].into_iter().chain(frames);
    let mut recorded = Recorded::new(all, &text, source.input.radius);
    let course = Course {
        name: &name,
        motion: "as recorded",
        recorded: true,
        particles,
        count,
        next: &mut |_| recorded.next_frame()?.map(|given| open(given, &name)).transpose(),
    };
    body(course).map(Some)
}

/// Frames have open boundaries.
fn open(given: Given, name: &str) -> anyhow::Result<AnyScene<'static>> {
    match given.lattice {
        None => Ok(given.scene),
        Some(lattice) => bail!(
            "{name}: the scene repeats along {}, and in motion boundaries are open; take it \
             without its box, or one frame of it at rest (of a file: --frame last)",
            along(lattice.periodic())
        ),
    }
}
