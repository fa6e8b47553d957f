#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightLine {
    pub slope: f64,
    /// Standard error of the slope; `None` for two points, which any line fits.
    pub error: Option<f64>,
}

impl StraightLine {
    /// Returns `None` for fewer than two different x.
    pub fn fit(points: &[(f64, f64)]) -> Option<StraightLine> {
        let count = points.len() as f64;
        // x and y are centred, so that the sums do not cancel.
        let (x, y) = points.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
        let (x, y) = (x / count, y / count);
        let spread: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
        let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread;
        let residual: f64 = points.iter().map(|p| (p.1 - y - slope * (p.0 - x)).powi(2)).sum();
        let error = (points.len() > 2).then(|| (residual / (count - 2.0) / spread).sqrt());
        (spread > 0.0).then_some(StraightLine { slope, error })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_has_the_textbook_slope_and_error() {
        let line = StraightLine::fit(&[(1.0, 1.2), (2.0, 1.9), (3.0, 3.2), (4.0, 3.7)]).unwrap();
        assert!((line.slope - 0.88).abs() < 1e-12);
        assert!((line.error.unwrap() - (0.108_f64 / 2.0 / 5.0).sqrt()).abs() < 1e-12, "{line:?}");
        let two = StraightLine::fit(&[(1.0, 1e9), (2.0, 1e9 + 3.0)]).unwrap();
        assert_eq!((two.slope, two.error), (3.0, None));
        assert_eq!(StraightLine::fit(&[(2.0, 1.0), (2.0, 3.0)]), None);
        assert_eq!(StraightLine::fit(&[]), None);
    }
}
