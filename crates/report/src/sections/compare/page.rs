//! The page that `contactbench compare` prints, and its JSON.

use std::fmt::Write;

use serde_json::{Map, Value, json};

use crate::document::indented;
use crate::sections::compare as words;
use crate::sections::trust::conditions as doubtful;
use contactbench_record::findings::compare::comparison::{Comparison, Terms};
use contactbench_record::findings::compare::{Compared, Options as How, Timing, pooled, records};
use contactbench_record::findings::trust::conditions::Conditions;
use contactbench_record::record::merge::Part;
use contactbench_record::stats::interval::Interval;
use contactbench_terms::number::plural;

/// A comparison, and how it is printed.
pub struct Page<'a> {
    pub comparison: &'a Comparison,
    pub terms: &'a Terms,
    pub gate_time: bool,
    pub strict: bool,
    /// Whether cells that do not differ are printed, too.
    pub all: bool,
    pub failed: usize,
}

impl Page<'_> {
    /// Returns the page, at most `width` columns wide.
    pub fn text(&self, width: usize) -> Result<String, std::fmt::Error> {
        let Comparison { parts, how, cells, summary } = self.comparison;
        let mut out = String::new();
        let measured = |part: &Part| {
            format!("{}, measured on {}", part.folder.display(), processors(part).join(", "))
        };
        let mut say = |head: &str, text: &str| write!(out, "{}", indented(head, text, width));
        if let Some(two) = &how.machines {
            say("NOTE: ", &words::machines(two))?;
        }
        if let [a, b] = &parts[..]
            && !self.terms.same_machine
            && records::caches_of_one([a, b])
        {
            say("NOTE: ", "only one record states cache sizes; taken to be one machine")?;
        }
        let names: &[&str] =
            if parts.len() == 1 { &["A: the base, B: this build, in"] } else { &["A:", "B:"] };
        for (name, part) in names.iter().zip(parts) {
            say(&format!("{name} "), &measured(part))?;
            if let Some(said) = doubtful::sentence(&conditions(part)) {
                say("   ", &said)?;
            }
        }
        say("times: ", &words::pairing(how))?;
        for (experiment, noise) in how.side_by_side.iter().flatten() {
            say("floor: ", &words::floor(experiment, noise))?;
        }
        writeln!(out)?;
        for cell in cells.iter().filter(|cell| !cell.changes.is_empty()) {
            writeln!(out, "CHANGED  {}", cell.place)?;
            for change in &cell.changes {
                writeln!(out, "         {}", words::change(change))?;
            }
        }
        for cell in cells {
            if let Some(absent) = cell.absent.as_ref().filter(|_| self.all || self.strict) {
                writeln!(out, "absent   {}: {}", cell.place, absent)?;
            }
            if !cell.lacks.is_empty() {
                writeln!(out, "lacking  {}: {}", cell.place, cell.lacks.join("; "))?;
            }
        }
        let times = words::times(cells, how, self.all);
        if !times.rows.is_empty() {
            writeln!(out, "{}", times.plain(width))?;
        }
        let mut say = |head: &str, text: &str| write!(out, "{}", indented(head, text, width));
        for one in &pooled(cells) {
            say("pooled: ", &words::pooled(one))?;
        }
        if how.side_by_side.is_some() {
            say("NOTE: ", &words::placement())?;
        }
        if let Some((name, factor)) = &summary.moved {
            say("NOTE: ", &words::moved(name, *factor))?;
        }
        for line in words::summary(summary, self.terms.band, self.gate_time) {
            writeln!(out, "{line}")?;
        }
        match self.failed {
            0 => writeln!(out, "compare: passed")?,
            failed => writeln!(out, "compare: FAILED in {}", plural(failed, "cell"))?,
        }
        Ok(out)
    }

    pub fn json(&self) -> Value {
        let Comparison { parts, how, cells, summary } = self.comparison;
        let judged = summary.judged.iter();
        let judged: Map<String, Value> = judged
            .map(|(verdict, count)| (verdict.name().replace(' ', "-"), (*count).into()))
            .collect();
        json!({
            "a": parts.first().map(side),
            "b": parts.last().map(side),
            "band_percent": self.terms.band,
            "against": how.against.as_ref().map(|control| &control.detector),
            "drift": how.against.as_ref().and_then(|control| control.drift),
            "floor": how.side_by_side.as_ref().map(|floors| {
                let floors = floors.iter().map(|(name, noise)| (name.clone(), noise.floor.into()));
                floors.collect::<Map<String, Value>>()
            }),
            "times": words::pairing(how),
            "gate_time": self.gate_time,
            "strict": self.strict,
            "summary": {
                "cells": summary.cells,
                "changed": summary.changed,
                "absent": summary.absent,
                "times": judged,
                "slower_by_chance": summary.by_chance,
                "failed": self.failed,
            },
            "moved_twin": summary.moved.as_ref().map(|(name, factor)| {
                json!({"twin": name, "factor": factor})
            }),
            "pooled": pooled(cells).iter().map(pooled_json).collect::<Vec<_>>(),
            "passed": self.failed == 0,
            "cells": cells.iter().map(|cell| as_json(cell, how)).collect::<Vec<_>>(),
        })
    }
}

fn processors(part: &Part) -> Vec<String> {
    records::machines(part).iter().map(|name| words::machine(&part.machine(name))).collect()
}

fn pooled_json((name, ratio): &(String, Interval)) -> Value {
    let Interval { median, low, high, coverage, count } = ratio;
    json!({"detector": name, "ratio": median, "low": low, "high": high, "coverage": coverage,
           "cells": count})
}

fn side(part: &Part) -> Value {
    json!({
        "folder": part.folder.display().to_string(),
        "machines": records::machines(part),
        "processors": processors(part),
        "revision": records::field(part, "revision"),
        "profile": records::field(part, "profile"),
        "doubts": conditions(part).doubts,
    })
}

fn conditions(part: &Part) -> Conditions {
    Conditions::new(part.provenances(), &part.ledger, &part.rows)
}

fn as_json(cell: &Compared, how: &How) -> Value {
    let time = cell.timing.as_ref().map(|timing| {
        let Timing { a_ns, b_ns, multiples, ratio, judgement, least, .. } = timing;
        json!({
            "a_ns": a_ns,
            "b_ns": b_ns,
            "a_of_control": multiples.map(|[a, _]| a),
            "b_of_control": multiples.map(|[_, b]| b),
            "ratio": ratio.median,
            "low": ratio.low,
            "high": ratio.high,
            "coverage": ratio.coverage,
            "blocks": ratio.count,
            "verdict": judgement,
            "excludes_1": ratio.excludes(1.0),
            "least": least,
            "note": words::note(timing, how),
        })
    });
    let names = cell.id.names().filter_map(|name| cell.id.axis(&name).map(|v| (name, v)));
    let key: Map<String, Value> = names.map(|(name, value)| (name, Value::from(value))).collect();
    json!({
        "cell": cell.place,
        "key": key,
        "changes": cell.changes,
        "absent": cell.absent,
        "lacks": cell.lacks,
        "time": time,
    })
}
