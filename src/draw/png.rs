//! A picture's pixels.

use std::sync::Arc;

use anyhow::{Context, anyhow, ensure};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};

/// Pixels per unit of the SVG: sharp on paper and on fine screens.
const SCALE: f32 = 2.0;
/// The most pixels along a side.
const MOST: u32 = 16_384;

/// A text of SVG as the bytes of a PNG, twice as large, with the fonts that the program brings.
pub fn png(svg: &str) -> anyhow::Result<Vec<u8>> {
    let mut fonts = Database::new();
    fonts.load_font_data(include_bytes!("../../assets/DejaVuSans-subset.ttf").to_vec());
    fonts.load_font_data(include_bytes!("../../assets/DejaVuSans-Bold-subset.ttf").to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    let options = Options { fontdb: Arc::new(fonts), font_family: "DejaVu Sans".into(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).context("the picture is no SVG")?;
    let [width, height] = [tree.size().width(), tree.size().height()].map(|side| (side * SCALE).ceil() as u32);
    ensure!(width <= MOST && height <= MOST, "the picture has {width} x {height} pixels; a PNG holds {MOST} along a side: write SVG");
    let mut pixels = Pixmap::new(width, height).ok_or_else(|| anyhow!("no memory for {width} x {height} pixels; write SVG"))?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| anyhow!("the picture cannot be written as PNG: {error}"))
}
