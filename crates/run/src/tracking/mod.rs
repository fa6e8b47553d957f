//! Compares trackers with the truth in every frame: their cost, and the contacts that they miss.
//! The truth can be limited to the contacts of a random sample of the particles.

#[cfg(test)]
mod box_tests;
mod builds;
mod displacement;
mod late;
mod recorded;
mod survey;

use std::time::{Duration, Instant};

use contactbench_detectors::oracle::random;
use contactbench_detectors::tracker::TrackerSpec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::periodic::{ContactList, ImagePair, Loaded};
use contactbench_io::Given;
use contactbench_lists::track::Tracker;
use contactbench_scenes::touching::in_any_box;

pub use builds::Builds;
use contactbench_detectors::oracle::loaded as truth;
pub use contactbench_terms::moved::{Displacements, Moved};
pub(crate) use displacement::nearest;
pub use late::Late;
pub use recorded::Recorded;
pub use survey::Survey;

pub struct Question<'a> {
    pub trackers: &'a [TrackerSpec],
    pub arithmetic: Arithmetic,
    /// Maximum number of frames, the first included.
    pub frames: u64,
    pub memory_limit: u64,
    pub check: Check,
}

/// Which contacts are compared with the truth, in every frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    All,
    /// Contacts of this many random particles, the same in all frames.
    Sample(usize),
    None,
}

/// Seed of the sample.
pub const SEED: u32 = 1;

#[derive(Debug)]
pub struct Followed {
    /// Measures of the motion; contact counts include only checked contacts.
    pub moved: Moved,
    /// Which contacts were checked: all, also if the sample includes all particles.
    pub check: Check,
    pub trackers: Vec<Tracked>,
}

#[derive(Clone, Debug)]
pub struct Tracked {
    pub spec: TrackerSpec,
    /// Whether the tracker's rule guarantees that no contact is missed.
    pub is_safe: bool,
    pub times: Vec<Duration>,
    pub building: Duration,
    pub builds: Builds,
    pub listed: u64,
    pub reported: u64,
    pub spurious: u64,
    pub late: Late,
    /// Memory kept between frames in bytes, computed by a formula.
    pub bytes: u64,
    pub refused: Option<String>,
}

impl Tracked {
    pub fn is_wrong(&self) -> bool {
        self.spurious > 0 || self.is_safe && self.late.missed > 0
    }
}

struct Follower {
    tracker: Box<dyn Tracker>,
    tracked: Tracked,
    contacts: ContactList,
}

/// Runs all trackers on the frames, and compares them with the truth. `frame` returns the frame of
/// a number, and `None` after the last. Making frames and finding the truth is not timed.
///
/// # Errors
/// Fails if a frame cannot be made or stored, or has no truth. Refusals of trackers are results.
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
            tracked: Tracked {
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
            },
            contacts: ContactList::default(),
        })
        .collect();
    let (mut survey, mut check) = (Survey::default(), question.check);
    let mut chosen: Option<Vec<bool>> = None;
    for k in 0..question.frames {
        let Some(given) = frame(k)? else { break };
        let frame = given.loaded(arithmetic)?;
        let n = frame.particles();
        // Every frame has the same particles.
        if k == 0 {
            (check, chosen) = match check {
                Check::Sample(count) if count < n => (check, Some(random(n, count, SEED))),
                Check::None => (check, Some(vec![false; n])),
                _ => (Check::All, None),
            };
        }
        let chosen = chosen.as_deref();
        let truth = match (check, chosen) {
            (Check::None, _) => Vec::new(),
            (_, Some(chosen)) => truth::touching(&frame, arithmetic, chosen, memory_limit)?,
            _ => truth::truth(&frame, arithmetic, memory_limit)?.pairs,
        };
        survey.take(&in_any_box(&given)?, &truth);
        let going = followers.iter_mut().filter(|follower| follower.tracked.refused.is_none());
        going.for_each(|follower| {
            if let Err(why) = follower.step(k, &frame, question, (chosen, &truth)) {
                follower.tracked.refused = Some(format!("frame {k}: {why}"));
            }
        });
    }
    let trackers = followers.into_iter().map(|mut follower| {
        follower.tracked.late.end();
        follower.tracked
    });
    Ok(Followed { moved: survey.moved, check, trackers: trackers.collect() })
}

impl Follower {
    fn step(
        &mut self,
        k: u64,
        frame: &Loaded<'_>,
        question: &Question<'_>,
        (chosen, truth): (Option<&[bool]>, &[ImagePair]),
    ) -> Result<(), Refusal> {
        let Follower { tracker, tracked, contacts } = self;
        contacts.clear();
        let started = Instant::now();
        let step = tracker.find(frame.frame(question.arithmetic), None, contacts)?;
        tracked.times.push(started.elapsed());
        tracked.builds.take(step.built, step.dangerous, tracked.late.missed);
        tracked.building += step.building;
        tracked.listed = tracked.listed.saturating_add(step.listed);
        tracked.reported += contacts.len();
        tracked.bytes = tracked.bytes.max(tracker.formula_bytes());
        if question.check == Check::None {
            return Ok(());
        }
        let is_chosen = |k: u32| chosen.is_none_or(|chosen| chosen[k as usize]);
        let filtered =
            chosen.map(|_| contacts.filtered(|pair| is_chosen(pair.i) || is_chosen(pair.j)));
        let checked = filtered.as_ref().unwrap_or(contacts);
        let found = checked.sorted(frame.particles(), question.memory_limit)?;
        let depth = |pair| truth::depth(frame, pair);
        tracked.spurious += tracked.late.take(k, depth, &found, truth);
        Ok(())
    }
}
