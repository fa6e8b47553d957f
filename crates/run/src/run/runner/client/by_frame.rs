//! Sends a trajectory frame by frame to runners that take one frame at a time.

use std::collections::BTreeMap;

use crate::run::runner::client::{Client, Failure};
use crate::run::runner::protocol::{Counted, Memory, Reply, Request, Sample, Steps};
use crate::run::runner::trajectory::Trajectory;
use crate::run::stage::passes::astray;
use contactbench_record::record::row::Outcome;

/// Requests every frame, and combines the replies to one. Each frame is loaded on its own, so the
/// runner cannot reuse what it computed for earlier frames.
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

#[derive(Default)]
struct Whole {
    steps: Steps,
    step_ns: Vec<u64>,
    counts: BTreeMap<String, u64>,
    memory: Memory,
}

impl Whole {
    /// Adds the reply for one frame, or returns it if it is of another kind.
    fn take(&mut self, reply: Reply) -> Result<(), Reply> {
        let found = match reply {
            Reply::Sample(sample) => {
                self.step_ns.push(sample.time_ns);
                sample.found
            }
            Reply::Count(counted) => {
                for (name, count) in counted.counts {
                    let all = self.counts.entry(name).or_default();
                    *all = all.saturating_add(count);
                }
                counted.found
            }
            Reply::Memory(one) => {
                let all = &mut self.memory;
                all.peak_bytes = all.peak_bytes.max(one.peak_bytes);
                all.live_bytes = all.live_bytes.max(one.live_bytes);
                all.allocations = all.allocations.saturating_add(one.allocations);
                all.warm_allocations = all.warm_allocations.max(one.warm_allocations);
                all.formula_bytes = all.formula_bytes.max(one.formula_bytes);
                one.found
            }
            other => return Err(other),
        };
        self.steps.contacts.push(found.contacts);
        self.steps.digests.push(found.digest);
        Ok(())
    }

    fn reply(self, request: &Request) -> Reply {
        let Whole { steps, step_ns, counts, memory } = self;
        let found = steps.into();
        match request {
            Request::Count => Reply::Count(Counted { counts, found }.into()),
            Request::Memory => Reply::Memory(Memory { found, ..memory }.into()),
            _ => {
                // The combined reply is one pass: each frame counts as one detection with its mean
                // time.
                let elapsed_ns = step_ns.iter().fold(0u64, |all, ns| all.saturating_add(*ns));
                let calls = step_ns.len().max(1) as u64;
                let time_ns = (elapsed_ns + calls / 2) / calls;
                let (building_ns, first_ns) = (None, None);
                let sample =
                    Sample { time_ns, calls, elapsed_ns, step_ns, building_ns, first_ns, found };
                Reply::Sample(sample.into())
            }
        }
    }
}
