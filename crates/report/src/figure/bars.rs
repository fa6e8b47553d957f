//! Figures of bars: a panel per scene and N, a bar per contender, as long as its time over that of
//! one of them.

use crate::figure::About;
use crate::figure::axis::Axis;
use crate::figure::canvas::{self, Canvas, MARGIN, Point, Text, width};
use crate::figure::outcome::letter;
use crate::figure::style::{CONTROL, Colour, FAINT, GRID, INK, Styles};
use contactbench_record::cells::{Cell, select};
use contactbench_record::experiment::{Bars, Experiment, Where};
use contactbench_record::findings::ratios::{Entry, Ratios};
use contactbench_record::record::row::Outcome;
use contactbench_record::stats::interval::Interval;
use contactbench_terms::number::{number, times, wrap};

const WIDTH: f64 = 1400.0;
const GAP: f64 = 36.0;
/// Height of a bar with the room around it, and of what stands above and below the bars.
const BAR: f64 = 25.0;
const HEADING: f64 = 34.0;
const SCALE: f64 = 34.0;
/// Room for what is said behind a bar.
const SAID: f64 = 168.0;
const SIZE: f64 = 16.0;

/// The figure as SVG; none if the reference has no time.
pub fn svg(about: &About<'_>, options: &Bars) -> anyhow::Result<Option<String>> {
    let Some(plot) = Plot::new(options, &about.figure.filter, about.cells)? else {
        return Ok(None);
    };
    let sheet = Sheet::new(about.experiment, &about.figure.title, &plot, about.style)?;
    canvas::svg(sheet.size, |canvas| sheet.draw(canvas)).map(Some)
}

pub struct Plot {
    reference: String,
    panels: Vec<Panel>,
}

/// A scene at one N, the fastest first.
struct Panel {
    title: String,
    bars: Vec<Bar>,
}

struct Bar {
    name: String,
    detector: String,
    /// Its time over that of the reference.
    ratio: Option<Interval>,
    outcome: Outcome,
    /// What stands behind the bar.
    said: String,
    is_base: bool,
}

impl Plot {
    /// None where the reference has no time.
    pub fn new(options: &Bars, filter: &Where, cells: &[Cell]) -> anyhow::Result<Option<Plot>> {
        let chosen = select::select(cells, filter)?;
        let Some(found) = Ratios::new(&chosen, &options.to) else { return Ok(None) };
        let mut panels = Vec::new();
        for scene in &found.scenes {
            for (k, &n) in scene.entries.sizes.iter().enumerate() {
                let entries = scene.entries.lines.iter().filter_map(|line| {
                    let entry = line.values.get(k)?.as_ref()?;
                    Bar::new(&line.name, &line.line.detector, entry, n)
                });
                let mut bars: Vec<Bar> = entries.collect();
                bars.sort_by(|a, b| a.length().total_cmp(&b.length()));
                if bars.iter().any(|bar| bar.is_base) {
                    panels.push(Panel { title: format!("{}, N = {n}", scene.entries.title), bars });
                }
            }
        }
        Ok((!panels.is_empty()).then_some(Plot { reference: found.reference, panels }))
    }
}

impl Bar {
    /// None for what is not compared.
    fn new(name: &str, detector: &str, entry: &Entry, n: u64) -> Option<Bar> {
        let per = |time: f64| format!("{} ns", number(time / n.max(1) as f64));
        let said = match (entry.outcome, entry.ratio, entry.time_ns) {
            _ if entry.control => return None,
            (Outcome::Unavailable, ..) => return None,
            (Outcome::Wrong, Some(ratio), _) => format!("{}, wrong", times(ratio.median)),
            (outcome, ..) if !outcome.is_good() => letter(outcome).1.into(),
            (_, _, Some(time)) if entry.is_base => format!("1 = {}", per(time)),
            (_, Some(ratio), Some(time)) => format!("{} = {}", times(ratio.median), per(time)),
            _ => return None,
        };
        Some(Bar {
            name: name.into(),
            detector: detector.into(),
            ratio: entry.ratio,
            outcome: entry.outcome,
            said,
            is_base: entry.is_base,
        })
    }

    /// What has no time comes last, and before it what is wrong.
    fn length(&self) -> f64 {
        match self.ratio {
            Some(ratio) if self.outcome.is_good() => ratio.median,
            Some(_) => f64::MAX,
            None => f64::INFINITY,
        }
    }
}

pub struct Sheet<'a> {
    pub size: (u32, u32),
    title: &'a str,
    subtitle: Vec<String>,
    plot: &'a Plot,
    styles: &'a Styles,
    axis: Axis,
    top: f64,
    names: f64,
    /// Width of a panel, and how many are side by side.
    across: f64,
    columns: usize,
}

impl<'a> Sheet<'a> {
    pub fn new(
        experiment: &Experiment,
        title: &'a str,
        plot: &'a Plot,
        styles: &'a Styles,
    ) -> anyhow::Result<Sheet<'a>> {
        let columns = plot.panels.len().clamp(1, 2);
        let across = (WIDTH - 2.0 * MARGIN + GAP) / columns as f64 - GAP;
        let how = format!(
            "{} Bars: time over that of {}, with its interval; behind them the ratio and the time \
             per particle.",
            experiment.question, plot.reference
        );
        let subtitle = wrap(&how, 150);
        let top = MARGIN + 34.0 + 22.0 * subtitle.len() as f64 + 10.0;
        let bars = || plot.panels.iter().flat_map(|panel| &panel.bars);
        let mut names: f64 = 60.0;
        for bar in bars() {
            names = names.max(width(&bar.name, SIZE, bar.is_base)? + 14.0);
        }
        let ends = bars().filter_map(|bar| bar.ratio).flat_map(|ratio| [ratio.low, ratio.high]);
        let heights = plot.panels.chunks(columns).map(row_height);
        Ok(Sheet {
            size: (WIDTH as u32, (top + heights.sum::<f64>() + MARGIN).min(20_000.0) as u32),
            title,
            subtitle,
            plot,
            styles,
            axis: Axis::new(ends.chain([1.0]), true),
            top,
            names,
            across,
            columns,
        })
    }

    pub fn draw(&self, canvas: &mut Canvas) -> anyhow::Result<()> {
        canvas.heading(self.title, &self.subtitle)?;
        let mut top = self.top;
        for row in self.plot.panels.chunks(self.columns) {
            for (column, panel) in row.iter().enumerate() {
                self.panel(canvas, panel, (MARGIN + column as f64 * (self.across + GAP), top))?;
            }
            top += row_height(row);
        }
        Ok(())
    }

    fn panel(&self, canvas: &mut Canvas, panel: &Panel, (left, top): Point) -> anyhow::Result<()> {
        let (from, room) = (left + self.names, self.across - self.names - SAID);
        let at = |ratio: f64| from + room * self.axis.place(ratio).unwrap_or(0.0).clamp(0.0, 1.0);
        let (first, last) = (top + HEADING, top + HEADING + BAR * panel.bars.len() as f64);
        // Above the bars; a long one begins above the names, or is smaller.
        let wide = width(&panel.title, 19.0, true)?;
        let begin = from.min(left + self.across - wide).max(left);
        let size = 19.0 * (self.across / wide).min(1.0);
        canvas.text(&panel.title, (begin, top + 16.0), Text::new(size, INK).bold())?;
        for (value, label) in self.axis.ticks(room, 60.0) {
            let Some(label) = label else { continue };
            let x = at(value);
            canvas.line(&[(x, first), (x, last)], GRID, 1.0, None)?;
            canvas.text(&label, (x, last + 12.0), Text::new(14.0, FAINT).anchor(0))?;
        }
        for (k, bar) in panel.bars.iter().enumerate() {
            let y = first + BAR * (k as f64 + 0.5);
            let name = Text { bold: bar.is_base, ..Text::new(SIZE, INK).anchor(1) };
            canvas.text(&bar.name, (from - 8.0, y), name)?;
            let colour: Colour = match bar.outcome.is_good() {
                true => self.styles.get(&bar.detector).colour,
                false => CONTROL,
            };
            let mut end = at(1.0);
            if let Some(ratio) = bar.ratio {
                let (low, high) = (at(ratio.median.min(1.0)), at(ratio.median.max(1.0)));
                canvas.rect((low, y - 8.0), (high.max(low + 2.0), y + 8.0), colour)?;
                canvas.line(&[(at(ratio.low), y), (at(ratio.high), y)], INK, 1.0, None)?;
                end = at(ratio.high).max(high);
            }
            canvas.text(&bar.said, (end + 8.0, y), Text::new(SIZE, FAINT))?;
        }
        canvas.line(&[(at(1.0), first), (at(1.0), last)], INK, 1.0, None)
    }
}

/// As high as the highest panel of a row.
fn row_height(row: &[Panel]) -> f64 {
    let most = row.iter().map(|panel| panel.bars.len()).max().unwrap_or(0);
    HEADING + BAR * most as f64 + SCALE
}
