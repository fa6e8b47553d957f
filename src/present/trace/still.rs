//! A step as one picture for slides and papers.

use crate::present::escape;
use crate::present::player::palette::LIGHT;
use crate::present::svg::px;
use crate::present::trace::Trace;
use crate::present::trace::arrays::{Arrays, WIDTH};
use crate::present::trace::picture::{Scene, style};
use crate::present::trace::recorder::Step;

const SIZE: [f64; 2] = [1600.0, 1000.0];
/// Letters in a line of the sentence.
const LINE: usize = 92;

/// What pictures of one trace share.
pub struct Stills<'a> {
    trace: &'a Trace,
    scene: Scene,
    arrays: Arrays,
    title: String,
    style: String,
}

impl<'a> Stills<'a> {
    /// For a trace of a scene with this name.
    pub fn new(trace: &'a Trace, name: &str) -> Stills<'a> {
        let title = escape::html(&trace.title(name));
        Stills {
            trace,
            scene: Scene::new(trace),
            arrays: Arrays::new(trace),
            title,
            style: style(&LIGHT, ""),
        }
    }

    /// The picture of step `k`, from 0, as SVG; none if there is no such step.
    pub fn svg(&self, k: usize) -> Option<String> {
        let (trace, step) = (self.trace, self.trace.steps.get(k)?);
        let [under, over] = self.scene.layers(trace, step);
        let contacts: String =
            step.state.contacts.iter().map(|&pair| self.scene.line(trace, pair)).collect();
        let [sw, sh] = self.scene.size.map(px);
        let [width, height] = SIZE.map(px);
        let (ground, grid, discs, numbers) = (
            self.scene.ground(trace),
            self.scene.grid(trace),
            self.scene.discs(trace),
            self.scene.numbers(trace),
        );
        let arrays = self.arrays.draw(trace, step).concat();
        let (aw, ah) = (px(WIDTH), px(self.arrays.height));
        let (part, last) = (escape::html(&trace.parts[step.part]), trace.steps.len() - 1);
        let words: String = lines(&step.words)
            .iter()
            .enumerate()
            .map(|(line, text)| {
                format!(
                    "<text x=\"30\" y=\"{}\" class=\"words\">{}</text>",
                    868 + 38 * line,
                    escape::html(text)
                )
            })
            .collect();
        Some(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"DejaVu Sans, Verdana, \
             sans-serif\">\n<title>{title}, step \
             {k}</title>\n<style>{style}.words{{font-size:28px;fill:{ink}}} \
             .counts{{font-size:18px;fill:{ink}}}</style>\n<rect width=\"{width}\" \
             height=\"{height}\" fill=\"{paper}\"/>\n<text x=\"30\" y=\"46\" font-size=\"22\" \
             fill=\"{ink}\">{title}</text>\n<text x=\"1570\" y=\"46\" font-size=\"26\" \
             font-weight=\"bold\" text-anchor=\"end\" fill=\"{ink}\">step {k} of \
             {last}</text>\n<text x=\"30\" y=\"92\" font-size=\"30\" font-weight=\"bold\" \
             fill=\"{ink}\">{part}</text>\n<svg x=\"20\" y=\"115\" width=\"730\" height=\"710\" \
             viewBox=\"0 0 {sw} {sh}\">{ground}{under}{grid}{discs}<path class=\"contact\" \
             d=\"{contacts}\"/>{over}{numbers}</svg>\n<svg x=\"780\" y=\"115\" width=\"800\" \
             height=\"710\" viewBox=\"0 0 {aw} {ah}\" \
             preserveAspectRatio=\"xMinYMin\">{arrays}</svg>\n{words}\n<text x=\"30\" y=\"980\" \
             class=\"counts\">{counts}</text>\n</svg>\n",
            title = self.title,
            style = self.style,
            ink = LIGHT.ink,
            paper = LIGHT.ground,
            counts = counts(trace, step)
        ))
    }
}

/// The operations that this detector has, and how many there were.
fn counts(trace: &Trace, step: &Step) -> String {
    let count = |(op, words)| format!("{words} {}", step.tally.get(op));
    trace.ops().into_iter().map(count).collect::<Vec<_>>().join("  \u{b7}  ")
}

/// A sentence in lines.
fn lines(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = vec![String::new()];
    for word in text.split(' ') {
        let full = lines.last().is_some_and(|line| {
            !line.is_empty() && line.chars().count() + 1 + word.chars().count() > LINE
        });
        if full {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_are_broken_between_words() {
        let text = "word ".repeat(60);
        let lines = lines(text.trim_end());
        assert!(
            lines.len() > 3
                && lines.iter().all(|line| line.chars().count() <= LINE && !line.starts_with(' '))
        );
        assert_eq!(lines.join(" "), text.trim_end());
    }
}
