//! A list of near pairs over any detector.

use std::time::Instant;

use super::kept::{Kept, Wanted};
use super::rule::Rule;
use super::spec::Skin;
use super::tuner::{LEAST, Served, Tuner};
use super::{Step, Tracker};
use crate::contact::{Bodies, Test, any_bodies};
use crate::detect::any::AnyDetector;
use crate::filter::bounds;
use crate::pair_list::{Allowance, PairList};
use crate::probe::{Op, Probe, Tally};
use crate::refusal::Refusal;
use crate::scene::{AnyScene, Real, Scene};
use crate::with_stored;

/// Keeps all pairs whose bodies are at most a skin apart, found by a detector among larger bodies,
/// and looks at those only, until the rule says that others may touch.
///
/// Needs, for N particles in D dimensions and L listed pairs, (4 + 12·D) N bytes and 8 for each of
/// L or N + 1, whichever are more, beside its detector; 16 N more with a radius each, and 8 N more
/// of those while a list is built; 8·D N more where the rule is [`Rule::Summed`].
pub(super) struct Verlet {
    detector: Box<dyn AnyDetector>,
    skin: Skin,
    rule: Rule,
    /// For the list of contacts, in bytes.
    limit: u64,
    tuner: Tuner,
    /// Contacts of the last frame.
    touching: u64,
    plane: Kept<2>,
    space: Kept<3>,
}

impl Verlet {
    pub fn new(detector: Box<dyn AnyDetector>, skin: Skin, rule: Rule, limit: u64) -> Verlet {
        let (plane, space) = (Kept::default(), Kept::default());
        Verlet { detector, skin, rule, limit, tuner: Tuner::default(), touching: 0, plane, space }
    }

    /// Asks the detector, and keeps nothing. As safe as lists are, whatever filters are asked for.
    fn direct(
        &mut self,
        frame: &AnyScene<'_>,
        test: Test,
        tally: Option<&mut Tally>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Step, Refusal> {
        self.plane.forget();
        self.space.forget();
        self.tuner.direct = self.tuner.direct.saturating_sub(1);
        super::ask(&mut *self.detector, frame, test.safe(), self.limit, tally, pairs)
    }
}

impl Tracker for Verlet {
    fn step(
        &mut self,
        frame: &AnyScene<'_>,
        test: Test,
        mut tally: Option<&mut Tally>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Step, Refusal> {
        let before = pairs.len();
        let mut step = Ok(None);
        if self.tuner.direct == 0 {
            let Verlet { detector, skin, rule, limit, tuner, touching, plane, space } = self;
            let settings = Settings { rule: *rule, limit: *limit, touching: *touching, test };
            let skin = match *skin {
                Skin::Diameters(skin) => Thick::Given(skin),
                Skin::Auto => Thick::By(tuner),
            };
            let (detector, tally) = (&mut **detector, tally.as_deref_mut());
            step = match frame {
                AnyScene::Plane(frame) => {
                    space.forget();
                    with_stored!(frame, scene => {
                        settings.step(plane, scene, skin, detector, tally, pairs)
                    })
                }
                AnyScene::Space(frame) => {
                    plane.forget();
                    with_stored!(frame, scene => {
                        settings.step(space, scene, skin, detector, tally, pairs)
                    })
                }
            };
        }
        let step = match step {
            Ok(Some(step)) => Ok(step),
            Ok(None) => self.direct(frame, test, tally, pairs),
            Err(refusal) => Err(refusal),
        };
        match &step {
            Ok(_) => self.touching = (pairs.len() - before) as u64,
            Err(_) => self.forget(),
        }
        step
    }

    fn forget(&mut self) {
        self.plane.forget();
        self.space.forget();
        self.tuner = Tuner::default();
    }

    fn formula_bytes(&self) -> u64 {
        self.plane.bytes() + self.space.bytes() + self.detector.formula_bytes()
    }
}

/// Who says how thick the skin is, in diameters of the largest body.
enum Thick<'a> {
    Given(f64),
    By(&'a mut Tuner),
}

struct Settings {
    rule: Rule,
    limit: u64,
    /// Contacts of the frame before.
    touching: u64,
    test: Test,
}

impl Settings {
    /// None if the detector is to be asked without a list.
    fn step<T: Real, const D: usize>(
        &self,
        kept: &mut Kept<D>,
        scene: &Scene<'_, T, D>,
        mut skin: Thick<'_>,
        detector: &mut dyn AnyDetector,
        mut tally: Option<&mut Tally>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Option<Step>, Refusal>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let bodies = any_bodies(scene, self.test)?;
        let (largest, slack) = (scene.largest_radius().wide(), bodies.slack());
        let rounding = 2.0 * largest * slack.relative + slack.absolute;
        let mut step = Step { built: true, ..Step::default() };
        if let Some((age, ways)) = kept.follow(scene, self.rule, rounding) {
            let due = self.rule.is_due(age, &ways, kept.skin());
            (step.built, step.dangerous) = (due.build, due.dangerous);
            if let Thick::By(tuner) = &mut skin {
                let served = self.served(kept, scene, age, self.rule.gone(&ways));
                step.built |= tuner.is_too_thick(&served);
                if step.built {
                    tuner.learn(&served);
                }
                if tuner.direct > 0 {
                    return Ok(None);
                }
            }
        }
        if step.built {
            let started = Instant::now();
            let corners = bounds(&bodies);
            loop {
                let half = largest
                    * match &skin {
                        Thick::Given(skin) => *skin,
                        Thick::By(tuner) => tuner.skin,
                    };
                let list = Wanted { half, rounding, rule: self.rule, limit: self.limit };
                let built = kept.build(scene, corners, &list, detector, tally.as_deref_mut());
                let Err(refusal) = built else { break };
                let too_long = matches!(refusal, Refusal::Listed { .. });
                match &mut skin {
                    Thick::Given(_) => return Err(refusal),
                    Thick::By(tuner) if too_long && tuner.skin > LEAST => tuner.thinner(),
                    // Without a list there may be room.
                    Thick::By(tuner) => {
                        tuner.give_up();
                        return Ok(None);
                    }
                }
            }
            step.building = started.elapsed();
        }
        step.listed = kept.listed();
        let allowance = Allowance::new(self.limit);
        let mut list = PairList::behind(std::mem::take(pairs), &allowance);
        let exact = kept.pass(bodies, &mut list);
        if let Some(tally) = tally {
            tally.add(Op::ContactTest, step.listed);
            tally.add(Op::ExactTest, exact);
        }
        list.end(scene.len(), pairs)?;
        Ok(Some(step))
    }

    fn served<T: Real, const D: usize>(
        &self,
        kept: &Kept<D>,
        scene: &Scene<'_, T, D>,
        age: u32,
        gone: f64,
    ) -> Served {
        let diameter = 2.0 * scene.largest_radius().wide();
        // Points go infinitely far.
        let in_diameters = |length: f64| if length > 0.0 { length / diameter } else { 0.0 };
        let per_particle = |count: u64| count as f64 / scene.len().max(1) as f64;
        Served {
            age,
            together: in_diameters(gone),
            skin: in_diameters(kept.skin()),
            listed: per_particle(kept.listed()),
            touching: per_particle(self.touching),
            dim: D as u32,
        }
    }
}
