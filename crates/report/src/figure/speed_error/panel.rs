//! One panel of speed against error: its grid, the front, marks and letters.

use crate::figure::axis::plain;
use crate::figure::canvas::{Canvas, Point, Text};
use crate::figure::outcome::{badge, letter};
use crate::figure::speed_error::data::{Mark, Panel};
use crate::figure::speed_error::sheet::Sheet;
use crate::figure::style::{Colour, FAINT, GRID, INK};

/// Between the logarithmic part and the field of zeros.
pub const BREAK: f64 = 9.0;
/// Height of the logarithmic part.
pub const SCALE: f64 = 132.0;
/// Room at its ends for half a mark.
const ROOM: f64 = 7.0;
/// Height of one arithmetic's line in the field of zeros.
pub const LANE: f64 = 13.0;
pub const ZERO: Colour = (229, 242, 232);
const FRAME: Colour = (170, 170, 170);
const STAIRS: Colour = (105, 105, 105);

/// A ring around a mark of the front.
pub fn ring(canvas: &mut Canvas, (x, y): Point) -> anyhow::Result<()> {
    let point = |k: u32| (f64::from(k) * std::f64::consts::TAU / 36.0).sin_cos();
    let points: Vec<Point> =
        (0..=36).map(point).map(|(sine, cosine)| (x + 9.0 * cosine, y + 9.0 * sine)).collect();
    canvas.line(&points, INK, 1.8, None)
}

/// The shape of an arithmetic. Those that decide alike (f32 and f32-cell, textbook and f64) are
/// told apart where they lie on each other.
pub fn shape(
    canvas: &mut Canvas,
    (x, y): Point,
    r: f64,
    arithmetic: &str,
    colour: Colour,
) -> anyhow::Result<()> {
    let square = |r: f64| [(x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)];
    let diamond = |r: f64| [(x, y - 1.4 * r), (x + 1.4 * r, y), (x, y + 1.4 * r), (x - 1.4 * r, y)];
    match arithmetic {
        "f32" => {
            canvas.line(&[(x - r, y - r), (x + r, y + r)], colour, 2.0, None)?;
            canvas.line(&[(x - r, y + r), (x + r, y - r)], colour, 2.0, None)
        }
        "f32-cell" => canvas.fill(
            &[(x, y - 1.2 * r), (x + 1.15 * r, y + 0.85 * r), (x - 1.15 * r, y + 0.85 * r)],
            colour,
        ),
        "textbook" => {
            let corners = square(r);
            canvas.line(
                &[corners[0], corners[1], corners[2], corners[3], corners[0]],
                colour,
                1.6,
                None,
            )
        }
        "f64" => canvas.disc((x, y), r, colour),
        "exact" => canvas.fill(&diamond(r), colour),
        _ => {
            canvas.line(&[(x - r, y), (x + r, y)], colour, 2.0, None)?;
            canvas.line(&[(x, y - r), (x, y + r)], colour, 2.0, None)
        }
    }
}

/// A panel of the sheet: where it begins.
pub struct SmallPanel<'a> {
    pub sheet: &'a Sheet<'a>,
    /// The left end of the time axis.
    pub left: f64,
    /// The top of the logarithmic part.
    pub top: f64,
}

impl SmallPanel<'_> {
    fn right(&self) -> f64 {
        self.left + self.sheet.across
    }

    /// The field of zeros: from here, and to there.
    fn field(&self) -> (f64, f64) {
        let top = self.top + SCALE + BREAK;
        (top, top + self.sheet.zero)
    }

    /// The middle of an arithmetic's line in the field of zeros.
    pub fn lane(&self, arithmetic: usize) -> f64 {
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

    pub fn grid(&self, canvas: &mut Canvas, y_labels: bool, x_labels: bool) -> anyhow::Result<()> {
        let (sheet, right, field) = (self.sheet, self.right(), self.field());
        let labels = Text::new(16.0, INK);
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
                canvas.text(
                    &format!("{}%", plain(value)),
                    (self.left - 8.0, y),
                    labels.anchor(1),
                )?;
            }
        }
        for (top, bottom) in [(self.top, self.top + SCALE), field] {
            canvas.line(
                &[
                    (self.left, top),
                    (right, top),
                    (right, bottom),
                    (self.left, bottom),
                    (self.left, top),
                ],
                FRAME,
                1.0,
                None,
            )?;
        }
        if y_labels {
            canvas.text(
                "0",
                (self.left - 8.0, (field.0 + field.1) / 2.0),
                Text::new(22.0, INK).bold().anchor(1),
            )?;
            // the axis is broken
            let middle = self.top + SCALE + BREAK / 2.0;
            for y in [middle - 3.0, middle + 3.0] {
                canvas.line(
                    &[(self.left - 7.0, y + 3.0), (self.left + 7.0, y - 3.0)],
                    STAIRS,
                    1.2,
                    None,
                )?;
            }
        }
        Ok(())
    }

    /// The front, the marks, and the letters of what has no mark.
    pub fn marks(&self, canvas: &mut Canvas, panel: &Panel) -> anyhow::Result<()> {
        let (shown, slow): (Vec<&Mark>, Vec<&Mark>) =
            panel.marks.iter().partition(|mark| mark.time <= self.sheet.limit);
        let front: Vec<Point> =
            shown.iter().filter(|mark| mark.front).filter_map(|mark| self.at(mark)).collect();
        let mut stairs = Vec::new();
        for (k, &(x, y)) in front.iter().enumerate() {
            stairs.push((x, if k == 0 { self.top } else { front[k - 1].1 }));
            stairs.push((x, y));
        }
        stairs.extend(front.last().map(|last| (self.right(), last.1)));
        canvas.line(&stairs, STAIRS, 1.5, None)?;
        for mark in &shown {
            let (Some(at), Some(low), Some(high)) =
                (self.at(mark), self.x(mark.low), self.x(mark.high))
            else {
                continue;
            };
            let inside = |x: f64| x.clamp(self.left, self.right());
            canvas.line(
                &[(inside(low), at.1), (inside(high), at.1)],
                self.colour(mark),
                1.3,
                None,
            )?;
        }
        // the front last, so that its rings are whole
        for front in [false, true] {
            for mark in shown.iter().filter(|mark| mark.front == front) {
                let Some(at) = self.at(mark) else { continue };
                if front {
                    ring(canvas, at)?;
                }
                shape(
                    canvas,
                    at,
                    4.6,
                    &self.sheet.plot.arithmetics[mark.arithmetic],
                    self.colour(mark),
                )?;
                // In the lane of right answers there is room for one.
                if let Some(skin) = mark.skin.as_ref().filter(|_| front || mark.rate > 0.0) {
                    canvas.text(skin, (at.0, at.1 - 11.0), Text::new(12.0, FAINT).anchor(0))?;
                }
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
                badge(
                    canvas,
                    (x, self.top + 10.0),
                    letter(*outcome).0,
                    self.sheet.styles.get(detector).colour,
                )?;
            }
        }
        Ok(())
    }

    fn colour(&self, mark: &Mark) -> Colour {
        self.sheet.styles.get(&mark.detector).colour
    }
}
