//! Chooses the skin that minimises the cost of steps during the run.
//!
//! A thick skin makes a list long, and a thin one makes it short-lived. Costs are per particle, in
//! units of testing one listed pair. A step that builds a list costs about BUILD + MAKE · listed, a
//! step that only uses it costs FOLLOW + listed, and a call of the detector alone costs DETECT +
//! MAKE · contacts. Let u be the sum of the displacements of the two fastest particles in a step,
//! in diameters. A list with skin s is then built in one of floor(s / u) + 1 steps, and
//!
//! ```text
//! listed = contacts + e ((1 + s)^D - 1),
//! ```
//!
//! with e measured on the current list. All quantities are counted, not timed, so the same frames
//! get the same skins on every machine. Near its minimum the cost hardly depends on s: half or
//! twice the best skin raises the cost that depends on s by a quarter, and a factor of four in
//! BUILD changes the best skin by a factor of two.

/// Costs of a detector, in units of testing one listed pair (1 to 1.3 ns).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Costs {
    build: f64,
    make: f64,
    detect: f64,
}

impl Costs {
    /// Costs of `streamed-nbs` on 2,000 to a million packed spheres. There building a list takes 40
    /// to 100 units per particle and a whole detection 27 to 42.
    const FAST: Costs = Costs { build: 55.0, make: 5.0, detect: 18.0 };
    /// Costs of `nbs` on 32,000 packed spheres.
    const SLOW: Costs = Costs { build: 100.0, make: 18.0, detect: 100.0 };

    pub fn of(fast: bool) -> Costs {
        if fast { Costs::FAST } else { Costs::SLOW }
    }
}

/// Cost of updating a particle, in units of testing one listed pair; measured values were 5 to 22.
const FOLLOW: f64 = 10.0;
/// First skin of a run, in diameters; the next two constants are the least and the largest.
const FIRST: f64 = 0.1;
pub(super) const LEAST: f64 = 0.01;
const MOST: f64 = 1.0;
/// Number of frames without a list after lists did not pay; it doubles each time the next list does
/// not pay either.
const DIRECT: u32 = 15;
const MOST_DIRECT: u32 = 64 * DIRECT;
/// Age in frames at which a list is first compared with a thinner one; each comparison doubles it.
const ASKED: u32 = 64;

/// Statistics of a list that is being discarded or compared with a thinner one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Served {
    /// Frames since the list was built.
    pub age: u32,
    /// How much nearer two particles may have come since the list was built, in diameters.
    pub together: f64,
    pub skin: f64,
    /// Listed pairs per particle.
    pub listed: f64,
    /// Touching pairs per particle.
    pub touching: f64,
    pub dim: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tuner {
    costs: Costs,
    /// Skin of the next list, in diameters.
    pub skin: f64,
    /// Number of frames that follow without a list.
    pub direct: u32,
    /// Number of frames without a list that follow if the next list does not pay.
    next: u32,
    /// Largest skin that may be chosen, in diameters; halved while lists do not fit in memory.
    most: f64,
}

impl Tuner {
    pub fn new(costs: Costs) -> Tuner {
        Tuner { costs, skin: FIRST, direct: 0, next: DIRECT, most: MOST }
    }

    pub fn reset(&mut self) {
        *self = Tuner::new(self.costs);
    }

    /// Chooses the next skin from the statistics of a list that is discarded.
    pub fn learn(&mut self, served: &Served) {
        match best(self.costs, served) {
            Some(skin) => {
                (self.skin, self.direct, self.next) = (skin.min(self.most), 0, DIRECT);
            }
            None => self.give_up(),
        }
    }

    pub fn give_up(&mut self) {
        (self.skin, self.direct) = (FIRST.min(self.most), self.next);
        self.next = (2 * self.next).min(MOST_DIRECT);
    }

    /// Returns whether it pays to replace a list that is still valid by one with a thinner skin.
    pub fn is_too_thick(&self, served: &Served) -> bool {
        let asked = served.age >= ASKED && served.age.is_power_of_two();
        asked && best(self.costs, served).is_some_and(|skin| skin < 0.5 * served.skin)
    }

    /// Halves the skin because the list does not fit in memory.
    pub fn thinner(&mut self) {
        self.most = (0.5 * self.skin).max(LEAST);
        self.skin = self.most;
    }
}

/// Returns the skin of least cost in diameters, or `None` if the detector alone costs less.
fn best(costs: Costs, served: &Served) -> Option<f64> {
    let Costs { build, make, detect } = costs;
    let Served { age, together, skin, listed, touching, dim } = *served;
    // The power is multiplied out, because powers are rounded differently on different machines.
    let grown = |skin: f64| (0..dim).fold(1.0, |power, _| power * (1.0 + skin)) - 1.0;
    // The number is at least 1, because an empty list does not predict the length of the next one.
    let extra = ((listed - touching) / grown(skin).max(LEAST)).max(1.0);
    let step = together / f64::from(age.max(1));
    let cost = |steps: f64, skin: f64| {
        let listed = touching + extra * grown(skin);
        (build + make * listed + steps * (FOLLOW + listed)) / (steps + 1.0)
    };
    let alone = detect + make * touching;
    if step * f64::from(u16::MAX) < LEAST {
        return Some(LEAST);
    }
    let mut found: Option<(f64, f64)> = None;
    let mut steps = 1.0;
    while steps * step <= MOST {
        // The skin has a margin of 1%, because speeds vary slightly.
        let skin = (1.01 * steps * step).max(LEAST);
        let cost = cost((skin / step).floor(), skin);
        if cost < alone && found.is_none_or(|(least, _)| cost < least) {
            found = Some((cost, skin));
        }
        steps = (steps + 1.0).max((1.1 * steps).floor());
    }
    found.map(|(_, skin)| skin)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Statistics of a dense packing in which the two fastest particles together move by `step` in
    /// each frame.
    fn served(step: f64, skin: f64) -> Served {
        let age = (skin / step).floor().clamp(1.0, 1e6);
        let listed = 3.0 + 6.0 * ((1.0 + skin).powi(3) - 1.0);
        let together = (age * step).min(1e3);
        Served { age: age as u32, together, skin, listed, touching: 3.0, dim: 3 }
    }

    /// For thin skins the best skin agrees with the model without integer steps, in which a step
    /// that builds a list does not update it but finds its contacts.
    #[test]
    fn the_skin_grows_with_the_root_of_the_speed() {
        for step in [1e-5, 1e-4, 1e-3, 1e-2] {
            let mut tuner = Tuner::new(Costs::FAST);
            tuner.learn(&served(step, 0.1));
            let Costs { build, make, .. } = Costs::FAST;
            let excess = build - FOLLOW + (make - 1.0) * 3.0;
            let predicted = (excess * step / (3.0 * 6.0)).sqrt().max(LEAST);
            let ratio = tuner.skin / predicted;
            assert!((0.5..=1.5).contains(&ratio), "{step}: {} for {predicted}", tuner.skin);
            // The best skin is stable: learning from it changes it little.
            let before = tuner;
            tuner.learn(&served(step, tuner.skin));
            assert!((tuner.skin / before.skin - 1.0).abs() < 0.3, "{step}: {tuner:?}");
        }
    }

    #[test]
    fn lists_that_do_not_pay_are_dropped_for_a_while() {
        let mut tuner = Tuner::new(Costs::FAST);
        tuner.learn(&served(0.7, 0.1));
        assert_eq!((tuner.direct, tuner.skin), (DIRECT, FIRST));
        let mut longer = || {
            tuner.learn(&served(0.7, 0.1));
            tuner.direct
        };
        assert_eq!([longer(), longer()], [2 * DIRECT, 4 * DIRECT]);
        assert_eq!((0..9).map(|_| longer()).last(), Some(MOST_DIRECT));
        tuner.learn(&served(1e-3, 0.1));
        assert_eq!(tuner.direct, 0);
        tuner.give_up();
        assert_eq!(tuner.direct, DIRECT);
    }

    /// Lists pay if detection is slow: for many contacts, or for few with a slow detector.
    #[test]
    fn slow_detections_favour_lists() {
        let many = Served { listed: 30.0, touching: 25.0, ..served(2e-3, 0.1) };
        assert!(best(Costs::of(true), &many).is_some());
        let fast = served(0.2, 0.4);
        assert_eq!(best(Costs::of(true), &fast), None);
        assert!(best(Costs::of(false), &fast).is_some());
    }

    #[test]
    fn resting_particles_get_the_thinnest_skin_soon() {
        let rest = Served { age: 64, together: 0.0, ..served(1e-3, 0.1) };
        let tuner = Tuner::new(Costs::FAST);
        assert!(tuner.is_too_thick(&rest) && !tuner.is_too_thick(&Served { age: 63, ..rest }));
        assert_eq!(best(Costs::FAST, &rest), Some(LEAST));
        assert!(!tuner.is_too_thick(&Served { skin: LEAST, ..rest }));
    }
}
