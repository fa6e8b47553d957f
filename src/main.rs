//! The `contactbench` program: verbs to modules.

use std::borrow::Cow;
use std::process::ExitCode;

use clap::Parser;
use contactbench::check::contender;
use contactbench::cli::{
    Cli, Verb, check, compare, detect, draw, inspect, list, map, merge, new_detector, ranks,
    recommend, report, run, runner, say, scene, shell, trace, track, verify,
};
use contactbench::record::built::{self, Build};
use contactbench::record::faults::Damaged;
use contactbench::run::alloc::Counting;
use contactbench::text::{line, lines};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const BUILD: Build = Build {
    revision: env!("CONTACTBENCH_REVISION"),
    dirty: env!("CONTACTBENCH_DIRTY"),
    features: env!("CONTACTBENCH_FEATURES"),
    rustc: env!("CONTACTBENCH_RUSTC"),
    rustflags: env!("CONTACTBENCH_RUSTFLAGS"),
    profile: env!("CONTACTBENCH_PROFILE"),
};

fn main() -> ExitCode {
    built::set(BUILD);
    report_full_files();
    report_missing_memory();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
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
            return ExitCode::from(2);
        }
    };
    let result = match cli.verb {
        None => run::standard(cli.quick),
        Some(Verb::Run(options)) => run::run(&options),
        Some(Verb::Report(options)) => report::report(&options),
        Some(Verb::Compare(options)) => compare::compare(&options),
        Some(Verb::Merge(options)) => merge::merge(&options),
        Some(Verb::Map(options)) => map::map(&options),
        Some(Verb::List(options)) => list::list(&options),
        Some(Verb::Check(options)) => check::check(&options),
        Some(Verb::Detect(options)) => detect::detect(&options),
        Some(Verb::Inspect(options)) => inspect::inspect(&options),
        Some(Verb::Verify(options)) => verify::verify(&options),
        Some(Verb::Scene(options)) => scene::scene(&options),
        Some(Verb::NewDetector(options)) => new_detector::new_detector(&options),
        Some(Verb::Recommend(options)) => recommend::recommend(&options),
        Some(Verb::Draw(options)) => draw::draw(&options),
        Some(Verb::Trace(options)) => trace::trace(&options),
        Some(Verb::Track(options)) => track::track(&options),
        Some(Verb::Ranks(options)) => ranks::ranks(&options),
        Some(Verb::Completions(options)) => shell::completions(&options),
        Some(Verb::Runner(options)) => runner::serve(&options),
    };
    match result {
        Ok(code) => code,
        Err(error) if broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("contactbench: {error:#}"));
            // What is wrong is found, as a wrong answer is.
            ExitCode::from(if error.chain().any(|cause| cause.is::<Damaged>()) { 1 } else { 2 })
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
        let words = panic.payload_as_str().unwrap_or_default();
        // `check` reports the detector and goes on.
        let is_checked = std::thread::current().name() == Some(contender::THREAD);
        if words.contains("could not be had") && !is_checked {
            say(&format!("contactbench: {words}"));
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
