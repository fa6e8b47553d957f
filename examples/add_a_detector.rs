//! A new detector, from its first line to agreement with the truth.
//!
//! `cargo run --release --example add_a_detector`

use anyhow::ensure;
use contactbench::check::{self, Limits};
use contactbench::scene::spec::Spec;
use contactbench::scene::{AnyScene, Real, Stored};
use contactbench_detectors::oracle;
use contactbench_detectors::table::{Entry, Group, PLAIN};
use contactbench_ground::contact::{Arithmetic, Particles, Test};
use contactbench_ground::detect::any::{self, Both};
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::filter;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::{Digest, Sink};
use contactbench_ground::probe::{Op, Probe, Tally};

/// Sorts the particles by x and tests each against those that follow within reach.
pub struct SweepX(Options, Vec<u32>);

impl Declare for SweepX {
    fn with(options: Options) -> SweepX {
        SweepX(options, Vec::new())
    }

    fn formula_bytes(&self) -> u64 {
        4 * self.1.len() as u64
    }
}

impl<T: Real, const D: usize> Detector<T, D> for SweepX {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let (n, x, order) =
            (particles.len() as u32, |i: u32| particles.position(i)[0], &mut self.1);
        within(&self.0, "sweep-x", 4 * u64::from(n), || format!("{n} particles"))?;
        order.clear();
        order.reserve_exact(n as usize);
        order.extend(0..n);
        order.sort_unstable_by(|&i, &j| {
            probe.count(Op::KeyCompare);
            x(i).total_cmp(&x(j))
        });
        for (k, &i) in order.iter().enumerate() {
            for &j in &order[k + 1..] {
                probe.count(Op::BoundTest);
                if filter::beyond(x(i), x(j), particles.reach()) {
                    break;
                }
                if particles.touch(i, j, probe) {
                    sink.contact(i, j);
                }
            }
        }
        Ok(())
    }
}

static TABLE: &[Entry] = &[Entry {
    name: "sweep-x",
    group: Group::Modern,
    summary: "sorts along x, tests what follows within reach",
    cost: "N log N key comparisons; contact tests grow as N^(2 - 1/D) in a box",
    memory: "4N",
    limits: "many particles at the same x are N^2",
    constructor: Both::<SweepX, SweepX>::boxed,
    ..PLAIN
}];

fn main() -> anyhow::Result<()> {
    // Detects one scene directly, as a user of the library does.
    let AnyScene::Space(Stored::F64(scene)) = Spec::parse("packed:dim=3,n=5000")?.make()? else {
        unreachable!("dim=3 is made in space, in f64")
    };
    let (mut tally, mut found) = (Tally::default(), Digest::default());
    any::run(&mut SweepX::with(Options::default()), &scene, Test::Exact, &mut tally, &mut found)?;
    let truth = oracle::truth(&AnyScene::from(scene), Arithmetic::Exact)?;
    ensure!(
        found == truth.digest,
        "sweep-x finds {} contacts, there are {}",
        found.contacts,
        truth.digest.contacts
    );
    println!(
        "sweep-x: {} contacts, as the oracle finds; {} contact tests",
        found.contacts,
        tally.get(Op::ContactTest)
    );

    // Checks all generators, dimensions and arithmetics, as `contactbench check` does for every
    // entry of the table.
    let report =
        check::check(&[&TABLE[0]], &Arithmetic::SAFE, &Limits { seeds: 1, ..Limits::default() })?;
    ensure!(
        report.failures.is_empty() && report.refused.is_empty(),
        "sweep-x disagrees with the truth, or refuses"
    );
    println!("sweep-x: {} detections agree with all pairs tested", report.cases);
    Ok(())
}
