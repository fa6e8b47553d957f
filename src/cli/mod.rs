//! The command line: one file per verb.

// What is printed goes through `say!` and `terminal::out`.
#![deny(clippy::print_stderr, clippy::print_stdout)]

#[macro_use]
pub mod shared;

pub mod check;
pub mod compare;
pub mod detect;
pub mod draw;
pub mod inspect;
pub mod list;
pub mod map;
pub mod merge;
pub mod new_detector;
pub mod process;
pub mod recommend;
pub mod report;
pub mod run;
pub mod runner;
pub mod satellite;
pub mod scene;
pub mod shell;
pub mod trace;
pub mod track;
pub mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
pub use shared::terminal::say;

/// Which contact detection algorithm, for which scene: how fast, how much memory, how many
/// operations, and how wrong?
#[derive(Parser)]
#[command(
    version,
    about,
    args_conflicts_with_subcommands = true,
    after_help = "Without a verb the standard reproduction is run: the book's scaling figures, on \
                  this machine, in minutes.\n\nExit codes: 0 all is well; 1 a detector was wrong, \
                  a machine-independent claim failed, a record is damaged, or two lists or \
                  records differ; 2 bad arguments or input; 130 ended by Ctrl-C."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub verb: Option<Verb>,
    /// The standard reproduction in seconds: small scenes, few blocks
    #[arg(long)]
    pub quick: bool,
}

/// One line for each verb: its options, and what does it.
macro_rules! verbs {
    ($($(#[$about:meta])* $verb:ident($options:ty) => $run:expr,)*) => {
        /// What can be done.
        #[derive(Subcommand)]
        pub enum Verb {
            $($(#[$about])* $verb($options),)*
        }

        impl Verb {
            fn run(&self) -> anyhow::Result<ExitCode> {
                match self {
                    $(Verb::$verb(options) => $run(options),)*
                }
            }
        }
    };
}

verbs! {
    /// Runs experiments: measures, checks every answer, writes record, report and figures
    #[command(after_help = "Example: contactbench run scaling --quick\nExample: contactbench run \
                            my-experiment.toml --out results/mine")]
    Run(run::Run) => run::run,
    /// Makes report and figures of a result folder again, from its record alone
    #[command(after_help = "Example: contactbench report results/reference/standard")]
    Report(report::Report) => report::report,
    /// Compares two result folders: of two revisions, or two machines
    #[command(after_help = "Example: contactbench compare results/before results/after\nExample: \
                            contactbench compare laptop server --against nbs\nExit code 1 if \
                            pairs, counts, bytes or outcomes differ (with --gate-time, also if \
                            more cells are slower than chance explains).")]
    Compare(compare::Compare) => compare::compare,
    /// Merges result folders of shards, or of several machines
    #[command(after_help = "Example: contactbench merge part-1 part-2 part-3 --out whole")]
    Merge(merge::Merge) => merge::merge,
    /// Draws who is the fastest over two variables, from result folders
    #[command(after_help = "Example: contactbench map results/reference-sizes --x size-ratio --y \
                            n\nExample: contactbench map laptop server --x n --y density --where \
                            dim=3 --out map.svg")]
    Map(map::Map) => map::map,
    /// Lists detectors with cost, memory and limits; scenes; experiments; hard cases
    #[command(after_help = "Example: contactbench list detectors")]
    List(list::List) => list::list,
    /// Cross-checks detectors against all pairs tested: for your CI
    #[command(after_help = "Example: contactbench check --detector nbs\nExit code 1 if one \
                            disagrees; the smallest failing scene found is written as CSV.")]
    Check(check::Check) => check::check,
    /// Finds the touching pairs of a particle file
    #[command(after_help = "Example: contactbench detect packing.csv --detector nbs -o \
                            pairs.csv\nExample: contactbench detect centres.npy --radius 0.5 \
                            --arithmetic f64 > pairs.csv")]
    Detect(detect::Detect) => detect::detect,
    /// Says what is understood of a particle file, and warns of the usual mistakes
    #[command(after_help = "Example: contactbench inspect packing.dump\nExample: contactbench \
                            inspect centres.npy --radius 0.5 --json")]
    Inspect(inspect::Inspect) => inspect::inspect,
    /// Compares a contact list of another code with the exact truth
    #[command(after_help = "Example: contactbench verify packing.csv --pairs theirs.csv --base \
                            1\nExample: contactbench verify flow.dump --pairs lists.dump --frame \
                            all\nExit code 1 if the lists differ.")]
    Verify(Box<verify::Verify>) => verify::verify,
    /// Writes a scene to a file, for use in your own code
    #[command(after_help = "Example: contactbench scene packed:dim=3,n=1000,seed=1 -o \
                            packed.csv\nExample: contactbench scene packing.dump --frame last -o \
                            packing.xyz")]
    Scene(scene::Scene) => scene::scene,
    /// Says which detector to use for a scene: measures them there
    #[command(after_help = "Example: contactbench recommend packing.csv\nExample: contactbench \
                            recommend clustered:dim=3,n=100000 --threads 2")]
    Recommend(recommend::Recommend) => recommend::recommend,
    /// Writes a new detector that works, as a file to be changed, and its line in the table: in a
    /// checkout
    #[command(after_help = "Example: contactbench new-detector quad-tree --in ~/contactbench")]
    NewDetector(new_detector::NewDetector) => new_detector::new_detector,
    /// Draws a scene with its contacts, or a slice through spheres, or plays it as it moves
    #[command(after_help = "Example: contactbench draw packing.csv\nExample: contactbench draw \
                            packed:dim=3,n=2000 --slice z=4 -o slice.svg\nExample: contactbench \
                            draw packing.csv --pairs theirs.csv\nExample: contactbench draw \
                            packed:n=200 --motion vortex -o play.html")]
    Draw(draw::Draw) => draw::draw,
    /// Shows a detector of the book step by step: one HTML page that steps with the arrow keys, and
    /// an SVG of each step
    #[command(after_help = "Example: contactbench trace nbs\nExample: contactbench trace \
                            screening packed:n=12 -o lecture\nWithout a scene the book's worked \
                            example is shown.")]
    Trace(trace::Trace) => trace::trace,
    /// Moves a scene, frame by frame, and says what lists of near pairs cost and miss
    #[command(after_help = "Example: contactbench track packed:dim=3,n=10000 --motion \
                            drift:speed=0.01\nExample: contactbench track packing.csv --motion \
                            vortex --tracker 'verlet(nbs,skin=0.3,rule=lammps-10-1-yes)'\nExit \
                            code 1 if a tracker missed a contact that promises to miss none.")]
    Track(track::Track) => track::track,
    /// Finds the contacts of one scene by several ranks: the program contactbench-ranks
    Ranks(satellite::Passed) => (|passed| satellite::run("contactbench-ranks", passed)),
    /// Writes a completion script for your shell
    #[command(after_help = "Example: contactbench completions bash\nWrite it to a file such as \
                            ~/.local/share/bash-completion/completions/contactbench")]
    Completions(shell::Completions) => shell::completions,
    /// Serves one detector on standard input and output: see docs/PROTOCOL.md
    #[command(
        after_help = "Example: echo '{\"request\":\"quit\"}' | contactbench runner --detector nbs"
    )]
    Runner(runner::Serve) => runner::serve,
}

impl Cli {
    /// Does what was asked for.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        self.verb.map_or_else(|| run::standard(self.quick), |verb| verb.run())
    }
}

/// Bytes as people read them.
pub fn bytes(bytes: u64) -> String {
    match bytes {
        0..10_000 => format!("{bytes} B"),
        10_000..10_000_000 => format!("{:.1} KB", bytes as f64 / 1e3),
        10_000_000..10_000_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{:.1} GB", bytes as f64 / 1e9),
    }
}

/// Tells rayon how many threads there are. One thread needs no pool, and its worker would allocate
/// while memory is measured.
fn use_threads(threads: usize) {
    if threads > 1 {
        // Fails only if there is a pool already; nothing before this call makes one.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
}
