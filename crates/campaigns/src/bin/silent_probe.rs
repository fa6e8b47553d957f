//! Checks that a silent probe costs nothing: direct checking with [`Silent`] executes as many
//! instructions as a hand-written copy without a probe.
//!
//! `cargo run --release -p contactbench-campaigns --bin silent_probe` runs both under `valgrind
//! --tool=callgrind`, which counts instructions repeatably even on a busy machine. From both counts
//! it subtracts that of the same program without direct checking. It fails if they differ by more
//! than 1%. A run with [`Tally`] shows that the comparison can fail. Without valgrind nothing is
//! compared.
//!
//! Then it prints the instructions per particle of every detector.

use std::hint::black_box;
use std::process::{Command, ExitCode};

use contactbench_detectors::book::direct::Direct;
use contactbench_detectors::table;
use contactbench_detectors::table::{Role, TABLE};
use contactbench_ground::contact::Test;
use contactbench_ground::detect::any::run;
use contactbench_ground::detect::{Declare, Options};
use contactbench_ground::probe::{Silent, Tally};
use contactbench_ground::scene::{AnyScene, Radii, Scene, Stored, array};
use contactbench_scenes::spec::Spec;

/// Direct checking without a probe, in rounded arithmetic and with one radius.
#[inline(never)]
fn twin(scene: &Scene<'_, f64, 3>, pairs: &mut Vec<[u32; 2]>) {
    let Radii::Uniform(r) = *scene.radii() else { return };
    let (centres, square) = (scene.centres(), (r + r) * (r + r));
    let n = centres.len() as u32;
    for i in 0..n {
        for j in i + 1..n {
            let (a, b) = (array(&centres[i as usize]), array(&centres[j as usize]));
            let (x, y, z) = (a[0] - b[0], a[1] - b[1], a[2] - b[2]);
            if x * x + y * y + z * z <= square {
                pairs.push([i, j]);
            }
        }
    }
}

/// Number of spheres.
const N: usize = 2_000;

fn work(what: &str) -> usize {
    let any = Spec::parse(&format!("packed:dim=3,n={N}"))
        .and_then(|spec| spec.make())
        .expect("the scene is a constant of this bench");
    let AnyScene::Space(Stored::F64(scene)) = &any else { return 0 };
    let mut pairs = Vec::with_capacity(20_000);
    let mut direct = Direct::with(Options::default());
    match what {
        "twin" => twin(scene, &mut pairs),
        "silent" => run(&mut direct, scene, Test::Rounded, &mut Silent, &mut pairs)
            .expect("direct refuses nothing here"),
        "tally" => {
            let mut tally = Tally::default();
            run(&mut direct, scene, Test::Rounded, &mut tally, &mut pairs)
                .expect("direct refuses nothing here");
            black_box(tally);
        }
        "nothing" => {}
        name => table::parse(name)
            .expect("a name from the table")
            .make(Options::default())
            .list(&any, Test::Rounded, &mut pairs)
            .expect("every detector accepts 2,000 spheres"),
    }
    black_box(pairs).len()
}

/// Returns how many instructions this program executes for `what`, or `None` without valgrind.
fn instructions(what: &str) -> Option<f64> {
    let program = std::env::current_exe().ok()?;
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(["--do", what])
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr);
    let count = text.lines().find_map(|line| line.split("Collected :").nth(1))?;
    count.trim().parse().ok()
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|argument| argument == "--do") {
        println!("{} contacts", work(arguments.get(at + 1).map_or("", String::as_str)));
        return ExitCode::SUCCESS;
    }
    let counts = ["nothing", "twin", "silent", "tally"].map(instructions);
    let [Some(nothing), Some(twin), Some(silent), Some(tally)] = counts else {
        println!(
            "silent_probe: skipped, valgrind is not installed (Debian: apt-get install valgrind)"
        );
        return ExitCode::SUCCESS;
    };
    let (silent, tally) =
        ((silent - nothing) / (twin - nothing), (tally - nothing) / (twin - nothing));
    println!(
        "silent_probe: instructions of direct checking against a hand-written twin: silent \
         {silent:.5}, tally {tally:.5}"
    );
    for entry in TABLE.iter().filter(|entry| entry.role == Role::Detector) {
        let count = instructions(entry.name).map_or(0.0, |count| (count - nothing) / N as f64);
        println!("instructions {} {count:.0}", entry.name);
    }
    if (silent - 1.0).abs() <= 0.01 && tally > 1.01 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
