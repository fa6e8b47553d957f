//! How radii are parted into levels.

use std::fmt;

use super::levels::MOST_LEVELS;

/// Where the borders of levels are.
#[derive(Clone, Debug, PartialEq)]
pub enum Parting {
    /// The largest radius divided by a ratio, again and again; none: all sizes in one level.
    Ratio(Option<f64>),
    /// As given.
    Borders(Borders),
    /// Where a model of the work is least.
    Optimal,
}

/// The largest radii of all levels but the coarsest, the smallest first.
#[derive(Clone, Debug, PartialEq)]
pub struct Borders(Vec<f64>);

impl Borders {
    /// From radii as in `0.1/0.3/1`: finite, over 0 and rising; none if they are not, or too many.
    pub fn parse(text: &str) -> Option<Borders> {
        let mut radii = Vec::new();
        let mut last = 0.0;
        for piece in text.split('/') {
            let radius: f64 = piece.trim().parse().ok()?;
            if !(radius.is_finite() && radius > last) || radii.len() == MOST_LEVELS - 1 {
                return None;
            }
            radii.push(radius);
            last = radius;
        }
        Some(Borders(radii))
    }

    /// The smallest first.
    pub fn radii(&self) -> &[f64] {
        &self.0
    }
}

impl fmt::Display for Borders {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let radii: Vec<String> = self.radii().iter().map(f64::to_string).collect();
        f.write_str(&radii.join("/"))
    }
}
