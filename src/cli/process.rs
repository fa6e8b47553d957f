//! The beginning and the end of a process: arguments, errors, exit codes.

use std::borrow::Cow;
use std::process::ExitCode;

use clap::Parser;
use contactbench_core::refusal::no_memory;

use crate::cli::{say, shell};
use contactbench_record::record::built::{self, Build};
use contactbench_record::record::faults::Damaged;
use contactbench_run::check::contender;
use contactbench_terms::text::{line, lines};

/// The build of the program that is compiled, as its build script notes it.
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

/// Sets what holds for the whole process.
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
        // It repeats the arguments, and those may be names of files.
        match lines(&error.render().to_string()) {
            Cow::Borrowed(_) => _ = error.print(),
            Cow::Owned(clean) => eprint!("{clean}"),
        }
        advice.into_iter().for_each(|advice| eprintln!("\n  tip: {}", line(&advice)));
        ExitCode::from(2)
    })
}

/// The exit code of a verb; an error is printed.
pub fn ended(result: anyhow::Result<ExitCode>) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(error) if broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            let damaged = error.chain().any(|cause| cause.is::<Damaged>());
            let words = format!("contactbench: {error:#}");
            // The faults of a record stand on lines of their own.
            words.splitn(if damaged { usize::MAX } else { 1 }, '\n').for_each(say);
            // What is wrong is found, as a wrong answer is.
            ExitCode::from(if damaged { 1 } else { 2 })
        }
    }
}

/// Lets writes beyond the limit on the size of files (`ulimit -f`) fail with an error that is
/// printed. By default a signal ends the program without a word.
fn report_full_files() {
    #[cfg(unix)]
    {
        let seen = std::sync::Arc::default();
        // If it cannot be caught, the default stays.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, seen);
    }
}

/// Ends the program with one sentence where a detector gets no memory, which it reports by a panic.
fn report_missing_memory() {
    let default = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        // `check` reports the detector and goes on.
        let is_checked = std::thread::current().name() == Some(contender::THREAD);
        if let Some(refusal) = no_memory(panic.payload()).filter(|_| !is_checked) {
            say(&format!("contactbench: {refusal}"));
            std::process::exit(2);
        }
        default(panic);
    }));
}

/// Whoever read our output has seen enough.
fn broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
