//! Draws lines, shapes and text into an SVG, with coordinates in layout units.

use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontStyle, FontTransform, IntoFont, IntoTextStyle, RGBColor, ShapeStyle,
};

use crate::figure::style::{Colour, FAINT, INK, Marker, WHITE, ink_on};

pub type Point = (f64, f64);

#[derive(Clone, Copy)]
pub struct Text {
    size: f64,
    colour: Colour,
    bold: bool,
    anchor: HPos,
    /// True for text that runs from bottom to top.
    upright: bool,
}

impl Text {
    pub const fn new(size: f64, colour: Colour) -> Text {
        Text { size, colour, bold: false, anchor: HPos::Left, upright: false }
    }
    pub const fn centred(self) -> Text {
        Text { anchor: HPos::Center, ..self }
    }
    pub const fn ending(self) -> Text {
        Text { anchor: HPos::Right, ..self }
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

/// The surface that a figure is drawn on. Drawing cannot fail: plotters writes to a string.
pub struct Canvas<'a>(SVGBackend<'a>);

/// Lengths of a dash and of the gap, as SVG writes them.
pub type Dash = &'static str;
const DASHES: [Dash; 5] = ["2 3", "3 4", "5 4", "6 5", "10 4"];

/// Draws an SVG on a white background, because a viewer may have a dark one.
pub fn svg([width, height]: [f64; 2], draw: impl FnOnce(&mut Canvas)) -> String {
    let (mut text, size) = (String::new(), (width as u32, height as u32));
    let mut canvas = Canvas(SVGBackend::with_string(&mut text, size));
    canvas.rect((0.0, 0.0), (size.0.into(), size.1.into()), WHITE);
    draw(&mut canvas);
    drop(canvas);
    // A renderer assumes these values, or takes them from the outer element. Without them the text
    // is a third shorter.
    const FONT: &str = " font-family=\"sans-serif\"";
    for default in [" opacity=\"1\"", " stroke-width=\"1\"", " stroke=\"none\"", FONT] {
        text = text.replace(default, "");
    }
    for (k, dash) in DASHES.iter().enumerate() {
        let [from, to] =
            [format!(" opacity=\"0.{}\"", k + 1), format!(" stroke-dasharray=\"{dash}\"")];
        text = text.replace(&from, &to);
    }
    text.replacen("<svg", &format!("<svg{FONT}"), 1)
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

impl Canvas<'_> {
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
        // Plotters has no dashes: the opacity stands for them until the figure is complete.
        let place = DASHES.iter().position(|it| Some(*it) == dash);
        let alpha = place.map_or(1.0, |place| (place + 1) as f64 / 10.0);
        let width = width.round().max(1.0) as u32;
        let style =
            ShapeStyle { color: rgb(colour).mix(alpha), filled: false, stroke_width: width };
        let _ = match pixels(points).as_slice() {
            [] => Ok(()),
            &[from, to] => self.0.draw_line(from, to, &style),
            path => self.0.draw_path(path.iter().copied(), &style),
        };
    }

    pub fn fill(&mut self, points: &[Point], colour: Colour) {
        let _ = self.0.fill_polygon(pixels(points), &rgb(colour));
    }

    pub fn rect(&mut self, low: Point, high: Point, colour: Colour) {
        self.fill(&corners(low, high)[..4], colour);
    }

    pub fn frame(&mut self, low: Point, high: Point, width: f64, colour: Colour) {
        self.line(&corners(low, high), colour, width);
    }

    pub fn disc(&mut self, at: Point, radius: f64, colour: Colour) {
        let _ = self.0.draw_circle(pixel(at), radius.round() as u32, &rgb(colour), true);
    }

    /// Draws one line of text, vertically centred on the point.
    pub fn text(&mut self, text: &str, at: Point, style: Text) {
        let face = if style.bold { FontStyle::Bold } else { FontStyle::Normal };
        let turn = if style.upright { FontTransform::Rotate270 } else { FontTransform::None };
        let style = ("sans-serif", style.size, face)
            .into_font()
            .transform(turn)
            .color(&rgb(style.colour))
            .pos(Pos::new(style.anchor, VPos::Center))
            .into_text_style(&(1, 1));
        // XML has no control characters, not even escaped.
        let text = text.replace(char::is_control, " ");
        let _ = self.0.draw_text(&text, &style, pixel(at));
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

fn pixels(points: &[Point]) -> Vec<(i32, i32)> {
    points.iter().copied().map(pixel).collect()
}

fn rgb((r, g, b): Colour) -> RGBColor {
    RGBColor(r, g, b)
}
