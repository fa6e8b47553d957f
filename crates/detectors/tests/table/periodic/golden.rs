//! Scenes with known contacts: test cases of other codes, and scenes that codes got wrong.

use super::*;

fn bag<const D: usize>(
    centres: &[[f64; D]],
    radius: f64,
    vectors: [[f64; 3]; 3],
    periodic: [bool; 3],
) -> Bag<D> {
    let radii = Radii::Uniform(radius);
    Bag { centres: centres.to_vec(), radii, vectors, periodic, origin: [0.0; 3] }
}

fn along_axes(lengths: [f64; 3]) -> [[f64; 3]; 3] {
    let [x, y, z] = lengths;
    [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]
}

/// Counts each particle's contacts, which all detectors must find; self-contacts count twice.
fn neighbours<const D: usize>(bag: &Bag<D>) -> Vec<usize> {
    let pairs = bag.truth();
    all_find(bag, &pairs);
    let mut counts = vec![0; bag.centres.len()];
    for pair in pairs {
        counts[pair.i as usize] += 1;
        counts[pair.j as usize] += 1;
    }
    counts
}

/// Cases of matscipy (tests/test_neighbours.py); the last two are tangent through images.
#[test]
fn a_cube_has_the_neighbours_that_it_is_known_to_have() {
    let of = |cutoff: f64, periodic| {
        neighbours(&bag(&[[0.25, 0.5, 0.875]], cutoff / 2.0, along_axes([1.0; 3]), periodic))[0]
    };
    for (cutoff, expected) in [(1.1, 6), (1.5, 18), (1.8, 26), (2.0, 32)] {
        assert_eq!(of(cutoff, [true; 3]), expected, "{cutoff}");
    }
    assert_eq!(of(2.0f64.next_down(), [true; 3]), 26);
    assert_eq!(of(1.0, [true; 3]), 6);
    assert_eq!(of(1.0f64.next_down(), [true; 3]), 0);
    assert_eq!(of(1.1, [true, false, false]), 2);
    assert_eq!(of(1.1, [true, false, true]), 4);
    assert_eq!(of(1.1, [false; 3]), 0);
}

/// Cases of ASE and matscipy: a face-centred cubic primitive cell; graphite with 1 to 9 cells.
#[test]
fn crystals() {
    let h = 4.05 / 2.0;
    let primitive = [[0.0, h, h], [h, 0.0, h], [h, h, 0.0]];
    let aluminium =
        |cutoff: f64| neighbours(&bag(&[[0.1, 0.2, 0.3]], cutoff / 2.0, primitive, [true; 3]))[0];
    assert_eq!([2.8637, 2.8638, 3.1, 4.04, 4.06].map(aluminium), [0, 12, 12, 12, 18]);
    let (a, b) = ([2.5, 0.0, 0.0], [-1.25, 2.5 * 0.75f64.sqrt(), 0.0]);
    for cells in 1..=3 {
        let mut atoms = Vec::new();
        for k in 0..cells * cells {
            let (u, v) = (f64::from(k % cells), f64::from(k / cells));
            let basis = [(0.0, 0.0, 0.0), (1.0, 2.0, 0.0), (0.0, 0.0, 5.0), (2.0, 1.0, 5.0)];
            atoms.extend(basis.map(|(x, y, z)| {
                let (u, v) = (u + x / 3.0, v + y / 3.0);
                [u * a[0] + v * b[0], v * b[1], z]
            }));
        }
        let n = f64::from(cells);
        let vectors = [a.map(|x| n * x), b.map(|x| n * x), [0.0, 0.0, 10.0]];
        let counts = neighbours(&bag(&atoms, 1.85 / 2.0, vectors, [true; 3]));
        assert!(counts.len() == 4 * (cells * cells) as usize && counts.iter().all(|&c| c == 3));
    }
}

/// Joins `times` copies of a box of unequal spheres along its periodic vectors into one box.
fn supercell(bag: &Bag<3>, times: [i32; 3]) -> Bag<3> {
    let times: [i32; 3] = std::array::from_fn(|v| if bag.periodic[v] { times[v] } else { 1 });
    let (mut centres, mut radii) = (Vec::new(), Vec::new());
    for a in 0..times[0] {
        for b in 0..times[1] {
            for c in 0..times[2] {
                let by: [f64; 3] = bag.shift([a, b, c]);
                centres.extend(bag.centres.iter().map(|x| std::array::from_fn(|k| x[k] + by[k])));
                radii.extend((0..bag.centres.len()).map(|k| bag.scene().radius(k)));
            }
        }
    }
    let vectors = std::array::from_fn(|v| bag.vectors[v].map(|x| f64::from(times[v]) * x));
    Bag { centres, radii: Radii::Each(radii.into()), vectors, ..bag.clone() }
}

/// matscipy's wild cell, on a grid of 2^-10 so that copies are exact: ten particles of ten radii,
/// in and around the box. A particle has the same number of contacts in any supercell.
#[test]
fn a_wild_cell_repeated_has_the_same_contacts() {
    let random = &mut ChaCha8Rng::seed_from_u64(1);
    let wild = [[205.0, 1229.0, 1434.0], [1434.0, 102.0, 1638.0], [1331.0, 2048.0, -102.0]];
    let wild = wild.map(|vector| vector.map(|x| x / 1024.0));
    let mut all = 0;
    for flags in 0..8 {
        let periodic = [flags & 1 > 0, flags & 2 > 0, flags & 4 > 0];
        let mut one = bag::<3>(&[], 0.0, wild, periodic);
        one.radii = Radii::Each((0..10).map(|_| 0.25 + 0.75 * random.random::<f64>()).collect());
        one.centres = (0..10)
            .map(|_| {
                let s: [f64; 3] = std::array::from_fn(|_| 3.0 * random.random::<f64>() - 1.0);
                std::array::from_fn(|k| {
                    let x: f64 = (0..3).map(|v| s[v] * wild[v][k]).sum();
                    (x * 1024.0).round() / 1024.0
                })
            })
            .collect();
        let times = [2, 3, 1];
        let many = supercell(&one, times);
        let (counts, copies) = (neighbours(&one), neighbours(&many));
        let repeated = (0..3).filter(|&v| periodic[v]).map(|v| times[v]).product::<i32>() as usize;
        assert_eq!(copies.len(), 10 * repeated);
        for (k, &count) in copies.iter().enumerate() {
            assert_eq!(count, counts[k % 10], "{periodic:?}, particle {k}");
        }
        all += counts.iter().sum::<usize>();
    }
    assert!(all > 300, "{all}");
}

/// Scenes from bug reports of other codes.
#[test]
fn scenes_that_codes_were_wrong_about() {
    let pair = |i, j, image| ImagePair { i, j, image };
    let cube = |edge: f64| along_axes([edge; 3]);
    // NeighbourLists#28, #38: wrapped and rounded, this particle is on the upper face of the box,
    // which is the same as the lower face.
    let scene = bag(&[[-5e-17, 0.5, 0.5], [0.9, 0.5, 0.5]], 0.05, cube(1.0), [true; 3]);
    all_find(&scene, &[pair(0, 1, [-1, 0, 0])]);
    all_find(&Bag { radii: Radii::Uniform(0.05 - 4e-17), ..scene }, &[]);
    // NeighbourLists#6: particles outside the box on both sides.
    let scene = bag(&[[-0.5, 1.0, 1.0], [8.5, 1.0, 1.0]], 0.5, cube(8.0), [true; 3]);
    all_find(&scene, &[pair(0, 1, [-1, 0, 0])]);
    // Two particles near opposite faces, a distance of 1 apart through the faces.
    let scene = bag(&[[0.5, 4.0, 4.0], [7.5, 4.0, 4.0]], 0.5, cube(8.0), [true; 3]);
    all_find(&scene, &[pair(0, 1, [-1, 0, 0])]);
    all_find(&Bag { radii: Radii::Uniform(0.5f64.next_down()), ..scene }, &[]);
    // The box is twice as long as the reach, and the particles are two and a half boxes apart: two
    // contacts.
    let scene = bag(&[[-4.0, 1.0, 1.0], [6.0, 1.0, 1.0]], 1.0, cube(4.0), [true; 3]);
    all_find(&scene, &[pair(0, 1, [-3, 0, 0]), pair(0, 1, [-2, 0, 0])]);
    // FreeBird.jl#150: the box is twice as long as the reach, so two images touch.
    let scene = bag(&[[0.0, 0.0], [2.0, 0.0]], 1.0, cube(4.0), [true, false, false]);
    all_find(&scene, &[pair(0, 1, [-1, 0, 0]), pair(0, 1, [0; 3])]);
    // GPUMD#190: a box slightly shorter than a whole number of cutoffs.
    let row: Vec<[f64; 3]> = (0..20).map(|k| [f64::from(k) * 0.149, 0.0, 0.0]).collect();
    let scene = bag(&row, 0.075, along_axes([2.9795, 9.0, 9.0]), [true; 3]);
    assert_eq!(neighbours(&scene), [2; 20]);
    // ESPResSo#2051, #5267: a box sheared by 0, by half its edge and by its whole edge.
    for (tilt, x, image) in [(0.0, 1.0, [0, -1, 0]), (2.0, 3.0, [0, -1, 0]), (4.0, 1.0, [1, -1, 0])]
    {
        let vectors = [[4.0, 0.0, 0.0], [tilt, 4.0, 0.0], [0.0, 0.0, 1.0]];
        let scene = bag(&[[1.0, 0.25], [x, 3.75]], 0.25, vectors, [true, true, false]);
        all_find(&scene, &[pair(0, 1, image)]);
    }
}
