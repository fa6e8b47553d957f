//! `contactbench runner`.

use std::process::ExitCode;

use anyhow::Context;

use crate::cli::shared::arithmetic::arithmetic;
use crate::contact::Arithmetic;
use crate::detect::{Options, table};
use crate::run::server::Server;

/// Options of `runner`.
#[derive(clap::Args)]
pub struct Serve {
    /// The detector, with parameters as in streamed-nbs:level=avx2
    #[arg(long)]
    detector: String,
    /// How contacts are decided
    #[arg(long, value_parser = arithmetic(), default_value_t)]
    arithmetic: Arithmetic,
    /// Threads, for detectors that can use them
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Most bytes for the detector's arrays
    #[arg(long, default_value_t = Options::default().memory_limit)]
    memory_limit: u64,
}

/// Serves until the end of the input.
pub fn serve(options: &Serve) -> anyhow::Result<ExitCode> {
    let spec = table::parse(&options.detector)?;
    crate::cli::use_threads(options.threads);
    let limits = Options { memory_limit: options.memory_limit, threads: options.threads };
    let mut server = Server::new(spec, options.arithmetic, limits);
    server
        .serve(std::io::stdin().lock(), std::io::stdout().lock())
        .context("the harness is gone")?;
    Ok(ExitCode::SUCCESS)
}
