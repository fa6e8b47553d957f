//! The fonts that the program brings: how wide a text is, and its outlines.
//!
//! Letters stand at their advance widths, without kerning.

use std::fmt::Write;
use std::sync::LazyLock;

use anyhow::Context;
use ttf_parser::{Face, OutlineBuilder};

use crate::present::svg::px;

type Loaded = LazyLock<Option<Face<'static>>>;

static REGULAR: Loaded =
    LazyLock::new(|| Face::parse(include_bytes!("../../../assets/DejaVuSans-subset.ttf"), 0).ok());
static BOLD: Loaded = LazyLock::new(|| {
    Face::parse(include_bytes!("../../../assets/DejaVuSans-Bold-subset.ttf"), 0).ok()
});

/// One face at one size.
pub struct Font {
    face: &'static Face<'static>,
    /// Pixels per unit of the font.
    scale: f64,
}

impl Font {
    /// DejaVu Sans, `size` pixels per em.
    pub fn new(size: f64, bold: bool) -> anyhow::Result<Font> {
        let face = if bold { &BOLD } else { &REGULAR };
        let face = face.as_ref().context("the embedded font cannot be read")?;
        Ok(Font { face, scale: size / f64::from(face.units_per_em()) })
    }

    /// The height of a small x, in pixels.
    pub fn x_height(&self) -> f64 {
        let glyph = self.face.glyph_index('x').and_then(|x| self.face.glyph_bounding_box(x));
        glyph.map_or(0.0, |outline| f64::from(outline.y_max)) * self.scale
    }

    /// The width of a text, in pixels.
    pub fn width(&self, text: &str) -> f64 {
        text.chars().map(|letter| self.advance(letter)).sum()
    }

    /// The outlines of a text that begins at `left` on the line `base`, as the data of a path.
    pub fn outline(&self, text: &str, left: f64, base: f64) -> String {
        let mut pen = Pen { path: String::new(), left, base, scale: self.scale };
        for letter in text.chars() {
            let glyph = self.face.glyph_index(letter).unwrap_or_default();
            // A glyph without outlines is a space.
            let _ = self.face.outline_glyph(glyph, &mut pen);
            pen.left += self.advance(letter);
        }
        pen.path
    }

    fn advance(&self, letter: char) -> f64 {
        let glyph = self.face.glyph_index(letter).unwrap_or_default();
        f64::from(self.face.glyph_hor_advance(glyph).unwrap_or_default()) * self.scale
    }
}

/// Writes outlines as the data of a path.
struct Pen {
    path: String,
    left: f64,
    base: f64,
    scale: f64,
}

impl Pen {
    fn draw(&mut self, command: char, points: &[(f32, f32)]) {
        self.path.push(command);
        for (k, &(x, y)) in points.iter().enumerate() {
            let x = px(self.left + f64::from(x) * self.scale);
            let y = px(self.base - f64::from(y) * self.scale);
            // Writing to a string cannot fail.
            let _ = write!(self.path, "{}{x} {y}", if k == 0 { "" } else { " " });
        }
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.draw('M', &[(x, y)]);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.draw('L', &[(x, y)]);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.draw('Q', &[(x1, y1), (x, y)]);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.draw('C', &[(x1, y1), (x2, y2), (x, y)]);
    }
    fn close(&mut self) {
        self.path.push('Z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_as_wide_as_its_letters() {
        let [regular, bold] = [false, true].map(|bold| Font::new(20.0, bold).unwrap());
        let (one, two) = (regular.width("N²"), regular.width("N²N²"));
        assert!((two - 2.0 * one).abs() < 1e-9 && bold.width("N²") > one, "{one} {two}");
        assert!((10.0..12.0).contains(&regular.x_height()), "{}", regular.x_height());
        assert_eq!(regular.outline(" ", 0.0, 0.0), "");
        // A vertical bar: one closed outline between the left end and the advance.
        let bar = regular.outline("|", 100.0, 50.0);
        assert!(bar.starts_with("M10") && bar.ends_with('Z'), "{bar}");
        assert_eq!(bar.matches('M').count(), 1);
    }
}
