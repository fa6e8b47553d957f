//! One panel of speed against error: its grid, the front, marks and letters.

use crate::figure::axis::plain;
use crate::figure::canvas::{Canvas, Point, Text, slanted, upright};
use crate::figure::speed_error::Layout;
use crate::figure::speed_error::data::{Mark, Panel};
use crate::figure::style::{Colour, FAINT, FRAME, GRID, INK, letter};

/// Gap between the logarithmic part and the field of zeros.
pub const BREAK: f64 = 9.0;
pub const SCALE: f64 = 132.0;
/// Room at both ends of the logarithmic part for half a mark.
const ROOM: f64 = 7.0;
pub const LANE: f64 = 13.0;
pub const ZERO: Colour = (229, 242, 232);
const STAIRS: Colour = (105, 105, 105);
const LABEL: Text = Text::new(16.0, INK);

pub fn ring(canvas: &mut Canvas, (x, y): Point) {
    let point = |k: u32| (f64::from(k) * std::f64::consts::TAU / 36.0).sin_cos();
    let points: Vec<Point> =
        (0..=36).map(point).map(|(sine, cosine)| (x + 9.0 * cosine, y + 9.0 * sine)).collect();
    canvas.line(&points, INK, 1.8);
}

/// Draws the shape of an arithmetic. Arithmetics that decide alike (textbook and f64) have shapes
/// that differ even if they overlap.
pub fn shape(canvas: &mut Canvas, (x, y): Point, r: f64, arithmetic: &str, colour: Colour) {
    match arithmetic {
        "f32" => canvas.cross(slanted((x, y), r), colour),
        "textbook" => canvas.frame((x - r, y - r), (x + r, y + r), 1.6, colour),
        "f64" => canvas.disc((x, y), r, colour),
        "exact" => {
            let [left, right, top, bottom] = upright((x, y), 1.4 * r);
            canvas.fill(&[top, right, bottom, left], colour);
        }
        _ => canvas.cross(upright((x, y), r), colour),
    }
}

pub struct SmallPanel<'a> {
    pub layout: &'a Layout<'a>,
    pub left: f64,
    pub top: f64,
}

impl SmallPanel<'_> {
    fn right(&self) -> f64 {
        self.left + self.layout.across
    }

    /// Returns top and bottom of the strip for subjects without errors.
    fn field(&self) -> (f64, f64) {
        let top = self.top + SCALE + BREAK;
        (top, top + self.layout.zero)
    }

    pub fn lane(&self, arithmetic: usize) -> f64 {
        self.field().0 + 2.0 + LANE * (arithmetic as f64 + 0.5)
    }

    fn x(&self, time: f64) -> Option<f64> {
        Some(self.left + self.layout.x.place(time)? * self.layout.across)
    }

    fn y(&self, mark: &Mark) -> Option<f64> {
        if mark.rate == 0.0 {
            return Some(self.lane(mark.arithmetic));
        }
        self.scale(mark.rate)
    }

    fn scale(&self, rate: f64) -> Option<f64> {
        Some(self.top + ROOM + (SCALE - 2.0 * ROOM) * (1.0 - self.layout.y.place(rate)?))
    }

    fn at(&self, mark: &Mark) -> Option<Point> {
        Some((self.x(mark.time)?, self.y(mark)?))
    }

    pub fn grid(&self, canvas: &mut Canvas, y_labels: bool, x_labels: bool) {
        let (layout, left, right, field) = (self.layout, self.left, self.right(), self.field());
        canvas.rect((left, field.0), (right, field.1), ZERO);
        for (value, label) in layout.x.ticks(layout.across, 50.0) {
            let Some(x) = self.x(value) else { continue };
            canvas.line(&[(x, self.top), (x, self.top + SCALE)], GRID, 1.0);
            canvas.line(&[(x, field.0), (x, field.1)], (208, 226, 212), 1.0);
            if let Some(label) = label.filter(|_| x_labels) {
                canvas.text(&label, (x, field.1 + 14.0), LABEL.centred());
            }
        }
        for (value, label) in layout.y.ticks(SCALE, 26.0) {
            let Some(y) = self.scale(value) else { continue };
            canvas.line(&[(left, y), (right, y)], GRID, 1.0);
            if label.is_some() && y_labels {
                canvas.text(&format!("{}%", plain(value)), (left - 8.0, y), LABEL.ending());
            }
        }
        canvas.frame((left, self.top), (right, self.top + SCALE), 1.0, FRAME);
        canvas.frame((left, field.0), (right, field.1), 1.0, FRAME);
        if y_labels {
            let zero = (left - 8.0, (field.0 + field.1) / 2.0);
            canvas.text("0", zero, LABEL.of_size(22.0).bold().ending());
            let middle = self.top + SCALE + BREAK / 2.0;
            for y in [middle - 3.0, middle + 3.0] {
                canvas.line(&[(left - 7.0, y + 3.0), (left + 7.0, y - 3.0)], STAIRS, 1.2);
            }
        }
    }

    pub fn marks(&self, canvas: &mut Canvas, panel: &Panel) {
        let right = self.right();
        let (shown, slow): (Vec<&Mark>, Vec<&Mark>) =
            panel.marks.iter().partition(|mark| mark.time <= self.layout.limit);
        self.stairs(canvas, &shown);
        let inside = |x: f64| x.clamp(self.left, right);
        for mark in &shown {
            if let (Some((_, y)), Some(low), Some(high)) =
                (self.at(mark), self.x(mark.low), self.x(mark.high))
            {
                canvas.line(&[(inside(low), y), (inside(high), y)], self.colour(mark), 1.3);
            }
        }
        // The front is drawn last, so that no other mark hides its rings.
        for front in [false, true] {
            for mark in shown.iter().filter(|mark| mark.front == front) {
                let Some(at) = self.at(mark) else { continue };
                if front {
                    ring(canvas, at);
                }
                self.shape(canvas, at, mark);
                // Among answers without errors, only marks on the front show their skin.
                if let Some(skin) = mark.skin.as_ref().filter(|_| front || mark.rate > 0.0) {
                    canvas.text(skin, (at.0, at.1 - 11.0), Text::new(12.0, FAINT).centred());
                }
            }
        }
        for (k, mark) in slow.iter().rev().enumerate() {
            let Some(y) = self.y(mark) else { continue };
            self.shape(canvas, (right - 24.0 - 13.0 * k as f64, y), mark);
            canvas.text("→", (right - 3.0, y), LABEL.ending());
        }
        for (k, (detector, outcome)) in panel.missing.iter().enumerate() {
            let x = right - 10.0 - 17.0 * k as f64;
            if x > self.left + 8.0 {
                let colour = self.layout.about.styles.get(detector).colour;
                canvas.badge((x, self.top + 10.0), letter(*outcome).0, colour);
            }
        }
    }

    fn stairs(&self, canvas: &mut Canvas, shown: &[&Mark]) {
        let mut stairs: Vec<Point> = Vec::new();
        for (x, y) in shown.iter().filter(|mark| mark.front).filter_map(|mark| self.at(mark)) {
            stairs.push((x, stairs.last().map_or(self.top, |last| last.1)));
            stairs.push((x, y));
        }
        stairs.extend(stairs.last().map(|last| (self.right(), last.1)));
        canvas.line(&stairs, STAIRS, 1.5);
    }

    fn shape(&self, canvas: &mut Canvas, at: Point, mark: &Mark) {
        let arithmetic = &self.layout.plot.arithmetics[mark.arithmetic];
        shape(canvas, at, 4.6, arithmetic, self.colour(mark));
    }

    fn colour(&self, mark: &Mark) -> Colour {
        self.layout.about.styles.get(&mark.detector).colour
    }
}
