//! Lines, shapes and text in layout units, as plotters writes them into an SVG.

use anyhow::anyhow;
use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontStyle, FontTransform, IntoFont, IntoTextStyle, RGBColor, ShapeStyle,
};

use crate::figure::style::{Colour, FAINT, INK, Marker};
use crate::svg::font::Font;

/// Plotters writes text of this height per em.
const LINE_HEIGHT: f64 = 1.24;

/// A point, in layout units.
pub type Point = (f64, f64);

/// Where text is placed, and how.
#[derive(Clone, Copy)]
pub struct Text {
    pub size: f64,
    pub colour: Colour,
    pub bold: bool,
    /// Which part of the text the point is: -1 left, 0 centre, 1 right.
    pub anchor: i8,
    /// Reads from bottom to top.
    pub upright: bool,
}

impl Text {
    /// Regular text that begins at the point.
    pub fn new(size: f64, colour: Colour) -> Text {
        Text { size, colour, bold: false, anchor: -1, upright: false }
    }
    /// The same, with the point at its centre (0) or end (1).
    pub fn anchor(self, anchor: i8) -> Text {
        Text { anchor, ..self }
    }
    pub fn bold(self) -> Text {
        Text { bold: true, ..self }
    }
}

/// What a figure is drawn on.
pub struct Canvas<'a>(SVGBackend<'a>);

/// Draws an SVG on a white ground: viewers may have a dark one.
pub fn svg(
    size: (u32, u32),
    draw: impl FnOnce(&mut Canvas) -> anyhow::Result<()>,
) -> anyhow::Result<String> {
    let mut text = String::new();
    let mut canvas = Canvas(SVGBackend::with_string(&mut text, size));
    canvas.rect((0.0, 0.0), (f64::from(size.0), f64::from(size.1)), (255, 255, 255))?;
    draw(&mut canvas)?;
    canvas.0.present().map_err(failed)?;
    drop(canvas);
    Ok(text)
}

/// The width of a text, in layout units.
pub fn width(text: &str, size: f64, bold: bool) -> anyhow::Result<f64> {
    Ok(Font::new(size / LINE_HEIGHT, bold)?.width(text))
}

/// The margin of a sheet.
pub const MARGIN: f64 = 24.0;

impl Canvas<'_> {
    /// The title of a sheet, and the lines below it.
    pub fn heading(&mut self, title: &str, subtitle: &[String]) -> anyhow::Result<()> {
        self.text(title, (MARGIN, MARGIN + 12.0), Text::new(29.0, INK).bold())?;
        for (k, line) in subtitle.iter().enumerate() {
            self.text(line, (MARGIN, MARGIN + 42.0 + 22.0 * k as f64), Text::new(18.0, FAINT))?;
        }
        Ok(())
    }

    /// A line of this width; `dash` is (drawn, skipped), or none.
    pub fn line(
        &mut self,
        points: &[Point],
        colour: Colour,
        width: f64,
        dash: Option<Point>,
    ) -> anyhow::Result<()> {
        let style = ShapeStyle {
            color: rgb(colour).to_rgba(),
            filled: false,
            stroke_width: width.round().max(1.0) as u32,
        };
        let pieces = match dash {
            None => vec![points.to_vec()],
            Some(dash) => dashes(points, dash),
        };
        for piece in pieces {
            match pixels(&piece).as_slice() {
                [] => {}
                &[from, to] => self.0.draw_line(from, to, &style).map_err(failed)?,
                path => self.0.draw_path(path.iter().copied(), &style).map_err(failed)?,
            }
        }
        Ok(())
    }

    pub fn fill(&mut self, points: &[Point], colour: Colour) -> anyhow::Result<()> {
        self.0.fill_polygon(pixels(points), &rgb(colour)).map_err(failed)
    }

    pub fn rect(&mut self, low: Point, high: Point, colour: Colour) -> anyhow::Result<()> {
        self.fill(&[low, (high.0, low.1), high, (low.0, high.1)], colour)
    }

    pub fn disc(&mut self, at: Point, radius: f64, colour: Colour) -> anyhow::Result<()> {
        let radius = radius.round() as u32;
        self.0.draw_circle(pixel(at), radius, &rgb(colour), true).map_err(failed)
    }

    /// One line of text, vertically centred on the point.
    pub fn text(&mut self, text: &str, at: Point, style: Text) -> anyhow::Result<()> {
        let face = if style.bold { FontStyle::Bold } else { FontStyle::Normal };
        let anchor = match style.anchor {
            0 => HPos::Center,
            1 => HPos::Right,
            _ => HPos::Left,
        };
        let turn = if style.upright { FontTransform::Rotate270 } else { FontTransform::None };
        let style = ("sans-serif", style.size, face)
            .into_font()
            .transform(turn)
            .color(&rgb(style.colour))
            .pos(Pos::new(anchor, VPos::Center))
            .into_text_style(&(1, 1));
        self.0.draw_text(text, &style, pixel(at)).map_err(failed)
    }

    /// A detector's marker, with a white rim that keeps crossing lines apart.
    pub fn marker(
        &mut self,
        (x, y): Point,
        r: f64,
        marker: Marker,
        colour: Colour,
    ) -> anyhow::Result<()> {
        let shape = |r: f64| -> Vec<Point> {
            match marker {
                Marker::Square => {
                    vec![(x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)]
                }
                Marker::Up => {
                    vec![(x, y - 1.25 * r), (x + 1.2 * r, y + 0.9 * r), (x - 1.2 * r, y + 0.9 * r)]
                }
                Marker::Down => {
                    vec![(x, y + 1.25 * r), (x + 1.2 * r, y - 0.9 * r), (x - 1.2 * r, y - 0.9 * r)]
                }
                _ => {
                    vec![(x, y - 1.35 * r), (x + 1.35 * r, y), (x, y + 1.35 * r), (x - 1.35 * r, y)]
                }
            }
        };
        match marker {
            Marker::Circle => {
                self.disc((x, y), 1.1 * r + 1.5, (255, 255, 255))?;
                self.disc((x, y), 1.1 * r, colour)
            }
            Marker::Cross => {
                self.line(&[(x - r, y - r), (x + r, y + r)], colour, 2.0, None)?;
                self.line(&[(x - r, y + r), (x + r, y - r)], colour, 2.0, None)
            }
            Marker::Plus => {
                self.line(&[(x - 1.2 * r, y), (x + 1.2 * r, y)], colour, 2.0, None)?;
                self.line(&[(x, y - 1.2 * r), (x, y + 1.2 * r)], colour, 2.0, None)
            }
            _ => {
                self.fill(&shape(r + 1.5), (255, 255, 255))?;
                self.fill(&shape(r), colour)
            }
        }
    }
}

/// The cast saturates; not a number becomes 0.
fn pixel((x, y): Point) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

fn pixels(points: &[Point]) -> Vec<(i32, i32)> {
    points.iter().copied().map(pixel).collect()
}

fn rgb((r, g, b): Colour) -> RGBColor {
    RGBColor(r, g, b)
}

fn failed(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("drawing failed: {error}")
}

/// The drawn pieces of a dashed line.
fn dashes(points: &[Point], (on, off): Point) -> Vec<Vec<Point>> {
    let (mut pieces, mut phase) = (Vec::new(), 0.0);
    for pair in points.windows(2) {
        let &[(x0, y0), (x1, y1)] = pair else { continue };
        let length = (x1 - x0).hypot(y1 - y0);
        if !length.is_finite() || length <= 0.0 || on + off < 1.0 {
            continue;
        }
        let at = |s: f64| (x0 + (x1 - x0) * s / length, y0 + (y1 - y0) * s / length);
        let mut start = -phase;
        while start < length {
            let (low, high) = (start.max(0.0), (start + on).min(length));
            if high > low {
                pieces.push(vec![at(low), at(high)]);
            }
            start += on + off;
        }
        phase = on + off - (start - length);
    }
    pieces
}
