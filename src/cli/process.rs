//! The start and end of a process: arguments, errors, exit codes.

use std::borrow::Cow;
use std::process::ExitCode;

use clap::Parser;
use contactbench_core::refusal::no_memory;

use crate::cli::{say, shell};
use contactbench_record::record::built::{self, Build};
use contactbench_record::record::faults::Damaged;
use contactbench_run::check::contender;
use contactbench_terms::text::{line, lines};

/// The build of the program, as recorded by its build script.
#[macro_export]
macro_rules! build {
    () => {
        $crate::record::built::Build {
            revision: env!("CONTACTBENCH_REVISION"),
            dirty: env!("CONTACTBENCH_DIRTY"),
            features: env!("CONTACTBENCH_FEATURES"),
            rustc: env!("CONTACTBENCH_RUSTC"),
            rustflags: env!("CONTACTBENCH_RUSTFLAGS"),
            profile: env!("CONTACTBENCH_PROFILE"),
        }
    };
}

/// Prepares the process: panics, signals and the build.
pub fn prepare(build: Build) {
    built::set(build);
    report_full_files();
    report_missing_memory();
}

/// The arguments of the process, or the exit code after help or an error was printed.
#[expect(clippy::print_stderr, reason = "the lines are cleaned first")]
pub fn parsed<Cli: Parser>() -> Result<Cli, ExitCode> {
    Cli::try_parse().map_err(|error| {
        let advice = shell::advice(&error);
        if advice.is_none() && !error.use_stderr() {
            error.exit()
        }
        // The error repeats the arguments, which may be file names with terminal commands.
        match lines(&error.render().to_string()) {
            Cow::Borrowed(_) => _ = error.print(),
            Cow::Owned(clean) => eprint!("{clean}"),
        }
        advice.into_iter().for_each(|advice| eprintln!("\n  tip: {}", line(&advice)));
        ExitCode::from(2)
    })
}

/// The exit code of a verb; prints the error, if any.
pub fn ended(result: anyhow::Result<ExitCode>) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(error) if broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            let damaged = error.chain().any(|cause| cause.is::<Damaged>());
            let words = format!("contactbench: {error:#}");
            // The faults of a record stand on lines of their own.
            words.splitn(if damaged { usize::MAX } else { 1 }, '\n').for_each(say);
            // A damaged record is a finding, like a wrong answer.
            ExitCode::from(if damaged { 1 } else { 2 })
        }
    }
}

/// Makes writes beyond the file size limit (`ulimit -f`) fail with a printed error. By default a
/// signal ends the program silently.
fn report_full_files() {
    #[cfg(unix)]
    {
        let seen = std::sync::Arc::default();
        // If the signal cannot be caught, the default remains.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, seen);
    }
}

/// Ends the program with one sentence if a detector panics because memory is exhausted.
fn report_missing_memory() {
    let default = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        // `check` reports the detector and continues.
        let is_checked = std::thread::current().name() == Some(contender::THREAD);
        if let Some(refusal) = no_memory(panic.payload()).filter(|_| !is_checked) {
            say(&format!("contactbench: {refusal}"));
            std::process::exit(2);
        }
        default(panic);
    }));
}

/// Whether the reader of the output has closed it, as `head` does.
fn broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
