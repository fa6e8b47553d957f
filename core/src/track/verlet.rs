//! A list of near pairs over any detector.

use std::time::Instant;

use super::kept::{Kept, Wanted};
use super::rule::Rule;
use super::spec::Skin;
use super::tuner::{Costs, LEAST, Served, Tuner};
use super::{Step, Tracker};
use crate::contact::{Arithmetic, Bodies, Test, any_bodies};
use crate::detect::any::AnyDetector;
use crate::filter::bounds;
use crate::pair_list::{Allowance, PairList};
use crate::periodic::{Contacts, Finder, List, Periodic};
use crate::probe::{Op, Probe, Tally};
use crate::refusal::Refusal;
use crate::scene::{AnyScene, Lattice, Real, Scene};
use crate::with_stored;

/// Keeps all pairs whose bodies are at most a skin apart, found by a detector among larger bodies,
/// and looks at those only, until the rule says that others may touch.
///
/// Needs, for N particles in D dimensions and L listed pairs, (16 + 8·D) N bytes and 8 for each of
/// L or N + 1, whichever are more, beside its detector; 16 N more with a radius each, and 8 N more
/// of those while a list is built; 8·D N more where the rule is [`Rule::Summed`]. In a box N / 8
/// more, 20 for each listed pair through a face, 16 for each particle that has another name than
/// when the list was built, and images while it is built.
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
    /// Of images, once a frame is in a box.
    finder: Option<Finder>,
}

impl Verlet {
    pub fn new(
        detector: Box<dyn AnyDetector>,
        costs: Costs,
        skin: Skin,
        rule: Rule,
        limit: u64,
    ) -> Verlet {
        Verlet {
            detector,
            skin,
            rule,
            limit,
            tuner: Tuner::new(costs),
            touching: 0,
            plane: Kept::default(),
            space: Kept::default(),
            finder: None,
        }
    }

    /// What a step with a list takes.
    fn at_work<'a>(
        &'a mut self,
        test: Test,
        lattice: Option<&'a Lattice>,
        tally: Option<&'a mut Tally>,
    ) -> (Settings, Work<'a>, &'a mut Kept<2>, &'a mut Kept<3>) {
        let settings =
            Settings { rule: self.rule, limit: self.limit, touching: self.touching, test };
        let skin = match self.skin {
            Skin::Diameters(skin) => Thick::Given(skin),
            Skin::Auto => Thick::By(&mut self.tuner),
        };
        let detector = &mut *self.detector;
        let work = Work { skin, detector, around: lattice.zip(self.finder.as_mut()), tally };
        (settings, work, &mut self.plane, &mut self.space)
    }

    /// The detector is asked in this frame, and nothing is kept.
    fn without_list(&mut self) {
        self.plane.forget();
        self.space.forget();
        self.tuner.direct = self.tuner.direct.saturating_sub(1);
    }

    /// After a frame with so many contacts.
    fn done(&mut self, step: Result<Step, Refusal>, touching: u64) -> Result<Step, Refusal> {
        match &step {
            Ok(_) => self.touching = touching,
            Err(_) => self.forget(),
        }
        step
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
        self.finder = None;
        let mut step = Ok(None);
        if self.tuner.direct == 0 {
            let (settings, work, plane, space) = self.at_work(test, None, tally.as_deref_mut());
            step = match frame {
                AnyScene::Plane(frame) => {
                    space.forget();
                    with_stored!(frame, scene => settings.step(plane, scene, work, pairs))
                }
                AnyScene::Space(frame) => {
                    plane.forget();
                    with_stored!(frame, scene => settings.step(space, scene, work, pairs))
                }
            };
        }
        let step = match step {
            Ok(Some(step)) => Ok(step),
            Ok(None) => {
                self.without_list();
                // As safe as lists are, whatever filters are asked for.
                super::ask(&mut *self.detector, frame, test.safe(), self.limit, tally, pairs)
            }
            Err(refusal) => Err(refusal),
        };
        self.done(step, (pairs.len() - before) as u64)
    }

    fn step_in_box(
        &mut self,
        frame: &Periodic<'_>,
        arithmetic: Arithmetic,
        mut tally: Option<&mut Tally>,
        contacts: &mut Contacts,
    ) -> Result<Step, Refusal> {
        if arithmetic != Arithmetic::Exact {
            return Err(Refusal::Rounded { arithmetic: arithmetic.name() });
        }
        let before = contacts.len();
        let limit = self.limit;
        self.finder.get_or_insert_with(|| Finder::new(limit));
        let mut step = Ok(None);
        if self.tuner.direct == 0 {
            let (settings, work, plane, space) =
                self.at_work(Test::Exact, Some(frame.lattice()), tally.as_deref_mut());
            step = match frame.scene() {
                AnyScene::Plane(scene) => {
                    space.forget();
                    settings.step_in_box(plane, &scene.widened(), work, contacts)
                }
                AnyScene::Space(scene) => {
                    plane.forget();
                    settings.step_in_box(space, &scene.widened(), work, contacts)
                }
            };
        }
        let step = match step {
            Ok(Some(step)) => Ok(step),
            Ok(None) => {
                self.without_list();
                let finder = self.finder.get_or_insert_with(|| Finder::new(limit));
                let detector = &mut *self.detector;
                super::ask_in_box(finder, detector, frame, arithmetic, tally, contacts)
            }
            Err(refusal) => Err(refusal),
        };
        self.done(step, contacts.len() - before)
    }

    fn forget(&mut self) {
        self.plane.forget();
        self.space.forget();
        self.tuner.reset();
    }

    fn formula_bytes(&self) -> u64 {
        let images = self.finder.as_ref().map_or(0, Finder::formula_bytes);
        self.plane.bytes() + self.space.bytes() + images + self.detector.formula_bytes()
    }
}

/// Who says how thick the skin is, in diameters of the largest body.
enum Thick<'a> {
    Given(f64),
    By(&'a mut Tuner),
}

/// Who builds a list.
struct Work<'a> {
    skin: Thick<'a>,
    detector: &'a mut dyn AnyDetector,
    /// The box, if there is one.
    around: Option<(&'a Lattice, &'a mut Finder)>,
    tally: Option<&'a mut Tally>,
}

impl Work<'_> {
    /// A list was looked at, and so many of its pairs took exact arithmetic.
    fn tally(self, step: &Step, exact: u64) {
        if let Some(tally) = self.tally {
            tally.add(Op::ContactTest, step.listed);
            tally.add(Op::ExactTest, exact);
        }
    }
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
        mut work: Work<'_>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Option<Step>, Refusal>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let bodies = any_bodies(scene, self.test)?;
        let Some(step) = self.ready(kept, scene, &bodies, &mut work)? else { return Ok(None) };
        let allowance = Allowance::new(self.limit);
        let mut list = PairList::behind(std::mem::take(pairs), &allowance);
        let exact = kept.pass(bodies, &mut list);
        work.tally(&step, exact);
        list.end(scene.len(), pairs)?;
        Ok(Some(step))
    }

    /// None if the detector is to be asked without a list.
    fn step_in_box<const D: usize>(
        &self,
        kept: &mut Kept<D>,
        scene: &Scene<'_, f64, D>,
        mut work: Work<'_>,
        contacts: &mut Contacts,
    ) -> Result<Option<Step>, Refusal>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let bodies = any_bodies(scene, self.test)?;
        let Some(step) = self.ready(kept, scene, &bodies, &mut work)? else { return Ok(None) };
        let pass =
            |plain: &mut PairList<'_>, shifted: &mut List| kept.pass_in_box(scene, plain, shifted);
        let exact = contacts.gather(self.limit, scene.len(), pass)?;
        work.tally(&step, exact);
        Ok(Some(step))
    }

    /// Brings particles to their places, and builds a list if it is due. None if the detector is to
    /// be asked without one.
    fn ready<T: Real, const D: usize>(
        &self,
        kept: &mut Kept<D>,
        scene: &Scene<'_, T, D>,
        bodies: &impl Bodies<T, D>,
        work: &mut Work<'_>,
    ) -> Result<Option<Step>, Refusal>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let (largest, slack) = (scene.largest_radius().wide(), bodies.slack());
        let rounding = 2.0 * largest * slack.relative + slack.absolute;
        let lattice = work.around.as_ref().map(|(lattice, _)| *lattice);
        let mut step = Step { built: true, ..Step::default() };
        if let Some((age, ways)) = kept.follow(scene, lattice, self.rule, rounding) {
            let nearer = kept.nearer(2.0 * largest);
            let left = if nearer > 0.0 { (kept.skin() - nearer).next_down() } else { kept.skin() };
            let due = self.rule.is_due(age, &ways, left);
            (step.built, step.dangerous) = (due.build, due.dangerous);
            if let Thick::By(tuner) = &mut work.skin {
                let served = self.served(kept, scene, age, self.rule.gone(&ways) + nearer);
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
            let corners = bounds(bodies);
            loop {
                let half = largest
                    * match &work.skin {
                        Thick::Given(skin) => *skin,
                        Thick::By(tuner) => tuner.skin,
                    };
                let list = Wanted { half, rounding, rule: self.rule, limit: self.limit };
                let around =
                    work.around.as_mut().map(|(lattice, finder)| (*lattice, &mut **finder));
                let tally = work.tally.as_deref_mut();
                let built = kept.build(scene, corners, &list, around, work.detector, tally);
                let Err(refusal) = built else { break };
                let too_long = matches!(refusal, Refusal::Listed { .. });
                match &mut work.skin {
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
