//! Checks how a runner follows the protocol, apart from its pairs: errors that do not end it,
//! unknown fields, digests, the clock, and optional measurements.

use std::path::Path;
use std::time::Duration;

use crate::check::Wrong;
use crate::check::process::{Foreign, Line, Stop, digest, word};
use crate::check::subject::Answer;
use crate::run::machine::disk;
use crate::run::runner::protocol::{Found, Reply, Request};
use crate::run::runner::trajectory::Trajectory;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::scene::Scene;
use contactbench_io::Given;

#[derive(Debug, Default)]
pub struct Manners {
    pub broken: Vec<Wrong>,
    pub abilities: Vec<&'static str>,
}

const SAMPLE_NS: u64 = 2_000_000;

struct Talk {
    line: Line,
    manners: Manners,
}

/// Tests a runner with four discs in a row, of which the first three touch.
pub fn hold(foreign: &Foreign, deadline: Duration) -> anyhow::Result<Manners> {
    let folder = disk::temporary()?;
    let scene = Given::from(Scene::at([0.0, 1.0, 2.0, 10.0].map(|x| [x, 0.0]), 0.5)?);
    let right = Digest::from_pairs(&[[0, 1], [1, 2]]);
    let row = Trajectory::write_at_rest(&folder.path().join("row.npy"), &scene)?;
    let line = Line { foreign: foreign.clone(), deadline, client: None };
    let mut talk = Talk { line, manners: Manners::default() };
    talk.early(&folder.path().join("not-there.npy"))?;
    talk.load(row)?;
    talk.sample(right)?;
    for (ability, request) in [("count", Request::Count), ("memory", Request::Memory)] {
        talk.measure(ability, &request, right)?;
    }
    let path = folder.path().join("pairs.npy");
    if let Some(Reply::Pairs { .. }) =
        talk.say("asked for the pairs", &Request::Pairs { path, frame: None }, &[])?
    {
        talk.manners.abilities.push("pairs");
    }
    Ok(talk.manners)
}

impl Talk {
    /// Sends a request with additional fields, and returns the reply. If there is none, notes what
    /// is wrong and returns `None`.
    fn say(
        &mut self,
        when: &str,
        request: &Request,
        fields: &[(&str, &str)],
    ) -> anyhow::Result<Option<Reply>> {
        let answer = match self.line.say(request, fields) {
            Ok(reply) => return Ok(Some(reply)),
            Err(Stop::Failed(error)) => return Err(error),
            Err(Stop::Answer(answer)) => answer,
        };
        match answer {
            Answer::Wrong(Wrong::Hangs(deadline)) => {
                let seconds = deadline.as_secs_f64();
                self.breaks(format!("{when}, it does not answer within {seconds} s"));
            }
            Answer::Wrong(Wrong::Dies { how, errors }) => {
                self.manners.broken.push(Wrong::Dies { how: format!("{when}: {how}"), errors });
            }
            Answer::Wrong(Wrong::Breaks(what)) => self.breaks(format!("{when}: {what}")),
            Answer::Wrong(other) => self.manners.broken.push(other),
            Answer::Right | Answer::Pairs(_) | Answer::Refused(..) | Answer::Declined(_) => {}
        }
        Ok(None)
    }

    fn breaks(&mut self, what: String) {
        self.manners.broken.push(Wrong::Breaks(what));
    }

    /// Sends requests that must fail without ending the runner.
    fn early(&mut self, missing: &Path) -> anyhow::Result<()> {
        let frames = vec![missing.to_path_buf()];
        let radius = Some(0.5);
        let nowhere =
            Request::Load(Trajectory { frames, dim: 2, n: 4, radius, ..Trajectory::default() });
        for (when, request) in [
            ("asked for a sample before any scene", Request::Sample { min_ns: 1 }),
            ("given a file that is not there", nowhere),
        ] {
            match self.say(when, &request, &[])? {
                None | Some(Reply::Error { .. } | Reply::Refused { .. }) => {}
                Some(other) => self.breaks(format!(
                    "{when}, it answers {}; it should answer error, and go on",
                    word(&other)
                )),
            }
        }
        Ok(())
    }

    fn load(&mut self, row: Trajectory) -> anyhow::Result<()> {
        let when = "given a load with a field that it does not know";
        match self.say(when, &Request::Load(row), &[("remark", "of a later version")])? {
            None | Some(Reply::Loaded | Reply::Refused { .. }) => {}
            Some(Reply::Error { reason }) => {
                self.breaks(format!("{when}, it answers with the error: {reason}"))
            }
            Some(other) => self.breaks(format!("{when}, it answers {}, not loaded", word(&other))),
        }
        Ok(())
    }

    fn sample(&mut self, right: Digest) -> anyhow::Result<()> {
        let request = Request::Sample { min_ns: SAMPLE_NS };
        for when in ["asked for a sample", "asked for a second sample"] {
            let Some(reply) = self.say(when, &request, &[])? else { return Ok(()) };
            if matches!(reply, Reply::Refused { .. }) {
                return Ok(());
            }
            let Reply::Sample(sample) = &reply else {
                self.breaks(format!("{when}, it answers {}", word(&reply)));
                return Ok(());
            };
            self.digest(when, &sample.found, right);
            if self.impossible(when, &request, &reply) {
                return Ok(());
            }
        }
        Ok(())
    }

    fn impossible(&mut self, when: &str, request: &Request, reply: &Reply) -> bool {
        let found = self.line.impossible(request, reply);
        let wrong = found.is_some();
        found.into_iter().for_each(|what| self.breaks(format!("{when}, {what}")));
        wrong
    }

    fn measure(
        &mut self,
        ability: &'static str,
        request: &Request,
        right: Digest,
    ) -> anyhow::Result<()> {
        let when = format!("asked to {ability}");
        let reply = self.say(&when, request, &[])?;
        if reply.as_ref().is_some_and(|reply| self.impossible(&when, request, reply)) {
            return Ok(());
        }
        match reply {
            Some(Reply::Count(counted)) if *request == Request::Count => {
                self.manners.abilities.push(ability);
                self.digest(&when, &counted.found, right);
            }
            Some(Reply::Memory(memory)) if *request == Request::Memory => {
                self.manners.abilities.push(ability);
                self.digest(&when, &memory.found, right);
            }
            None | Some(Reply::Unsupported | Reply::Refused { .. }) => {}
            Some(other) => self.breaks(format!(
                "{when}, it answers {}; a runner without this ability must reply unsupported",
                word(&other)
            )),
        }
        Ok(())
    }

    /// Checks the digest of an answer whose pairs are known.
    fn digest(&mut self, when: &str, found: &Found, right: Digest) {
        let Found { contacts, digest: text, .. } = found;
        match digest(*contacts, text) {
            Err(wrong) => self.manners.broken.push(wrong),
            Ok(said) if said.contacts == right.contacts && said != right => {
                let sample = "of the pairs 0,1 and 1,2";
                self.breaks(format!(
                    "{when}, it reports 2 contacts and digest {text}; {sample} the digest is {}",
                    right.hex()
                ));
            }
            Ok(_) => {}
        }
    }
}
