//! The `contactbench` program: verbs to modules.

use std::process::ExitCode;

use contactbench::cli::{
    Cli, Verb, check, compare, detect, draw, inspect, list, map, merge, new_detector, process,
    recommend, report, run, runner, satellite, scene, shell, trace, track, verify,
};
use contactbench::run::alloc::Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn main() -> ExitCode {
    process::prepare(contactbench::build!());
    let cli = match process::parsed::<Cli>() {
        Ok(cli) => cli,
        Err(code) => return code,
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
        Some(Verb::Ranks(passed)) => satellite::run("contactbench-ranks", &passed),
        Some(Verb::Completions(options)) => shell::completions(&options),
        Some(Verb::Runner(options)) => runner::serve(&options),
    };
    process::ended(result)
}
