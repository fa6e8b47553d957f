//! Time and memory for reading files. Run `cargo bench -p contactbench-campaigns --bench readers`;
//! a number after `--` replaces the number of particles.
//!
//! Ten million spheres with different radii are written as CSV in shortest decimals (mostly 17
//! digits), as npy, and as extended XYZ. Targets: CSV in 10 s, npy in 1 s, memory at most 2.5 times
//! the bytes of the coordinates. Files are read from the page cache.

use std::time::Instant;

use contactbench_io as io;
use contactbench_io::{Options, write};
use contactbench_run::run::runner::alloc;
use contactbench_run::run::runner::alloc::Counting;
use contactbench_scenes::spec::Spec;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn main() -> anyhow::Result<()> {
    let n: u64 =
        std::env::args().filter_map(|argument| argument.parse().ok()).next().unwrap_or(10_000_000);
    let folder = tempfile::tempdir()?;
    let spec = Spec::parse(&format!("packed:dim=3,n={n},size-ratio=3,order=generated"))?;
    let scene = spec.make()?;
    println!(
        "{:<6} {:>12} {:>10} {:>10} {:>22}",
        "format", "file", "time", "per s", "peak / coordinates"
    );
    for ending in ["csv", "npy", "xyz"] {
        let path = folder.path().join(format!("scene.{ending}"));
        write::scene(&path, &scene.clone().into())?;
        let size = std::fs::metadata(&path)?.len();
        for _ in 0..2 {
            let started = Instant::now();
            let (found, usage) = alloc::measure(|| io::scene(&path, Options::NONE));
            let seconds = started.elapsed().as_secs_f64();
            anyhow::ensure!(found? == scene, "{ending}: the scene that was read is another");
            let peak = usage.map_or(f64::NAN, |usage| usage.peak_bytes as f64 / (24 * n) as f64);
            println!(
                "{ending:<6} {:>9.1} MB {seconds:>8.2} s {:>7.1} MB {peak:>22.2}",
                size as f64 / 1e6,
                size as f64 / 1e6 / seconds
            );
        }
        std::fs::remove_file(&path)?;
    }
    Ok(())
}
