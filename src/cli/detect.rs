//! `contactbench detect`.

mod frames;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, bail, ensure};

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::limit::Limit;
use crate::cli::shared::scene::Source;
use crate::cli::shared::values;
use crate::contact::Arithmetic;
use crate::crowd;
use crate::detect::spec::DetectorSpec;
use crate::detect::{Options, table};
use crate::experiment::detectors;
use crate::io;
use crate::io::Frame;
use crate::io::boxes::along;
use crate::number::plural;
use crate::pair_list::PAIR_BYTES;
use crate::periodic::{Contacts, Finder, IMAGE_PAIR_BYTES, Periodic};
use crate::run::alloc;
use crate::scene::Given;
use crate::sink::normalise_by;

/// Options of `detect`.
#[derive(clap::Args)]
pub struct Detect {
    #[command(flatten)]
    source: Source,
    /// The detector, with parameters as in streamed-nbs:level=avx2
    #[arg(
        long,
        default_value = table::DEFAULT,
        value_parser = values::DETECTOR,
        hide_possible_values = true
    )]
    detector: String,
    /// How contacts are decided
    #[arg(long, value_parser = arithmetic(), default_value_t)]
    arithmetic: Arithmetic,
    /// Threads, for detectors that can use them
    #[arg(long, default_value_t = 1, value_parser = values::whole::<usize>)]
    threads: usize,
    #[command(flatten)]
    limit: Limit,
    /// Where the pairs go: a .csv or .npy file, or .vtk to see them in ParaView (default: CSV to
    /// standard output); with --frame all the first column is the frame
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Reads, detects, writes the pairs, and says on standard error what was done.
pub fn detect(options: &Detect) -> anyhow::Result<ExitCode> {
    let spec = detectors::parse(&options.detector)?;
    let threads = options.threads;
    ensure!(threads >= 1, "--threads 0: at least one is needed");
    ensure!(
        threads == 1 || spec.entry.threads,
        "{} is sequential and cannot use {threads} threads; leave out --threads, or use \
         streamed-nbs, cell-grid or direct",
        spec.entry.name
    );
    if let Some(path) = &options.output {
        io::write::format(path)?;
    }
    crate::cli::use_threads(threads);
    if let (Some(Frame::All), Some(text)) = (options.source.input.frame, &options.source.scene)
        && Path::new(text).exists()
    {
        return frames::detect(options, &spec, Path::new(text));
    }
    let Some((name, Given { scene: given, lattice, .. })) = options.source.given()? else {
        bail!("name a particle file, or a scene such as packed:n=1000 (contactbench list scenes)");
    };
    if let Some(lattice) = lattice {
        return in_box(options, &spec, &name, Periodic::new(given, lattice)?);
    }
    let scene = given
        .as_stored(options.arithmetic)
        .with_context(|| format!("{name} in {}", options.arithmetic.name()))?;
    let memory_limit = options.limit.bytes(scene.len());
    crowd::within(&scene, memory_limit).with_context(|| name.clone())?;
    let mut detector = spec.make(Options { memory_limit, threads });
    let mut pairs = Vec::new();
    let started = Instant::now();
    let (result, usage) =
        alloc::measure(|| detector.list(&scene, options.arithmetic.test(), &mut pairs));
    let seconds = started.elapsed().as_secs_f64();
    result.with_context(|| name.clone())?;
    // What is left on the heap is the list of pairs and the detector's buffers.
    let memory = usage.map(|usage| usage.live_bytes.saturating_sub(pairs.capacity() as u64 * 8));
    normalise_by(threads, &mut pairs);
    match &options.output {
        Some(path) => io::write::pairs_of(path, &pairs, &given)?,
        None => {
            let mut out = std::io::BufWriter::new(std::io::stdout().lock());
            io::write::csv(&mut out, &pairs)
                .and_then(|()| out.flush())
                .context("cannot write the pairs to standard output")?;
        }
    }
    say!(
        "{name}: N = {}, {}D, {}, {:.3} ms, {} held by the detector, {}, {} arithmetic",
        scene.len(),
        scene.dim(),
        plural(pairs.len(), "pair"),
        seconds * 1e3,
        memory.map_or("memory not measured".into(), crate::cli::bytes),
        spec,
        options.arithmetic.name()
    );
    Ok(ExitCode::SUCCESS)
}

/// The same in a box that repeats: contacts with images of particles.
fn in_box(
    options: &Detect,
    spec: &DetectorSpec,
    name: &str,
    periodic: Periodic<'_>,
) -> anyhow::Result<ExitCode> {
    let (scene, lattice) = (periodic.scene(), periodic.lattice());
    let memory_limit = options.limit.bytes(scene.len());
    let mut detector = spec.make(Options { memory_limit, threads: options.threads });
    let started = Instant::now();
    let (mut contacts, mut finder) = (Contacts::default(), Finder::new(memory_limit));
    let (result, usage) = alloc::measure(|| {
        finder.list(&periodic, &mut *detector, options.arithmetic, &mut contacts)
    });
    let seconds = started.elapsed().as_secs_f64();
    result.with_context(|| name.to_string())?;
    let bytes = contacts.plain.capacity() as u64 * PAIR_BYTES
        + contacts.shifted.capacity() as u64 * IMAGE_PAIR_BYTES;
    let pairs = contacts.sorted(scene.len(), memory_limit).with_context(|| name.to_string())?;
    let memory = usage.map(|usage| usage.live_bytes.saturating_sub(bytes));
    match &options.output {
        Some(path) => io::write::images_of(path, &pairs, scene, lattice)?,
        None => {
            let mut out = std::io::BufWriter::new(std::io::stdout().lock());
            io::write::images_csv(&mut out, &pairs, scene.dim())
                .and_then(|()| out.flush())
                .context("cannot write the pairs to standard output")?;
        }
    }
    let across = pairs.iter().filter(|pair| pair.image != [0; 3]).count();
    say!(
        "{name}: N = {}, {}D, {}, {across} of them across the box, which repeats along {} \
         ({} made), {:.3} ms, {} held by the detector, {}, {} arithmetic",
        scene.len(),
        scene.dim(),
        plural(pairs.len(), "pair"),
        along(lattice.periodic()),
        plural(finder.images() as usize, "image"),
        seconds * 1e3,
        memory.map_or("memory not measured".into(), crate::cli::bytes),
        spec,
        options.arithmetic.name()
    );
    Ok(ExitCode::SUCCESS)
}
