//! A picture's pixels.

use anyhow::{Context, anyhow, ensure};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use crate::present::svg::outline::outlined;

/// Pixels per unit of the SVG: sharp on paper and on fine screens.
const SCALE: f32 = 2.0;
/// The most pixels along a side.
const MOST: u32 = 16_384;

/// An SVG as the bytes of a PNG twice as large, with the fonts that the program brings.
pub fn png(svg: &str) -> anyhow::Result<Vec<u8>> {
    let tree = Tree::from_str(&outlined(svg)?, &Options::default())
        .context("the picture is not an SVG")?;
    let [width, height] =
        [tree.size().width(), tree.size().height()].map(|side| (side * SCALE).ceil() as u32);
    ensure!(
        width <= MOST && height <= MOST,
        "the picture has {width} x {height} pixels; a PNG holds {MOST} along a side: write SVG"
    );
    let mut pixels = Pixmap::new(width, height)
        .ok_or_else(|| anyhow!("no memory for {width} x {height} pixels; write SVG"))?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| anyhow!("the picture cannot be written as PNG: {error}"))
}
