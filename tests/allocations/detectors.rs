//! Tests the heap memory of detectors, as the allocator counts it, against their formulas.

use contactbench::run::runner::alloc::{Usage, measure};
use contactbench::scene::spec::Spec;
use contactbench::scene::{AnyScene, Lattice, Real};
use contactbench_detectors::table::{Entry, TABLE, find};
use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::detect::Options;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Count;
use contactbench_ground::periodic::{ContactList, Periodic};
use contactbench_ground::with_scene;
use contactbench_lists::periodic::Finder;

fn scene(text: &str) -> AnyScene<'static> {
    Spec::parse(text).unwrap().make().unwrap()
}

const SCENES: [&str; 9] = [
    "packed:n=1500",
    "packed:dim=3,n=1500",
    "loose:n=1500",
    "loose:dim=3,n=1500,fraction=0.001",
    "clustered:dim=3,n=1500",
    "pack-c:n=2500,s=50",
    "packed:dim=3,n=1",
    "loose:n=1500,fraction=0.5,sizes=power,exponent=-3,size-ratio=20",
    "clustered:dim=3,n=1500,sizes=giants,giants=3,size-ratio=30",
];

/// Scenes that are large enough for a second thread, and too large to test all pairs.
const LARGE: [&str; 2] = ["packed:n=30000", "packed:dim=3,n=30000"];

#[test]
fn formulas_hold_and_warm_calls_allocate_nothing() {
    let _quiet = crate::quiet();
    for text in SCENES {
        for (scene, arithmetic) in stored(text, &Arithmetic::ALL) {
            TABLE.iter().for_each(|entry| thrice(|| one_thread(entry, &scene, text, arithmetic)));
        }
    }
    for entry in TABLE.iter().filter(|entry| entry.threads) {
        let scenes = if entry.name == "direct" { [SCENES[0], SCENES[1]] } else { LARGE };
        scenes.iter().for_each(|text| thrice(|| two_threads(entry, text)));
    }
    for text in BOXES {
        let scene = scene(text);
        for entry in TABLE.iter().filter(|entry| entry.must_be_right()) {
            for arithmetic in Arithmetic::SAFE {
                for outside in [false, true] {
                    thrice(|| in_a_box(entry, (&scene, text), arithmetic, outside));
                }
            }
        }
    }
    book_formulas();
    refusals_allocate_nothing();
}

const BOXES: [&str; 4] = [
    "packed:n=1500",
    "packed:dim=3,n=1500",
    "loose:dim=3,n=1500",
    "loose:n=1500,fraction=0.5,sizes=power,exponent=-3,size-ratio=20",
];

fn stored(text: &str, all: &[Arithmetic]) -> Vec<(AnyScene<'static>, Arithmetic)> {
    let scene = scene(text);
    all.iter().map(|&arithmetic| (scene.stored(arithmetic).unwrap(), arithmetic)).collect()
}

/// Measures a scene in a box that is smaller than its extent, so that particles are wrapped.
fn in_a_box(
    entry: &Entry,
    (scene, text): (&AnyScene<'static>, &str),
    arithmetic: Arithmetic,
    outside: bool,
) {
    let corners = with_scene!(scene, scene => {
        scene.centres().iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], centre| {
            let x = centre[0].wide();
            [low.min(x), high.max(x)]
        })
    });
    let edge = (corners[1] - corners[0]) * if outside { 0.75 } else { 1.0 };
    let lattice = Lattice::along_axes([edge; 3], [true, true, false]).unwrap();
    let periodic = Periodic::new(scene.clone(), lattice).unwrap();
    let mut contacts = ContactList::default();
    let (mut finder, mut detector) =
        (Finder::new(1 << 30), find("nbs").unwrap().make(Options::default()));
    finder.list(&periodic, &mut *detector, arithmetic, &mut contacts).unwrap();
    let (mut finder, mut detector) = (Finder::new(1 << 30), entry.make(Options::default()));
    let mut measured = || {
        contacts.clear();
        let list = || finder.list(&periodic, &mut *detector, arithmetic, &mut contacts).unwrap();
        measure(list).1.expect("the counting allocator is installed")
    };
    let cold = measured();
    let warm = measured();
    let (images, formula) = (finder.formula_bytes(), detector.formula_bytes());
    let what = format!("{} on {text} in {arithmetic} in a box of {edge}", entry.name);
    assert!(finder.images() > 0 && !contacts.shifted.is_empty(), "{what}");
    if entry.name == "binary-tree" {
        assert!(cold.live_bytes >= images + formula, "{what}: {cold:?}, {images} + {formula}");
    } else {
        assert_eq!(cold.live_bytes, images + formula, "{what}: {images} + {formula}");
    }
    assert_eq!(warm.allocations, 0, "{what}: warm");
}

fn one_thread(entry: &Entry, scene: &AnyScene<'_>, text: &str, arithmetic: Arithmetic) {
    let mut detector = entry.make(Options::default());
    let (cold, warm, _) = cold_and_warm(&mut *detector, scene, arithmetic.test());
    let formula = detector.formula_bytes();
    let what = format!("{} on {text} in {}", entry.name, arithmetic.name());
    if entry.name == "binary-tree" {
        // The array of nodes grows by doubling, so it may exceed the formula.
        assert!(
            cold.live_bytes >= formula && cold.peak_bytes <= 3 * formula + 64,
            "{what}: {cold:?}, formula {formula}"
        );
    } else {
        assert_eq!((cold.peak_bytes, cold.live_bytes), (formula, formula), "{what}");
    }
    assert_eq!(warm.allocations, 0, "{what}: warm");
}

/// The formula for several threads includes the contacts that they collect, but not the small lists
/// of their work.
fn two_threads(entry: &Entry, text: &str) {
    const SHARES: u64 = 16 << 10;
    /// Maximum number of bytes that rayon's queue of jobs may free during a measurement.
    const QUEUE: u64 = 2 << 10;
    // Starts rayon's pool now, because its memory does not belong to the detector.
    rayon::join(|| (), || ());
    let scene = scene(text);
    let mut detector = entry.make(Options { threads: 2, ..Options::default() });
    let (cold, warm, contacts) = cold_and_warm(&mut *detector, &scene, Test::Exact);
    let formula = detector.formula_bytes();
    let what = format!("{} on {text} with two threads", entry.name);
    assert!(contacts > 0, "{what}");
    assert!(
        formula >= 8 * contacts
            && (formula.saturating_sub(QUEUE)..=formula + SHARES).contains(&cold.peak_bytes),
        "{what}: {cold:?}, formula {formula}, {contacts} contacts"
    );
    // A second call needs no more memory than the first.
    assert!(warm.peak_bytes <= formula + SHARES, "{what}, warm: {warm:?}, formula {formula}");
    // The memory limit covers the contacts, too.
    let limited = |memory_limit| {
        let mut detector = entry.make(Options { threads: 2, memory_limit });
        detector.list(&scene, Test::Exact, &mut Vec::new())
    };
    assert_eq!(limited(formula), Ok(()), "{what}");
    let refusal = limited(formula - 16 * contacts / 3).unwrap_err();
    assert!(matches!(refusal, Refusal::Pairs { .. }), "{what}: {refusal}");
}

/// Measures a first and a second detection; also returns the number of contacts.
fn cold_and_warm(
    detector: &mut dyn AnyDetector,
    scene: &AnyScene<'_>,
    test: Test,
) -> (Usage, Usage, u64) {
    let mut contacts = Count::default();
    find("nbs").unwrap().make(Options::default()).visit(scene, test, &mut contacts).unwrap();
    let mut pairs = Vec::with_capacity(contacts.0 as usize);
    let mut measured = || {
        pairs.clear();
        measure(|| detector.list(scene, test, &mut pairs).unwrap())
            .1
            .expect("the counting allocator is installed")
    };
    let cold = measured();
    (cold, measured(), contacts.0)
}

/// Measures up to three times, because the test harness may allocate meanwhile.
fn thrice(measured: impl Fn()) {
    let once = || std::panic::catch_unwind(std::panic::AssertUnwindSafe(&measured)).is_ok();
    if !once() && !once() {
        measured();
    }
}

/// The book's numbers for example III, 100 x 100 particles with S/D = 200 (BOOK, section 4). They
/// do not count border cells.
fn book_formulas() {
    let scene = scene("pack-c:n=10000,s=200");
    let bytes = |name: &str| {
        let mut detector = find(name).unwrap().make(Options::default());
        measure(|| detector.visit(&scene, Test::Exact, &mut Count::default()).unwrap())
            .1
            .unwrap()
            .peak_bytes
    };
    // Centres span 19,800 diameters. Cells are wider than a diameter by 2^-18; 2 are border cells.
    let cells = (19_800.0 * (1.0 - 1.0 / f64::from(1 << 18))) as u64 + 1 + 2;
    assert_eq!(bytes("nbs"), 4 * (3 * cells + 2 * 10_000));
    assert_eq!(bytes("sorting"), 4 * 3 * 10_000);
}

fn refusals_allocate_nothing() {
    let scene = scene("pack-c:n=10000,s=200");
    let mut detector =
        find("screening").unwrap().make(Options { memory_limit: 1 << 30, threads: 1 });
    let (refusal, usage) =
        measure(|| detector.visit(&scene, Test::Exact, &mut Count::default()).unwrap_err());
    let text = refusal.to_string();
    assert!(usage.unwrap().peak_bytes < 1000, "{usage:?}");
    assert!(
        text.contains("1073741824")
            && text.contains("the memory limit")
            && text.contains("screening"),
        "{text}"
    );
}
