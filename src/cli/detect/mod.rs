mod frames;
mod search;

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use self::search::{Pairs, Search, SearchResult};
use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::input::tell;
use crate::cli::shared::limit::Limit;
use crate::cli::shared::scene::Source;
use crate::cli::shared::values;
use contactbench_detectors::table;
use contactbench_ground::contact::Arithmetic;
use contactbench_io as io;
use contactbench_io::FrameChoice;
use contactbench_io::boxes::along;
use contactbench_io::write::Extra;
use contactbench_run::run::machine::interrupt;
use contactbench_terms::number::plural;

#[derive(clap::Args)]
pub struct Detect {
    #[command(flatten)]
    source: Source,
    /// Detector (see: list)
    #[arg(
        long,
        value_name = "NAME",
        default_value = table::DEFAULT,
        value_parser = values::DETECTOR,
        hide_possible_values = true
    )]
    detector: String,
    /// Arithmetic (see: list); exact-open decides by <
    #[arg(long, value_name = "NAME", value_parser = arithmetic(), default_value_t)]
    #[arg(hide_possible_values = true)]
    arithmetic: Arithmetic,
    /// Threads, if the detector can use them
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = values::threads)]
    threads: usize,
    #[command(flatten)]
    limit: Limit,
    /// Pairs: .csv, .npy or .vtk [default: CSV, stdout]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Name particles by id [default with --frame all]
    #[arg(long, conflicts_with = "places")]
    ids: bool,
    /// Number particles from 0 in file order [default]
    #[arg(long)]
    places: bool,
    /// More columns: overlap, normal, ids, count
    #[arg(long = "with", value_name = "COLUMNS", value_parser = extra(), value_delimiter = ',')]
    #[arg(hide_possible_values = true)]
    extras: Vec<Extra>,
}

fn extra() -> impl TypedValueParser<Value = Extra> {
    let values = Extra::ALL.map(|(_, name, help)| PossibleValue::new(name).help(help));
    let named = |text: String| Extra::ALL.iter().find(|(_, name, _)| *name == text);
    PossibleValuesParser::new(values)
        .try_map(move |text| named(text).map(|(extra, ..)| *extra).ok_or("there is no such column"))
}

impl Detect {
    fn needs_ids(&self) -> bool {
        self.ids || self.extras.contains(&Extra::Ids)
    }

    /// Returns the ids of the particles, if the options need them.
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
            "{name}: two particles have the id {}; correct it, or leave out --ids and --with ids",
            repeated.unwrap_or_default()
        );
        Ok(Some(ids))
    }
}

/// Returns an id that two particles share, if there is one.
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

/// Writes the contacts, and prints a summary on standard error.
pub fn detect(options: &Detect) -> anyhow::Result<()> {
    interrupt::end_runners_too().context("cannot listen to Ctrl-C")?;
    let spec = table::parse(&options.detector)?;
    spec.usable(options.threads).context("--detector or --threads")?;
    if let Some(path) = &options.out {
        io::write::format(path)?;
    }
    crate::cli::use_threads(options.threads);
    ensure!(
        options.source.scene.as_deref() != Some("-"),
        "'-' is not a file; to read standard input, give /dev/stdin"
    );
    if let (Some(FrameChoice::All), Some(text)) =
        (options.source.input.frame, &options.source.scene)
        && io::exists(Path::new(text))
    {
        return frames::detect(options, &spec, Path::new(text));
    }
    let (name, (given, ids)) = options.source.with_ids(options.needs_ids())?;
    let ids = options.ids(&name, ids)?;
    let n = given.scene.len();
    let mut search = Search::new(options, &spec, options.limit.bytes(n));
    let periodic = given.periodic()?;
    let found = search.find(&given, periodic.as_ref()).with_context(|| name.clone())?;
    tell(&name, found.doubt(&given).as_slice());
    let (counts, ids) = (found.counts(options, n)?, ids.as_deref());
    let style = search::style(options, &given, periodic.as_ref(), ids, options.ids, &counts);
    io::write::contacts(options.out.as_deref(), found.pairs.iter(), &style)?;
    let SearchResult { time, memory, pairs, images, .. } = &found;
    let across = match (&given.lattice, pairs) {
        (Some(lattice), Pairs::Boxed(pairs)) => format!(
            ", {} of them across the box, periodic along {} ({} made)",
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
        plural(pairs.iter().len(), "pair"),
        time.as_secs_f64() * 1e3,
        memory.map_or("memory not measured".into(), crate::cli::bytes),
        options.arithmetic.name()
    );
    Ok(())
}
