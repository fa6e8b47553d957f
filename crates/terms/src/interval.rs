//! A median and its confidence interval.

/// A median with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Interval {
    /// The sample median.
    pub median: f64,
    /// Lower end; one of the observed values.
    pub low: f64,
    /// Upper end; one of the observed values.
    pub high: f64,
    /// Probability that the interval covers the true median; 0 for a single value.
    pub coverage: f64,
    /// Number of observed values.
    pub count: usize,
}

impl Interval {
    /// The lower and the upper end; `None` for a single value, which has no interval.
    pub fn ends(&self) -> Option<[f64; 2]> {
        (self.count > 1).then_some([self.low, self.high])
    }

    /// Whether `value` lies outside the interval. A single value excludes nothing.
    pub fn excludes(&self, value: f64) -> bool {
        self.ends().is_some_and(|[low, high]| value < low || value > high)
    }

    /// Returns the interval with all values multiplied by `by`, which must be positive.
    pub fn scaled(self, by: f64) -> Interval {
        let Interval { median, low, high, .. } = self;
        Interval { median: by * median, low: by * low, high: by * high, ..self }
    }

    /// Returns the interval of exp(x), given the interval of x.
    pub fn exp(self) -> Interval {
        Interval { median: self.median.exp(), low: self.low.exp(), high: self.high.exp(), ..self }
    }
}
