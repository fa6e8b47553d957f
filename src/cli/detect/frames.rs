//! `detect --frame all`: the contacts of all frames of a file.

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};

use crate::cli::detect::Detect;
use crate::cli::shared::input;
use crate::cli::shared::progress::Counted;
use crate::crowd;
use crate::detect::Options;
use crate::detect::any::AnyDetector;
use crate::detect::spec::DetectorSpec;
use crate::io;
use crate::io::write::{Framed, framed};
use crate::number::plural;
use crate::periodic::{Contacts, Finder, Periodic, without_shift};
use crate::scene::Given;
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
}

/// Goes through the frames with one detector, writes the pairs, and says on standard error what was
/// done.
pub(super) fn detect(
    options: &Detect,
    spec: &DetectorSpec,
    path: &Path,
) -> anyhow::Result<ExitCode> {
    let input = &options.source.input;
    let done = input::frames(path, input.options(), |frames| {
        framed(options.output.as_deref(), |out| all(options, spec, path, frames, out))
    })?;
    let Done { frames, pairs, particles: [least, most], dim, time } = done;
    let n = if least == most { most.to_string() } else { format!("{least} to {most}") };
    say!(
        "{}: {}, N = {n}, {dim}D, {}, {:.3} ms, {spec}, {} arithmetic",
        path.display(),
        plural(frames, "frame"),
        plural(pairs, "pair"),
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
    let (progress, mut told) = (Counted::new(None), Vec::new());
    for frame in frames {
        let (particles, about) = frame?;
        progress.frame(about.frame);
        input::tell_of(&name, &particles, &about, &mut told);
        let place = || format!("{name}: {}", about.which());
        let given = particles.given(&name, options.source.input.radius).with_context(place)?;
        let n = given.scene.len();
        let memory_limit = options.limit.bytes(n);
        // Detectors keep what they have allocated for the frame before.
        let search = match search.take().filter(|search| search.memory_limit == memory_limit) {
            Some(kept) => search.insert(kept),
            None => search.insert(Search::new(options, spec, memory_limit)),
        };
        let pairs = search.frame(options, given, about.frame, out, &mut done);
        pairs.with_context(place)?;
    }
    ensure!(done.frames > 0, "{name} holds no frame of particles; is it of another format?");
    Ok(done)
}

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
        k: u64,
        out: &mut Framed<'_>,
        done: &mut Done,
    ) -> anyhow::Result<()> {
        let Search { memory_limit, detector, finder, pairs, contacts } = self;
        let (n, dim) = (given.scene.len(), given.scene.dim());
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
                out.frame(k, n, 0, without_shift(pairs))?;
            }
            Some(lattice) => {
                let periodic = Periodic::new(given.scene, lattice)?;
                contacts.clear();
                let started = Instant::now();
                finder.list(&periodic, &mut **detector, options.arithmetic, contacts)?;
                done.time += started.elapsed();
                let pairs = contacts.sorted(n, *memory_limit)?;
                done.pairs += pairs.len();
                out.frame(k, n, dim, pairs.into_iter())?;
            }
        }
        let [least, most] = done.particles;
        done.particles = [least.min(n), most.max(n)];
        (done.frames, done.dim) = (done.frames + 1, dim);
        Ok(())
    }
}
