//! Bar charts: a panel per scene and N, and a bar per subject, whose length is its time over that
//! of the reference.

use crate::figure::About;
use crate::figure::axis::Axis;
use crate::figure::canvas::{self, Canvas, HEADING, MARGIN, Point, Text, width};
use crate::figure::style::{CONTROL, FAINT, GRID, INK, Styles, letter};
use contactbench_record::cells::select;
use contactbench_record::experiment::Bars;
use contactbench_record::findings::ratios::{Entry, Ratios};
use contactbench_record::record::row::Outcome;
use contactbench_terms::number::{number, times, wrap};

const WIDTH: f64 = 1400.0;
const GAP: f64 = 36.0;
/// Height of a bar with its margins, then heights above and below the bars of a panel.
const BAR: f64 = 25.0;
const ABOVE: f64 = 34.0;
const BELOW: f64 = 34.0;
/// Width reserved for the numbers beside a bar.
const SAID: f64 = 168.0;
const NAME: Text = Text::new(16.0, INK).ending();

struct Panel<'a> {
    title: String,
    bars: Vec<Bar<'a>>,
}

struct Bar<'a> {
    name: &'a str,
    detector: &'a str,
    entry: &'a Entry,
    said: String,
}

impl<'a> Bar<'a> {
    /// Returns `None` for controls and for subjects without anything to show.
    fn new(name: &'a str, detector: &'a str, entry: &'a Entry, n: u64) -> Option<Bar<'a>> {
        let per = |time: f64| format!("{} ns", number(time / n.max(1) as f64));
        let said = match (entry.outcome, entry.ratio, entry.time_ns) {
            _ if entry.control || entry.outcome == Outcome::Unavailable => return None,
            (Outcome::Wrong, Some(ratio), _) => format!("{}, wrong", times(ratio.median)),
            (outcome, ..) if !outcome.is_good() => letter(outcome).1.into(),
            (_, _, Some(time)) if entry.is_base => format!("1 = {}", per(time)),
            (outcome, Some(ratio), Some(time)) => {
                let lossy = if outcome == Outcome::Lossy { ", lossy" } else { "" };
                format!("{} = {}{lossy}", times(ratio.median), per(time))
            }
            _ => return None,
        };
        Some(Bar { name, detector, entry, said })
    }

    /// Sort key: right answers by ratio, then wrong answers, then subjects without a time.
    fn length(&self) -> f64 {
        match self.entry.ratio {
            Some(ratio) if self.entry.outcome.is_good() => ratio.median,
            Some(_) => f64::MAX,
            None => f64::INFINITY,
        }
    }
}

fn panels(found: &Ratios) -> Vec<Panel<'_>> {
    let mut panels = Vec::new();
    for scene in &found.scenes {
        for (k, &n) in scene.sizes.iter().enumerate() {
            let bars = scene.lines.iter().filter_map(|line| {
                Bar::new(&line.name, &line.line.detector, line.entries.get(k)?.as_ref()?, n)
            });
            let mut bars: Vec<Bar<'_>> = bars.collect();
            bars.sort_by(|a, b| a.length().total_cmp(&b.length()));
            if bars.iter().any(|bar| bar.entry.is_base) {
                panels.push(Panel { title: format!("{}, N = {n}", scene.title), bars });
            }
        }
    }
    panels
}

/// Returns the figure as SVG; `None` if the reference has no time.
pub fn svg(about: &About<'_>, options: &Bars) -> anyhow::Result<Option<String>> {
    let chosen = select::select(about.cells, &about.figure.filter);
    let Some(found) = Ratios::new(&chosen, &options.to) else { return Ok(None) };
    let panels = panels(&found);
    if panels.is_empty() {
        return Ok(None);
    }
    let columns = panels.len().min(2);
    let how = format!(
        "{} Each bar is a time over that of {}, with its interval; beside it stand that ratio and \
         the time per particle.",
        about.experiment.question, found.reference
    );
    let subtitle = wrap(&how, 150);
    let mut top = MARGIN + 34.0 + 22.0 * subtitle.len() as f64 + 10.0;
    let bars = || panels.iter().flat_map(|panel| &panel.bars);
    let names = bars().map(|bar| width(bar.name, 16.0, bar.entry.is_base) + 14.0);
    let ends = bars().filter_map(|bar| bar.entry.ratio).flat_map(|ratio| [ratio.low, ratio.high]);
    let layout = Layout {
        styles: about.styles,
        axis: Axis::new(ends.chain([1.0]), true),
        names: names.fold(60.0, f64::max),
        across: (WIDTH - 2.0 * MARGIN + GAP) / columns as f64 - GAP,
    };
    let height = top + panels.chunks(columns).map(row_height).sum::<f64>() + MARGIN;
    Ok(Some(canvas::svg([WIDTH, height.min(20_000.0)], |canvas| {
        canvas.heading(&about.figure.title, &subtitle);
        for row in panels.chunks(columns) {
            for (column, panel) in row.iter().enumerate() {
                let left = MARGIN + column as f64 * (layout.across + GAP);
                layout.panel(canvas, panel, (left, top));
            }
            top += row_height(row);
        }
    })))
}

struct Layout<'a> {
    styles: &'a Styles,
    axis: Axis,
    /// Width reserved for names, then width of a panel.
    names: f64,
    across: f64,
}

impl Layout<'_> {
    fn panel(&self, canvas: &mut Canvas, panel: &Panel<'_>, (left, top): Point) {
        let (from, room) = (left + self.names, self.across - self.names - SAID);
        let at = |ratio: f64| from + room * self.axis.place(ratio).unwrap_or(0.0).clamp(0.0, 1.0);
        let (first, last) = (top + ABOVE, top + ABOVE + BAR * panel.bars.len() as f64);
        // A long title begins above the names, or has a smaller font.
        let wide = width(&panel.title, 19.0, true);
        let begin = from.min(left + self.across - wide).max(left);
        let title = HEADING.of_size(19.0 * (self.across / wide).min(1.0));
        canvas.text(&panel.title, (begin, top + 16.0), title);
        for (value, label) in self.axis.ticks(room, 60.0) {
            let Some(label) = label else { continue };
            let x = at(value);
            canvas.line(&[(x, first), (x, last)], GRID, 1.0);
            canvas.text(&label, (x, last + 12.0), Text::new(14.0, FAINT).centred());
        }
        for (k, bar) in panel.bars.iter().enumerate() {
            let y = first + BAR * (k as f64 + 0.5);
            canvas.text(bar.name, (from - 8.0, y), NAME.bold_if(bar.entry.is_base));
            let colour = match bar.entry.outcome.is_good() {
                true => self.styles.get(bar.detector).colour,
                false => CONTROL,
            };
            let mut end = at(1.0);
            if let Some(ratio) = bar.entry.ratio {
                let (low, high) = (at(ratio.median.min(1.0)), at(ratio.median.max(1.0)));
                canvas.rect((low, y - 8.0), (high.max(low + 2.0), y + 8.0), colour);
                canvas.line(&[(at(ratio.low), y), (at(ratio.high), y)], INK, 1.0);
                end = at(ratio.high).max(high);
            }
            canvas.text(&bar.said, (end + 8.0, y), Text::new(16.0, FAINT));
        }
        canvas.line(&[(at(1.0), first), (at(1.0), last)], INK, 1.0);
    }
}

fn row_height(row: &[Panel<'_>]) -> f64 {
    let most = row.iter().map(|panel| panel.bars.len()).max().unwrap_or(0);
    ABOVE + BAR * most as f64 + BELOW
}
