//! Metamorphic relations, exact on dyadic boxes: how a change of the box changes the set of
//! contacts. `tests/detectors/metamorphic` tests changes of the particles.

use super::*;

type Becomes = Box<dyn Fn(Vec<ImagePair>) -> Vec<ImagePair>>;

/// A scene after a change, or `None` if the change does not apply.
type Change<const D: usize> = Option<(Bag<D>, Becomes)>;

type Relation<const D: usize> = fn(&Bag<D>, &mut ChaCha8Rng) -> Change<D>;

/// Checks a relation for each detector on a few scenes in 2D and 3D, in every safe arithmetic. All
/// numbers have so few bits that none is rounded.
fn hold(plane: Relation<2>, space: Relation<3>) {
    for arithmetic in Arithmetic::SAFE {
        let contacts = hold_in(plane, arithmetic) + hold_in(space, arithmetic);
        assert!(contacts > 2000, "{arithmetic}: {contacts}");
    }
}

fn hold_in<const D: usize>(relation: Relation<D>, arithmetic: Arithmetic) -> usize {
    let mut contacts = 0;
    for seed in 0..20 {
        for (k, entry) in detectors().enumerate() {
            let seed = seed * 100 + k as u64;
            let before = random::<D>(seed, Numbers::Dyadic);
            let random = &mut ChaCha8Rng::seed_from_u64(seed ^ 0x5eed);
            let Some((after, becomes)) = relation(&before, random) else { continue };
            let detector = &mut *entry.make(OPTIONS);
            let mut find = |bag: &Bag<D>| {
                match ask(detector, &bag.periodic(), arithmetic) {
                    // Refused: a particle is too far away along an open vector.
                    Err(Refusal::Memory { .. } | Refusal::Domain { .. }) => None,
                    found => Some(found.unwrap()),
                }
            };
            let (Some(earlier), Some(found)) = (find(&before), find(&after)) else { continue };
            let mut expected = becomes(earlier);
            expected.sort_unstable();
            let what = format!("{} in {arithmetic}: {before:?} and {after:?}", entry.name);
            assert!(found == expected, "{what}: {found:?}, not {expected:?}");
            contacts += expected.len();
        }
    }
    contacts
}

/// Makes a change in which each contact becomes one contact.
fn one<const D: usize>(
    after: Bag<D>,
    becomes: impl Fn(ImagePair) -> ImagePair + 'static,
) -> Change<D> {
    some(after, move |pair| vec![becomes(pair)])
}

/// Makes a change in which each contact becomes any number of contacts.
fn some<const D: usize>(
    after: Bag<D>,
    becomes: impl Fn(ImagePair) -> Vec<ImagePair> + 'static,
) -> Change<D> {
    Some((after, Box::new(move |pairs| pairs.into_iter().flat_map(&becomes).collect())))
}

fn moved<const D: usize>(x: &[f64; D], by: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| x[k] + by[k])
}

fn numbers<const D: usize>(bag: &Bag<D>, most: i32, random: &mut ChaCha8Rng) -> [i32; 3] {
    bag.periodic.map(|periodic| if periodic { random.random_range(-most..=most) } else { 0 })
}

#[test]
fn the_corner_of_the_box_changes_no_contact() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let origin = [(); 3].map(|()| f64::from(random.random_range(-5000..5000)) / 256.0);
        one(Bag { origin, ..bag.clone() }, |pair| pair)
    }
    hold(relation::<2>, relation::<3>);
}

#[test]
fn shifts_by_box_vectors_change_only_the_images() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let most = [1, 5, 100_000][random.random_range(0..3)];
        let by: Vec<[i32; 3]> = bag.centres.iter().map(|_| numbers(bag, most, random)).collect();
        let centres = bag.centres.iter().zip(&by).map(|(x, &by)| moved(x, bag.shift(by))).collect();
        let renamed = move |ImagePair { i, j, image }| {
            let (a, b) = (by[i as usize], by[j as usize]);
            ImagePair::new(i, j, std::array::from_fn(|v| image[v] + a[v] - b[v]))
        };
        one(Bag { centres, ..bag.clone() }, renamed)
    }
    hold(relation::<2>, relation::<3>);
}

/// Adding a multiple of one vector to another, or reversing one, does not change the lattice.
#[test]
fn other_vectors_of_a_lattice_change_only_the_images() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let open: Vec<usize> = (0..3).filter(|&v| bag.periodic[v]).collect();
        let mut after = bag.clone();
        let mut steps = Vec::new();
        for _ in 0..random.random_range(1..3) {
            let (a, b) =
                (open.get(random.random_range(0..3))?, open[random.random_range(0..open.len())]);
            let times = if *a == b { -2 } else { random.random_range(-1..=1) };
            let add = after.vectors[b].map(|x| f64::from(times) * x);
            after.vectors[*a] = moved(&after.vectors[*a], add);
            steps.push((*a, b, times));
        }
        Lattice::new(after.vectors, after.periodic, after.origin).ok()?;
        one(after, move |ImagePair { i, j, mut image }| {
            for &(a, b, times) in &steps {
                // The old vector Ha is H'a - times Hb; for a = b it is -H'a.
                if a == b { image[a] = -image[a] } else { image[b] -= times * image[a] }
            }
            ImagePair::new(i, j, image)
        })
    }
    hold(relation::<2>, relation::<3>);
}

/// Joins `times` copies of the box along periodic vectors into one box.
pub fn supercell<const D: usize>(bag: &Bag<D>, times: [i32; 3]) -> Bag<D> {
    let times: [i32; 3] = std::array::from_fn(|v| if bag.periodic[v] { times[v] } else { 1 });
    let mut many = Bag { centres: Vec::new(), ..bag.clone() };
    let (mut copies, mut radii) = (0, Vec::new());
    for a in 0..times[0] {
        for b in 0..times[1] {
            for c in 0..times[2] {
                let by = bag.shift([a, b, c]);
                many.centres.extend(bag.centres.iter().map(|x| moved(x, by)));
                copies += 1;
            }
        }
    }
    if let Radii::Each(each) = &bag.radii {
        (0..copies).for_each(|_| radii.extend(each.iter().copied()));
        many.radii = Radii::Each(radii.into());
    }
    many.vectors = std::array::from_fn(|v| bag.vectors[v].map(|x| f64::from(times[v]) * x));
    many
}

#[test]
fn a_box_repeated_has_each_contact_once_in_every_copy() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let n = bag.centres.len() as u32;
        let times = bag.periodic.map(|repeats| if repeats { random.random_range(1..4) } else { 1 });
        let copy = move |k: u32, place: [i32; 3]| {
            let [a, b, c] = place.map(|x| x as u32);
            let [_, y, z] = times.map(|x| x as u32);
            ((a * y + b) * z + c) * n + k
        };
        let becomes = move |ImagePair { i, j, image }| {
            let mut pairs = Vec::new();
            for a in 0..times[0] {
                for b in 0..times[1] {
                    for c in 0..times[2] {
                        let from = [a, b, c];
                        let to: [i32; 3] = std::array::from_fn(|v| from[v] + image[v]);
                        let place = std::array::from_fn(|v| to[v].rem_euclid(times[v]));
                        let image = std::array::from_fn(|v| to[v].div_euclid(times[v]));
                        pairs.push(ImagePair::new(copy(i, from), copy(j, place), image));
                    }
                }
            }
            pairs
        };
        some(supercell(bag, times), becomes)
    }
    hold(relation::<2>, relation::<3>);
}

/// The contacts without an image along a vector are those of the box that is open along it; the
/// contacts without any image are those of the open scene.
#[test]
fn a_box_has_the_contacts_of_boxes_that_are_more_open() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let periodic = bag.periodic.map(|flag| flag && random.random_bool(0.5));
        let kept = move |pair: ImagePair| {
            let open = (0..3).all(|v| periodic[v] || pair.image[v] == 0);
            if open { vec![pair] } else { Vec::new() }
        };
        some(Bag { periodic, ..bag.clone() }, kept)
    }
    hold(relation::<2>, relation::<3>);
}
