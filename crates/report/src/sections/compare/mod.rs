//! The page that `contactbench compare` prints, and its JSON.

use serde_json::{Value, json};

use crate::document::indented;
use crate::sections::trust::conditions as doubtful;
use crate::table::Table;
use contactbench_record::findings::compare::comparison::{Comparison, Terms};
use contactbench_record::findings::compare::{
    Against, Change, Compared, Judgement, Options, PLACEMENT, Summary, Timing, pooled, records,
};
use contactbench_record::findings::trust::conditions::Conditions;
use contactbench_record::findings::trust::noise::{Noise, Twin};
use contactbench_record::record::merge::Part;
use contactbench_record::record::origin::machines::Machine;
use contactbench_record::stats::interval::{COVERAGE, Interval};
use contactbench_terms::number::{number, percent, plural, with_ends};

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
        let times = times(cells, how, self.all);
        let mut below: Vec<Line> =
            pooled(cells).iter().map(|one| ("pooled: ", typical(one))).collect();
        below.extend(how.side_by_side.iter().map(|_| {
            let words = "two builds of equal sources differ by up to";
            let most = percent(PLACEMENT - 1.0);
            let rest = "smaller differences are called neither slower nor faster";
            ("NOTE: ", format!("{words} {most} (docs/COMPARE.md): {rest}"))
        }));
        below.extend(summary.moved.iter().map(|moved| ("NOTE: ", has_moved(moved))));
        let said = |lines: Vec<Line>| -> String {
            lines.iter().map(|(head, text)| indented(head, text, width)).collect()
        };
        let mut out = said(self.head()) + "\n" + &self.changes();
        if !times.rows.is_empty() {
            out += &(times.plain(width) + "\n");
        }
        out += &(said(below) + &self.totals());
        out + &match self.failed {
            0 => "compare: passed\n".into(),
            failed => format!("compare: FAILED in {}\n", plural(failed, "cell")),
        }
    }

    /// Returns what is compared, and how.
    fn head(&self) -> Vec<Line> {
        let Comparison { parts, how, .. } = self.comparison;
        let mut out: Vec<Line> = how.machines.iter().map(|two| ("NOTE: ", machines(two))).collect();
        let names: &[&str] = match parts.len() {
            1 => &["A: the base, B: this build, in "],
            _ => &["A: ", "B: "],
        };
        for (name, part) in names.iter().zip(parts) {
            let (folder, machines) = (part.folder.display(), processors(part).join(", "));
            out.push((name, format!("{folder}, measured on {machines}")));
            out.extend(doubtful::sentence(&conditions(part)).map(|said| ("   ", said)));
        }
        out.push(("times: ", pairing(how)));
        let floors = how.side_by_side.iter().flatten();
        out.extend(floors.map(|(experiment, noise)| ("floor: ", floor(experiment, noise))));
        out
    }

    /// Returns the cells with values that differ, or that only one record has.
    fn changes(&self) -> String {
        let cells = &self.comparison.cells;
        let mut out = String::new();
        for cell in cells.iter().filter(|cell| !cell.changes.is_empty()) {
            out += &format!("CHANGED  {}\n", cell.place);
            out.extend(cell.changes.iter().map(|it| format!("         {}\n", change(it))));
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

    /// Returns a line about values that must be the same, and one about times and their gate.
    fn totals(&self) -> String {
        let found = &self.comparison.summary;
        let same = match found.changed {
            0 => "the same everywhere".into(),
            changed => format!("CHANGED in {}", plural(changed, "cell")),
        };
        let compared = plural(found.cells - found.absent, "cell");
        let mut counts = format!("{compared} compared, {} in one only", found.absent);
        if found.lacking > 0 {
            counts += &format!(", {} measured in part in one: see --all", found.lacking);
        }
        let count = |(verdict, count): (&Judgement, &usize)| match (verdict, found.small) {
            (Judgement::WithinBand, small @ 1..) => {
                format!("{count} {} ({small} of them not 1)", verdict.name())
            }
            _ => format!("{count} {}", verdict.name()),
        };
        let judged: Vec<String> = found.judged.iter().map(count).collect();
        let mut judged = if judged.is_empty() { "none".into() } else { judged.join(", ") };
        if let Some((typical, most)) = found.least {
            judged += &format!(
                "; only slowdowns above {} would show in a typical cell, above {} in the worst",
                seen(typical),
                seen(most),
            );
        }
        let (gate, band) = (if self.gate_time { "gated" } else { "not gated" }, self.terms.band);
        format!(
            "pairs, counts, bytes, outcomes: {same} ({counts})\ntimes ({gate}, band {band} %): \
             {judged}\n"
        )
    }

    pub fn json(&self) -> Value {
        let Comparison { parts, how, cells, summary } = self.comparison;
        let side = |part: &Part| {
            json!({
                "folder": part.folder.display().to_string(),
                "processors": processors(part),
                "revision": records::field(part, "revision"),
                "profile": records::field(part, "profile"),
                "doubts": conditions(part).doubts,
            })
        };
        json!({
            "folders": parts.iter().map(side).collect::<Vec<_>>(),
            "against": how.against,
            "times": pairing(how),
            "summary": summary,
            "pooled": pooled(cells),
            "failed": self.failed,
            "passed": self.failed == 0,
            "cells": cells,
        })
    }
}

fn processors(part: &Part) -> Vec<String> {
    records::machines(part).iter().map(|name| machine(&part.machine(name))).collect()
}

fn conditions(part: &Part) -> Conditions {
    Conditions::new(part.provenances(), &part.ledger, &part.rows)
}

/// Formats a change such as `digest 0x01 -> 0x02`.
pub fn change(Change { what, a, b }: &Change) -> String {
    format!("{what} {a} -> {b}")
}

fn has_moved((name, factor): &(String, f64)) -> String {
    format!(
        "{name} is equal code and moved by {factor:.2}: nothing is decided; compare builds side by \
         side with contactbench run --against PROGRAM"
    )
}

/// Describes a machine by name and processor, since virtual machines may share a name.
fn machine(Machine { name, hardware }: &Machine) -> String {
    let name = if name.is_empty() { "an unnamed machine" } else { name };
    hardware.cpu.as_ref().map_or(name.into(), |cpu| format!("{name} ({cpu})"))
}

fn machines(machines: &[Machine; 2]) -> String {
    let [a, b] = machines.each_ref().map(machine);
    let same = if a == b { ", which differ in cores, caches, features or memory" } else { "" };
    format!("two machines: {a} and {b}{same}")
}

/// Describes how times are compared, or why they are not judged.
fn pairing(how: &Options) -> String {
    let against = how.against.as_ref();
    let why = match (&how.builds, &how.machines, against) {
        _ if how.side_by_side.is_some() => {
            return "side by side: both took turns in each block, in fresh processes".into();
        }
        (Some([a, b]), ..) => format!("A is a {a} build, B a {b} build"),
        (_, Some(found), _) if against.is_none() || !how.across => {
            format!("{}; --against DETECTOR --across-machines judges multiples", machines(found))
        }
        (.., Some(Against { detector, drift: Some(drift) })) => {
            return format!(
                "multiples of the time of {detector} in the same block. In nine cells of ten, its \
                 own times differ by less than {}: smaller changes are not reported",
                seen(*drift)
            );
        }
        (.., Some(Against { detector, .. })) => {
            format!("{detector} has no times on a scene of both")
        }
        (.., None) => "the folders were measured at different times; --against DETECTOR compares \
                       multiples of its time; contactbench run --against PROGRAM compares builds \
                       side by side"
            .into(),
    };
    format!("shown, not judged: {why}")
}

/// Describes how far the times of equal code differed while two builds took turns.
fn floor(experiment: &str, noise: &Noise) -> String {
    let sum = |count: fn(&Twin) -> usize| -> usize { noise.twins.iter().map(count).sum() };
    format!(
        "this build against itself in the same way: {} of {} exclude 1; nine in ten are within \
         {} ({experiment})",
        sum(|twin| twin.outside),
        plural(sum(|twin| twin.cells), "interval"),
        percent(noise.floor - 1.0)
    )
}

/// Formats `1.012 (1.003 to 1.021)`. Three decimals show the small differences of interest.
pub fn ratio(timing: &Timing) -> String {
    with_ends(&timing.ratio, |ratio| format!("{ratio:.3}"))
}

/// Makes the table of cells that became slower or faster, or of all, by verdict and falling ratio.
fn times(cells: &[Compared], how: &Options, all: bool) -> Table {
    let shown =
        |timing: &Timing| all || matches!(timing.judgement, Judgement::Slower | Judgement::Faster);
    let mut timed: Vec<(&Timing, &str)> = cells
        .iter()
        .filter_map(|cell| Some((cell.timing.as_ref()?, cell.place.as_str())))
        .filter(|(timing, _)| shown(timing))
        .collect();
    timed.sort_by(|(a, _), (b, _)| {
        a.judgement.cmp(&b.judgement).then(b.ratio.median.total_cmp(&a.ratio.median))
    });
    let control = how.against.as_ref().filter(|_| how.side_by_side.is_none());
    let unit = control.map_or("ns".into(), |control| format!("/ {}", control.detector));
    let shown = |ns: f64, multiple: Option<f64>| match (control, multiple) {
        (None, _) => number(ns),
        (Some(_), Some(multiple)) => format!("{multiple:.3}"),
        (Some(_), None) => format!("{} ns", number(ns)),
    };
    // A certain difference within the band is marked.
    let verdict = |timing: &Timing| {
        timing.judgement.name().to_string() + if timing.is_small() { ", not 1" } else { "" }
    };
    let cell = |timing: &Timing, place: &str| match &*timing.note {
        "" => place.to_string(),
        note => format!("{place}: {note}"),
    };
    Table::of("", timed)
        .left("", |(timing, _)| verdict(timing))
        .left("B / A within turns", |(timing, _)| ratio(timing))
        .right(format!("A, median {unit}"), |(it, _)| {
            shown(it.a_ns, it.multiples.map(|both| both[0]))
        })
        .right(format!("B, median {unit}"), |(it, _)| {
            shown(it.b_ns, it.multiples.map(|both| both[1]))
        })
        .left("cell", |(timing, place)| cell(timing, place))
        .into()
}

/// Formats the smallest slowdown that a comparison can detect: `12%`, `47 times`.
fn seen(least: f64) -> String {
    if least < 2.0 { percent(least - 1.0) } else { format!("{least:.0} times") }
}

/// Explains why times cannot be gated; `None` if they can.
pub fn ungated(found: &Summary, how: &Options) -> Option<String> {
    match (&how.machines, &found.moved, found.least) {
        (Some(two), ..) => Some(format!("no time could be judged ({})", machines(two))),
        (_, Some(moved), _) => Some(has_moved(moved)),
        (.., None) => Some(format!(
            "no time could be judged ({}; an interval needs six blocks); leave --gate-time out",
            pairing(how)
        )),
        (.., Some((typical, _))) if !found.sees() => Some(format!(
            "this comparison can only find slowdowns above {}: give it more blocks, or use \
             contactbench run --against PROGRAM",
            seen(typical)
        )),
        _ => (!found.decides()).then(|| "every cell is undecided; give it more blocks".into()),
    }
}

fn typical((name, ratio): &(String, Interval)) -> String {
    let Interval { median, low, high, coverage, count } = ratio;
    let interval = match *coverage < COVERAGE {
        true => "too few for an interval".into(),
        false => format!("95% interval {low:.3} to {high:.3}"),
    };
    format!("{name}: B / A {median:.3}, the median of {}, {interval}", plural(*count, "cell"))
}
