//! `contactbench run`, and `contactbench` without a verb.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::cli::measuring::report::finish;
use crate::cli::shared::ci::Outputs;
use crate::cli::shared::progress::Terminal;
use crate::cli::shared::terminal;
use contactbench_record::experiment::shard::Shard;
use contactbench_record::record::row;
use contactbench_run::plan::builtin;
use contactbench_run::run::machine::interrupt::{self, Interrupted};
use contactbench_run::run::session::{self, Asked};

#[derive(clap::Args, Default)]
pub struct Run {
    /// Names (see: list experiments), or TOML files
    #[arg(value_name = "EXPERIMENT", required = true)]
    #[arg(value_hint = clap::ValueHint::FilePath)]
    experiments: Vec<String>,
    /// Small scenes and few blocks, to see that all works
    #[arg(long)]
    quick: bool,
    /// At most K blocks; merge adds those of several runs
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..))]
    blocks: Option<u32>,
    /// Continue a run that was stopped
    #[arg(long)]
    resume: bool,
    /// Result folder [default: results/NAME/DATE-MACHINE]
    #[arg(short, long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Another build of contactbench, timed in turns
    #[arg(long, value_name = "PROGRAM", conflicts_with = "shard")]
    against: Option<PathBuf>,
    /// Part K of N, as in 2/8
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    ci: Outputs,
}

pub fn standard(quick: bool) -> anyhow::Result<ExitCode> {
    let names = builtin::all()?
        .into_iter()
        .filter(|experiment| experiment.standard)
        .map(|experiment| experiment.name)
        .collect();
    let time = if quick { "in seconds" } else { "about four minutes" };
    say!(
        "running the book's scaling experiments, {time}; results go to a new folder under \
         results/standard"
    );
    let options = Run { experiments: names, quick, ..Run::default() };
    run_named(&options, "standard")
}

pub fn run(options: &Run) -> anyhow::Result<ExitCode> {
    let stems = options
        .experiments
        .iter()
        .map(|name| Path::new(name).file_stem().unwrap_or_default().to_string_lossy().into_owned());
    run_named(options, &stems.collect::<Vec<_>>().join("+"))
}

fn run_named(options: &Run, name: &str) -> anyhow::Result<ExitCode> {
    let mut experiments = session::find(&options.experiments)?;
    for (experiment, _) in &mut experiments {
        // The copy in the record remains the plan of the whole.
        experiment.blocks = experiment.blocks.min(options.blocks.unwrap_or(u32::MAX));
    }
    let Run { quick, resume, against, shard, .. } = options;
    let (quick, resume, against, shard) = (*quick, *resume, against.clone(), *shard);
    let folder = match &options.out {
        Some(folder) => folder.clone(),
        None => session::folder(name, shard, resume)?,
    };
    let asked = Asked { experiments, quick, resume, against, shard };
    // The progress bar is a temporary value, removed at the end of this statement.
    let ended = session::run(&asked, &folder, &mut Terminal::start(), &mut |it| say!("{it}"));
    let error = match ended {
        Ok(0) => {
            let mut out = terminal::out();
            writeln!(
                out,
                "shard {} has no scenes, because there are more shards than scenes",
                shard.map_or_else(String::new, |shard| shard.to_string())
            )?;
            options.ci.write("run", &[])?;
            return Ok(ExitCode::SUCCESS);
        }
        Ok(_) => return finish(&folder, &options.ci),
        Err(error) => error,
    };
    if error.is::<Interrupted>() {
        // Reports the part that was measured.
        if let Err(error) = finish(&folder, &Outputs::default()) {
            say!("no report: {error:#}");
        }
        say!("interrupted: the record is in {}; continue with:", folder.join(row::FILE).display());
        terminal::command(&again(options, &folder));
        return Ok(ExitCode::from(interrupt::exit_code()));
    }
    let session::Stopped(error) = error.downcast()?;
    let again = again(options, &folder);
    Err(error
        .context(format!("the run stopped; solve the problem below, then continue with: {again}")))
}

fn again(options: &Run, folder: &Path) -> String {
    let mut words = vec!["contactbench".to_string(), "run".into()];
    words.extend(options.experiments.iter().cloned());
    words.extend(options.quick.then(|| "--quick".into()));
    words.extend(options.blocks.iter().flat_map(|k| ["--blocks".into(), k.to_string()]));
    words.extend(
        options.against.iter().flat_map(|path| ["--against".into(), path.display().to_string()]),
    );
    words.extend(options.shard.iter().flat_map(|shard| ["--shard".into(), shard.to_string()]));
    words.extend(["--resume".into(), "--out".into(), folder.display().to_string()]);
    shlex::try_join(words.iter().map(String::as_str)).unwrap_or_default()
}
