//! A runner under test: the questions of the check, asked over the runner protocol (docs/PROTOCOL.md).
//!
//! Every scene is loaded from a file, sampled once, and its pairs are fetched, if it is small or the fingerprint is not the right one. A
//! runner that dies, or does not answer in time, is started anew for the next scene.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, anyhow, bail};
use tempfile::TempDir;

use super::subject::{Answer, Question, Subject};
use super::{Differences, Wrong};
use crate::contact::Arithmetic;
use crate::harness::bake;
use crate::harness::child::{self, NO_REPLY, Runner, Start};
use crate::harness::protocol::{Reply, Request};
use crate::harness::record::Outcome;
use crate::sink::Digest;

/// Address space of a runner under test, in bytes: enough for an interpreter and its libraries.
const ADDRESS_SPACE: u64 = 8 << 30;
/// The first line must be there after this time: an interpreter may take a while to load its libraries.
const GREETING: Duration = Duration::from_secs(30);
/// Lines of what a runner said on its standard error that are kept.
const LAST_LINES: usize = 12;
/// The pairs of scenes of at most so many elements are always fetched.
const SMALL: usize = 100;

/// A detector in another language.
#[derive(Clone)]
pub struct Foreign {
    /// What it calls itself, made fit for the name of a file.
    pub name: String,
    /// What it says of its version; may be empty.
    pub version: String,
    /// The truth that it is held to.
    pub arithmetic: Arithmetic,
    /// Program and arguments.
    pub command: Vec<String>,
}

impl Foreign {
    /// Starts a runner to hear who it is. An error if it cannot be started, or its library is not there; what is wrong, if it breaks the protocol.
    pub fn meet(command: Vec<String>) -> anyhow::Result<Result<Foreign, Wrong>> {
        let mut runner = spawn(&command, GREETING)?;
        match runner.greet(GREETING) {
            Ok(()) => {}
            Err(failure) if failure.outcome == Outcome::Unavailable => bail!(failure.reason),
            Err(failure) if failure.outcome == Outcome::Timeout => {
                let must = "a runner says hello before it reads anything, and flushes";
                return Ok(Err(Wrong::Breaks(format!("no first line within {} s: {must}", GREETING.as_secs()))));
            }
            Err(failure) => return Ok(Err(broken(&runner, failure))),
        }
        let Some(arithmetic) = Arithmetic::ALL.into_iter().find(|arithmetic| arithmetic.name() == runner.arithmetic) else {
            let what = format!("its hello says arithmetic '{}'; it must be one of {}", runner.arithmetic, Arithmetic::names());
            return Ok(Err(Wrong::Breaks(what)));
        };
        let fit = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' };
        let name: String = runner.detector.trim_start_matches('.').chars().take(60).map(fit).collect();
        let name = if name.is_empty() { "runner".into() } else { name };
        Ok(Ok(Foreign { name, version: runner.version.clone(), arithmetic, command }))
    }

    /// A process that has said hello. `Err` is what is wrong with it.
    pub(super) fn start(&self, limit: Duration) -> anyhow::Result<Result<Runner, Wrong>> {
        let mut runner = spawn(&self.command, limit)?;
        Ok(match runner.greet(GREETING) {
            Ok(()) => Ok(runner),
            Err(failure) => Err(broken(&runner, failure)),
        })
    }
}

fn spawn(command: &[String], time_limit: Duration) -> anyhow::Result<Runner> {
    let start = Start { command: command.to_vec(), install: String::new(), time_limit, memory_limit: ADDRESS_SPACE };
    Runner::spawn(&start).map_err(|failure| anyhow!(failure.reason))
}

/// A failure in the words of the check; its answer was none.
pub(super) fn broken(runner: &Runner, failure: child::Failure) -> Wrong {
    if failure.outcome == Outcome::Wrong || failure.reason.starts_with(NO_REPLY) {
        return Wrong::Breaks(failure.reason);
    }
    let errors = runner.errors();
    let lines: Vec<&str> = errors.lines().collect();
    Wrong::Dies { how: failure.reason, errors: lines[lines.len().saturating_sub(LAST_LINES)..].join("\n") }
}

/// The fingerprint of a reply, if it is one.
pub(super) fn digest(contacts: u64, text: &str) -> Result<Digest, Wrong> {
    let digits = text.strip_prefix("0x").filter(|digits| digits.len() == 16 && !digits.contains(|c: char| c.is_ascii_uppercase()));
    match digits.and_then(|digits| u64::from_str_radix(digits, 16).ok()) {
        Some(sum) => Ok(Digest { contacts, sum }),
        None => Err(Wrong::Breaks(format!("its digest is '{text}'; it must be 0x and 16 lower-case hexadecimal digits"))),
    }
}

/// A runner, kept from scene to scene.
pub(super) struct Process {
    foreign: Foreign,
    deadline: Duration,
    folder: TempDir,
    runner: Option<Runner>,
    /// It has had a scene.
    used: bool,
}

impl Process {
    pub fn new(foreign: &Foreign, deadline: Duration) -> anyhow::Result<Process> {
        let folder = tempfile::tempdir().context("cannot make a temporary folder for scenes; set TMPDIR to a writable place")?;
        Ok(Process { foreign: foreign.clone(), deadline, folder, runner: None, used: false })
    }

    fn request(&mut self, request: &Request) -> anyhow::Result<Result<Reply, Answer>> {
        let mut line = serde_json::to_string(request)?;
        line.push('\n');
        let runner = match self.runner.take() {
            Some(runner) => Ok(runner),
            None => self.foreign.start(self.deadline)?,
        };
        let mut runner = match runner {
            Ok(runner) => runner,
            Err(wrong) => return Ok(Err(Answer::Wrong(wrong))),
        };
        Ok(match runner.exchange(&line) {
            Ok(Reply::Refused { reason }) => {
                self.runner = Some(runner);
                Err(Answer::Declined(reason))
            }
            Ok(reply) => {
                self.runner = Some(runner);
                Ok(reply)
            }
            Err(failure) if failure.outcome == Outcome::Timeout => Err(Answer::Hangs(self.deadline)),
            Err(failure) if failure.outcome == Outcome::Unavailable => {
                Err(Answer::Wrong(Wrong::Breaks(format!("it has begun, and then says unavailable: {}", failure.reason))))
            }
            Err(failure) => Err(Answer::Wrong(broken(&runner, failure))),
        })
    }

    /// The pairs that it writes; none if it does not.
    fn pairs(&mut self, n: usize) -> anyhow::Result<Result<Option<Vec<[u32; 2]>>, Answer>> {
        let path: PathBuf = self.folder.path().join("pairs.npy");
        // What was written before is not the answer; mostly there is nothing to remove.
        let _ = std::fs::remove_file(&path);
        let contacts = match self.request(&Request::Pairs { path: path.clone() })? {
            Ok(Reply::Pairs { contacts }) => contacts,
            Ok(Reply::Unsupported | Reply::Error { .. }) => return Ok(Ok(None)),
            Ok(other) => return Ok(Err(astray("pairs", &other))),
            Err(answer) => return Ok(Err(answer)),
        };
        let breaks = |what: String| Ok(Err(Answer::Wrong(Wrong::Breaks(what))));
        let pairs = match bake::read_pairs(&path) {
            Ok(pairs) => pairs,
            // The name of a temporary file would say nothing.
            Err(error) => {
                return breaks(format!(
                    "the file of its pairs: {}",
                    format!("{error:#}").replace(&path.display().to_string(), "pairs.npy")
                ));
            }
        };
        if pairs.len() as u64 != contacts {
            return breaks(format!("it says that it has written {contacts} pairs, and its file holds {}", pairs.len()));
        }
        match pairs.iter().find(|pair| pair.iter().any(|&id| id as usize >= n)) {
            Some([i, j]) => {
                breaks(format!("it reports the pair {i},{j} in a scene of {n} elements: they are numbered from 0 to {}", n as i64 - 1))
            }
            None => Ok(Ok(Some(pairs))),
        }
    }

    fn answer(&mut self, question: &Question<'_>) -> anyhow::Result<Result<Answer, Answer>> {
        let Question { given, truth, arithmetic, .. } = question;
        let load = bake::load(&self.folder.path().join("scene.npy"), given)?;
        self.used = true;
        match self.request(&load)? {
            Ok(Reply::Loaded) => {}
            Ok(other) => return Ok(Err(astray("load", &other))),
            Err(answer) => return Ok(Err(answer)),
        }
        let said = match self.request(&Request::Sample { min_ns: 1 })? {
            Ok(Reply::Sample { contacts, digest: text, .. }) => digest(contacts, &text),
            Ok(other) => return Ok(Err(astray("sample", &other))),
            Err(answer) => return Ok(Err(answer)),
        };
        let said = match said {
            Ok(said) => said,
            Err(wrong) => return Ok(Err(Answer::Wrong(wrong))),
        };
        let right = said == truth.digest;
        if right && given.len() > SMALL {
            return Ok(Ok(Answer::Pairs(truth.pairs.clone())));
        }
        let pairs = match self.pairs(given.len())? {
            Ok(pairs) => pairs,
            Err(answer) => return Ok(Err(answer)),
        };
        let Some(pairs) = pairs else {
            return Ok(if right {
                Ok(Answer::Pairs(truth.pairs.clone()))
            } else {
                Err(Answer::Wrong(Wrong::Counts { said, truth: truth.digest }))
            });
        };
        let own = Digest::of(&pairs);
        let as_text = |digest: Digest| format!("{} contacts and {}", digest.contacts, digest.hex());
        if own != said && own == truth.digest {
            let what = format!("its pairs are right, with {}, but its sample says {}", as_text(own), as_text(said));
            return Ok(Err(Answer::Wrong(Wrong::Breaks(what))));
        }
        let differences = Differences::new(pairs.clone(), &truth.pairs);
        if own != said && right {
            let what = format!("its sample is right, but not the pairs that it writes: {differences}");
            return Ok(Err(Answer::Wrong(Wrong::Breaks(what))));
        }
        // Textbook filters may lose contacts.
        let only_missed = differences == Differences { missed: differences.missed.clone(), ..Differences::default() };
        Ok(Ok(Answer::Pairs(if only_missed && !arithmetic.is_safe() { truth.pairs.clone() } else { pairs })))
    }
}

impl Subject for Process {
    fn ask(&mut self, question: &Question<'_>) -> anyhow::Result<Answer> {
        if question.fresh && self.used {
            (self.runner, self.used) = (None, false);
        }
        Ok(self.answer(question)?.unwrap_or_else(|answer| answer))
    }
}

/// An answer that does not belong to the request.
fn astray(request: &str, reply: &Reply) -> Answer {
    let what = match reply {
        Reply::Error { reason } => format!("asked to {request}, it answers with the error: {reason}"),
        other => format!("asked to {request}, it answers {}", word(other)),
    };
    Answer::Wrong(Wrong::Breaks(what))
}

/// The name of a reply.
pub(super) fn word(reply: &Reply) -> String {
    let value = serde_json::to_value(reply).unwrap_or_default();
    value["reply"].as_str().unwrap_or_default().to_string()
}
