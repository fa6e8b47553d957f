//! A tracker that keeps a list of near pairs, over any detector.

use std::time::Instant;

use super::kept::{Kept, Wanted};
use super::rule::Rule;
use super::tuner::{Costs, LEAST, Served, Tuner};
use super::{EveryStep, Step, Tracker};
use crate::searcher::Searcher;
use crate::track::Skin;
use contactbench_ground::contact::{AnyParticles, Particles, Test, any_particles};
use contactbench_ground::filter::bounds;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::pair_list::PairList;
use contactbench_ground::periodic::Searchable;
use contactbench_ground::periodic::{ContactList, List};
use contactbench_ground::probe::{Op, Probe, Tally};
use contactbench_ground::scene::{AnyScene, Lattice, Real, Scene};
use contactbench_ground::with_stored;

/// Keeps a list of all pairs at most a skin apart and tests only those until the rule requires a
/// rebuild. The detector finds the list as contacts of enlarged particles.
///
/// For N particles in D dimensions and L listed pairs it needs (16 + 8·D) N bytes and 8 for each of
/// max(L, N + 1), besides its detector. A radius per particle adds 16 N, and 8 N more while a list
/// is built; [`Rule::Summed`] adds 8·D N. A box adds N / 8, 20 for each listed pair through a face,
/// 16 for each particle given by another image than when the list was built, and images during a
/// build.
pub(super) struct Verlet {
    search: EveryStep,
    skin: Skin,
    rule: Rule,
    tuner: Tuner,
    touching: u64,
    plane: Kept<2>,
    space: Kept<3>,
}

impl Verlet {
    pub fn new(search: EveryStep, fast: bool, skin: Skin, rule: Rule) -> Verlet {
        Verlet {
            search,
            skin,
            rule,
            tuner: Tuner::new(Costs::of(fast)),
            touching: 0,
            plane: Kept::default(),
            space: Kept::default(),
        }
    }

    /// Finds contacts from a list, or returns `None` if the detector must be called without one.
    fn with_list(
        &mut self,
        frame: Searchable<'_>,
        tally: Option<&mut Tally>,
        contacts: &mut ContactList,
    ) -> Result<Option<Step>, Refusal> {
        let skin = match self.skin {
            Skin::Diameters(skin) => Thick::Given(skin),
            Skin::Auto => Thick::By(&mut self.tuner),
        };
        let (lattice, test) = match frame {
            Searchable::Open(_, test) => (None, test),
            Searchable::Boxed(periodic, arithmetic) => {
                (Some(periodic.lattice()), arithmetic.test())
            }
        };
        let (rule, touching, search) = (self.rule, self.touching, &mut self.search.0);
        let work = Work { rule, touching, test, skin, search, lattice, tally };
        let (plane, space) = (&mut self.plane, &mut self.space);
        match (frame, frame.scene()) {
            (Searchable::Open(..), AnyScene::Plane(scene)) => {
                space.forget();
                with_stored!(scene, scene => {
                    work.step(plane, scene, contacts, |kept, particles, plain, _| {
                        kept.pass(particles, plain)
                    })
                })
            }
            (Searchable::Open(..), AnyScene::Space(scene)) => {
                plane.forget();
                with_stored!(scene, scene => {
                    work.step(space, scene, contacts, |kept, particles, plain, _| {
                        kept.pass(particles, plain)
                    })
                })
            }
            (Searchable::Boxed(..), AnyScene::Plane(scene)) => {
                space.forget();
                let scene = &scene.widened();
                work.step(plane, scene, contacts, |kept, _, plain, shifted| {
                    kept.pass_in_box(scene, test, plain, shifted)
                })
            }
            (Searchable::Boxed(..), AnyScene::Space(scene)) => {
                plane.forget();
                let scene = &scene.widened();
                work.step(space, scene, contacts, |kept, _, plain, shifted| {
                    kept.pass_in_box(scene, test, plain, shifted)
                })
            }
        }
    }
}

impl Tracker for Verlet {
    fn find(
        &mut self,
        frame: Searchable<'_>,
        mut tally: Option<&mut Tally>,
        contacts: &mut ContactList,
    ) -> Result<Step, Refusal> {
        if let Searchable::Boxed(_, arithmetic) = frame
            && !arithmetic.is_exact()
        {
            return Err(Refusal::Rounded { arithmetic: arithmetic.name() });
        }
        let before = contacts.len();
        let mut step = Ok(None);
        if self.tuner.direct == 0 {
            step = self.with_list(frame, tally.as_deref_mut(), contacts);
        }
        let step = step.and_then(|step| {
            if let Some(step) = step {
                return Ok(step);
            }
            self.plane.forget();
            self.space.forget();
            self.tuner.direct = self.tuner.direct.saturating_sub(1);
            let frame = match frame {
                // Lists are safe, so a frame without a list uses safe filters, too.
                Searchable::Open(scene, test) => Searchable::Open(scene, test.safe()),
                boxed @ Searchable::Boxed(..) => boxed,
            };
            self.search.find(frame, tally, contacts)
        });
        match &step {
            Ok(_) => self.touching = contacts.len() - before,
            Err(_) => self.forget(),
        }
        step
    }

    fn forget(&mut self) {
        self.plane.forget();
        self.space.forget();
        self.tuner.reset();
    }

    fn formula_bytes(&self) -> u64 {
        self.plane.bytes() + self.space.bytes() + self.search.formula_bytes()
    }
}

/// Thickness of the skin in diameters of the largest particle: given, or chosen by a tuner.
enum Thick<'a> {
    Given(f64),
    By(&'a mut Tuner),
}

struct Work<'a> {
    rule: Rule,
    touching: u64,
    test: Test,
    skin: Thick<'a>,
    search: &'a mut Searcher,
    lattice: Option<&'a Lattice>,
    tally: Option<&'a mut Tally>,
}

impl Work<'_> {
    /// Finds the contacts of a frame: `pass` adds the listed pairs that touch to the lists and
    /// returns how many tests used exact arithmetic. Returns `None` if the detector must be called
    /// without a list.
    fn step<'a, T: Real, const D: usize>(
        mut self,
        kept: &mut Kept<D>,
        scene: &'a Scene<'_, T, D>,
        contacts: &mut ContactList,
        pass: impl FnOnce(&Kept<D>, AnyParticles<'a, T, D>, &mut PairList<'_>, &mut List) -> u64,
    ) -> Result<Option<Step>, Refusal>
    where
        for<'b> AnyScene<'b>: From<Scene<'b, f64, D>>,
    {
        let particles = any_particles(scene, self.test)?;
        let Some(step) = self.ready(kept, scene, &particles)? else { return Ok(None) };
        let limit = self.search.memory_limit();
        let exact = contacts
            .gather(limit, scene.len(), |plain, shifted| pass(kept, particles, plain, shifted))?;
        if let Some(tally) = self.tally {
            tally.add(Op::ContactTest, step.listed);
            tally.add(Op::ExactTest, exact);
        }
        Ok(Some(step))
    }

    /// Updates the particles to this frame and builds a list if one is due. Returns `None` if the
    /// detector must be called without a list.
    fn ready<T: Real, const D: usize>(
        &mut self,
        kept: &mut Kept<D>,
        scene: &Scene<'_, T, D>,
        particles: &impl Particles<T, D>,
    ) -> Result<Option<Step>, Refusal>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let (largest, slack) = (scene.largest_radius().wide(), particles.slack());
        let rounding = 2.0 * largest * slack.relative + slack.absolute;
        let mut step = Step { built: true, ..Step::default() };
        if let Some((age, displacements)) = kept.follow(scene, self.lattice, self.rule, rounding) {
            let due = self.rule.is_due(age, &displacements, kept.skin());
            (step.built, step.dangerous) = (due.build, due.dangerous);
            if let Thick::By(tuner) = &mut self.skin {
                let gone = self.rule.approach(&displacements);
                let served = served(kept, (scene.len(), 2.0 * largest), self.touching, age, gone);
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
            let corners = bounds(particles);
            loop {
                let half = largest
                    * match &self.skin {
                        Thick::Given(skin) => *skin,
                        Thick::By(tuner) => tuner.skin,
                    };
                let list = Wanted { half, rounding, rule: self.rule, lattice: self.lattice };
                let tally = self.tally.as_deref_mut();
                let built = kept.build(scene, corners, &list, self.search, tally);
                let refusal = match built {
                    Ok(true) => break,
                    Ok(false) => return Ok(None),
                    Err(refusal) => refusal,
                };
                let too_long = matches!(refusal, Refusal::Listed { .. });
                match &mut self.skin {
                    Thick::Given(_) => return Err(refusal),
                    Thick::By(tuner) if too_long && tuner.skin > LEAST => tuner.thinner(),
                    // The detector alone may need less memory than a list.
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
}

/// Returns statistics of a list for the tuner, in diameters and per particle.
fn served<const D: usize>(
    kept: &Kept<D>,
    (particles, diameter): (usize, f64),
    touching: u64,
    age: u32,
    gone: f64,
) -> Served {
    // If all particles are points, every displacement would be infinitely many diameters.
    let in_diameters = |length: f64| if length > 0.0 { length / diameter } else { 0.0 };
    let per_particle = |count: u64| count as f64 / particles.max(1) as f64;
    Served {
        age,
        together: in_diameters(gone),
        skin: in_diameters(kept.skin()),
        listed: per_particle(kept.listed()),
        touching: per_particle(touching),
        dim: D as u32,
    }
}
