//! `contactbench run`, and `contactbench` alone.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::cli::report::finish;
use crate::cli::shared::ci::Outputs;
use crate::cli::shared::progress::Terminal;
use crate::cli::shared::terminal::{self, quoted};
use crate::cli::shared::values;
use contactbench_record::experiment::shard::Part;
use contactbench_record::record::row;
use contactbench_run::plan::{builtin, detectors};
use contactbench_run::run::interrupt::{self, Interrupted};
use contactbench_run::run::session::{self, Asked};

#[derive(clap::Args, Default)]
pub struct Run {
    /// Names of experiments (see `contactbench list experiments`), or TOML files
    #[arg(required = true, value_parser = values::EXPERIMENT, hide_possible_values = true)]
    experiments: Vec<String>,
    /// Small scenes and few blocks: does everything work?
    #[arg(long)]
    quick: bool,
    /// Continue a killed run: what its record holds is not measured again
    #[arg(long)]
    resume: bool,
    /// The result folder (default: results/EXPERIMENT/DATE-MACHINE; with --resume the last one)
    #[arg(long)]
    out: Option<PathBuf>,
    /// Time another build of this program side by side with this one: in each block both take
    /// turns in fresh processes on one processor; `contactbench compare FOLDER` says what differs
    #[arg(long, value_name = "PROGRAM", conflicts_with = "shard")]
    against: Option<PathBuf>,
    /// Only part k of n of the scenes, as in 2/8, or auto: the part that the job array (Slurm, PBS,
    /// Grid Engine, LSF) or MPI gives to this process, in a folder of its own below --out (auto/8
    /// where the array does not say how long it is); `contactbench merge` puts the parts together
    #[arg(long, value_name = "K/N")]
    shard: Option<Part>,
    #[command(flatten)]
    ci: Outputs,
}

/// Runs the standard reproduction; a quick one has small scenes and few blocks.
pub fn standard(quick: bool) -> anyhow::Result<ExitCode> {
    let names = builtin::all()?
        .into_iter()
        .filter(|experiment| experiment.standard)
        .map(|experiment| experiment.name)
        .collect();
    let time = if quick { "a quick look in seconds" } else { "about four minutes" };
    say!(
        "the standard reproduction: the book's scaling experiments, {time}; results go to a new \
         folder under results/standard"
    );
    let options = Run { experiments: names, quick, ..Run::default() };
    run_named(&options, "standard")
}

/// Runs the experiments named.
pub fn run(options: &Run) -> anyhow::Result<ExitCode> {
    let stems = options
        .experiments
        .iter()
        .map(|name| Path::new(name).file_stem().unwrap_or_default().to_string_lossy().into_owned());
    run_named(options, &stems.collect::<Vec<_>>().join("+"))
}

fn run_named(options: &Run, name: &str) -> anyhow::Result<ExitCode> {
    let experiments = session::find(&options.experiments)?;
    let asked = experiments.iter().flat_map(|(experiment, _)| &experiment.detectors);
    detectors::not_built(asked).iter().for_each(|missing| say!("{missing}"));
    let shard = options.shard.map(|part| part.shard);
    let folder = match (&options.out, options.shard) {
        (Some(folder), Some(Part { shard, told: true })) => folder.join(shard.file_name()),
        (Some(folder), _) => folder.clone(),
        (None, _) => session::folder(name, shard, options.resume)?,
    };
    let Run { quick, resume, against, .. } = options;
    let (quick, resume, against) = (*quick, *resume, against.clone());
    let asked = Asked { experiments, quick, resume, against, shard };
    // Its bar is gone before anything else is printed.
    let ended = session::run(&asked, &folder, &mut Terminal::default(), &mut |it| say!("{it}"));
    let error = match ended {
        Ok(0) => {
            let mut out = terminal::out();
            writeln!(out, "there are more shards than scenes: nothing is to be run in this one")?;
            options.ci.write("run", &[])?;
            return Ok(ExitCode::SUCCESS);
        }
        Ok(_) => return finish(&folder, &options.ci),
        Err(error) => error,
    };
    if error.is::<Interrupted>() {
        // A report of what there is; whether claims hold is not known yet.
        if let Err(error) = finish(&folder, &Outputs::default()) {
            say!("no report: {error:#}");
        }
        say!(
            "interrupted: what was measured is in {}; continue with: {}",
            folder.join(row::FILE).display(),
            again(options, &folder)
        );
        return Ok(ExitCode::from(interrupt::exit_code()));
    }
    let session::Stopped(error) = error.downcast()?;
    let again = again(options, &folder);
    Err(error.context(format!("the run stopped; when this is mended, continue with: {again}")))
}

/// The command that continues a run.
fn again(options: &Run, folder: &Path) -> String {
    let mut words = vec!["contactbench".to_string(), "run".into()];
    words.extend(options.experiments.iter().cloned());
    words.extend(options.quick.then(|| "--quick".into()));
    words.extend(
        options.against.iter().flat_map(|path| ["--against".into(), path.display().to_string()]),
    );
    words.extend(options.shard.iter().flat_map(|part| ["--shard".into(), part.shard.to_string()]));
    words.extend(["--resume".into(), "--out".into(), folder.display().to_string()]);
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}
