//! `detect --frame all`: the contacts of all frames of a file.

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};

use crate::cli::detect::Detect;
use crate::cli::shared::input::{self, Told};
use crate::cli::shared::progress::Counted;
use crate::crowd;
use crate::detect::Options;
use crate::detect::any::AnyDetector;
use crate::detect::spec::DetectorSpec;
use crate::io;
use crate::io::RadiusSource;
use crate::io::write::{Around, Framed, Style, framed};
use crate::number::plural;
use crate::periodic::{Contacts, Finder, Periodic, without_shift};
use crate::scene::doubts::Touching;
use crate::scene::{AnyScene, Given};
use crate::sink::normalise_by;

/// What was done.
#[derive(Default)]
struct Done {
    frames: usize,
    pairs: usize,
    /// Particles of the smallest frame and of the largest, and the dimension.
    particles: [usize; 2],
    dim: usize,
    time: Duration,
    /// Contacts are named by ids; known from the first frame on.
    by_id: Option<bool>,
}

/// Goes through the frames with one detector, writes the pairs, and says on standard error what was
/// done.
pub(super) fn detect(
    options: &Detect,
    spec: &DetectorSpec,
    path: &Path,
) -> anyhow::Result<ExitCode> {
    let input = &options.source.input;
    let read = io::Options { ids: !options.places || options.needs_ids(), ..input.options() };
    let done = input::frames(path, read, |frames| {
        framed(options.output.as_deref(), true, |out| all(options, spec, path, frames, out))
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
    Ok(ExitCode::SUCCESS)
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
        told.of_reader(&name, &particles, &about);
        let place = || format!("{name}: {}", about.which());
        let ids = particles.ids_copied()?;
        let ids = if options.needs_ids() { options.ids(&place(), ids)? } else { ids };
        let by_id = by_id(options, &place, ids.as_deref(), done.by_id)?;
        done.by_id = Some(by_id);
        let ids = ids.as_deref();
        let given = particles.given(&name, options.source.input.radius).with_context(place)?;
        let n = given.scene.len();
        let memory_limit = options.limit.bytes(n);
        // Detectors keep what they have allocated for the frame before.
        let search = match search.take().filter(|search| search.memory_limit == memory_limit) {
            Some(kept) => search.insert(kept),
            None => search.insert(Search::new(options, spec, memory_limit)),
        };
        let mut doubt = |scene: &AnyScene<'_>, source: Option<&RadiusSource>, found: &Touching| {
            let place = input::place(&name, &about);
            told.of_contacts(&place, scene, source, options.arithmetic, Some(found));
        };
        let of_frame = (about.frame, ids, by_id);
        let pairs = search.frame(options, given, of_frame, out, &mut done, &mut doubt);
        pairs.with_context(place)?;
    }
    told.end(&name);
    ensure!(done.frames > 0, "{name} holds no frame of particles; is it of another format?");
    Ok(done)
}

/// Whether the contacts of a frame are named by ids: as in the frames before it, or because the
/// first frame has an id for each particle.
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
        "{}: not every particle has an id of its own, as in the frames before; mend the column id, \
         or give --places",
        place()
    );
    Ok(before.unwrap_or(usable))
}
/// Hears what a frame's particles and contacts are.
type Doubt<'a> = dyn FnMut(&AnyScene<'_>, Option<&RadiusSource>, &Touching) + 'a;

/// A detector and its lists.
struct Search {
    memory_limit: u64,
    detector: Box<dyn AnyDetector>,
    finder: Finder,
    pairs: Vec<[u32; 2]>,
    contacts: Contacts,
}

impl Search {
    fn new(options: &Detect, spec: &DetectorSpec, memory_limit: u64) -> Search {
        let detector = spec.make(Options { memory_limit, threads: options.threads });
        let (pairs, contacts) = (Vec::new(), Contacts::default());
        Search { memory_limit, detector, finder: Finder::new(memory_limit), pairs, contacts }
    }

    /// Writes the contacts of frame `k`, in order.
    fn frame(
        &mut self,
        options: &Detect,
        given: Given,
        (k, ids, by_id): (u64, Option<&[i64]>, bool),
        out: &mut Framed<'_>,
        done: &mut Done,
        doubt: &mut Doubt<'_>,
    ) -> anyhow::Result<()> {
        let Search { memory_limit, detector, finder, pairs, contacts } = self;
        let (n, dim) = (given.scene.len(), given.scene.dim());
        let style = |around| Style { around, ids, by_id, extras: &options.extras };
        match given.lattice {
            None => {
                let scene = given.scene.as_stored(options.arithmetic)?;
                crowd::within(&scene, *memory_limit)?;
                pairs.clear();
                let started = Instant::now();
                detector.list(&scene, options.arithmetic.test(), pairs)?;
                done.time += started.elapsed();
                normalise_by(options.threads, pairs);
                done.pairs += pairs.len();
                doubt(&scene, given.source.as_ref(), &Touching::open(&scene, pairs));
                out.frame(k, &style(Around::Open(&given.scene)), without_shift(pairs))?;
            }
            Some(lattice) => {
                let periodic = Periodic::new(given.scene, lattice)?;
                crowd::within(periodic.scene(), *memory_limit)?;
                contacts.clear();
                let started = Instant::now();
                finder.list(&periodic, &mut **detector, options.arithmetic, contacts)?;
                done.time += started.elapsed();
                let pairs = contacts.sorted(n, *memory_limit)?;
                done.pairs += pairs.len();
                let found = Touching::boxed(&periodic, &pairs);
                doubt(periodic.scene(), given.source.as_ref(), &found);
                out.frame(k, &style(Around::Boxed(&periodic)), pairs.into_iter())?;
            }
        }
        let [least, most] = done.particles;
        done.particles = [least.min(n), most.max(n)];
        (done.frames, done.dim) = (done.frames + 1, dim);
        Ok(())
    }
}
