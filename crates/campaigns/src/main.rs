//! `cargo run --release -p contactbench-campaigns -- --pairs 1000000000 [PART ...]`
//!
//! * `predicate`: is the exact contact test right? It decides pairs as near to tangency as numbers
//!   go, built from integers, so that apart, tangent or overlapping is known without the library:
//!   Pythagorean triples and quadruples moved by one ulp, random directions whose sum of radii is
//!   the rounded distance, sums that need 60 bits, pairs that leave their axis by as little as
//!   2^-900; scales from 2^-1010 to 2^970, offsets up to 10^12 diameters.
//! * `detectors`: does a detector lose, add or repeat a pair? Each pair is isolated, and within one
//!   ulp of the borders of cells.
//! * `boxes`: the same in periodic boxes, in which pairs meet through faces, edges and corners, and
//!   particles meet images of themselves; particles are named by images up to 10^6 boxes away.
//! * `courses`: does a tracker that promises to miss no contact miss one? It follows all motions,
//!   in 2D and 3D, at speeds from 10^-4 to 1 diameters per frame, packed, loose and clustered, of
//!   one size and of many, in every safe arithmetic, frames in order or, once in four times, in
//!   any. Every detector searches every frame, and builds the lists of every safe rule.
//! * `couples`: pairs that come into contact just when their displacements have used up the skin,
//!   to the unit, made of whole numbers, at scales from 2^-900 to 2^900 and offsets to 10^9
//!   diameters.
//!
//! Column *exact* counts decisions that the filter left to exact arithmetic, *wrong in f64* pairs
//! that the rounded test decides wrongly: the proof that these pairs can find an error. Controls
//! must be found to miss some. Ends with 1 if there is an error.

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use contactbench_campaigns::{Plan, Table, What, boxes, moving, predicate, skin};
use contactbench_core::contact::Test;

#[derive(Parser)]
struct Arguments {
    /// predicate, detectors, boxes, courses, couples (default: all)
    parts: Vec<String>,
    /// Decisions in each part; a tenth of `couples`
    #[arg(long, default_value_t = 1_000_000)]
    pairs: u64,
    /// The same seed gives the same pairs and trajectories
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// 0: all cores
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

/// Name, what runs it, its share of the decisions, and what proves that it can find an error.
type Part = (&'static str, fn(Plan) -> Table, u64, fn(&Table) -> u64);

const PARTS: [Part; 5] = [
    ("predicate", predicate::run, 1, |table| table.total(true).get(What::RoundedWrong)),
    ("detectors", boxes::detectors, 1, |table| table.total(true).get(What::RoundedWrong)),
    ("boxes", boxes::boxes, 1, |table| table.total(true).get(What::RoundedWrong)),
    ("courses", moving::courses, 1, |table| table.total(false).get(What::Missed)),
    ("couples", skin::couples, 10, |table| table.total(false).get(What::Missed)),
];

fn main() -> ExitCode {
    let Arguments { parts, pairs, seed, threads } = Arguments::parse();
    // A pool that is there already works as well.
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
        let table = run(Plan { pairs: (pairs / share).max(1), seed, test: Test::Exact });
        let (errors, control) = (table.errors(), found(&table));
        println!("{name}, seed {seed}, {:.0} s\n{}", start.elapsed().as_secs_f64(), table.text());
        println!("{errors} errors; {control} in the control\n");
        failed |= errors > 0 || control == 0;
    }
    ExitCode::from(u8::from(failed))
}
