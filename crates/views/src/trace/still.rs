//! A step as one picture for slides and papers.

use crate::player::painted;
use crate::px;
use crate::trace::Trace;
use crate::trace::arrays::{Arrays, WIDTH};
use crate::trace::picture::{Scene, style};
use contactbench_terms::text;

/// Letters in a line of the sentence.
const LINE: usize = 92;

/// What pictures of one trace share.
pub struct Stills<'a> {
    trace: &'a Trace,
    scene: Scene<'a>,
    arrays: Arrays<'a>,
    title: String,
    /// The picture without what changes from step to step.
    frame: String,
}

impl<'a> Stills<'a> {
    /// For a trace of a scene with this name.
    pub fn new(trace: &'a Trace, name: &str) -> Stills<'a> {
        let (scene, arrays) = (Scene::new(trace), Arrays::new(trace));
        let [width, height] = scene.size.map(px);
        let frame = painted(include_str!("still.svg"), false)
            .replace("@@STYLE@@", &style(false, ""))
            .replace("@@LAST@@", &(trace.steps.len() - 1).to_string())
            .replace("@@SCENE@@", &format!("{width} {height}"))
            .replace("@@ARRAYS@@", &format!("{} {}", px(WIDTH), px(arrays.height)))
            .replace("@@GROUND@@", &scene.ground())
            .replace("@@GRID@@", &scene.grid())
            .replace("@@DISCS@@", &scene.discs())
            .replace("@@NUMBERS@@", &scene.numbers());
        Stills { trace, scene, arrays, title: text::html(&trace.title(name)), frame }
    }

    /// The picture of step `k`, from 0, as SVG; none if there is no such step.
    pub fn svg(&self, k: usize) -> Option<String> {
        let (trace, step) = (self.trace, self.trace.steps.get(k)?);
        let [under, over] = self.scene.layers(step);
        let contacts: String =
            step.state.contacts.iter().map(|&pair| self.scene.line(pair)).collect();
        let words: String = (0..)
            .zip(lines(&step.words))
            .map(|(line, words)| {
                let (y, words) = (868 + 38 * line, text::html(&words));
                format!("<text x=\"30\" y=\"{y}\" class=\"words\">{words}</text>")
            })
            .collect();
        let counts =
            trace.ops().into_iter().map(|(op, words)| format!("{words} {}", step.tally.get(op)));
        let picture = self
            .frame
            .replace("@@UNDER@@", &under)
            .replace("@@OVER@@", &over)
            .replace("@@CONTACTS@@", &contacts)
            .replace("@@BLOCKS@@", &self.arrays.draw(step).concat())
            .replace("@@PART@@", &text::html(&trace.parts[step.part]))
            .replace("@@WORDS@@", &words)
            .replace("@@COUNTS@@", &counts.collect::<Vec<_>>().join("  \u{b7}  "))
            .replace("@@STEP@@", &k.to_string());
        // Last, so that a name cannot be taken for a place.
        Some(picture.replace("@@TITLE@@", &self.title))
    }
}

/// A sentence in lines, broken at spaces.
fn lines(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= LINE => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_are_broken_between_words() {
        let text = ["word"; 60].join(" ");
        let lines = lines(&text);
        assert!(lines.len() > 3 && lines.iter().all(|line| line.len() <= LINE), "{lines:?}");
        assert_eq!(lines.join(" "), text);
    }
}
