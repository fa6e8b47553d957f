//! The metamorphic relations: each change of a scene, and why its effect is exact.

use contactbench::scene::{Radii, Scene, array};
use contactbench_ground::contact::Arithmetic;
use nalgebra::Point;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::scenes::{kept, map};
use super::{Claim, Flat, Pairs};

pub struct Given<'a, const D: usize> {
    pub scene: &'a Flat<D>,
    pub arithmetic: Arithmetic,
    pub random: &'a mut ChaCha8Rng,
}

/// A changed scene; `None` where the change of pairs is not exact.
type Change<const D: usize> = Option<Claim<D>>;

impl<const D: usize> Given<'_, D> {
    fn n(&self) -> u32 {
        self.scene.len() as u32
    }

    fn same(self, after: Flat<D>) -> Change<D> {
        self.becomes(after, Pairs::clone)
    }

    fn becomes(self, after: Flat<D>, expected: impl Fn(&Pairs) -> Pairs + 'static) -> Change<D> {
        let (before, expected) = (self.scene.clone(), Box::new(expected));
        Some(Claim { before, after, expected, superset: false })
    }

    pub fn permutation(self) -> Change<D> {
        let mut order: Vec<u32> = (0..self.n()).collect();
        order.shuffle(self.random);
        let mut place = vec![0; order.len()];
        order.iter().zip(0..).for_each(|(&old, new)| place[old as usize] = new);
        let after = self.scene.reordered(&order);
        self.becomes(after, move |pairs| {
            pairs.iter().map(|pair| pair.map(|k| place[k as usize])).collect()
        })
    }

    pub fn radius_each(self) -> Change<D> {
        let (r, centres) = (self.scene.largest_radius(), self.scene.centres().to_vec());
        let one = Scene::new(centres.clone(), Radii::Uniform(r)).unwrap();
        let each = Radii::Each(vec![r; centres.len()].into());
        Given { scene: &one, ..self }.same(Scene::new(centres, each).unwrap())
    }

    pub fn removal(self) -> Change<D> {
        let share = [0.02, 0.5][self.random.random_range(0..2)];
        let kept: Vec<u32> = (0..self.n()).filter(|_| !self.random.random_bool(share)).collect();
        let after = self.scene.reordered(&kept);
        self.becomes(after, move |pairs| {
            let new = |k: &u32| kept.binary_search(k).ok().map(|k| k as u32);
            pairs.iter().filter_map(|[i, j]| Some([new(i)?, new(j)?])).collect()
        })
    }

    pub fn twice(self) -> Change<D> {
        let n = self.n();
        let which = (n > 0).then(|| self.random.random_range(0..n))?;
        let order: Vec<u32> = (0..n).chain([which]).collect();
        let after = self.scene.reordered(&order);
        // Two points at one place are a tie.
        let closed = self.arithmetic != Arithmetic::ExactOpen;
        let itself = closed || self.scene.radius(which as usize) > 0.0;
        self.becomes(after, move |pairs| {
            let partner = |&[i, j]: &[u32; 2]| match which {
                _ if i == which => Some(j),
                _ => (j == which).then_some(i),
            };
            let more =
                pairs.iter().filter_map(partner).chain(itself.then_some(which)).map(|k| [k, n]);
            pairs.iter().copied().chain(more).collect()
        })
    }

    pub fn growth(self) -> Change<D> {
        let scene = self.scene;
        let mut larger = |r: f64| {
            let all = [r, r.next_up(), 1.5 * r, 4.0 * r, r + 0.1];
            all[self.random.random_range(0..5)]
        };
        let radii = (0..scene.len()).map(|k| larger(scene.radius(k))).collect();
        let after = Scene::new(scene.centres().to_vec(), Radii::Each(radii)).unwrap();
        self.same(after).map(|claim| Claim { superset: true, ..claim })
    }

    pub fn scaling(self) -> Change<D> {
        let (low, high) = powers(self.scene, self.arithmetic)?;
        let k = [low, high, self.random.random_range(low..=high)][self.random.random_range(0..3)];
        let scene = self.scene;
        let scaled = |k: i32| map(scene, |c| c.map(|x| libm::ldexp(x, k)), |r| libm::ldexp(r, k));
        // The scene before the change has the scale nearest to 1 without under- or overflow.
        Given { scene: &scaled(0.clamp(low, high))?, ..self }.same(scaled(k)?)
    }

    pub fn mirror(self) -> Change<D> {
        let axis = self.random.random_range(0..D);
        let turned = |mut c: [f64; D]| {
            c[axis] = -c[axis];
            c
        };
        let after = map(self.scene, turned, |r| r)?;
        self.same(after)
    }

    pub fn exchange(self) -> Change<D> {
        let exchanged = |mut c: [f64; D]| {
            c.swap(0, 1);
            c
        };
        let after = map(self.scene, exchanged, |r| r)?;
        self.same(after)
    }

    pub fn turned(self) -> Change<D> {
        let mut axes: [usize; D] = std::array::from_fn(|k| k);
        axes.shuffle(self.random);
        let after = map(self.scene, |c| axes.map(|k| c[k]), |r| r)?;
        self.same(after)
    }

    pub fn translation(self) -> Change<D> {
        // Shifted coordinates fit the 24 bits of f32.
        let bits = if self.arithmetic == Arithmetic::F32 { 22 } else { 40 };
        let offset: [f64; D] = std::array::from_fn(|_| {
            self.random.random_range(-(1i64 << bits)..1 << bits) as f64 / 256.0
        });
        let before = dyadic(self.scene);
        let after = map(&before, |c| std::array::from_fn(|k| c[k] + offset[k]), |r| r)?;
        Given { scene: &before, ..self }.same(after)
    }

    pub fn copy(self) -> Change<D> {
        let (axis, n) = (self.random.random_range(0..D), self.n());
        let before = dyadic(self.scene);
        if 2.0 * before.largest_radius() > 8000.0 {
            return None;
        }
        let all: Vec<u32> = (0..n).chain(0..n).collect();
        let copied = before.reordered(&all);
        let mut centres: Vec<Point<f64, D>> = copied.centres().to_vec();
        centres[n as usize..].iter_mut().for_each(|at| at[axis] -= 16384.0);
        let after = Scene::new(centres, copied.radii().clone()).unwrap();
        Given { scene: &before, ..self }.becomes(after, move |pairs| {
            pairs.iter().flat_map(|&[i, j]| [[i, j], [i + n, j + n]]).collect()
        })
    }
}

/// Rounds coordinates to multiples of 2^-8 with an absolute value of at most 2^12.
fn dyadic<const D: usize>(scene: &Flat<D>) -> Flat<D> {
    let dyadic = |x: f64| (x * 256.0).round().clamp(-1048576.0, 1048576.0) / 256.0;
    map(scene, |c| c.map(dyadic), |r| r).unwrap()
}

/// Returns the least and the largest k for which the scene times 2^k has the same pairs.
fn powers<const D: usize>(scene: &Flat<D>, arithmetic: Arithmetic) -> Option<(i32, i32)> {
    let exponent = |x: f64| libm::frexp(x).1 - 1;
    let radii = (0..scene.len()).map(|k| scene.radius(k)).chain([scene.largest_radius()]);
    let coordinates = scene.centres().iter().flat_map(array).map(|x| x.abs());
    let own: Vec<f64> = coordinates.chain(radii).filter(|&x| x > 0.0).collect();
    let lowest_bit = |&x: &f64| exponent(x) - 52 + (x.to_bits() | 1 << 52).trailing_zeros() as i32;
    let (last_bit, first_bit) =
        (own.iter().map(lowest_bit).min()?, own.iter().map(|&x| exponent(x)).max()?);
    let (least_square, most_square): (i32, i32) = match arithmetic {
        // Scaling must neither move a bit below 2^-1074 nor exceed the largest number.
        Arithmetic::Exact => return Some((-1074 - last_bit, 1023 - first_bit)),
        Arithmetic::F32 => (-126, 127),
        _ => (-1022, 1023),
    };
    // Squares of differences and sums must be normal numbers, and sums of squares finite.
    let kept = kept(scene, arithmetic)?;
    let mut compared = vec![2.0 * kept.largest_radius()];
    for (i, a) in kept.centres().iter().enumerate() {
        for (j, b) in kept.centres()[..i].iter().enumerate() {
            compared.extend((0..D).map(|k| (a[k] - b[k]).abs()));
            compared.push(kept.radius(i) + kept.radius(j));
        }
    }
    let exponents = || compared.iter().filter(|&&x| x > 0.0).map(|&x| exponent(x));
    let lows = exponents().map(|e| (least_square + 1).div_euclid(2) - e);
    let low = lows.chain(own.iter().map(|&x| least_square - exponent(x))).max()?;
    let highs = exponents().map(|e| (most_square - 2) / 2 - 1 - e);
    let high = highs.chain(own.iter().map(|&x| most_square - 1 - exponent(x))).min()?;
    (low <= high).then_some((low, high))
}
