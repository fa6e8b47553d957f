//! Reports of wrong detectors and of refusals.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::Check;
use crate::cli::shared::scene::particle_line;
use contactbench_detectors::oracle::boxes;
use contactbench_detectors::spec;
use contactbench_ground::limits::memory::default_limit;
use contactbench_ground::periodic::{ImagePair, depth};
use contactbench_run::check::{Differences, Failure, Report, Wrong, regression};
use contactbench_scenes::touching::in_any_box;
use contactbench_terms::number::{mean_radii, plural};
use contactbench_views::draw::{self, Look, Pairs};

/// Maximum number of refusals that are printed.
const KINDS: usize = 12;

/// Maximum number of lines printed of a failing scene.
const LINES: usize = 12;

pub(super) fn regression_file(failure: &Failure, given: Option<&str>, options: &Check) -> PathBuf {
    let stem = given
        .and_then(|scene| Path::new(scene).file_stem())
        .map(|stem| format!("-{}", stem.to_string_lossy()))
        .unwrap_or_default();
    let name = format!("failing-{}-{}{stem}", failure.detector, failure.arithmetic.name());
    folder(options).join(name.replace([':', '=', ','], "-") + regression::ending(failure))
}

/// Returns the folder for failing scenes: that of --out, or a temporary one.
fn folder(options: &Check) -> PathBuf {
    let own = || std::env::temp_dir().join(format!("contactbench-check-{}", std::process::id()));
    options.out.clone().unwrap_or_else(own)
}

/// Gap or overlap in mean radii; below it, rounding decides whether a pair touches.
const TANGENT: f64 = 1e-9;

/// Returns the worst pair of the scene before it was shrunk, because two defects may shrink to the
/// same scene.
pub(super) fn worst(failure: &Failure) -> Option<(ImagePair, f64)> {
    let Wrong::Pairs(differences) = &failure.found else { return None };
    let all = differences.missed.iter().chain(&differences.spurious);
    let periodic = in_any_box(&failure.given).ok()?;
    let deep = |&pair: &ImagePair| (pair, depth(&periodic, pair));
    all.map(deep).max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
}

/// Returns a remark if rounding explains every wrong pair of the failure.
pub(super) fn rounding(failure: &Failure) -> Option<String> {
    let Wrong::Pairs(Differences { missed, spurious, selves, duplicate }) = &failure.found else {
        return None;
    };
    let (_, depth) = worst(failure).filter(|(_, depth)| depth.abs() < TANGENT)?;
    let others = selves.is_empty() && duplicate.is_empty();
    let count = missed.len() + spurious.len();
    (others && failure.arithmetic.is_exact()).then(|| {
        let all = if count == 1 { "the pair".into() } else { format!("all {count} pairs") };
        format!(
            "{all} it gets wrong there: tangent to within {}; it seems to decide contacts in \
             rounded arithmetic: declare f64 (or f32), or decide exactly",
            mean_radii(depth.abs())
        )
    })
}

/// Prints the standard error of a runner that died.
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

/// Prints the most frequent kinds of refusals, each with its first reason. Reasons that differ only
/// in numbers are one kind.
pub(super) fn refusals(report: &Report, out: &mut dyn Write) -> anyhow::Result<()> {
    let mut kinds: BTreeMap<String, (&String, u64)> = BTreeMap::new();
    for (reason, times) in &report.refused {
        let kind = reason.chars().filter(|c| !c.is_ascii_digit()).collect();
        kinds.entry(kind).or_insert((reason, 0)).1 += times;
    }
    let mut kinds: Vec<(&String, u64)> = kinds.into_values().collect();
    kinds.sort_by_key(|(_, times)| std::cmp::Reverse(*times));
    for (reason, times) in kinds.iter().take(KINDS) {
        writeln!(out, "refused {}: {reason}", plural(*times as usize, "time"))?;
    }
    if kinds.len() > KINDS {
        let rest: u64 = kinds[KINDS..].iter().map(|(_, times)| times).sum();
        let (rest, others) = (plural(rest as usize, "time"), kinds.len() - KINDS);
        writeln!(out, "refused {rest} for {}", plural(others, "other reason"))?;
    }
    Ok(())
}

/// Draws the scene with its wrong pairs; returns `None` if it cannot be drawn.
fn picture(failure: &Failure) -> Option<String> {
    let Failure { detector, arithmetic, found, smallest, wrong, .. } = failure;
    let (smallest, limit) = (in_any_box(smallest).ok()?, default_limit());
    let contacts = boxes::truth(&smallest, *arithmetic, limit).ok()?.pairs;
    let mut pairs = Pairs { contacts, ..Pairs::default() };
    let wrong = wrong.as_ref().unwrap_or(found);
    if let Wrong::Pairs(Differences { missed, spurious, selves, duplicate }) = wrong {
        pairs.contacts.retain(|pair| missed.binary_search(pair).is_err());
        pairs.missed = missed.clone();
        pairs.spurious = [&spurious[..], selves].concat();
        pairs.duplicates = duplicate.clone();
    }
    let title = format!("{detector}, {}: {wrong}", arithmetic.name());
    draw::svg(&smallest, &pairs, &Look { title, ..Look::default() }).ok()
}

pub(super) fn describe(
    failure: &Failure,
    asked: Option<&str>,
    options: &Check,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let Failure { detector, arithmetic, found_on, found, wrong, .. } = failure;
    let arithmetic = arithmetic.name();
    writeln!(out, "WRONG: {detector} with {arithmetic} arithmetic, on {found_on}: {found}")?;
    last_words(wrong.as_ref().unwrap_or(found), out)?;
    worst_pair(failure, out)?;
    if let Some(words) = rounding(failure) {
        writeln!(out, "  {words}")?;
    }
    let path = regression_file(failure, asked, options);
    let who = match &options.runner {
        None => format!("--detector {detector} --arithmetic {arithmetic}"),
        Some(command) => format!("--runner {}", shlex::try_quote(command).unwrap_or_default()),
    };
    let text = regression::file(failure, &path, &who);
    let write = |path: &Path, text: &str| {
        let cannot = || format!("cannot write {}; choose another place with --out", path.display());
        let made = std::fs::create_dir_all(folder(options));
        made.and_then(|()| std::fs::write(path, text)).with_context(cannot)
    };
    write(&path, &text)?;
    smallest_scene(failure, &path, out)?;
    if let Some(picture) = picture(failure) {
        let path = path.with_extension("svg");
        write(&path, &picture)?;
        let place = path.display();
        writeln!(out, "  drawn, missed pairs red and dashed, spurious ones orange: {place}")?;
    }
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    for line in lines.iter().take(LINES) {
        writeln!(out, "    {line}")?;
    }
    if lines.len() > LINES {
        writeln!(out, "    ... {}", plural(lines.len() - LINES, "more line"))?;
    }
    let place = path.to_string_lossy();
    let place = shlex::try_quote(&place).unwrap_or_default();
    writeln!(out, "  again:  contactbench check --scene {place} {who}")?;
    let detect = format!("contactbench detect {place} --arithmetic {arithmetic} --detector");
    let control = spec::parse(detector).is_ok_and(|spec| spec.entry.is_control());
    if options.runner.is_none() && !control {
        writeln!(out, "  see it: {detect} {detector}")?;
    }
    writeln!(out, "  truth:  {detect} direct")?;
    Ok(())
}

/// Prints the worst wrong pair, with its particles.
fn worst_pair(failure: &Failure, out: &mut dyn Write) -> anyhow::Result<()> {
    let given = &failure.given;
    if let Some((pair, depth)) = worst(failure) {
        let size = mean_radii(depth.abs());
        let what = if depth >= 0.0 { "missed, overlap" } else { "spurious, gap" };
        writeln!(out, "  the worst there, of {} particles:", given.scene.len())?;
        writeln!(out, "    {pair}: {what} {size}")?;
        for k in [pair.i, pair.j] {
            writeln!(out, "    {}", particle_line(&given.scene, k))?;
        }
    }
    Ok(())
}

fn smallest_scene(failure: &Failure, path: &Path, out: &mut dyn Write) -> anyhow::Result<()> {
    let Failure { smallest, wrong, .. } = failure;
    let (n, place) = (smallest.scene.len(), path.display());
    let what = match wrong {
        Some(Wrong::Hangs(_)) => format!("the scene, not made smaller: {n} particles"),
        Some(wrong) => format!("smallest failing scene: {n} particles, {wrong}"),
        None => format!("wrong only after earlier scenes; the scene: {n} particles"),
    };
    writeln!(out, "  {what}: {place}")?;
    Ok(())
}
