//! Groups of detectors that are checked together: those of the table, or a runner.

use std::io::Write;

use anyhow::{bail, ensure};

use super::Check;
use super::failing::last_words;
use contactbench_detectors::table::{self, TABLE};
use contactbench_ground::contact::Arithmetic;
use contactbench_run::check::process::{self, Foreign};
use contactbench_run::check::subject::CheckedSubject;
use contactbench_run::check::{Limits, Wrong, conversation};
use contactbench_run::plan::detectors;

pub(super) struct Group {
    pub(super) subjects: Vec<CheckedSubject>,
    pub(super) arithmetics: Vec<Arithmetic>,
}

impl Group {
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.subjects.iter().map(CheckedSubject::name)
    }
}

pub(super) fn detectors(options: &Check) -> anyhow::Result<Group> {
    let names = detectors::expand(&options.detector, false).map_err(anyhow::Error::msg)?;
    let parse = |name: &String| Ok(CheckedSubject::from(table::parse(name)?));
    let mut subjects = names.iter().map(parse).collect::<anyhow::Result<Vec<_>>>()?;
    if subjects.is_empty() {
        let right = TABLE.iter().filter(|entry| entry.must_be_right());
        subjects.extend(right.map(CheckedSubject::from));
    }
    let arithmetics = match &*options.arithmetic {
        [] => vec![Arithmetic::Exact],
        all => all.to_vec(),
    };
    Ok(Group { subjects, arithmetics })
}

/// The word in a runner's command that is replaced by the arithmetic.
const ARITHMETIC: &str = "{arithmetic}";

/// Splits the command of a runner into words; also returns the arithmetics to start it in.
fn commands(
    command: &str,
    options: &Check,
) -> anyhow::Result<(Vec<String>, Vec<Option<Arithmetic>>)> {
    let words = match shlex::split(command) {
        Some(words) if !words.is_empty() => words,
        Some(_) => {
            bail!("--runner is empty; give a command, as in --runner \"python3 my_detector.py\"")
        }
        None => bail!("--runner '{command}': close the quote"),
    };
    let asks = words.iter().any(|word| word.contains(ARITHMETIC));
    ensure!(
        asks || options.arithmetic.is_empty(),
        "--arithmetic: the first line of a runner names its arithmetic; if its command takes one, \
         use --runner \"my-detector --arithmetic {ARITHMETIC}\""
    );
    let asked: Vec<Option<Arithmetic>> = match (asks, options.arithmetic.is_empty()) {
        (false, _) => vec![None],
        (true, true) => Arithmetic::SAFE.map(Some).into(),
        (true, false) => options.arithmetic.iter().copied().map(Some).collect(),
    };
    Ok((words, asked))
}

/// Starts a runner in each arithmetic, tests the protocol, and prints what it supports.
pub(super) fn runners(
    command: &str,
    options: &Check,
    limits: &Limits,
    broken: &mut Vec<Wrong>,
    out: &mut dyn Write,
) -> anyhow::Result<Vec<Group>> {
    let (words, asked) = commands(command, options)?;
    let mut groups = Vec::new();
    for arithmetic in asked {
        let name = arithmetic.map_or("", Arithmetic::name);
        let words = words.iter().map(|word| word.replace(ARITHMETIC, name)).collect();
        let met = Foreign::meet(words).and_then(|foreign| {
            let said = foreign.arithmetic;
            ensure!(
                arithmetic.is_none_or(|asked| asked == said),
                Wrong::Breaks(format!(
                    "it was started with {name} arithmetic, and its first line has {}",
                    said.name()
                ))
            );
            Ok(foreign)
        });
        let (foreign, lacks, wrongs) = match process::wrong(met)? {
            Ok(foreign) => {
                let (lacks, wrongs) = conversation::hold(&foreign, limits.deadline)?;
                (Some(foreign), lacks, wrongs)
            }
            Err(wrong) => (None, vec![], vec![wrong]),
        };
        for wrong in &wrongs {
            writeln!(out, "WRONG: {wrong}")?;
            last_words(wrong, out)?;
        }
        let Some(foreign) = foreign else {
            broken.extend(wrongs);
            continue;
        };
        let Foreign { name, version, arithmetic, .. } = &foreign;
        let version = if version.is_empty() { String::new() } else { format!(" {version}") };
        let lacks = match &lacks[..] {
            _ if !wrongs.is_empty() => "breaks the protocol".into(),
            [] => "has all requests".into(),
            lacks => format!("without {}", lacks.join(" and ")),
        };
        writeln!(out, "runner: {name}{version}, {} arithmetic, {lacks}", arithmetic.name())?;
        broken.extend(wrongs);
        groups.push(Group {
            arithmetics: vec![*arithmetic],
            subjects: vec![CheckedSubject::Runner(foreign)],
        });
    }
    Ok(groups)
}
