//! The relations: how the scene is changed, and why that is exact.

use contactbench::contact::Arithmetic;
use contactbench::scene::{AnyScene, Scene};
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::scenes::{Bag, Size};
use super::{Claim, Pairs};

pub fn permutation<const D: usize>(
    bag: &Bag<D>,
    _: Arithmetic,
    random: &mut ChaCha8Rng,
) -> Option<Claim<D>> {
    let mut order: Vec<u32> = (0..bag.len() as u32).collect();
    order.shuffle(random);
    let mut place = vec![0; order.len()];
    order.iter().zip(0..).for_each(|(&old, new)| place[old as usize] = new);
    let renamed =
        move |pairs: &Pairs| pairs.iter().map(|pair| pair.map(|k| place[k as usize])).collect();
    Some(Claim { expected: Box::new(renamed), ..Claim::same(bag.clone(), bag.chosen(&order)) })
}

pub fn radius_each<const D: usize>(
    bag: &Bag<D>,
    _: Arithmetic,
    _: &mut ChaCha8Rng,
) -> Option<Claim<D>> {
    let before = Bag { radii: Size::One(bag.largest()), ..bag.clone() };
    let after = Bag { radii: Size::Each(vec![bag.largest(); bag.len()]), ..bag.clone() };
    Some(Claim::same(before, after))
}

pub fn removal<const D: usize>(
    bag: &Bag<D>,
    arithmetic: Arithmetic,
    random: &mut ChaCha8Rng,
) -> Option<Claim<D>> {
    let share = [0.02, 0.5][random.random_range(0..2)];
    let kept: Vec<u32> = (0..bag.len() as u32).filter(|_| !random.random_bool(share)).collect();
    let after = bag.chosen(&kept);
    // The edge of the cells, in which coordinates are rounded, is made from the largest particle,
    // or the extent of points.
    if arithmetic == Arithmetic::F32Cell
        && (after.largest() != bag.largest() || bag.largest() == 0.0)
    {
        return None;
    }
    let rest = move |pairs: &Pairs| {
        let new = |k: &u32| kept.binary_search(k).ok().map(|k| k as u32);
        pairs.iter().filter_map(|[i, j]| Some([new(i)?, new(j)?])).collect()
    };
    Some(Claim { expected: Box::new(rest), ..Claim::same(bag.clone(), after) })
}

pub fn twice<const D: usize>(
    bag: &Bag<D>,
    _: Arithmetic,
    random: &mut ChaCha8Rng,
) -> Option<Claim<D>> {
    if bag.len() == 0 {
        return None;
    }
    let (n, which) = (bag.len() as u32, random.random_range(0..bag.len() as u32));
    let order: Vec<u32> = (0..n).chain([which]).collect();
    let more = move |pairs: &Pairs| {
        let partner = |&[i, j]: &[u32; 2]| (i == which).then_some(j).or((j == which).then_some(i));
        pairs
            .iter()
            .copied()
            .chain(pairs.iter().filter_map(partner).chain([which]).map(|k| [k, n]))
            .collect()
    };
    Some(Claim { expected: Box::new(more), ..Claim::same(bag.clone(), bag.chosen(&order)) })
}

pub fn growth<const D: usize>(
    bag: &Bag<D>,
    arithmetic: Arithmetic,
    random: &mut ChaCha8Rng,
) -> Option<Claim<D>> {
    let most = if arithmetic == Arithmetic::F32Cell { bag.largest() } else { f64::INFINITY };
    let radii = (0..bag.len()).map(|k| {
        let r = bag.radius(k);
        [r, r.next_up(), 1.5 * r, 4.0 * r, r + 0.1][random.random_range(0..5)].min(most)
    });
    let after = Bag { radii: Size::Each(radii.collect()), ..bag.clone() };
    Some(Claim { superset: true, ..Claim::same(bag.clone(), after) })
}

pub fn scaling<const D: usize>(
    bag: &Bag<D>,
    arithmetic: Arithmetic,
    random: &mut ChaCha8Rng,
) -> Option<Claim<D>>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let (low, high) = powers(bag, arithmetic)?;
    let k = [low, high, random.random_range(low..=high)][random.random_range(0..3)];
    let scaled = |k: i32| bag.map(|c| c.map(|x| libm::ldexp(x, k)), |r| libm::ldexp(r, k));
    // The scale nearest to the given one at which nothing under- or overflows, either.
    Some(Claim::same(scaled(0.clamp(low, high)), scaled(k)))
}

/// The least and the largest k for which the scene times 2^k has the same pairs.
fn powers<const D: usize>(bag: &Bag<D>, arithmetic: Arithmetic) -> Option<(i32, i32)>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let exponent = |x: f64| libm::frexp(x).1 - 1;
    let sizes = |bag: &Bag<D>| -> Vec<f64> {
        let radii = (0..bag.len()).map(|k| bag.radius(k)).chain([bag.largest()]);
        bag.centres.iter().flatten().map(|x| x.abs()).chain(radii).filter(|&x| x > 0.0).collect()
    };
    let own = sizes(bag);
    let lowest_bit = |&x: &f64| exponent(x) - 52 + (x.to_bits() | 1 << 52).trailing_zeros() as i32;
    let (last_bit, first_bit) =
        (own.iter().map(lowest_bit).min()?, own.iter().map(|&x| exponent(x)).max()?);
    let (least_square, most_square): (i32, i32) = match arithmetic {
        // No bit may be lost below 2^-1074 or above the largest number.
        Arithmetic::Exact => return Some((-1074 - last_bit, 1023 - first_bit)),
        // The edge of the cells must be a normal number, also where it is 2^-20 of the extent; then
        // the scenes are stored alike.
        Arithmetic::F32Cell => return Some((-990 - last_bit, 1021 - first_bit)),
        Arithmetic::F32 => (-126, 127),
        _ => (-1022, 1023),
    };
    // Squares of differences and of sums of radii must be normal numbers, and the sums of squares
    // finite; so must what is stored.
    let kept = bag.kept(arithmetic)?;
    let mut compared = vec![2.0 * kept.largest()];
    for (i, a) in kept.centres.iter().enumerate() {
        for (j, b) in kept.centres[..i].iter().enumerate() {
            compared.extend((0..D).map(|k| (a[k] - b[k]).abs()));
            compared.push(kept.radius(i) + kept.radius(j));
        }
    }
    let exponents = || compared.iter().filter(|&&x| x > 0.0).map(|&x| exponent(x));
    let low = exponents()
        .map(|e| (least_square + 1).div_euclid(2) - e)
        .chain(own.iter().map(|&x| least_square - exponent(x)))
        .max()?;
    let high = exponents()
        .map(|e| (most_square - 2) / 2 - 1 - e)
        .chain(own.iter().map(|&x| most_square - 1 - exponent(x)))
        .min()?;
    (low <= high).then_some((low, high))
}

pub fn mirror<const D: usize>(
    bag: &Bag<D>,
    arithmetic: Arithmetic,
    random: &mut ChaCha8Rng,
) -> Option<Claim<D>>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let axis = random.random_range(0..D);
    let before = match arithmetic {
        // Half a step of an offset is rounded upwards, and so downwards in the mirror.
        Arithmetic::F32Cell if bag.largest() == 0.0 => return None,
        Arithmetic::F32Cell => bag.kept(arithmetic)?,
        _ => bag.clone(),
    };
    let after =
        before.map(|c| std::array::from_fn(|k| if k == axis { -c[k] } else { c[k] }), |r| r);
    Some(Claim::same(before, after))
}

pub fn exchange<const D: usize>(
    bag: &Bag<D>,
    _: Arithmetic,
    _: &mut ChaCha8Rng,
) -> Option<Claim<D>> {
    let exchanged = |mut c: [f64; D]| {
        c.swap(0, 1);
        c
    };
    Some(Claim::same(bag.clone(), bag.map(exchanged, |r| r)))
}

pub fn turned<const D: usize>(
    bag: &Bag<D>,
    _: Arithmetic,
    random: &mut ChaCha8Rng,
) -> Option<Claim<D>> {
    let mut axes: [usize; D] = std::array::from_fn(|k| k);
    axes.shuffle(random);
    Some(Claim::same(bag.clone(), bag.map(|c| axes.map(|k| c[k]), |r| r)))
}

/// The bag with coordinates that are multiples of 2^-8 of at most 2^12.
fn dyadic<const D: usize>(bag: &Bag<D>) -> Bag<D> {
    bag.map(|c| c.map(|x| (x * 256.0).round().clamp(-1048576.0, 1048576.0) / 256.0), |r| r)
}

pub fn translation<const D: usize>(
    bag: &Bag<D>,
    arithmetic: Arithmetic,
    random: &mut ChaCha8Rng,
) -> Option<Claim<D>> {
    // 24 bits hold the sums in f32. By cells, steps are of 2^-24 of a diameter.
    let bits = if arithmetic == Arithmetic::F32 { 22 } else { 40 };
    let offset: [f64; D] =
        std::array::from_fn(|_| (random.random_range(-(1i64 << bits)..1 << bits)) as f64 / 256.0);
    let before = dyadic(bag);
    let after = before.map(|c| std::array::from_fn(|k| c[k] + offset[k]), |r| r);
    Some(Claim::same(before, after))
}

pub fn copy<const D: usize>(
    bag: &Bag<D>,
    _: Arithmetic,
    random: &mut ChaCha8Rng,
) -> Option<Claim<D>> {
    let (axis, n) = (random.random_range(0..D), bag.len() as u32);
    let before = dyadic(bag);
    let far = before
        .map(|c| std::array::from_fn(|k| if k == axis { c[k] - 16384.0 } else { c[k] }), |r| r);
    if 2.0 * bag.largest() > 8000.0 {
        return None;
    }
    let order: Vec<u32> = (0..n).chain(0..n).collect();
    let mut after = before.chosen(&order);
    after.centres[n as usize..].copy_from_slice(&far.centres);
    let both =
        move |pairs: &Pairs| pairs.iter().flat_map(|&[i, j]| [[i, j], [i + n, j + n]]).collect();
    Some(Claim { expected: Box::new(both), ..Claim::same(before, after) })
}
