//! All steps as one self-contained HTML page, controlled by keys, a presenter, buttons or a bar.
//! The pictures are drawn here; the page's script only exchanges them. Each part that several steps
//! share is stored once.

use std::collections::HashMap;

use serde_json::{Value, json};

use crate::trace::Trace;
use crate::trace::arrays::Arrays;
use crate::trace::picture::Scene;
use contactbench_terms::text;

pub fn html(trace: &Trace, name: &str) -> String {
    let (scene, arrays, ops) = (Scene::new(trace), Arrays::new(trace), trace.ops());
    let (mut texts, mut numbers) = (Vec::new(), HashMap::new());
    let mut number = |text: String| {
        *numbers.entry(text).or_insert_with_key(|text| {
            texts.push(text.clone());
            texts.len() - 1
        })
    };
    let step = |step| {
        let layers = scene.layers(step).map(&mut number);
        let blocks: Vec<usize> = arrays.draw(step).into_iter().map(&mut number).collect();
        let counts: Vec<u64> = ops.iter().map(|(op, _)| step.tally.get(*op)).collect();
        json!([step.words, step.part, layers, blocks, counts, step.state.contacts.len()])
    };
    let steps: Vec<Value> = trace.steps.iter().map(step).collect();
    let data = json!({
        "steps": steps,
        "parts": trace.parts,
        "ops": ops.iter().map(|(_, words)| words).collect::<Vec<_>>(),
        "f": texts,
        "contacts": trace.contacts.iter().map(|&pair| scene.line(pair)).collect::<Vec<_>>(),
    });
    let mut values = vec![
        ("blocks", "<g></g>".repeat(arrays.len())),
        // The data cannot end its script element.
        ("data", data.to_string().replace("</", "<\\/")),
        ("title", text::html(&trace.title(name))),
    ];
    values.extend(scene.values(&arrays));
    text::fill(include_str!("page.html"), &values)
}
