//! From a race to a recommendation: the fastest, or, of those that cannot be told apart from it,
//! the leanest.

use serde_json::{Value, json};

use crate::number::number;
use crate::recommend::race::{BEHIND, Race, Standing, fastest};
use crate::stats::interval::{Interval, interval, ratio};

/// The recommendation.
pub struct Verdict {
    /// The one to use, by its place in the race.
    pub choice: usize,
    /// The fastest of those that take longer for sure, and the ratio of its time to that of the
    /// choice.
    pub next: Option<(usize, Interval)>,
    /// Those that cannot be told apart from the fastest, without the choice; and the ratios of
    /// their times to that of the choice.
    pub tied: Vec<(usize, Option<Interval>)>,
}

impl Verdict {
    /// Reads a race; none if nobody has a time.
    pub fn new(race: &Race) -> Option<Verdict> {
        let standings = &race.standings;
        let best = fastest(standings)?;
        let against = |k: usize, base: usize| ratio(&standings[k].times, &standings[base].times);
        let others: Vec<usize> = (0..standings.len())
            .filter(|&k| {
                k != best && standings[k].outcome.is_good() && !standings[k].times.is_empty()
            })
            .collect();
        // Few blocks tell only what is far apart, and a single one nothing.
        let sure = |ratio: Interval| {
            ratio.coverage >= 0.9 && ratio.low > 1.0 || ratio.count > 1 && ratio.low > BEHIND
        };
        let slower = |k: &usize| against(*k, best).is_some_and(sure);
        let (behind, mut near): (Vec<usize>, Vec<usize>) = others.into_iter().partition(slower);
        near.push(best);
        let choice = near
            .iter()
            .copied()
            .min_by_key(|&k| (standings[k].peak_bytes.unwrap_or(u64::MAX), k != best))?;
        let next = behind
            .into_iter()
            .filter_map(|k| Some((k, against(k, choice)?)))
            .filter(|(_, ratio)| sure(*ratio));
        let next = next.min_by(|a, b| a.1.median.total_cmp(&b.1.median));
        let tied =
            near.into_iter().filter(|&k| k != choice).map(|k| (k, against(k, choice))).collect();
        Some(Verdict { choice, next, tied })
    }
}

/// Nanoseconds per element.
pub fn per_element(standing: &Standing, n: usize) -> Option<Interval> {
    let times: Vec<f64> =
        standing.times.values().map(|&time| time as f64 / n.max(1) as f64).collect();
    interval(&times)
}

/// Bytes per element.
pub fn bytes_per_element(standing: &Standing, n: usize) -> Option<f64> {
    standing.peak_bytes.map(|bytes| bytes as f64 / n.max(1) as f64)
}

/// Its answer against exact decisions on the scene as given, in words.
pub fn error(standing: &Standing) -> String {
    match standing.errors {
        None => "not compared".into(),
        Some(errors) if errors.wrong() == 0 => "exact".into(),
        Some(errors) => errors.to_string(),
    }
}

fn range(interval: &Interval) -> String {
    format!("{} to {}", number(interval.low), number(interval.high))
}

/// The recommendation in a sentence.
pub fn sentence(verdict: &Verdict, race: &Race, n: usize) -> String {
    let standings = &race.standings;
    let name = |k: usize| standings[k].entry.name;
    let choice = &standings[verdict.choice];
    let mut parts = Vec::new();
    if let Some(time) = per_element(choice, n) {
        parts.push(format!("{} ns per element ({})", number(time.median), range(&time)));
    }
    if let Some((k, ratio)) = &verdict.next {
        let next =
            if verdict.tied.is_empty() { "the next" } else { "the next that can be told apart" };
        parts.push(format!(
            "{:.2} times ({:.2} to {:.2}) faster than {next}, {}",
            ratio.median,
            ratio.low,
            ratio.high,
            name(*k)
        ));
    }
    if let Some(bytes) = bytes_per_element(choice, n) {
        parts.push(format!("{} bytes per element", number(bytes)));
    }
    parts.push(error(choice));
    let mut text = format!("{}: {}", name(verdict.choice), parts.join("; "));
    for (k, ratio) in &verdict.tied {
        let takes = ratio.map_or(String::new(), |ratio| {
            format!(
                ", which takes {:.2} times ({:.2} to {:.2}) its time",
                ratio.median, ratio.low, ratio.high
            )
        });
        let memory = match bytes_per_element(&standings[*k], n) {
            Some(bytes) => format!(" and {} bytes per element", number(bytes)),
            None => String::new(),
        };
        text += &format!(
            "\n  in time it cannot be told apart from {}{takes}{memory}: the leaner is recommended",
            name(*k)
        );
    }
    text
}

fn numbers(interval: Interval) -> Value {
    let Interval { median, low, high, coverage, count } = interval;
    json!({ "median": median, "low": low, "high": high, "coverage": coverage, "blocks": count })
}

/// All of it for programs.
pub fn as_json(verdict: Option<&Verdict>, race: &Race, n: usize) -> Value {
    let standings = &race.standings;
    let name = |k: usize| standings[k].entry.name;
    let base = fastest(standings).map(|k| standings[k].times.clone()).unwrap_or_default();
    let detectors = standings.iter().map(|standing| {
        json!({
            "detector": standing.entry.name,
            "threads": standing.threads,
            "outcome": standing.outcome.name(),
            "reason": standing.reason,
            "probe_ns": standing.probe_ns,
            "ns_per_element": per_element(standing, n).map(numbers),
            "ratio_to_fastest": ratio(&standing.times, &base).map(numbers),
            "peak_bytes": standing.peak_bytes,
            "bytes_per_element": bytes_per_element(standing, n),
            "errors": standing.errors,
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
        "detectors": detectors.collect::<Vec<_>>(),
    })
}
