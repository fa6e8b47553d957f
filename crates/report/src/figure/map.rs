//! Maps: a panel per scene, and a tile for each x and y. A tile names the fastest detector and the
//! ratio of the runner-up's time to its time. Each detector has a colour, deeper for a larger lead.
//! Undecided tiles are striped; a line separates tiles with different fastest detectors.

use std::collections::BTreeMap;

use crate::figure::About;
use crate::figure::canvas::{self, Canvas, HEADING, MARGIN, Point, Text, width};
use crate::figure::style::{Colour, FAINT, GRID, INK, STRIP, Styles, WHITE, ink_on, lightened};
use crate::sections::map::either;
use contactbench_record::cells::select;
use contactbench_record::experiment::MapAxes;
use contactbench_record::findings::map::{Answer, Map, Panel, STEPS, Spot};
use contactbench_terms::number::{times, wrap};

const WIDTH: (f64, f64) = (1400.0, 760.0);
/// Height of a tile, then its width for short and for long names.
const HIGH: f64 = 64.0;
const WIDE: (f64, f64) = (112.0, 164.0);
const ROOM: f64 = 18.0;
const GAP: f64 = 30.0;
const ABOVE: f64 = 34.0;
const BELOW: f64 = 56.0;
const STRIPE: f64 = 14.0;
const SIZE: f64 = 15.0;
const VALUE: Text = Text::new(SIZE, INK);
const NOTE: Text = Text::new(SIZE, FAINT);
const AXIS: Text = Text::new(16.0, FAINT).centred();

/// Share of white in a detector's colour, by its lead: below all [`STEPS`], then from each step on.
const WHITENESS: [f64; STEPS.len() + 1] = [0.72, 0.5, 0.25, 0.0];

/// Returns the figure as SVG; `None` if no cell has a time.
pub fn svg(about: &About<'_>, axes: &MapAxes) -> anyhow::Result<Option<String>> {
    let About { figure, cells, .. } = about;
    if select::select(cells, &figure.filter)?.iter().all(|cell| cell.time().is_none()) {
        return Ok(None);
    }
    let found = Map::new(axes, &figure.filter, cells)?;
    Ok(Some(drawn(&figure.title, axes, &found, about.styles)))
}

pub fn drawn(title: &str, axes: &MapAxes, map: &Map, styles: &Styles) -> String {
    let values = map.axes[1].values.iter().map(|value| width(value, SIZE, false) + 44.0);
    let left = values.fold(40.0, f64::max);
    let names = map.subjects.iter().map(|name| width(name, SIZE, true) + ROOM);
    let tile = names.fold(WIDE.0, f64::max).min(WIDE.1);
    let panels = map.panels.iter().map(|panel| {
        let tiles = tile * panel.values(0).len() as f64;
        left + tiles.max(width(&panel.title, 19.0, true))
    });
    let across = panels.fold(0.0, f64::max);
    let fit = ((WIDTH.0 - 2.0 * MARGIN + GAP) / (across + GAP)).floor().max(1.0);
    let columns = (fit as usize).min(map.panels.len()).max(1);
    let whole = 2.0 * MARGIN + columns as f64 * (across + GAP) - GAP;
    let whole = whole.max(WIDTH.1);
    let how = "Each tile names the fastest detector. The number is the time of the runner-up over \
               its own, with the interval of that ratio. Striped: undecided.";
    let title = wrap(title, (whole / 16.0) as usize);
    let subtitle = wrap(how, (whole / 9.3) as usize);
    let lines = 34.0 * title.len() as f64 + 22.0 * subtitle.len() as f64;
    let mut top = MARGIN + lines + 62.0;
    let height = top + map.panels.chunks(columns).map(row_height).sum::<f64>() + MARGIN - 10.0;
    let colours = map.subjects.iter().map(String::as_str).zip(styles.of_map(&map.subjects));
    let sheet = Sheet { labels: axes.labels(), map, colours: colours.collect(), left, tile };
    canvas::svg([whole, height].map(|it| it.min(20_000.0)), |canvas| {
        let mut y = MARGIN + 12.0;
        for line in &title {
            canvas.text(line, (MARGIN, y), Text::new(29.0, INK).bold());
            y += 34.0;
        }
        for line in &subtitle {
            canvas.text(line, (MARGIN, y - 4.0), Text::new(18.0, FAINT));
            y += 22.0;
        }
        legend(canvas, y + 12.0);
        for row in map.panels.chunks(columns) {
            for (column, panel) in row.iter().enumerate() {
                sheet.panel(canvas, panel, (MARGIN + column as f64 * (across + GAP), top));
            }
            top += row_height(row);
        }
    })
}

fn legend(canvas: &mut Canvas, y: f64) {
    let head = "time of the runner-up / fastest:";
    canvas.text(head, (MARGIN, y), NOTE);
    let mut x = MARGIN + width(head, SIZE, false) + 12.0;
    for (k, white) in WHITENESS.into_iter().enumerate() {
        let words = match (k.checked_sub(1).map(|k| STEPS[k]), STEPS.get(k)) {
            (None, Some(to)) => format!("below {to}"),
            (Some(from), Some(to)) => format!("{from} to {to}"),
            (from, None) => format!("{} and more", from.unwrap_or_default()),
        };
        canvas.rect((x, y - 9.0), (x + 26.0, y + 9.0), lightened(INK, white));
        canvas.text(&words, (x + 32.0, y), NOTE);
        x += 32.0 + width(&words, SIZE, false) + 16.0;
    }
}

struct Sheet<'a> {
    labels: [&'a str; 2],
    map: &'a Map,
    colours: BTreeMap<&'a str, Colour>,
    left: f64,
    tile: f64,
}

impl Sheet<'_> {
    fn panel(&self, canvas: &mut Canvas, panel: &Panel, (left, top): Point) {
        let [x, y] = &self.map.axes;
        let (columns, rows) = (panel.values(0), panel.values(1));
        let (wide, from, first) = (self.tile, left + self.left, top + ABOVE);
        let (right, last) = (from + wide * columns.len() as f64, first + HIGH * rows.len() as f64);
        let across = |i: usize| from + wide * i as f64;
        let down = |j: usize| last - HIGH * (j + 1) as f64;
        canvas.text(&panel.title, (from, top + 16.0), HEADING);
        for (j, &value) in rows.iter().enumerate() {
            canvas.text(&y.values[value], (from - 8.0, down(j) + HIGH / 2.0), VALUE.ending());
        }
        for (i, &value) in columns.iter().enumerate() {
            canvas.text(&x.values[value], (across(i) + wide / 2.0, last + 14.0), VALUE.centred());
        }
        canvas.text(self.labels[0], ((from + right) / 2.0, last + 36.0), AXIS);
        canvas.text(self.labels[1], (left + 8.0, (first + last) / 2.0), AXIS.upright());
        let spot = |i: usize, j: usize| panel.at([*columns.get(i)?, *rows.get(j)?]);
        let all = || (0..rows.len()).flat_map(|j| (0..columns.len()).map(move |i| (i, j)));
        for (i, j) in all() {
            self.tile(canvas, spot(i, j), (across(i), down(j)));
        }
        // A line is drawn if no detector may be the fastest in both tiles.
        let front = |i: usize, j: usize| spot(i, j).map(Spot::front).unwrap_or_default();
        let parted = |[a, b]: [(usize, usize); 2]| {
            let (a, b) = (front(a.0, a.1), front(b.0, b.1));
            !a.is_empty() && !b.is_empty() && a.iter().all(|name| !b.contains(name))
        };
        for (i, j) in all() {
            let (x, y) = (across(i), down(j));
            if i + 1 < columns.len() && parted([(i, j), (i + 1, j)]) {
                canvas.line(&[(x + wide, y), (x + wide, y + HIGH)], INK, 3.0);
            }
            if j + 1 < rows.len() && parted([(i, j), (i, j + 1)]) {
                canvas.line(&[(x, y), (x + wide, y)], INK, 3.0);
            }
        }
        canvas.frame((from, first), (right, last), 1.0, INK);
    }

    fn tile(&self, canvas: &mut Canvas, spot: Option<&Spot>, (x, y): Point) {
        let (right, low) = (x + self.tile, y + HIGH);
        let answer = spot.map(|spot| (spot, spot.answer()));
        let ground = self.ground(canvas, answer, (x, y));
        let Some((spot, answer)) = answer else {
            return canvas.frame((x, y), (right, low), 1.0, GRID);
        };
        let (front, factor, mut lines) = (spot.front(), spot.factor(), Vec::new());
        let ratio = factor.map(|it| times(it.median));
        let undecided = answer == Answer::Undecided;
        match answer {
            Answer::Nobody => lines.push(spot.outcome.name().to_string()),
            Answer::Undecided => {
                lines.extend([front[0].to_string(), format!("or {}", either(&front[1..]))]);
                lines.extend(ratio.filter(|_| front.len() > 1));
            }
            Answer::Decided(_) | Answer::Alone => {
                lines.push(front[0].to_string());
                lines.extend(ratio);
                let ends = factor.and_then(|factor| factor.ends());
                lines.extend(ends.map(|[low, high]| format!("{} to {}", times(low), times(high))));
                lines.extend((answer == Answer::Alone).then(|| "alone".into()));
            }
        }
        let (middle, step) = ((x + self.tile / 2.0, y + HIGH / 2.0), 17.0);
        let top = middle.1 - step * (lines.len() as f64 - 1.0) / 2.0;
        let ink = if answer == Answer::Nobody { FAINT } else { ink_on(ground) };
        for (k, line) in lines.iter().enumerate() {
            let named = k == 0 || (k == 1 && undecided);
            let size = fitted(line, self.tile - ROOM, if k == 2 { 13.0 } else { SIZE }, named);
            let text = Text::new(size, ink).bold_if(named).centred();
            canvas.text(line, (middle.0, top + step * k as f64), text);
        }
        canvas.frame((x, y), (right, low), 1.0, GRID);
    }

    /// Paints a tile, and returns the colour behind its text.
    fn ground(&self, canvas: &mut Canvas, spot: Option<(&Spot, Answer)>, (x, y): Point) -> Colour {
        let (right, low) = (x + self.tile, y + HIGH);
        let front = spot.map(|(spot, _)| spot.front()).unwrap_or_default();
        let colour = |k: usize, white: f64| {
            let own = front.get(k).and_then(|name| self.colours.get(name)).copied();
            lightened(own.unwrap_or(FAINT), white)
        };
        let ground = match spot.map(|(_, answer)| answer) {
            None | Some(Answer::Nobody) => STRIP,
            Some(Answer::Undecided) => colour(0, 0.45),
            Some(Answer::Decided(step)) => colour(0, WHITENESS[step.min(WHITENESS.len() - 1)]),
            Some(Answer::Alone) => colour(0, 0.85),
        };
        canvas.rect((x, y), (right, low), ground);
        if !matches!(spot, Some((_, Answer::Undecided))) {
            return ground;
        }
        stripes(canvas, (x, y), self.tile, colour(1, 0.45));
        canvas.rect((x + 7.0, y + 7.0), (right - 7.0, low - 7.0), WHITE);
        WHITE
    }
}

/// Returns the font size at which a line fits into the width `room`.
fn fitted(line: &str, room: f64, size: f64, bold: bool) -> f64 {
    (size * room / width(line, size, bold).max(room)).max(7.0)
}

fn stripes(canvas: &mut Canvas, (x, y): Point, wide: f64, colour: Colour) {
    let mut start = -HIGH;
    while start < wide {
        // A stripe reaches from `start` to `end` on the lower edge, and leans to the right.
        let end = start + STRIPE / 2.0;
        let cut = |at: f64, t: f64| (x + at + t, y + HIGH - t);
        let inside = |at: f64| (f64::max(0.0, -at), f64::min(HIGH, wide - at));
        let ((a, b), (c, d)) = (inside(start), inside(end));
        if a < b && c < d {
            canvas.fill(&[cut(start, a), cut(start, b), cut(end, d), cut(end, c)], colour);
        }
        start += STRIPE;
    }
}

fn row_height(row: &[Panel]) -> f64 {
    let most = row.iter().map(|panel| panel.values(1).len()).max().unwrap_or(0);
    ABOVE + HIGH * most as f64 + BELOW + 10.0
}
