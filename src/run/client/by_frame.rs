//! A trajectory for runners that take scenes at rest: frame after frame, as one whole answer.

use std::collections::BTreeMap;

use crate::record::row::Outcome;
use crate::run::client::{Client, Failure};
use crate::run::passes::astray;
use crate::run::protocol::{Reply, Request, Steps};
use crate::run::trajectory::Trajectory;

/// The answer to a request about a trajectory of several frames, of which the runner gets one at a
/// time. Each frame is a scene at rest that has just been loaded: nothing is kept from the frame
/// before.
pub(super) fn ask(
    client: &mut Client,
    trajectory: &Trajectory,
    request: &Request,
) -> Result<Reply, Failure> {
    let count = trajectory.frames.len();
    let each = match request {
        Request::Sample { min_ns } => {
            Request::Sample { min_ns: (min_ns / count.max(1) as u64).max(1) }
        }
        Request::Pairs { path, frame } => {
            let k = frame.map_or(Some(count - 1), |k| usize::try_from(k).ok());
            let Some(k) = k.filter(|&k| k < count) else {
                let reason = format!("there is no frame {k:?}; the trajectory has {count}");
                return Err(Failure { outcome: Outcome::Crashed, reason });
            };
            return at(client, trajectory, k, &Request::Pairs { path: path.clone(), frame: None });
        }
        other => other.clone(),
    };
    let mut whole: Option<Whole> = None;
    for k in 0..count {
        let reply = at(client, trajectory, k, &each)?;
        if reply == Reply::Unsupported {
            return Ok(reply);
        }
        whole.get_or_insert_default().take(reply).map_err(|reply| astray(&each, &reply))?;
    }
    let whole = whole.unwrap_or_default();
    Ok(whole.reply(&each))
}

/// The answer to a request about one frame.
fn at(
    client: &mut Client,
    trajectory: &Trajectory,
    k: usize,
    request: &Request,
) -> Result<Reply, Failure> {
    let of_frame =
        |failure: Failure| Failure { reason: format!("frame {k}: {}", failure.reason), ..failure };
    let load = Request::Load(trajectory.at_rest(k));
    match client.ask_one(&load).map_err(of_frame)? {
        Reply::Loaded => client.ask_one(request).map_err(of_frame),
        other => Err(of_frame(astray(&load, &other))),
    }
}

/// The answers to all frames so far.
#[derive(Default)]
struct Whole {
    steps: Steps,
    step_ns: Vec<u64>,
    counts: BTreeMap<String, u64>,
    peak_bytes: u64,
    live_bytes: u64,
    allocations: u64,
    warm_allocations: Option<u64>,
    formula_bytes: Option<u64>,
}

impl Whole {
    /// Takes the answer to one more frame; one that belongs to another request is given back.
    fn take(&mut self, reply: Reply) -> Result<(), Reply> {
        let (contacts, digest) = match reply {
            Reply::Sample { time_ns, contacts, digest, .. } => {
                self.step_ns.push(time_ns);
                (contacts, digest)
            }
            Reply::Count { counts, contacts, digest, .. } => {
                for (name, count) in counts {
                    let all = self.counts.entry(name).or_default();
                    *all = all.saturating_add(count);
                }
                (contacts, digest)
            }
            Reply::Memory {
                peak_bytes,
                live_bytes,
                allocations,
                warm_allocations,
                formula_bytes,
                contacts,
                digest,
                ..
            } => {
                self.peak_bytes = self.peak_bytes.max(peak_bytes);
                self.live_bytes = self.live_bytes.max(live_bytes);
                self.allocations = self.allocations.saturating_add(allocations);
                self.warm_allocations = self.warm_allocations.max(warm_allocations);
                self.formula_bytes = self.formula_bytes.max(formula_bytes);
                (contacts, digest)
            }
            other => return Err(other),
        };
        self.steps.contacts.push(contacts);
        self.steps.digests.push(digest);
        Ok(())
    }

    fn reply(self, request: &Request) -> Reply {
        let Whole { steps, step_ns, counts, .. } = self;
        let ((contacts, digest), steps) = (steps.last(), Box::new(steps));
        match request {
            Request::Count => Reply::Count { counts, contacts, digest, steps },
            Request::Memory => Reply::Memory {
                peak_bytes: self.peak_bytes,
                live_bytes: self.live_bytes,
                allocations: self.allocations,
                warm_allocations: self.warm_allocations,
                formula_bytes: self.formula_bytes,
                contacts,
                digest,
                steps,
            },
            _ => {
                // One pass: of each frame the mean of its detections, of which each has its number.
                let elapsed_ns = step_ns.iter().fold(0u64, |all, ns| all.saturating_add(*ns));
                let calls = step_ns.len().max(1) as u64;
                Reply::Sample {
                    time_ns: (elapsed_ns + calls / 2) / calls,
                    calls,
                    elapsed_ns,
                    step_ns,
                    building_ns: None,
                    first_ns: None,
                    contacts,
                    digest,
                    steps,
                }
            }
        }
    }
}
