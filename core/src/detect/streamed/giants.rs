//! A few giants among bodies that are much smaller.
//!
//! Cells are as wide as the reach, so one body of ten times the radius of all others would put a
//! thousand of them into each cell. Where at most [`MOST`] bodies are [`GAP`] times larger than
//! every other, they are left out of the sweep, whose reach is then that of the others
//! ([`Bodies::class_reach`]), and each is tested against all bodies, which costs no more than going
//! over the scene once.

use crate::contact::{Bodies, Margin, Slack};
use crate::filter::Near;
use crate::probe::{Op, Probe};
use crate::scene::Real;
use crate::sink::Sink;

/// More are no exception.
const MOST: usize = 8;
/// Less of a difference costs the sweep less than the giants would.
const GAP: f64 = 3.0;

/// The particles that are left out of the sweep.
#[derive(Clone, Copy, Debug)]
pub struct Giants {
    /// Their numbers, ascending.
    ids: [u32; MOST],
    count: usize,
    /// The largest radius of the others, and whether it is that of all others.
    largest: f64,
    uniform: bool,
}

impl Giants {
    /// Those of a scene, if it has some and others beside them.
    pub fn of<T: Real, const D: usize>(bodies: &impl Bodies<T, D>) -> Option<Giants> {
        if bodies.uniform().is_some() || bodies.len() <= MOST {
            return None;
        }
        // The largest, in falling order, and the least.
        let mut top = [(f64::NEG_INFINITY, 0); MOST + 1];
        let mut least = f64::INFINITY;
        for id in 0..bodies.len() as u32 {
            let radius = bodies.radius(id);
            least = least.min(radius);
            if radius > top[MOST].0 {
                let place = top.partition_point(|known| known.0 >= radius);
                top.copy_within(place..MOST, place + 1);
                top[place] = (radius, id);
            }
        }
        let count = (1..=MOST).rev().find(|&k| top[k - 1].0 > GAP * top[k].0)?;
        let mut ids = [u32::MAX; MOST];
        ids.iter_mut().zip(&top[..count]).for_each(|(to, (_, id))| *to = *id);
        ids[..count].sort_unstable();
        let largest = top[count].0;
        Some(Giants { ids, count, largest, uniform: least == largest })
    }

    fn ids(&self) -> &[u32] {
        &self.ids[..self.count]
    }

    /// The number in the scene of what has this number among the others.
    #[inline(always)]
    fn number(&self, mut id: u32) -> u32 {
        for &giant in self.ids() {
            id += u32::from(id >= giant);
        }
        id
    }

    /// Tests each giant against all bodies, and the giants against each other once.
    pub fn test<T: Real, const D: usize, P: Probe>(
        &self,
        bodies: &impl Bodies<T, D>,
        probe: &mut P,
        sink: &mut dyn Sink,
    ) {
        let slack = bodies.slack();
        for &giant in self.ids() {
            let (centre, radius) = (bodies.position(giant), bodies.radius(giant));
            for id in (0..bodies.len() as u32).filter(|&id| id != giant) {
                let other = bodies.position(id);
                let mut square = 0.0;
                for k in 0..D {
                    square += (centre[k] - other[k]) * (centre[k] - other[k]);
                }
                let touching = match Near::new(radius + bodies.radius(id), slack).verdict(square) {
                    Some(touching) => {
                        probe.count(Op::ContactTest);
                        touching
                    }
                    None => bodies.touch(giant, id, probe),
                };
                if touching && !(id < giant && self.ids().contains(&id)) {
                    sink.contact(giant, id);
                }
            }
        }
    }
}

/// The bodies without the giants, numbered without them.
#[derive(Clone, Copy)]
pub struct Others<'a, B> {
    bodies: B,
    giants: &'a Giants,
}

impl<'a, B> Others<'a, B> {
    /// All but these.
    pub fn new(bodies: B, giants: &'a Giants) -> Others<'a, B> {
        Others { bodies, giants }
    }
}

impl<T: Real, B: Bodies<T, D>, const D: usize> Bodies<T, D> for Others<'_, B> {
    fn len(&self) -> usize {
        self.bodies.len() - self.giants.count
    }

    #[inline(always)]
    fn position(&self, i: u32) -> [f64; D] {
        self.bodies.position(self.giants.number(i))
    }

    #[inline(always)]
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool {
        self.bodies.touch(self.giants.number(i), self.giants.number(j), probe)
    }

    fn reach(&self) -> f64 {
        self.bodies.class_reach(self.giants.largest, self.giants.largest)
    }

    #[inline(always)]
    fn radius(&self, i: u32) -> f64 {
        self.bodies.radius(self.giants.number(i))
    }

    fn uniform(&self) -> Option<f64> {
        self.giants.uniform.then_some(self.giants.largest)
    }

    fn slack(&self) -> Slack {
        self.bodies.slack()
    }

    fn margin(&self) -> Margin {
        self.bodies.margin()
    }
}

/// Hands pairs of the others on by their numbers in the scene.
pub struct Renumbered<'a> {
    giants: &'a Giants,
    sink: &'a mut dyn Sink,
}

impl<'a> Renumbered<'a> {
    /// To this sink.
    pub fn new(giants: &'a Giants, sink: &'a mut dyn Sink) -> Renumbered<'a> {
        Renumbered { giants, sink }
    }
}

impl Sink for Renumbered<'_> {
    fn contact(&mut self, i: u32, j: u32) {
        self.sink.contact(self.giants.number(i), self.giants.number(j));
    }

    fn contacts(&mut self, pairs: &[[u32; 2]]) {
        let mut numbered = [[0; 2]; 128];
        for pairs in pairs.chunks(numbered.len()) {
            let numbered = &mut numbered[..pairs.len()];
            numbered.copy_from_slice(pairs);
            // One giant after the other, so that the loop over the pairs has no branch.
            for &giant in self.giants.ids() {
                for pair in numbered.as_flattened_mut() {
                    *pair += u32::from(*pair >= giant);
                }
            }
            self.sink.contacts(numbered);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::contact::{Arithmetic, Test, any_bodies};
    use crate::detect::{Options, table};
    use crate::oracle;
    use crate::probe::Tally;
    use crate::scene::{AnyScene, Radii, Scene};
    use crate::sink::Digest;

    /// Dust in a box, and giants here and there among it, in number and in place.
    fn scene<const D: usize>(giants: &[f64], dust: impl Fn(u32) -> f64) -> Scene<'static, f64, D> {
        let mut random = ChaCha8Rng::seed_from_u64(giants.len() as u64);
        let mut radii: Vec<f64> = (0..2000).map(dust).collect();
        for &giant in giants {
            radii.insert(random.random_range(0..=radii.len()), giant);
        }
        let centre = |_| Point::from(std::array::from_fn(|_| 40.0 * random.random::<f64>()));
        Scene::new((0..radii.len()).map(centre).collect::<Vec<_>>(), Radii::Each(radii.into()))
            .unwrap()
    }

    #[test]
    fn giants_are_those_far_above_all_others() {
        let of = |giants: &[f64], dust: fn(u32) -> f64| {
            let scene = scene::<2>(giants, dust);
            let found = Giants::of(&any_bodies(&scene, Test::Exact).unwrap());
            found.map(|found| (found.count, found.largest, found.uniform))
        };
        let equal: fn(u32) -> f64 = |_| 0.5;
        let mixed: fn(u32) -> f64 = |k| 0.3 + 0.1 * f64::from(k % 3);
        assert_eq!(of(&[], equal), None);
        assert_eq!(of(&[1.4], equal), None);
        assert_eq!(of(&[2.0], equal), Some((1, 0.5, true)));
        assert_eq!(of(&[5.0, 2.0, 100.0], mixed), Some((3, 0.5, false)));
        assert_eq!(of(&[9.0; 8], equal), Some((8, 0.5, true)));
        assert_eq!(of(&[9.0; 9], equal), None);
        assert_eq!(of(&[3.0], |_| 0.0), Some((1, 0.0, true)));
    }

    #[test]
    fn the_others_keep_their_numbers() {
        let giants =
            Giants { ids: [0, 1, 4, 9, 0, 0, 0, 0], count: 4, largest: 1.0, uniform: true };
        assert_eq!([0, 1, 2, 5, 6, 7].map(|id| giants.number(id)), [2, 3, 5, 8, 10, 11]);
        let mut pairs = Vec::new();
        let all: Vec<[u32; 2]> = (0..300).map(|k| [k, k + 1]).collect();
        Renumbered::new(&giants, &mut pairs).contacts(&all);
        let expected = all.iter().map(|pair| pair.map(|id| giants.number(id)));
        assert_eq!(pairs, expected.collect::<Vec<_>>());
    }

    #[test]
    fn giants_lose_nothing() {
        let mut contacts = 0;
        let dusts: [fn(u32) -> f64; 3] = [|_| 0.25, |k| 0.1 * f64::from(k % 4), |_| 0.0];
        for giants in [&[8.0][..], &[30.0, 2.5], &[4.0; 8], &[100.0, 3.0, 3.0, 50.0]] {
            for dust in dusts {
                let scenes: [AnyScene<'_>; 2] =
                    [scene::<2>(giants, dust).into(), scene::<3>(giants, dust).into()];
                for scene in scenes {
                    for arithmetic in Arithmetic::ALL {
                        let truth = oracle::truth(&scene, arithmetic).unwrap();
                        let stored = scene.stored(arithmetic).unwrap();
                        for (form, threads) in
                            [("auto", 1), ("auto", 2), ("dense", 1), ("sparse", 1)]
                        {
                            let spec = table::parse(&format!("streamed-nbs:form={form}")).unwrap();
                            let mut pairs = Vec::new();
                            spec.make(Options { threads, ..Options::default() })
                                .list(&stored, arithmetic.test(), &mut pairs)
                                .unwrap();
                            let found = Digest::from_pairs(&pairs);
                            assert_eq!(found, truth.digest, "{giants:?} {spec} {arithmetic:?}");
                            contacts += found.contacts;
                        }
                    }
                }
            }
        }
        assert!(contacts > 100_000, "{contacts}");
    }

    /// What a giant costs is a test of each body, and the sweep is that of the scene without it.
    #[test]
    fn a_giant_costs_one_test_of_each_body() {
        let tests = |giants: &[f64]| {
            let scene: AnyScene<'_> = scene::<3>(giants, |_| 0.5).into();
            let mut tally = Tally::default();
            table::find("streamed-nbs")
                .unwrap()
                .make(Options::default())
                .count(&scene, Test::Exact, &mut tally, &mut Digest::default())
                .unwrap();
            tally.get(Op::ContactTest) as f64
        };
        let (without, with) = (tests(&[]), tests(&[300.0]));
        assert!((with - without - 2000.0).abs() < 0.1 * without, "{without} {with}");
    }
}
