//! A list of near pairs over any detector.

use std::time::Instant;

use super::kept::Kept;
use super::rule::Rule;
use super::{Step, Tracker};
use crate::contact::{Bodies, Test, any_bodies};
use crate::detect::any::AnyDetector;
use crate::pair_list::{Allowance, PairList};
use crate::probe::{Op, Probe, Tally};
use crate::refusal::Refusal;
use crate::scene::{AnyScene, Real, Scene};
use crate::with_stored;

/// Keeps all pairs whose bodies are at most a skin apart, found by a detector among larger bodies,
/// and looks at those only, until the rule says that others may touch.
///
/// Needs, for N particles in D dimensions and L listed pairs, at most (12 + 16·D) N + 8 L bytes, 16
/// N more with a radius each, beside its detector; 8 N more of those while a list is built.
pub(super) struct Verlet {
    detector: Box<dyn AnyDetector>,
    /// In diameters of the largest body.
    skin: f64,
    rule: Rule,
    /// For the list of contacts, in bytes.
    limit: u64,
    plane: Kept<2>,
    space: Kept<3>,
}

impl Verlet {
    pub fn new(detector: Box<dyn AnyDetector>, skin: f64, rule: Rule, limit: u64) -> Verlet {
        let (plane, space) = (Kept::default(), Kept::default());
        Verlet { detector, skin, rule, limit, plane, space }
    }
}

impl Tracker for Verlet {
    fn step(
        &mut self,
        frame: &AnyScene<'_>,
        test: Test,
        tally: Option<&mut Tally>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Step, Refusal> {
        let Verlet { detector, skin, rule, limit, plane, space } = self;
        let settings = Settings { skin: *skin, rule: *rule, limit: *limit, test };
        let detector = &mut **detector;
        let step = match frame {
            AnyScene::Plane(frame) => {
                space.forget();
                with_stored!(frame, scene => settings.step(plane, scene, detector, tally, pairs))
            }
            AnyScene::Space(frame) => {
                plane.forget();
                with_stored!(frame, scene => settings.step(space, scene, detector, tally, pairs))
            }
        };
        if step.is_err() {
            self.forget();
        }
        step
    }

    fn forget(&mut self) {
        self.plane.forget();
        self.space.forget();
    }

    fn formula_bytes(&self) -> u64 {
        self.plane.bytes() + self.space.bytes() + self.detector.formula_bytes()
    }
}

struct Settings {
    skin: f64,
    rule: Rule,
    limit: u64,
    test: Test,
}

impl Settings {
    fn step<T: Real, const D: usize>(
        &self,
        kept: &mut Kept<D>,
        scene: &Scene<'_, T, D>,
        detector: &mut dyn AnyDetector,
        mut tally: Option<&mut Tally>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Step, Refusal>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let bodies = any_bodies(scene, self.test)?;
        let (largest, slack) = (scene.largest_radius().wide(), bodies.slack());
        let half = self.skin * largest;
        let rounding = 2.0 * largest * slack.relative + slack.absolute;
        let mut step = Step { built: true, ..Step::default() };
        if let Some((age, ways)) = kept.follow(scene, self.rule, rounding) {
            let due = self.rule.is_due(age, &ways, 2.0 * half);
            (step.built, step.dangerous) = (due.build, due.dangerous);
        }
        if step.built {
            let started = Instant::now();
            kept.build(scene, half, rounding, self.limit, detector, tally.as_deref_mut())?;
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
        Ok(step)
    }
}
