//! Lines, shapes and text in layout units on a plotters backend.
//!
//! PNGs are drawn at twice the size and averaged: plotters places text and markers on whole pixels, which shows at the final size.

use std::path::Path;

use anyhow::anyhow;
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, IntoFont, IntoTextStyle, RGBColor, ShapeStyle};

use super::style::{Colour, Marker};

/// How much larger a PNG is drawn than written.
const OVERSAMPLING: u32 = 2;

static REGULAR: &[u8] = include_bytes!("../../assets/DejaVuSans-subset.ttf");
static BOLD: &[u8] = include_bytes!("../../assets/DejaVuSans-Bold-subset.ttf");

/// Makes the embedded fonts known to plotters; no font of the system is needed.
pub fn register_fonts() -> anyhow::Result<()> {
    for (style, bytes) in [(FontStyle::Normal, REGULAR), (FontStyle::Bold, BOLD)] {
        plotters::style::register_font("sans-serif", style, bytes).map_err(|_| anyhow!("the embedded font cannot be read"))?;
    }
    Ok(())
}

/// A point, in layout units.
pub type Point = (f64, f64);

/// Where text is placed, and how.
#[derive(Clone, Copy)]
pub struct Text {
    /// Height of the line.
    pub size: f64,
    /// Colour.
    pub colour: Colour,
    /// Bold face.
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
    /// The same, bold.
    pub fn bold(self) -> Text {
        Text { bold: true, ..self }
    }
}

/// What the layout draws on.
pub trait Canvas {
    /// A line of this width; `dash` is (drawn, skipped), or none.
    fn line(&mut self, points: &[Point], colour: Colour, width: f64, dash: Option<Point>) -> anyhow::Result<()>;
    /// A filled polygon.
    fn fill(&mut self, points: &[Point], colour: Colour) -> anyhow::Result<()>;
    /// A filled circle.
    fn disc(&mut self, at: Point, radius: f64, colour: Colour) -> anyhow::Result<()>;
    /// One line of text, vertically centred on the point.
    fn text(&mut self, text: &str, at: Point, style: Text) -> anyhow::Result<()>;

    /// A filled rectangle.
    fn rect(&mut self, low: Point, high: Point, colour: Colour) -> anyhow::Result<()> {
        self.fill(&[low, (high.0, low.1), high, (low.0, high.1)], colour)
    }

    /// A detector's marker, with a white rim that keeps crossing lines apart.
    fn marker(&mut self, (x, y): Point, r: f64, marker: Marker, colour: Colour) -> anyhow::Result<()> {
        let shape = |r: f64| -> Vec<Point> {
            match marker {
                Marker::Square => vec![(x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r)],
                Marker::Up => vec![(x, y - 1.25 * r), (x + 1.2 * r, y + 0.9 * r), (x - 1.2 * r, y + 0.9 * r)],
                Marker::Down => vec![(x, y + 1.25 * r), (x + 1.2 * r, y - 0.9 * r), (x - 1.2 * r, y - 0.9 * r)],
                _ => vec![(x, y - 1.35 * r), (x + 1.35 * r, y), (x, y + 1.35 * r), (x - 1.35 * r, y)],
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

/// The width of a text, in layout units.
pub fn width(text: &str, size: f64, bold: bool) -> f64 {
    let style = if bold { FontStyle::Bold } else { FontStyle::Normal };
    // estimated where the font is not registered
    ("sans-serif", size, style).into_font().box_size(text).map_or(0.5 * size * text.chars().count() as f64, |size| f64::from(size.0))
}

struct On<B: DrawingBackend> {
    backend: B,
    scale: f64,
    /// How far text must be lowered to be centred, in heights: the bitmap backend centres it about 0.18 too high.
    lower: f64,
}

impl<B: DrawingBackend> On<B> {
    fn at(&self, (x, y): Point) -> (i32, i32) {
        // the cast saturates; not a number becomes 0
        ((x * self.scale).round() as i32, (y * self.scale).round() as i32)
    }
}

fn rgb((r, g, b): Colour) -> RGBColor {
    RGBColor(r, g, b)
}

fn failed(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("drawing failed: {error}")
}

impl<B: DrawingBackend> Canvas for On<B> {
    fn line(&mut self, points: &[Point], colour: Colour, width: f64, dash: Option<Point>) -> anyhow::Result<()> {
        let style = ShapeStyle { color: rgb(colour).to_rgba(), filled: false, stroke_width: (width * self.scale).round().max(1.0) as u32 };
        let pieces = match dash {
            None => vec![points.to_vec()],
            Some(dash) => dashes(points, dash),
        };
        for piece in pieces {
            let path: Vec<(i32, i32)> = piece.iter().map(|&point| self.at(point)).collect();
            match path.as_slice() {
                [] => {}
                &[from, to] => self.backend.draw_line(from, to, &style).map_err(failed)?,
                _ => self.backend.draw_path(path, &style).map_err(failed)?,
            }
        }
        Ok(())
    }

    fn fill(&mut self, points: &[Point], colour: Colour) -> anyhow::Result<()> {
        let path: Vec<(i32, i32)> = points.iter().map(|&point| self.at(point)).collect();
        self.backend.fill_polygon(path, &rgb(colour)).map_err(failed)
    }

    fn disc(&mut self, at: Point, radius: f64, colour: Colour) -> anyhow::Result<()> {
        let (centre, radius) = (self.at(at), (radius * self.scale).round() as u32);
        self.backend.draw_circle(centre, radius, &rgb(colour), true).map_err(failed)
    }

    fn text(&mut self, text: &str, at: Point, style: Text) -> anyhow::Result<()> {
        let face = if style.bold { FontStyle::Bold } else { FontStyle::Normal };
        let lower = self.lower * style.size;
        let at = if style.upright { (at.0 + lower, at.1) } else { (at.0, at.1 + lower) };
        let h_pos = match style.anchor {
            0 => HPos::Center,
            1 => HPos::Right,
            _ => HPos::Left,
        };
        let turn = if style.upright { FontTransform::Rotate270 } else { FontTransform::None };
        let font = ("sans-serif", style.size * self.scale, face).into_font().transform(turn);
        let style = font.color(&rgb(style.colour)).pos(Pos::new(h_pos, VPos::Center)).into_text_style(&(1, 1));
        let at = self.at(at);
        self.backend.draw_text(text, &style, at).map_err(failed)
    }
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

/// Draws an SVG.
pub fn svg(size: (u32, u32), draw: impl FnOnce(&mut dyn Canvas) -> anyhow::Result<()>) -> anyhow::Result<String> {
    let mut text = String::new();
    let mut canvas = On { backend: SVGBackend::with_string(&mut text, size), scale: 1.0, lower: 0.0 };
    paper(&mut canvas, size)?;
    draw(&mut canvas)?;
    canvas.backend.present().map_err(failed)?;
    drop(canvas);
    Ok(text)
}

/// Draws a PNG.
pub fn png(path: &Path, size: (u32, u32), draw: impl FnOnce(&mut dyn Canvas) -> anyhow::Result<()>) -> anyhow::Result<()> {
    let large = (size.0 * OVERSAMPLING, size.1 * OVERSAMPLING);
    let mut pixels = vec![255; 3 * large.0 as usize * large.1 as usize];
    let mut canvas = On { backend: BitMapBackend::with_buffer(&mut pixels, large), scale: f64::from(OVERSAMPLING), lower: 0.18 };
    draw(&mut canvas)?;
    canvas.backend.present().map_err(failed)?;
    drop(canvas);
    let (width, height, step) = (size.0 as usize, size.1 as usize, OVERSAMPLING as usize);
    let mut small = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let index = |dx: usize, dy: usize| 3 * ((step * y + dy) * step * width + step * x + dx) + channel;
                let sum: usize = (0..step * step).map(|k| usize::from(pixels[index(k % step, k / step)])).sum();
                small.push((sum / (step * step)) as u8);
            }
        }
    }
    let mut out = BitMapBackend::new(path, size);
    out.blit_bitmap((0, 0), size, &small).map_err(failed)?;
    out.present().map_err(failed)
}

/// A white background: SVG viewers may have a dark one.
fn paper<B: DrawingBackend>(canvas: &mut On<B>, (width, height): (u32, u32)) -> anyhow::Result<()> {
    canvas.backend.draw_rect((0, 0), (width as i32, height as i32), &rgb((255, 255, 255)), true).map_err(failed)
}
