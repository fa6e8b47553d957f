//! The `contactbench` program.

use std::process::ExitCode;

use contactbench::cli::{Cli, process};
use contactbench::run::runner::alloc::Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn main() -> ExitCode {
    process::prepare(contactbench::build!());
    let cli = match process::parsed::<Cli>() {
        Ok(cli) => cli,
        Err(code) => return code,
    };
    process::ended(cli.run())
}
