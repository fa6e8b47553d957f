//! The subjects of an experiment: every detector in every arithmetic, and runners in other
//! languages.

use std::path::Path;
use std::time::Duration;

use crate::plan::{self, THREADS, detectors, memory_limit, says_threads};
use crate::run::runner::client::{Client, Failure, Start};
use contactbench_detectors::tracker::{self, TrackerSpec};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::scene::AnyScene;
use contactbench_record::experiment::{Experiment, ExternalRunner, PlannedSubject};
use contactbench_record::record::id::{CellId, split_subject};
use contactbench_record::record::role::Role;
use contactbench_record::record::row::Row;
use contactbench_scenes::spec::Spec;
use contactbench_scenes::stats::Stats;

/// Address space of a runner's program, stacks and libraries, in bytes.
const PROGRAM_BYTES: u64 = 1 << 30;
/// Address space of each further thread in bytes: its stack, and what the system's allocator
/// reserves for it.
const THREAD_BYTES: u64 = 128 << 20;

#[derive(Clone, Default)]
pub struct Subject {
    pub name: String,
    pub arithmetic: Option<Arithmetic>,
    pub role: Role,
    /// Whether the subject is a tracker whose rule may miss contacts.
    pub may_miss: bool,
    pub threads: usize,
    pub start: Start,
    pub copy: Option<Start>,
    pub missing: Option<String>,
    /// Number of the group of builds that are timed in turns; `None` if the subject is timed alone.
    pub duet: Option<usize>,
}

pub(crate) const BASE: &str = "@base";
const TWIN: &str = "-twin";

/// Returns the command that starts one of this program's detectors as a runner. `program` may
/// include arguments; `limit` is in bytes.
pub fn own(
    program: &[String],
    detector: &str,
    arithmetic: Arithmetic,
    threads: usize,
    limit: u64,
) -> Vec<String> {
    let [threads, limit] = [threads as u64, limit].map(|number| number.to_string());
    let options = [("detector", detector), ("arithmetic", arithmetic.name())];
    let options = options.into_iter().chain([("threads", &*threads), ("memory-limit", &limit)]);
    let options = options.flat_map(|(name, value)| [format!("--{name}"), value.into()]);
    program.iter().cloned().chain(["runner".into()]).chain(options).collect()
}

/// Fails unless `program` starts a runner as builds of this program do.
pub(crate) fn is_build(program: &Path) -> Result<(), Failure> {
    let limit = 1 << 28;
    let program = [program.display().to_string()];
    let command = own(&program, "nothing", Arithmetic::default(), 1, limit);
    let start = Start::of(&command, Duration::from_secs(10), address_space(limit, 1));
    Client::start(&start).map(drop)
}

/// Returns the address space of a runner, without its scene, if its detector may use `limit` bytes.
pub(crate) fn address_space(limit: u64, threads: usize) -> u64 {
    limit.saturating_add(PROGRAM_BYTES + (threads as u64).saturating_sub(1) * THREAD_BYTES)
}

/// Returns the bytes for a scene and its list of pairs, with a reserve. While the scene is read, it
/// is held twice; so is the list while it grows, and its capacity may be twice its length.
pub fn room(n: u64, contacts: u64) -> u64 {
    n * (2 * 32 + 128) + contacts * 4 * 8
}

/// Returns the subjects of an experiment, by arithmetic.
///
/// If there is another build, each detector takes part three times: in this build, in the other,
/// and as its own twin, which shows the noise of equal code. Otherwise there is at least one twin
/// if times are measured.
pub fn subjects(experiment: &Experiment, program: &Path, against: Option<&Path>) -> Vec<Subject> {
    let planned = of_plan(experiment, program, against.is_some());
    let timed = experiment.blocks > 0;
    if let Some(base) = against {
        let entries = planned.into_iter().enumerate().map(|(k, one)| match one.missing {
            None => one.trio(k, base).to_vec(),
            Some(_) => vec![one],
        });
        return entries.flatten().collect();
    }
    let named = planned.iter().any(|subject| subject.role.twin_of().is_some());
    let originals = planned.iter().filter(|one| !one.role.is_control() && one.missing.is_none());
    // A subject with few threads is preferred: with one thread, it stays on one processor.
    let original = originals.min_by_key(|one| one.threads);
    let twin = original.filter(|_| timed && !named).map(Subject::twin);
    planned.into_iter().chain(twin).collect()
}

/// Returns the subjects that the experiment names; if there is another build, only those that can
/// differ in it.
fn of_plan(experiment: &Experiment, path: &Path, beside: bool) -> Vec<Subject> {
    let limit = memory_limit(experiment);
    let start = |command: &[String], install: &str, threads: usize| Start {
        install: install.to_string(),
        ..Start::of(
            command,
            Duration::from_secs_f64(experiment.time_limit_s),
            address_space(limit, threads),
        )
    };
    let path = [path.display().to_string()];
    let of_detector = |planned: &PlannedSubject, arithmetic| {
        // Names were checked when the experiment was read. So a name that does not parse is a peer
        // that was not compiled.
        let PlannedSubject { name, threads, .. } = planned;
        let spec = tracker::parse(name);
        let with = |threads| {
            let mut start = start(&own(&path, name, arithmetic, threads, limit), "", threads);
            // A tracker may use the limit once for its lists and once for its detector.
            if detectors::is_tracker(name) {
                start.memory_limit = start.memory_limit.saturating_add(limit);
            }
            start
        };
        Subject {
            may_miss: spec.as_ref().is_ok_and(TrackerSpec::may_miss),
            missing: spec.err().map(|reason| reason.to_string()),
            copy: (experiment.ceiling && *threads > 1).then(|| with(1)),
            ..Subject::new(planned, with(*threads))
        }
    };
    let of_runner = |planned: &PlannedSubject, runner: &ExternalRunner| {
        let with = |threads: usize| {
            let word = |word: &String| word.replace(THREADS, &threads.to_string());
            let command: Vec<String> = runner.command.iter().map(word).collect();
            start(&command, &runner.install, threads)
        };
        let copied = experiment.ceiling && says_threads(runner) && planned.threads > 1;
        Subject { copy: copied.then(|| with(1)), ..Subject::new(planned, with(planned.threads)) }
    };
    let subject = |planned: &PlannedSubject| match planned.arithmetic {
        Some(arithmetic) => Some(of_detector(planned, arithmetic)),
        None => {
            let runner = experiment.runners.iter().find(|runner| runner.name == planned.name)?;
            Some(of_runner(planned, runner))
        }
    };
    let all_planned = experiment.planned.subjects.iter();
    all_planned.filter(|planned| !beside || planned.is_of_builds()).filter_map(subject).collect()
}

fn suffixed(spec: &str, suffix: &str) -> String {
    let (name, rest) = spec.split_at(spec.find([':', '(']).unwrap_or(spec.len()));
    format!("{name}{suffix}{rest}")
}

impl Subject {
    fn new(planned: &PlannedSubject, start: Start) -> Subject {
        let PlannedSubject { name, role, arithmetic, threads } = planned.clone();
        Subject { name, arithmetic, role, threads, start, ..Subject::default() }
    }

    fn twin(&self) -> Subject {
        let name = suffixed(&self.name, TWIN);
        let role = Role::Twin(split_subject(&self.name).0);
        Subject { name, role, copy: None, ..self.clone() }
    }

    fn trio(self, number: usize, base: &Path) -> [Subject; 3] {
        let this = Subject { duet: Some(number), copy: None, ..self };
        let mut other = Subject {
            name: suffixed(&this.name, BASE),
            role: Role::Base(split_subject(&this.name).0),
            ..this.clone()
        };
        if let Some(program) = other.start.command.first_mut() {
            *program = base.display().to_string();
        }
        let twin = this.twin();
        [this, other, twin]
    }

    pub fn allowing(mut self, scene: &AnyScene<'_>, contacts: u64) -> Subject {
        for start in std::iter::once(&mut self.start).chain(&mut self.copy) {
            start.memory_limit += room(scene.len() as u64, contacts);
        }
        self
    }

    pub fn blank(
        &self,
        experiment: &Experiment,
        spec: &Spec,
        scene: Option<&AnyScene<'_>>,
        stats: &Stats,
    ) -> Row {
        let id = plan::id(experiment, spec);
        let id = CellId {
            dim: scene.map_or(id.dim, |scene| scene.dim() as u32),
            n: scene.map_or(id.n, |scene| scene.len() as u64),
            arithmetic: self.arithmetic.unwrap_or_default().name().into(),
            ..id
        };
        Row {
            id: id.with_subject(&self.name).with_threads(self.threads as u32),
            role: self.role.clone(),
            stats: stats.clone(),
            ..Row::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn experiment_with(lists: &str) -> Experiment {
        let head = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\n";
        let scene = "\n[[scene]]\nname = \"packed\"\nn = 50\n";
        plan::parse(&format!("{head}{lists}{scene}"), Path::new(".")).unwrap()
    }

    #[test]
    fn wherever_times_are_taken_there_is_a_twin() {
        let twins = |lists: &str| -> Vec<(String, usize)> {
            let all = subjects(&experiment_with(lists), Path::new("contactbench"), None);
            let twins = all.into_iter().filter(|one| one.role.twin_of().is_some());
            twins.map(|one| (one.name, one.threads)).collect()
        };
        let several = "detectors = [\"streamed-nbs\", \"nbs\"]\n";
        for (lists, name, threads) in [
            (format!("{several}threads = [1, 2]"), "streamed-nbs-twin", 1),
            (format!("{several}threads = [2]"), "nbs-twin", 1),
            ("detectors = [\"streamed-nbs\"]\nthreads = [2]".into(), "streamed-nbs-twin", 2),
        ] {
            assert_eq!(twins(&lists), [(name.to_string(), threads)], "{lists}");
        }
        assert!(twins(&format!("{several}blocks = 0")).is_empty());
    }

    #[test]
    fn beside_another_build_are_detectors() {
        let experiment = experiment_with("detectors = [\"nothing\", \"nbs\"]");
        let program = Path::new("contactbench");
        let all = subjects(&experiment, program, Some(Path::new("base")));
        let names: Vec<&str> = all.iter().map(|one| &*one.name).collect();
        assert_eq!(names, ["nbs", "nbs@base", "nbs-twin"]);
    }
}
