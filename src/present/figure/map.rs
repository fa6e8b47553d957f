//! Figures of maps: a panel per scene, a tile per place with the name of the fastest and the factor
//! to the next. A colour per contender, deeper where it is farther ahead; stripes of two where it
//! is undecided; a line where another becomes the fastest.

use std::collections::BTreeMap;

use crate::experiment::MapAxes;
use crate::findings::map::{Answer, Map, Panel, STEPS, Spot};
use crate::number::{times, wrap};
use crate::present::figure::canvas::{Canvas, Point, Text, width};
use crate::present::figure::style::{Colour, FAINT, GRID, INK, STRIP, Styles, ink_on, lightened};
use crate::present::sections::map::either;

const MARGIN: f64 = 24.0;
/// The widest figure, and the narrowest.
const WIDTH: (f64, f64) = (1400.0, 760.0);
/// A tile.
const TILE: (f64, f64) = (122.0, 64.0);
const GAP: f64 = 30.0;
/// Room for the title of a panel above it, and for values and the name of the axis below.
const HEADING: f64 = 34.0;
const BELOW: f64 = 56.0;
/// Between stripes.
const STRIPE: f64 = 14.0;
const SIZE: f64 = 15.0;

/// How much of a contender's colour is white, by how clearly it wins: one for each of [`STEPS`],
/// and for less than the first.
pub const WHITE: [f64; STEPS.len() + 1] = [0.72, 0.5, 0.25, 0.0];

/// A figure, laid out.
pub struct Sheet<'a> {
    /// Width and height.
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
}

impl<'a> Sheet<'a> {
    /// Measures everything.
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
        let tiles = TILE.0 * map.axes[0].values.len() as f64;
        let mut across = left + tiles;
        for panel in &map.panels {
            across = across.max(left + width(&panel.title, 19.0, true)?);
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
        let rows = map.panels.len().div_ceil(columns) as f64;
        let height = top + rows * row_height(map) + MARGIN - 10.0;
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
        })
    }

    /// Draws everything.
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
        for (k, panel) in self.map.panels.iter().enumerate() {
            let (row, column) = (k / self.columns, k % self.columns);
            let left = MARGIN + column as f64 * (self.across + GAP);
            let top = self.top + row as f64 * row_height(self.map);
            self.panel(canvas, panel, (left, top))?;
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
        let (nx, ny) = (x.values.len(), y.values.len());
        let (from, first) = (left + self.left, top + HEADING);
        let last = first + TILE.1 * ny as f64;
        let corner = |[i, j]: [usize; 2]| -> Point {
            (from + TILE.0 * i as f64, first + TILE.1 * (ny - 1 - j) as f64)
        };
        canvas.text(&panel.title, (from, top + 16.0), Text::new(19.0, INK).bold())?;
        for (j, value) in y.values.iter().enumerate() {
            let (_, at) = corner([0, j]);
            let place = (from - 8.0, at + TILE.1 / 2.0);
            canvas.text(value, place, Text::new(SIZE, INK).anchor(1))?;
        }
        for (i, value) in x.values.iter().enumerate() {
            let (at, _) = corner([i, 0]);
            let place = (at + TILE.0 / 2.0, last + 14.0);
            canvas.text(value, place, Text::new(SIZE, INK).anchor(0))?;
        }
        let middle = from + TILE.0 * nx as f64 / 2.0;
        canvas.text(self.labels[0], (middle, last + 36.0), Text::new(16.0, FAINT).anchor(0))?;
        let upright = Text { upright: true, ..Text::new(16.0, FAINT).anchor(0) };
        canvas.text(self.labels[1], (left + 8.0, (first + last) / 2.0), upright)?;
        for j in 0..ny {
            for i in 0..nx {
                self.tile(canvas, panel.at([i, j]), corner([i, j]))?;
            }
        }
        // Where another becomes the fastest.
        let front = |at: [usize; 2]| panel.at(at).map(Spot::front);
        for j in 0..ny {
            for i in 0..nx {
                let (x, y) = corner([i, j]);
                if i + 1 < nx && front([i, j]) != front([i + 1, j]) {
                    let x = x + TILE.0;
                    canvas.line(&[(x, y), (x, y + TILE.1)], INK, 3.0, None)?;
                }
                if j + 1 < ny && front([i, j]) != front([i, j + 1]) {
                    canvas.line(&[(x, y), (x + TILE.0, y)], INK, 3.0, None)?;
                }
            }
        }
        let (low, high) = ((from, first), (from + TILE.0 * nx as f64, last));
        let frame = [low, (high.0, low.1), high, (low.0, high.1), low];
        canvas.line(&frame, INK, 1.0, None)
    }

    fn tile(&self, canvas: &mut Canvas, spot: Option<&Spot>, (x, y): Point) -> anyhow::Result<()> {
        let (right, low) = (x + TILE.0, y + TILE.1);
        let frame = [(x, y), (right, y), (right, low), (x, low), (x, y)];
        let middle = (x + TILE.0 / 2.0, y + TILE.1 / 2.0);
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
                stripes(canvas, (x, y), lightened(second, 0.45))?;
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
            let size = fitted(line, if k == 2 { 13.0 } else { SIZE }, named)?;
            let text = Text { bold: named, ..Text::new(size, ink).anchor(0) };
            canvas.text(line, (middle.0, top + step * k as f64), text)?;
        }
        canvas.line(&frame, GRID, 1.0, None)
    }
}

/// The size at which a line fits into a tile.
fn fitted(line: &str, size: f64, bold: bool) -> anyhow::Result<f64> {
    let room = TILE.0 - 18.0;
    Ok((size * room / width(line, size, bold)?.max(room)).max(7.0))
}

/// Slanted stripes over a tile.
fn stripes(canvas: &mut Canvas, (x, y): Point, colour: Colour) -> anyhow::Result<()> {
    let (wide, high) = TILE;
    let mut start = -high;
    while start < wide {
        // A stripe's lower edge is from `start` to `start + half`, and it leans by the height.
        let half = STRIPE / 2.0;
        let cut = |at: f64, t: f64| (x + at + t, y + high - t);
        let inside = |at: f64| (f64::max(0.0, -at), f64::min(high, wide - at));
        let ((a, b), (c, d)) = (inside(start), inside(start + half));
        if a < b && c < d {
            let points = [cut(start, a), cut(start, b), cut(start + half, d), cut(start + half, c)];
            canvas.fill(&points, colour)?;
        }
        start += STRIPE;
    }
    Ok(())
}

/// As high as all its tiles and what stands above and below them.
fn row_height(map: &Map) -> f64 {
    HEADING + TILE.1 * map.axes[1].values.len() as f64 + BELOW + 10.0
}
