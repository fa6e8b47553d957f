//! Every form of `streamed-nbs` is right on every instruction set and with several threads.

use std::sync::atomic::{AtomicU64, Ordering};

use contactbench::scene::{AnyScene, Scene, Stored};
use contactbench_detectors::table;
use contactbench_ground::contact::{Arithmetic, Particles, Slack, Test, any_particles};
use contactbench_ground::detect::any::{AnyDetector, Searched, Task};
use contactbench_ground::detect::{Detector, Options};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::pair_list::{Allowance, PAIR_BYTES, PairList};
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::probe::{Op, Probe, Silent, Tally};
use contactbench_ground::wide::Level;
use contactbench_streamed::{FEWEST_FOR_THREADS, Form, Streamed, streamed};

use crate::make;

const NAME: &str = "streamed-nbs";

const SCENES: [&str; 15] = [
    "packed:n=1000",
    "packed:dim=3,n=1000",
    "packed:dim=3,n=1000,size-ratio=5",
    "packed:lattice=square,spacing=1,jitter=0,n=700",
    "packed:dim=3,lattice=cubic,spacing=1,jitter=0,n=700",
    "loose:n=1000",
    "loose:dim=3,n=1000,size-ratio=3",
    "loose:dim=3,n=700,fraction=0.000001",
    "loose:n=700,fraction=5,size-ratio=2",
    "clustered:n=1000",
    "clustered:dim=3,n=1000,fraction=0.0001",
    "pack-c:n=900,s=200",
    "loose:n=1000,neighbours=100",
    "loose:dim=3,n=1000,neighbours=80",
    "loose:dim=3,n=1000,neighbours=400,size-ratio=1.2",
];

fn of<const D: usize>(centres: impl IntoIterator<Item = [f64; D]>) -> Scene<'static, f64, D> {
    Scene::at(centres, 0.5).unwrap()
}

fn answer(detector: &mut dyn AnyDetector, scene: &AnyScene<'_>, test: Test) -> Digest {
    let mut digest = Digest::default();
    detector.visit(scene, test, &mut digest).unwrap();
    digest
}

fn in_form(level: Level, form: Option<Form>) -> Box<dyn AnyDetector> {
    streamed(Some(level.name()), form, Options::default())
}

/// Compares the answers of all forms and levels; returns the number of answers compared.
fn compare(what: &str, scene: &AnyScene<'_>, test: Test) -> usize {
    let mut direct = table::find("direct").unwrap().make(Options::default());
    let truth = answer(&mut *direct, scene, test);
    let mut compared = 0;
    for level in Level::all() {
        for form in [None, Some(Form::Dense), Some(Form::Flat), Some(Form::Sparse)] {
            let mut detector = in_form(level, form);
            let what = format!("{what} on {} in form {form:?}", level.name());
            assert_eq!(answer(&mut *detector, scene, test), truth, "{what}");
            // Later rounds use the buffers of the first. Pairs are written in the space of a list,
            // which is short of it, fills up during the sweep, or has enough.
            for capacity in [0, 400, 1 << 16] {
                let mut pairs = Vec::with_capacity(capacity);
                detector.list(scene, test, &mut pairs).unwrap();
                assert_eq!(Digest::from_pairs(&pairs), truth, "{what}, {capacity} pairs");
                compared += 1;
            }
            let allowance = Allowance::new(500 * PAIR_BYTES);
            let mut full = PairList::new(&allowance);
            detector.search(&Searched::scene(scene, test), Task::List(&mut full)).unwrap();
            assert_eq!(full.found(), truth.contacts, "{what}");
        }
    }
    compared
}

#[test]
fn all_forms_on_all_levels_in_all_arithmetics() {
    let mut compared = 0;
    for text in SCENES {
        let scene = make(text);
        for arithmetic in Arithmetic::SAFE {
            let scene = scene.stored(arithmetic).unwrap();
            let what = format!("{text} in {}", arithmetic.name());
            compared += compare(&what, &scene, arithmetic.test());
        }
    }
    assert_eq!(compared, SCENES.len() * Arithmetic::SAFE.len() * Level::all().len() * 12);
}

/// Stored coordinates wrap. They wrap many times between two distant heaps, and once inside a heap.
#[test]
fn coordinates_that_begin_again() {
    let heap = |x: f64, y: f64| {
        (0..400).map(move |k| [x + 0.7 * f64::from(k % 20), y + 0.45 * f64::from(k / 20)])
    };
    for far in [246.0, 250.0, 255.5, 1000.0, 3e5, 5e8] {
        let centres = || heap(0.0, 0.0).chain(heap(far, 3.0)).chain(heap(0.3, 2.0 * far));
        let solid = of(centres().map(|[x, y]| [x, y, 1.5 * y]));
        compare(&format!("solid heaps {far} apart"), &solid.into(), Test::Exact);
        compare(&format!("heaps {far} apart"), &of(centres()).into(), Test::Exact);
    }
}

/// Some particles have more neighbours than a vector or a buffer holds. Crowds at the corners of a
/// cube fill the buffers exactly, and exceed them by one.
#[test]
fn heaps_of_any_height_and_rooms_that_are_filled() {
    for n in [7, 8, 9, 15, 16, 17, 18, 33, 250, 1000] {
        let at = |k| [1e-3 * f64::from(k % 7), 2e-3 * f64::from(k % 5), 1e-3];
        compare(&format!("a heap of {n}"), &of((0..n).map(at)).into(), Test::Exact);
    }
    let corners = [[0.0, 0.0, 0.0], [0.9, 0.9, 0.0], [0.9, 0.0, 0.9], [0.0, 0.9, 0.9]];
    let numbers = [60, 80, 81, 700, 1024, 1025, 1026, 2800];
    for (n, used) in numbers.into_iter().flat_map(|n| [(n, 3), (n, 4)]) {
        let scene = of((0..n).map(|k| corners[k % used]));
        compare(&format!("{n} at {used} corners"), &scene.into(), Test::Exact);
    }
}

/// Layers hold less than one particle on average. The 32 bits of a coordinate limit the number of
/// layers in a bundle.
#[test]
fn lines_strips_and_columns() {
    for n in [1000, 2000, 4999] {
        for pitch in [0.9, 1.0, 2.4, 4.9] {
            let line = of((0..n).map(|k| [0.0, pitch * f64::from(k)]));
            compare(&format!("a line of {n}, {pitch} apart"), &line.into(), Test::Exact);
            let at = |k| [f64::from(k % 2), 0.7 * f64::from(k % 3), pitch * f64::from(k)];
            let column = of((0..n).map(at));
            compare(&format!("a column of {n}, {pitch} apart"), &column.into(), Test::Exact);
        }
    }
}

/// A crowd is refused without a panic if its extent is beyond the range of cell numbers.
#[test]
fn crowds_far_apart_are_refused() {
    let heap = |at: f64| (0..2500).map(move |k| [at + 1e-3 * f64::from(k), at]);
    let scene = of(heap(0.0).chain(heap(1e20))).into();
    let answer = in_form(Level::best(), None).list(&scene, Test::Exact, &mut Vec::new());
    assert!(matches!(answer, Err(Refusal::Domain { .. })), "{answer:?}");
}

/// Textbook arithmetic accepts points whose squared distance underflows to 0.
#[test]
fn textbook_loses_nothing() {
    let scene = Scene::at([[0.0, 0.0], [1e-163, 0.0]], 0.0).unwrap().into();
    let digest = answer(&mut *in_form(Level::best(), None), &scene, Test::Textbook);
    assert_eq!(digest, Digest::from_pairs(&[[0, 1]]));
}

/// Several threads find the same pairs as one, even if they outnumber bundles or reuse buffers.
#[test]
fn threads_find_the_same() {
    let n = FEWEST_FOR_THREADS;
    for text in ["packed:dim=3", "packed:dim=3,size-ratio=1.2", "loose:dim=2", "clustered:dim=2"] {
        let scene = make(&format!("{text},n={}", n + 2_000));
        assert!(scene.len() >= n, "{text} is for one thread");
        let other = make(&format!("loose:dim={},n={n},seed=2", scene.dim()));
        let table = table::find(NAME).unwrap();
        let digests = [1, 2, 3, 20].map(|threads| {
            let mut detector = table.make(Options { threads, ..Options::default() });
            let mut pairs = vec![[9, 9]];
            detector.list(&scene, Test::Exact, &mut pairs).unwrap();
            assert_eq!(pairs[0], [9, 9], "what was in the list stays");
            let first = Digest::from_pairs(&pairs[1..]);
            detector.list(&other, Test::Exact, &mut Vec::new()).unwrap();
            pairs.truncate(1);
            detector.list(&scene, Test::Exact, &mut pairs).unwrap();
            [first, Digest::from_pairs(&pairs[1..])]
        });
        let same = digests.iter().flatten().all(|digest| *digest == digests[0][0]);
        assert!(same && digests[0][0].contacts > 1_000, "{text}: {digests:?}");
    }
}

/// The f32 filter leaves few pairs undecided, but on a lattice of tangent particles all contacts.
#[test]
fn few_pairs_are_left_to_the_contact_test() {
    let asked_of_contacts = |text: &str| {
        let AnyScene::Space(Stored::F64(scene)) = make(text) else { panic!("{text}") };
        let (asked, mut digest) = (AtomicU64::new(0), Digest::default());
        let counted = Counted(any_particles(&scene, Test::Exact).unwrap(), &asked);
        let mut detector = Streamed::<3>::on(Level::best(), None, Options::default());
        detector.detect(counted, &mut Silent, &mut digest).unwrap();
        (asked.into_inner(), digest.contacts)
    };
    let (asked, contacts) = asked_of_contacts("packed:dim=3,n=7000");
    assert!(asked * 500 < contacts, "{asked} of {contacts}");
    let lattice = "packed:dim=3,lattice=cubic,spacing=1,jitter=0,n=1000";
    assert_eq!(asked_of_contacts(lattice), (2700, 2700));
}

#[derive(Clone, Copy)]
struct Counted<'a, B>(B, &'a AtomicU64);

impl<B: Particles<f64, 3>> Particles<f64, 3> for Counted<'_, B> {
    fn len(&self) -> usize {
        self.0.len()
    }
    fn position(&self, i: u32) -> [f64; 3] {
        self.0.position(i)
    }
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.touch(i, j, probe)
    }
    fn reach(&self) -> f64 {
        self.0.reach()
    }
    fn radius(&self, i: u32) -> f64 {
        self.0.radius(i)
    }
    fn uniform(&self) -> Option<f64> {
        self.0.uniform()
    }
    fn slack(&self) -> Slack {
        self.0.slack()
    }
}

/// Memory does not depend on the number of cells, tried with 4·10^8 and 10^27 cells.
#[test]
fn memory_is_of_particles_not_of_cells() {
    let per_particle = |scene: &AnyScene<'_>| {
        let mut detector = table::find(NAME).unwrap().make(Options::default());
        detector.visit(scene, Test::Exact, &mut Digest::default()).unwrap();
        detector.formula_bytes() as f64 / scene.len() as f64
    };
    let all = [2, 20, 200].map(|s| per_particle(&make(&format!("pack-c:n=10000,s={s}"))));
    assert!(all.iter().all(|&bytes| bytes < 64.0), "{all:?}");
    let ends = |far: f64| of((0..60).map(|k| [far * f64::from(k % 2); 3]));
    let far = |far: f64| 60.0 * per_particle(&ends(far).into());
    assert!(far(1e9) <= far(1e3) + 64.0 && far(1e9) < 50_000.0, "{} {}", far(1e3), far(1e9));
}

/// On every instruction set a contact test is counted for each particle in a visited range, and
/// undecided pairs are counted once.
#[test]
fn counts_are_the_same_on_all_levels() {
    for text in [
        "packed:dim=3,n=700",
        "packed:lattice=square,spacing=1,jitter=0,n=1000",
        "clustered:n=700,size-ratio=3",
    ] {
        let scene = make(text);
        for form in [Form::Dense, Form::Flat, Form::Sparse] {
            let counted = |level| {
                let (mut tally, mut digest) = (Tally::default(), Digest::default());
                let mut detector = in_form(level, Some(form));
                detector.count(&scene, Test::Exact, &mut tally, &mut digest).unwrap();
                assert!(tally.get(Op::ContactTest) >= digest.contacts);
                // The flat form visits one range for each particle in 2D, two in 3D.
                if form == Form::Flat && !text.contains("ratio") {
                    let ranges = u64::from(text.contains("dim=3")) + 1;
                    assert_eq!(tally.get(Op::CellProbe), ranges * scene.len() as u64, "{text}");
                }
                tally
            };
            let tallies: Vec<Tally> = Level::all().into_iter().map(counted).collect();
            let same = tallies.iter().all(|tally| *tally == tallies[0]);
            assert!(same, "{text} in form {form:?}: {tallies:?}");
        }
    }
}

/// Columns are divided into cells if all particles except one lie in one column. The form for other
/// scenes can be read off `counts.txt`: for each particle, with cells 2 ranges are visited in 2D
/// and 5 in 3D, with columns 1 and 2.
#[test]
fn a_column_of_all_particles_is_divided() {
    let row = (0..4095).map(|k| [0.0, f64::from(k)]).chain([[4100.0, 0.0]]);
    let (mut tally, mut digest) = (Tally::default(), Digest::default());
    let mut detector = in_form(Level::best(), None);
    detector.count(&of(row).into(), Test::Exact, &mut tally, &mut digest).unwrap();
    assert_eq!(tally.get(Op::CellProbe), 2 * 4096);
}

/// Pairs whose distance is a few steps of f32 from a diameter, far from the origin. The filter
/// needs its full bound on rounding: half of it would lose or add some pairs.
#[test]
fn pairs_where_floats_are_coarse() {
    let mut state = 1;
    let mut unit = || {
        state = contactbench_terms::mix::splitmix64(state);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    // The first scene has 270 cells along x, or 3000 columns in the flat form; the second has 2110
    // cells along both axes.
    let wide: Vec<_> =
        (0..7800).map(|_| [3000.0 * (0.95 + 0.05 * unit()), 3200.0 * unit()]).collect();
    let corner: Vec<_> =
        (0..7800).map(|_| [2050.0 + 60.0 * unit(), 2050.0 + 60.0 * unit()]).collect();
    for (mut places, turned) in [(wide, 0.0), (corner, 1.0)] {
        places[0] = [0.0, 0.0];
        // The rounding error depends on the difference modulo a step of the floats, so diameters
        // and directions go through all residues.
        for (diameter, all) in (0..32).map(|k| (1.0 + 2e-5 * f64::from(k), k % 8 == 0)) {
            let pair = |(k, [x, y]): (usize, [f64; 2])| {
                let apart = diameter + 1e-5 * (k as f64 / 3900.0 - 1.0);
                let (sin, cos) = f64::sin_cos(turned * (0.5 + 0.001 * (k % 600) as f64));
                [[x, y], [x + cos * apart, y + sin * apart]]
            };
            let pairs = places.iter().copied().enumerate().flat_map(pair);
            let scene = Scene::at(pairs, 0.5 * diameter).unwrap().into();
            let mut nbs = table::find("nbs").unwrap().make(Options::default());
            let truth = answer(&mut *nbs, &scene, Test::Exact);
            // All levels have the same bound.
            let best = Level::best().name();
            for level in Level::all().into_iter().filter(|level| all || level.name() == best) {
                for form in [Form::Dense, Form::Flat] {
                    let found = answer(&mut *in_form(level, Some(form)), &scene, Test::Exact);
                    let what = (level.name(), form, diameter, turned);
                    assert_eq!(found, truth, "{what:?}");
                }
            }
        }
    }
}
