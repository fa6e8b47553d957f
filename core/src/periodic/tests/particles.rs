//! More relations: what a change of the particles, of all lengths or of an axis' direction does to
//! the contacts in a box.

use super::relations::{Change, Held, hold, hold_to, one, some};
use super::*;

fn chosen<const D: usize>(bag: &Bag<D>, order: &[u32]) -> Bag<D> {
    let centres = order.iter().map(|&k| bag.centres[k as usize]).collect();
    let radii = match &bag.radii {
        Radii::Uniform(r) => Radii::Uniform(*r),
        Radii::Each(radii) => Radii::Each(order.iter().map(|&k| radii[k as usize]).collect()),
    };
    Bag { centres, radii, ..bag.clone() }
}

fn largest<const D: usize>(bag: &Bag<D>) -> f64 {
    match &bag.radii {
        Radii::Uniform(r) => *r,
        Radii::Each(radii) => radii.iter().copied().fold(0.0, f64::max),
    }
}

#[test]
fn permutation_renames_the_contacts() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let mut order: Vec<u32> = (0..bag.centres.len() as u32).collect();
        for k in (1..order.len()).rev() {
            order.swap(k, random.random_range(0..=k));
        }
        let mut place = vec![0; order.len()];
        order.iter().zip(0..).for_each(|(&old, new)| place[old as usize] = new);
        one(chosen(bag, &order), move |ImagePair { i, j, image }| {
            ImagePair::new(place[i as usize], place[j as usize], image)
        })
    }
    hold(relation::<2>, relation::<3>);
}

#[test]
fn removal_leaves_the_contacts_of_the_rest() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let kept: Vec<u32> =
            (0..bag.centres.len() as u32).filter(|_| random.random_bool(0.75)).collect();
        let after = chosen(bag, &kept);
        some(after, move |ImagePair { i, j, image }| {
            let new = |k: u32| kept.binary_search(&k).ok().map(|k| k as u32);
            let pair = new(i).zip(new(j)).map(|(i, j)| ImagePair::new(i, j, image));
            pair.into_iter().collect()
        })
    }
    hold(relation::<2>, relation::<3>);
}

/// The second meets the images of the first as the first does, on both sides, and the first itself.
#[test]
fn a_particle_twice_has_its_contacts_twice_and_those_with_itself() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let n = bag.centres.len() as u32;
        let which = random.random_range(0..Some(n).filter(|&n| n > 0)?);
        let order: Vec<u32> = (0..n).chain([which]).collect();
        let of = move |pair: ImagePair| {
            let ImagePair { i, j, image } = pair;
            let mut pairs = vec![pair];
            match (i == which, j == which) {
                (true, true) => pairs.extend([
                    ImagePair::new(n, n, image),
                    ImagePair::new(which, n, image),
                    ImagePair::new(n, which, image),
                ]),
                (true, false) => pairs.push(ImagePair::new(n, j, image)),
                (false, true) => pairs.push(ImagePair::new(i, n, image)),
                (false, false) => {}
            }
            pairs
        };
        let with_itself = ImagePair::new(which, n, [0; 3]);
        let all = move |pairs: Vec<ImagePair>| {
            pairs.into_iter().flat_map(of).chain([with_itself]).collect()
        };
        Some((chosen(bag, &order), Box::new(all)))
    }
    hold(relation::<2>, relation::<3>);
}

#[test]
fn larger_radii_lose_no_contact() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let most = largest(bag);
        let mut larger =
            |r: f64| [r, r.next_up(), 1.5 * r].map(|r| r.min(most))[random.random_range(0..3)];
        let n = bag.centres.len();
        let radii = match &bag.radii {
            Radii::Uniform(r) => vec![*r; n],
            Radii::Each(radii) => radii.iter().map(|&r| larger(r)).collect(),
        };
        one(Bag { radii: Radii::Each(radii.into()), ..bag.clone() }, |pair| pair)
    }
    hold_to(Held::Superset, relation::<2>, relation::<3>);
}

#[test]
fn powers_of_two_scale_box_and_particles() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let scale = 2f64.powi(random.random_range(-40..=40));
        let mut after = bag.clone();
        after.centres.as_flattened_mut().iter_mut().for_each(|x| *x *= scale);
        after.vectors.as_flattened_mut().iter_mut().for_each(|x| *x *= scale);
        after.origin.iter_mut().for_each(|x| *x *= scale);
        after.radii = match &bag.radii {
            Radii::Uniform(r) => Radii::Uniform(r * scale),
            Radii::Each(radii) => Radii::Each(radii.iter().map(|r| r * scale).collect()),
        };
        one(after, |pair| pair)
    }
    hold(relation::<2>, relation::<3>);
}

#[test]
fn a_mirror_changes_nothing() {
    fn relation<const D: usize>(bag: &Bag<D>, random: &mut ChaCha8Rng) -> Change<D> {
        let axis = random.random_range(0..D);
        let mut after = bag.clone();
        after.centres.iter_mut().for_each(|x| x[axis] = -x[axis]);
        after.vectors.iter_mut().for_each(|x| x[axis] = -x[axis]);
        after.origin[axis] = -after.origin[axis];
        one(after, |pair| pair)
    }
    hold(relation::<2>, relation::<3>);
}
