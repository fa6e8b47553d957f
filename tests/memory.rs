//! What detectors take from the heap, measured by the counting allocator, against the formulas they declare.

use contactbench::contact::{Arithmetic, Test};
use contactbench::detect::Options;
use contactbench::detect::table::{TABLE, find};
use contactbench::harness::alloc::{Counting, measure};
use contactbench::scene::AnyScene;
use contactbench::scene::spec::Spec;
use contactbench::sink::Count;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn scene(text: &str) -> AnyScene<'static> {
    Spec::parse(text).unwrap().make().unwrap()
}

const SCENES: [&str; 7] = [
    "packed:n=3000",
    "packed:dim=3,n=3000",
    "loose:n=3000",
    "loose:dim=3,n=3000,fraction=0.001",
    "clustered:dim=3,n=3000",
    "pack-c:n=2500,s=50",
    "packed:dim=3,n=1",
];

/// One test function: other tests of this process would be counted, too.
#[test]
fn formulas_hold_and_warm_calls_allocate_nothing() {
    // Libraries allocate as they please.
    for entry in TABLE.iter().filter(|entry| entry.is_ours()) {
        for text in SCENES {
            for arithmetic in Arithmetic::ALL {
                let scene = scene(text).stored(arithmetic).unwrap();
                let test = arithmetic.test();
                let mut detector = entry.make(Options::default());
                let (_, cold) = measure(|| detector.visit(&scene, test, &mut Count::default()).unwrap());
                let (cold, formula) = (cold.expect("the counting allocator is installed"), detector.formula_bytes());
                let what = format!("{} on {text} in {}", entry.name, arithmetic.name());
                if entry.name == "binary-tree" {
                    // The array of nodes grows by doubling.
                    assert!(cold.live_bytes >= formula && cold.peak_bytes <= 3 * formula + 64, "{what}: {cold:?}, formula {formula}");
                } else {
                    assert_eq!((cold.peak_bytes, cold.live_bytes), (formula, formula), "{what}");
                }
                let (_, warm) = measure(|| detector.visit(&scene, test, &mut Count::default()).unwrap());
                assert_eq!(warm.unwrap().allocations, 0, "{what}: warm");
            }
        }
    }
    book_formulas();
    refusals_allocate_nothing();
}

/// The book's numbers for example III at S/D = 200 on 100 x 100 elements (BOOK, section 4), which count no border cells.
fn book_formulas() {
    let scene = scene("pack-c:n=10000,s=200");
    let bytes = |name: &str| {
        let mut detector = find(name).unwrap().make(Options::default());
        measure(|| detector.visit(&scene, Test::Exact, &mut Count::default()).unwrap()).1.unwrap().peak_bytes
    };
    // The centres span 19,800 diameters; cells are wider than that by 2^-18; and there are 2 border cells.
    let cells = (19_800.0 * (1.0 - 1.0 / f64::from(1 << 18))) as u64 + 1 + 2;
    assert_eq!(bytes("nbs"), 4 * (3 * cells + 2 * 10_000));
    assert_eq!(bytes("sorting"), 4 * 3 * 10_000);
}

fn refusals_allocate_nothing() {
    let scene = scene("pack-c:n=10000,s=200");
    let mut detector = find("screening").unwrap().make(Options { memory_limit: 1 << 30, threads: 1 });
    let (refusal, usage) = measure(|| detector.visit(&scene, Test::Exact, &mut Count::default()).unwrap_err());
    let text = refusal.to_string();
    assert!(usage.unwrap().peak_bytes < 1000, "{usage:?}");
    assert!(text.contains("1073741824") && text.contains("--memory-limit") && text.contains("screening"), "{text}");
}
