//! `contactbench detect`.

mod frames;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, bail, ensure};

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::input::doubt;
use crate::cli::shared::limit::Limit;
use crate::cli::shared::scene::Source;
use crate::cli::shared::values;
use crate::contact::Arithmetic;
use crate::crowd;
use crate::detect::spec::DetectorSpec;
use crate::detect::{Options, table};
use crate::experiment::detectors;
use crate::io;
use crate::io::boxes::along;
use crate::io::write::{Around, Extra, PairFormat, Style};
use crate::io::{Frame, RadiusSource};
use crate::number::plural;
use crate::pair_list::PAIR_BYTES;
use crate::periodic::{Contacts, Finder, IMAGE_PAIR_BYTES, Periodic, without_shift};
use crate::run::alloc;
use crate::scene::doubts::Touching;
use crate::scene::{AnyScene, Given};
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
    /// Names particles by the file's column id, with the header id1,id2 (default: with --frame all,
    /// if the file has ids)
    #[arg(long, conflicts_with = "places")]
    ids: bool,
    /// Names particles by their place in the file, from 0 (default: for one frame)
    #[arg(long)]
    places: bool,
    /// More columns: overlap (a length, and as depth in mean radii), normal (unit vector from the
    /// first particle to the second), ids
    #[arg(long = "with", value_name = "COLUMNS", value_enum, value_delimiter = ',')]
    extras: Vec<Extra>,
}

impl Detect {
    /// The ids are read in any case.
    fn needs_ids(&self) -> bool {
        self.ids || self.extras.contains(&Extra::Ids)
    }

    /// The ids of particles, if they are asked for.
    fn ids(&self, name: &str, ids: Option<Vec<i64>>) -> anyhow::Result<Option<Vec<i64>>> {
        if !self.needs_ids() {
            return Ok(None);
        }
        let ids = ids.with_context(|| {
            format!(
                "{name} has no column 'id' of whole numbers; leave out --ids and --with ids, or \
                 name the column: --columns id=K"
            )
        })?;
        let repeated = repeated(&ids)?;
        ensure!(
            repeated.is_none(),
            "{name}: the id {} stands there twice and names no particle; mend it, or leave out \
             --ids and --with ids",
            repeated.unwrap_or_default()
        );
        Ok(Some(ids))
    }
}

/// An id of two particles, if there is one.
fn repeated(ids: &[i64]) -> anyhow::Result<Option<i64>> {
    if ids.is_sorted_by(|a, b| a < b) {
        return Ok(None);
    }
    let mut sorted = Vec::new();
    let room = sorted.try_reserve_exact(ids.len());
    room.with_context(|| format!("no memory for the order of {} ids", ids.len()))?;
    sorted.extend_from_slice(ids);
    sorted.sort_unstable();
    Ok(sorted.windows(2).find(|two| two[0] == two[1]).map(|two| two[0]))
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
    ensure!(
        options.source.scene.as_deref() != Some("-"),
        "'-' names no file; to read standard input give /dev/stdin"
    );
    if let (Some(Frame::All), Some(text)) = (options.source.input.frame, &options.source.scene)
        && io::exists(Path::new(text))
    {
        return frames::detect(options, &spec, Path::new(text));
    }
    let found = options.source.with_ids(options.needs_ids())?;
    let Some((name, (Given { scene: given, lattice, source, .. }, ids))) = found else {
        bail!("name a particle file, or a scene such as packed:n=1000 (contactbench list scenes)");
    };
    let (ids, source) = (options.ids(&name, ids)?, source.as_ref());
    if let Some(lattice) = lattice {
        let periodic = Periodic::new(given, lattice)?;
        return in_box(options, &spec, &name, periodic, ids.as_deref(), source);
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
    let touching = Touching::open(&given, &pairs);
    doubt(&name, &given, source, options.arithmetic, Some(&touching));
    write_open(options, &pairs, &given, ids.as_deref())?;
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

/// Writes pairs of open space.
fn write_open(
    options: &Detect,
    pairs: &[[u32; 2]],
    scene: &AnyScene<'_>,
    ids: Option<&[i64]>,
) -> anyhow::Result<()> {
    let path = options.output.as_deref();
    let lines = path.map(io::write::format).transpose()? == Some(PairFormat::Vtk);
    if !lines && !options.ids && options.extras.is_empty() {
        return match path {
            Some(path) => io::write::pairs(path, pairs),
            None => {
                let mut out = std::io::BufWriter::new(std::io::stdout().lock());
                io::write::csv(&mut out, pairs)
                    .and_then(|()| out.flush())
                    .context("cannot write the pairs to standard output")
            }
        };
    }
    let mut contacts = Vec::new();
    let room = contacts.try_reserve_exact(pairs.len());
    room.with_context(|| format!("no memory for {} contacts", pairs.len()))?;
    contacts.extend(without_shift(pairs));
    let style =
        Style { around: Around::Open(scene), ids, by_id: options.ids, extras: &options.extras };
    io::write::contacts(path, &contacts, &style)
}

/// The same in a box that repeats: contacts with images of particles.
fn in_box(
    options: &Detect,
    spec: &DetectorSpec,
    name: &str,
    periodic: Periodic<'_>,
    ids: Option<&[i64]>,
    source: Option<&RadiusSource>,
) -> anyhow::Result<ExitCode> {
    let (scene, lattice) = (periodic.scene(), periodic.lattice());
    let memory_limit = options.limit.bytes(scene.len());
    crowd::within(scene, memory_limit).with_context(|| name.to_string())?;
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
    doubt(name, scene, source, options.arithmetic, Some(&Touching::boxed(&periodic, &pairs)));
    let style = Style {
        around: Around::Boxed(&periodic),
        ids,
        by_id: options.ids,
        extras: &options.extras,
    };
    io::write::contacts(options.output.as_deref(), &pairs, &style)?;
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
