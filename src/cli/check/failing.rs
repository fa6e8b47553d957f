//! What is printed and written of detectors that are wrong, and of refusals.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::Check;
use crate::check::{Differences, Failure, Report, Wrong, regression};
use crate::oracle;
use crate::present::draw;
use crate::present::draw::{Highlighted, Look};

/// So many kinds of refusals are shown.
const KINDS: usize = 6;

/// The file that a failing scene is written to.
pub(super) fn regression_file(failure: &Failure, given: Option<&Path>, options: &Check) -> PathBuf {
    let stem = given
        .and_then(Path::file_stem)
        .map(|stem| format!("-{}", stem.to_string_lossy()))
        .unwrap_or_default();
    options.out.join(format!(
        "failing-{}-{}{stem}.csv",
        failure.detector.replace([':', '=', ','], "-"),
        failure.arithmetic.name()
    ))
}

/// What a runner said on its standard error before it died.
pub(super) fn last_words(wrong: &Wrong, out: &mut dyn Write) -> anyhow::Result<()> {
    if let Wrong::Dies { errors, .. } = wrong
        && errors.lines().count() > 1
    {
        writeln!(out, "  the last lines of its standard error:")?;
        for line in errors.lines() {
            writeln!(out, "    {line}")?;
        }
    }
    Ok(())
}

/// Refusals of a kind differ in numbers only.
pub(super) fn refusals(report: &Report, out: &mut dyn Write) -> anyhow::Result<()> {
    let mut kinds: BTreeMap<String, (&str, u64)> = BTreeMap::new();
    for (reason, times) in &report.refused {
        let kind = reason
            .chars()
            .map(|c| if c.is_ascii_digit() { '0' } else { c })
            .filter(|c| !"0.-+e".contains(*c))
            .collect();
        kinds.entry(kind).or_insert((reason, 0)).1 += times;
    }
    let mut kinds: Vec<(&str, u64)> = kinds.into_values().collect();
    kinds.sort_by_key(|&(_, times)| std::cmp::Reverse(times));
    for (reason, times) in kinds.iter().take(KINDS) {
        writeln!(out, "refused {times} times: {reason}")?;
    }
    if kinds.len() > KINDS {
        let rest: u64 = kinds[KINDS..].iter().map(|(_, times)| times).sum();
        writeln!(out, "refused {rest} times for {} other reasons", kinds.len() - KINDS)?;
    }
    Ok(())
}

/// The scene with its contacts, and what is wrong with the pairs. None where nobody could draw it.
fn picture(failure: &Failure) -> Option<String> {
    let Failure { detector, arithmetic, found, smallest, wrong, .. } = failure;
    let mut contacts = oracle::truth(smallest, *arithmetic).ok()?.pairs;
    let wrong = wrong.as_ref().unwrap_or(found);
    let Differences { missed, spurious, selves, duplicate } = match wrong {
        Wrong::Pairs(differences) => differences.clone(),
        _ => Differences::default(),
    };
    contacts.retain(|pair| missed.binary_search(pair).is_err());
    let near = Highlighted::from_scene(smallest).ok()?.near;
    let pairs = Highlighted {
        contacts,
        near,
        missed,
        spurious: [spurious, selves].concat(),
        duplicates: duplicate,
    };
    let title = format!("{detector}, {}: {wrong}", arithmetic.name());
    draw::svg(smallest, &pairs, &Look::titled(title)).ok()
}

pub(super) fn describe(
    failure: &Failure,
    given: Option<&Path>,
    options: &Check,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let Failure { detector, arithmetic, found_on, found, smallest, wrong } = failure;
    let arithmetic = arithmetic.name();
    writeln!(out, "WRONG: {detector} with {arithmetic} arithmetic, on {found_on}: {found}")?;
    last_words(wrong.as_ref().unwrap_or(found), out)?;
    let path = regression_file(failure, given, options);
    let who = match &options.runner {
        None => format!("--detector {detector} --arithmetic {arithmetic}"),
        Some(command) => format!("--runner {}", shlex::try_quote(command).unwrap_or_default()),
    };
    let scene = regression::file(failure, &path, &who);
    std::fs::write(&path, &scene).with_context(|| {
        format!("cannot write {}; choose another place with --out", path.display())
    })?;
    let (n, place) = (smallest.len(), path.display());
    match wrong {
        Some(Wrong::Hangs(_)) => {
            writeln!(out, "  the scene, not made smaller: {n} particles: {place}")?
        }
        Some(wrong) => writeln!(out, "  smallest failing scene: {n} particles, {wrong}: {place}")?,
        None => writeln!(
            out,
            "  only after earlier scenes: something is left in its buffers; the scene: {n} \
             particles: {place}"
        )?,
    }
    if let Some(picture) = picture(failure) {
        let path = path.with_extension("svg");
        std::fs::write(&path, picture).with_context(|| {
            format!("cannot write {}; choose another place with --out", path.display())
        })?;
        writeln!(
            out,
            "  drawn, missed pairs red and dashed, spurious ones orange: {}",
            path.display()
        )?;
    }
    for line in scene.lines().filter(|line| !line.starts_with('#')).take(12) {
        writeln!(out, "    {line}")?;
    }
    writeln!(out, "  again:  contactbench check --scene {place} {who}")?;
    if options.runner.is_none() {
        writeln!(
            out,
            "  see it: contactbench detect {place} --detector {detector} --arithmetic {arithmetic}"
        )?;
    }
    writeln!(
        out,
        "  truth:  contactbench detect {place} --detector direct --arithmetic {arithmetic}"
    )?;
    Ok(())
}
