//! `cargo run --release -p contactbench-campaigns -- --pairs 1000000000 [PART ...]`
//!
//! * `predicate` checks the exact contact test. It decides pairs as close to tangency as numbers
//!   allow, built from integers, so that the label is known without the library: Pythagorean
//!   triples and quadruples changed by one ulp, random directions with a rounded sum of radii, sums
//!   that need 60 bits, pairs that leave their axis by as little as 2^-900. Scales range from
//!   2^-1010 to 2^970, offsets up to 10^12 diameters.
//! * `detectors` checks whether a detector misses, adds or repeats a pair. Each pair is isolated,
//!   and within one ulp of the borders of cells.
//! * `boxes` does the same in periodic boxes. Pairs touch through faces, edges and corners,
//!   particles touch images of themselves, and particles are given by images up to 10^6 boxes away.
//! * `trackers` checks whether a safe tracker misses a contact. It covers all motions in 2D and 3D,
//!   speeds from 10^-4 to 1 diameters per frame, packed, loose and clustered scenes, one size and
//!   many, and every safe arithmetic. One run in four shuffles the frames. Every detector searches
//!   every frame and builds the lists of every safe rule.
//! * `pairs` builds pairs from integers that come into contact exactly when their displacements
//!   have used up the skin, at scales from 2^-900 to 2^900 and offsets up to 10^9 diameters.
//!
//! The column *exact* counts decisions that the filter left to exact arithmetic. The column *wrong
//! in f64* counts pairs that the rounded test decides wrongly, which proves that these pairs can
//! reveal an error. Controls must miss some contacts. The exit code is 1 if there is an error.

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use contactbench_campaigns::{Plan, Totals, What, boxes, predicate, skin, tracking};

#[derive(Parser)]
struct Arguments {
    /// Names of the campaigns to run (default: all five)
    parts: Vec<String>,
    /// Decisions in each campaign; a tenth for `pairs`
    #[arg(long, default_value_t = 1_000_000)]
    pairs: u64,
    /// Seed of all pairs and trajectories
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; 0: all cores
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

/// Name, function, divisor of the planned number of decisions, and a count of errors that must be
/// above 0: it proves that errors are found.
type Part = (&'static str, fn(Plan) -> Totals, u64, fn(&Totals) -> u64);

const PARTS: [Part; 5] = [
    ("predicate", predicate::run, 1, |table| table.total(true).get(What::RoundedWrong)),
    ("detectors", boxes::detectors, 1, |table| table.total(true).get(What::RoundedWrong)),
    ("boxes", boxes::boxes, 1, |table| table.total(true).get(What::RoundedWrong)),
    ("trackers", tracking::trackers, 1, |table| table.total(false).get(What::Missed)),
    ("pairs", skin::pairs, 10, |table| table.total(false).get(What::Missed)),
];

fn main() -> ExitCode {
    let Arguments { parts, pairs, seed, threads } = Arguments::parse();
    // If a pool exists already, that one is used.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    let unknown = parts.iter().find(|part| PARTS.iter().all(|known| known.0 != **part));
    if let Some(part) = unknown {
        eprintln!(
            "there is no part '{part}'; the parts are {}",
            PARTS.map(|part| part.0).join(", ")
        );
        return ExitCode::from(2);
    }
    let mut failed = false;
    for (name, run, share, found) in PARTS {
        if !parts.is_empty() && !parts.iter().any(|part| part == name) {
            continue;
        }
        let start = Instant::now();
        let table = run(Plan { pairs: (pairs / share).max(1), seed });
        let (errors, control) = (table.errors(), found(&table));
        println!("{name}, seed {seed}, {:.0} s\n{}", start.elapsed().as_secs_f64(), table.text());
        println!("{errors} errors; {control} in the control\n");
        failed |= errors > 0 || control == 0;
    }
    ExitCode::from(u8::from(failed))
}
