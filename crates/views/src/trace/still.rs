//! A step as one picture for slides and papers.

use crate::player::painted;
use crate::trace::Trace;
use crate::trace::arrays::Arrays;
use crate::trace::picture::{Scene, style};
use contactbench_terms::text;

/// Maximum number of letters in a line of the sentence.
const LINE: usize = 92;

pub struct Stills<'a> {
    trace: &'a Trace,
    scene: Scene<'a>,
    arrays: Arrays<'a>,
    template: String,
    values: Vec<(&'static str, String)>,
}

impl<'a> Stills<'a> {
    pub fn new(trace: &'a Trace, name: &str) -> Stills<'a> {
        let (scene, arrays) = (Scene::new(trace), Arrays::new(trace));
        let mut values = scene.values(&arrays).to_vec();
        values.push(("style", style(false, "")));
        values.push(("title", text::html(&trace.title(name))));
        let template = painted(include_str!("still.svg"), false);
        Stills { trace, scene, arrays, template, values }
    }

    /// Returns the picture of step `k`, from 0, as SVG; `None` past the last step.
    pub fn svg(&self, k: usize) -> Option<String> {
        let (trace, step) = (self.trace, self.trace.steps.get(k)?);
        let [under, over] = self.scene.layers(step);
        let contacts = step.state.contacts.iter().map(|&pair| self.scene.line(pair));
        let words = (0..).zip(lines(&step.words)).map(|(line, words)| {
            let (y, words) = (868 + 38 * line, text::html(&words));
            format!("<text x=\"30\" y=\"{y}\" class=\"words\">{words}</text>")
        });
        let ops = trace.ops().into_iter();
        let counts = ops.map(|(op, words)| format!("{words} {}", step.tally.get(op)));
        let mut values = self.values.clone();
        values.extend([
            ("under", under),
            ("over", over),
            ("contacts", contacts.collect()),
            ("blocks", self.arrays.draw(step).concat()),
            ("part", text::html(&trace.parts[step.part])),
            ("words", words.collect()),
            ("counts", counts.collect::<Vec<_>>().join("  \u{b7}  ")),
            ("step", k.to_string()),
        ]);
        Some(text::fill(&self.template, &values))
    }
}

fn lines(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.is_empty() => *line = word.into(),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= LINE => {
                *line += &format!(" {word}");
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}
