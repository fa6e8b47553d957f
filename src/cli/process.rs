//! Start and end of a process: arguments, errors, exit codes.

use std::process::ExitCode;

use clap::Parser;
use contactbench_ground::limits::refusal::no_memory;

use crate::cli::{say, shell};
use contactbench_record::record::faults::{Damaged, MOST_THREADS};
use contactbench_record::record::origin::built::{self, Build};
use contactbench_run::check::subject;

/// Expands to the `Build` of the crate, from variables that its build script sets.
#[macro_export]
macro_rules! build {
    () => {
        $crate::record::origin::built::Build {
            revision: env!("CONTACTBENCH_REVISION"),
            dirty: env!("CONTACTBENCH_DIRTY"),
            rustc: env!("CONTACTBENCH_RUSTC"),
            rustflags: env!("CONTACTBENCH_RUSTFLAGS"),
            profile: env!("CONTACTBENCH_PROFILE"),
        }
    };
}

pub fn prepare(build: Build) {
    built::set(build);
    report_full_files();
    report_missing_memory();
}

/// Returns the arguments of the process, or the exit code after it printed help or an error.
pub fn parsed<Cli: Parser>() -> Result<Cli, ExitCode> {
    if let Some(name) = POOLS.into_iter().find(|name| too_many(name)) {
        say(&format!("contactbench: {name} must be at most {MOST_THREADS}"));
        return Err(ExitCode::from(2));
    }
    Cli::try_parse().map_err(|error| {
        if !error.use_stderr() {
            error.exit()
        }
        say(&format!("contactbench: {}", sentence(&error)));
        ExitCode::from(2)
    })
}

/// Environment variables with the number of threads that rayon starts, without a limit of its own.
const POOLS: [&str; 2] = ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"];

fn too_many(name: &str) -> bool {
    let threads = std::env::var(name).ok().and_then(|text| text.parse::<usize>().ok());
    threads.is_some_and(|threads| threads > MOST_THREADS)
}

/// Formats an error of clap like the errors of this program, as one line.
fn sentence(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let usage = |part: &&str| !part.starts_with("Usage:") && !part.starts_with("For more");
    let parts = text.split("\n\n").map(str::trim).take_while(usage);
    let parts = parts.map(|part| part.split_whitespace().collect::<Vec<_>>().join(" "));
    let parts: Vec<String> = parts.chain(shell::advice(error)).collect();
    format!("{}; see --help", parts.join("; ").trim_start_matches("error: "))
}

/// Returns the exit code of a verb, and prints its error.
pub fn ended(result: anyhow::Result<ExitCode>) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(error) if broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            let damaged = error.chain().any(|cause| cause.is::<Damaged>());
            say(&format!("contactbench: {}", without_numbers(&format!("{error:#}"))));
            ExitCode::from(if damaged { 1 } else { 2 })
        }
    }
}

/// Makes writes beyond `ulimit -f` fail with an error. By default a signal ends the program
/// silently.
fn report_full_files() {
    #[cfg(unix)]
    {
        let seen = std::sync::Arc::default();
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, seen);
    }
}

/// Ends the program with a message when a detector gets no memory, which it reports by a panic.
fn report_missing_memory() {
    let default = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        // `check` reports the failed detector itself and goes on.
        if std::thread::current().name() == Some(subject::THREAD) {
            return;
        }
        if let Some(refusal) = no_memory(panic.payload()) {
            say(&format!("contactbench: {refusal}"));
            std::process::exit(2);
        }
        default(panic);
    }));
}

/// Removes the numbers of system errors, as in `(os error 2)`.
fn without_numbers(text: &str) -> String {
    let mut pieces = text.split(" (os error ");
    let mut clean = pieces.next().unwrap_or_default().to_string();
    pieces.for_each(|piece| clean += piece.split_once(')').map_or("", |(_, rest)| rest));
    clean
}

/// Returns whether the reader of the output has closed it, as `head` does.
fn broken_pipe(error: &anyhow::Error) -> bool {
    let mut of_system = error.chain().filter_map(|cause| cause.downcast_ref::<std::io::Error>());
    of_system.any(|error| error.kind() == std::io::ErrorKind::BrokenPipe)
}
