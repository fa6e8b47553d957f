//! The verb `ranks`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use crate::rank::Failure;
#[cfg(feature = "mpi")]
use crate::rank::{alike, together};
use crate::share::{self, Share};
use crate::world::{World, threads};
use crate::{RankResults, Setting, Whole, measure, whole};
use anyhow::{Context, bail, ensure};
#[cfg(feature = "mpi")]
use contactbench::cli::shared::input::tell;
use contactbench::cli::shared::limit::Limit;
use contactbench::cli::shared::scene::Source;
use contactbench::cli::shared::{terminal, values};
use contactbench::io::write::append;
use contactbench::number::plural;
use contactbench::present::document::{Block, plain};
use contactbench::present::table::Table;
use contactbench_detectors::table;

#[derive(clap::Args)]
pub struct Ranks {
    #[command(flatten)]
    source: Source,
    /// Detector of each rank, with parameters as in streamed-nbs:level=avx2
    #[arg(
        long,
        default_value = table::DEFAULT,
        value_parser = values::DETECTOR,
        hide_possible_values = true
    )]
    detector: String,
    /// Numbers of ranks to measure in turn, as threads; mpirun sets the number instead
    #[arg(
        long,
        value_name = "NUMBERS",
        value_delimiter = ',',
        default_value = "1,2,4,8",
        value_parser = values::whole::<usize>
    )]
    ranks: Vec<usize>,
    /// Make a scene per rank, side by side along x: the whole grows with the ranks
    #[arg(long)]
    each: bool,
    /// Number of timed steps, after one warm-up step
    #[arg(long, default_value_t = 9, value_parser = values::whole::<usize>)]
    steps: usize,
    /// Skip the comparison with one process, for scenes too large for one machine
    #[arg(long)]
    unchecked: bool,
    /// Also append a line of JSON per number of ranks to a file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    limit: Limit,
}

pub fn ranks(options: &Ranks) -> anyhow::Result<ExitCode> {
    let spec = table::parse(&options.detector)?;
    ensure!(options.steps >= 1, "--steps is 0; it must be at least 1");
    for &ranks in &options.ranks {
        ensure!(
            (1..=MOST_THREADS).contains(&ranks),
            "--ranks is {ranks}; it must be from 1 to {MOST_THREADS}; use mpirun for more ranks"
        );
    }
    let Source { scene: Some(name), input } = &options.source else {
        bail!(
            "name a particle file, or a scene such as packed:dim=3,n=1e6 (contactbench list scenes)"
        );
    };
    let setting = |n: usize| Setting {
        spec: &spec,
        memory_limit: options.limit.bytes(n),
        steps: options.steps,
    };
    if mpi_size().is_some_and(|size| size > 1 || cfg!(feature = "mpi")) {
        return by_mpi(options, name, &setting);
    }
    let origin = input.origin(name)?;
    let given = (!options.each).then(|| input.given(name)).transpose()?;
    let mut rows = Vec::new();
    for &ranks in &options.ranks {
        let of = |world: &_| -> anyhow::Result<RankResults> {
            let share = match &given {
                Some(given) => Share::of(given, World::rank(world), ranks),
                None => share::beside(&origin, world)?,
            };
            let setting = setting(share.given.scene.len());
            Ok(measure(world, "threads", name, share, setting)?)
        };
        let ended = threads(ranks, of).with_context(|| format!("cannot start {ranks} threads"))?;
        let mut row = first_to_say_why(ended).with_context(|| name.clone())?;
        if !options.unchecked {
            let all = given
                .as_ref()
                .map_or_else(|| share::row(&origin, ranks), |given| Ok(given.clone()))?;
            row.whole = Some(whole(&all, setting(all.scene.len())).context("one process")?);
        }
        rows.push(row);
    }
    say(options, &rows)
}

/// Maximum number of ranks that are threads; more would take longer to start than to work.
const MOST_THREADS: usize = 64;

/// Number of processes of this MPI job: Open MPI, MPICH or a step of Slurm.
fn mpi_size() -> Option<usize> {
    let size = |name: &str| std::env::var(name).ok()?.trim().parse().ok();
    ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"].into_iter().find_map(size)
}

#[cfg(feature = "mpi")]
fn by_mpi<'a>(
    options: &Ranks,
    name: &str,
    setting: &dyn Fn(usize) -> Setting<'a>,
) -> anyhow::Result<ExitCode> {
    let world = crate::mpi::Processes::begin().context("cannot initialize MPI")?;
    let (rank, size) = (world.rank(), world.size());
    // If --steps differed, or only one rank found no file, ranks would wait for each other.
    let same = alike(&world, [options.steps as f64, f64::from(u8::from(options.each))]);
    let origin = match same {
        true => together(&world, options.source.input.origin(name)),
        false => Err(Failure::Unlike("--steps or --each").into()),
    };
    let share = origin.and_then(|origin| match options.each {
        true => Ok((share::beside(&origin, &world)?, origin)),
        false => Ok((together(&world, share::part(&origin, rank, size))?, origin)),
    });
    let row = share.and_then(|(share, origin)| {
        if rank == 0 {
            tell(name, &share.given.notices);
            options.source.input.tell_frame(name, share.frames);
        }
        let setting = setting(share.given.scene.len());
        Ok((measure(&world, "mpi", name, share, setting)?, origin))
    });
    let (mut row, origin) = match row {
        Ok(row) => row,
        Err(error) => {
            // A rank that knows the reason prints it; if inputs differ, the first rank prints it.
            // All ranks wait for that, because mpirun kills the others when one has failed.
            let knows = match error.downcast_ref() {
                Some(Failure::Elsewhere(_)) => false,
                Some(Failure::Unlike(_)) => rank == 0,
                _ => true,
            };
            if knows {
                contactbench::cli::say(&format!("contactbench: {name}: rank {rank}: {error:#}"));
            }
            world.sum(&mut [0]);
            return Ok(ExitCode::from(2));
        }
    };
    if rank > 0 {
        return Ok(ExitCode::SUCCESS);
    }
    if !options.unchecked {
        let all = if options.each { share::row(&origin, size) } else { origin.whole() }?;
        row.whole = Some(whole(&all, setting(all.scene.len())).context("one process")?);
    }
    say(options, &[row])
}

#[cfg(not(feature = "mpi"))]
fn by_mpi<'a>(_: &Ranks, _: &str, _: &dyn Fn(usize) -> Setting<'a>) -> anyhow::Result<ExitCode> {
    bail!(
        "this is one of several MPI processes, and the program was built without MPI; build it \
         with cargo build --release -p contactbench-ranks --features mpi (docs/CLUSTER.md)"
    )
}

/// Returns the rows, or the error of a rank that knows the reason if any does.
fn first_to_say_why(rows: Vec<anyhow::Result<RankResults>>) -> anyhow::Result<RankResults> {
    let knows = |row: &anyhow::Result<RankResults>| match row {
        Ok(_) => false,
        Err(error) => !matches!(error.downcast_ref(), Some(Failure::Elsewhere(_))),
    };
    let which = rows.iter().position(knows).unwrap_or(0);
    rows.into_iter().nth(which).context("no rank")?
}

fn say(options: &Ranks, rows: &[RankResults]) -> anyhow::Result<ExitCode> {
    if let Some(path) = &options.json {
        let lines = rows.iter().map(|row| Ok(serde_json::to_string(row)? + "\n"));
        append(path, &lines.collect::<anyhow::Result<String>>()?, "--json")?;
    }
    let mut blocks = Vec::new();
    if let Some(row) = rows.iter().max_by_key(|row| row.ranks) {
        blocks.extend([heading(row), Block::Table(table(rows))]);
        let have = std::thread::available_parallelism().map_or(1, |number| number.get());
        if row.kind == "threads" && row.ranks > have {
            blocks.push(Block::paragraph(format!(
                "There are more ranks than processors ({have}), so ranks take turns, and times are \
                 longer than with a processor each."
            )));
        }
    }
    blocks.extend(rows.iter().map(verdict));
    write!(terminal::out(), "{}", plain(&blocks, terminal::width()))?;
    let wrong = rows.iter().any(|row| row.is_right() == Some(false));
    Ok(if wrong { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

fn heading(row: &RankResults) -> Block {
    let along = match row.around {
        false => ["x", "y", "z"][row.along.min(2)].into(),
        true => format!("vector {} of the box", row.along + 1),
    };
    let RankResults { scene, dim, detector, .. } = row;
    Block::paragraph(format!("{scene}: {dim}D, {detector}, exact arithmetic; slabs along {along}."))
}

/// Returns the contacts of all ranks, compared with those of one process.
fn verdict(row: &RankResults) -> Block {
    let verdict = match &row.whole {
        None => "not compared with one process".to_string(),
        Some(_) if row.is_right() == Some(true) => "those of one process".to_string(),
        Some(Whole { pairs, digest }) => {
            let pairs = plural(*pairs as usize, "pair");
            format!("WRONG: one process finds {pairs}, digest {digest}")
        }
    };
    let (ranks, pairs) = (plural(row.ranks, "rank"), plural(row.found.pairs as usize, "pair"));
    Block::paragraph(format!("{ranks}: {pairs}, digest {}: {verdict}.", row.found.digest))
}

fn table(rows: &[RankResults]) -> Table {
    Table::of("", rows)
        .right("ranks", |row| row.ranks as u64)
        .unit("own", "most", |row| row.own[1])
        .unit("halo", "most", |row| row.halo_most)
        .unit("sent", "bytes", |row| row.sent_bytes)
        .unit("step", "ms", |row| row.step_ms)
        .unit("search", "ms", |row| row.search_ms)
        .unit("alone", "ms", |row| row.alone_ms)
        .unit("memory", "MB", |row| row.memory_most as f64 / 1e6)
        .into()
}
