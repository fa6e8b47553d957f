//! The sheet: heading, a grid of panels (a row per dimension, a column per scene) that share their
//! axes, and the legend beside them.

use crate::figure::axis::Axis;
use crate::figure::canvas::{Canvas, MARGIN, Text, width};
use crate::figure::lines::data::{CurveKey, Plot};
use crate::figure::lines::panel::{self, Area, ROW, Shared, dash_of};
use crate::figure::outcome::{badge, letter};
use crate::figure::style::{CACHE, CACHE_NAME, FAINT, INK, Styles};
use contactbench_record::cells::label;
use contactbench_record::cells::machine::Machine;
use contactbench_record::experiment::{Experiment, Lines};
use contactbench_terms::number::wrap;

const WIDTH: f64 = 1400.0;
const LEFT: f64 = 92.0;
const GAP: f64 = 16.0;
const HEADING: f64 = 24.0;

pub struct Sheet<'a> {
    pub size: (u32, u32),
    title: &'a str,
    options: &'a Lines,
    plot: &'a Plot,
    styles: &'a Styles,
    subtitle: Vec<String>,
    columns: usize,
    rows: usize,
    legend: f64,
    top: f64,
    gap: f64,
    panel: (f64, f64),
    shared: Shared,
}

/// `48 KiB`, `2 MiB`.
fn binary(bytes: u64) -> String {
    if bytes >= 1 << 20 { format!("{} MiB", bytes >> 20) } else { format!("{} KiB", bytes >> 10) }
}

/// The names of lines in the legend.
fn namer(plot: &Plot) -> impl Fn(&CurveKey) -> String {
    let brief = label::brief(plot.keys().into_iter().map(|key| key.detector.as_str()));
    move |key| {
        let name = brief(&key.detector);
        if key.variant.is_empty() { name } else { format!("{name}, {}", key.variant) }
    }
}

impl<'a> Sheet<'a> {
    pub fn new(
        experiment: &Experiment,
        title: &'a str,
        options: &'a Lines,
        plot: &'a Plot,
        styles: &'a Styles,
        machine: &Machine,
    ) -> anyhow::Result<Sheet<'a>> {
        let dims: std::collections::BTreeSet<u32> =
            plot.panels.iter().map(|panel| panel.dim).collect();
        let mut scenes: Vec<&str> = plot.panels.iter().map(|panel| panel.scene.as_str()).collect();
        scenes.sort_unstable();
        scenes.dedup();
        let count = plot.panels.len();
        // a full grid keeps its columns; a long or ragged list is wrapped
        let columns = if scenes.len() <= 4 && count == scenes.len() * dims.len() {
            scenes.len()
        } else {
            count.min(3)
        };
        let rows = count.div_ceil(columns.max(1));
        let mut names = 150.0_f64;
        let named = namer(plot);
        for key in plot.keys() {
            names = names.max(width(&named(key), 18.0, false)?);
        }
        let slopes = options.slopes;
        // the names of the slopes stand between the panels, where no line can cross them
        let gap = if slopes { 58.0 } else { GAP };
        let legend = names + 70.0 + gap - GAP;
        let mut subtitle = wrap(&experiment.question, 150);
        if subtitle.len() > 3 {
            subtitle.truncate(3);
            subtitle[2] += " …";
        }
        let top = MARGIN + 34.0 + 22.0 * subtitle.len() as f64 + 12.0;
        let across =
            (WIDTH - 2.0 * MARGIN - LEFT - legend - gap * (columns as f64 - 1.0)) / columns as f64;
        let strip = plot
            .panels
            .iter()
            .map(|panel| panel.lines.values().filter(|line| !line.marks.is_empty()).count())
            .max()
            .unwrap_or(0);
        let strip = if strip == 0 { 0.0 } else { ROW * strip as f64 + 4.0 };
        let down = (if rows == 1 {
            (0.75 * across).clamp(380.0, 520.0)
        } else {
            across.clamp(270.0, 340.0)
        }) + strip;
        let height = top + rows as f64 * (down + HEADING) + (rows as f64 - 1.0) * GAP + 76.0;
        let zero = options.log && plot.points().any(|point| point.y <= 0.0);
        let ys = plot.points().flat_map(|point| [point.y, point.low, point.high]);
        let shared = Shared {
            x: Axis::new(plot.xs(), options.log),
            y: Axis::new(ys, options.log),
            strip,
            zero: if zero { 22.0 } else { 0.0 },
            slopes,
            per_particle: options.per_particle,
            caches: if options.caches { machine.caches.clone() } else { Vec::new() },
        };
        let lines = plot.keys().len() + plot.outcomes().len() + shared.caches.len();
        let height = height.max(top + 26.0 * lines as f64 + 190.0);
        let size = (WIDTH as u32, height.clamp(300.0, 8000.0) as u32);
        Ok(Sheet {
            size,
            title,
            options,
            plot,
            styles,
            subtitle,
            columns,
            rows,
            legend,
            top,
            gap,
            panel: (across, down),
            shared,
        })
    }

    pub fn draw(&self, canvas: &mut Canvas) -> anyhow::Result<()> {
        canvas.heading(self.title, &self.subtitle)?;
        for (k, panel) in self.plot.panels.iter().enumerate() {
            let (row, column) = (k / self.columns, k % self.columns);
            let left = MARGIN + LEFT + column as f64 * (self.panel.0 + self.gap);
            let top = self.top + HEADING + row as f64 * (self.panel.1 + HEADING + GAP);
            let area = Area {
                low: (left, top),
                high: (left + self.panel.0, top + self.panel.1),
                y_labels: column == 0,
                x_labels: k + self.columns >= self.plot.panels.len(),
            };
            let heading = format!("{}, {}D", panel.scene, panel.dim);
            // Smaller where it would run into its neighbour.
            let fits = (self.panel.0 - 2.0) / width(&heading, 19.0, true)?;
            let text = Text::new(19.0 * fits.min(1.0), INK).bold();
            canvas.text(&heading, (left + 2.0, top - 13.0), text)?;
            area.draw(canvas, panel, &self.shared, self.styles)?;
        }
        let bottom =
            self.top + self.rows as f64 * (self.panel.1 + HEADING) + (self.rows as f64 - 1.0) * GAP;
        let centre = MARGIN + LEFT + (WIDTH - 2.0 * MARGIN - LEFT - self.legend) / 2.0;
        canvas.text(
            &self.options.x_label,
            (centre, bottom + 50.0),
            Text::new(19.0, INK).anchor(0),
        )?;
        let upright = Text { upright: true, ..Text::new(19.0, INK).anchor(0) };
        canvas.text(
            &self.options.y_label,
            (MARGIN + 10.0, (self.top + HEADING + bottom) / 2.0),
            upright,
        )?;
        self.legend(canvas)
    }

    fn legend(&self, canvas: &mut Canvas) -> anyhow::Result<()> {
        let (left, mut y) =
            (WIDTH - MARGIN - self.legend + 22.0 + self.gap - GAP, self.top + HEADING + 12.0);
        let named = namer(self.plot);
        for key in self.plot.keys() {
            let style = self.styles.get(&key.detector);
            let (line_width, dash) = dash_of(style, key);
            canvas.line(&[(left, y), (left + 36.0, y)], style.colour, line_width, dash)?;
            canvas.marker(
                (left + 18.0, y),
                if style.control { 3.0 } else { 5.0 },
                style.marker,
                style.colour,
            )?;
            let colour = if style.control { FAINT } else { INK };
            canvas.text(&named(key), (left + 46.0, y), Text::new(18.0, colour))?;
            y += 26.0;
        }
        let outcomes = self.plot.outcomes();
        if !outcomes.is_empty() {
            y += 14.0;
            canvas.text("no value, because:", (left, y), Text::new(16.0, FAINT))?;
            y += 24.0;
            for outcome in outcomes {
                let (letter, words) = letter(outcome);
                badge(canvas, (left + 18.0, y), letter, INK)?;
                canvas.text(words, (left + 46.0, y), Text::new(17.0, INK))?;
                y += 24.0;
            }
        }
        let bars = if self.plot.over_seeds {
            Some("bars: range over seeds")
        } else {
            Some("bars: 95% interval")
        };
        let visible = self.plot.points().any(|point| point.high > point.low);
        let slopes = self.shared.slopes.then_some("dashed: cost N, N log N, N²");
        let parallel =
            self.plot.keys().iter().any(|key| key.parallel).then_some("dashed: several threads");
        y += 14.0;
        for words in [bars.filter(|_| visible), slopes, parallel].into_iter().flatten() {
            canvas.text(words, (left, y), Text::new(16.0, FAINT))?;
            y += 22.0;
        }
        if !self.shared.caches.is_empty() {
            canvas.line(
                &[(left + 4.0, y - 8.0), (left + 4.0, y + 10.0)],
                CACHE,
                2.0,
                Some((2.0, 3.0)),
            )?;
            canvas.text("coordinates larger than", (left + 14.0, y), Text::new(16.0, FAINT))?;
            y += 20.0;
            for (name, bytes) in &self.shared.caches {
                // The lines of panels in other dimensions lie elsewhere.
                let within = |dim: u32| {
                    self.shared
                        .x
                        .place(panel::outgrown(*bytes, dim))
                        .is_some_and(|place| place < 1.0)
                };
                let beyond = if self.plot.panels.iter().any(|panel| within(panel.dim)) {
                    ""
                } else {
                    ": no scene"
                };
                canvas.text(
                    &format!("{name} ({}){beyond}", binary(*bytes)),
                    (left + 14.0, y),
                    Text::new(16.0, CACHE_NAME),
                )?;
                y += 20.0;
            }
        }
        Ok(())
    }
}
