//! `contactbench detect`.

mod frames;
mod search;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, bail, ensure};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use self::search::{Found, Pairs, Search};
use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::input::doubt;
use crate::cli::shared::limit::Limit;
use crate::cli::shared::scene::Source;
use crate::cli::shared::values;
use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::table::{self, TABLE};
use contactbench_core::periodic::ImagePair;
use contactbench_io as io;
use contactbench_io::Frame;
use contactbench_io::boxes::along;
use contactbench_io::write::{Extra, Style};
use contactbench_terms::number::plural;

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
    #[arg(long = "with", value_name = "COLUMNS", value_parser = extra(), value_delimiter = ',')]
    extras: Vec<Extra>,
}

/// Reads one of [`Extra::ALL`].
fn extra() -> impl TypedValueParser<Value = Extra> {
    let values = Extra::ALL.map(|(_, name, help)| PossibleValue::new(name).help(help));
    let named = |text: String| Extra::ALL.iter().find(|(_, name, _)| *name == text);
    PossibleValuesParser::new(values)
        .try_map(move |text| named(text).map(|(extra, ..)| *extra).ok_or("there is no such column"))
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

/// Reads, detects, writes the pairs, and prints on standard error what was done.
pub fn detect(options: &Detect) -> anyhow::Result<ExitCode> {
    let spec = table::parse(&options.detector)?;
    ensure!(
        !spec.entry.is_control(),
        "there is no detector '{}' here: it is a control, for experiments",
        spec.entry.name
    );
    let threads = options.threads;
    ensure!(threads >= 1, "--threads 0: at least one is needed");
    let several = TABLE.iter().filter(|entry| entry.threads && !entry.is_control());
    ensure!(
        threads == 1 || spec.entry.threads,
        "{} is sequential and cannot use {threads} threads; leave out --threads, or use one of {}",
        spec.entry.name,
        several.map(|entry| entry.name).collect::<Vec<_>>().join(", ")
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
    let Some((name, (given, ids))) = found else {
        bail!("name a particle file, or a scene such as packed:n=1000 (contactbench list scenes)");
    };
    let ids = options.ids(&name, ids)?;
    let n = given.scene.len();
    let mut search = Search::new(options, &spec, options.limit.bytes(n));
    let periodic = given.periodic()?;
    let found = search.find(&given, periodic.as_ref()).with_context(|| name.clone())?;
    let source = given.source.as_ref();
    doubt(&name, &given.scene, source, options.arithmetic, Some(&found.touching));
    let style = search::style(options, &given, periodic.as_ref(), ids.as_deref(), options.ids);
    write(options, &found.pairs, &style)?;
    let Found { time, memory, pairs, images, .. } = &found;
    let across = match (&given.lattice, pairs) {
        (Some(lattice), Pairs::Boxed(pairs)) => format!(
            ", {} of them across the box, which repeats along {} ({} made)",
            pairs.iter().filter(|pair| pair.image != [0; 3]).count(),
            along(lattice.periodic()),
            plural(*images, "image")
        ),
        _ => String::new(),
    };
    say!(
        "{name}: N = {n}, {}D, {}{across}, {:.3} ms, {} held by the detector, {spec}, {} \
         arithmetic",
        given.scene.dim(),
        plural(pairs.len(), "pair"),
        time.as_secs_f64() * 1e3,
        memory.map_or("memory not measured".into(), crate::cli::bytes),
        options.arithmetic.name()
    );
    Ok(ExitCode::SUCCESS)
}

/// Writes the pairs of one scene.
fn write(options: &Detect, pairs: &Pairs, style: &Style<'_>) -> anyhow::Result<()> {
    let path = options.output.as_deref();
    match pairs {
        Pairs::Open(pairs) => {
            let plain = pairs.iter().map(|&[i, j]| ImagePair { i, j, image: [0; 3] });
            io::write::contacts(path, plain, style)
        }
        Pairs::Boxed(pairs) => io::write::contacts(path, pairs.iter().copied(), style),
    }
}
