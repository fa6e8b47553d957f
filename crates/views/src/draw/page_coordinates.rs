//! Conversion from coordinates of the scene to pixels of the page.

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PageCoordinates {
    low: [f64; 2],
    scale: f64,
    corner: [f64; 2],
    pub size: [f64; 2],
}

impl PageCoordinates {
    /// Scales a box to at most `most` pixels, with a margin, below a header of `top` pixels.
    pub fn around([low, high]: [[f64; 2]; 2], most: [f64; 2], top: f64) -> PageCoordinates {
        const MARGIN: f64 = 14.0;
        const LEAST: [f64; 2] = [420.0, 60.0];
        let extent = [high[0] - low[0], high[1] - low[1]];
        let longest = extent[0].max(extent[1]);
        // The scale of a single point is arbitrary.
        let extent = if longest > 0.0 { extent } else { [1.0, 1.0] };
        let fits = |k: usize| if extent[k] > 0.0 { most[k] / extent[k] } else { f64::INFINITY };
        let scale = fits(0).min(fits(1));
        let drawn = extent.map(|x| x * scale);
        let size = [0, 1].map(|k| drawn[k].max(LEAST[k]) + 2.0 * MARGIN);
        let corner = [0.5 * (size[0] - drawn[0]), top + 0.5 * (size[1] + drawn[1])];
        PageCoordinates { low, scale, corner, size }
    }

    /// Converts a point; the y axis points up in the scene and down on the page.
    pub fn at(&self, point: [f64; 2]) -> [f64; 2] {
        [
            self.corner[0] + (point[0] - self.low[0]) * self.scale,
            self.corner[1] - (point[1] - self.low[1]) * self.scale,
        ]
    }

    pub fn length(&self, length: f64) -> f64 {
        length * self.scale
    }
}
