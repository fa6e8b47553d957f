//! One panel: grid, reference slopes, lines with bars, and a strip at the top edge that marks cells
//! without a value.

use crate::figure::axis::Axis;
use crate::figure::canvas::{Canvas, Dash, Point, Text, width};
use crate::figure::lines::data::{Curve, CurveKey, Panel};
use crate::figure::style::{
    CACHE, CACHE_NAME, FAINT, FRAME, GRID, INK, STRIP, Style, Styles, WHITE, letter,
};
use contactbench_record::stats::growth::Model;

/// Height of one row of marks in the strip.
pub const ROW: f64 = 17.0;
const LABEL: Text = Text::new(17.0, INK);
const SLOPE: Text = Text::new(15.0, FAINT);

pub struct Shared<'a> {
    pub styles: &'a Styles,
    pub x: Axis,
    pub y: Axis,
    /// Height of the strip at the top; 0 without marks.
    pub strip: f64,
    /// Height of the band at the bottom for zeros, which a logarithmic axis cannot show; 0 without
    /// zeros.
    pub zero: f64,
    pub slopes: bool,
    /// True if the reference slopes are drawn per particle, as the data are.
    pub per_particle: bool,
    /// Name and bytes of each cache to be marked; empty unless x is the number of particles.
    pub caches: &'a [(String, u64)],
}

pub struct Area<'a> {
    pub shared: &'a Shared<'a>,
    pub low: Point,
    pub high: Point,
    pub y_labels: bool,
    pub x_labels: bool,
}

/// Returns the width and the dashes of a line. Controls are thin. Lines of several threads are
/// dashed, and so are f32 and f64 if the figure compares arithmetics.
pub fn dash_of(style: Style, key: &CurveKey) -> (f64, Option<Dash>) {
    match &*key.variant {
        _ if style.control => (1.0, Some("5 4")),
        _ if key.parallel => (2.0, Some("6 5")),
        v if v.starts_with("f32") => (2.0, Some("3 4")),
        v if v.starts_with("f64") => (2.0, Some("10 4")),
        _ => (2.0, None),
    }
}

/// Returns the number of particles whose coordinates, of eight bytes each, fill this many bytes.
pub fn outgrown(bytes: u64, dim: u32) -> f64 {
    bytes as f64 / (8.0 * f64::from(dim.max(1)))
}

impl Area<'_> {
    pub fn draw(&self, canvas: &mut Canvas, panel: &Panel) {
        let styles = self.shared.styles;
        self.grid(canvas);
        self.caches(canvas, panel.dim);
        if self.shared.slopes {
            self.slopes(canvas, panel);
        }
        // Controls are drawn first, and so lie behind the detectors.
        let mut lines: Vec<_> = panel.lines.iter().collect();
        lines.sort_by_key(|(key, _)| std::cmp::Reverse(styles.get(&key.detector).control));
        for (key, line) in lines {
            self.line(canvas, line, key);
        }
        canvas.frame(self.low, self.high, 1.0, FRAME);
        let marked = panel.lines.iter().filter(|(_, line)| !line.marks.is_empty());
        for (row, (key, line)) in marked.enumerate() {
            let y = self.low.1 + 2.0 + ROW * (row as f64 + 0.5);
            for &(x, outcome) in &line.marks {
                if let Some(x) = self.x(x) {
                    canvas.badge((x, y), letter(outcome).0, styles.get(&key.detector).colour);
                }
            }
        }
    }

    fn x(&self, value: f64) -> Option<f64> {
        Some(self.low.0 + self.shared.x.place(value)? * (self.high.0 - self.low.0))
    }

    /// Returns the y of the strip's lower edge and of the bottom of the scale.
    fn scale(&self) -> (f64, f64) {
        (self.low.1 + self.shared.strip, self.high.1 - self.shared.zero)
    }

    fn y(&self, value: f64) -> Option<f64> {
        if self.shared.zero > 0.0 && value <= 0.0 {
            return Some(self.high.1 - self.shared.zero / 2.0);
        }
        let (top, bottom) = self.scale();
        Some(bottom - self.shared.y.place(value)? * (bottom - top))
    }

    fn grid(&self, canvas: &mut Canvas) {
        let (shared, (left, right)) = (self.shared, (self.low.0, self.high.0));
        let (top, bottom) = self.scale();
        if shared.strip > 0.0 {
            canvas.rect(self.low, (right, top), STRIP);
            canvas.line(&[(left, top), (right, top)], FRAME, 1.0);
        }
        if shared.zero > 0.0 {
            canvas.rect((left, bottom), self.high, STRIP);
            if self.y_labels {
                let at = (left - 8.0, self.high.1 - shared.zero / 2.0);
                canvas.text("0", at, LABEL.ending());
            }
        }
        for (value, label) in shared.x.ticks(right - left, 58.0) {
            let Some(x) = self.x(value) else { continue };
            canvas.line(&[(x, top), (x, self.high.1)], GRID, 1.0);
            if let Some(label) = label.filter(|_| self.x_labels) {
                canvas.text(&label, (x, self.high.1 + 16.0), LABEL.centred());
            }
        }
        for (value, label) in shared.y.ticks(bottom - top, 30.0) {
            let Some(y) = self.y(value) else { continue };
            canvas.line(&[(left, y), (right, y)], GRID, 1.0);
            if let Some(label) = label.filter(|_| self.y_labels) {
                canvas.text(&label, (left - 8.0, y), LABEL.ending());
            }
        }
    }

    /// Draws a light line where the coordinates alone outgrow a cache, with its name at the foot.
    fn caches(&self, canvas: &mut Canvas, dim: u32) {
        let (top, bottom) = self.scale();
        let inside = self.low.0 + 2.0..self.high.0 - 2.0;
        for (name, bytes) in self.shared.caches {
            let x = self.x(outgrown(*bytes, dim)).filter(|x| inside.contains(x));
            let Some(x) = x else { continue };
            canvas.dashed(&[(x, top), (x, bottom)], CACHE, 2.0, Some("2 3"));
            let (words, text) = (format!("> {name}"), Text::new(15.0, CACHE_NAME).bold());
            // The name is left of the line if it would leave the panel on the right.
            let right = x + 6.0 + width(&words, 15.0, true) < self.high.0;
            let (at, text) = if right { (x + 5.0, text) } else { (x - 5.0, text.ending()) };
            canvas.text(&words, (at, bottom - 11.0), text);
        }
    }

    /// Draws costs of N, N log N and N². They begin a little below the lowest first point of all
    /// detectors, so that they do not hide the data. Per particle, the cost N is a horizontal line
    /// at the bottom.
    fn slopes(&self, canvas: &mut Canvas, panel: &Panel) {
        let shared = self.shared;
        let lines = panel.lines.iter().filter(|(key, _)| !shared.styles.get(&key.detector).control);
        let firsts = lines.filter_map(|(_, line)| {
            line.points.iter().find(|point| point.y > 0.0 && point.x >= 2.0)
        });
        let first = firsts.min_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        let Some(first) = first else { return };
        let ((top, bottom), mut last) = (self.scale(), f64::NEG_INFINITY);
        let start = shared.x.place(first.x).unwrap_or(0.0);
        for (model, name) in
            [(Model::Quadratic, "N²"), (Model::Linearithmic, "N log N"), (Model::Linear, "N")]
        {
            let cost = |x: f64| {
                let growth = model.at(x) / model.at(first.x);
                first.y * if shared.per_particle { growth * first.x / x } else { 0.5 * growth }
            };
            let at = |step: u32| {
                let place = start + (1.0 - start) * f64::from(step) / 30.0;
                let x = self.low.0 + place * (self.high.0 - self.low.0);
                Some((x, self.y(cost(shared.x.value(place)))?))
            };
            let path = (0..=30).map_while(at).take_while(|at| at.1 >= top);
            let path: Vec<Point> = path.filter(|at| at.1 <= bottom).collect();
            canvas.dashed(&path, (175, 175, 175), 1.0, Some("6 5"));
            match path.last().filter(|_| path.len() > 1) {
                Some(&(x, y)) if x < self.high.0 - 1.0 => {
                    canvas.text(name, (x + 7.0, y.max(top + 9.0)), SLOPE);
                }
                // Names beside the panel must not overlap.
                Some(&(_, y)) => {
                    last = y.max(last + 14.0);
                    canvas.text(name, (self.high.0 + 4.0, last), SLOPE);
                }
                None => {}
            }
        }
    }

    fn line(&self, canvas: &mut Canvas, curve: &Curve, key: &CurveKey) {
        let style = self.shared.styles.get(&key.detector);
        let (width, dash) = dash_of(style, key);
        let at = |x: f64, y: f64| Some((self.x(x)?, self.y(y)?));
        // A mark between two points breaks the line, because no value was measured there.
        let broken = |a: f64, b: f64| curve.marks.iter().any(|mark| mark.0 > a && mark.0 < b);
        for piece in curve.points.chunk_by(|a, b| !broken(a.x, b.x)) {
            let path: Vec<Point> = piece.iter().filter_map(|point| at(point.x, point.y)).collect();
            canvas.dashed(&path, style.colour, width, dash);
        }
        for point in &curve.points {
            if let (Some(low), Some(high)) = (at(point.x, point.low), at(point.x, point.high))
                && low.1 - high.1 > 1.0
            {
                canvas.line(&[low, high], style.colour, 2.0);
            }
            if let Some(at) = at(point.x, point.y) {
                let size = if style.control { 2.5 } else { 4.5 };
                canvas.marker(at, size, style.marker, style.colour);
                if point.lossy {
                    canvas.marker(at, 1.5, style.marker, WHITE);
                }
            }
        }
    }
}
