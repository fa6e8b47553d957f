//! The program that `contactbench ranks` starts.

use std::process::ExitCode;

use clap::Parser;
use contactbench::cli::process;
use contactbench_ranks::verb::{Ranks, ranks};

/// Finds the contacts of one scene on several ranks: MPI processes, or threads for trials
#[derive(Parser)]
#[command(
    version,
    bin_name = "contactbench ranks",
    after_help = "Example: contactbench ranks packed:dim=3,n=1e6\nExample: mpirun -n 4 \
                  contactbench ranks packed:dim=3,n=1e6 --each\nExit code 1 if the \
                  contacts are not those of one process."
)]
struct Cli {
    #[command(flatten)]
    ranks: Ranks,
}

fn main() -> ExitCode {
    process::prepare(contactbench::build!());
    match process::parsed::<Cli>() {
        Ok(cli) => process::ended(ranks(&cli.ranks)),
        Err(code) => code,
    }
}
