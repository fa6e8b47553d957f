//! The command line: one file per verb. Folders group verbs as the help does.

// Output goes through `say!` and `terminal::out`.
#![deny(clippy::print_stderr, clippy::print_stdout)]

#[macro_use]
pub mod shared;

pub mod detect;
pub mod draw;
mod help;
pub mod inspect;
pub mod list;
pub mod measuring;
pub mod process;
pub mod recommend;
pub mod satellite;
pub mod scene;
pub mod shell;
pub mod track;
pub mod verify;
pub mod your_detector;

use std::process::{ExitCode, Termination};

use clap::{Parser, Subcommand};
use measuring::{compare, merge, report, run, site};
pub use shared::terminal::say;
use your_detector::{check, new_detector, runner, trace};

const VERSION: &str =
    concat!(env!("CARGO_PKG_VERSION"), " (commit ", env!("CONTACTBENCH_REVISION"), ")");

/// Which contact detection algorithm suits which scene: time, memory, error
#[derive(Parser)]
#[command(
    version = VERSION,
    subcommand_value_name = "VERB",
    args_conflicts_with_subcommands = true,
    help_template = help::template(),
    after_help = "Without a verb, contactbench runs the book's scaling experiments (4 minutes).\n\
                  contactbench VERB --help lists a verb's options; docs/ explains them.\n\n\
                  Exit codes: 0 all is well; 1 a wrong answer, a failed claim, a damaged record,\n\
                  or two lists or records that differ; 2 bad arguments or input; 130 Ctrl-C,\n\
                  143 SIGTERM."
)]
pub struct Cli {
    #[command(subcommand)]
    pub verb: Option<Verb>,
    /// Use small scenes and few blocks: seconds
    #[arg(long)]
    pub quick: bool,
}

/// Groups of verbs. Each verb has the line of its help, its options, the function that runs it,
/// examples without the name of the program, and where to read more.
macro_rules! verbs {
    ($($group:literal { $(
        $(#[$about:meta])* $verb:ident($options:ty) => $run:expr, $examples:expr, $more:literal;
    )* })*) => {
        #[derive(Subcommand)]
        pub enum Verb {
            $($(
                $(#[$about])*
                #[command(after_help = help::examples(&$examples, $more))]
                $verb($options),
            )*)*
        }

        impl Verb {
            fn run(&self) -> anyhow::Result<ExitCode> {
                match self {
                    $($(Verb::$verb(options) => $run(options).map(Termination::report),)*)*
                }
            }
        }

        /// Titles of the groups, each with its number of verbs.
        const GROUPS: &[(&str, usize)] = &[$(($group, [$(stringify!($verb)),*].len())),*];
    };
}

verbs! {
    "Your particles" {
        /// Prints what a particle file holds, and warns of common mistakes
        Inspect(inspect::Inspect) => inspect::inspect,
            ["inspect packing.dump", "inspect centres.npy --radius 0.5 --json"],
            "docs/FILES.md";
        /// Finds the contacts in a particle file
        Detect(detect::Detect) => detect::detect,
            ["detect packing.csv --detector nbs -o pairs.csv",
             "detect centres.npy --radius 0.5 --arithmetic f64"],
            "docs/FILES.md";
        /// Compares another code's contact list with the exact truth
        Verify(Box<verify::Verify>) => verify::verify,
            ["verify packing.csv --pairs theirs.csv --base 1",
             "verify flow.dump --pairs lists.dump --frame all"],
            "docs/FILES.md\nExit code 1: the lists differ";
        /// Follows moving particles: what neighbour lists cost and miss
        Track(track::Track) => track::track,
            ["track packed:dim=3,n=10000 --motion drift:speed=0.01",
             "track packing.csv --motion vortex --tracker 'verlet(nbs)'"],
            "docs/MOTION.md\nExit code 1: a tracker that promises to miss no contact missed one";
        /// Draws a scene with its contacts, and the errors of a list
        Draw(draw::Draw) => draw::draw,
            ["draw packing.csv", "draw packing.csv --pairs theirs.csv",
             "draw packed:dim=3,n=2000 --slice z=4 -o slice.svg"],
            "docs/SEEING.md";
        /// Measures which detector is the fastest on your particles
        Recommend(recommend::Recommend) => recommend::recommend,
            ["recommend packing.csv", "recommend clustered:dim=3,n=100000 --threads 2"],
            "docs/DETECTORS.md\nExit code 1: a detector was wrong, or none can be used";
    }
    "Measuring" {
        /// Runs experiments; writes record, report and figures
        Run(run::Run) => run::run,
            ["run scaling --quick", "run my-experiment.toml -o results/mine"],
            "docs/EXPERIMENTS.md";
        /// Makes report and figures again from a record
        Report(report::Report) => report::report,
            ["report results/before"],
            "docs/REPORT.md";
        /// Compares two records: two builds or two machines
        Compare(compare::Compare) => compare::compare,
            ["compare results/before results/after", "compare laptop server --against nbs"],
            "docs/COMPARE.md\nExit code 1: pairs, counts, bytes or outcomes differ";
        /// Merges the records of shards or of several machines
        Merge(merge::Merge) => merge::merge,
            ["merge part-1 part-2 -o whole"],
            "docs/CLUSTER.md";
        /// Makes a static site of all records in a folder
        Site(site::Site) => site::site,
            ["site results -o site"],
            "docs/REPORT.md";
    }
    "Your detector" {
        /// Adds a working detector to this checkout, for you to change
        NewDetector(new_detector::NewDetector) => new_detector::new_detector,
            ["new-detector quad-tree"],
            "docs/DETECTORS.md";
        /// Compares detectors with testing all pairs, also in CI
        Check(check::Check) => check::check,
            ["check --detector nbs", "check --runner 'python3 my_detector.py'"],
            "docs/DETECTORS.md\nExit code 1: a detector is wrong; 2: nothing was compared";
        /// Serves one detector over standard input and output
        Runner(runner::Serve) => runner::serve,
            ["runner --detector nbs"],
            "docs/PROTOCOL.md";
        /// Shows a detector of the book step by step, on a page
        Trace(trace::Trace) => trace::trace,
            ["trace nbs", "trace screening packed:n=12 -o lecture.html"],
            "docs/SEEING.md";
    }
    "More" {
        /// Lists detectors, scenes, motions, trackers and experiments
        List(list::List) => list::list,
            ["list detectors", "list scenes --json"],
            "docs/DETECTORS.md";
        /// Writes a scene, or frames of a motion, to a file
        Scene(scene::Scene) => scene::scene,
            ["scene packed:dim=3,n=1000,seed=1 -o packed.csv",
             "scene packing.dump --frame last -o packing.xyz"],
            "docs/FILES.md";
        /// Finds the contacts of one scene with several processes (MPI)
        Ranks(satellite::Passed) => (|passed| satellite::run("contactbench-ranks", passed)),
            ["ranks packing.csv"],
            "docs/CLUSTER.md";
        /// Prints a completion script for your shell, or writes man pages
        Completions(shell::Completions) => shell::completions,
            ["completions bash"],
            "the manual of your shell on where such a script goes";
    }
}

impl Cli {
    pub fn run(self) -> anyhow::Result<ExitCode> {
        self.verb.map_or_else(|| run::standard(self.quick), |verb| verb.run())
    }
}

/// Formats a number of bytes for people: at most four digits and a unit.
pub fn bytes(bytes: u64) -> String {
    match bytes {
        0..10_000 => format!("{bytes} B"),
        10_000..10_000_000 => format!("{:.1} KB", bytes as f64 / 1e3),
        10_000_000..10_000_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{:.1} GB", bytes as f64 / 1e9),
    }
}

/// Sets rayon's number of threads. For one thread it makes no pool, because the pool's worker would
/// allocate while memory is measured.
fn use_threads(threads: usize) {
    if threads > 1 {
        // This call fails only if rayon's pool exists, and no earlier code makes it.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
}
