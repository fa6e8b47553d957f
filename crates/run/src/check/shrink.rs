//! Finds the simplest scene on which an error still occurs: few particles, few significant bits.
//!
//! Simplifications are tried in passes, until none helps or the effort is spent. Particles are
//! removed in ever smaller groups (Zeller and Hildebrandt 2002, doi:10.1109/32.988498, without
//! complements). All particles get one radius, lose an axis, move towards the origin, are scaled by
//! a power of two, or are rounded. Each number becomes 0 or 1, or is rounded to ever more bits.
//!
//! A simplification is kept if the scene still fails and its cost falls. The cost compares, in this
//! order: particles, more than one radius, significant bits, distance from 1 in powers of two,
//! minus signs. Because the cost always falls, the passes end.
//!
//! Translations and scalings are tried only if they change no distance by rounding.

use std::time::{Duration, Instant};

use crate::check::numbers::{Numbers, bits, difference, rounded, scaled};
use contactbench_ground::scene::AnyScene;

#[derive(Clone, Copy, Debug)]
pub struct Effort {
    pub trials: u32,
    pub time: Duration,
}

const BITS: [u32; 11] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 40];

const ORIGINS: usize = 16;

type Cost = (usize, bool, u64, u64, u64);

struct Shrinker<F> {
    best: Numbers,
    cost: Cost,
    fails: F,
    trials: u32,
    until: Instant,
}

/// Returns the simplest scene on which `fails` holds, or `scene` itself if it does not hold there.
pub fn shrink(
    scene: &AnyScene<'static>,
    effort: Effort,
    mut fails: impl FnMut(&AnyScene<'static>) -> bool,
) -> AnyScene<'static> {
    let best = Numbers::new(scene);
    if !best.scene().is_ok_and(|scene| fails(&scene)) {
        return scene.clone();
    }
    let until = Instant::now() + effort.time;
    let mut shrinker = Shrinker { cost: cost(&best), best, fails, trials: effort.trials, until };
    loop {
        let before = shrinker.cost;
        shrinker.take_particles();
        shrinker.change_all();
        shrinker.change_each();
        if shrinker.cost == before || shrinker.spent() {
            return shrinker.best.scene().unwrap_or_else(|_| scene.clone());
        }
    }
}

fn cost(numbers: &Numbers) -> Cost {
    let sum = |of: fn(f64) -> u64| numbers.values.iter().map(|&x| of(x)).sum();
    let places =
        |x: f64| if x == 0.0 { 0 } else { 1 + u64::from((libm::frexp(x).1 - 1).unsigned_abs()) };
    (
        numbers.len(),
        numbers.mixed(),
        sum(|x| bits(x).into()),
        sum(places),
        sum(|x| x.is_sign_negative().into()),
    )
}

impl<F: FnMut(&AnyScene<'static>) -> bool> Shrinker<F> {
    fn spent(&self) -> bool {
        self.trials == 0 || Instant::now() >= self.until
    }

    fn keeps(&mut self, candidate: Numbers) -> bool {
        let cost = cost(&candidate);
        if cost >= self.cost || self.spent() {
            return false;
        }
        let Ok(scene) = candidate.scene() else { return false };
        self.trials -= 1;
        if !(self.fails)(&scene) {
            return false;
        }
        (self.best, self.cost) = (candidate, cost);
        true
    }

    /// Applies `change` to each number; nothing is kept if `change` returns `None` for any of them.
    fn keeps_changed(&mut self, change: impl Fn(usize, f64) -> Option<f64>) -> bool {
        let Numbers { dim, ref values } = self.best;
        let values: Option<Vec<f64>> =
            values.iter().enumerate().map(|(k, &x)| change(k, x)).collect();
        values.is_some_and(|values| self.keeps(Numbers { dim, values }))
    }

    fn take_particles(&mut self) {
        let mut chunk = self.best.len().div_ceil(2);
        while chunk > 0 {
            let mut start = 0;
            while start < self.best.len() && !self.spent() {
                let mut fewer = self.best.clone();
                let stride = fewer.stride();
                fewer
                    .values
                    .drain(start * stride..((start + chunk) * stride).min(fewer.values.len()));
                if !self.keeps(fewer) {
                    start += chunk;
                }
            }
            chunk /= 2;
        }
    }

    fn change_all(&mut self) {
        let (dim, stride) = (self.best.dim, self.best.stride());
        let extreme =
            |pick: fn(f64, f64) -> f64| move |numbers: &Numbers| numbers.radii().reduce(pick);
        let (largest, smallest) = (extreme(f64::max)(&self.best), extreme(f64::min)(&self.best));
        for r in [Some(1.0), largest, smallest].into_iter().flatten() {
            self.keeps_changed(|k, x| Some(if k % stride == dim { r } else { x }));
        }
        for axis in 0..dim {
            if !self.keeps_changed(|k, x| Some(if k % stride == axis { 0.0 } else { x })) {
                for origin in 0..self.best.len().min(ORIGINS) {
                    let from = self.best.values[origin * stride + axis];
                    self.keeps_changed(|k, x| {
                        if k % stride == axis { difference(x, from) } else { Some(x) }
                    });
                }
            }
        }
        // Scales all numbers so that the largest radius, the largest number or the smallest number
        // lies between 1/2 and 2.
        let sizes = || self.best.values.iter().map(|x| x.abs()).filter(|&x| x > 0.0);
        let units = [largest, sizes().reduce(f64::max), sizes().reduce(f64::min)];
        for unit in units.into_iter().flatten() {
            let exponent = 1 - libm::frexp(unit).1;
            self.keeps_changed(|_, x| scaled(x, exponent));
            self.keeps_changed(|_, x| scaled(x, exponent - 1));
        }
        for count in BITS {
            if self.keeps_changed(|_, x| Some(rounded(x, count))) {
                break;
            }
        }
    }

    fn change_each(&mut self) {
        for k in 0..self.best.values.len() {
            let x = self.best.values[k];
            for simpler in [0.0, 1.0].into_iter().chain(BITS.map(|count| rounded(x, count))) {
                if self.spent() {
                    return;
                }
                let mut candidate = self.best.clone();
                candidate.values[k] = simpler;
                if self.keeps(candidate) {
                    break;
                }
            }
        }
    }
}
