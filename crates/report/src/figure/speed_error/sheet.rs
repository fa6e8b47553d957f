//! The sheet of a figure of speed against error: small panels that share their axes, and the legend
//! of colours and shapes.
//!
//! The error axis is broken: above the gap it is logarithmic, below it lies the field of answers
//! without error, where every arithmetic has a line of its own, so that their marks do not hide
//! each other.

use crate::figure::axis::Axis;
use crate::figure::canvas::{Canvas, MARGIN, Text};
use crate::figure::outcome::{badge, letter};
use crate::figure::speed_error::data::Plot;
use crate::figure::speed_error::panel::{BREAK, LANE, SCALE, SmallPanel, ZERO, ring, shape};
use crate::figure::style::{FAINT, INK, Styles};
use contactbench_record::cells::label;
use contactbench_record::experiment::{Against, Experiment, SpeedError};
use contactbench_terms::number::wrap;

const WIDTH: f64 = 1400.0;
const LEFT: f64 = 104.0;
const GAP: f64 = 14.0;
/// Height of the headings of a row: its own, and those of its panels.
const HEADING: f64 = 58.0;
/// Room beside the panels for the names of the lines.
const NAMES: f64 = 66.0;
const LEGEND: f64 = 206.0;

pub struct Sheet<'a> {
    pub size: (u32, u32),
    title: &'a str,
    against: Against,
    pub(super) plot: &'a Plot,
    pub(super) styles: &'a Styles,
    subtitle: Vec<String>,
    top: f64,
    pub(super) across: f64,
    pub(super) zero: f64,
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Marks that take longer than this, ns, stand at the right edge.
    pub(super) limit: f64,
}

impl<'a> Sheet<'a> {
    pub fn new(
        experiment: &Experiment,
        title: &'a str,
        options: &SpeedError,
        plot: &'a Plot,
        styles: &'a Styles,
    ) -> Sheet<'a> {
        let columns = plot.rows.iter().map(|row| row.panels.len()).max().unwrap_or(1).max(1);
        let room = WIDTH - 2.0 * MARGIN - LEFT - NAMES - LEGEND;
        // one or two panels need not fill the sheet
        let across = ((room + GAP) / columns as f64 - GAP).min(420.0);
        let against = match options.against {
            Against::Given => {
                "Errors are pairs missed, added or repeated, against exact decisions on the scene \
                 as given."
            }
            Against::Stored => {
                "Errors are pairs missed, added or repeated, against exact decisions on the scene \
                 as stored: what storing it did is left out."
            }
        };
        let subtitle = wrap(&format!("{} {against}", experiment.question), 150);
        let top = MARGIN + 34.0 + 22.0 * subtitle.len() as f64 + 4.0;
        let zero = LANE * plot.arithmetics.len() as f64 + 4.0;
        let height = top + plot.rows.len() as f64 * (HEADING + SCALE + BREAK + zero) + 74.0;
        let skins = plot.marks().any(|mark| mark.skin.is_some());
        let legend = 26.0
            * (plot.detectors.len() + plot.arithmetics.len() + plot.outcomes().len()) as f64
            + if skins { 356.0 } else { 330.0 };
        // with 100% as a landmark; without any error there is still an axis to be without error on
        let rates: Vec<f64> =
            plot.marks().map(|mark| mark.rate).filter(|rate| *rate > 0.0).chain([100.0]).collect();
        let least = if rates.len() > 1 { 100.0 } else { 1.0 };
        // what is wrong and far slower than anything right must not squeeze all other marks
        // together
        let right =
            plot.marks().filter(|mark| mark.rate == 0.0).map(|mark| mark.time).fold(0.0, f64::max);
        let limit = if right > 0.0 { 3.0 * right } else { f64::INFINITY };
        Sheet {
            size: (WIDTH as u32, height.max(top + legend).clamp(300.0, 8000.0) as u32),
            title,
            against: options.against,
            plot,
            styles,
            subtitle,
            top,
            across,
            zero,
            // bars may leave the panel, for the same reason
            x: Axis::new(plot.marks().map(|mark| mark.time).filter(|time| *time <= limit), true),
            y: Axis::new(rates.into_iter().chain([least]), true),
            limit,
        }
    }

    pub fn draw(&self, canvas: &mut Canvas) -> anyhow::Result<()> {
        canvas.heading(self.title, &self.subtitle)?;
        let height = HEADING + SCALE + BREAK + self.zero;
        for (k, row) in self.plot.rows.iter().enumerate() {
            let top = self.top + height * k as f64;
            canvas.text(&row.title, (MARGIN + LEFT, top + 25.0), Text::new(19.0, INK).bold())?;
            for (column, panel) in row.panels.iter().enumerate() {
                let left = MARGIN + LEFT + column as f64 * (self.across + GAP);
                let below =
                    self.plot.rows.get(k + 1).is_some_and(|below| below.panels.len() > column);
                let small = SmallPanel { sheet: self, left, top: top + HEADING };
                canvas.text(
                    &panel.title,
                    (left + self.across / 2.0, top + 47.0),
                    Text::new(16.0, INK).anchor(0),
                )?;
                small.grid(canvas, column == 0, !below)?;
                small.marks(canvas, panel)?;
                if column + 1 == row.panels.len() {
                    for (lane, name) in self.plot.arithmetics.iter().enumerate() {
                        canvas.text(
                            name,
                            (left + self.across + 6.0, small.lane(lane)),
                            Text::new(13.0, FAINT),
                        )?;
                    }
                }
            }
        }
        let bottom = self.top + height * self.plot.rows.len() as f64;
        let columns = self.plot.rows.iter().map(|row| row.panels.len()).max().unwrap_or(1) as f64;
        let centre = MARGIN + LEFT + (columns * (self.across + GAP) - GAP) / 2.0;
        canvas.text(
            "time per particle (ns)",
            (centre, bottom + 48.0),
            Text::new(19.0, INK).anchor(0),
        )?;
        let upright = Text { upright: true, ..Text::new(19.0, INK).anchor(0) };
        let errors = match self.against {
            Against::Given => "wrong pairs, per true contact",
            Against::Stored => "wrong pairs, per contact of the scene as stored",
        };
        canvas.text(errors, (MARGIN + 8.0, (self.top + HEADING + bottom) / 2.0), upright)?;
        self.legend(canvas)
    }

    fn legend(&self, canvas: &mut Canvas) -> anyhow::Result<()> {
        let (left, mut y) = (WIDTH - MARGIN - LEGEND + 16.0, self.top + HEADING + 6.0);
        let head = Text::new(16.0, FAINT);
        canvas.text("colour: detector", (left, y), head)?;
        let brief = label::brief(self.plot.detectors.iter().map(String::as_str));
        for name in &self.plot.detectors {
            y += 26.0;
            let colour = self.styles.get(name).colour;
            canvas.rect((left + 6.0, y - 7.0), (left + 28.0, y + 7.0), colour)?;
            canvas.text(&brief(name), (left + 40.0, y), Text::new(18.0, INK))?;
        }
        if self.plot.marks().any(|mark| mark.skin.is_some()) {
            y += 26.0;
            canvas.text("above a mark: its skin", (left, y), Text::new(16.0, INK))?;
        }
        y += 40.0;
        canvas.text("shape: arithmetic", (left, y), head)?;
        for name in &self.plot.arithmetics {
            y += 26.0;
            shape(canvas, (left + 17.0, y), 6.0, name, INK)?;
            canvas.text(name, (left + 40.0, y), Text::new(18.0, INK))?;
        }
        y += 40.0;
        canvas.rect((left, y - 9.0), (left + 34.0, y + 9.0), ZERO)?;
        canvas.text("0", (left + 17.0, y), Text::new(17.0, INK).bold().anchor(0))?;
        canvas.text("not one pair wrong", (left + 40.0, y), Text::new(16.0, INK))?;
        y += 28.0;
        ring(canvas, (left + 17.0, y))?;
        canvas.text("no other is as fast", (left + 40.0, y - 2.0), Text::new(16.0, INK))?;
        canvas.text("with as few errors", (left + 40.0, y + 18.0), Text::new(16.0, INK))?;
        y += 44.0;
        canvas.line(&[(left, y), (left + 34.0, y)], INK, 1.5, None)?;
        canvas.text("interval of the time", (left + 40.0, y), Text::new(16.0, INK))?;
        if self.plot.marks().any(|mark| mark.time > self.limit) {
            y += 28.0;
            canvas.text("→", (left + 17.0, y), Text::new(18.0, INK).anchor(0))?;
            canvas.text("slower than shown", (left + 40.0, y), Text::new(16.0, INK))?;
        }
        for outcome in self.plot.outcomes() {
            y += 28.0;
            let (letter, words) = letter(outcome);
            badge(canvas, (left + 17.0, y), letter, INK)?;
            canvas.text(words, (left + 40.0, y), Text::new(16.0, INK))?;
        }
        Ok(())
    }
}
