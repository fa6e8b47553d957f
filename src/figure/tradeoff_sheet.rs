//! The sheet of a figure of speed against error: small panels that share their axes, and the legend of colours and shapes.
//!
//! The error axis is broken: above the gap it is logarithmic, below it lies the field of answers without error, where every arithmetic has
//! a line of its own, so that their marks do not hide each other.

use super::axis::Axis;
use super::canvas::{Canvas, Point, Text};
use super::layout::letter;
use super::panel::badge;
use super::style::{Colour, FAINT, GRID, INK, Styles};
use super::tradeoff::{Mark, Panel, Plot};
use crate::analyse::text::wrap;
use crate::harness::experiment::{Against, Experiment, Figure};

const WIDTH: f64 = 1400.0;
const MARGIN: f64 = 24.0;
const LEFT: f64 = 104.0;
const GAP: f64 = 14.0;
/// Between the logarithmic part and the field of zeros.
const BREAK: f64 = 9.0;
/// Height of the logarithmic part.
const SCALE: f64 = 132.0;
/// Room at its ends for half a mark.
const ROOM: f64 = 7.0;
/// Height of one arithmetic's line in the field of zeros.
const LANE: f64 = 13.0;
/// Height of the headings of a row: its own, and those of its panels.
const HEADING: f64 = 58.0;
/// Room beside the panels for the names of the lines.
const NAMES: f64 = 66.0;
const LEGEND: f64 = 206.0;
const ZERO: Colour = (229, 242, 232);
const FRAME: Colour = (170, 170, 170);
const STAIRS: Colour = (105, 105, 105);

/// A figure, laid out.
pub struct Sheet<'a> {
    /// Width and height.
    pub size: (u32, u32),
    figure: &'a Figure,
    plot: &'a Plot,
    styles: &'a Styles,
    subtitle: Vec<String>,
    top: f64,
    across: f64,
    zero: f64,
    x: Axis,
    y: Axis,
    /// Marks that take longer than this, ns, stand at the right edge.
    limit: f64,
}

impl<'a> Sheet<'a> {
    /// Measures everything.
    pub fn new(experiment: &Experiment, figure: &'a Figure, plot: &'a Plot, styles: &'a Styles) -> Sheet<'a> {
        let columns = plot.rows.iter().map(|row| row.panels.len()).max().unwrap_or(1).max(1);
        let room = WIDTH - 2.0 * MARGIN - LEFT - NAMES - LEGEND;
        // one or two panels need not fill the sheet
        let across = ((room + GAP) / columns as f64 - GAP).min(420.0);
        let against = match figure.against {
            Against::Given => "Errors are pairs missed, added or repeated, against exact decisions on the scene as given.",
            Against::Stored => {
                "Errors are pairs missed, added or repeated, against exact decisions on the scene as stored: what storing it did is left out."
            }
        };
        let subtitle = wrap(&format!("{} {against}", experiment.question), 150);
        let top = MARGIN + 34.0 + 22.0 * subtitle.len() as f64 + 4.0;
        let zero = LANE * plot.arithmetics.len() as f64 + 4.0;
        let height = top + plot.rows.len() as f64 * (HEADING + SCALE + BREAK + zero) + 74.0;
        let legend = 26.0 * (plot.detectors.len() + plot.arithmetics.len() + plot.outcomes().len()) as f64 + 330.0;
        // with 100% as a landmark; without any error there is still an axis to be without error on
        let rates: Vec<f64> = plot.marks().map(|mark| mark.rate).filter(|rate| *rate > 0.0).chain([100.0]).collect();
        let least = if rates.len() > 1 { 100.0 } else { 1.0 };
        // what is wrong and far slower than anything right must not squeeze all other marks together
        let right = plot.marks().filter(|mark| mark.rate == 0.0).map(|mark| mark.time).fold(0.0, f64::max);
        let limit = if right > 0.0 { 3.0 * right } else { f64::INFINITY };
        Sheet {
            size: (WIDTH as u32, height.max(top + legend).clamp(300.0, 8000.0) as u32),
            figure,
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

    /// Draws everything.
    pub fn draw(&self, canvas: &mut dyn Canvas) -> anyhow::Result<()> {
        canvas.text(&self.figure.title, (MARGIN, MARGIN + 12.0), Text::new(29.0, INK).bold())?;
        for (k, line) in self.subtitle.iter().enumerate() {
            canvas.text(line, (MARGIN, MARGIN + 42.0 + 22.0 * k as f64), Text::new(18.0, FAINT))?;
        }
        let height = HEADING + SCALE + BREAK + self.zero;
        for (k, row) in self.plot.rows.iter().enumerate() {
            let top = self.top + height * k as f64;
            canvas.text(&row.title, (MARGIN + LEFT, top + 25.0), Text::new(19.0, INK).bold())?;
            for (column, panel) in row.panels.iter().enumerate() {
                let left = MARGIN + LEFT + column as f64 * (self.across + GAP);
                let below = self.plot.rows.get(k + 1).is_some_and(|below| below.panels.len() > column);
                let frame = Frame { sheet: self, left, top: top + HEADING };
                canvas.text(&panel.title, (left + self.across / 2.0, top + 47.0), Text::new(16.0, INK).anchor(0))?;
                frame.grid(canvas, column == 0, !below)?;
                frame.panel(canvas, panel)?;
                if column + 1 == row.panels.len() {
                    for (lane, name) in self.plot.arithmetics.iter().enumerate() {
                        canvas.text(name, (left + self.across + 6.0, frame.lane(lane)), Text::new(13.0, FAINT))?;
                    }
                }
            }
        }
        let bottom = self.top + height * self.plot.rows.len() as f64;
        let columns = self.plot.rows.iter().map(|row| row.panels.len()).max().unwrap_or(1) as f64;
        let centre = MARGIN + LEFT + (columns * (self.across + GAP) - GAP) / 2.0;
        canvas.text("time per element (ns)", (centre, bottom + 48.0), Text::new(19.0, INK).anchor(0))?;
        let upright = Text { upright: true, ..Text::new(19.0, INK).anchor(0) };
        let errors = match self.figure.against {
            Against::Given => "wrong pairs, per true contact",
            Against::Stored => "wrong pairs, per contact of the scene as stored",
        };
        canvas.text(errors, (MARGIN + 8.0, (self.top + HEADING + bottom) / 2.0), upright)?;
        self.legend(canvas)
    }

    fn legend(&self, canvas: &mut dyn Canvas) -> anyhow::Result<()> {
        let (left, mut y) = (WIDTH - MARGIN - LEGEND + 16.0, self.top + HEADING + 6.0);
        let head = Text::new(16.0, FAINT);
        canvas.text("colour: detector", (left, y), head)?;
        for name in &self.plot.detectors {
            y += 26.0;
            let colour = self.styles.of(name).colour;
            canvas.rect((left + 6.0, y - 7.0), (left + 28.0, y + 7.0), colour)?;
            canvas.text(name, (left + 40.0, y), Text::new(18.0, INK))?;
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

/// A ring around a mark of the front.
fn ring(canvas: &mut dyn Canvas, (x, y): Point) -> anyhow::Result<()> {
    let point = |k: u32| (f64::from(k) * std::f64::consts::TAU / 36.0).sin_cos();
    let points: Vec<Point> = (0..=36).map(point).map(|(sine, cosine)| (x + 9.0 * cosine, y + 9.0 * sine)).collect();
    canvas.line(&points, INK, 1.8, None)
}

/// The shape of an arithmetic. Those that decide alike (f32 and f32-cell, textbook and f64) are told apart where they lie on each other.
fn shape(canvas: &mut dyn Canvas, (x, y): Point, r: f64, arithmetic: &str, colour: Colour) -> anyhow::Result<()> {
    let square = |r: f64| [(x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)];
    let diamond = |r: f64| [(x, y - 1.4 * r), (x + 1.4 * r, y), (x, y + 1.4 * r), (x - 1.4 * r, y)];
    match arithmetic {
        "f32" => {
            canvas.line(&[(x - r, y - r), (x + r, y + r)], colour, 2.0, None)?;
            canvas.line(&[(x - r, y + r), (x + r, y - r)], colour, 2.0, None)
        }
        "f32-cell" => canvas.fill(&[(x, y - 1.2 * r), (x + 1.15 * r, y + 0.85 * r), (x - 1.15 * r, y + 0.85 * r)], colour),
        "textbook" => {
            let corners = square(r);
            canvas.line(&[corners[0], corners[1], corners[2], corners[3], corners[0]], colour, 1.6, None)
        }
        "f64" => canvas.disc((x, y), r, colour),
        "exact" => canvas.fill(&diamond(r), colour),
        _ => {
            canvas.line(&[(x - r, y), (x + r, y)], colour, 2.0, None)?;
            canvas.line(&[(x, y - r), (x, y + r)], colour, 2.0, None)
        }
    }
}

/// A panel's place.
struct Frame<'a> {
    sheet: &'a Sheet<'a>,
    left: f64,
    top: f64,
}

impl Frame<'_> {
    fn right(&self) -> f64 {
        self.left + self.sheet.across
    }

    /// The field of zeros: from here, and to there.
    fn field(&self) -> (f64, f64) {
        let top = self.top + SCALE + BREAK;
        (top, top + self.sheet.zero)
    }

    fn lane(&self, arithmetic: usize) -> f64 {
        self.field().0 + 2.0 + LANE * (arithmetic as f64 + 0.5)
    }

    fn x(&self, time: f64) -> Option<f64> {
        Some(self.left + self.sheet.x.place(time)? * self.sheet.across)
    }

    fn y(&self, mark: &Mark) -> Option<f64> {
        if mark.rate == 0.0 {
            return Some(self.lane(mark.arithmetic));
        }
        self.scale(mark.rate)
    }

    fn scale(&self, rate: f64) -> Option<f64> {
        Some(self.top + ROOM + (SCALE - 2.0 * ROOM) * (1.0 - self.sheet.y.place(rate)?))
    }

    fn at(&self, mark: &Mark) -> Option<Point> {
        Some((self.x(mark.time)?, self.y(mark)?))
    }

    fn grid(&self, canvas: &mut dyn Canvas, y_labels: bool, x_labels: bool) -> anyhow::Result<()> {
        let (sheet, right, labels, field) = (self.sheet, self.right(), Text::new(16.0, INK), self.field());
        canvas.rect((self.left, field.0), (right, field.1), ZERO)?;
        for (value, label) in sheet.x.ticks(sheet.across, 50.0) {
            let Some(x) = self.x(value) else { continue };
            canvas.line(&[(x, self.top), (x, self.top + SCALE)], GRID, 1.0, None)?;
            canvas.line(&[(x, field.0), (x, field.1)], (208, 226, 212), 1.0, None)?;
            if let Some(label) = label.filter(|_| x_labels) {
                canvas.text(&label, (x, field.1 + 14.0), labels.anchor(0))?;
            }
        }
        for (value, label) in sheet.y.ticks(SCALE, 26.0) {
            let Some(y) = self.scale(value) else { continue };
            canvas.line(&[(self.left, y), (right, y)], GRID, 1.0, None)?;
            if label.is_some() && y_labels {
                canvas.text(&format!("{}%", super::axis::plain(value)), (self.left - 8.0, y), labels.anchor(1))?;
            }
        }
        for (top, bottom) in [(self.top, self.top + SCALE), field] {
            canvas.line(&[(self.left, top), (right, top), (right, bottom), (self.left, bottom), (self.left, top)], FRAME, 1.0, None)?;
        }
        if y_labels {
            canvas.text("0", (self.left - 8.0, (field.0 + field.1) / 2.0), Text::new(22.0, INK).bold().anchor(1))?;
            // the axis is broken
            let middle = self.top + SCALE + BREAK / 2.0;
            for y in [middle - 3.0, middle + 3.0] {
                canvas.line(&[(self.left - 7.0, y + 3.0), (self.left + 7.0, y - 3.0)], STAIRS, 1.2, None)?;
            }
        }
        Ok(())
    }

    fn panel(&self, canvas: &mut dyn Canvas, panel: &Panel) -> anyhow::Result<()> {
        let (shown, slow): (Vec<&Mark>, Vec<&Mark>) = panel.marks.iter().partition(|mark| mark.time <= self.sheet.limit);
        let front: Vec<Point> = shown.iter().filter(|mark| mark.front).filter_map(|mark| self.at(mark)).collect();
        let mut stairs = Vec::new();
        for (k, &(x, y)) in front.iter().enumerate() {
            stairs.push((x, if k == 0 { self.top } else { front[k - 1].1 }));
            stairs.push((x, y));
        }
        stairs.extend(front.last().map(|last| (self.right(), last.1)));
        canvas.line(&stairs, STAIRS, 1.5, None)?;
        for mark in &shown {
            let (Some(at), Some(low), Some(high)) = (self.at(mark), self.x(mark.low), self.x(mark.high)) else { continue };
            let inside = |x: f64| x.clamp(self.left, self.right());
            canvas.line(&[(inside(low), at.1), (inside(high), at.1)], self.colour(mark), 1.3, None)?;
        }
        // the front last, so that its rings are whole
        for front in [false, true] {
            for mark in shown.iter().filter(|mark| mark.front == front) {
                let Some(at) = self.at(mark) else { continue };
                if front {
                    ring(canvas, at)?;
                }
                shape(canvas, at, 4.6, &self.sheet.plot.arithmetics[mark.arithmetic], self.colour(mark))?;
            }
        }
        for (k, mark) in slow.iter().rev().enumerate() {
            let Some(y) = self.y(mark) else { continue };
            shape(
                canvas,
                (self.right() - 24.0 - 13.0 * k as f64, y),
                4.6,
                &self.sheet.plot.arithmetics[mark.arithmetic],
                self.colour(mark),
            )?;
            canvas.text("→", (self.right() - 3.0, y), Text::new(16.0, INK).anchor(1))?;
        }
        for (k, (detector, outcome)) in panel.missing.iter().enumerate() {
            let x = self.right() - 10.0 - 17.0 * k as f64;
            if x > self.left + 8.0 {
                badge(canvas, (x, self.top + 10.0), letter(*outcome).0, self.sheet.styles.of(detector).colour)?;
            }
        }
        Ok(())
    }

    fn colour(&self, mark: &Mark) -> Colour {
        self.sheet.styles.of(&mark.detector).colour
    }
}
