//! All steps as one HTML page, which needs nothing else: it steps with the keys of a keyboard or a
//! presenter, with buttons, and by touch.
//!
//! Pictures are drawn here; the page only exchanges them. What is the same in many steps is in it
//! once.

use std::collections::HashMap;

use serde_json::{Value, json};

use crate::player::{self, painted};
use crate::px;
use crate::trace::Trace;
use crate::trace::arrays::{Arrays, WIDTH};
use crate::trace::picture::{Scene, style};
use contactbench_terms::text;

/// The page of a trace of a scene with this name.
pub fn html(trace: &Trace, name: &str) -> String {
    let (scene, arrays, ops) = (Scene::new(trace), Arrays::new(trace), trace.ops());
    let mut fragments = Fragments::default();
    let steps: Vec<Value> = trace
        .steps
        .iter()
        .map(|step| {
            let layers = scene.layers(step).map(|layer| fragments.number(layer));
            let blocks = arrays.draw(step).into_iter().map(|block| fragments.number(block));
            let blocks: Vec<usize> = blocks.collect();
            let counts: Vec<u64> = ops.iter().map(|(op, _)| step.tally.get(*op)).collect();
            json!([step.words, step.part, layers, blocks, counts, step.state.contacts.len()])
        })
        .collect();
    let contacts: Vec<String> = trace.contacts.iter().map(|&pair| scene.line(pair)).collect();
    let names: Vec<&str> = ops.iter().map(|(_, words)| words.as_str()).collect();
    let data = json!({
        "steps": steps,
        "parts": trace.parts,
        "ops": names,
        "f": fragments.texts,
        "contacts": contacts,
    });
    let [sw, sh] = scene.size.map(px);
    let colours = [colours(false, ":root", ""), colours(true, ":root.dark", ":root.dark ")];
    include_str!("page.html")
        .replace("@@STYLE@@", &(colours.concat() + player::STYLE))
        .replace("@@PLAYER@@", player::SCRIPT)
        .replace("@@SCENE@@", &format!("0 0 {sw} {sh}"))
        .replace("@@ARRAYS@@", &format!("0 0 {} {}", px(WIDTH), px(arrays.height)))
        .replace("@@GROUND@@", &scene.ground())
        .replace("@@GRID@@", &scene.grid())
        .replace("@@DISCS@@", &scene.discs())
        .replace("@@NUMBERS@@", &scene.numbers())
        .replace("@@BLOCKS@@", &"<g></g>".repeat(arrays.len()))
        .replace("@@LAST@@", &(trace.steps.len() - 1).to_string())
        // In a script nothing but its end tag must be avoided.
        .replace("@@DATA@@", &data.to_string().replace("</", "<\\/"))
        // Last, so that a name cannot be taken for a place.
        .replace("@@TITLE@@", &text::html(&trace.title(name)))
}

fn colours(dark: bool, root: &str, scope: &str) -> String {
    let variables = painted("{--ground:@ground;--ink:@ink;--accent:@accent}\n", dark);
    format!("{root}{variables}{}", style(dark, scope))
}

/// Texts, each once.
#[derive(Default)]
struct Fragments {
    texts: Vec<String>,
    numbers: HashMap<String, usize>,
}

impl Fragments {
    fn number(&mut self, text: String) -> usize {
        let next = self.texts.len();
        let number = *self.numbers.entry(text.clone()).or_insert(next);
        if number == next {
            self.texts.push(text);
        }
        number
    }
}
