//! `check` finds deliberately wrong detectors and shrinks the failing scenes.

use std::time::{Duration, Instant};

use contactbench::check::numbers::{Numbers, bits};
use contactbench::check::{self, Failure, Limits, Wrong, regression};
use contactbench::io;
use contactbench::scene::{Given, Lattice, Radii, Real, Scene};
use contactbench_detectors::table;
use contactbench_detectors::table::{Entry, PLAIN};
use contactbench_ground::contact::{Arithmetic, Particles};
use contactbench_ground::detect::any::Both;
use contactbench_ground::detect::{Declare, Detector, Options};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::Probe;

use crate::common::Place;

/// Brute force with the defect number `WAY`.
struct Mutant<const WAY: u8> {
    calls: u32,
}

const DROPS_THE_LAST_PARTICLE: u8 = 0;
const REPEATS_THE_FIRST_PAIR: u8 = 1;
const PAIRS_PARTICLES_WITH_THEMSELVES: u8 = 2;
const PANICS_AT_TEN_PARTICLES: u8 = 3;
const IS_WRONG_ONLY_LATER: u8 = 4;
const SKIPS_PAIRS_AT_REACH: u8 = 5;
const HANGS_AT_THREE_PARTICLES: u8 = 6;
const REPORTS_WITHOUT_END: u8 = 7;
const REFUSES_AFTER_REPORTING: u8 = 8;

impl<const WAY: u8> Declare for Mutant<WAY> {
    fn with(_: Options) -> Self {
        Mutant { calls: 0 }
    }
}

impl<T: Real, const D: usize, const WAY: u8> Detector<T, D> for Mutant<WAY> {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        self.calls += 1;
        let mut n = particles.len() as u32;
        assert!(WAY != PANICS_AT_TEN_PARTICLES || n < 10, "on purpose");
        if WAY == HANGS_AT_THREE_PARTICLES && n >= 3 {
            loop {
                std::thread::sleep(Duration::from_secs(1));
            }
        }
        if WAY == DROPS_THE_LAST_PARTICLE || WAY == IS_WRONG_ONLY_LATER && self.calls > 30 {
            n = n.saturating_sub(1);
        }
        let mut first = true;
        for i in 0..n {
            for j in i + u32::from(WAY != PAIRS_PARTICLES_WITH_THEMSELVES)..n {
                // A sweep that compares with `>=` instead of `>` has this defect.
                let far = (particles.position(i)[0] - particles.position(j)[0]).abs()
                    >= particles.reach();
                if particles.touch(i, j, probe) && !(WAY == SKIPS_PAIRS_AT_REACH && far) {
                    sink.contact(i, j);
                    if std::mem::take(&mut first) && WAY == REPEATS_THE_FIRST_PAIR {
                        sink.contact(j, i);
                    }
                    if WAY == REPORTS_WITHOUT_END {
                        loop {
                            sink.contact(j, i);
                        }
                    }
                }
            }
        }
        if WAY == REFUSES_AFTER_REPORTING && n >= 17 {
            return Err(Refusal::Particles { detector: "mutant", n: n.into(), limit: 16 });
        }
        Ok(())
    }
}

const fn entry<const WAY: u8>() -> Entry {
    Entry { name: "mutant", constructor: Both::<Mutant<WAY>, Mutant<WAY>>::boxed, ..PLAIN }
}

#[rustfmt::skip]
static MUTANTS: [Entry; 9] = [
    entry::<0>(), entry::<1>(), entry::<2>(), entry::<3>(), entry::<4>(), entry::<5>(),
    entry::<6>(), entry::<7>(), entry::<8>(),
];

/// Deadline for detectors that hang on purpose.
const SHORT: Duration = Duration::from_millis(500);

fn found(entry: &'static Entry, arithmetics: &[Arithmetic], deadline: Duration) -> Failure {
    let limits = Limits { seeds: 1, deadline, ..Limits::default() };
    let mut report = check::battery(&[entry.into()], arithmetics, &limits).unwrap();
    assert_eq!(report.failures.len(), 1, "{}", entry.name);
    report.failures.remove(0)
}

fn failure(way: u8) -> Failure {
    let hangs = [HANGS_AT_THREE_PARTICLES, REPORTS_WITHOUT_END].contains(&way);
    // Detectors that do not hang get 20 s, because a backtrace on a busy machine takes time.
    found(
        &MUTANTS[way as usize],
        &Arithmetic::SAFE,
        if hangs { SHORT } else { Duration::from_secs(20) },
    )
}

/// Returns the number of significant bits of all coordinates and radii.
fn total_bits(failure: &Failure) -> u32 {
    Numbers::new(&failure.smallest.scene).values.iter().map(|&x| bits(x)).sum()
}

/// Returns the numbers of missed, spurious, repeated and self pairs.
fn differences(failure: &Failure) -> [usize; 4] {
    let Some(Wrong::Pairs(differences)) = &failure.wrong else { panic!("{:?}", failure.wrong) };
    [&differences.missed, &differences.spurious, &differences.duplicate, &differences.selves]
        .map(Vec::len)
}

#[test]
fn wrong_pairs_are_found_and_shrunk_to_the_simplest_numbers() {
    for (way, scene, wrong) in [
        (DROPS_THE_LAST_PARTICLE, "0.0,0.0,1.0\n0.0,0.0,1.0\n", [1, 0, 0, 0]),
        (REPEATS_THE_FIRST_PAIR, "0.0,0.0,1.0\n0.0,0.0,1.0\n", [0, 0, 1, 0]),
        (PAIRS_PARTICLES_WITH_THEMSELVES, "0.0,0.0,0.0\n", [0, 0, 0, 1]),
    ] {
        let failure = failure(way);
        let csv = check::as_csv(&failure.smallest.scene);
        assert_eq!((csv, differences(&failure)), (format!("x,y,r\n{scene}"), wrong), "{way}");
    }
    let failure = failure(IS_WRONG_ONLY_LATER);
    assert!(failure.wrong.is_none() && matches!(failure.found, Wrong::Pairs(_)), "by history");
}

/// Two tangent discs far from the origin shrink only if both are moved together. The file names
/// what is wrong, reads back to the same bits, and finds the failure again.
#[test]
fn a_tangent_pair_stays_tangent_and_its_file_finds_the_failure_again() {
    let mutant = &MUTANTS[SKIPS_PAIRS_AT_REACH as usize];
    let failure = found(mutant, &[Arithmetic::Exact], Duration::from_secs(20));
    let csv = check::as_csv(&failure.smallest.scene);
    let either = ["2.0,0.0,1.0\n0.0,0.0,1.0\n", "0.0,0.0,1.0\n2.0,0.0,1.0\n"];
    assert!(either.map(|rows| format!("x,y,r\n{rows}")).contains(&csv), "{csv}");
    assert_eq!(differences(&failure), [1, 0, 0, 0]);
    let at = Place::new();
    let path = at.path("found.csv");
    let text = regression::file(&failure, &path, "--detector mutant --arithmetic exact");
    for words in [
        ": 1 missed, 0 spurious, 0 duplicate",
        "packed dim=2 ",
        "check --scene found.csv --detector mutant --arithmetic exact\nx,y,r\n",
    ] {
        assert!(text.contains(words), "{text}");
    }
    at.file("found.csv", text);
    let scene = io::scene(&path, io::Options::default()).unwrap();
    assert_eq!(scene, failure.smallest.scene);
    let again = again(&scene.into(), mutant, Arithmetic::Exact);
    assert_eq!(again.found, failure.wrong.unwrap());
}

fn again(given: &Given, entry: &'static Entry, arithmetic: Arithmetic) -> Failure {
    let limits = Limits::default();
    let report = check::check_scene(given, "again", &[entry.into()], &[arithmetic], &limits);
    report.unwrap().failures.remove(0)
}

/// The book's cells lose a pair because of a coordinate's last bits, which shrinking keeps.
#[test]
fn a_pair_lost_to_rounding_keeps_its_last_bits_only() {
    let mut values = vec![-4.0, 0.7, 2.0, -2.0 * f64::EPSILON, 0.7, 2.0, 4.0, 0.7, 2.0];
    // Particles that play no part in the failure.
    (0..40).for_each(|k| {
        values.extend([2.9 * f64::from(k % 7) - 3.7, 9.1 + 3.3 * f64::from(k / 7), 1.37])
    });
    let scene = Numbers { dim: 2, values }.scene().unwrap();
    for name in ["nbs", "sorting", "screening"] {
        let entry = table::find(name).unwrap();
        let failure = again(&scene.clone().into(), entry, Arithmetic::Textbook);
        let scene = check::as_csv(&failure.smallest.scene);
        assert_eq!(
            (failure.smallest.scene.len(), differences(&failure)),
            (3, [1, 0, 0, 0]),
            "{name}: {scene}"
        );
        assert!(total_bits(&failure) <= 64, "{name}: {} bits in {scene}", total_bits(&failure));
    }
}

#[test]
fn a_panic_is_a_failure_with_a_small_scene() {
    let failure = failure(PANICS_AT_TEN_PARTICLES);
    assert_eq!(failure.wrong, Some(Wrong::Panics("on purpose".into())));
    assert_eq!(
        (failure.smallest.scene.len(), total_bits(&failure)),
        (10, 10),
        "{}",
        check::as_csv(&failure.smallest.scene)
    );
}

#[test]
fn what_hangs_is_a_failure_and_ends_no_check() {
    for way in [HANGS_AT_THREE_PARTICLES, REPORTS_WITHOUT_END] {
        let started = Instant::now();
        let failure = failure(way);
        assert_eq!(failure.wrong, Some(Wrong::Hangs(SHORT)), "mutant {way}");
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "mutant {way}: {:?}",
            started.elapsed()
        );
    }
}

#[test]
fn a_refusal_after_pairs_is_a_failure() {
    let failure = failure(REFUSES_AFTER_REPORTING);
    assert_eq!(
        (failure.wrong.clone(), failure.smallest.scene.len()),
        (Some(Wrong::RefusesLate(136)), 17)
    );
    // A sphere in a periodic box touches 32 of its images.
    let sphere = Scene::<f64, 3>::new(vec![[0.5; 3].into()], Radii::Uniform(1.0)).unwrap();
    let cube = Lattice::along_axes([1.0; 3], [true; 3]).unwrap();
    let given = Given::in_box(sphere.into(), cube).unwrap();
    let mutant = &MUTANTS[REFUSES_AFTER_REPORTING as usize];
    assert_eq!(again(&given, mutant, Arithmetic::Exact).found, Wrong::RefusesLate(16));
}
