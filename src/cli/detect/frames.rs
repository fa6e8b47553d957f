//! `detect --frame all`: finds the contacts of all frames.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, ensure};

use crate::cli::detect::Detect;
use crate::cli::detect::search::{Search, style};
use crate::cli::shared::input::{self, Told};
use crate::cli::shared::progress::Counted;
use contactbench_detectors::spec::DetectorSpec;
use contactbench_io as io;
use contactbench_io::write::{Framed, framed};
use contactbench_terms::number::plural;

#[derive(Default)]
struct Done {
    frames: usize,
    pairs: usize,
    /// Numbers of particles in the smallest and in the largest frame.
    particles: [usize; 2],
    dim: usize,
    time: Duration,
    /// Whether contacts are named by ids; set by the first frame.
    by_id: Option<bool>,
}

/// Writes the contacts of all frames, and prints a summary on standard error.
pub(super) fn detect(options: &Detect, spec: &DetectorSpec, path: &Path) -> anyhow::Result<()> {
    let input = &options.source.input;
    let read = io::Options { ids: !options.places || options.needs_ids(), ..input.options() };
    let done = input::frames(path, read, |frames| {
        framed(options.out.as_deref(), true, |out| all(options, spec, path, frames, out))
    })?;
    let Done { frames, pairs, particles: [least, most], dim, time, by_id } = done;
    let n = if least == most { most.to_string() } else { format!("{least} to {most}") };
    say!(
        "{}: {}, N = {n}, {dim}D, {} by {}, {:.3} ms, {spec}, {} arithmetic",
        path.display(),
        plural(frames, "frame"),
        plural(pairs, "pair"),
        if by_id == Some(true) { "id (--places: by place in the frame)" } else { "place" },
        time.as_secs_f64() * 1e3,
        options.arithmetic.name()
    );
    Ok(())
}

fn all(
    options: &Detect,
    spec: &DetectorSpec,
    path: &Path,
    frames: io::Frames<'_>,
    out: &mut Framed<'_>,
) -> anyhow::Result<Done> {
    let name = path.display().to_string();
    let mut done = Done { particles: [usize::MAX, 0], ..Done::default() };
    let mut search: Option<Search> = None;
    let (progress, mut told) = (Counted::new(None), Told::default());
    for frame in frames {
        let (particles, about) = frame?;
        progress.frame(about.frame);
        let which = input::place(&name, &about);
        told.tell(&which, &particles.notices);
        let place = || format!("{name}: {}", about.which());
        let ids = particles.ids_copied()?;
        let ids = if options.needs_ids() { options.ids(&place(), ids)? } else { ids };
        let by_id = by_id(options, &place, ids.as_deref(), done.by_id)?;
        done.by_id = Some(by_id);
        let ids = ids.as_deref();
        let given = particles.given(&name, options.source.input.radius).with_context(place)?;
        let n = given.scene.len();
        let memory_limit = options.limit.bytes(n);
        // A detector keeps its buffers from frame to frame.
        let search = match search.take().filter(|search| search.memory_limit == memory_limit) {
            Some(kept) => search.insert(kept),
            None => search.insert(Search::new(options, spec, memory_limit)),
        };
        let periodic = given.periodic().with_context(place)?;
        let found = search.find(&given, periodic.as_ref()).with_context(place)?;
        told.tell(&which, found.doubt(&given).as_slice());
        let counts = found.counts(options, n).with_context(place)?;
        let style = style(options, &given, periodic.as_ref(), ids, by_id, &counts);
        out.frame(about.frame, &style, found.pairs.iter()).with_context(place)?;
        done.frames += 1;
        done.pairs += found.pairs.iter().len();
        done.time += found.time;
        done.dim = given.scene.dim();
        let [least, most] = done.particles;
        done.particles = [least.min(n), most.max(n)];
    }
    ensure!(done.frames > 0, "{name} holds no frame of particles; check its --format");
    Ok(done)
}

/// Returns whether the contacts of a frame are named by ids. The first frame decides: it must have
/// an id for each particle.
fn by_id(
    options: &Detect,
    place: &dyn Fn() -> String,
    ids: Option<&[i64]>,
    before: Option<bool>,
) -> anyhow::Result<bool> {
    let usable = match ids {
        Some(ids) if !options.places => super::repeated(ids)?.is_none(),
        _ => false,
    };
    ensure!(
        usable || before != Some(true),
        "{}: some particles share an id or have none, unlike in earlier frames; correct the \
         column id, or give --places",
        place()
    );
    Ok(before.unwrap_or(usable))
}
