//! Tests a runner as a subject of the check, over the runner protocol (docs/PROTOCOL.md).
//!
//! Every scene is loaded from a file and sampled once. Its pairs are requested if the scene is
//! small or the digest is wrong. A runner that dies or does not answer in time is restarted for the
//! next scene.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{anyhow, bail};
use tempfile::TempDir;

use crate::check::subject::{Answer, Question, Respondent};
use crate::check::{Differences, Wrong};
use crate::run::machine::disk;
use crate::run::runner::client::{self, Client, NO_REPLY, Start};
use crate::run::runner::protocol::{self, Reply, Request};
use crate::run::runner::trajectory::Trajectory;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::limits::memory::most_of_one;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::periodic::ContactList;
use contactbench_io::Given;
use contactbench_io::exchange;
use contactbench_record::record::row::Outcome;

/// Maximum address space of a runner in bytes; enough for an interpreter and its libraries.
const ADDRESS_SPACE: u64 = 8 << 30;
/// Time limit for the first line, because an interpreter may load libraries slowly.
const GREETING: Duration = Duration::from_secs(30);
const LAST_LINES: usize = 12;
/// Maximum number of particles for which the pairs are always requested.
const SMALL: usize = 100;

#[derive(Clone)]
pub struct Foreign {
    pub name: String,
    pub version: String,
    pub arithmetic: Arithmetic,
    pub command: Vec<String>,
}

pub enum Met {
    Runner(Foreign),
    Wrong(Wrong),
}

pub(super) enum Stop {
    Answer(Answer),
    Failed(anyhow::Error),
}

impl From<anyhow::Error> for Stop {
    fn from(error: anyhow::Error) -> Stop {
        Stop::Failed(error)
    }
}

impl From<Wrong> for Stop {
    fn from(wrong: Wrong) -> Stop {
        Stop::Answer(Answer::Wrong(wrong))
    }
}

fn breaks(what: String) -> Stop {
    Wrong::Breaks(what).into()
}

impl Foreign {
    /// Starts a runner and reads its hello. Fails if it cannot be started, or its library is
    /// missing.
    pub fn meet(command: Vec<String>) -> anyhow::Result<Met> {
        let mut client = spawn(&command, GREETING)?;
        match client.greet(GREETING) {
            Ok(()) => {}
            Err(failure) if failure.outcome == Outcome::Unavailable => bail!(failure.reason),
            Err(failure) if failure.outcome == Outcome::Timeout => {
                return Ok(Met::Wrong(Wrong::Breaks(failure.reason)));
            }
            Err(failure) => return Ok(Met::Wrong(broken(&client, failure))),
        }
        let hello = &client.hello;
        let said = |arithmetic: &Arithmetic| arithmetic.name() == hello.arithmetic;
        let Some(arithmetic) = Arithmetic::ALL.into_iter().find(said) else {
            return Ok(Met::Wrong(Wrong::Breaks(format!(
                "its hello has arithmetic '{}'; it must be one of {}",
                hello.arithmetic,
                Arithmetic::names()
            ))));
        };
        let fit = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' };
        let name: String =
            hello.detector.trim_start_matches('.').chars().take(60).map(fit).collect();
        let name = if name.is_empty() { "runner".into() } else { name };
        let version = hello.version.clone();
        Ok(Met::Runner(Foreign { name, version, arithmetic, command }))
    }

    fn start(&self, limit: Duration) -> Result<Client, Stop> {
        let mut client = spawn(&self.command, limit)?;
        match client.greet(GREETING) {
            Ok(()) => Ok(client),
            Err(failure) => Err(broken(&client, failure).into()),
        }
    }
}

fn spawn(command: &[String], time_limit: Duration) -> anyhow::Result<Client> {
    let start = Start::of(command, time_limit, ADDRESS_SPACE);
    Client::spawn(&start).map_err(|failure| anyhow!(failure.reason))
}

/// Converts a failed request to the error that the check reports.
fn broken(client: &Client, failure: client::Failure) -> Wrong {
    if failure.outcome == Outcome::Wrong || failure.reason.starts_with(NO_REPLY) {
        return Wrong::Breaks(failure.reason);
    }
    let errors = client.errors();
    let lines: Vec<&str> = errors.lines().collect();
    Wrong::Dies {
        how: failure.reason,
        errors: lines[lines.len().saturating_sub(LAST_LINES)..].join("\n"),
    }
}

pub(super) fn digest(contacts: u64, text: &str) -> Result<Digest, Wrong> {
    protocol::digest(contacts, text).map_err(Wrong::Breaks)
}

/// A connection to a runner, which is restarted after it has ended.
pub(super) struct Line {
    pub foreign: Foreign,
    pub deadline: Duration,
    pub client: Option<Client>,
}

impl Line {
    pub fn say(&mut self, request: &Request, fields: &[(&str, &str)]) -> Result<Reply, Stop> {
        let mut client = match self.client.take() {
            Some(client) => client,
            None => self.foreign.start(self.deadline)?,
        };
        let mut message = request.message().map_err(|reason| anyhow!(reason))?;
        for (name, value) in fields {
            message[name] = (*value).into();
        }
        match client.exchange(&message) {
            Ok(reply) => {
                self.client = Some(client);
                Ok(reply)
            }
            Err(failure) if failure.outcome == Outcome::Timeout => {
                Err(Wrong::Hangs(self.deadline).into())
            }
            Err(failure) if failure.outcome == Outcome::Unavailable => {
                Err(breaks(format!("it replies unavailable after its hello: {}", failure.reason)))
            }
            Err(failure) => Err(broken(&client, failure).into()),
        }
    }

    pub fn impossible(&self, request: &Request, reply: &Reply) -> Option<String> {
        self.client.as_ref().and_then(|client| client.impossible(request, reply))
    }
}

pub(super) struct Process {
    line: Line,
    folder: TempDir,
    used: bool,
}

impl Process {
    pub fn new(foreign: &Foreign, deadline: Duration) -> anyhow::Result<Process> {
        let folder = disk::temporary()?;
        let line = Line { foreign: foreign.clone(), deadline, client: None };
        Ok(Process { line, folder, used: false })
    }

    fn request(&mut self, request: &Request) -> Result<Reply, Stop> {
        let reply = self.line.say(request, &[])?;
        match (self.line.impossible(request, &reply), reply) {
            (Some(impossible), _) => Err(breaks(impossible)),
            (None, Reply::Refused { reason }) => Err(Stop::Answer(Answer::Declined(reason))),
            (None, reply) => Ok(reply),
        }
    }

    fn pairs(&mut self, given: &Given) -> Result<Option<ContactList>, Stop> {
        let n = given.scene.len();
        let box_dim = given.lattice.map(|_| given.scene.dim());
        let path: PathBuf = self.folder.path().join("pairs.npy");
        // Removes the file of the previous answer, which must not be taken for this one.
        let _ = std::fs::remove_file(&path);
        let contacts = match self.request(&Request::Pairs { path: path.clone(), frame: None })? {
            Reply::Pairs { contacts } => contacts,
            Reply::Unsupported | Reply::Error { .. } => return Ok(None),
            other => return Err(astray("pairs", &other)),
        };
        let found = exchange::read_contacts(&path, box_dim).map_err(|error| {
            let why = format!("{error:#}").replace(&path.display().to_string(), "pairs.npy");
            breaks(format!("the file of its pairs: {why}"))
        })?;
        if found.len() != contacts {
            return Err(breaks(format!(
                "it reports {contacts} written pairs, and its file holds {}",
                found.len()
            )));
        }
        let named = |&[i, j]: &[u32; 2]| i.max(j) as usize >= n;
        let shifted = found.shifted.iter().map(|pair| [pair.i, pair.j]);
        if let Some([i, j]) = found.plain.iter().copied().chain(shifted).find(named) {
            return Err(breaks(format!(
                "it reports the pair {i},{j} in a scene of {n} particles: they are numbered from \
                 0 to {}",
                n as i64 - 1
            )));
        }
        Ok(Some(found))
    }

    fn answer(&mut self, question: &Question<'_>) -> Result<Answer, Stop> {
        let Question { given, truth, arithmetic, .. } = question;
        let scene = Trajectory::write_at_rest(&self.folder.path().join("scene.npy"), given)?;
        self.used = true;
        match self.request(&Request::Load(scene))? {
            Reply::Loaded => {}
            other => return Err(astray("load", &other)),
        }
        let said = match self.request(&Request::Sample { min_ns: 1 })? {
            Reply::Sample(sample) => digest(sample.found.contacts, &sample.found.digest)?,
            other => return Err(astray("sample", &other)),
        };
        let right = said == truth.digest;
        if right && given.scene.len() > SMALL {
            return Ok(Answer::Right);
        }
        let Some(contacts) = self.pairs(given)? else {
            let counts = Wrong::Counts { said, truth: truth.digest };
            return if right { Ok(Answer::Right) } else { Err(counts.into()) };
        };
        let own = contacts.digest();
        let as_text = |digest: Digest| format!("{} contacts and {}", digest.contacts, digest.hex());
        if own != said && own == truth.digest {
            return Err(breaks(format!(
                "its pairs are right, with {}, but its sample reports {}",
                as_text(own),
                as_text(said)
            )));
        }
        let Ok(pairs) = contacts.sorted(given.scene.len(), most_of_one()) else {
            return Err(Wrong::Counts { said: own, truth: truth.digest }.into());
        };
        if own != said && right {
            let differences = Differences::new(pairs, &truth.pairs);
            return Err(breaks(format!(
                "its sample is right, but not the pairs that it writes: {differences}"
            )));
        }
        Ok(Answer::of(pairs, truth, *arithmetic))
    }
}

impl Respondent for Process {
    fn ask(&mut self, question: &Question<'_>) -> anyhow::Result<Answer> {
        if question.fresh && self.used {
            self.line.client = None;
            self.used = false;
        }
        match self.answer(question) {
            Ok(answer) | Err(Stop::Answer(answer)) => Ok(answer),
            Err(Stop::Failed(error)) => Err(error),
        }
    }
}

fn astray(request: &str, reply: &Reply) -> Stop {
    breaks(match reply {
        Reply::Error { reason } => {
            format!("asked to {request}, it answers with the error: {reason}")
        }
        other => format!("asked to {request}, it answers {}", word(other)),
    })
}

pub(super) fn word(reply: &Reply) -> String {
    let value = serde_json::to_value(reply).unwrap_or_default();
    value["reply"].as_str().unwrap_or_default().to_string()
}
