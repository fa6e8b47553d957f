use serde_json::{Value, json};

use contactbench_record::stats::interval::{Interval, ratio};
use contactbench_terms::number::{number, percent, with_interval};

use crate::recommend::race::FEWEST;
use crate::recommend::subject::{Race, RacedSubject, fastest};
use crate::recommend::verdict::{Verdict, bytes_per_particle, per_particle};

pub fn error(subject: &RacedSubject) -> String {
    match subject.row.errors {
        None => "not compared".into(),
        Some(errors) if errors.wrong() == 0 => "exact".into(),
        Some(errors) => errors.to_string(),
    }
}

pub fn sentences(verdict: &Verdict, race: &Race, n: usize) -> Vec<String> {
    let subjects = &race.subjects;
    let name = |k: usize| subjects[k].entry.name;
    let choice = &subjects[verdict.choice];
    let time = per_particle(choice, n)
        .map(|time| format!("{} ns per particle in this run", number(time.median)));
    let bytes =
        bytes_per_particle(choice, n).map(|bytes| format!("{} bytes per particle", number(bytes)));
    let parts: Vec<String> = time.into_iter().chain(bytes).chain([error(choice)]).collect();
    let mut lines = vec![format!("{}: {}", name(verdict.choice), parts.join("; "))];
    let tied: Vec<&str> = verdict.tied.iter().map(|&k| name(k)).collect();
    if !tied.is_empty() {
        let why = if verdict.is_fastest { "has the shortest median" } else { "needs less memory" };
        lines.push(format!(
            "undecided against {}; it {why}; more --seconds may decide",
            tied.join(", ")
        ));
    } else if verdict.next.is_none() {
        lines.push("no other detector has a time, so nothing was compared".into());
    }
    lines.push(match (&race.twin, verdict.floor) {
        _ if race.blocks < FEWEST => format!(
            "{} of the {FEWEST} blocks that a decision needs; give more --seconds",
            race.blocks
        ),
        (Some(twin), Some(floor)) => format!(
            "its twin took {} times as long, so factors below {floor:.2} decide nothing",
            with_interval(twin)
        ),
        _ => "its twin has no times, so nothing is decided".into(),
    });
    let others = |share| {
        format!(
            "other processes and the host took {} of a core, which may have changed the times",
            percent(share)
        )
    };
    lines.extend(race.disturbed.map(others));
    lines
}

fn numbers(interval: Interval) -> Value {
    let Interval { median, low, high, coverage, count } = interval;
    json!({ "median": median, "low": low, "high": high, "coverage": coverage, "blocks": count })
}

pub fn as_json(verdict: Option<&Verdict>, race: &Race, n: usize) -> Value {
    let subjects = &race.subjects;
    let name = |k: usize| subjects[k].entry.name;
    let base = fastest(subjects).map(|k| subjects[k].times.clone()).unwrap_or_default();
    let detectors = subjects.iter().map(|subject| {
        json!({
            "detector": subject.entry.name,
            "threads": subject.threads,
            "outcome": subject.row.outcome.name(),
            "reason": subject.row.reason,
            "probe_ns": subject.probe_ns,
            "ns_per_particle": per_particle(subject, n).map(numbers),
            "ratio_to_fastest": ratio(&subject.times, &base).map(numbers),
            "peak_bytes": subject.row.peak_bytes,
            "bytes_per_particle": bytes_per_particle(subject, n),
            "formula_bytes": subject.row.formula_bytes,
            "errors": subject.row.errors,
        })
    });
    let next =
        |(k, ratio): &(usize, Interval)| json!({ "detector": name(*k), "ratio": numbers(*ratio) });
    let tied = |verdict: &Verdict| verdict.tied.iter().map(|&k| name(k)).collect::<Vec<_>>();
    json!({
        "use": verdict.map(|verdict| name(verdict.choice)),
        "because": verdict.map(|verdict| sentences(verdict, race, n).join(". ")),
        "next": verdict.and_then(|verdict| verdict.next.as_ref()).map(next),
        "cannot_tell_apart": verdict.map(tied),
        "blocks": race.blocks,
        "twin_ratio": race.twin.map(numbers),
        "detectors": detectors.collect::<Vec<_>>(),
    })
}
