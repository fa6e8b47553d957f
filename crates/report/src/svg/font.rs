//! The width of a text in the font that figures are laid out for.
//!
//! Letters stand at their advance widths, without kerning.

use std::sync::LazyLock;

use anyhow::Context;
use ttf_parser::Face;

type Loaded = LazyLock<Option<Face<'static>>>;

static REGULAR: Loaded =
    LazyLock::new(|| Face::parse(include_bytes!("../../assets/DejaVuSans-subset.ttf"), 0).ok());
static BOLD: Loaded = LazyLock::new(|| {
    Face::parse(include_bytes!("../../assets/DejaVuSans-Bold-subset.ttf"), 0).ok()
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

    /// The width of a text, in pixels.
    pub fn width(&self, text: &str) -> f64 {
        text.chars().map(|letter| self.advance(letter)).sum()
    }

    fn advance(&self, letter: char) -> f64 {
        let glyph = self.face.glyph_index(letter).unwrap_or_default();
        f64::from(self.face.glyph_hor_advance(glyph).unwrap_or_default()) * self.scale
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
    }
}
