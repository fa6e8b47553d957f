//! Trackers held to the truth, frame by frame: what a kept list costs, and what it misses.

mod between;
#[cfg(test)]
mod box_tests;
mod builds;
mod course;
mod late;
mod names;
mod recorded;
mod through;

use std::time::{Duration, Instant};

use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::Options;
use contactbench_core::detect::Refusal;
use contactbench_core::oracle;
use contactbench_core::periodic::{self, Contacts, ImagePair, Periodic};
use contactbench_core::scene::AnyScene;
use contactbench_core::sink::normalise;
use contactbench_core::track::{Step, Tracker, TrackerSpec};
use contactbench_io::Given;

pub use between::{Moved, Way};
pub use builds::Builds;
pub use course::Course;
pub use late::Late;
pub use names::Names;
pub use recorded::Recorded;

/// What is asked.
pub struct Question<'a> {
    /// Who keeps lists.
    pub trackers: &'a [TrackerSpec],
    /// How contacts are decided.
    pub arithmetic: Arithmetic,
    /// Frames at most, the first among them.
    pub frames: u64,
    /// For lists, in bytes.
    pub memory_limit: u64,
}

/// What trackers did in the frames of a scene in motion.
#[derive(Debug)]
pub struct Followed {
    /// What the motion is like.
    pub moved: Moved,
    /// In the order of the question.
    pub trackers: Vec<Tracked>,
}

/// What one of them did.
#[derive(Clone, Debug)]
pub struct Tracked {
    /// Who.
    pub spec: TrackerSpec,
    /// It promises to miss nothing.
    pub is_safe: bool,
    /// The time of each frame.
    pub times: Vec<Duration>,
    /// Of all of them, for building lists.
    pub building: Duration,
    /// When it built its list.
    pub builds: Builds,
    /// Pairs that were looked at, in all frames.
    pub listed: u64,
    /// Pairs that were reported, in all frames.
    pub reported: u64,
    /// Pairs that were reported and do not touch.
    pub spurious: u64,
    /// What it missed.
    pub late: Late,
    /// Bytes between frames, by formula.
    pub bytes: u64,
    /// Why it ended before the last frame.
    pub refused: Option<String>,
}

impl Tracked {
    fn new(spec: &TrackerSpec, arithmetic: Arithmetic) -> Tracked {
        Tracked {
            spec: spec.clone(),
            is_safe: spec.is_safe(arithmetic.test()),
            times: Vec::new(),
            building: Duration::ZERO,
            builds: Builds::default(),
            listed: 0,
            reported: 0,
            spurious: 0,
            late: Late::default(),
            bytes: 0,
            refused: None,
        }
    }

    /// A tracker that promises to miss nothing did, or any reported a pair that does not touch.
    pub fn is_wrong(&self) -> bool {
        self.spurious > 0 || self.is_safe && self.late.missed > 0
    }
}

/// A tracker at work.
struct Follower {
    tracker: Box<dyn Tracker>,
    tracked: Tracked,
    contacts: Contacts,
}

/// Follows the frames with all trackers side by side, and with the truth. `frame` gives the one of
/// each number in turn, and none after the last; making frames and finding the truth is outside the
/// clock.
///
/// # Errors
/// Frames that cannot be made or stored, and scenes without a truth. What a tracker refuses is in
/// its answer.
pub fn follow(
    mut frame: impl FnMut(u64) -> anyhow::Result<Option<Given>>,
    question: &Question<'_>,
) -> anyhow::Result<Followed> {
    let Question { trackers, arithmetic, memory_limit, .. } = *question;
    let options = Options { memory_limit, threads: 1 };
    let mut followers: Vec<Follower> = trackers
        .iter()
        .map(|spec| Follower {
            tracker: spec.make(options),
            tracked: Tracked::new(spec, arithmetic),
            contacts: Contacts::default(),
        })
        .collect();
    let mut course = Course::default();
    for k in 0..question.frames {
        let Some(given) = frame(k)? else { break };
        let going = followers.iter_mut().filter(|follower| follower.tracked.refused.is_none());
        if let Some(periodic) = given.periodic()? {
            let truth = periodic::truth(&periodic, arithmetic, memory_limit)?.pairs;
            course.in_box(&periodic, &truth, memory_limit);
            let frame = (&periodic, &course.names);
            going.for_each(|follower| follower.step_in_box(k, frame, question, &truth));
        } else {
            let frame = given.scene.as_stored(arithmetic)?;
            let truth = oracle::truth_as_stored(&frame, arithmetic.test(), memory_limit)?.pairs;
            going.for_each(|follower| follower.step(k, &frame, arithmetic, &truth));
            course.open(given.scene, &truth, memory_limit);
        }
    }
    let trackers = followers.into_iter().map(|mut follower| {
        follower.tracked.late.end();
        follower.tracked
    });
    Ok(Followed { moved: course.moved, trackers: trackers.collect() })
}

impl Follower {
    fn step(&mut self, k: u64, frame: &AnyScene<'_>, arithmetic: Arithmetic, truth: &[[u32; 2]]) {
        let step = self.timed(k, |tracker, contacts| {
            tracker.step(frame, arithmetic.test(), None, &mut contacts.plain)
        });
        if step {
            let Follower { tracked, contacts: Contacts { plain, .. }, .. } = self;
            normalise(plain);
            tracked.spurious += tracked.late.take(k, frame, plain, truth);
        }
    }

    fn step_in_box(
        &mut self,
        k: u64,
        frame: (&Periodic<'_>, &Names),
        question: &Question<'_>,
        truth: &[ImagePair],
    ) {
        let step = self.timed(k, |tracker, contacts| {
            tracker.step_in_box(frame.0, question.arithmetic, None, contacts)
        });
        if step {
            let Follower { tracked, contacts, .. } = self;
            match contacts.sorted(frame.0.scene().len(), question.memory_limit) {
                Ok(found) => tracked.spurious += tracked.late.take(k, &frame, &found, truth),
                Err(refusal) => tracked.refused = Some(format!("frame {k}: {refusal}")),
            }
        }
    }

    /// Asks the tracker, and notes what it did; tells whether it answered.
    fn timed(
        &mut self,
        k: u64,
        ask: impl FnOnce(&mut dyn Tracker, &mut Contacts) -> Result<Step, Refusal>,
    ) -> bool {
        let Follower { tracker, tracked, contacts } = self;
        contacts.clear();
        let started = Instant::now();
        let step = match ask(&mut **tracker, contacts) {
            Ok(step) => step,
            Err(refusal) => {
                tracked.refused = Some(format!("frame {k}: {refusal}"));
                return false;
            }
        };
        tracked.times.push(started.elapsed());
        tracked.builds.take(step.built, step.dangerous, tracked.late.missed);
        tracked.building += step.building;
        tracked.listed = tracked.listed.saturating_add(step.listed);
        tracked.reported += contacts.len();
        tracked.bytes = tracked.bytes.max(tracker.formula_bytes());
        true
    }
}
