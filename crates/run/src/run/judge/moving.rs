//! The judge of trajectories: every frame of an answer is held to what is true in it.

use std::collections::HashMap;
use std::rc::Rc;

use crate::moving::{self, Builds, Late, Moved, Names};
use crate::run::interrupt;
use crate::run::judge::at_rest::{AtRest, Truths};
use crate::run::judge::{Judged, Nothing, Unjudged};
use crate::run::protocol::Steps;
use crate::run::trajectory::Trajectory;
use contactbench_core::contact::Arithmetic;
use contactbench_core::oracle::{Causes, Errors, NoTruth};
use contactbench_core::periodic::Contacts;
use contactbench_core::searcher::Loaded;
use contactbench_core::sink::Digest;
use contactbench_io::Given;
use contactbench_record::record::row::Outcome;

/// What is true in the frames of a trajectory, as digests.
pub(super) struct Moving {
    trajectory: Trajectory,
    /// For a list of pairs, in bytes.
    memory_limit: u64,
    known: HashMap<Arithmetic, Result<Rc<[Right]>, Nothing>>,
}

/// The right answer in a frame, in an arithmetic.
#[derive(Clone, Default)]
struct Right {
    digest: Digest,
    /// Against exact decisions on the frame as given.
    errors: Errors,
    causes: Causes,
}

/// The judgement on an answer to all frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// When lists were built.
    pub builds: Builds,
    /// What was missed in the frames in which it was there.
    pub late: Late,
}

/// What somebody said of a trajectory.
#[derive(Clone, Copy)]
pub(crate) struct Said<'a> {
    pub arithmetic: Arithmetic,
    /// Contacts may be missed.
    pub may_miss: bool,
    pub steps: &'a Steps,
}

impl Moving {
    /// Finds what is true by exact decisions, and what the motion is like.
    pub fn new(
        trajectory: Trajectory,
        memory_limit: u64,
    ) -> anyhow::Result<(Moving, Option<Moved>)> {
        let mut course = moving::Course::default();
        let mut judge = Moving { trajectory, memory_limit, known: HashMap::new() };
        let found = judge.known(Arithmetic::Exact, |given, truths| {
            match &*truths.stored {
                Loaded::Open(_) => {
                    course.open(given.scene, &truths.own.contacts.plain, memory_limit)
                }
                Loaded::InBox(frame) => {
                    let truth = truths.own.contacts.sorted(given.scene.len(), u64::MAX);
                    course.in_box(frame, &truth.map_err(NoTruth::from)?, memory_limit);
                }
            }
            Ok(())
        });
        let moved = match found {
            Ok(_) => Some(course.moved),
            Err(Unjudged::Nothing(_)) => None,
            Err(Unjudged::Defect(defect)) => return Err(defect),
        };
        Ok((judge, moved))
    }

    /// The fingerprint of the right answer of frame 0.
    pub fn truth(&mut self, arithmetic: Arithmetic) -> Result<Digest, Unjudged> {
        let known = self.known(arithmetic, |_, _| Ok(()))?;
        Ok(known.first().map(|right| right.digest).unwrap_or_default())
    }

    /// Contacts in the frame that has the most.
    pub fn most_contacts(&mut self) -> Result<u64, Unjudged> {
        let known = self.known(Arithmetic::Exact, |_, _| Ok(()))?;
        Ok(known.iter().map(|right| right.digest.contacts).max().unwrap_or(0))
    }

    /// The right answers of all frames; where they are found now, `each` gets the frames with what
    /// is true in them.
    fn known(
        &mut self,
        arithmetic: Arithmetic,
        each: impl FnMut(Given, Truths) -> Result<(), Unjudged>,
    ) -> Result<Rc<[Right]>, Unjudged> {
        if let Some(known) = self.known.get(&arithmetic) {
            return known.clone().map_err(Unjudged::Nothing);
        }
        let found = match self.find(arithmetic, each) {
            Ok(found) => Ok(found.into()),
            Err(Unjudged::Nothing(nothing)) => Err(nothing),
            Err(defect) => return Err(defect),
        };
        self.known.insert(arithmetic, found.clone());
        found.map_err(Unjudged::Nothing)
    }

    fn find(
        &self,
        arithmetic: Arithmetic,
        mut each: impl FnMut(Given, Truths) -> Result<(), Unjudged>,
    ) -> Result<Vec<Right>, Unjudged> {
        let mut all = Vec::new();
        for k in 0..self.trajectory.frames.len() {
            interrupt::check().map_err(anyhow::Error::from)?;
            let given = self.trajectory.read_frame(k)?;
            let mut frame = AtRest::new(&given, self.memory_limit)?;
            let truths = frame.known(arithmetic)?;
            let digest = truths.own.digest;
            let judged =
                frame.judge(arithmetic, digest, || Err("the right answer is known".into()))?;
            let (errors, causes) = (judged.errors.unwrap_or_default(), judged.causes);
            all.push(Right { digest, errors, causes: causes.unwrap_or_default() });
            drop(frame);
            each(given, truths)?;
        }
        Ok(all)
    }

    /// Judges all frames. `fetch` gives the pairs of a frame whose answer is not the right one;
    /// frames are asked for in order.
    pub fn judge(
        &mut self,
        said: Said<'_>,
        mut fetch: impl FnMut(u64) -> Result<Contacts, String>,
    ) -> Result<(Judged, Course), Unjudged> {
        let Said { arithmetic, may_miss, steps } = said;
        let right = self.known(arithmetic, |_, _| Ok(()))?;
        let unseen = |why: &str| Ok((Judged::unseen(why), Course::default()));
        let found: Vec<Digest> = match steps.answers().collect() {
            Ok(found) => found,
            Err(why) => return unseen(&why),
        };
        if found.len() != right.len() {
            return unseen(&format!("it answers {} frames of {}", found.len(), right.len()));
        }
        let (mut own, mut errors, mut causes) =
            (Errors::default(), Errors::default(), Causes::default());
        let (mut course, mut names) = (Course::default(), Names::default());
        for (k, (&found, right)) in found.iter().zip(&*right).enumerate() {
            let flag = |flags: &[bool]| flags.get(k) == Some(&true);
            let missed = course.late.missed;
            course.builds.take(flag(&steps.built), flag(&steps.dangerous), missed);
            let is_right = found == right.digest;
            if is_right {
                errors.add(&right.errors);
                causes.add(&right.causes);
                if !course.late.is_open() {
                    continue;
                }
            }
            let given = self.trajectory.read_frame(k)?;
            let mut frame = AtRest::new(&given, self.memory_limit)?;
            let known = frame.known(arithmetic)?;
            if let Loaded::InBox(periodic) = &*known.stored {
                // In frames that were passed over nothing was missed: no name goes through them.
                names.next(periodic);
            }
            let contacts = if is_right {
                None
            } else {
                match fetch(k as u64) {
                    Ok(contacts) if contacts.digest() == found => Some(contacts),
                    Ok(_) => return unseen(&format!("asked for frame {k}, it gave others")),
                    Err(why) => return unseen(&format!("frame {k}: {why}")),
                }
            };
            if let Err(why) = self.late(&mut course.late, k, &known, &names, &contacts) {
                return unseen(&format!("frame {k}: {why}"));
            }
            let Some(contacts) = contacts else { continue };
            let judged = frame.judge(arithmetic, found, || Ok(contacts))?;
            let (Some(of_frame), Some(by_cause)) = (judged.errors, judged.causes) else {
                return unseen(&format!("nothing is known of frame {k}"));
            };
            own.add(&by_cause.search);
            errors.add(&of_frame);
            causes.add(&by_cause);
        }
        course.late.end();
        let mut judged = Judged::by(&own, arithmetic);
        if may_miss && own.missed > 0 && own.wrong() == own.missed {
            judged.outcome = Outcome::Lossy;
        }
        (judged.errors, judged.causes) = (Some(errors), Some(causes));
        Ok((judged, course))
    }

    /// Notes what is late in a frame; none were asked for where the answer is right.
    fn late(
        &self,
        late: &mut Late,
        k: usize,
        known: &Truths,
        names: &Names,
        said: &Option<Contacts>,
    ) -> Result<(), String> {
        let truth = &known.own.contacts;
        match &*known.stored {
            Loaded::Open(scene) => {
                let mut said = said.as_ref().unwrap_or(truth).clone();
                said.sort();
                late.take(k as u64, scene, &said.plain, &truth.plain);
            }
            Loaded::InBox(periodic) => {
                let sorted = |contacts: &Contacts, limit| {
                    let sorted = contacts.sorted(periodic.scene().len(), limit);
                    sorted.map_err(|refusal| refusal.to_string())
                };
                let truth = sorted(truth, u64::MAX)?;
                let said = said.as_ref().map(|said| sorted(said, self.memory_limit)).transpose()?;
                late.take(k as u64, &(periodic, names), said.as_ref().unwrap_or(&truth), &truth);
            }
        }
        Ok(())
    }
}
