//! Tests a runner as a subject of the check, over the runner protocol (docs/PROTOCOL.md).
//!
//! Every scene is loaded from a file and sampled once. Its pairs are requested if the scene is
//! small or the digest is wrong. A runner that dies or does not answer in time is restarted for the
//! next scene.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{anyhow, bail, ensure};
use tempfile::TempDir;

use crate::check::answer::{Answer, Question, Respondent};
use crate::check::{Differences, Wrong};
use crate::run::machine::temporary;
use crate::run::runner::client::{Client, Failure, Start};
use crate::run::runner::protocol::{Reply, Request};
use crate::run::runner::trajectory::Trajectory;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::limits::memory::most_of_one;
use contactbench_ground::periodic::ContactList;
use contactbench_io::{Given, exchange};
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

/// Separates the errors of a runner from errors of the check.
pub fn wrong<T>(result: anyhow::Result<T>) -> anyhow::Result<Result<T, Wrong>> {
    result.map(Ok).or_else(|error| Ok(Err(error.downcast()?)))
}

impl Foreign {
    /// Starts a runner and reads its hello. Fails with [`Wrong`] if the hello breaks the protocol,
    /// otherwise if the runner cannot be started or its library is missing.
    pub fn meet(command: Vec<String>) -> anyhow::Result<Foreign> {
        let hello = started(&command, GREETING)?.hello.clone();
        let arithmetic = hello.arithmetic().map_err(Wrong::Breaks)?;
        let fit = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' };
        let name: String =
            hello.detector.trim_start_matches('.').chars().take(60).map(fit).collect();
        let name = if name.is_empty() { "runner".into() } else { name };
        Ok(Foreign { name, version: hello.version, arithmetic, command })
    }
}

fn started(command: &[String], time_limit: Duration) -> anyhow::Result<Client> {
    let start = Start::of(command, time_limit, ADDRESS_SPACE);
    let mut client = Client::spawn(&start).map_err(|failure| anyhow!(failure.reason))?;
    match client.greet(GREETING) {
        Ok(()) => Ok(client),
        Err(Failure { outcome: Outcome::Timeout, reason }) => bail!(Wrong::Breaks(reason)),
        Err(failure) => Err(broken(&client, failure)),
    }
}

/// Converts a failed request to the error that the check reports.
fn broken(client: &Client, Failure { outcome, reason }: Failure) -> anyhow::Error {
    match outcome {
        Outcome::Unavailable => anyhow!(reason),
        Outcome::Wrong => Wrong::Breaks(reason).into(),
        _ => {
            let errors = client.errors();
            let lines: Vec<&str> = errors.lines().collect();
            let errors = lines[lines.len().saturating_sub(LAST_LINES)..].join("\n");
            Wrong::Dies { how: reason, errors }.into()
        }
    }
}

/// A connection to a runner, which is restarted after it has ended.
pub(super) struct Line {
    foreign: Foreign,
    deadline: Duration,
    client: Option<Client>,
}

impl Line {
    pub fn new(foreign: &Foreign, deadline: Duration) -> Line {
        Line { foreign: foreign.clone(), deadline, client: None }
    }

    pub fn say(&mut self, request: &Request) -> anyhow::Result<Reply> {
        let mut client = match self.client.take() {
            Some(client) => client,
            None => started(&self.foreign.command, self.deadline)?,
        };
        match client.exchange(request) {
            Ok(reply) => {
                self.client = Some(client);
                Ok(reply)
            }
            Err(failure) if failure.outcome == Outcome::Timeout => {
                bail!(Wrong::Hangs(self.deadline))
            }
            Err(Failure { outcome: Outcome::Unavailable, reason }) => {
                bail!(Wrong::Breaks(format!("it replies unavailable after its hello: {reason}")))
            }
            Err(failure) => Err(broken(&client, failure)),
        }
    }
}

pub(super) struct Process {
    line: Line,
    folder: TempDir,
}

impl Process {
    pub fn new(foreign: &Foreign, deadline: Duration) -> anyhow::Result<Process> {
        let (folder, line) = (temporary()?, Line::new(foreign, deadline));
        Ok(Process { line, folder })
    }

    fn pairs(&mut self, given: &Given) -> anyhow::Result<Option<ContactList>> {
        let n = given.scene.len();
        let box_dim = given.lattice.map(|_| given.scene.dim());
        let path: PathBuf = self.folder.path().join("pairs.npy");
        // Removes the file of the previous answer, which must not be taken for this one.
        let _ = std::fs::remove_file(&path);
        let contacts = match self.line.say(&Request::Pairs { path: path.clone(), frame: None })? {
            Reply::Pairs { contacts } => contacts,
            Reply::Unsupported | Reply::Error { .. } | Reply::Refused { .. } => return Ok(None),
            other => return Err(astray("pairs", &other)),
        };
        let found = exchange::read_contacts(&path, box_dim).map_err(|error| {
            let why = format!("{error:#}").replace(&path.display().to_string(), "pairs.npy");
            Wrong::Breaks(format!("the file of its pairs: {why}"))
        })?;
        let held = found.len();
        ensure!(
            held == contacts,
            Wrong::Breaks(format!(
                "it reports {contacts} written pairs, and its file holds {held}"
            ))
        );
        let named = |&[i, j]: &[u32; 2]| i.max(j) as usize >= n;
        let shifted = found.shifted.iter().map(|pair| [pair.i, pair.j]);
        if let Some([i, j]) = found.plain.iter().copied().chain(shifted).find(named) {
            bail!(Wrong::Breaks(format!(
                "it reports the pair {i},{j} in a scene of {n} particles: they are numbered from \
                 0 to {}",
                n as i64 - 1
            )));
        }
        Ok(Some(found))
    }

    fn answer(&mut self, question: &Question<'_>) -> anyhow::Result<Answer> {
        let Question { given, truth, arithmetic, .. } = question;
        let scene = Trajectory::write_at_rest(&self.folder.path().join("scene.npy"), given)?;
        match self.line.say(&Request::Load(scene))? {
            Reply::Loaded => {}
            Reply::Refused { reason } => return Ok(Answer::Declined(reason)),
            other => return Err(astray("load", &other)),
        }
        let said = match self.line.say(&Request::Sample { min_ns: 1 })? {
            Reply::Sample(sample) => sample.found.digest().map_err(Wrong::Breaks)?,
            Reply::Refused { reason } => return Ok(Answer::Declined(reason)),
            other => return Err(astray("sample", &other)),
        };
        let right = said == truth.digest;
        if right && given.scene.len() > SMALL {
            return Ok(Answer::Right);
        }
        let counts = |said| Answer::Wrong(Wrong::Counts { said, truth: truth.digest });
        let Some(contacts) = self.pairs(given)? else {
            return Ok(if right { Answer::Right } else { counts(said) });
        };
        let own = contacts.digest();
        let Ok(pairs) = contacts.sorted(given.scene.len(), most_of_one()) else {
            return Ok(counts(own));
        };
        if own != said && (right || own == truth.digest) {
            let (sample, file) = if right { ("right", "wrong") } else { ("wrong", "right") };
            bail!(Wrong::Breaks(format!(
                "its sample is {sample}, with {} contacts and {}, but the pairs that it writes \
                 are {file}: {}",
                said.contacts,
                said.hex(),
                Differences::new(pairs, &truth.pairs)
            )));
        }
        Ok(Answer::of(pairs, truth, *arithmetic))
    }
}

impl Respondent for Process {
    fn ask(&mut self, question: &Question<'_>) -> anyhow::Result<Answer> {
        if question.fresh {
            self.line.client = None;
        }
        Ok(wrong(self.answer(question))?.unwrap_or_else(Answer::Wrong))
    }
}

fn astray(request: &str, reply: &Reply) -> anyhow::Error {
    Wrong::Breaks(format!("asked to {request}, it answers {}", word(reply))).into()
}

/// Returns the kind of a reply, with the reason if it has one.
pub(super) fn word(reply: &Reply) -> String {
    let value = serde_json::to_value(reply).unwrap_or_default();
    let [kind, reason] = ["reply", "reason"].map(|key| value[key].as_str().unwrap_or_default());
    if reason.is_empty() { kind.into() } else { format!("{kind}: {reason}") }
}
