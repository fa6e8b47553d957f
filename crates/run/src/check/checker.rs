use std::mem::discriminant;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::answer::{Question, Respondent};
use super::cases::Scene;
use super::shrink::shrink;
use super::subject::CheckedSubject;
use super::{Failure, Limits, MOST_BYTES, Report, Wrong};
use contactbench_detectors::oracle::NoTruth;
use contactbench_detectors::oracle::boxes::Truth;
use contactbench_detectors::oracle::loaded::truth;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::periodic::Loaded;
use contactbench_ground::scene::AnyScene;
use contactbench_io::Given;

pub(super) struct Checker<'a> {
    limits: &'a Limits,
    started: Instant,
    arithmetics: &'a [Arithmetic],
    subjects: Vec<(&'a CheckedSubject, Box<dyn Respondent>)>,
    pub(super) report: Report,
}

impl<'a> Checker<'a> {
    pub(super) fn new(
        subjects: &'a [CheckedSubject],
        arithmetics: &'a [Arithmetic],
        limits: &'a Limits,
    ) -> anyhow::Result<Checker<'a>> {
        let entered = |subject: &'a CheckedSubject| {
            Ok((subject, subject.respondent(limits.options, limits.deadline)?))
        };
        let subjects = subjects.iter().map(entered).collect::<anyhow::Result<_>>()?;
        let (started, report) = (Instant::now(), Report::default());
        Ok(Checker { limits, started, arithmetics, subjects, report })
    }

    fn decided(&self) -> bool {
        self.report.failures.len() == self.subjects.len()
    }

    pub(super) fn over(&self) -> bool {
        self.started.elapsed() > self.limits.time || self.decided()
    }

    /// Checks scene after scene. Returns false if the check stops early: no subject is left or, if
    /// `in_time`, the time is over.
    pub(super) fn all(
        &mut self,
        scenes: impl Iterator<Item = anyhow::Result<Scene>>,
        in_time: bool,
    ) -> anyhow::Result<bool> {
        for scene in scenes {
            if self.decided() || in_time && self.over() {
                return Ok(false);
            }
            self.scene(&scene?)?;
        }
        Ok(true)
    }

    pub(super) fn scene(&mut self, scene: &Scene) -> anyhow::Result<()> {
        let Scene { source, name, given } = scene;
        *self.report.scenes.entry(source).or_default() += 1;
        for &arithmetic in self.arithmetics {
            let (stored, truth) = match known(given, arithmetic, self.limits)? {
                Ok(known) => known,
                Err(error) => {
                    let reason = format!("{}: {error}", arithmetic.name());
                    *self.report.refused.entry(reason).or_default() += 1;
                    continue;
                }
            };
            for (subject, respondent) in &mut self.subjects {
                if self.report.failures.iter().any(|failure| failure.detector == subject.name()) {
                    continue;
                }
                let question =
                    Question { given, stored: &stored, arithmetic, fresh: false, truth: &truth };
                let answer = respondent.ask(&question)?;
                if let Some(reason) = answer.refusal() {
                    let reason = format!("{}: {reason}", subject.name());
                    *self.report.refused.entry(reason).or_default() += 1;
                } else {
                    self.report.cases += 1;
                    let of = (subject.name().to_string(), arithmetic.name());
                    *self.report.compared.entry(of).or_default() += 1;
                }
                if let Some(found) = answer.wrong(&truth) {
                    let (smallest, wrong) =
                        simplest(subject, arithmetic, given, &found, self.limits)?;
                    self.report.failures.push(Failure {
                        detector: subject.name().to_string(),
                        arithmetic,
                        found_on: name.clone(),
                        found,
                        given: given.clone(),
                        smallest,
                        wrong,
                    });
                }
            }
        }
        Ok(())
    }
}

/// Returns a scene as the arithmetic stores it, with its truth, or the reason why it has none.
fn known(
    given: &Given,
    arithmetic: Arithmetic,
    limits: &Limits,
) -> anyhow::Result<Result<(Arc<Loaded<'static>>, Truth), String>> {
    let stored = match given.loaded(arithmetic) {
        Ok(stored) => stored,
        Err(error) => return Ok(Err(format!("{error:#}"))),
    };
    match truth(&stored, arithmetic, limits.options.memory_limit) {
        Ok(truth) => Ok(Ok((Arc::new(stored), truth))),
        Err(error @ (NoTruth::Refused(_) | NoTruth::Stored(_))) => Ok(Err(error.to_string())),
        Err(error) => Err(error.into()),
    }
}

/// Deadline and maximum number of hangs while shrinking. Each hang leaves a thread behind.
const SHRINKING_DEADLINE: Duration = Duration::from_secs(1);
const SHRINKING_HANGS: u32 = 2;

/// Finds the smallest scene on which a fresh detector is wrong, and its error there.
fn simplest(
    subject: &CheckedSubject,
    arithmetic: Arithmetic,
    given: &Given,
    found: &Wrong,
    limits: &Limits,
) -> anyhow::Result<(Given, Option<Wrong>)> {
    if matches!(found, Wrong::Hangs(_)) {
        return Ok((given.clone(), Some(found.clone())));
    }
    let in_box = |scene: AnyScene<'static>| Given { lattice: given.lattice, ..scene.into() };
    let wrong = |respondent: &mut dyn Respondent,
                 given: &Given,
                 fresh: bool|
     -> anyhow::Result<Option<Wrong>> {
        let Ok(Ok((stored, truth))) = known(given, arithmetic, limits) else { return Ok(None) };
        let question = Question { given, stored: &stored, arithmetic, fresh, truth: &truth };
        Ok(respondent.ask(&question)?.wrong(&truth))
    };
    let mut patient = subject.respondent(limits.options, limits.deadline)?;
    let Some(first) = wrong(&mut *patient, given, true)? else { return Ok((given.clone(), None)) };
    let options =
        Options { memory_limit: limits.options.memory_limit.min(MOST_BYTES), ..limits.options };
    let mut respondent = subject.respondent(options, limits.deadline.min(SHRINKING_DEADLINE))?;
    let mut hangs = 0;
    let mut smaller = |fresh: bool| {
        in_box(shrink(&given.scene, limits.effort, |scene| {
            hangs < SHRINKING_HANGS
                && match wrong(&mut *respondent, &in_box(scene.clone()), fresh) {
                    Ok(Some(Wrong::Hangs(_))) | Err(_) => {
                        hangs += 1;
                        false
                    }
                    // Only the same kind of error counts; otherwise shrinking could end at another
                    // defect.
                    Ok(wrong) => {
                        wrong.is_some_and(|wrong| discriminant(&wrong) == discriminant(&first))
                    }
                }
        }))
    };
    if matches!(subject, CheckedSubject::Runner(_)) {
        // Most runners keep nothing from earlier scenes. So they are not restarted, which is a
        // hundred times faster.
        let smallest = smaller(false);
        if let Some(wrong) = wrong(&mut *patient, &smallest, true)?
            .filter(|wrong| discriminant(wrong) == discriminant(&first))
        {
            return Ok((smallest, Some(wrong)));
        }
    }
    let smallest = smaller(true);
    let wrong = wrong(&mut *patient, &smallest, true)?;
    Ok((smallest, wrong))
}
