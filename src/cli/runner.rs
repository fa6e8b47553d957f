//! `contactbench runner`.

use std::process::ExitCode;

use anyhow::Context;

use crate::contact::Arithmetic;
use crate::detect::Options;
use crate::harness::runner::Runner;

/// Options of `runner`.
#[derive(clap::Args)]
pub struct Serve {
    /// The detector
    #[arg(long)]
    detector: String,
    /// How contacts are decided
    #[arg(long, value_enum, default_value_t)]
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
    let entry = super::detector(&options.detector)?;
    super::use_threads(options.threads);
    let limits = Options { memory_limit: options.memory_limit, threads: options.threads };
    let mut runner = Runner::new(entry, options.arithmetic, limits);
    runner.serve(std::io::stdin().lock(), std::io::stdout().lock()).context("the harness is gone")?;
    Ok(ExitCode::SUCCESS)
}
