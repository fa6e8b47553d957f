//! Checks how a runner follows the protocol, apart from its pairs: errors that do not end it,
//! unknown fields, digests, the clock, and optional measurements.

use std::time::Duration;

use crate::check::Wrong;
use crate::check::process::{Foreign, Line, word, wrong};
use crate::run::machine::temporary;
use crate::run::runner::protocol::{Reply, Request};
use crate::run::runner::trajectory::Trajectory;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::scene::Scene;
use contactbench_io::Given;

const SAMPLE_NS: u64 = 2_000_000;

/// Tests a runner with four discs in a row, of which the first three touch. Returns the optional
/// requests that it lacks, and how it breaks the protocol. The test ends at an answer that is not a
/// reply or that cannot be true.
pub fn hold(
    foreign: &Foreign,
    deadline: Duration,
) -> anyhow::Result<(Vec<&'static str>, Vec<Wrong>)> {
    let folder = temporary()?;
    let at = |name: &str| folder.path().join(name);
    let scene = Given::from(Scene::at([0.0, 1.0, 2.0, 10.0].map(|x| [x, 0.0]), 0.5)?);
    let remark = Some("a field of a later version".into());
    let row = Trajectory { remark, ..Trajectory::write_at_rest(&at("row.npy"), &scene)? };
    let nowhere = Trajectory { frames: vec![at("not-there.npy")], ..row.clone() };
    let sample = || Request::Sample { min_ns: SAMPLE_NS };
    let pairs = Request::Pairs { path: at("pairs.npy"), frame: None };
    let mut line = Line::new(foreign, deadline);
    let (mut lacks, mut broken) = (Vec::new(), Vec::new());
    for (when, request, allowed) in [
        ("asked for a sample before any scene", sample(), &["error", "refused"][..]),
        ("given a file that is not there", Request::Load(nowhere), &["error", "refused"]),
        ("given a load with an unknown field", Request::Load(row), &["loaded", "refused"]),
        ("asked for a sample", sample(), &["sample", "refused"]),
        ("asked for a second sample", sample(), &["sample", "refused"]),
        ("asked to count", Request::Count, &["count", "unsupported", "refused"]),
        ("asked for the memory", Request::Memory, &["memory", "unsupported", "refused"]),
        ("asked for the pairs", pairs, &["pairs", "unsupported", "refused", "error"]),
    ] {
        let reply = match wrong(line.say(&request))? {
            Ok(reply) => reply,
            Err(wrong) => {
                broken.push(match wrong {
                    Wrong::Dies { how, errors } => {
                        Wrong::Dies { how: format!("{when}: {how}"), errors }
                    }
                    Wrong::Breaks(what) => Wrong::Breaks(format!("{when}: {what}")),
                    other => Wrong::Breaks(format!("{when}: {other}")),
                });
                break;
            }
        };
        let said = word(&reply);
        match allowed.iter().position(|kind| said.split(':').next() == Some(kind)) {
            None => broken.push(Wrong::Breaks(format!(
                "{when}, it answers {said}; it must answer {}",
                allowed.join(" or ")
            ))),
            Some(1..) if allowed.len() > 2 => lacks.push(allowed[0]),
            _ => {}
        }
        if let Err(what) = digest(&reply) {
            broken.push(Wrong::Breaks(format!("{when}: {what}")));
        }
    }
    Ok((lacks, broken))
}

/// Checks the digest of an answer whose number of pairs is right.
fn digest(reply: &Reply) -> Result<(), String> {
    let found = match reply {
        Reply::Sample(sample) => &sample.found,
        Reply::Count(counted) => &counted.found,
        Reply::Memory(memory) => &memory.found,
        _ => return Ok(()),
    };
    let (said, right) = (found.digest()?, Digest::from_pairs(&[[0, 1], [1, 2]]));
    contactbench_terms::must!(
        said.contacts != right.contacts || said == right,
        "it reports 2 contacts and digest {}; of the pairs 0,1 and 1,2 the digest is {}",
        said.hex(),
        right.hex()
    );
    Ok(())
}
