//! Who takes part in an experiment: every detector in every arithmetic, and the runners in other
//! languages.

use std::path::Path;
use std::time::Duration;

use crate::contact::Arithmetic;
use crate::detect::table::{self, DetectorSpec};
use crate::experiment::Experiment;
use crate::record::id::CellId;
use crate::record::provenance;
use crate::record::role::Role;
use crate::record::row::Row;
use crate::run::client::Start;
use crate::scene::AnyScene;
use crate::scene::spec::{Order, Spec};
use crate::scene::stats::Stats;

/// Address space for a runner beside a detector's arrays and the scene: the program, its stacks,
/// its libraries.
const PROGRAM_BYTES: u64 = 1 << 30;
/// The same for each further thread: its stack, and the address space that the system's allocator
/// sets apart for it.
const THREAD_BYTES: u64 = 128 << 20;
/// What stands for the number of threads in the command of a runner in another language.
const THREADS: &str = "{threads}";

/// A detector with an arithmetic, as a runner.
#[derive(Clone)]
pub(crate) struct Contender {
    pub name: String,
    /// `None`: the runner says.
    pub arithmetic: Option<Arithmetic>,
    pub role: Role,
    pub threads: usize,
    pub start: Start,
    /// How a copy with one thread is started, where the ceiling of several threads is to be
    /// measured.
    pub copy: Option<Start>,
    /// Why it cannot be started at all.
    pub missing: Option<String>,
}

/// The command that starts this program as a runner of one of its detectors; `limit` is in bytes.
pub(crate) fn own(
    program: &Path,
    detector: &str,
    arithmetic: Arithmetic,
    threads: usize,
    limit: u64,
) -> Vec<String> {
    let mut command = vec![
        program.display().to_string(),
        "runner".into(),
        "--detector".into(),
        detector.to_string(),
    ];
    command.extend([
        "--arithmetic".into(),
        arithmetic.name().into(),
        "--threads".into(),
        threads.to_string(),
    ]);
    command.extend(["--memory-limit".into(), limit.to_string()]);
    command
}

/// The address space of a runner whose detector may take `limit` bytes, without its scene and
/// pairs.
pub(crate) fn address_space(limit: u64, threads: usize) -> u64 {
    limit.saturating_add(PROGRAM_BYTES + (threads as u64).saturating_sub(1) * THREAD_BYTES)
}

/// Bytes for a scene and its list of pairs: the scene (twice while it is read); the list (up to
/// twice its size, and twice while it grows), with some to spare.
pub(crate) fn room(n: u64, contacts: u64) -> u64 {
    n * (2 * 32 + 128) + contacts * 4 * 8
}

/// The contenders of an experiment, by arithmetic.
pub(crate) fn contenders(experiment: &Experiment, program: &Path) -> Vec<Contender> {
    let limit = experiment.memory_limit_mib << 20;
    let start = |command: Vec<String>, install: &str, threads: usize| Start {
        command,
        install: install.to_string(),
        time_limit: Duration::from_secs_f64(experiment.time_limit_s),
        memory_limit: address_space(limit, threads),
    };
    let asked = experiment.threads.to_vec();
    let mut contenders = Vec::new();
    for &arithmetic in &experiment.arithmetics {
        for name in &experiment.detectors {
            // The names were checked when the experiment was read: what is left is a peer that
            // was not compiled.
            let (role, several, missing) = match table::parse(name) {
                Ok(DetectorSpec { entry, .. }) => (Role::from(entry.role), entry.threads, None),
                Err(reason) => (Role::Peer, false, Some(reason.to_string())),
            };
            let with =
                |threads: usize| start(own(program, name, arithmetic, threads, limit), "", threads);
            // A sequential detector has one thread, whatever the others are given.
            for &threads in if several { &*asked } else { &[1] } {
                contenders.push(Contender {
                    name: name.clone(),
                    arithmetic: Some(arithmetic),
                    role: role.clone(),
                    threads,
                    start: with(threads),
                    copy: (experiment.ceiling && threads > 1).then(|| with(1)),
                    missing: missing.clone(),
                });
            }
        }
    }
    for runner in &experiment.runners {
        let with = |threads: usize| {
            let command =
                runner.command.iter().map(|word| word.replace(THREADS, &threads.to_string()));
            start(command.collect(), &runner.install, threads)
        };
        // A command that does not say how many threads is the same for all numbers of them.
        let says = runner.command.iter().any(|word| word.contains(THREADS));
        for &threads in if says { &*asked } else { &asked[..1] } {
            contenders.push(Contender {
                name: runner.name.clone(),
                arithmetic: None,
                role: Role::Runner,
                threads,
                start: with(threads),
                copy: (experiment.ceiling && says && threads > 1).then(|| with(1)),
                missing: None,
            });
        }
    }
    contenders
}

impl Contender {
    /// With memory for a scene and its list of pairs beside the detector's own.
    pub fn allowing(mut self, scene: &AnyScene<'_>, contacts: u64) -> Contender {
        for start in std::iter::once(&mut self.start).chain(&mut self.copy) {
            start.memory_limit += room(scene.len() as u64, contacts);
        }
        self
    }

    /// A row of this contender without a measurement; without a scene, too, where there is none.
    pub fn blank(
        &self,
        experiment: &Experiment,
        spec: &Spec,
        scene: Option<&AnyScene<'_>>,
        stats: &Stats,
    ) -> Row {
        let id = CellId {
            experiment: experiment.name.clone(),
            scene: spec.name.clone(),
            dim: scene.map_or(spec.dim, |scene| scene.dim() as u32),
            machine: Some(provenance::machine()),
            params: spec.params.iter().map(|(name, v)| (name.clone(), v.into())).collect(),
            order: match spec.order {
                Order::Shuffled => "shuffled",
                Order::Generated => "generated",
                Order::Morton => "morton",
            }
            .into(),
            n: scene.map_or(spec.n, |scene| scene.len() as u64),
            seed: spec.seed,
            arithmetic: self.arithmetic.unwrap_or_default().name().into(),
            ..CellId::default()
        };
        Row {
            id: id.with_contender(&self.name).with_threads(self.threads as u32),
            role: self.role.clone(),
            stats: stats.clone(),
            ..Row::default()
        }
    }
}
