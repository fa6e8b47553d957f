//! The check finds detectors that are wrong on purpose, each in its way, and a small scene on which they are.

use std::time::Duration;

use contactbench::check::{self, Failure, Wrong};
use contactbench::contact::{Arithmetic, Bodies, Real};
use contactbench::detect::any::Both;
use contactbench::detect::table::{Entry, Role};
use contactbench::detect::{Declare, Detector, Options, Refusal};
use contactbench::probe::Probe;
use contactbench::sink::Sink;

/// Direct checking that is wrong in way `WAY`.
struct Mutant<const WAY: u8> {
    calls: u32,
}

const DROPS_THE_LAST_ELEMENT: u8 = 0;
const REPEATS_THE_FIRST_PAIR: u8 = 1;
const PAIRS_ELEMENTS_WITH_THEMSELVES: u8 = 2;
const PANICS_AT_TEN_ELEMENTS: u8 = 3;
const IS_WRONG_ONLY_LATER: u8 = 4;

impl<const WAY: u8> Declare for Mutant<WAY> {
    fn with(_: Options) -> Self {
        Mutant { calls: 0 }
    }
    fn formula_bytes(&self) -> u64 {
        0
    }
}

impl<T: Real, const D: usize, const WAY: u8> Detector<T, D> for Mutant<WAY> {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(&mut self, bodies: B, probe: &mut P, sink: &mut S) -> Result<(), Refusal> {
        self.calls += 1;
        let mut n = bodies.len() as u32;
        assert!(WAY != PANICS_AT_TEN_ELEMENTS || n < 10, "on purpose");
        if WAY == DROPS_THE_LAST_ELEMENT || WAY == IS_WRONG_ONLY_LATER && self.calls > 30 {
            n = n.saturating_sub(1);
        }
        let mut first = true;
        for i in 0..n {
            for j in i + u32::from(WAY != PAIRS_ELEMENTS_WITH_THEMSELVES)..n {
                if bodies.touch(i, j, probe) {
                    sink.contact(i, j);
                    if std::mem::take(&mut first) && WAY == REPEATS_THE_FIRST_PAIR {
                        sink.contact(j, i);
                    }
                }
            }
        }
        Ok(())
    }
}

const fn entry<const WAY: u8>() -> Entry {
    Entry {
        name: "mutant",
        role: Role::Detector,
        summary: "",
        cost: "",
        memory: "",
        limits: "",
        threads: false,
        constructor: Both::<Mutant<WAY>, Mutant<WAY>>::boxed,
    }
}

static MUTANTS: [Entry; 5] = [
    entry::<DROPS_THE_LAST_ELEMENT>(),
    entry::<REPEATS_THE_FIRST_PAIR>(),
    entry::<PAIRS_ELEMENTS_WITH_THEMSELVES>(),
    entry::<PANICS_AT_TEN_ELEMENTS>(),
    entry::<IS_WRONG_ONLY_LATER>(),
];

fn failure(way: u8) -> Failure {
    let mut report = check::check(&[&MUTANTS[way as usize]], &Arithmetic::SAFE, 1, Duration::ZERO).unwrap();
    assert_eq!(report.failures.len(), 1, "mutant {way}");
    report.failures.remove(0)
}

#[test]
fn wrong_pairs_are_found_and_shrunk() {
    for (way, elements, missed, self_pairs, duplicate) in
        [(DROPS_THE_LAST_ELEMENT, 2, 1, 0, 0), (REPEATS_THE_FIRST_PAIR, 2, 0, 0, 1), (PAIRS_ELEMENTS_WITH_THEMSELVES, 1, 0, 1, 0)]
    {
        let failure = failure(way);
        let Some(Wrong::Pairs(errors)) = failure.wrong else { panic!("mutant {way}") };
        assert_eq!(failure.smallest.len(), elements, "mutant {way}");
        assert_eq!((errors.missed, errors.self_pairs, errors.duplicate), (missed, self_pairs, duplicate), "mutant {way}");
    }
}

#[test]
fn a_panic_is_a_failure_with_a_small_scene() {
    let failure = failure(PANICS_AT_TEN_ELEMENTS);
    assert!(matches!(failure.wrong, Some(Wrong::Panics)));
    assert_eq!(failure.smallest.len(), 10);
}

#[test]
fn what_only_history_shows_is_said_to_be_so() {
    assert!(failure(IS_WRONG_ONLY_LATER).wrong.is_none());
}
