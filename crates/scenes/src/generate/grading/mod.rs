//! Grading curves: the percentage of a soil, by volume, that passes each sieve.
//!
//! ```text
//!   percent passing          text or CSV: sieve size, percent passing; # begins a comment
//!   100 |            .--o
//!       |         .o'           0.063   0
//!       |   .-o--'              0.2    15
//!     0 o-'                     0.63   60
//!       '---------------->      2     100
//!         log sieve size
//! ```
//!
//! Between two sieves the curve is linear in the logarithm of the size, as grading curves are drawn
//! on paper. In d dimensions the number of particles there has the density size^(-d - 1); the
//! volume of a disc is its area. Sizes may have any unit; the largest becomes r. Percentages by
//! mass are the same if all particles have one density.

use std::io::Read;
use std::path::Path;

use anyhow::{Context, bail, ensure};

use contactbench_io::short;

/// Maximum size of a file, in bytes.
const MOST_BYTES: u64 = 1 << 20;
/// Maximum ratio of two sizes; its cube is finite.
const MOST_RATIO: f64 = 1e100;

/// Sieve sizes and the percentage that passes each. Sizes ascend; percentages rise from 0 to 100.
#[derive(Debug)]
pub struct Curve(Vec<[f64; 2]>);

/// Returns whether the text holds points, as in `0.063 0, 0.2 15, 2 100`, instead of a file name.
pub fn is_points(text: &str) -> bool {
    text.split(',').all(|piece| point(piece).is_some())
}

impl Curve {
    /// Reads the text of a file with a point per line, or points separated by commas.
    pub fn new(text: &str) -> anyhow::Result<Curve> {
        if is_points(text) {
            let points = text.split(',').filter_map(point).collect();
            return Curve::of(points).with_context(|| format!("grading '{text}'"));
        }
        let path = Path::new(text);
        Curve::read(path).with_context(|| format!("the grading curve {}", path.display()))
    }

    fn read(path: &Path) -> anyhow::Result<Curve> {
        let mut text = String::new();
        let file = std::fs::File::open(path).context("cannot be read")?;
        file.take(MOST_BYTES + 1).read_to_string(&mut text).context("cannot be read as text")?;
        ensure!(
            text.len() as u64 <= MOST_BYTES,
            "has more than {MOST_BYTES} bytes; give one line per sieve"
        );
        let mut points = Vec::new();
        for (line, number) in text.trim_start_matches('\u{feff}').lines().zip(1..) {
            let line = line.split('#').next().unwrap_or_default().trim();
            match point(line) {
                Some(point) => points.push(point),
                // A header with the names of the columns.
                None if points.is_empty() && !line.contains(|c: char| c.is_ascii_digit()) => {}
                None if line.is_empty() => {}
                None => {
                    bail!("line {number} is '{}'; write size and percent: 0.2, 15", short(line))
                }
            }
        }
        Curve::of(points)
    }

    fn of(points: Vec<[f64; 2]>) -> anyhow::Result<Curve> {
        let sound = |&[size, percent]: &[f64; 2]| size > 0.0 && size.is_finite() && percent >= 0.0;
        let rises = |two: &[[f64; 2]]| two[0][0] < two[1][0] && two[0][1] <= two[1][1];
        let ends = [points.first(), points.last()].map(|point| point.map(|[_, percent]| *percent));
        for (holds, must) in [
            (points.iter().all(sound), "must have sizes over 0, and percent of at least 0"),
            (points.windows(2).all(rises), "must rise: sizes, each once, and percent that passes"),
            (ends == [Some(0.0), Some(100.0)], "must begin at 0 percent and end at 100"),
        ] {
            ensure!(holds, "{must}");
        }
        let curve = Curve(points);
        let ratio = curve.ratio();
        ensure!(ratio <= MOST_RATIO, "has sizes {ratio:e} apart; at most {MOST_RATIO:e}");
        Ok(curve)
    }

    /// Returns the intervals that contain particles, the coarsest first. Each holds the smaller
    /// size, the larger size, and the percentage between them.
    fn intervals(&self) -> impl Iterator<Item = [f64; 3]> {
        let interval = |pair: &[[f64; 2]]| [pair[0][0], pair[1][0], pair[1][1] - pair[0][1]];
        self.0.windows(2).rev().map(interval).filter(|[_, _, percent]| *percent > 0.0)
    }

    fn ratio(&self) -> f64 {
        let ends = |(_, largest): (f64, f64), [low, high, _]: [f64; 3]| (low, largest.max(high));
        let (least, largest) = self.intervals().fold((1.0, 0.0), ends);
        largest / least
    }

    /// Returns n sizes in descending order, relative to the largest. The fraction of all particles
    /// above each is 0, 1/(n-1), .. 1.
    pub fn quantiles(&self, n: u64, dim: u32) -> impl Iterator<Item = f64> + use<> {
        let power = f64::from(dim);
        let largest = self.intervals().map(|[_, high, _]| high).fold(0.0, f64::max);
        // Each interval holds the number of particles above its lower end, the number inside, its
        // upper end, and the ratio of its ends to the power `dim`, minus 1.
        let mut above = 0.0;
        let parts: Vec<[f64; 4]> = self
            .intervals()
            .map(|[low, high, percent]| {
                let (ratio, high) = (high / low, high / largest);
                let more = libm::pow(ratio, power) - 1.0;
                let own = percent / libm::log(ratio) * more / libm::pow(high, power);
                above += own;
                [above, own, high, more]
            })
            .collect();
        let last = n.saturating_sub(1).max(1) as f64;
        let mut at = 0;
        (0..n).map(move |k| {
            let wanted = k as f64 / last * above;
            while at + 1 < parts.len() && parts[at][0] < wanted {
                at += 1;
            }
            let [above, own, high, more] = parts[at];
            let part = (1.0 - (above - wanted) / own).clamp(0.0, 1.0);
            high * libm::pow(1.0 + part * more, -1.0 / power)
        })
    }
}

/// Parses a size and a percentage, separated by a comma, a semicolon or spaces.
fn point(text: &str) -> Option<[f64; 2]> {
    let mut numbers = text
        .split(|c: char| c == ',' || c == ';' || c.is_whitespace())
        .filter(|piece| !piece.is_empty())
        .map(|piece| piece.parse().ok());
    match [numbers.next(), numbers.next(), numbers.next()] {
        [Some(size), Some(percent), None] => Some([size?, percent?]),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
