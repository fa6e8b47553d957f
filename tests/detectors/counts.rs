//! Tests the book's claims with exact operation counts.

use contactbench::contact::Test;
use contactbench::detect::Options;
use contactbench::detect::table::{self, TABLE};
use contactbench::probe::{Op, Tally};
use contactbench::scene::AnyScene;
use contactbench::scene::spec::Spec;
use contactbench::sink::{Count, Digest};

fn scene(text: &str) -> AnyScene<'static> {
    Spec::parse(text).and_then(|spec| spec.make()).unwrap()
}

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
        let tests = count("direct", &scene(&format!("loose:n={n}"))).get(Op::ContactTest);
        assert_eq!(tests, n * n.saturating_sub(1) / 2);
    }
}

#[test]
fn nbs_pushes_at_most_three_times_in_2d_and_eight_times_in_3d() {
    for text in SCENES {
        let scene = scene(text);
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
        let tally = count("nbs", &scene(&format!("pack-c:n=10000,s={s}")));
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
        let scene = scene(text);
        let tally = count("screening", &scene);
        assert_eq!(tally.get(Op::ListReset), 2 * scene.len() as u64, "{text}");
        assert_eq!(tally.get(Op::ListPush), scene.len() as u64, "{text}");
    }
}

#[test]
fn sorting_compares_n_log_n_keys() {
    let per = |n: usize, dim: usize| {
        let tally = count("sorting", &scene(&format!("packed:dim={dim},n={n}")));
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
        let scene = scene(text);
        let visits = count("binary-tree", &scene).get(Op::NodeVisit);
        let (n, two) = (scene.len() as u64, scene.dim() == 2);
        let (levels, mask) = if two { (2 * 11, 4) } else { (3 * 9, 13) };
        assert!(visits <= n * levels * (mask + 3), "{text}: {visits}");
        assert!(visits >= n * 4, "{text}: {visits}");
    }
}

/// `cell-grid` makes the same contact tests as `screening`.
#[test]
fn the_cell_grid_tests_what_screening_tests() {
    for text in SCENES {
        let scene = scene(text);
        let (grid, screening) = (count("cell-grid", &scene), count("screening", &scene));
        assert_eq!(grid.get(Op::ContactTest), screening.get(Op::ContactTest), "{text}");
        assert_eq!(grid.get(Op::Move), scene.len() as u64, "{text}");
    }
}

/// Each particle looks into at most two bricks of cells in each of five rows (two rows in 2D).
#[test]
fn the_hash_grid_does_not_mind_how_loose_the_pack_is() {
    let counts = |text: &str| {
        let (hash, cells) = (count("hash-grid", &scene(text)), count("screening", &scene(text)));
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
            let tally = count("sweep", &scene(&format!("loose:dim={dim},n={n}")));
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
                count(detector, &scene(&format!("loose:dim={dim},n={n}"))).get(op) as f64 / n as f64
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
            let scene = scene(text);
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

fn counted(detector: &str, scene: &AnyScene<'_>) -> String {
    // Key comparisons are left out where the standard library sorts: another version may differ.
    let own = |op| {
        op != Op::KeyCompare
            || !["sweep", "kd-tree", "bvh", "hgrid"].iter().any(|name| detector.starts_with(name))
    };
    count(detector, scene)
        .iter()
        .filter(|&(op, count)| count > 0 && own(op))
        .map(|(op, count)| format!("{}={count}", op.name()))
        .collect::<Vec<_>>()
        .join(" ")
}

/// Counts do not depend on the machine, and change only if an algorithm changes.
#[test]
fn counts_are_the_same_on_every_machine() {
    let scene = scene("clustered:dim=3,n=2000");
    for (detector, expected) in GOLDEN {
        assert_eq!(counted(detector, &scene), expected, "{detector}");
    }
}

const GOLDEN: [(&str, &str); 10] = [
    (
        "nbs",
        "integerise=34296 list_push=14148 list_step=36534 list_reset=14148 cell_probe=17520 \
     contact_test=6238",
    ),
    (
        "screening",
        "integerise=18000 list_push=2000 list_step=8238 list_reset=4000 cell_probe=24776 \
     contact_test=6238",
    ),
    ("sorting", "integerise=6000 key_compare=314266 move=10186 contact_test=6238"),
    (
        "binary-tree",
        "integerise=11256 list_push=2000 list_step=8238 node_visit=407218 contact_test=6238",
    ),
    ("cell-grid", "integerise=12000 cell_probe=144861 move=2000 contact_test=6238"),
    (
        "hash-grid",
        "integerise=21306 cell_probe=10372 key_compare=1102 move=2000 contact_test=28168",
    ),
    ("sweep", "bound_test=102300 contact_test=10394"),
    ("kd-tree", "node_visit=1068 bound_test=14753 contact_test=21404"),
    ("bvh", "integerise=6000 node_visit=1884 move=2000 bound_test=27905 contact_test=36015"),
    ("streamed-nbs", "integerise=6000 list_push=2000 cell_probe=4000 move=2000 contact_test=22458"),
];

/// Counts of detectors with size classes do not depend on the machine, either.
#[test]
fn counts_of_levels_are_the_same_on_every_machine() {
    let found = ["dim=2", "dim=3"].map(|dim| {
        let scene = scene(&format!(
            "loose:{dim},n=3000,fraction=0.5,sizes=power,exponent=-3,size-ratio=20"
        ));
        [
            "hgrid",
            "hgrid:levels=optimal",
            "hgrid:levels=0.05/0.2",
            "streamed-nbs",
            "nbs:levels=auto",
        ]
        .map(|detector| counted(detector, &scene))
    });
    assert_eq!(found, LEVELS);
}

const LEVELS: [[&str; 5]; 2] = [
    [
        "integerise=28300 cell_probe=895 level_probe=5334 move=3000 contact_test=22260",
        "integerise=19364 cell_probe=802 level_probe=1322 move=3000 contact_test=17718",
        "integerise=21240 cell_probe=809 level_probe=2452 move=3000 contact_test=20062",
        "integerise=6000 list_push=3000 cell_probe=6000 level_probe=402 move=3000 \
         contact_test=35230",
        "integerise=105130 list_push=47648 list_step=92886 list_reset=47648 cell_probe=21166 \
         level_probe=5808 move=3000 bound_test=18946 contact_test=16828",
    ],
    [
        "integerise=39438 cell_probe=3486 level_probe=11400 move=3000 contact_test=52934",
        "integerise=26280 cell_probe=2421 level_probe=4018 move=3000 contact_test=48211",
        "integerise=28818 cell_probe=2409 level_probe=5696 move=3000 contact_test=60402",
        "integerise=9000 list_push=3000 cell_probe=15000 level_probe=1228 move=3000 \
         contact_test=107716",
        "integerise=261969 list_push=123609 list_step=291751 list_reset=123609 cell_probe=32509 \
         level_probe=8100 move=3000 bound_test=18946 contact_test=58911",
    ],
];
