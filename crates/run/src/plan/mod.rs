//! Plans experiments: resolves names of detectors and scenes, and fills in defaults that
//! [`Experiment`] leaves open.

pub mod builtin;
pub mod detectors;
mod scenes;

use std::io::Read;
use std::path::Path;

use anyhow::{Context, ensure};

pub use self::scenes::{id, specs};
use contactbench_ground::limits::memory::default_limit;
use contactbench_record::experiment::{
    Bars, Document, Experiment, ExternalRunner, FigureKind, Planned, PlannedSubject, Where,
};
use contactbench_record::record::role::Role;
use contactbench_terms::nearest::hint;

/// Maximum size of an experiment file in bytes; the largest one of this project has 15 kB.
const MOST_BYTES: u64 = 1 << 20;
pub const THREADS: &str = "{threads}";

fn short_enough(len: usize) -> anyhow::Result<()> {
    ensure!(
        len as u64 <= MOST_BYTES,
        "an experiment has at most {} KiB; give a scene lists of values, or write several \
         experiments",
        MOST_BYTES >> 10
    );
    Ok(())
}

/// Reads an experiment file for a new run, and returns its text, too. Claims and figures may name
/// only rows that the run will have.
pub fn read(path: &Path) -> anyhow::Result<(Experiment, String)> {
    let place = || format!("in {}", path.display());
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path);
    file.and_then(|file| file.take(MOST_BYTES + 1).read_to_end(&mut bytes))
        .with_context(|| format!("cannot read the experiment {}", path.display()))?;
    short_enough(bytes.len()).with_context(place)?;
    let text = String::from_utf8(bytes);
    let text = text.with_context(|| format!("{} is not text (UTF-8)", path.display()))?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let (experiment, document) = checked(&text, folder, false).with_context(place)?;
    experiment.check_names(&document).with_context(place)?;
    Ok((experiment, text))
}

/// Parses and checks the text of an experiment; file names of scenes are relative to `folder`.
pub fn parse(text: &str, folder: &Path) -> anyhow::Result<Experiment> {
    checked(text, folder, false).map(|read| read.0)
}

/// Parses the copy of an experiment in a record. It may name detectors, trackers and motions that
/// this program lacks, because their rows are only reported.
pub fn parse_copy(text: &str) -> anyhow::Result<Experiment> {
    checked(text, Path::new(""), true).map(|read| read.0)
}

fn checked<'a>(
    text: &'a str,
    folder: &Path,
    is_copy: bool,
) -> anyhow::Result<(Experiment, Document<'a>)> {
    short_enough(text.len())?;
    let (mut experiment, document) = Document::read(text, is_copy)?;
    experiment.detectors = detectors::expand(&experiment.detectors, is_copy)
        .map_err(|words| document.key("detectors", words))?;
    experiment.ratios_to = experiment.ratios_to.as_deref().map(detectors::normal);
    resolve_names(&mut experiment, &document, is_copy)?;
    experiment.check(&document)?;
    for sweep in &mut experiment.scenes {
        scenes::relative_to(sweep, folder).with_context(|| format!("line {}", sweep.line))?;
    }
    let whole = specs(&experiment, false)?;
    let quick = specs(&experiment, true)?;
    if !is_copy {
        let mut trajectories = whole.iter().filter_map(|spec| spec.trajectory);
        trajectories.try_for_each(|trajectory| trajectory.motion.kind.made())?;
    }
    let ids = |specs: &[_]| specs.iter().map(|spec| id(&experiment, spec)).collect();
    experiment.planned = Planned {
        scenes: ids(&whole),
        quick: ids(&quick),
        subjects: subjects(&experiment),
        own_n: scenes::own_n(&experiment),
    };
    Ok((experiment, document))
}

fn resolve_names(
    experiment: &mut Experiment,
    document: &Document<'_>,
    is_copy: bool,
) -> anyhow::Result<()> {
    let lacking = experiment.detectors.iter().filter(|name| is_copy && detectors::is_lacking(name));
    let lacking: Vec<String> = lacking.cloned().collect();
    let runners = experiment.runners.iter().map(|runner| runner.name.clone());
    let known: Vec<String> = experiment.detectors.iter().cloned().chain(runners).collect();
    for (k, claim) in experiment.claims.iter_mut().enumerate() {
        let problem = |words| document.claim(k, words);
        resolve(&mut claim.filter, &lacking).map_err(problem)?;
        if let Some(than) = claim.kind.than_mut() {
            name_one(than, "than", &known).map_err(problem)?;
        }
    }
    for (k, figure) in experiment.figures.iter_mut().enumerate() {
        let problem = |words| document.figure(k, words);
        resolve(&mut figure.filter, &lacking).map_err(problem)?;
        if let FigureKind::Bars(Bars { to }) = &mut figure.kind {
            name_one(to, "to", &known).map_err(problem)?;
        }
    }
    Ok(())
}

/// Normalises the name of a detector; fails unless the result is in `known`.
fn name_one(name: &mut String, key: &str, known: &[String]) -> Result<(), String> {
    *name = detectors::normal(name);
    if known.contains(name) {
        return Ok(());
    }
    Err(format!(
        "{key} = \"{name}\": it must be one of the experiment's detectors or runners{}",
        hint(name, known.iter().map(String::as_str))
    ))
}

/// Expands groups of detectors. In the copy of a record, a group that this program lacks stands for
/// the `lacking` detectors, which it lacks, too.
fn resolve(filter: &mut Where, lacking: &[String]) -> Result<(), String> {
    let Some(list) = filter.get_mut("detector") else { return Ok(()) };
    let mut all = Vec::new();
    for value in list.drain(..) {
        match value.as_str() {
            Some(group) if group.starts_with('@') => {
                let members = match detectors::members(group) {
                    Err(_) if !lacking.is_empty() => lacking.to_vec(),
                    members => members?,
                };
                all.extend(members.into_iter().map(toml::Value::from));
            }
            Some(name) => all.push(detectors::normal(name).into()),
            None => all.push(value),
        }
    }
    *list = all;
    Ok(())
}

pub fn memory_limit(experiment: &Experiment) -> u64 {
    experiment.memory_limit_mib.map_or_else(default_limit, |mib| mib << 20)
}

fn subjects(experiment: &Experiment) -> Vec<PlannedSubject> {
    let Experiment { threads, .. } = experiment;
    let mut all = Vec::new();
    for &arithmetic in &experiment.arithmetics {
        for name in &experiment.detectors {
            // Sequential detectors run with one thread. A tracker runs with as many threads as its
            // detector.
            let spec = contactbench_detectors::tracker::parse(name);
            let entry = spec.as_ref().map(|spec| spec.detector().entry);
            let role = entry.map_or(Role::Peer, |entry| detectors::role(entry.role));
            let several = entry.is_ok_and(|entry| entry.threads);
            let counts = if several { &threads[..] } else { &[1] };
            all.extend(counts.iter().map(|&threads| PlannedSubject {
                name: name.clone(),
                role: role.clone(),
                arithmetic: Some(arithmetic),
                threads,
            }));
        }
    }
    for runner in &experiment.runners {
        // A command without `{threads}` is measured once, with the first number of threads.
        let counts = if says_threads(runner) { &threads[..] } else { &threads[..1] };
        all.extend(counts.iter().map(|&threads| PlannedSubject {
            name: runner.name.clone(),
            role: Role::Runner,
            arithmetic: None,
            threads,
        }));
    }
    all
}

pub fn says_threads(runner: &ExternalRunner) -> bool {
    runner.command.iter().any(|word| word.contains(THREADS))
}

#[cfg(test)]
mod documented_tests;
#[cfg(test)]
mod tests;
