//! The skin that makes steps cheap, found while they go on.
//!
//! A thick skin makes a list long, a thin one makes it short-lived. Per particle, in units of one
//! look at a listed pair, a step that builds a list costs about BUILD + MAKE · listed, one that
//! only looks at it FOLLOW + listed, and the detector alone DETECT + MAKE · contacts. A list with
//! skin s, whose two fastest bodies go u diameters in a step together, is built in one of
//! floor(s / u) + 1 steps, and
//!
//! ```text
//! listed = contacts + e ((1 + s)^D - 1),
//! ```
//!
//! with e known from the list at hand. All are counted, not timed, so that the same frames are
//! given the same skins on every machine. Near its least the cost hardly depends on s: half or
//! twice the best skin costs a quarter more of the excess, and an error of four times in BUILD is
//! one of two times in the skin.

use crate::detect::table::Speed;

/// What a detector costs, in looks of 1 to 1.3 ns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Costs {
    build: f64,
    make: f64,
    detect: f64,
}

impl Costs {
    /// Of `streamed-nbs` on 2,000 to a million packed spheres, where building takes 40 to 100 looks
    /// and asking 27 to 42 in all.
    const FAST: Costs = Costs { build: 55.0, make: 5.0, detect: 18.0 };
    /// Of `nbs` on 32,000.
    const SLOW: Costs = Costs { build: 100.0, make: 18.0, detect: 100.0 };

    /// The costs of a detector.
    pub fn of(speed: Speed) -> Costs {
        if speed == Speed::Fast { Costs::FAST } else { Costs::SLOW }
    }
}

/// To follow costs 5 to 22 looks.
const FOLLOW: f64 = 10.0;
/// In diameters: before anything is known, and at least and at most.
const FIRST: f64 = 0.1;
pub(super) const LEAST: f64 = 0.01;
const MOST: f64 = 1.0;
/// Where lists are of no use so many frames are looked at without one, and twice as many each time
/// that the next is of no use either.
const DIRECT: u32 = 15;
const MOST_DIRECT: u32 = 64 * DIRECT;
/// So many frames after a list was built it is asked whether a thinner skin would do, and then
/// after twice as many.
const ASKED: u32 = 64;

/// What is known of a list that is given up, or looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Served {
    /// Frames since it was built.
    pub age: u32,
    /// How far the two that went farthest have gone together, in diameters.
    pub together: f64,
    /// Its skin, in diameters.
    pub skin: f64,
    /// Listed pairs for each particle.
    pub listed: f64,
    /// Of those, in touch.
    pub touching: f64,
    /// Dimensions.
    pub dim: u32,
}

/// Chooses skins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tuner {
    costs: Costs,
    /// Of the next list, in diameters.
    pub skin: f64,
    /// Frames to come that are looked at without a list.
    pub direct: u32,
    /// So many there will be where the next list is of no use.
    next: u32,
    /// The thickest for which there is room.
    most: f64,
}

impl Tuner {
    /// Of lists over a detector that costs so much.
    pub fn new(costs: Costs) -> Tuner {
        Tuner { costs, skin: FIRST, direct: 0, next: DIRECT, most: MOST }
    }

    /// As at first.
    pub fn reset(&mut self) {
        *self = Tuner::new(self.costs);
    }

    /// A list has been given up.
    pub fn learn(&mut self, served: &Served) {
        match best(self.costs, served) {
            Some(skin) => {
                (self.skin, self.direct, self.next) = (skin.min(self.most), 0, DIRECT);
            }
            None => self.give_up(),
        }
    }

    /// No list for a while.
    pub fn give_up(&mut self) {
        (self.skin, self.direct) = (FIRST.min(self.most), self.next);
        self.next = (2 * self.next).min(MOST_DIRECT);
    }

    /// A list that may serve on: is it worth building a thinner one?
    pub fn is_too_thick(&self, served: &Served) -> bool {
        let asked = served.age >= ASKED && served.age.is_power_of_two();
        asked && best(self.costs, served).is_some_and(|skin| skin < 0.5 * served.skin)
    }

    /// There is no room for a list with this skin.
    pub fn thinner(&mut self) {
        self.most = (0.5 * self.skin).max(LEAST);
        self.skin = self.most;
    }
}

/// The skin of least cost, in diameters; none if it costs less to build in every step.
fn best(costs: Costs, served: &Served) -> Option<f64> {
    let Costs { build, make, detect } = costs;
    let Served { age, together, skin, listed, touching, dim } = *served;
    // Multiplied out: powers are rounded differently from machine to machine.
    let grown = |skin: f64| (0..dim).fold(1.0, |power, _| power * (1.0 + skin)) - 1.0;
    // An empty list says nothing of the next.
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
        // Speeds vary a little.
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

    /// A dense pack, in which the two fastest go so far together in a step.
    fn served(step: f64, skin: f64) -> Served {
        let age = (skin / step).floor().clamp(1.0, 1e6);
        let listed = 3.0 + 6.0 * ((1.0 + skin).powi(3) - 1.0);
        let together = (age * step).min(1e3);
        Served { age: age as u32, together, skin, listed, touching: 3.0, dim: 3 }
    }

    /// By the model without whole steps, where the skin is thin: a step that
    /// builds a list does not follow, and makes its contacts.
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
            // What it finds it keeps.
            let before = tuner;
            tuner.learn(&served(step, tuner.skin));
            assert!((tuner.skin / before.skin - 1.0).abs() < 0.3, "{step}: {tuner:?}");
        }
    }

    #[test]
    fn where_lists_are_of_no_use_there_is_none_for_a_while() {
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

    /// What takes long to find is kept for longer: many contacts, by any detector, and few, by a
    /// slow one.
    #[test]
    fn the_longer_asking_takes_the_more_lists_pay() {
        let many = Served { listed: 30.0, touching: 25.0, ..served(2e-3, 0.1) };
        assert!(best(Costs::of(Speed::Fast), &many).is_some());
        let fast = served(0.2, 0.4);
        assert_eq!(best(Costs::of(Speed::Fast), &fast), None);
        assert!(best(Costs::of(Speed::Usual), &fast).is_some());
    }

    #[test]
    fn what_rests_has_the_thinnest_skin_soon() {
        let rest = Served { age: 64, together: 0.0, ..served(1e-3, 0.1) };
        let tuner = Tuner::new(Costs::FAST);
        assert!(tuner.is_too_thick(&rest) && !tuner.is_too_thick(&Served { age: 63, ..rest }));
        assert_eq!(best(Costs::FAST, &rest), Some(LEAST));
        assert!(!tuner.is_too_thick(&Served { skin: LEAST, ..rest }));
    }
}
