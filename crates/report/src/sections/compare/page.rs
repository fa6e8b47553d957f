//! The page that `contactbench compare` prints, and its JSON.

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

/// A head and the text after it.
type Line = (&'static str, String);

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
    pub fn text(&self, width: usize) -> String {
        let Comparison { how, cells, summary, .. } = self.comparison;
        let times = words::times(cells, how, self.all);
        let mut below: Vec<Line> =
            pooled(cells).iter().map(|one| ("pooled: ", words::pooled(one))).collect();
        below.extend(how.side_by_side.iter().map(|_| ("NOTE: ", words::placement())));
        let moved = summary.moved.iter();
        below.extend(moved.map(|(name, factor)| ("NOTE: ", words::moved(name, *factor))));
        let said = |lines: Vec<Line>| -> String {
            lines.iter().map(|(head, text)| indented(head, text, width)).collect()
        };
        let mut out = said(self.head()) + "\n" + &self.changes();
        if !times.rows.is_empty() {
            out += &(times.plain(width) + "\n");
        }
        out += &said(below);
        for line in words::summary(summary, self.terms.band, self.gate_time) {
            out += &(line + "\n");
        }
        out + &match self.failed {
            0 => "compare: passed\n".into(),
            failed => format!("compare: FAILED in {}\n", plural(failed, "cell")),
        }
    }

    /// Returns what is compared, and how.
    fn head(&self) -> Vec<Line> {
        let Comparison { parts, how, .. } = self.comparison;
        let mut out: Vec<Line> =
            how.machines.iter().map(|two| ("NOTE: ", words::machines(two))).collect();
        if let [a, b] = &parts[..]
            && !self.terms.same_machine
            && records::caches_of_one([a, b])
        {
            let note = "only one record states cache sizes; taken to be one machine";
            out.push(("NOTE: ", note.into()));
        }
        let names: &[&str] = match parts.len() {
            1 => &["A: the base, B: this build, in "],
            _ => &["A: ", "B: "],
        };
        for (name, part) in names.iter().zip(parts) {
            let (folder, machines) = (part.folder.display(), processors(part).join(", "));
            out.push((name, format!("{folder}, measured on {machines}")));
            out.extend(doubtful::sentence(&conditions(part)).map(|said| ("   ", said)));
        }
        out.push(("times: ", words::pairing(how)));
        for (experiment, noise) in how.side_by_side.iter().flatten() {
            out.push(("floor: ", words::floor(experiment, noise)));
        }
        out
    }

    /// Returns the cells with values that differ, or that only one record has.
    fn changes(&self) -> String {
        let cells = &self.comparison.cells;
        let mut out = String::new();
        for cell in cells.iter().filter(|cell| !cell.changes.is_empty()) {
            out += &format!("CHANGED  {}\n", cell.place);
            let line = |change| format!("         {}\n", words::change(change));
            out.extend(cell.changes.iter().map(line));
        }
        for cell in cells {
            if let Some(absent) = cell.absent.as_ref().filter(|_| self.all || self.strict) {
                out += &format!("absent   {}: {absent}\n", cell.place);
            }
            if !cell.lacks.is_empty() {
                out += &format!("lacking  {}: {}\n", cell.place, cell.lacks.join("; "));
            }
        }
        out
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
