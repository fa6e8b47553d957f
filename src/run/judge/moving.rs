//! The judge of trajectories: every frame of an answer is held to what is true in it.

use std::collections::HashMap;

use crate::contact::Arithmetic;
use crate::moving::{Builds, Late, Moved};
use crate::oracle::{Causes, Errors};
use crate::periodic::Contacts;
use crate::record::row::Outcome;
use crate::run::interrupt;
use crate::run::judge::open::Open;
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
        let (mut moved, mut last) = (Moved::default(), None::<(Given, Vec<[u32; 2]>)>);
        let mut moving = Moving { trajectory, memory_limit, known: HashMap::new() };
        let exact = moving.find(Arithmetic::Exact, |given, truth| {
            let before = last.as_ref().map(|(given, pairs)| (&given.scene, &pairs[..]));
            moved.take(before, &given.scene, truth, memory_limit);
            last = Some((given, truth.to_vec()));
        })?;
        let moved = exact.is_ok().then_some(moved);
        moving.known.insert(Arithmetic::Exact, exact);
        Ok((moving, moved))
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
        self.trajectory.read_frame(&self.trajectory.frames[k])
    }

    /// The right answers of all frames; `each` sees the frames with their pairs.
    fn find(
        &self,
        arithmetic: Arithmetic,
        mut each: impl FnMut(Given, &[[u32; 2]]),
    ) -> anyhow::Result<Result<Vec<Right>, Nothing>> {
        let mut all = Vec::new();
        for k in 0..self.trajectory.frames.len() {
            interrupt::check()?;
            let given = self.read(k)?;
            let mut open = Open::new(&given.scene, self.memory_limit);
            let truths = match open.known(arithmetic)? {
                Ok(truths) => truths,
                Err(nothing) => return Ok(Err(nothing)),
            };
            let digest = truths.rounded.digest;
            let never = || Err("the right answer is known".into());
            let judged = match open.judge(arithmetic, digest, never)? {
                Ok(judged) => judged,
                Err(nothing) => return Ok(Err(nothing)),
            };
            let (errors, causes) = (judged.errors.unwrap_or_default(), judged.causes);
            all.push(Right { digest, errors, causes: causes.unwrap_or_default() });
            drop(open);
            each(given, &truths.rounded.pairs);
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
        let mut course = Course::default();
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
            let mut open = Open::new(&given.scene, self.memory_limit);
            let truths = match open.known(arithmetic)? {
                Ok(truths) => truths,
                Err(nothing) => return Ok(Err(nothing)),
            };
            let (frame, truth) = (k as u64, &truths.rounded.pairs);
            if is_right {
                course.late.take(frame, &truths.stored, truth, truth);
                continue;
            }
            let contacts = match fetch(frame) {
                Ok(contacts) if contacts.digest() == found => contacts,
                Ok(_) => return unseen(&format!("asked for frame {k}, it gave others")),
                Err(why) => return unseen(&format!("frame {k}: {why}")),
            };
            let mut pairs = contacts.plain.clone();
            normalise(&mut pairs);
            match open.judge(arithmetic, found, || Ok(contacts))? {
                Ok(Judged { errors: Some(of_frame), causes: Some(by_cause), .. }) => {
                    own.add(&by_cause.search);
                    errors.add(&of_frame);
                    causes.add(&by_cause);
                }
                Ok(_) => return unseen(&format!("nothing is known of frame {k}")),
                Err(nothing) => return Ok(Err(nothing)),
            }
            course.late.take(frame, &truths.stored, &pairs, truth);
        }
        course.late.end();
        let mut judged = Judged::by(&own, arithmetic);
        if may_miss && own.missed > 0 && own.wrong() == own.missed {
            judged.outcome = Outcome::Lossy;
        }
        (judged.errors, judged.causes) = (Some(errors), Some(causes));
        Ok(Ok((judged, course)))
    }
}
