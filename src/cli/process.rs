//! Start and end of a process: arguments, errors, exit codes.

use std::error::Error as _;
use std::process::ExitCode;

use clap::Parser;
use clap::error::{ContextKind as Kind, ContextValue, ErrorKind};
use contactbench_ground::limits::refusal::no_memory;

use crate::cli::{say, shell};
use contactbench_record::record::faults::Damaged;
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
    Cli::try_parse().map_err(|error| {
        if !error.use_stderr() {
            error.exit()
        }
        say(&format!("contactbench: {}", sentence(&error)));
        ExitCode::from(2)
    })
}

/// Returns the name of an option or argument without that of its value.
fn name(shown: &str) -> String {
    match shown.starts_with('-') {
        true => shown.split([' ', '=', '[']).next().unwrap_or_default().to_string(),
        false => shown.replace(['<', '>', '[', ']'], ""),
    }
}

/// Formats an error of clap like the errors of this program: one sentence with a remedy.
fn sentence(error: &clap::Error) -> String {
    let all = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => vec![text.clone()],
        Some(ContextValue::Strings(texts)) => texts.clone(),
        Some(ContextValue::StyledStrs(texts)) => texts.iter().map(ToString::to_string).collect(),
        Some(ContextValue::StyledStr(text)) => vec![text.to_string()],
        _ => Vec::new(),
    };
    let one = |kind| all(kind).join(", ");
    let options: Vec<String> = all(Kind::InvalidArg).iter().map(|shown| name(shown)).collect();
    let option = options.join(", ");
    let value = one(Kind::InvalidValue);
    let what = match error.kind() {
        ErrorKind::UnknownArgument if option.starts_with('-') => {
            format!("there is no option {option}")
        }
        ErrorKind::UnknownArgument => {
            format!("'{}' is one argument too many", one(Kind::InvalidArg))
        }
        ErrorKind::InvalidSubcommand => {
            format!("there is no verb '{}'", one(Kind::InvalidSubcommand))
        }
        ErrorKind::MissingRequiredArgument => format!("missing: {option}"),
        ErrorKind::InvalidValue if value.is_empty() => format!("{option} needs a value"),
        ErrorKind::InvalidValue => {
            format!("{option} cannot be '{value}'; it must be one of {}", one(Kind::ValidValue))
        }
        ErrorKind::ValueValidation if !option.is_empty() => {
            let why = error.source().map(ToString::to_string).unwrap_or_default();
            match why.contains(&format!("'{value}'")) {
                true => format!("{option}: {why}"),
                false => format!("{option} cannot be '{value}'; {why}"),
            }
        }
        ErrorKind::ArgumentConflict => {
            format!("{option} cannot be used with {}; leave one out", name(&one(Kind::PriorArg)))
        }
        _ => {
            let text = error.render().to_string();
            text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_string()
        }
    };
    let near = [Kind::SuggestedArg, Kind::SuggestedSubcommand, Kind::SuggestedValue]
        .into_iter()
        .find_map(|kind| all(kind).pop());
    let near = near.map(|near| format!(" (did you mean {near}?)"));
    let advice = shell::advice(error).map(|advice| format!("; {advice}"));
    let remedy = advice.or(near).unwrap_or_default();
    let usage = one(Kind::Usage);
    let usage = usage.trim_start_matches("Usage: ").split(['[', '<']).next().unwrap_or_default();
    let help = match usage.split(" -").next().unwrap_or_default().trim() {
        "" => String::new(),
        command => format!("; see {command} --help"),
    };
    format!("{what}{remedy}{help}")
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
        let is_checked = std::thread::current().name() == Some(subject::THREAD);
        if let Some(refusal) = no_memory(panic.payload()).filter(|_| !is_checked) {
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
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
