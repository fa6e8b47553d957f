//! All steps as one self-contained HTML page, controlled by keys, a presenter, buttons or a bar. The
//! page holds the scene and what each step changes; its script draws them.

use serde_json::{Value, json};

use crate::trace::recorder::Step;
use crate::trace::state::{State, arrays};
use crate::trace::{Algorithm, Trace};
use contactbench_terms::text;

pub fn html(trace: &Trace, name: &str) -> String {
    let (cells, ops, mut before) = (&trace.cells, trace.ops(), State::default());
    let step = |step: &Step| {
        let counts: Vec<u64> = ops.iter().map(|(op, _)| step.tally.get(*op)).collect();
        let changes = step.state.changes(&before);
        before.clone_from(&step.state);
        json!([step.words, step.part, step.marks, changes, counts, step.state.contacts.len()])
    };
    let steps: Vec<Value> = trace.steps.iter().map(step).collect();
    let data = json!({
        "arrays": arrays(trace.algorithm),
        "cells": { "origin": cells.origin(), "edge": cells.edge(), "count": cells.count },
        "contacts": trace.contacts,
        "discs": trace.discs,
        "names": trace.names,
        "ops": ops.iter().map(|(_, words)| words).collect::<Vec<_>>(),
        "parts": trace.parts,
        "row_below": trace.algorithm == Algorithm::Nbs,
        "steps": steps,
    });
    let values = [
        // The data cannot end its script element.
        ("data", data.to_string().replace("</", "<\\/")),
        ("title", text::html(&trace.title(name))),
    ];
    text::fill(include_str!("page.html"), &values)
}
