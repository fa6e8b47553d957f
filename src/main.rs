//! The `contactbench` program: verbs to modules.

use std::process::ExitCode;

use clap::Parser;
use contactbench::cli::{
    Cli, Verb, check, compare, detect, draw, inspect, list, merge, new_detector, recommend, run,
    runner, scene, shell, trace, verify,
};
use contactbench::run::alloc::Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn main() -> ExitCode {
    let result = match Cli::parse().verb {
        None => run::standard(),
        Some(Verb::Run(options)) => run::run(&options),
        Some(Verb::Report(options)) => run::report(&options),
        Some(Verb::Compare(options)) => compare::compare(&options),
        Some(Verb::Merge(options)) => merge::merge(&options),
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
        Some(Verb::Completions(options)) => shell::completions(&options),
        Some(Verb::Runner(options)) => runner::serve(&options),
    };
    match result {
        Ok(code) => code,
        Err(error) if broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("contactbench: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Whoever read our output has seen enough.
fn broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
