use serde_json::{Value, json};

use contactbench_record::stats::interval::{Interval, ratio};
use contactbench_terms::number::{number, with_interval};

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

pub fn sentence(verdict: &Verdict, race: &Race, n: usize) -> String {
    let subjects = &race.subjects;
    let name = |k: usize| subjects[k].entry.name;
    let choice = &subjects[verdict.choice];
    let mut parts = Vec::new();
    // Ratios come before times, because they vary less between runs.
    if let Some((k, ratio)) = &verdict.next {
        let next = if verdict.tied.is_empty() {
            "the runner-up"
        } else {
            "the next that is decidedly slower"
        };
        let takes = with_interval(ratio);
        parts.push(format!("{next}, {}, takes {takes} times as long", name(*k)));
    }
    if let Some(time) = per_particle(choice, n) {
        parts.push(format!("{} ns per particle in this run", number(time.median)));
    }
    if let Some(bytes) = bytes_per_particle(choice, n) {
        parts.push(format!("{} bytes per particle", number(bytes)));
    }
    parts.push(error(choice));
    let mut text = format!("{}: {}", name(verdict.choice), parts.join("; "));
    for (k, ratio) in &verdict.tied {
        let takes = ratio.map_or(String::new(), |ratio| {
            format!(": it takes {} times as long", with_interval(&ratio))
        });
        let memory = match bytes_per_particle(&subjects[*k], n) {
            Some(bytes) => format!(", with {} bytes per particle", number(bytes)),
            None => String::new(),
        };
        text += &format!("\n  {} may be as fast{takes}{memory}", name(*k));
    }
    if !verdict.tied.is_empty() {
        let why =
            if verdict.is_fastest { "its median is the shortest" } else { "it needs less memory" };
        text += &format!(
            "\n  {} is recommended because {why}; more --seconds may decide",
            name(verdict.choice)
        );
    }
    if verdict.next.is_none() && verdict.tied.is_empty() {
        text += "\n  no other detector has a time, so nothing was compared; give more --seconds";
    }
    text += &match (&race.twin, verdict.floor) {
        _ if race.blocks < FEWEST => format!(
            "\n  {} of the {FEWEST} blocks that a decision needs; give more --seconds",
            race.blocks
        ),
        (Some(twin), Some(floor)) => format!(
            "\n  a second copy of it took {} times as long:\n  factors below {floor:.2} decide \
             nothing",
            with_interval(twin)
        ),
        _ => "\n  the second copy of it has no times, so nothing is decided".into(),
    };
    text
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
    let tied = |verdict: &Verdict| verdict.tied.iter().map(|(k, _)| name(*k)).collect::<Vec<_>>();
    json!({
        "use": verdict.map(|verdict| name(verdict.choice)),
        "because": verdict.map(|verdict| sentence(verdict, race, n)),
        "next": verdict.and_then(|verdict| verdict.next.as_ref()).map(next),
        "cannot_tell_apart": verdict.map(tied),
        "blocks": race.blocks,
        "twin_ratio": race.twin.map(numbers),
        "detectors": detectors.collect::<Vec<_>>(),
    })
}
