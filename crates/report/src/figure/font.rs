//! The width of a text in DejaVu Sans, the font that figures are laid out for: the sum of the
//! letters' advance widths, without kerning.

use std::sync::LazyLock;

use ttf_parser::Face;

const LINE_HEIGHT: f64 = 1.24;

static FACES: LazyLock<[Option<Face<'static>>; 2]> = LazyLock::new(|| {
    let regular = include_bytes!("../../assets/DejaVuSans-subset.ttf");
    let bold = include_bytes!("../../assets/DejaVuSans-Bold-subset.ttf");
    [Face::parse(regular, 0).ok(), Face::parse(bold, 0).ok()]
});

/// Returns the width of a text of this height, in layout units.
pub fn width(text: &str, size: f64, bold: bool) -> f64 {
    let Some(face) = &FACES[usize::from(bold)] else { return 0.0 };
    let scale = size / LINE_HEIGHT / f64::from(face.units_per_em());
    let glyph = |letter: char| face.glyph_index(letter).unwrap_or_default();
    let advance = |letter| f64::from(face.glyph_hor_advance(glyph(letter)).unwrap_or_default());
    text.chars().map(|letter| advance(letter) * scale).sum()
}

#[test]
fn a_text_is_as_wide_as_its_letters() {
    let (one, two) = (width("N²", 20.0, false), width("N²N²", 20.0, false));
    assert!((two - 2.0 * one).abs() < 1e-9 && width("N²", 20.0, true) > one && one > 0.0);
}
