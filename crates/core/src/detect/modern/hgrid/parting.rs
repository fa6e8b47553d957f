//! How radii are divided into levels.

use std::fmt;

use super::levels::MOST_LEVELS;

/// Choice of the radii at which levels are divided.
#[derive(Clone, Debug, PartialEq)]
pub enum Parting {
    /// Borders at the largest radius divided by powers of a ratio; `None` puts all sizes in one
    /// level.
    Ratio(Option<f64>),
    /// Borders at the given radii.
    Borders(Borders),
    /// Borders at the radii for which a model of the work is least.
    Optimal,
}

/// Largest radii of all levels except the coarsest, in ascending order.
#[derive(Clone, Debug, PartialEq)]
pub struct Borders(Vec<f64>);

impl Borders {
    /// Parses at most 31 radii such as `0.1/0.3/1`. Returns `None` unless they are finite, positive
    /// and ascending.
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

    /// Returns the radii in ascending order.
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
