//! Figures of speed against error: small panels with common axes, a mark per detector and
//! arithmetic, and a legend of colours and shapes.
//!
//! The error axis is broken. Its upper part is logarithmic. Its lower part holds the answers
//! without errors, on a separate line for each arithmetic, so that their marks do not hide each
//! other.

mod data;
mod panel;

use crate::figure::About;
use crate::figure::axis::Axis;
use crate::figure::canvas::{self, AXIS, Canvas, HEADING, MARGIN, Text};
use crate::figure::style::{FAINT, INK, letter};
use contactbench_record::cells::label;
use contactbench_record::experiment::{Against, SpeedError};
use contactbench_terms::number::wrap;
use data::Plot;
use panel::{BREAK, LANE, SCALE, SmallPanel, ZERO, ring, shape};

const WIDTH: f64 = 1400.0;
const LEFT: f64 = 104.0;
const GAP: f64 = 14.0;
const HEADINGS: f64 = 58.0;
const NAMES: f64 = 66.0;
const LEGEND: f64 = 206.0;
const NAME: Text = Text::new(18.0, INK);
const WORDS: Text = Text::new(16.0, INK);

struct Layout<'a> {
    about: &'a About<'a>,
    against: Against,
    plot: &'a Plot,
    subtitle: Vec<String>,
    top: f64,
    across: f64,
    zero: f64,
    x: Axis,
    y: Axis,
    /// Time in nanoseconds; slower marks are drawn at the right edge.
    limit: f64,
}

pub fn svg(about: &About<'_>, options: &SpeedError) -> anyhow::Result<Option<String>> {
    let Some(plot) = Plot::new(about, options)? else { return Ok(None) };
    let layout = Layout::new(about, options.against, &plot);
    let names = plot.detectors.len() + plot.arithmetics.len() + plot.outcomes().len();
    let legend = 26.0 * names as f64 + if plot.skins() { 356.0 } else { 330.0 };
    let height = (layout.bottom() + 74.0).max(layout.top + legend).clamp(300.0, 8000.0);
    Ok(Some(canvas::svg([WIDTH, height], |canvas| layout.draw(canvas))))
}

impl<'a> Layout<'a> {
    fn new(about: &'a About<'_>, against: Against, plot: &'a Plot) -> Layout<'a> {
        let room = WIDTH - 2.0 * MARGIN - LEFT - NAMES - LEGEND;
        let stored = match against {
            Against::Given => "given.",
            Against::Stored => "stored: what storing it did is left out.",
        };
        let subtitle = format!(
            "{} Errors are pairs missed, added or repeated, against exact decisions on the scene \
             as {stored}",
            about.experiment.question
        );
        let subtitle = wrap(&subtitle, 150);
        // The axis includes 100%. Without errors, it begins at 1%.
        let rates = plot.marks().map(|mark| mark.rate).filter(|rate| *rate > 0.0);
        let least = if rates.clone().next().is_some() { 100.0 } else { 1.0 };
        // Wrong answers that are far slower than all right ones must not squeeze the other marks.
        let right = plot.marks().filter(|mark| mark.rate == 0.0).map(|mark| mark.time);
        let right = right.fold(0.0, f64::max);
        let limit = if right > 0.0 { 3.0 * right } else { f64::INFINITY };
        Layout {
            about,
            against,
            plot,
            top: MARGIN + 34.0 + 22.0 * subtitle.len() as f64 + 4.0,
            subtitle,
            // One or two panels do not fill the whole width.
            across: ((room + GAP) / plot.columns() - GAP).min(420.0),
            zero: LANE * plot.arithmetics.len() as f64 + 4.0,
            // The axis ignores marks beyond the limit; bars may leave the panel.
            x: Axis::new(plot.marks().map(|mark| mark.time).filter(|time| *time <= limit), true),
            y: Axis::new(rates.chain([100.0, least]), true),
            limit,
        }
    }

    fn row(&self) -> f64 {
        HEADINGS + SCALE + BREAK + self.zero
    }

    fn bottom(&self) -> f64 {
        self.top + self.row() * self.plot.rows.len() as f64
    }

    fn draw(&self, canvas: &mut Canvas) {
        canvas.heading(&self.about.figure.title, &self.subtitle);
        let rows = &self.plot.rows;
        for (k, row) in rows.iter().enumerate() {
            let top = self.top + self.row() * k as f64;
            canvas.text(&row.title, (MARGIN + LEFT, top + 25.0), HEADING);
            for (column, panel) in row.panels.iter().enumerate() {
                let left = MARGIN + LEFT + column as f64 * (self.across + GAP);
                let below = rows.get(k + 1).is_some_and(|below| below.panels.len() > column);
                let small = SmallPanel { layout: self, left, top: top + HEADINGS };
                let middle = left + self.across / 2.0;
                canvas.text(&panel.title, (middle, top + 47.0), WORDS.centred());
                small.grid(canvas, column == 0, !below);
                small.marks(canvas, panel);
                if column + 1 == row.panels.len() {
                    for (lane, name) in self.plot.arithmetics.iter().enumerate() {
                        let at = (left + self.across + 6.0, small.lane(lane));
                        canvas.text(name, at, Text::new(13.0, FAINT));
                    }
                }
            }
        }
        let bottom = self.bottom();
        let centre = MARGIN + LEFT + (self.plot.columns() * (self.across + GAP) - GAP) / 2.0;
        canvas.text("time per particle (ns)", (centre, bottom + 48.0), AXIS);
        let errors = match self.against {
            Against::Given => "wrong pairs, per true contact",
            Against::Stored => "wrong pairs, per contact of the scene as stored",
        };
        let middle = (self.top + HEADINGS + bottom) / 2.0;
        canvas.text(errors, (MARGIN + 8.0, middle), AXIS.upright());
        self.legend(canvas);
    }

    fn legend(&self, canvas: &mut Canvas) {
        let (left, mut y) = (WIDTH - MARGIN - LEGEND + 16.0, self.top + HEADINGS + 6.0);
        let (middle, words) = (left + 17.0, left + 40.0);
        let head = Text::new(16.0, FAINT);
        canvas.text("colour: detector", (left, y), head);
        let brief = label::brief(self.plot.detectors.iter().map(String::as_str));
        for name in &self.plot.detectors {
            y += 26.0;
            let colour = self.about.styles.get(name).colour;
            canvas.rect((left + 6.0, y - 7.0), (left + 28.0, y + 7.0), colour);
            canvas.text(&brief(name), (words, y), NAME);
        }
        if self.plot.skins() {
            y += 26.0;
            canvas.text("above a mark: its skin", (left, y), WORDS);
        }
        y += 40.0;
        canvas.text("shape: arithmetic", (left, y), head);
        for name in &self.plot.arithmetics {
            y += 26.0;
            shape(canvas, (middle, y), 6.0, name, INK);
            canvas.text(name, (words, y), NAME);
        }
        y += 40.0;
        canvas.rect((left, y - 9.0), (left + 34.0, y + 9.0), ZERO);
        canvas.text("0", (middle, y), Text::new(17.0, INK).bold().centred());
        canvas.text("no pair is wrong", (words, y), WORDS);
        y += 28.0;
        ring(canvas, (middle, y));
        canvas.text("no other is as fast", (words, y - 2.0), WORDS);
        canvas.text("with as few errors", (words, y + 18.0), WORDS);
        y += 44.0;
        canvas.line(&[(left, y), (left + 34.0, y)], INK, 1.5);
        canvas.text("interval of the time", (words, y), WORDS);
        if self.plot.marks().any(|mark| mark.time > self.limit) {
            y += 28.0;
            canvas.text("→", (middle, y), NAME.centred());
            canvas.text("slower than shown", (words, y), WORDS);
        }
        for (letter, meaning) in self.plot.outcomes().into_iter().map(letter) {
            y += 28.0;
            canvas.badge((middle, y), letter, INK);
            canvas.text(meaning, (words, y), WORDS);
        }
    }
}
