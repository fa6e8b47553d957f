//! Is the exact contact test right, and do detectors built on it lose, add or repeat a pair? On
//! pairs as near to tangency as numbers go.
//!
//! `cargo run --release -p contactbench-campaigns --bin near_tangent -- --pairs 1000000000`
//!
//! Couples are built from integers, so that apart, tangent or overlapping is known without the
//! library: Pythagorean triples and quadruples moved by one ulp, random directions whose sum of
//! radii is the rounded distance, sums that need 60 bits, couples that leave their axis by as
//! little as 2^-900; scales from 2^-1010 to 2^970, offsets up to 10^12 diameters. First the contact
//! test alone answers, then every detector, on scenes of isolated couples within one ulp of the
//! borders of cells, and in boxes that repeat, where couples meet through faces, edges and corners,
//! and particles meet images of themselves (*offset*: how many boxes away particles are). Column
//! *exact* is the share of decisions that the filter left to exact arithmetic, *other* counts wrong
//! labels, signs of depth, self-contacts and refusals, and *f64* is the share of couples that the
//! rounded test decides wrongly: the proof that these couples can find an error. Ends with 1 if
//! there is one.

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use contactbench_campaigns::near_tangent::counts::What;
use contactbench_campaigns::near_tangent::{Line, Plan, boxes, detectors, predicate, table, total};
use contactbench_core::contact::Test;

#[derive(Parser)]
struct Arguments {
    /// Couples for the contact test, and decisions of detectors, in open space and in boxes.
    #[arg(long, default_value_t = 1_000_000)]
    pairs: u64,
    /// The same seed gives the same couples.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// 0: all cores.
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

fn main() -> ExitCode {
    let Arguments { pairs, seed, threads } = Arguments::parse();
    // A pool that is there already works as well.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    let plan = Plan { pairs, seed, test: Test::Exact };
    println!("near-tangent couples, seed {seed}\n");
    let errors = part("The contact test", predicate, plan)
        + part("Every detector", detectors, plan)
        + part("Every detector, in boxes that repeat", boxes, plan);
    println!("{errors} errors in all");
    ExitCode::from(u8::from(errors > 0))
}

/// Runs and prints one part; the number of its errors.
fn part(title: &str, run: fn(Plan) -> Vec<Line>, plan: Plan) -> u64 {
    let start = Instant::now();
    let lines = run(plan);
    let (seconds, sum) = (start.elapsed().as_secs_f64(), total(&lines));
    println!("{title}\n{}", table(&lines));
    let (decisions, rounded, wrong) =
        (sum.get(What::Pairs), sum.get(What::Rounded), sum.get(What::RoundedWrong));
    println!(
        "{decisions} decisions in {seconds:.1} s, {:.2} million a second; {} errors",
        decisions as f64 / seconds / 1e6,
        sum.errors()
    );
    if sum.get(What::Sampled) > 0 {
        println!(
            "{} labels also by rational arithmetic, {} differ",
            sum.get(What::Sampled),
            sum.get(What::Construction)
        );
    }
    println!(
        "control, the same pairs decided in f64: {wrong} of {rounded} wrong, {:.1}%\n",
        100.0 * wrong as f64 / rounded.max(1) as f64
    );
    sum.errors()
}
