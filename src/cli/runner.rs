//! `contactbench runner`.

use std::process::ExitCode;

use anyhow::Context;

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::values;
use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::Options;
use contactbench_run::run::server::Server;

#[derive(clap::Args)]
pub struct Serve {
    /// The detector, with parameters as in streamed-nbs:level=avx2; or a tracker over one, as in
    /// verlet(streamed-nbs,skin=0.1)
    #[arg(long, value_parser = values::DETECTOR, hide_possible_values = true)]
    detector: String,
    /// How contacts are decided
    #[arg(long, value_parser = arithmetic(), default_value_t)]
    arithmetic: Arithmetic,
    /// Threads, for detectors that can use them
    #[arg(long, default_value_t = 1, value_parser = values::whole::<usize>)]
    threads: usize,
    /// Most bytes for the detector's arrays, and for a list of pairs, as in 4GiB
    #[arg(long, default_value_t = Options::default().memory_limit, value_parser = values::bytes)]
    memory_limit: u64,
}

/// Serves until the end of the input.
pub fn serve(options: &Serve) -> anyhow::Result<ExitCode> {
    crate::cli::use_threads(options.threads);
    let limits = Options { memory_limit: options.memory_limit, threads: options.threads };
    let mut server = Server::new(&options.detector, options.arithmetic, limits)?;
    server
        .serve(std::io::stdin().lock(), std::io::stdout().lock())
        .context("the harness is gone")?;
    Ok(ExitCode::SUCCESS)
}
