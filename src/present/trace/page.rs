//! All steps as one HTML page, which needs nothing else: it steps with the keys of a keyboard or a
//! presenter, with buttons, and by touch.
//!
//! Pictures are drawn here; the page only exchanges them. What is the same in many steps is in it
//! once.

use std::collections::HashMap;

use serde_json::{Value, json};

use crate::present::player::palette::{DARK, LIGHT, Palette};
use crate::present::svg::px;
use crate::present::trace::Trace;
use crate::present::trace::arrays::{Arrays, WIDTH};
use crate::present::trace::picture::{Scene, style};
use crate::present::{escape, player};

/// The page of a trace of a scene with this name.
pub fn html(trace: &Trace, name: &str) -> String {
    let (scene, arrays) = (Scene::new(trace), Arrays::new(trace));
    let ops = trace.ops();
    let mut fragments = Fragments::default();
    let steps: Vec<Value> = trace
        .steps
        .iter()
        .map(|step| {
            let layers = scene.layers(trace, step).map(|layer| fragments.number(layer));
            let blocks: Vec<usize> =
                arrays.draw(trace, step).into_iter().map(|block| fragments.number(block)).collect();
            let counts: Vec<u64> = ops.iter().map(|(op, _)| step.tally.get(*op)).collect();
            json!([step.words, step.part, layers, blocks, counts, step.state.contacts.len()])
        })
        .collect();
    let contacts: Vec<String> =
        trace.contacts.iter().map(|&pair| scene.line(trace, pair)).collect();
    let names: Vec<&str> = ops.iter().map(|(_, words)| words.as_str()).collect();
    // In a script nothing but its end tag must be avoided.
    let data = json!({
        "steps": steps,
        "parts": trace.parts,
        "ops": names,
        "f": fragments.texts,
        "contacts": contacts,
    })
    .to_string()
    .replace("</", "<\\/");
    let blocks = "<g></g>".repeat(arrays.len());
    let [sw, sh] = scene.size.map(px);
    include_str!("page.html")
        .replace(
            "@@STYLE@@",
            &format!(
                "{}{}{}",
                colours(&LIGHT, ":root", ""),
                colours(&DARK, ":root.dark", ":root.dark "),
                player::STYLE
            ),
        )
        .replace("@@PLAYER@@", player::SCRIPT)
        .replace("@@SCENE@@", &format!("0 0 {sw} {sh}"))
        .replace("@@ARRAYS@@", &format!("0 0 {} {}", px(WIDTH), px(arrays.height)))
        .replace("@@GROUND@@", &scene.ground(trace))
        .replace("@@GRID@@", &scene.grid(trace))
        .replace("@@DISCS@@", &scene.discs(trace))
        .replace("@@NUMBERS@@", &scene.numbers(trace))
        .replace("@@BLOCKS@@", &blocks)
        .replace("@@LAST@@", &(trace.steps.len() - 1).to_string())
        .replace("@@DATA@@", &data)
        // Last, so that a name cannot be taken for a place.
        .replace("@@TITLE@@", &escape::html(&trace.title(name)))
}

fn colours(palette: &Palette, root: &str, scope: &str) -> String {
    let Palette { ground, ink, accent, .. } = palette;
    format!("{root}{{--ground:{ground};--ink:{ink};--accent:{accent}}}\n{}", style(palette, scope))
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
