//! Draws lines, shapes and text into an SVG, with coordinates in layout units.

use std::fmt::Write;

use crate::figure::style::{Colour, FAINT, INK, Marker, WHITE, ink_on};
use contactbench_terms::text::html;

pub type Point = (f64, f64);

#[derive(Clone, Copy)]
pub struct Text {
    size: f64,
    colour: Colour,
    bold: bool,
    anchor: &'static str,
    /// True for text that runs from bottom to top.
    upright: bool,
}

impl Text {
    pub const fn new(size: f64, colour: Colour) -> Text {
        Text { size, colour, bold: false, anchor: "start", upright: false }
    }
    pub const fn centred(self) -> Text {
        Text { anchor: "middle", ..self }
    }
    pub const fn ending(self) -> Text {
        Text { anchor: "end", ..self }
    }
    pub const fn of_size(self, size: f64) -> Text {
        Text { size, ..self }
    }
    pub const fn bold(self) -> Text {
        self.bold_if(true)
    }
    pub const fn bold_if(self, bold: bool) -> Text {
        Text { bold, ..self }
    }
    pub const fn upright(self) -> Text {
        Text { upright: true, ..self.centred() }
    }
}

/// The surface that a figure is drawn on: the text of its SVG.
pub struct Canvas(String);

/// Lengths of a dash and of the gap, as SVG writes them.
pub type Dash = &'static str;

/// Draws an SVG on a white background, because a viewer may have a dark one.
pub fn svg([width, height]: [f64; 2], draw: impl FnOnce(&mut Canvas)) -> String {
    let (width, height) = (width as u32, height as u32);
    let mut canvas = Canvas(format!(
        "<svg font-family=\"sans-serif\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 \
         {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\">\n"
    ));
    canvas.rect((0.0, 0.0), (width.into(), height.into()), WHITE);
    draw(&mut canvas);
    canvas.0 + "</svg>\n"
}

/// Returns about the width of a text of this height in DejaVu Sans, a wide font, in layout units.
pub fn width(text: &str, size: f64, bold: bool) -> f64 {
    let share = |letter: char| match letter {
        'i' | 'j' | 'l' | 'I' | ' ' | '.' | ',' | ':' | '\'' | '|' => 0.3,
        'f' | 'r' | 't' | '(' | ')' | '-' | '/' => 0.4,
        'm' | 'w' | 'M' | 'W' | '%' | '=' | '+' => 0.9,
        'A'..='Z' => 0.7,
        _ => 0.62,
    };
    let em = if bold { 0.9 * size } else { 0.8 * size };
    text.chars().map(|letter| share(letter) * em).sum()
}

pub const MARGIN: f64 = 24.0;
pub const HEADING: Text = Text::new(19.0, INK).bold();
pub const AXIS: Text = Text::new(19.0, INK).centred();

impl Canvas {
    pub fn heading(&mut self, title: &str, subtitle: &[String]) {
        self.text(title, (MARGIN, MARGIN + 12.0), Text::new(29.0, INK).bold());
        for (k, line) in subtitle.iter().enumerate() {
            self.text(line, (MARGIN, MARGIN + 42.0 + 22.0 * k as f64), Text::new(18.0, FAINT));
        }
    }

    pub fn line(&mut self, points: &[Point], colour: Colour, width: f64) {
        self.dashed(points, colour, width, None);
    }

    /// Draws a line. `dash` names its dashes as SVG does; `None` is a solid line.
    pub fn dashed(&mut self, points: &[Point], colour: Colour, width: f64, dash: Option<Dash>) {
        let width = width.round().max(1.0);
        let dash = dash.map_or(String::new(), |dash| format!(" stroke-dasharray=\"{dash}\""));
        let mut look = format!("{dash} stroke=\"{}\"", hex(colour));
        if width > 1.0 {
            let _ = write!(look, " stroke-width=\"{width}\"");
        }
        let _ = match *points {
            [] => Ok(()),
            [from, to] => {
                let ((x1, y1), (x2, y2)) = (pixel(from), pixel(to));
                let ends = format!("x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"");
                writeln!(self.0, "<line{look} {ends}/>")
            }
            _ => writeln!(self.0, "<polyline fill=\"none\"{look} points=\"{}\"/>", pixels(points)),
        };
    }

    pub fn fill(&mut self, points: &[Point], colour: Colour) {
        let (fill, points) = (hex(colour), pixels(points));
        let _ = writeln!(self.0, "<polygon fill=\"{fill}\" points=\"{points}\"/>");
    }

    pub fn rect(&mut self, low: Point, high: Point, colour: Colour) {
        self.fill(&corners(low, high)[..4], colour);
    }

    pub fn frame(&mut self, low: Point, high: Point, width: f64, colour: Colour) {
        self.line(&corners(low, high), colour, width);
    }

    pub fn disc(&mut self, at: Point, radius: f64, colour: Colour) {
        let ((x, y), r, fill) = (pixel(at), radius.round(), hex(colour));
        let _ = writeln!(self.0, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"{fill}\"/>");
    }

    /// Draws one line of text, vertically centred on the point.
    pub fn text(&mut self, text: &str, at: Point, style: Text) {
        let Text { size, colour, bold, anchor, upright } = style;
        let ((x, y), fill, text) = (pixel(at), hex(colour), html(text));
        let bold = if bold { " font-weight=\"bold\"" } else { "" };
        let turn = match upright {
            true => format!(" transform=\"rotate(270, {x}, {y})\""),
            false => String::new(),
        };
        let _ = writeln!(
            self.0,
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" text-anchor=\"{anchor}\" font-size=\"{}\" \
             fill=\"{fill}\"{bold}{turn}>\n{text}\n</text>",
            size / 1.24
        );
    }

    /// Draws a letter in a disc: the mark of a cell without a value.
    pub fn badge(&mut self, at: Point, letter: &str, colour: Colour) {
        self.disc(at, 7.5, colour);
        self.text(letter, at, Text::new(13.0, ink_on(colour)).bold().centred());
    }

    pub fn cross(&mut self, [a, b, c, d]: [Point; 4], colour: Colour) {
        self.line(&[a, b], colour, 2.0);
        self.line(&[c, d], colour, 2.0);
    }

    /// Draws a detector's marker with a white rim, which separates it from lines behind it.
    pub fn marker(&mut self, (x, y): Point, r: f64, marker: Marker, colour: Colour) {
        let shape = |r: f64, corners: &[Point]| -> Vec<Point> {
            corners.iter().map(|corner| (x + corner.0 * r, y + corner.1 * r)).collect()
        };
        let corners = match marker {
            Marker::Circle => {
                self.disc((x, y), 1.1 * r + 1.5, WHITE);
                return self.disc((x, y), 1.1 * r, colour);
            }
            Marker::Cross => return self.cross(slanted((x, y), r), colour),
            Marker::Plus => return self.cross(upright((x, y), 1.2 * r), colour),
            Marker::Square => &[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)][..],
            Marker::Up => &[(0.0, -1.25), (1.2, 0.9), (-1.2, 0.9)],
            Marker::Down => &[(0.0, 1.25), (1.2, -0.9), (-1.2, -0.9)],
            Marker::Diamond => &[(0.0, -1.35), (1.35, 0.0), (0.0, 1.35), (-1.35, 0.0)],
        };
        self.fill(&shape(r + 1.5, corners), WHITE);
        self.fill(&shape(r, corners), colour);
    }
}

/// Returns the end points of the two lines of an x-shaped marker.
pub fn slanted((x, y): Point, r: f64) -> [Point; 4] {
    [(x - r, y - r), (x + r, y + r), (x - r, y + r), (x + r, y - r)]
}

pub fn upright((x, y): Point, r: f64) -> [Point; 4] {
    [(x - r, y), (x + r, y), (x, y - r), (x, y + r)]
}

fn corners(low: Point, high: Point) -> [Point; 5] {
    [low, (high.0, low.1), high, (low.0, high.1), low]
}

/// Rounds to pixels. Large values saturate; NaN becomes 0.
fn pixel((x, y): Point) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

fn pixels(points: &[Point]) -> String {
    let pixels = points.iter().map(|&point| pixel(point));
    pixels.map(|(x, y)| format!("{x},{y} ")).collect()
}

fn hex((r, g, b): Colour) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}
