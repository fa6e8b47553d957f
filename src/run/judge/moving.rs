//! The judge of trajectories: every frame of an answer is held to what is true in it.

use std::collections::HashMap;

use crate::contact::Arithmetic;
use crate::moving::{self, Builds, Late, Moved, Names};
use crate::oracle::{Causes, Errors};
use crate::periodic::Contacts;
use crate::record::row::Outcome;
use crate::run::interrupt;
use crate::run::judge::at_rest::{AtRest, Known};
use crate::run::judge::{Judged, Nothing};
use crate::run::protocol::Steps;
use crate::run::trajectory::Trajectory;
use crate::scene::Given;
use crate::sink::{Digest, normalise};

/// What is true in the frames of a trajectory, as digests.
pub(super) struct Moving {
    trajectory: Trajectory,
    /// For a list of pairs, in bytes.
    memory_limit: u64,
    known: HashMap<Arithmetic, Result<Vec<Right>, Nothing>>,
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
pub(crate) struct Course {
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
        let exact = judge.find(Arithmetic::Exact, |given, known| match known {
            Known::Open(truths) => course.open(given.scene, &truths.rounded.pairs, memory_limit),
            Known::InBox(frame, truth) => course.in_box(&frame, &truth.pairs, memory_limit),
        })?;
        let moved = exact.is_ok().then_some(course.moved);
        judge.known.insert(Arithmetic::Exact, exact);
        Ok((judge, moved))
    }

    /// The fingerprint of the right answer of frame 0.
    pub fn truth(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Result<Digest, Nothing>> {
        let known = self.known(arithmetic)?;
        Ok(known.map(|frames| frames.first().map(|right| right.digest).unwrap_or_default()))
    }

    /// Contacts in the frame that has the most.
    pub fn most_contacts(&mut self) -> anyhow::Result<u64> {
        let known = self.known(Arithmetic::Exact)?.unwrap_or_default();
        Ok(known.iter().map(|right| right.digest.contacts).max().unwrap_or(0))
    }

    fn known(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Result<Vec<Right>, Nothing>> {
        if let Some(known) = self.known.get(&arithmetic) {
            return Ok(known.clone());
        }
        let found = self.find(arithmetic, |_, _| {})?;
        self.known.insert(arithmetic, found.clone());
        Ok(found)
    }

    fn read(&self, k: usize) -> anyhow::Result<Given> {
        self.trajectory.read_frame(k)
    }

    /// The right answers of all frames; `each` sees the frames with what is true in them.
    fn find(
        &self,
        arithmetic: Arithmetic,
        mut each: impl FnMut(Given, Known),
    ) -> anyhow::Result<Result<Vec<Right>, Nothing>> {
        let mut all = Vec::new();
        for k in 0..self.trajectory.frames.len() {
            interrupt::check()?;
            let given = self.read(k)?;
            let mut frame = AtRest::new(&given, self.memory_limit)?;
            let known = match frame.known(arithmetic)? {
                Ok(known) => known,
                Err(nothing) => return Ok(Err(nothing)),
            };
            let digest = known.digest();
            let never = || Err("the right answer is known".into());
            let judged = match frame.judge(arithmetic, digest, never)? {
                Ok(judged) => judged,
                Err(nothing) => return Ok(Err(nothing)),
            };
            let (errors, causes) = (judged.errors.unwrap_or_default(), judged.causes);
            all.push(Right { digest, errors, causes: causes.unwrap_or_default() });
            drop(frame);
            each(given, known);
        }
        Ok(Ok(all))
    }

    /// Judges all frames. `fetch` gives the pairs of a frame whose answer is not the right one;
    /// frames are asked for in order.
    pub fn judge(
        &mut self,
        said: Said<'_>,
        mut fetch: impl FnMut(u64) -> Result<Contacts, String>,
    ) -> anyhow::Result<Result<(Judged, Course), Nothing>> {
        let Said { arithmetic, may_miss, steps } = said;
        let right = match self.known(arithmetic)? {
            Ok(right) => right,
            Err(nothing) => return Ok(Err(nothing)),
        };
        let unseen = |why: &str| Ok(Ok((Judged::unseen(why), Course::default())));
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
        for (k, (&found, right)) in found.iter().zip(&right).enumerate() {
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
            let given = self.read(k)?;
            let mut frame = AtRest::new(&given, self.memory_limit)?;
            let known = match frame.known(arithmetic)? {
                Ok(known) => known,
                Err(nothing) => return Ok(Err(nothing)),
            };
            if let Known::InBox(periodic, _) = &known {
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
            match frame.judge(arithmetic, found, || Ok(contacts))? {
                Ok(Judged { errors: Some(of_frame), causes: Some(by_cause), .. }) => {
                    own.add(&by_cause.search);
                    errors.add(&of_frame);
                    causes.add(&by_cause);
                }
                Ok(_) => return unseen(&format!("nothing is known of frame {k}")),
                Err(nothing) => return Ok(Err(nothing)),
            }
        }
        course.late.end();
        let mut judged = Judged::by(&own, arithmetic);
        if may_miss && own.missed > 0 && own.wrong() == own.missed {
            judged.outcome = Outcome::Lossy;
        }
        (judged.errors, judged.causes) = (Some(errors), Some(causes));
        Ok(Ok((judged, course)))
    }

    /// Notes what is late in a frame; none were asked for where the answer is right.
    fn late(
        &self,
        late: &mut Late,
        k: usize,
        known: &Known,
        names: &Names,
        said: &Option<Contacts>,
    ) -> Result<(), String> {
        match known {
            Known::Open(truths) => {
                let truth = &truths.rounded.pairs;
                let mut said = said.as_ref().map_or_else(|| truth.clone(), |it| it.plain.clone());
                normalise(&mut said);
                late.take(k as u64, &*truths.stored, &said, truth);
            }
            Known::InBox(periodic, truth) => {
                let sorted = |said: &Contacts| {
                    let sorted = said.sorted(periodic.scene().len(), self.memory_limit);
                    sorted.map_err(|refusal| refusal.to_string())
                };
                let said = said.as_ref().map(sorted).transpose()?;
                let said = said.as_ref().unwrap_or(&truth.pairs);
                late.take(k as u64, &(&**periodic, names), said, &truth.pairs);
            }
        }
        Ok(())
    }
}
