//! The harness's side of a runner: its process, requests with limits on time and memory, and a
//! reason for every failure.

use std::io::Write;
use std::path::Path;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::run::machine::{interrupt, processors};
use crate::run::runner::client::output::Line;
use crate::run::runner::family;
use crate::run::runner::possible::{self, Asked};
use crate::run::runner::protocol::{Hello, Reply, Request, VERSION};
use crate::run::runner::trajectory::Trajectory;
use contactbench_ground::periodic::ContactList;
use contactbench_io::exchange;
use contactbench_record::record::row::Outcome;
use contactbench_terms::text;

#[derive(Clone, Debug, Default)]
pub struct Start {
    pub command: Vec<String>,
    pub install: String,
    pub time_limit: Duration,
    /// Maximum address space of the runner, in bytes.
    pub memory_limit: u64,
    pub processor: Option<usize>,
}

impl Start {
    /// Describes a start of `command` on any processor, without a hint how to install it.
    pub fn of(command: &[String], time_limit: Duration, memory_limit: u64) -> Start {
        Start { command: command.to_vec(), time_limit, memory_limit, ..Start::default() }
    }

    fn hint(&self) -> String {
        if self.install.is_empty() { String::new() } else { format!("; {}", self.install) }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    pub outcome: Outcome,
    pub reason: String,
}

pub struct Client {
    child: Child,
    input: Option<ChildStdin>,
    lines: Receiver<Line>,
    errors: Arc<Mutex<String>>,
    pub time_limit: Duration,
    memory_limit: u64,
    samples: u32,
    frames: usize,
    particles: u64,
    /// The loaded trajectory, if the runner accepts only trajectories of one frame.
    by_frame: Option<Trajectory>,
    pub hello: Hello,
}

/// Interval at which a waiting client checks for signals.
const LOOK: Duration = Duration::from_millis(100);
/// Times that a runner gets to end after `quit`, and after SIGTERM. It may have to end processes
/// that it started.
const TO_LEAVE: Duration = Duration::from_millis(100);
#[cfg(unix)]
const TO_CLEAN_UP: Duration = Duration::from_millis(500);

impl Client {
    /// Starts a runner and reads its hello. Any failure has the outcome `unavailable`.
    pub fn start(start: &Start) -> Result<Client, Failure> {
        let mut runner = Client::spawn(start)?;
        // An interpreter may load its libraries slowly.
        let greeted = runner.greet(start.time_limit.max(Duration::from_secs(30)));
        let unavailable = |Failure { outcome, reason }| {
            let said = matches!(outcome, Outcome::Unavailable | Outcome::Wrong);
            let reason = if said { reason } else { reason + &start.hint() };
            Failure { outcome: Outcome::Unavailable, reason }
        };
        greeted.map_err(unavailable).map(|()| runner)
    }

    /// Starts a process; its hello is read by [`Client::greet`].
    pub fn spawn(start: &Start) -> Result<Client, Failure> {
        let unavailable = |reason: String| Failure { outcome: Outcome::Unavailable, reason };
        let [program, arguments @ ..] = &start.command[..] else {
            return Err(unavailable("the runner's command is empty".into()));
        };
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // When the harness ends, the pipe closes and runners see the end of their input.
        let mut child = family::start(&mut command)
            .map_err(|e| unavailable(format!("cannot start {program}: {e}{}", start.hint())))?;
        family::limit_memory(&child, start.memory_limit);
        processors::keep(Some(child.id()), start.processor);
        let lines = output::lines(child.stdout.take());
        let errors = output::errors(child.stderr.take());
        let input = child.stdin.take();
        Ok(Client {
            child,
            input,
            lines,
            errors,
            time_limit: start.time_limit,
            memory_limit: start.memory_limit,
            samples: 0,
            frames: 1,
            particles: 0,
            by_frame: None,
            hello: Hello::default(),
        })
    }

    /// Reads the first line. The failure has the outcome `wrong` if the line is not a valid hello.
    pub fn greet(&mut self, limit: Duration) -> Result<(), Failure> {
        let broken = |reason: String| Failure { outcome: Outcome::Wrong, reason };
        let line = self.receive(limit).map_err(|failure| match failure.outcome {
            Outcome::Timeout | Outcome::Crashed => {
                let last = match self.last_line() {
                    Some(last) if failure.outcome == Outcome::Timeout => {
                        format!("; last line on standard error: {last}")
                    }
                    _ => String::new(),
                };
                let reason = format!(
                    "no hello: {}; a runner first prints one line, \
                     {{\"reply\":\"hello\",\"protocol\":{VERSION},...}}, and flushes it \
                     (docs/PROTOCOL.md){last}",
                    failure.reason
                );
                Failure { reason, ..failure }
            }
            _ => failure,
        });
        match line? {
            Reply::Hello(hello) if hello.protocol == VERSION => {
                self.hello = *hello;
                Ok(())
            }
            Reply::Hello(hello) => Err(broken(format!(
                "the runner speaks protocol {}, but this program requires protocol {VERSION}; \
                 see docs/PROTOCOL.md",
                hello.protocol
            ))),
            other => Err(broken(format!("the runner's first line is not hello but {other:?}"))),
        }
    }

    pub fn process(&self) -> u32 {
        self.child.id()
    }

    pub fn errors(&self) -> String {
        self.errors.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Sends a request and reads the reply. After a failure other than a refusal, the runner is
    /// unusable. If a runner accepts only one frame, the trajectory is sent frame by frame.
    pub fn ask(&mut self, request: &Request) -> Result<Reply, Failure> {
        if let Request::Load(trajectory) = request {
            let several = self.hello.at_rest && trajectory.frames.len() > 1;
            self.by_frame = several.then(|| trajectory.clone());
            if several {
                return Ok(Reply::Loaded);
            }
        }
        match self.by_frame.take() {
            Some(trajectory) => {
                let answer = by_frame::ask(self, &trajectory, request);
                self.by_frame = Some(trajectory);
                answer
            }
            None => self.ask_one(request),
        }
    }

    fn ask_one(&mut self, request: &Request) -> Result<Reply, Failure> {
        let reply = self.exchange(request).map_err(|failure| match failure.outcome {
            Outcome::Wrong => {
                let reason = format!("the runner breaks the protocol: {}", failure.reason);
                Failure { outcome: Outcome::Crashed, reason }
            }
            _ => failure,
        })?;
        match reply {
            // The memory limit is checked here, too, because some systems do not enforce it.
            Reply::Memory(memory) if memory.peak_bytes > self.memory_limit => {
                let (taken, limit) = (memory.peak_bytes, self.memory_limit);
                let reason = format!("it used {taken} bytes; the limit is {limit}");
                Err(Failure { outcome: Outcome::OutOfMemory, reason })
            }
            Reply::Refused { reason } => Err(Failure { outcome: Outcome::Refused, reason }),
            Reply::Error { reason } => Err(Failure { outcome: Outcome::Crashed, reason }),
            reply => Ok(reply),
        }
    }

    /// Sends a request and reads the reply. The failure has the outcome `wrong` if the reply breaks
    /// the protocol.
    pub fn exchange(&mut self, request: &Request) -> Result<Reply, Failure> {
        let broken = |reason: String| Failure { outcome: Outcome::Wrong, reason };
        match request {
            Request::Load(trajectory) => {
                (self.samples, self.frames) = (0, trajectory.frames.len());
                self.particles = trajectory.n;
            }
            Request::Sample { .. } => self.samples += 1,
            _ => {}
        }
        let min_ns = match request {
            // Only the first sample must reach min_ns, because it fixes the number of detections.
            Request::Sample { min_ns } if self.samples == 1 => *min_ns,
            _ => 0,
        };
        let line = serde_json::to_string(request)
            .map_err(|error| broken(format!("cannot write the request as JSON: {error}")))?;
        let started = Instant::now();
        let line = line + "\n";
        let sent = self.input.as_mut().map(|input| input.write_all(line.as_bytes()));
        if !matches!(sent, Some(Ok(()))) {
            return Err(self.post_mortem());
        }
        let reply = self.receive(self.time_limit)?;
        let waited_ns = started.elapsed().as_nanos() as u64;
        let memory_limit = Some(self.memory_limit).filter(|_| cfg!(target_os = "linux"));
        let (frames, particles) = (self.frames, self.particles);
        let asked = Asked { min_ns, frames, particles, waited_ns, memory_limit };
        possible::check(&reply, &asked).map_err(broken)?;
        Ok(reply)
    }

    /// Returns the contacts of a frame (by default the last), which the runner writes to `path`.
    /// `box_dim` is the dimension of the box, if there is one.
    pub fn pairs(
        &mut self,
        path: &Path,
        box_dim: Option<usize>,
        frame: Option<u64>,
    ) -> Result<ContactList, String> {
        // Removes the file of an earlier answer, which must not be taken for this one.
        let _ = std::fs::remove_file(path);
        self.ask(&Request::Pairs { path: path.to_path_buf(), frame })
            .map_err(|failure| failure.reason)?;
        exchange::read_contacts(path, box_dim).map_err(|e| e.to_string())
    }

    fn receive(&mut self, limit: Duration) -> Result<Reply, Failure> {
        let line = match self.wait(limit) {
            Ok(line) => line,
            Err(RecvTimeoutError::Disconnected) => return Err(self.post_mortem()),
            Err(RecvTimeoutError::Timeout) => {
                self.kill();
                let reason = format!("no answer within {} s", limit.as_secs_f64());
                return Err(Failure { outcome: Outcome::Timeout, reason });
            }
        };
        let reply = line.and_then(|line| {
            serde_json::from_str(&line).map(Reply::cleaned).map_err(|error| {
                let shown = output::shown(line.as_bytes());
                format!(
                    "it printed '{shown}' ({error}); a reply is one line of JSON, as in \
                     docs/PROTOCOL.md, and other words go to standard error"
                )
            })
        });
        match reply {
            Ok(Reply::Unavailable { reason }) => {
                Err(Failure { outcome: Outcome::Unavailable, reason })
            }
            Ok(reply) => Ok(reply),
            Err(what) => {
                self.kill();
                let reason = format!("the runner's answer is not a reply: {}", text::line(&what));
                Err(Failure { outcome: Outcome::Wrong, reason })
            }
        }
    }

    /// Waits for a line, and checks for signals. The failure of an interrupted wait is never
    /// recorded; see [`interrupt::check`].
    fn wait(&mut self, limit: Duration) -> Result<Line, RecvTimeoutError> {
        let started = Instant::now();
        loop {
            let left = limit.saturating_sub(started.elapsed());
            match self.lines.recv_timeout(left.min(LOOK)) {
                Err(RecvTimeoutError::Timeout) if left > LOOK && !interrupt::requested() => {}
                answer => return answer,
            }
        }
    }

    fn post_mortem(&mut self) -> Failure {
        self.input = None;
        // The runner closed its output, so it has ended or will soon; after a second it is killed.
        // The pause lets its last messages arrive.
        std::thread::sleep(Duration::from_millis(20));
        let ended = self.ends_within(Duration::from_secs(1));
        let silent = || "it closed its output without answering".into();
        let status = ended.map_or_else(silent, |status| status.to_string());
        self.kill();
        let errors = self.errors();
        // These messages state failed allocations in Rust, this program, C++ and Python. A
        // backtrace may follow them.
        let starved = |line: &&str| {
            ["memory allocation of", "could not be allocated", "bad_alloc", "MemoryError"]
                .iter()
                .any(|words| line.contains(words))
        };
        let (outcome, last) = match errors.lines().rfind(starved) {
            Some(line) => (Outcome::OutOfMemory, Some(text::line(line).into_owned())),
            None => (Outcome::Crashed, self.last_line()),
        };
        let words = last.map_or_else(String::new, |last| format!(": {last}"));
        Failure { outcome, reason: format!("{status}{words}") }
    }

    /// Returns the last line of the runner's standard error.
    fn last_line(&self) -> Option<String> {
        let errors = self.errors();
        let last = errors.lines().rfind(|line| !line.trim().is_empty())?;
        Some(text::line(last).into_owned())
    }

    fn ends_within(&mut self, limit: Duration) -> Option<ExitStatus> {
        let started = Instant::now();
        loop {
            let ended = family::reap(&mut self.child);
            if ended.is_some() || started.elapsed() >= limit {
                return ended;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn kill(&mut self) {
        #[cfg(unix)]
        if family::reap(&mut self.child).is_none() {
            family::signal(self.child.id(), rustix::process::Signal::TERM);
            self.ends_within(TO_CLEAN_UP);
        }
        family::end(&mut self.child);
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        if let Some(mut input) = self.input.take() {
            let told = input.write_all(b"{\"request\":\"quit\"}\n").is_ok();
            drop(input);
            if told {
                self.ends_within(TO_LEAVE);
            }
        }
        self.kill();
    }
}

mod by_frame;
mod output;
#[cfg(all(test, unix))]
mod tests;
