//! From lengths of the scene to pixels, and to text of SVG.

use std::fmt::Write;

/// The drawing's place on the sheet, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    low: [f64; 2],
    /// Pixels per length.
    scale: f64,
    /// Left and bottom of the drawing.
    corner: [f64; 2],
    /// Width and height of the drawing.
    pub size: [f64; 2],
}

impl Frame {
    /// Fits a box into at most `most` pixels, below a header of `top` pixels; with a margin all around.
    pub fn around([low, high]: [[f64; 2]; 2], most: [f64; 2], top: f64) -> Frame {
        const MARGIN: f64 = 14.0;
        const LEAST: [f64; 2] = [420.0, 60.0];
        let extent = [high[0] - low[0], high[1] - low[1]];
        let longest = extent[0].max(extent[1]);
        // A single point: any scale will do.
        let extent = if longest > 0.0 { extent } else { [1.0, 1.0] };
        let fits = |k: usize| if extent[k] > 0.0 { most[k] / extent[k] } else { f64::INFINITY };
        let scale = fits(0).min(fits(1));
        let drawn = extent.map(|x| x * scale);
        let size = [0, 1].map(|k| drawn[k].max(LEAST[k]) + 2.0 * MARGIN);
        let corner = [0.5 * (size[0] - drawn[0]), top + 0.5 * (size[1] + drawn[1])];
        Frame { low, scale, corner, size }
    }

    /// Where a point is; y points up in the scene and down on the sheet.
    pub fn at(&self, point: [f64; 2]) -> [f64; 2] {
        [self.corner[0] + (point[0] - self.low[0]) * self.scale, self.corner[1] - (point[1] - self.low[1]) * self.scale]
    }

    /// How long a length is.
    pub fn length(&self, length: f64) -> f64 {
        length * self.scale
    }
}

/// A number of pixels with two decimals at most.
pub fn px(x: f64) -> String {
    let mut text = format!("{x:.2}");
    if text.contains('.') {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    }
    if text == "-0" { "0".into() } else { text }
}

/// `M x y L x y`, for a path.
pub fn segment(path: &mut String, a: [f64; 2], b: [f64; 2]) {
    // Writing to a string cannot fail.
    let _ = write!(path, "M{} {}L{} {}", px(a[0]), px(a[1]), px(b[0]), px(b[1]));
}

/// Text as XML and HTML hold it; characters that neither may hold become U+FFFD.
pub fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            '\t' | '\n' => safe.push(' '),
            '\0'..' ' | '\u{7f}'..'\u{a0}' | '\u{fffe}' | '\u{ffff}' => safe.push('\u{fffd}'),
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_text_is_safe() {
        assert_eq!([0.0, -0.001, 1.0, 12.5, 100.0, -4.25999].map(px), ["0", "0", "1", "12.5", "100", "-4.26"]);
        assert_eq!(escaped("<a href=\"x\">&'\u{1}\n"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;\u{fffd} ");
    }

    #[test]
    fn every_box_fits_its_frame() {
        for (low, high) in
            [([0.0, 0.0], [1.0, 1.0]), ([1e15, -3.0], [1e15 + 1000.0, -2.0]), ([5.0, 5.0], [5.0, 5.0]), ([0.0, 0.0], [0.0, 1e-300])]
        {
            let frame = Frame::around([low, high], [960.0, 720.0], 40.0);
            for point in [low, high] {
                let [x, y] = frame.at(point);
                assert!((0.0..=frame.size[0]).contains(&x) && (40.0..=40.0 + frame.size[1]).contains(&y), "{low:?} {high:?}: {x} {y}");
            }
            assert!(frame.size[0] <= 1000.0 && frame.size[1] <= 760.0);
        }
    }
}
