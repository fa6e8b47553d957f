use anyhow::Context;

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::values;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_run::run::runner::server::Server;

#[derive(clap::Args)]
pub struct Serve {
    /// Detector, or tracker such as verlet(nbs,skin=0.1)
    #[arg(long, value_name = "NAME", value_parser = values::DETECTOR, hide_possible_values = true)]
    detector: String,
    /// Arithmetic (see: list); exact-open decides by <
    #[arg(long, value_name = "NAME", value_parser = arithmetic(), default_value_t)]
    #[arg(hide_possible_values = true)]
    arithmetic: Arithmetic,
    /// Threads, if the detector can use them
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = values::threads)]
    threads: usize,
    /// Memory, as in 2GiB [default: 4GiB, or 1/4 of all]
    #[arg(long, value_name = "SIZE", value_parser = values::bytes)]
    memory_limit: Option<u64>,
}

pub fn serve(options: &Serve) -> anyhow::Result<()> {
    crate::cli::use_threads(options.threads);
    let memory_limit = options.memory_limit.unwrap_or(Options::default().memory_limit);
    let limits = Options { memory_limit, threads: options.threads };
    let mut server = Server::new(&options.detector, options.arithmetic, limits)?;
    server.serve(std::io::stdin().lock(), std::io::stdout().lock()).context("the harness has ended")
}
