//! The judge: decides whether an answer is right, lossy or wrong, and why. No other code decides
//! this. A scene at rest counts as a trajectory of one frame.

mod frame;

use std::borrow::Cow;
use std::collections::HashMap;
use std::rc::Rc;

use anyhow::Context;
use frame::{Differs, JudgedFrame, Truths};

use crate::run::machine::interrupt;
use crate::run::runner::protocol::Found;
use crate::run::runner::trajectory::Trajectory;
use crate::tracking::{Builds, Late, Moved, Survey};
use contactbench_detectors::oracle::loaded::depth;
use contactbench_detectors::oracle::{Causes, Errors, NoTruth};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::periodic::{ContactList, ImagePair};
use contactbench_io::Given;
use contactbench_record::record::row::Outcome;
use contactbench_scenes::touching::in_any_box;
use contactbench_terms::mix::splitmix64;

/// Judges the answers for one trajectory. The truth is computed when it is first needed.
pub struct Judge<'a> {
    /// The files of the frames; `None` for a scene at rest, which stays in memory.
    trajectory: Option<Trajectory>,
    memory_limit: u64,
    frame: Option<(usize, JudgedFrame<'a>)>,
    right: Known<Rc<[Right]>>,
    /// Verdicts on earlier answers, which timed samples often repeat.
    seen: HashMap<(Arithmetic, String, u64, u64), (Judged, Tracked)>,
}

type Known<T> = HashMap<Arithmetic, Result<T, Nothing>>;

/// Stores a result. Defects of this program and unreadable files are not stored.
fn kept<T: Clone>(
    known: &mut Known<T>,
    arithmetic: Arithmetic,
    found: anyhow::Result<T>,
) -> anyhow::Result<T> {
    let found = match found {
        Ok(found) => Ok(found),
        Err(error) => Err(nothing(error)?),
    };
    known.insert(arithmetic, found.clone());
    Ok(found?)
}

#[derive(Clone)]
struct Right {
    digest: Digest,
    differs: Differs,
}

/// Why the truth of a scene is unknown in an arithmetic.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{reason}")]
pub struct Nothing {
    pub reason: String,
    /// Whether no detector can answer either: there are too many contacts, or the box is invalid.
    pub hopeless: bool,
}

/// Returns why the truth is unknown, or the error if it has another cause.
fn nothing(error: anyhow::Error) -> anyhow::Result<Nothing> {
    let reason = match error.downcast::<Nothing>() {
        Ok(nothing) => return Ok(nothing),
        Err(error) => error.downcast::<NoTruth>()?,
    };
    let hopeless = match &reason {
        NoTruth::Refused(refusal) => refusal.is_of_scene(),
        NoTruth::Stored(_) | NoTruth::TooLarge { .. } => false,
        _ => return Err(reason.into()),
    };
    Ok(Nothing { reason: reason.to_string(), hopeless })
}

#[derive(Default)]
pub struct Count {
    pub first: u64,
    pub most: u64,
}

#[derive(Clone, Copy)]
pub(crate) struct Said<'a> {
    pub arithmetic: Arithmetic,
    pub may_miss: bool,
    pub found: &'a Found,
}

/// Rebuilds and late contacts of a tracker, from its answers to several frames.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tracked {
    pub builds: Builds,
    pub late: Late,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Judged {
    /// `ok`, `lossy` or `wrong`; `refused` if the truth is unknown.
    pub outcome: Outcome,
    pub reason: String,
    /// Errors compared with exact decisions on the given scene; `None` if the pairs are unknown.
    pub errors: Option<Errors>,
    /// Errors by cause. In a box, storing the scene means storing particles and images.
    pub causes: Option<Causes>,
}

impl Judged {
    fn without_pairs(outcome: Outcome, reason: String) -> (Judged, Tracked) {
        (Judged { outcome, reason, errors: None, causes: None }, Tracked::default())
    }

    fn unseen(why: &str) -> (Judged, Tracked) {
        let reason = format!("the pairs differ from the truth, and could not be read: {why}");
        Judged::without_pairs(Outcome::Wrong, reason)
    }

    fn new(differs: Differs, Said { arithmetic, may_miss, .. }: Said<'_>) -> Judged {
        let Differs { own, errors, causes } = differs;
        let only_missed = own.missed > 0 && own.wrong() == own.missed;
        let outcome = match outcome(&own, arithmetic) {
            _ if may_miss && only_missed => Outcome::Lossy,
            outcome => outcome,
        };
        let reason = match outcome {
            Outcome::Ok => String::new(),
            _ => format!("against the true pairs in {}: {own}", arithmetic.name()),
        };
        Judged { outcome, reason, errors, causes }
    }
}

/// Returns the outcome for these errors: `ok`; `lossy`, if contacts are missing, nothing else is
/// wrong and the arithmetic allows it; or `wrong`.
pub fn outcome(errors: &Errors, arithmetic: Arithmetic) -> Outcome {
    if errors.wrong() == 0 {
        Outcome::Ok
    } else if errors.wrong() == errors.missed && !arithmetic.is_safe() {
        Outcome::Lossy
    } else {
        Outcome::Wrong
    }
}

impl<'a> Judge<'a> {
    /// Judges a scene at rest. A list of contacts may use `memory_limit` bytes. Fails if the box
    /// does not fit the scene.
    pub fn new(given: &'a Given, memory_limit: u64) -> anyhow::Result<Judge<'a>> {
        let frame = JudgedFrame::new(Cow::Borrowed(given), memory_limit)?;
        Ok(Judge { frame: Some((0, frame)), ..Judge::of(None, memory_limit) })
    }

    /// Judges all frames of a trajectory. Also returns statistics of the motion, if the truth is
    /// known in all frames.
    pub fn moving(
        trajectory: Trajectory,
        memory_limit: u64,
    ) -> anyhow::Result<(Judge<'static>, Option<Moved>)> {
        let (mut judge, mut survey) =
            (Judge::of(Some(trajectory), memory_limit), Survey::default());
        let found = judge.right(Arithmetic::Exact, |given, truths| {
            let truth = truths.own.sorted(given.scene.len(), u64::MAX);
            let truth = truth.map_err(NoTruth::from)?;
            survey.take(&in_any_box(given)?, &truth);
            Ok(())
        });
        let moved = match found {
            Ok(_) => Some(survey.moved),
            Err(error) => nothing(error).map(|_| None)?,
        };
        Ok((judge, moved))
    }

    fn of(trajectory: Option<Trajectory>, memory_limit: u64) -> Judge<'a> {
        let (right, seen) = (HashMap::new(), HashMap::new());
        Judge { trajectory, memory_limit, frame: None, right, seen }
    }

    /// Judges an answer. `fetch` returns the pairs of a frame, and is called in the order of
    /// frames. It is not called for a frame whose answer is right, nor for an answer that was
    /// judged before.
    pub(crate) fn judge(
        &mut self,
        subject: &str,
        said: Said<'_>,
        fetch: impl FnMut(u64) -> Result<ContactList, String>,
    ) -> anyhow::Result<(Judged, Tracked)> {
        let answers = match said.found.answers() {
            Ok(answers) => answers,
            Err(why) => return Ok(Judged::without_pairs(Outcome::Wrong, why)),
        };
        // Two answers are equal only if neighbour lists were rebuilt in the same frames.
        let steps = &said.found.steps;
        let flags = steps.built.iter().chain(&steps.dangerous).map(|&flag| u64::from(flag));
        let sums = answers.iter().flat_map(|answer| [answer.contacts, answer.sum]);
        let sum = sums.chain(flags).fold(0, |hash, next| splitmix64(hash ^ next));
        let key = (said.arithmetic, subject.to_string(), said.found.contacts, sum);
        if let Some(known) = self.seen.get(&key) {
            return Ok(known.clone());
        }
        let judged = self.hold(said, &answers, fetch).or_else(|why| {
            let reason = format!("the answer cannot be checked: {}", nothing(why)?.reason);
            anyhow::Ok(Judged::without_pairs(Outcome::Refused, reason))
        })?;
        if judged.0.errors.is_some() {
            self.seen.insert(key, judged.clone());
        }
        Ok(judged)
    }

    fn hold(
        &mut self,
        said: Said<'_>,
        answers: &[Digest],
        mut fetch: impl FnMut(u64) -> Result<ContactList, String>,
    ) -> anyhow::Result<(Judged, Tracked)> {
        let (arithmetic, steps, moving) =
            (said.arithmetic, &said.found.steps, self.trajectory.is_some());
        let right = self.right(arithmetic, |_, _| Ok(()))?;
        let (asked, given) = (right.len(), answers.len());
        if given != asked {
            return Ok(Judged::unseen(&format!(
                "the reply has answers to {given} of {asked} frames"
            )));
        }
        let (errors, causes) = (Some(Errors::default()), Some(Causes::default()));
        let mut all = Differs { errors, causes, ..Differs::default() };
        let mut tracked = Tracked::default();
        for (k, (&found, right)) in answers.iter().zip(&*right).enumerate() {
            let flag = |flags: &[bool]| flags.get(k) == Some(&true);
            let missed = tracked.late.missed;
            tracked.builds.take(flag(&steps.built), flag(&steps.dangerous), missed);
            let mut contacts = None;
            if found == right.digest {
                all.add(&right.differs);
                if !tracked.late.is_open() {
                    continue;
                }
            } else {
                let why = match fetch(k as u64) {
                    Ok(mut fetched) if fetched.digest() == found => {
                        fetched.sort();
                        contacts = Some(fetched);
                        None
                    }
                    Ok(_) => Some("the written pairs do not have the reported digest".to_string()),
                    Err(why) => Some(why),
                };
                if let Some(why) = why {
                    let place = if moving { format!("frame {k}: ") } else { String::new() };
                    return Ok(Judged::unseen(&format!("{place}{why}")));
                }
            }
            let limit = self.memory_limit;
            let frame = self.frame(k)?;
            if moving {
                let known = frame.known(arithmetic)?;
                let reported = contacts.as_ref().map(|it| sorted(it, &known, limit)).transpose()?;
                let truth = sorted(&known.own, &known, u64::MAX)?;
                let depth = |pair| depth(&known.stored, pair);
                tracked.late.take(k as u64, depth, reported.as_ref().unwrap_or(&truth), &truth);
            }
            if let Some(contacts) = &contacts {
                all.add(&frame.compare(arithmetic, Some(contacts))?);
            }
        }
        tracked.late.end();
        Ok((Judged::new(all, said), tracked))
    }

    /// Returns the right answers to all frames. If they are not yet known, `each` receives every
    /// frame with its truth.
    fn right(
        &mut self,
        arithmetic: Arithmetic,
        each: impl FnMut(&Given, &Truths) -> anyhow::Result<()>,
    ) -> anyhow::Result<Rc<[Right]>> {
        if let Some(known) = self.right.get(&arithmetic) {
            return Ok(known.clone()?);
        }
        let found = self.find(arithmetic, each).map(Rc::from);
        kept(&mut self.right, arithmetic, found)
    }

    fn find(
        &mut self,
        arithmetic: Arithmetic,
        mut each: impl FnMut(&Given, &Truths) -> anyhow::Result<()>,
    ) -> anyhow::Result<Vec<Right>> {
        let frames = self.trajectory.as_ref().map_or(1, |trajectory| trajectory.frames.len());
        let mut all = Vec::new();
        for k in 0..frames {
            interrupt::check()?;
            let frame = self.frame(k)?;
            let (truths, differs) = (frame.known(arithmetic)?, frame.compare(arithmetic, None)?);
            all.push(Right { digest: truths.own.digest(), differs });
            each(&frame.given, &truths)?;
        }
        Ok(all)
    }

    fn frame(&mut self, k: usize) -> anyhow::Result<&mut JudgedFrame<'a>> {
        if let Some(trajectory) = &self.trajectory
            && self.frame.as_ref().is_none_or(|(last, _)| *last != k)
        {
            // Only one frame is in memory at a time.
            self.frame = None;
            let given = Cow::Owned(trajectory.read_frame(k)?);
            self.frame = Some((k, JudgedFrame::new(given, self.memory_limit)?));
        }
        self.frame.as_mut().map(|(_, frame)| frame).context("there is no frame")
    }

    pub fn count(&mut self, arithmetic: Arithmetic) -> anyhow::Result<(Count, Option<Nothing>)> {
        match self.right(arithmetic, |_, _| Ok(())) {
            Ok(right) => {
                let contacts = || right.iter().map(|right| right.digest.contacts);
                let (first, most) = (contacts().next(), contacts().max());
                let count = Count { first: first.unwrap_or(0), most: most.unwrap_or(0) };
                Ok((count, None))
            }
            Err(why) => Ok((Count::default(), Some(nothing(why)?))),
        }
    }
}

/// Returns the contacts in ascending order; the list of them may use `limit` bytes.
fn sorted(contacts: &ContactList, known: &Truths, limit: u64) -> anyhow::Result<Vec<ImagePair>> {
    Ok(contacts.sorted(known.stored.particles(), limit).map_err(NoTruth::from)?)
}

#[cfg(test)]
mod tests;
