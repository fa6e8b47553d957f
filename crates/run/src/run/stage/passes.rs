//! The measurements of one subject on one scene. Its runner loads the scene, counts operations,
//! measures memory, and takes timed samples. Every answer is judged before its row is written.
//!
//! Each timed sample has a new process. In one case of ten, the position of a process in memory
//! changes its time by up to a fifth, for as long as the process lives. Blocks within one process
//! would repeat the same position, and make equal code look different.

use crate::run::judge::{Said, Tracked};
use crate::run::machine::{interrupt, processors};
use crate::run::plan::describe;
use crate::run::runner::client::{Client, Failure};
use crate::run::runner::protocol::{Found, Hello, Reply, Request, Sample, Steps};
use crate::run::stage::Stage;
use crate::run::stage::bench::Bench;
use crate::run::subject::Subject;
use contactbench_ground::contact::Arithmetic;
use contactbench_record::record::role::Role;
use contactbench_record::record::row::{self, Outcome, Pass, Row};
use contactbench_scenes::stats::coordination;

/// Minimum length of a sample; in a shorter one, the clock's overhead and resolution would matter.
pub(crate) const SHORTEST_SAMPLE_NS: u64 = 2_000_000;

pub(crate) struct Running {
    pub subject: Subject,
    pub arithmetic: Arithmetic,
    pub hello: Hello,
    pub blank: Row,
}

impl Running {
    /// Returns the processor for the process in this block; `None` with several threads.
    pub fn processor(&self, block: u32) -> Option<usize> {
        processors::in_block(block).filter(|_| self.subject.threads == 1)
    }

    pub fn is_alone(&self) -> bool {
        self.subject.duet.is_none()
    }

    pub fn fresh(&self, bench: &Bench<'_>, processor: Option<usize>) -> Result<Client, Failure> {
        bench.fresh(&self.subject.start, Some(&self.hello), processor)
    }

    pub fn fill(&self, row: &mut Row, sample: &Sample, processor: Option<usize>) {
        row.time_ns = Some(sample.time_ns);
        row.first_ns = sample.first_ns;
        row.calls = Some(sample.calls);
        row.elapsed_ns = Some(sample.elapsed_ns);
        say(row, &sample.found);
        if !sample.found.steps.is_empty() {
            let mut each = sample.step_ns.clone();
            each.sort_unstable();
            row.median_step_ns = each.get(each.len() / 2).copied();
            row.worst_step_ns = each.last().copied();
            row.building_ns = sample.building_ns;
        }
        row.processor = processor.map(|processor| processor as u32);
    }
}

pub fn astray(request: &Request, reply: &Reply) -> Failure {
    // The message has only the variant's name, because paths differ between runs.
    let word = |text: String| text.split([' ', '(']).next().unwrap_or_default().to_string();
    let reason = format!(
        "the runner answered {} with {}",
        word(format!("{request:?}")),
        word(format!("{reply:?}"))
    );
    Failure { outcome: Outcome::Crashed, reason }
}

impl Stage<'_, '_> {
    /// Starts a subject, loads the scene, counts, and measures memory. Returns `None` if the
    /// subject fails; its rows state why.
    pub fn enter(
        &mut self,
        subject: Subject,
        mut blank: Row,
        bench: &mut Bench<'_>,
    ) -> anyhow::Result<Option<Running>> {
        if self.too_slow("", &blank, &Pass::ALL)? {
            return Ok(None);
        }
        let (mut client, arithmetic) = match start(&subject) {
            Ok(started) => started,
            Err(failure) => return self.fail(&blank, failure, &Pass::ALL).map(|()| None),
        };
        // A runner reports its arithmetic only when it is started.
        blank.id.arithmetic = arithmetic.name().into();
        blank.process = self.log.origins.process(&subject, &client)?;
        if self.give_up(&blank)? || self.too_slow("", &blank, &Pass::ALL)? {
            return Ok(None);
        }
        if let Err(failure) = bench.load(&mut client) {
            return self.fail(&blank, failure, &Pass::ALL).map(|()| None);
        }
        // The scene was counted by the closed rule.
        if arithmetic.exact() != Arithmetic::Exact {
            let contacts = bench.judge.count(arithmetic)?.0.first;
            blank.stats.coordination = coordination(blank.id.n, contacts);
        }
        let hello = client.hello.clone();
        let mut running = Running { subject, arithmetic, hello, blank };
        for pass in [Pass::Count, Pass::Memory] {
            let mut row = Row { pass, ..running.blank.clone() };
            if self.index.has(&row) {
                continue;
            }
            let found = match measure(&mut client, &mut row) {
                Ok(found) => found,
                Err(failure) => {
                    return self.fail(&running.blank, failure, pass.rest()).map(|()| None);
                }
            };
            if let Some(found) = found {
                self.judge(&mut row, &running, &mut client, bench, &found)?;
            }
            self.write(&row)?;
        }
        running.subject.copy = self.copy(&running)?;
        Ok(Some(running))
    }

    /// Judges the answer of a row, for several frames all answers. Must be called before the row is
    /// written.
    pub fn judge(
        &mut self,
        row: &mut Row,
        running: &Running,
        client: &mut Client,
        bench: &mut Bench<'_>,
        found: &Found,
    ) -> anyhow::Result<()> {
        let Running { subject, arithmetic, .. } = running;
        if subject.role == Role::Nothing {
            row.outcome = Outcome::Control;
            row.reason = "control: reports nothing by design".into();
            return Ok(());
        }
        let said = Said { arithmetic: *arithmetic, may_miss: subject.may_miss, found };
        let (judged, tracked) = bench.judge(&subject.name, said, client)?;
        row.course =
            (bench.is_moving && judged.errors.is_some()).then(|| recorded(&tracked, &found.steps));
        interrupt::check()?;
        row.outcome = judged.outcome;
        row.reason = judged.reason;
        row.errors = judged.errors;
        row.causes = judged.causes;
        if row.outcome == Outcome::Refused {
            // The outcome means that the truth is unknown, so times are not recorded.
            (row.time_ns, row.first_ns, row.pulse_ns) = (None, None, None);
        }
        if row.outcome == Outcome::Wrong {
            self.note_first("WRONG", row, &row.reason);
        }
        Ok(())
    }

    /// Prints the first wrong answer or crash of each detector at once; the report counts all of
    /// them.
    pub fn note_first(&mut self, what: &str, row: &Row, reason: &str) {
        let head = format!("{what}: {}", row.id.subject());
        if self.log.noted.insert(head.clone()) {
            let scene = describe(self.experiment, self.spec);
            let text = format!("{head} ({}) on {scene}: {reason}", row.id.arithmetic);
            self.log.progress.note(&text);
        }
    }
}

/// Starts the runner of a subject. Also returns the subject's arithmetic or, if it has none, the
/// one that the runner reports.
fn start(subject: &Subject) -> Result<(Client, Arithmetic), Failure> {
    let unavailable = |reason: String| Failure { outcome: Outcome::Unavailable, reason };
    if let Some(reason) = &subject.missing {
        return Err(unavailable(reason.clone()));
    }
    let client = Client::start(&subject.start)?;
    let arithmetic = match subject.arithmetic {
        Some(arithmetic) => arithmetic,
        None => client.hello.arithmetic().map_err(unavailable)?,
    };
    Ok((client, arithmetic))
}

fn recorded(Tracked { builds, late }: &Tracked, steps: &Steps) -> row::Course {
    row::Course {
        builds: builds.built,
        dangerous: builds.dangerous,
        dangerous_rightly: builds.rightly,
        missing_builds: builds.missing,
        listed: steps.listed.iter().fold(0, |all, &listed| all.saturating_add(listed)),
        first_wrong: late.first,
        wrong_frames: late.frames,
        worst_missed: late.worst,
        never: late.never,
        latest: late.latest,
        deepest_late: late.deepest,
    }
}

pub fn say(row: &mut Row, found: &Found) {
    let (contacts, digest) = found.whole();
    (row.contacts, row.digest) = (Some(contacts), Some(digest));
}

/// Counts operations or measures memory, as the row's pass requires. Returns `None` if the runner
/// does not support this.
pub(crate) fn measure(client: &mut Client, row: &mut Row) -> Result<Option<Found>, Failure> {
    let request = if row.pass == Pass::Count { Request::Count } else { Request::Memory };
    let found = match (client.ask(&request)?, row.pass) {
        (Reply::Count(counted), Pass::Count) => {
            row.counts = counted.counts;
            counted.found
        }
        (Reply::Memory(memory), Pass::Memory) => {
            row.peak_bytes = Some(memory.peak_bytes);
            row.live_bytes = Some(memory.live_bytes);
            row.allocations = Some(memory.allocations);
            row.warm_allocations = memory.warm_allocations;
            row.formula_bytes = memory.formula_bytes;
            memory.found
        }
        (Reply::Unsupported, _) => {
            row.reason = "the runner does not measure this".into();
            return Ok(None);
        }
        (other, _) => return Err(astray(&request, &other)),
    };
    say(row, &found);
    Ok(Some(found))
}
