//! `contactbench detect`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, ensure};

use crate::cli::shared::arithmetic::arithmetic;
use crate::contact::Arithmetic;
use crate::detect::{Options, table};
use crate::io;
use crate::run::alloc;
use crate::sink::normalise;

/// Options of `detect`.
#[derive(clap::Args)]
pub struct Detect {
    /// The particles: CSV, XYZ, LAMMPS, MercuryDPM, YADE, NumPy, VTK or PLY, also compressed with
    /// gzip
    file: PathBuf,
    /// The detector, with parameters as in streamed-nbs:level=avx2
    #[arg(long, default_value = "nbs")]
    detector: String,
    #[command(flatten)]
    input: crate::cli::shared::input::Input,
    /// How contacts are decided
    #[arg(long, value_parser = arithmetic(), default_value_t)]
    arithmetic: Arithmetic,
    /// Threads, for detectors that can use them
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Most bytes for the detector's arrays
    #[arg(long, default_value_t = Options::default().memory_limit)]
    memory_limit: u64,
    /// Where the pairs go: a .csv or .npy file, or .vtk to see them in ParaView (default: CSV to
    /// standard output)
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Reads, detects, writes the pairs, and says on standard error what was done.
pub fn detect(options: &Detect) -> anyhow::Result<ExitCode> {
    let spec = table::parse(&options.detector)?;
    let threads = options.threads;
    ensure!(threads >= 1, "--threads 0: at least one is needed");
    ensure!(
        threads == 1 || spec.entry.threads,
        "{} is sequential and cannot use {threads} threads; leave out --threads, or use direct or \
         cell-grid",
        spec.entry.name
    );
    if let Some(path) = &options.output {
        io::write::format(path)?;
    }
    crate::cli::use_threads(threads);
    let scene = io::scene(&options.file, options.input.options())?;
    let given = scene;
    let scene = given
        .stored(options.arithmetic)
        .with_context(|| format!("{} in {}", options.file.display(), options.arithmetic.name()))?;
    let mut detector = spec.make(Options { memory_limit: options.memory_limit, threads });
    let mut pairs = Vec::new();
    let started = Instant::now();
    let (result, usage) =
        alloc::measure(|| detector.list(&scene, options.arithmetic.test(), &mut pairs));
    let seconds = started.elapsed().as_secs_f64();
    result?;
    // What is left on the heap is the list of pairs and the detector's buffers.
    let memory = usage.map(|usage| usage.live_bytes.saturating_sub(pairs.capacity() as u64 * 8));
    normalise(&mut pairs);
    match &options.output {
        Some(path) => io::write::pairs_of(path, &pairs, &given)?,
        None => {
            let mut out = std::io::BufWriter::new(std::io::stdout().lock());
            io::write::csv(&mut out, &pairs)
                .and_then(|()| out.flush())
                .context("cannot write the pairs to standard output")?;
        }
    }
    eprintln!(
        "{}: N = {}, {}D, {} pairs, {:.3} ms, {} held by the detector, {}, {} arithmetic",
        options.file.display(),
        scene.len(),
        scene.dim(),
        pairs.len(),
        seconds * 1e3,
        memory.map_or("memory not measured".into(), crate::cli::bytes),
        spec,
        options.arithmetic.name()
    );
    Ok(ExitCode::SUCCESS)
}
