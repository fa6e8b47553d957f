//! Tests the book's claims with exact operation counts.

use contactbench::contact::{Arithmetic, Test};
use contactbench::detect::Options;
use contactbench::detect::table::{self, TABLE};
use contactbench::periodic::Contacts;
use contactbench::probe::{Op, Tally};
use contactbench::scene::AnyScene;
use contactbench::scene::spec::Spec;
use contactbench::searcher::{Loaded, Searcher};
use contactbench::sink::{Count, Digest};

use crate::make;

fn count(detector: &str, scene: &AnyScene<'_>) -> Tally {
    let (mut tally, mut contacts) = (Tally::default(), Count::default());
    let mut detector = table::parse(detector).unwrap().make(Options::default());
    detector.count(scene, Test::Exact, &mut tally, &mut contacts).unwrap();
    tally
}

const SCENES: [&str; 6] = [
    "packed:dim=2,n=5000",
    "packed:dim=3,n=5000",
    "loose:dim=2,n=5000",
    "loose:dim=3,n=5000",
    "clustered:dim=2,n=5000",
    "clustered:dim=3,n=5000,size-ratio=4",
];

#[test]
fn direct_tests_every_pair_once() {
    for n in [0u64, 1, 2, 3, 100, 777] {
        let tests = count("direct", &make(&format!("loose:n={n}"))).get(Op::ContactTest);
        assert_eq!(tests, n * n.saturating_sub(1) / 2);
    }
}

#[test]
fn nbs_pushes_at_most_three_times_in_2d_and_eight_times_in_3d() {
    for text in SCENES {
        let scene = make(text);
        let n = scene.len() as u64;
        let most = if scene.dim() == 2 { 3 } else { 8 };
        let pushes = count("nbs", &scene).get(Op::ListPush);
        assert!(pushes <= most * n && pushes > n, "{text}: {pushes} pushes");
    }
}

/// Pack C with N = 10,000: the cells grow from 40,000 to 4·10^8, but not the list operations.
#[test]
fn nbs_does_not_mind_how_loose_the_pack_is() {
    let operations = |s: f64| {
        let tally = count("nbs", &make(&format!("pack-c:n=10000,s={s}")));
        (tally.get(Op::ListPush) + tally.get(Op::ListStep) + tally.get(Op::ListReset)) as f64 / 1e4
    };
    let all = [2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0].map(operations);
    let (least, most) =
        (all.into_iter().fold(f64::MAX, f64::min), all.into_iter().fold(0.0, f64::max));
    assert!(most / least < 1.01, "{all:?}");
}

#[test]
fn screening_resets_particles_not_cells() {
    for text in SCENES.into_iter().chain(["pack-c:n=400,s=50"]) {
        let scene = make(text);
        let tally = count("screening", &scene);
        assert_eq!(tally.get(Op::ListReset), 2 * scene.len() as u64, "{text}");
        assert_eq!(tally.get(Op::ListPush), scene.len() as u64, "{text}");
    }
}

#[test]
fn sorting_compares_n_log_n_keys() {
    let per = |n: usize, dim: usize| {
        let tally = count("sorting", &make(&format!("packed:dim={dim},n={n}")));
        tally.get(Op::KeyCompare) as f64 / (n as f64 * (n as f64).log2())
    };
    for dim in [2, 3] {
        let all: Vec<f64> = [1000, 4000, 16_000, 64_000].map(|n| per(n, dim)).to_vec();
        assert!(all.iter().all(|&c| c > 1.0 && c < 20.0), "{dim}D: {all:?}");
        assert!(all[3] / all[1] < 1.1 && all[3] / all[1] > 0.9, "{dim}D: {all:?}");
    }
}

#[test]
fn the_binary_tree_descends_one_way_per_particle_and_mask_cell() {
    for text in SCENES {
        let scene = make(text);
        let visits = count("binary-tree", &scene).get(Op::NodeVisit);
        let (n, two) = (scene.len() as u64, scene.dim() == 2);
        let (levels, mask) = if two { (2 * 11, 4) } else { (3 * 9, 13) };
        assert!(visits <= n * levels * (mask + 3), "{text}: {visits}");
        assert!(visits >= n * 4, "{text}: {visits}");
    }
}

#[test]
fn the_cell_grid_tests_what_screening_tests() {
    for text in SCENES {
        let scene = make(text);
        let (grid, screening) = (count("cell-grid", &scene), count("screening", &scene));
        assert_eq!(grid.get(Op::ContactTest), screening.get(Op::ContactTest), "{text}");
        assert_eq!(grid.get(Op::Move), scene.len() as u64, "{text}");
    }
}

/// Each particle looks into at most two bricks of cells in each of five rows (two rows in 2D).
#[test]
fn the_hash_grid_does_not_mind_how_loose_the_pack_is() {
    let counts = |text: &str| {
        let (hash, cells) = (count("hash-grid", &make(text)), count("screening", &make(text)));
        let of = |tally: &Tally, op| tally.get(op) as f64 / 1e4;
        let in_vain = of(&hash, Op::ContactTest) - of(&cells, Op::ContactTest);
        [of(&hash, Op::CellProbe), in_vain, of(&hash, Op::KeyCompare)]
    };
    let packs = [2, 5, 20, 50].map(|s| (format!("pack-c:n=10000,s={s}"), [4.0, 4.0, 0.1]));
    let loose = [0.3, 0.1, 0.01]
        .map(|fraction| (format!("loose:dim=3,n=10000,fraction={fraction}"), [10.0, 12.0, 3.0]));
    for (text, most) in packs.into_iter().chain(loose) {
        let found = counts(&text);
        assert!(found.iter().zip(most).all(|(found, most)| *found <= most), "{text}: {found:?}");
    }
}

/// In a cube, the number of pairs that overlap along one axis grows as N^(2 - 1/D).
#[test]
fn sweeps_compare_more_per_particle_the_more_there_are() {
    for dim in [2, 3] {
        let per = |n: u64| {
            let tally = count("sweep", &make(&format!("loose:dim={dim},n={n}")));
            tally.get(Op::BoundTest) as f64 / n as f64
        };
        let (growth, expected) = (per(16_000) / per(2000), 8f64.powf(1.0 - 1.0 / f64::from(dim)));
        assert!((growth / expected - 1.0).abs() < 0.2, "{dim}D: {growth} for {expected}");
    }
}

#[test]
fn trees_sort_in_n_log_n_and_search_in_n() {
    for detector in ["kd-tree", "bvh"] {
        for dim in [2, 3] {
            // For these N all leaves are equally full; the share of inner leaves grows with N.
            let per = |n: u64, op| {
                count(detector, &make(&format!("loose:dim={dim},n={n}"))).get(op) as f64 / n as f64
            };
            let visits = per(32_000, Op::NodeVisit) / per(4000, Op::NodeVisit);
            let tests = per(32_000, Op::ContactTest) / per(4000, Op::ContactTest);
            assert!(
                (0.8..1.8).contains(&visits) && (0.8..1.4).contains(&tests),
                "{detector} {dim}D: {visits} {tests}"
            );
            let keys = per(32_000, Op::KeyCompare) / 32_000f64.log2();
            assert!((0.8..4.0).contains(&keys), "{detector} {dim}D: {keys}");
        }
    }
}

/// Counting does not change the contacts, and repeated counts are equal.
#[test]
fn counting_changes_nothing_and_repeats_exactly() {
    for entry in TABLE {
        for text in SCENES {
            let scene = make(text);
            let mut detector = entry.make(Options::default());
            let seen = [(); 2].map(|()| {
                let (mut tally, mut counted) = (Tally::default(), Digest::default());
                detector.count(&scene, Test::Exact, &mut tally, &mut counted).unwrap();
                let mut pairs = Vec::new();
                detector.list(&scene, Test::Exact, &mut pairs).unwrap();
                assert_eq!(counted, Digest::from_pairs(&pairs), "{} {text}", entry.name);
                tally
            });
            assert_eq!(seen[0], seen[1], "{} {text}", entry.name);
        }
    }
}

fn counted(detector: &str, text: &str) -> String {
    let given = Spec::parse(text).and_then(|spec| spec.given()).unwrap();
    let exact = Arithmetic::Exact;
    let loaded = Loaded::new(&given.scene, given.lattice, exact).unwrap();
    let mut searcher = Searcher::new(&table::parse(detector).unwrap(), Options::default());
    let tally = searcher.count(&loaded, exact, &mut Contacts::default()).unwrap();
    // Key comparisons are left out where the standard library sorts: another version may differ.
    let own = |op| {
        op != Op::KeyCompare
            || !["sweep", "kd-tree", "bvh", "hgrid"].iter().any(|name| detector.starts_with(name))
    };
    tally
        .iter()
        .filter(|&(op, count)| count > 0 && own(op))
        .map(|(op, count)| format!("{}={count}", op.name()))
        .collect::<Vec<_>>()
        .join(" ")
}

/// Counts do not depend on the machine, and change only if an algorithm changes.
#[test]
fn counts_are_the_same_on_every_machine() {
    let blocks = include_str!("counts.txt").split_terminator("\n\n").skip(1);
    let mut changed = Vec::new();
    for (text, detectors) in blocks.map(|block| block.split_once('\n').unwrap()) {
        for (detector, expected) in detectors.lines().map(|line| line.split_once(' ').unwrap()) {
            let found = counted(detector, text);
            if found != expected {
                changed.push(format!("{text}\n- {detector} {expected}\n+ {detector} {found}"));
            }
        }
    }
    assert!(changed.is_empty(), "counts.txt differs:\n{}", changed.join("\n"));
}
