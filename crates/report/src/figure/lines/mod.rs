//! Line charts: a grid of panels with common axes (a row per dimension, a column per scene), and a
//! legend beside them.

mod data;
mod panel;

use std::collections::BTreeSet;

use crate::figure::About;
use crate::figure::axis::Axis;
use crate::figure::canvas::{self, AXIS, Canvas, HEADING, MARGIN, Text, width};
use crate::figure::style::{CACHE, CACHE_NAME, FAINT, INK, letter};
use contactbench_record::cells::label;
use contactbench_record::experiment::Lines;
use contactbench_terms::number::wrap;
use data::{CurveKey, Plot};
use panel::{Area, ROW, Shared, dash_of, outgrown};

const WIDTH: f64 = 1400.0;
const LEFT: f64 = 92.0;
const GAP: f64 = 16.0;
const HEAD: f64 = 24.0;
const NOTE: Text = Text::new(16.0, FAINT);

struct Layout<'a> {
    about: &'a About<'a>,
    options: &'a Lines,
    plot: &'a Plot,
    subtitle: Vec<String>,
    columns: usize,
    legend: f64,
    gap: f64,
    top: f64,
    bottom: f64,
    panel: (f64, f64),
    shared: Shared<'a>,
}

pub fn svg(about: &About<'_>, options: &Lines) -> anyhow::Result<Option<String>> {
    let Some(plot) = Plot::new(about, options)? else { return Ok(None) };
    let layout = Layout::new(about, options, &plot);
    let lines = plot.keys().len() + plot.outcomes().len() + layout.shared.caches.len();
    let height = (layout.bottom + 76.0).max(layout.top + 26.0 * lines as f64 + 190.0);
    Ok(Some(canvas::svg([WIDTH, height.clamp(300.0, 8000.0)], |canvas| layout.draw(canvas))))
}

/// Formats a size such as `48 KiB` or `2 MiB`.
fn binary(bytes: u64) -> String {
    if bytes >= 1 << 20 { format!("{} MiB", bytes >> 20) } else { format!("{} KiB", bytes >> 10) }
}

fn namer(plot: &Plot) -> impl Fn(&CurveKey) -> String {
    let brief = label::brief(plot.keys().into_iter().map(|key| key.detector.as_str()));
    move |key| {
        let name = brief(&key.detector);
        if key.variant.is_empty() { name } else { format!("{name}, {}", key.variant) }
    }
}

impl<'a> Layout<'a> {
    fn new(about: &'a About<'_>, options: &'a Lines, plot: &'a Plot) -> Layout<'a> {
        let dims: BTreeSet<u32> = plot.panels.iter().map(|panel| panel.dim).collect();
        let scenes: BTreeSet<&str> = plot.panels.iter().map(|panel| &*panel.scene).collect();
        let count = plot.panels.len();
        // A full grid keeps one column per scene; other panels are wrapped into rows.
        let full = scenes.len() <= 4 && count == scenes.len() * dims.len();
        let columns = if full { scenes.len() } else { count.min(3) };
        let rows = count.div_ceil(columns.max(1)) as f64;
        let named = namer(plot);
        let names = plot.keys().into_iter().map(|key| width(&named(key), 18.0, false));
        // The names of the slopes are written between the panels, where no line crosses them.
        let gap = if options.slopes { 58.0 } else { GAP };
        let legend = names.fold(150.0, f64::max) + 70.0 + gap - GAP;
        let mut subtitle = wrap(&about.experiment.question, 150);
        if subtitle.len() > 3 {
            subtitle.truncate(3);
            subtitle[2] += " …";
        }
        let top = MARGIN + 34.0 + 22.0 * subtitle.len() as f64 + 12.0;
        let across =
            (WIDTH - 2.0 * MARGIN - LEFT - legend - gap * (columns as f64 - 1.0)) / columns as f64;
        let marked = plot
            .panels
            .iter()
            .map(|panel| panel.lines.values().filter(|line| !line.marks.is_empty()).count() as f64);
        let strip = marked.fold(0.0, f64::max);
        let strip = if strip == 0.0 { 0.0 } else { ROW * strip + 4.0 };
        let down = match rows {
            1.0 => (0.75 * across).clamp(380.0, 520.0),
            _ => across.clamp(270.0, 340.0),
        } + strip;
        let zero = options.log && plot.points().any(|point| point.y <= 0.0);
        let ys = plot.points().flat_map(|point| [point.y, point.low, point.high]);
        let shared = Shared {
            styles: about.styles,
            x: Axis::new(plot.xs(), options.log),
            y: Axis::new(ys, options.log),
            strip,
            zero: if zero { 22.0 } else { 0.0 },
            slopes: options.slopes,
            per_particle: options.per_particle,
            caches: if options.caches { about.caches } else { &[] },
        };
        let bottom = top + rows * (down + HEAD) + (rows - 1.0) * GAP;
        let panel = (across, down);
        Layout { about, options, plot, subtitle, columns, legend, gap, top, bottom, panel, shared }
    }

    fn draw(&self, canvas: &mut Canvas) {
        canvas.heading(&self.about.figure.title, &self.subtitle);
        let ((across, down), panels) = (self.panel, &self.plot.panels);
        for (k, panel) in panels.iter().enumerate() {
            let (row, column) = (k / self.columns, k % self.columns);
            let left = MARGIN + LEFT + column as f64 * (across + self.gap);
            let top = self.top + HEAD + row as f64 * (down + HEAD + GAP);
            let heading = format!("{}, {}D", panel.scene, panel.dim);
            // A heading that would reach the next panel has a smaller font.
            let fits = (across - 2.0) / width(&heading, 19.0, true);
            canvas.text(&heading, (left + 2.0, top - 13.0), HEADING.of_size(19.0 * fits.min(1.0)));
            let area = Area {
                shared: &self.shared,
                low: (left, top),
                high: (left + across, top + down),
                y_labels: column == 0,
                x_labels: k + self.columns >= panels.len(),
            };
            area.draw(canvas, panel);
        }
        let centre = MARGIN + LEFT + (WIDTH - 2.0 * MARGIN - LEFT - self.legend) / 2.0;
        canvas.text(&self.options.x_label, (centre, self.bottom + 50.0), AXIS);
        let middle = (self.top + HEAD + self.bottom) / 2.0;
        canvas.text(&self.options.y_label, (MARGIN + 10.0, middle), AXIS.upright());
        self.legend(canvas);
    }

    fn legend(&self, canvas: &mut Canvas) {
        let left = WIDTH - MARGIN - self.legend + 22.0 + self.gap - GAP;
        let mut y = self.top + HEAD + 12.0;
        let named = namer(self.plot);
        for key in self.plot.keys() {
            let style = self.about.styles.get(&key.detector);
            let (line_width, dash) = dash_of(style, key);
            canvas.dashed(&[(left, y), (left + 36.0, y)], style.colour, line_width, dash);
            let (size, ink) = if style.control { (3.0, FAINT) } else { (5.0, INK) };
            canvas.marker((left + 18.0, y), size, style.marker, style.colour);
            canvas.text(&named(key), (left + 46.0, y), Text::new(18.0, ink));
            y += 26.0;
        }
        let outcomes = self.plot.outcomes();
        if !outcomes.is_empty() {
            y += 14.0;
            canvas.text("no value, because:", (left, y), NOTE);
            y += 24.0;
        }
        for (letter, words) in outcomes.into_iter().map(letter) {
            canvas.badge((left + 18.0, y), letter, INK);
            canvas.text(words, (left + 46.0, y), Text::new(17.0, INK));
            y += 24.0;
        }
        let bars = match self.plot.over_seeds {
            true => "bars: range over seeds",
            false => "bars: 95% interval",
        };
        y += 14.0;
        for (shown, words) in [
            (self.plot.points().any(|point| point.high > point.low), bars),
            (self.plot.points().any(|point| point.lossy), "hollow: missed contacts"),
            (self.shared.slopes, "dashed: costs of N, N log N, N²"),
            (self.plot.keys().iter().any(|key| key.parallel), "dashed: several threads"),
        ] {
            if shown {
                canvas.text(words, (left, y), NOTE);
                y += 22.0;
            }
        }
        self.caches(canvas, left, y);
    }

    fn caches(&self, canvas: &mut Canvas, left: f64, mut y: f64) {
        if self.shared.caches.is_empty() {
            return;
        }
        let line = [(left + 4.0, y - 8.0), (left + 4.0, y + 10.0)];
        canvas.dashed(&line, CACHE, 2.0, Some("2 3"));
        canvas.text("coordinates larger than", (left + 14.0, y), NOTE);
        for (name, bytes) in self.shared.caches {
            y += 20.0;
            // The line of a cache is at another x in panels of another dimension.
            let place = |dim: u32| self.shared.x.place(outgrown(*bytes, dim));
            let within = |dim: u32| place(dim).is_some_and(|place| place < 1.0);
            let seen = self.plot.panels.iter().any(|panel| within(panel.dim));
            let words =
                format!("{name} ({}){}", binary(*bytes), if seen { "" } else { ": no scene" });
            canvas.text(&words, (left + 14.0, y), Text::new(16.0, CACHE_NAME));
        }
    }
}
