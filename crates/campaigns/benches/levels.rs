//! Compares the instruction sets of this processor for `streamed-nbs`, in turn on the same scenes.
//! Prints the median in nanoseconds per particle, and the ratio to the widest set by block.
//!
//! `cargo bench -p contactbench-campaigns --bench levels -- [N] [scene ...]`; the defaults are
//! 1000000 particles and six scenes. Results are not checked.

use std::time::Instant;

use contactbench_core::contact::Test;
use contactbench_core::detect::Options;
use contactbench_core::detect::any::run;
use contactbench_core::detect::streamed::Streamed;
use contactbench_core::probe::Silent;
use contactbench_core::scene::{AnyScene, Stored};
use contactbench_core::wide::Level;
use contactbench_scenes::spec::Spec;

const BLOCKS: usize = 15;
const SCENES: [&str; 6] = [
    "packed:dim=3",
    "loose:dim=3",
    "clustered:dim=3",
    "packed:dim=2",
    "loose:dim=2",
    "clustered:dim=2",
];

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let n: u64 = arguments.next().map_or(Ok(1_000_000), |n| n.parse())?;
    let mut scenes: Vec<String> = arguments.collect();
    if scenes.is_empty() {
        scenes = SCENES.map(String::from).to_vec();
    }
    let levels = Level::all();
    println!(
        "N = {n}, one thread, exact, {BLOCKS} blocks: ns per particle (ratio to {})",
        levels[0].name()
    );
    for text in scenes {
        let scene = Spec::parse(&format!("{text},n={n}"))?.make()?;
        let mut times = vec![Vec::new(); levels.len()];
        let mut pairs = Vec::new();
        let mut plane: Vec<_> =
            levels.iter().map(|&level| Streamed::<2>::on(level, Options::default())).collect();
        let mut space: Vec<_> =
            levels.iter().map(|&level| Streamed::<3>::on(level, Options::default())).collect();
        // The first block is not counted, because it warms the buffers.
        for _ in 0..=BLOCKS {
            for k in 0..levels.len() {
                pairs.clear();
                let start = Instant::now();
                match &scene {
                    AnyScene::Plane(Stored::F64(scene)) => {
                        run(&mut plane[k], scene, Test::Exact, &mut Silent, &mut pairs)?
                    }
                    AnyScene::Space(Stored::F64(scene)) => {
                        run(&mut space[k], scene, Test::Exact, &mut Silent, &mut pairs)?
                    }
                    _ => unreachable!("generated scenes are in f64"),
                }
                times[k].push(start.elapsed().as_secs_f64() * 1e9 / n as f64);
            }
        }
        let median = |mut all: Vec<f64>| {
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        print!("{text:16} {:>9} pairs", pairs.len());
        for (k, level) in levels.iter().enumerate() {
            let ratio = (1..=BLOCKS).map(|block| times[k][block] / times[0][block]).collect();
            print!(
                "   {} {:6.1} ({:.2})",
                level.name(),
                median(times[k][1..].to_vec()),
                median(ratio)
            );
        }
        println!();
    }
    Ok(())
}
