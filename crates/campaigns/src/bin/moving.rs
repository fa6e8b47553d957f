//! Does a tracker that promises to miss no contact miss one? Every frame is held to its truth.
//!
//! `cargo run --release -p contactbench-campaigns --bin moving -- --pair-steps 1000000000`
//!
//! First scenes in motion: all motions, in 2D and 3D, at speeds from 10^-4 to 1 diameters per
//! frame, packed, loose and clustered, of one size and of many, in every safe arithmetic, their
//! frames in order or, once in four times, in any. Every detector is asked in every frame and
//! builds the lists of every safe rule, with skins from 0 to 1 diameters and `auto`. Then couples
//! that come into touch just when their ways have used up the skin, to the unit, made of whole
//! numbers, at scales from 2^-900 to 2^900 and offsets to 10^9 diameters. A pair-step is a contact
//! in a frame, counted for each tracker. Controls must be found to miss some: a rule that looks at
//! no body, and for couples one that is safe but for rounding. Ends with 1 if there is an error.

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use contactbench_campaigns::moving::{Counts, Plan, Table, couples, courses};

#[derive(Parser)]
struct Arguments {
    /// Contacts in frames, each counted for every tracker, of scenes in motion; of couples a
    /// tenth.
    #[arg(long, default_value_t = 1_000_000)]
    pair_steps: u64,
    /// The same seed gives the same courses.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// 0: all cores.
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

fn main() -> ExitCode {
    let Arguments { pair_steps, seed, threads } = Arguments::parse();
    // A pool that is there already works as well.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    println!("bodies that move, seed {seed}\n");
    let courses = part("Scenes in motion", courses, Plan { pair_steps, seed });
    let few = Plan { pair_steps: pair_steps / 10, seed };
    let couples = part("Couples at the limit of the skin", couples, few);
    for (family, came) in &couples.came {
        println!("{family}: {came} couples came into touch that were not listed at first");
    }
    let mut found = true;
    for (what, table) in [("every tenth frame", &courses), ("rounded ways", &couples)] {
        let Counts { missed, pair_steps, .. } = table.total(false);
        println!("control, lists built by {what}: {missed} of {pair_steps} pair-steps missed");
        found &= missed > 0;
    }
    let errors = courses.errors() + couples.errors();
    println!("{errors} errors in all");
    ExitCode::from(u8::from(errors > 0 || !found))
}

/// Runs and prints one part.
fn part(title: &str, run: fn(Plan) -> Table, plan: Plan) -> Table {
    let start = Instant::now();
    let table = run(plan);
    let (seconds, safe) = (start.elapsed().as_secs_f64(), table.total(true));
    println!("{title}\n{}", table.text());
    println!(
        "{} pair-steps in {} frames in {seconds:.0} s: {} missed, {} reported that do not touch, \
         {} frames refused\n",
        safe.pair_steps, safe.frames, safe.missed, safe.wrong, safe.refused
    );
    table
}
