//! The pass over a list: finds the listed pairs that touch in this frame.
//!
//! Sixteen pairs are tested at a time, without branches, because branches would be unpredictable.
//! The `answer` decides the pairs that positions in f32 leave open.

use super::answer::PairReceiver;
use contactbench_ground::filter::Near;
use contactbench_ground::wide::{Kernel, LANES, Spot, Wide};

const BLOCK: usize = 128;

/// Tests listed pairs and passes the pairs that touch to `answer`.
pub(super) struct Pass<'a, R, A> {
    pub spots: &'a [Spot],
    /// Listed pairs, numbered by places.
    pub listed: &'a [[u32; 2]],
    pub reach: R,
    pub answer: &'a mut A,
}

pub(super) trait Reach {
    /// Returns limits for the squared distances of sixteen pairs: [`within`] and [`beyond`].
    fn bounds<W: Wide>(&self, w: W, places: &[[u32; 2]; LANES]) -> [W::Floats; 2];
}

/// For equal radii: one pair of limits serves all pairs.
pub(super) struct Same(pub Near);

impl Reach for Same {
    #[inline(always)]
    fn bounds<W: Wide>(&self, w: W, _: &[[u32; 2]; LANES]) -> [W::Floats; 2] {
        [w.all(within(self.0.inner)), w.all(beyond(self.0.outer))]
    }
}

/// For individual radii: limits for each pair.
pub(super) struct Each<'a, F> {
    pub placed: &'a [f64],
    /// Returns the limits for a given sum of radii.
    pub near: F,
}

impl<F: Fn(f64) -> Near> Reach for Each<'_, F> {
    #[inline(always)]
    fn bounds<W: Wide>(&self, w: W, places: &[[u32; 2]; LANES]) -> [W::Floats; 2] {
        let (mut inner, mut outer) = ([0.0; LANES], [0.0; LANES]);
        for (k, &[a, b]) in places.iter().enumerate() {
            let near = (self.near)(self.placed[a as usize] + self.placed[b as usize]);
            (inner[k], outer[k]) = (within(near.inner), beyond(near.outer));
        }
        [w.load(&inner), w.load(&outer)]
    }
}

/// Returns x such that exactly the f32 numbers up to `inner` are at most x.
#[inline(always)]
fn within(inner: f64) -> f32 {
    let near = inner as f32;
    if f64::from(near) > inner { near.next_down() } else { near }
}

/// Returns x such that exactly the f32 numbers above `outer` are at least x; NaN if `outer` is
/// infinite, because no number is above it.
#[inline(always)]
fn beyond(outer: f64) -> f32 {
    if outer < f64::INFINITY { within(outer).next_up() } else { f32::NAN }
}

impl<R: Reach, A: PairReceiver> Kernel for Pass<'_, R, A> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self, w: W) {
        let Pass { spots, listed, reach, answer } = self;
        let mut touching = [[0; 2]; BLOCK + LANES];
        for block in listed.chunks(BLOCK) {
            let mut len = 0;
            let (vectors, rest) = block.as_chunks::<LANES>();
            for places in vectors {
                len += look::<W, R, A>(w, spots, places, ALL, &reach, &mut touching[len..], answer);
            }
            if let Some(&first) = rest.first() {
                let (mut places, mask) = ([first; LANES], ALL >> (LANES - rest.len()));
                places[..rest.len()].copy_from_slice(rest);
                let to = &mut touching[len..];
                len += look::<W, R, A>(w, spots, &places, mask, &reach, to, answer);
            }
            answer.take(&touching[..len]);
        }
    }
}

const ALL: u32 = (1 << LANES) - 1;

/// Writes the pairs of `mask` that certainly touch to the front of `to` and returns their number.
/// The `answer` decides pairs that positions in f32 leave open.
#[inline(always)]
fn look<W: Wide, R: Reach, A: PairReceiver>(
    w: W,
    spots: &[Spot],
    places: &[[u32; 2]; LANES],
    mask: u32,
    reach: &R,
    to: &mut [[u32; 2]],
    answer: &mut A,
) -> usize {
    let (squares, numbers) = w.squares(spots, places);
    let pairs = if A::BY_PLACE { w.load_pairs(places) } else { numbers };
    let [inner, outer] = reach.bounds(w, places);
    let (touch, apart) = (w.at_most(squares, inner) & mask, w.at_most(outer, squares));
    // The buffer is longer than a block by one vector, so this never fails.
    let Some(to) = to.first_chunk_mut() else { unreachable!() };
    w.pack_pairs(pairs, touch, to);
    let open = mask & !(touch | apart);
    if open != 0 {
        let mut left = [[0; 2]; LANES];
        w.pack_pairs(pairs, open, &mut left);
        decide(left.get(..open.count_ones() as usize).unwrap_or(&left), answer);
    }
    touch.count_ones() as usize
}

#[cold]
#[inline(never)]
fn decide(pairs: &[[u32; 2]], answer: &mut impl PairReceiver) {
    pairs.iter().for_each(|&pair| answer.decide(pair));
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_ground::wide::Level;

    /// Tests squares at, next to and far from limits of all sizes.
    #[test]
    fn limits_in_f32_agree_with_limits_in_f64() {
        let scales = [
            -1e-60,
            f64::NEG_INFINITY,
            1.0,
            1e-30,
            1e-44,
            1e-46,
            1e30,
            3.4e38,
            1e39,
            f64::INFINITY,
            f64::NAN,
        ];
        for scale in scales {
            for bound in [-1.0, 0.0, scale, 0.1 * scale, 0.7 * scale.next_down(), scale.next_up()] {
                let near = bound as f32;
                let squares = [0.0, near, near.next_up(), near.next_down(), 1.0, f32::MAX];
                for square in squares.into_iter().chain([f32::INFINITY, f32::NAN]) {
                    let wide = f64::from(square);
                    assert_eq!(square <= within(bound), wide <= bound, "{square} {bound}");
                    assert_eq!(beyond(bound) <= square, wide > bound, "{square} {bound}");
                }
            }
        }
    }

    #[derive(Default)]
    struct Heard<const BY_PLACE: bool>(Vec<[u32; 2]>, Vec<[u32; 2]>);

    impl<const BY_PLACE: bool> PairReceiver for Heard<BY_PLACE> {
        const BY_PLACE: bool = BY_PLACE;
        fn take(&mut self, pairs: &[[u32; 2]]) {
            self.0.extend(pairs);
        }
        fn decide(&mut self, pair: [u32; 2]) {
            self.1.push(pair);
        }
    }

    fn heard<const BY_PLACE: bool>(
        level: Level,
        spots: &[Spot],
        listed: &[[u32; 2]],
        reach: impl Reach,
    ) -> [Vec<[u32; 2]>; 2] {
        let mut answer = Heard::<BY_PLACE>::default();
        level.run(Pass { spots, listed, reach, answer: &mut answer });
        let mut all = [answer.0, answer.1];
        all.iter_mut().for_each(|pairs| pairs.sort_unstable());
        all
    }

    /// Tests lists of all lengths, some with infinite coordinates, whose distances are NaN.
    #[test]
    fn every_level_agrees_with_single_pairs() {
        let spots: Vec<Spot> = (0..97u32)
            .map(|k| Spot {
                at: [k % 5, k / 5 % 5, k / 25].map(|x| match k {
                    13 | 31 => f32::INFINITY,
                    _ => x as f32 * 0.75,
                }),
                id: 1000 - k,
            })
            .collect();
        let placed: Vec<f64> = (0..97).map(|k| 0.3 + 0.05 * f64::from(k % 7)).collect();
        let near = |sum: f64| Near { inner: sum * sum * 0.9, outer: sum * sum * 1.4 };
        let at = |k: u32| (k.wrapping_mul(0x9e37_79b9) >> 8) % 97;
        for level in Level::all() {
            for length in 0..300 {
                let listed: Vec<[u32; 2]> = (0..length).map(|k| [at(k), at(k + 500)]).collect();
                for own in [false, true] {
                    let expected = |by_place: bool| {
                        let mut all = [Vec::new(), Vec::new()];
                        for &[a, b] in &listed {
                            let sum =
                                if own { placed[a as usize] + placed[b as usize] } else { 1.0 };
                            let [p, q] = [&spots[a as usize], &spots[b as usize]];
                            let name = if by_place { [a, b] } else { [p.id, q.id] };
                            match near(sum).verdict(f64::from(p.square(q))) {
                                Some(true) => all[0].push(name),
                                Some(false) => {}
                                None => all[1].push(name),
                            }
                        }
                        all.iter_mut().for_each(|pairs| pairs.sort_unstable());
                        all
                    };
                    let found = if own {
                        let each = || Each { placed: &placed, near };
                        (
                            heard::<false>(level, &spots, &listed, each()),
                            heard::<true>(level, &spots, &listed, each()),
                        )
                    } else {
                        let same = || Same(near(1.0));
                        (
                            heard::<false>(level, &spots, &listed, same()),
                            heard::<true>(level, &spots, &listed, same()),
                        )
                    };
                    let name = level.name();
                    assert_eq!(found, (expected(false), expected(true)), "{name} {length} {own}");
                }
            }
        }
    }
}
