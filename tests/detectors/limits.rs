//! Every detector stops a list of pairs at the memory limit, with one thread and with several.

use contactbench::scene::AnyScene;
use contactbench_detectors::oracle;
use contactbench_detectors::oracle::NoTruth;
use contactbench_detectors::table::TABLE;
use contactbench_ground::contact::Test;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::refusal::Refusal;

/// Returns `n` separate discs on a lattice, except that the first `heap` discs coincide.
fn clump(n: u32, heap: u32) -> AnyScene<'static> {
    let place = |k: u32| if k < heap { [0.0; 2] } else { [k % 150, k / 150].map(f64::from) };
    AnyScene::at((0..n).map(place), 0.25).unwrap()
}

const LIMIT: u64 = 8 << 20;
const PAIRS: u64 = 3000 * 2999 / 2;

#[test]
fn nobody_lists_more_than_the_limit_allows() {
    for entry in TABLE.iter().filter(|entry| entry.must_be_right()) {
        for threads in if entry.threads { 1..3 } else { 1..2 } {
            // Enough particles for a second thread, except in `direct`, which would take long.
            let n = if entry.threads && entry.name != "direct" { 31_000 } else { 5_000 };
            let (scene, mut pairs) = (clump(n, 3000), vec![[7, 9]]);
            let mut detector = entry.make(Options { memory_limit: LIMIT, threads });
            for _ in 0..2 {
                let refusal = detector.list(&scene, Test::Exact, &mut pairs).unwrap_err();
                let what = format!("{} with {threads} threads: {refusal}", entry.name);
                let Refusal::Pairs { found, particles, room } = refusal else { panic!("{what}") };
                assert_eq!((particles, found), (n.into(), PAIRS), "{what}");
                assert_eq!(pairs, [[7, 9]], "{what}");
                assert!(room <= LIMIT && pairs.capacity() as u64 * 8 <= LIMIT, "{what}");
            }
            // The detector still works after the refusal.
            pairs.clear();
            detector.list(&clump(n, 2), Test::Exact, &mut pairs).unwrap();
            assert_eq!(pairs.len(), 1, "{}", entry.name);
        }
    }
}

#[test]
fn the_truth_has_the_same_limit() {
    for n in [21_000, 3000] {
        let truth = oracle::truth_as_stored(&clump(n, 3000), Test::Exact, LIMIT);
        let Err(NoTruth::Refused(refusal)) = truth.map(|truth| truth.pairs.len()) else {
            panic!("the truth has more than it may")
        };
        assert!(refusal.is_of_scene(), "{refusal}");
        let truth = oracle::truth_as_stored(&clump(n, 3000), Test::Exact, 64 << 20).unwrap();
        assert_eq!(truth.digest.contacts, PAIRS);
    }
}
