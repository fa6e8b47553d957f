use contactbench_detectors::oracle::boxes;
use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::periodic::Searchable;
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic};
use contactbench_ground::scene::{AnyScene, Lattice, Radii};
use contactbench_lists::track::Tracker;

use super::{Draw, tracker};

const LIMIT: u64 = 1 << 28;

/// Image of a particle that a file contains.
#[derive(Clone, Copy, Debug)]
enum Named {
    /// The image on the particle's continuous path, which may leave the box.
    Onwards,
    /// The image inside the box, in every frame.
    Wrapped,
    /// A different random image in each frame.
    Anyhow,
}

struct Trajectory {
    n: usize,
    edges: [f64; 3],
    tilt: f64,
    open: bool,
    sizes: bool,
    /// Fraction of the first edge by which the box is sheared in each frame.
    sheared: f64,
    named: Named,
    seed: u64,
}

const TILTED: Trajectory = Trajectory {
    n: 60,
    edges: [4.5, 5.0, 4.2],
    tilt: 0.3,
    open: false,
    sizes: false,
    sheared: 0.0,
    named: Named::Onwards,
    seed: 0,
};

impl Trajectory {
    fn frames<const D: usize>(&self) -> Vec<Periodic<'static>> {
        let Trajectory { n, edges, tilt, open, sizes, sheared, named, seed } = *self;
        let mut draw = Draw(seed << 32);
        let mut points = |size: f64| -> Vec<[f64; 3]> {
            (0..n).map(|_| std::array::from_fn(|_| size * draw.symmetric())).collect()
        };
        // Positions as fractions of the box, displacements per frame, and random images.
        let (first, displacements, names) = (points(0.5), points(0.04), points(3.0));
        let radii = match sizes {
            true => Radii::Each((0..n).map(|k| 0.1 + 0.4 * (k % 5) as f64 / 4.0).collect()),
            false => Radii::Uniform(0.5),
        };
        let frame = |k: u32| {
            let age = f64::from(k);
            let ([x, y, z], tilt) = (edges, tilt + sheared * age);
            let vectors = [[x, 0.0, 0.0], [tilt * x, y, 0.0], [0.0, 0.0, z]];
            let given = [true, true, !open];
            let lattice = Lattice::new(vectors, given, [0.0; 3]).unwrap();
            // Particles move affinely with the box, and along individual paths.
            let place = |i: usize| -> [f64; 3] {
                let sum = |axis: usize| (0..3).map(|v| first[i][v] * vectors[v][axis]).sum::<f64>();
                std::array::from_fn(|axis| sum(axis) + age * displacements[i][axis])
            };
            let brought = |i: usize| -> [f64; 3] {
                let at = place(i);
                let by: [f64; 3] = std::array::from_fn(|v| match named {
                    _ if !given[v] || v >= D => 0.0,
                    Named::Onwards => 0.0,
                    Named::Wrapped => {
                        let dual = lattice.dual(v);
                        -(0..3).map(|axis| dual[axis] * at[axis]).sum::<f64>().floor()
                    }
                    Named::Anyhow => names[(i + k as usize) % n][v].round(),
                });
                let of = lattice.vectors();
                let sum = |axis: usize| (0..3).map(|v| by[v] * of[v][axis]).sum::<f64>();
                std::array::from_fn(|axis| at[axis] + sum(axis))
            };
            let row = |i| std::array::from_fn(|axis| brought(i)[axis]);
            let scene = AnyScene::at::<D>((0..n).map(row), radii.clone()).unwrap();
            Periodic::new(scene, lattice).unwrap()
        };
        (0..14).map(frame).collect()
    }
}

fn boxed<const D: usize>(
    centres: impl IntoIterator<Item = [f64; D]>,
    radius: f64,
    vectors: [[f64; 3]; 3],
    periodic: [bool; 3],
    corner: [f64; 3],
) -> Periodic<'static> {
    let scene = AnyScene::at(centres, radius).unwrap();
    Periodic::new(scene, Lattice::new(vectors, periodic, corner).unwrap()).unwrap()
}

/// Returns the numbers of missed contacts, all contacts, and frames in which a list was built.
fn missed(tracker: &mut dyn Tracker, frames: &[Periodic<'_>]) -> [usize; 3] {
    let (mut missed, mut all, mut built) = (0, 0, 0);
    let mut contacts = ContactList::default();
    for frame in frames {
        let truth = boxes::truth(frame, Arithmetic::Exact, LIMIT).unwrap().pairs;
        contacts.clear();
        let step =
            tracker.find(Searchable::Boxed(frame, Arithmetic::Exact), None, &mut contacts).unwrap();
        let found = contacts.sorted(frame.scene().len(), LIMIT).unwrap();
        assert!(found.windows(2).all(|two| two[0] < two[1]), "one twice");
        assert!(found.iter().all(|pair| truth.binary_search(pair).is_ok()), "one that is not");
        missed += truth.len() - found.len();
        all += truth.len();
        built += usize::from(step.built);
    }
    [missed, all, built]
}

fn trajectories() -> Vec<Trajectory> {
    let mut all = Vec::new();
    for (k, sheared) in [0.0, 0.02].into_iter().enumerate() {
        for (m, named) in [Named::Onwards, Named::Wrapped, Named::Anyhow].into_iter().enumerate() {
            for (edges, n) in [([4.5, 5.0, 4.2], 60), ([1.3, 2.5, 1.8], 5), ([0.8, 0.7, 0.9], 2)] {
                let (sizes, open) = ((k + m) % 2 == 0, m == k);
                let tilt = [0.0, 0.3, -0.45][m];
                let seed = (31 * k + 7 * m + n) as u64;
                all.push(Trajectory { n, edges, tilt, open, sizes, sheared, named, seed });
            }
        }
    }
    all
}

#[test]
fn safe_rules_miss_nothing_in_boxes() {
    let [mut all, mut frames, mut built] = [0; 3];
    for trajectory in trajectories() {
        let scenes = [trajectory.frames::<2>(), trajectory.frames::<3>()];
        for rule in ["half-skin", "top-two", "summed"] {
            for skin in ["0", "0.1", "0.6", "auto"] {
                let text = format!("verlet(nbs,skin={skin},rule={rule})");
                for scene in &scenes {
                    let found = missed(&mut *tracker(&text), scene);
                    let Trajectory { edges, tilt, sheared, named, .. } = &trajectory;
                    let about = || format!("{text} {edges:?} {tilt} {sheared} {named:?}");
                    assert_eq!(found[0], 0, "{}", about());
                    all += found[1];
                    if skin == "0.6" && trajectory.sheared == 0.0 {
                        frames += scene.len();
                        built += found[2];
                    }
                }
            }
        }
    }
    assert!(all > 200_000, "{all}");
    // Each list serves for several frames, whichever images are given.
    assert!(2 * built < frames, "{built} of {frames}");
}

/// Which images are given does not affect how long a list serves.
#[test]
fn lists_serve_as_long_for_any_image_of_a_particle() {
    let of = |named| Trajectory { named, seed: 9, ..TILTED };
    let built = [Named::Onwards, Named::Wrapped, Named::Anyhow].map(|named| {
        let [_, _, built] = missed(&mut *tracker("verlet(nbs,skin=0.3)"), &of(named).frames::<3>());
        built
    });
    assert_eq!(built, [built[0]; 3]);
    assert!((2..8).contains(&built[0]), "{built:?}");
}

/// A single sphere in a box that is compressed until it touches its own images: the list is
/// rebuilt.
#[test]
fn a_box_that_moves_makes_contacts_of_particles_at_rest() {
    let frame = |k: u32| {
        let vectors = [[1.5 - 0.0625 * f64::from(k), 0.0, 0.0], [0.0, 1.25, 0.0], [0.0, 0.0, 3.0]];
        boxed([[0.25, 0.5, 0.75]], 0.5, vectors, [true; 3], [0.0; 3])
    };
    let frames: Vec<_> = (0..10).map(frame).collect();
    for rule in ["half-skin", "every-20"] {
        let tracker = &mut *tracker(&format!("verlet(direct,skin=0.25,rule={rule})"));
        assert_eq!(missed(tracker, &frames), [0, 2, 10]);
    }
}

/// A corner that moves along the open axis of a box, as in dumps that fit the box to the particles,
/// does not end a list.
#[test]
fn corners_that_move_do_not_end_a_list() {
    let mut draw = Draw(17);
    let first: Vec<[f64; 3]> =
        (0..60).map(|_| std::array::from_fn(|_| 2.0 + 2.0 * draw.symmetric())).collect();
    let frame = |k: u32| {
        let low = 0.4 * f64::from(k);
        let vectors = [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0 - low]];
        boxed(first.iter().copied(), 0.5, vectors, [true, true, false], [0.0, 0.0, low])
    };
    let frames: Vec<_> = (0..9).map(frame).collect();
    let [lost, all, built] = missed(&mut *tracker("verlet(nbs,skin=0.3)"), &frames);
    assert!(lost == 0 && all > 100 && built == 1, "{all} {built}");
}

/// In a box tilted by more than its length, the image nearest to a particle's earlier position does
/// not have the nearest coordinates in fractions of the box.
#[test]
fn lists_serve_in_boxes_that_are_tilted_far() {
    let of = |tilt, named| Trajectory { tilt, named, seed: 23, ..TILTED };
    // A box at rest never flips.
    for tilt in [0.45, -0.49] {
        for named in [Named::Wrapped, Named::Anyhow] {
            let [lost, all, built] =
                missed(&mut *tracker("verlet(nbs,skin=0.3)"), &of(tilt, named).frames::<2>());
            assert!(lost == 0 && all > 100 && built < 8, "{tilt} {named:?} {all} {built}");
        }
    }
    let frame = |k: u32| {
        let at = [[0.0, 0.5 + 0.02 * f64::from(k)], [1.3, 0.5], [2.6, 0.1]];
        let by = f64::from(k % 2);
        let centres = at.map(|[x, y]: [f64; 2]| [x + by * 90.5, y + by * 1.0]);
        let vectors = [[4.0, 0.0, 0.0], [90.5, 1.0, 0.0], [0.0; 3]];
        boxed(centres, 0.5, vectors, [true, true, false], [0.0; 3])
    };
    let frames: Vec<_> = (0..14).map(frame).collect();
    let [lost, all, built] = missed(&mut *tracker("verlet(nbs,skin=0.5)"), &frames);
    assert!(lost == 0 && all > 20 && built == 1, "{all} {built}");
}

/// When the list is built, pairs through a face are apart by skin and rounding margin, or slightly
/// more or less. Then the particles move just far enough for a contact, or not quite.
#[test]
fn pairs_at_the_limit_of_the_skin_are_not_lost_through_a_face() {
    let (mut draw, mut touching, mut unlisted) = (Draw(5), 0, 0);
    for round in 0..10_000u32 {
        let radius = 0.5 + 0.25 * draw.symmetric();
        let skin = [0.01, 0.3, 1.7][round as usize % 3];
        let (reach, gap) = (2.0 * radius, 2.0 * (skin * radius));
        let edge = 16.0 + draw.symmetric();
        let offset = [0.0, 0.1, 1e3, 1e9, 1e12, 1e11, 1e12][round as usize % 7] * draw.symmetric();
        let share = [0.0, 0.5, 1.0, 0.5 + 0.5 * draw.symmetric()][round as usize / 7 % 4];
        let allowed = 64.0 / (1u64 << 48) as f64 * (2.0 * edge + 9.0 + 4.0 * offset.abs());
        let widest = if round % 2 == 0 { 1.4 } else { 4.0 };
        let mut near = |x: f64| match (widest * draw.symmetric()).round() as i32 {
            0 => x,
            1 => x.next_up(),
            -1 => x.next_down(),
            more => x + 0.5 * f64::from(more) * allowed,
        };
        // In some rounds the first particle is given by its image near the second.
        let named = if round % 3 == 0 { edge } else { 0.0 };
        // The second particle is beyond the opposite face, so its image is at -(reach + gap).
        let places = [
            [offset, near(offset + edge - reach - gap)],
            [near(offset + named - share * gap), near(offset + edge - reach - share * gap)],
        ];
        let frames = places.map(|of| {
            let vectors = [[edge, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 1.0]];
            let (corner, repeats) = ([offset, 0.0, 0.0], [true, true, false]);
            boxed(of.map(|x| [x, 0.25]), radius, vectors, repeats, corner)
        });
        for rule in ["half-skin", "top-two", "summed"] {
            let mut tracker = tracker(&format!("verlet(direct,skin={skin},rule={rule})"));
            let mut contacts = ContactList::default();
            let mut step = |frame| {
                contacts.clear();
                let step = tracker
                    .find(Searchable::Boxed(frame, Arithmetic::Exact), None, &mut contacts)
                    .unwrap();
                (step.listed, contacts.sorted(2, LIMIT).unwrap())
            };
            let (listed, _) = step(&frames[0]);
            let (_, found) = step(&frames[1]);
            let truth = boxes::truth(&frames[1], Arithmetic::Exact, LIMIT).unwrap().pairs;
            assert_eq!(found, truth, "{rule}, skin {skin}, {places:?} {edge} {radius}");
            touching += truth.len();
            unlisted += truth.len() * usize::from(listed == 0);
        }
    }
    assert!(touching > 3_000 && unlisted > 300, "{touching} {unlisted}");
}

#[test]
fn trackers_refuse_rounded_arithmetic_in_boxes() {
    let scene = AnyScene::at([[0.25, 0.5]], 0.5).unwrap();
    let lattice = Lattice::along_axes([1.0; 3], [true, true, false]).unwrap();
    let boxed = Periodic::new(scene.clone(), lattice).unwrap();
    let mut contacts = ContactList::default();
    let mut step = |text: &str, arithmetic| {
        contacts.clear();
        let step = tracker(text).find(Searchable::Boxed(&boxed, arithmetic), None, &mut contacts);
        step.map(|_| contacts.len()).map_err(|refusal| refusal.to_string())
    };
    assert_eq!(step("every-step(nbs)", Arithmetic::F32), Ok(2));
    assert_eq!(step("verlet(nbs)", Arithmetic::Exact), Ok(2));
    let said = step("verlet(nbs)", Arithmetic::F32).unwrap_err();
    assert!(said.contains("exact arithmetic, not in f32"), "{said}");
    let mut tracker = tracker("verlet(nbs,skin=0.5)");
    for _ in 0..3 {
        let mut pairs = Vec::new();
        let step = tracker.step(&scene, Test::Exact, None, &mut pairs).unwrap();
        assert!(step.built && pairs.is_empty());
        let mut contacts = ContactList::default();
        let step = tracker
            .find(Searchable::Boxed(&boxed, Arithmetic::Exact), None, &mut contacts)
            .unwrap();
        assert!(step.built && contacts.shifted.len() == 2, "{contacts:?}");
        contacts.shifted.sort();
        assert_eq!(contacts.shifted[0], ImagePair { i: 0, j: 0, image: [0, 1, 0] });
    }
}
