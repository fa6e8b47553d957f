//! Figures of maps: a panel per scene, a tile per place with the name of the fastest and the factor
//! to the next. A colour per contender, deeper where it is farther ahead; stripes of two where it
//! is undecided; a line where another becomes the fastest.

use std::collections::BTreeMap;

use crate::figure::About;
use crate::figure::canvas::{self, Canvas, MARGIN, Point, Text, width};
use crate::figure::style::{Colour, FAINT, GRID, INK, STRIP, Styles, ink_on, lightened};
use crate::sections::map::either;
use contactbench_record::cells::select;
use contactbench_record::experiment::MapAxes;
use contactbench_record::findings::map::{Answer, Map, Panel, STEPS, Spot};
use contactbench_terms::number::{times, wrap};

/// The widest figure, and the narrowest.
const WIDTH: (f64, f64) = (1400.0, 760.0);
/// A tile: its height, and how wide it is for short names and for long ones.
const HIGH: f64 = 64.0;
const WIDE: (f64, f64) = (112.0, 164.0);
/// Beside the names in it.
const ROOM: f64 = 18.0;
const GAP: f64 = 30.0;
/// Room for the title of a panel above it, and for values and the name of the axis below.
const HEADING: f64 = 34.0;
const BELOW: f64 = 56.0;
const STRIPE: f64 = 14.0;
const SIZE: f64 = 15.0;

/// How much of a contender's colour is white, by how clearly it wins: one for each of [`STEPS`],
/// and for less than the first.
pub const WHITE: [f64; STEPS.len() + 1] = [0.72, 0.5, 0.25, 0.0];

/// The figure as SVG; none if no cell has a time: of a shard, say.
pub fn svg(about: &About<'_>, axes: &MapAxes) -> anyhow::Result<Option<String>> {
    let About { figure, cells, .. } = about;
    if select::select(cells, &figure.filter)?.iter().all(|cell| cell.time().is_none()) {
        return Ok(None);
    }
    let found = Map::new(axes, &figure.filter, cells)?;
    drawn(&figure.title, axes, &found, about.style).map(Some)
}

/// A map as SVG.
pub fn drawn(title: &str, axes: &MapAxes, found: &Map, style: &Styles) -> anyhow::Result<String> {
    let sheet = Sheet::new(title, axes, found, style)?;
    canvas::svg(sheet.size, |canvas| sheet.draw(canvas))
}

pub struct Sheet<'a> {
    pub size: (u32, u32),
    title: Vec<String>,
    subtitle: Vec<String>,
    labels: [&'a str; 2],
    map: &'a Map,
    colours: BTreeMap<&'a str, Colour>,
    /// Panels side by side, the width of one, and where the first row of them begins.
    columns: usize,
    across: f64,
    top: f64,
    /// Room for the values upwards.
    left: f64,
    /// The width of a tile.
    tile: f64,
}

impl<'a> Sheet<'a> {
    pub fn new(
        title: &str,
        axes: &'a MapAxes,
        map: &'a Map,
        styles: &Styles,
    ) -> anyhow::Result<Sheet<'a>> {
        let mut left = 40.0_f64;
        for value in &map.axes[1].values {
            left = left.max(width(value, SIZE, false)? + 44.0);
        }
        let mut tile = WIDE.0;
        for name in &map.contenders {
            tile = tile.max(width(name, SIZE, true)? + ROOM);
        }
        let tile = tile.min(WIDE.1);
        let mut across: f64 = 0.0;
        for panel in &map.panels {
            let tiles = tile * panel.values(0).len() as f64;
            across = across.max(left + tiles.max(width(&panel.title, 19.0, true)?));
        }
        let fit = ((WIDTH.0 - 2.0 * MARGIN + GAP) / (across + GAP)).floor().max(1.0);
        let columns = (fit as usize).min(map.panels.len()).max(1);
        let whole = 2.0 * MARGIN + columns as f64 * (across + GAP) - GAP;
        let whole = whole.max(WIDTH.1);
        let how = "Each tile: who is the fastest, the time of the next over its own, and the \
                   interval of that ratio. Striped: undecided.";
        let title = wrap(title, (whole / 16.0) as usize);
        let subtitle = wrap(how, (whole / 9.3) as usize);
        let lines = 34.0 * title.len() as f64 + 22.0 * subtitle.len() as f64;
        let top = MARGIN + lines + 62.0;
        let rows = map.panels.chunks(columns).map(row_height);
        let height = top + rows.sum::<f64>() + MARGIN - 10.0;
        let colours = styles.of_map(&map.contenders);
        let colours = map.contenders.iter().map(String::as_str).zip(colours).collect();
        Ok(Sheet {
            size: (whole.min(20_000.0) as u32, height.min(20_000.0) as u32),
            title,
            subtitle,
            labels: axes.labels(),
            map,
            colours,
            columns,
            across,
            top,
            left,
            tile,
        })
    }

    pub fn draw(&self, canvas: &mut Canvas) -> anyhow::Result<()> {
        let mut y = MARGIN + 12.0;
        for line in &self.title {
            canvas.text(line, (MARGIN, y), Text::new(29.0, INK).bold())?;
            y += 34.0;
        }
        for line in &self.subtitle {
            canvas.text(line, (MARGIN, y - 4.0), Text::new(18.0, FAINT))?;
            y += 22.0;
        }
        self.legend(canvas, y + 12.0)?;
        let mut top = self.top;
        for row in self.map.panels.chunks(self.columns) {
            for (column, panel) in row.iter().enumerate() {
                self.panel(canvas, panel, (MARGIN + column as f64 * (self.across + GAP), top))?;
            }
            top += row_height(row);
        }
        Ok(())
    }

    /// What depth of colour means; names stand in the tiles.
    fn legend(&self, canvas: &mut Canvas, y: f64) -> anyhow::Result<()> {
        let shades = WHITE.iter().enumerate().map(|(k, &white)| {
            let from = if k == 0 { String::new() } else { format!("{}", STEPS[k - 1]) };
            let words = match STEPS.get(k) {
                Some(to) if k == 0 => format!("below {to}"),
                Some(to) => format!("{from} to {to}"),
                None => format!("{from} and more"),
            };
            (lightened(INK, white), words)
        });
        let mut x = MARGIN;
        let head = "the next takes, times as long:";
        canvas.text(head, (x, y), Text::new(SIZE, FAINT))?;
        x += width(head, SIZE, false)? + 12.0;
        for (colour, words) in shades {
            canvas.rect((x, y - 9.0), (x + 26.0, y + 9.0), colour)?;
            canvas.text(&words, (x + 32.0, y), Text::new(SIZE, FAINT))?;
            x += 32.0 + width(&words, SIZE, false)? + 16.0;
        }
        Ok(())
    }

    fn panel(&self, canvas: &mut Canvas, panel: &Panel, (left, top): Point) -> anyhow::Result<()> {
        let [x, y] = &self.map.axes;
        let (columns, rows) = (panel.values(0), panel.values(1));
        let (wide, from, first) = (self.tile, left + self.left, top + HEADING);
        let (right, last) = (from + wide * columns.len() as f64, first + HIGH * rows.len() as f64);
        let across = |i: usize| from + wide * i as f64;
        let down = |j: usize| last - HIGH * (j + 1) as f64;
        canvas.text(&panel.title, (from, top + 16.0), Text::new(19.0, INK).bold())?;
        for (j, &value) in rows.iter().enumerate() {
            let place = (from - 8.0, down(j) + HIGH / 2.0);
            canvas.text(&y.values[value], place, Text::new(SIZE, INK).anchor(1))?;
        }
        for (i, &value) in columns.iter().enumerate() {
            let place = (across(i) + wide / 2.0, last + 14.0);
            canvas.text(&x.values[value], place, Text::new(SIZE, INK).anchor(0))?;
        }
        let middle = ((from + right) / 2.0, last + 36.0);
        canvas.text(self.labels[0], middle, Text::new(16.0, FAINT).anchor(0))?;
        let upright = Text { upright: true, ..Text::new(16.0, FAINT).anchor(0) };
        canvas.text(self.labels[1], (left + 8.0, (first + last) / 2.0), upright)?;
        let spot = |i: usize, j: usize| panel.at([*columns.get(i)?, *rows.get(j)?]);
        let all = || (0..rows.len()).flat_map(|j| (0..columns.len()).map(move |i| (i, j)));
        for (i, j) in all() {
            self.tile(canvas, spot(i, j), (across(i), down(j)))?;
        }
        // Where another becomes the fastest for sure: nobody is among the fastest on both sides.
        let front = |i: usize, j: usize| spot(i, j).map(Spot::front).unwrap_or_default();
        let parted = |[a, b]: [(usize, usize); 2]| {
            let (a, b) = (front(a.0, a.1), front(b.0, b.1));
            !a.is_empty() && !b.is_empty() && a.iter().all(|name| !b.contains(name))
        };
        for (i, j) in all() {
            let (x, y) = (across(i), down(j));
            if i + 1 < columns.len() && parted([(i, j), (i + 1, j)]) {
                canvas.line(&[(x + wide, y), (x + wide, y + HIGH)], INK, 3.0, None)?;
            }
            if j + 1 < rows.len() && parted([(i, j), (i, j + 1)]) {
                canvas.line(&[(x, y), (x + wide, y)], INK, 3.0, None)?;
            }
        }
        let frame = [(from, first), (right, first), (right, last), (from, last), (from, first)];
        canvas.line(&frame, INK, 1.0, None)
    }

    fn tile(&self, canvas: &mut Canvas, spot: Option<&Spot>, (x, y): Point) -> anyhow::Result<()> {
        let (right, low) = (x + self.tile, y + HIGH);
        let frame = [(x, y), (right, y), (right, low), (x, low), (x, y)];
        let middle = (x + self.tile / 2.0, y + HIGH / 2.0);
        let Some(spot) = spot else {
            canvas.rect((x, y), (right, low), STRIP)?;
            return canvas.line(&frame, GRID, 1.0, None);
        };
        let front = spot.front();
        let colour = |name: &str| self.colours.get(name).copied().unwrap_or(FAINT);
        let factor = spot.factor();
        let (lines, ink) = match spot.answer() {
            Answer::Nobody => {
                canvas.rect((x, y), (right, low), STRIP)?;
                (vec![spot.outcome.name().to_string()], FAINT)
            }
            Answer::Undecided => {
                let [first, second] = [0, 1].map(|k| front.get(k).map_or(FAINT, |it| colour(it)));
                canvas.rect((x, y), (right, low), lightened(first, 0.45))?;
                stripes(canvas, (x, y), self.tile, lightened(second, 0.45))?;
                canvas.rect((x + 7.0, y + 7.0), (right - 7.0, low - 7.0), (255, 255, 255))?;
                let ratio = factor.map(|it| times(it.median));
                let mut lines = vec![front[0].to_string(), format!("or {}", either(&front[1..]))];
                lines.extend(ratio.filter(|_| front.len() > 1));
                (lines, INK)
            }
            answer => {
                let white = match answer {
                    Answer::Decided(step) => WHITE[step.min(WHITE.len() - 1)],
                    _ => 0.85,
                };
                let ground = lightened(colour(front[0]), white);
                canvas.rect((x, y), (right, low), ground)?;
                let mut lines = vec![front[0].to_string()];
                lines.extend(factor.map(|it| times(it.median)));
                let to = |low: f64, high: f64| format!("{} to {}", times(low), times(high));
                lines.extend(factor.map(|it| to(it.low, it.high)));
                if answer == Answer::Alone {
                    lines.push("alone".into());
                }
                (lines, ink_on(ground))
            }
        };
        let step = 17.0;
        let top = middle.1 - step * (lines.len() as f64 - 1.0) / 2.0;
        for (k, line) in lines.iter().enumerate() {
            let named = k == 0 || (k == 1 && spot.answer() == Answer::Undecided);
            let size = if k == 2 { 13.0 } else { SIZE };
            let size = fitted(line, self.tile - ROOM, size, named)?;
            let text = Text { bold: named, ..Text::new(size, ink).anchor(0) };
            canvas.text(line, (middle.0, top + step * k as f64), text)?;
        }
        canvas.line(&frame, GRID, 1.0, None)
    }
}

/// The size at which a line fits into so much room.
fn fitted(line: &str, room: f64, size: f64, bold: bool) -> anyhow::Result<f64> {
    Ok((size * room / width(line, size, bold)?.max(room)).max(7.0))
}

/// Slanted stripes over a tile so wide.
fn stripes(canvas: &mut Canvas, (x, y): Point, wide: f64, colour: Colour) -> anyhow::Result<()> {
    let mut start = -HIGH;
    while start < wide {
        // A stripe begins at the lower edge from `start` to half a step further, and leans right.
        let end = start + STRIPE / 2.0;
        let cut = |at: f64, t: f64| (x + at + t, y + HIGH - t);
        let inside = |at: f64| (f64::max(0.0, -at), f64::min(HIGH, wide - at));
        let ((a, b), (c, d)) = (inside(start), inside(end));
        if a < b && c < d {
            canvas.fill(&[cut(start, a), cut(start, b), cut(end, d), cut(end, c)], colour)?;
        }
        start += STRIPE;
    }
    Ok(())
}

/// As high as the highest panel of a row, with what stands above and below its tiles.
fn row_height(row: &[Panel]) -> f64 {
    let most = row.iter().map(|panel| panel.values(1).len()).max().unwrap_or(0);
    HEADING + HIGH * most as f64 + BELOW + 10.0
}
