//! A median and its confidence interval.

/// A median with an interval that covers the true median with probability `coverage`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Interval {
    /// The sample median.
    pub median: f64,
    /// Lower end: an observed value.
    pub low: f64,
    /// Upper end: an observed value.
    pub high: f64,
    /// Probability that such an interval covers the true median; 0 for a single value.
    pub coverage: f64,
    /// How many values there were.
    pub count: usize,
}

impl Interval {
    /// Is `value` outside?
    pub fn excludes(&self, value: f64) -> bool {
        self.count > 1 && (value < self.low || value > self.high)
    }

    /// The interval of `by` times the value, `by` being positive.
    pub fn scaled(self, by: f64) -> Interval {
        let Interval { median, low, high, .. } = self;
        Interval { median: by * median, low: by * low, high: by * high, ..self }
    }

    /// The interval of exp(x), for an interval of x.
    pub fn exp(self) -> Interval {
        Interval { median: self.median.exp(), low: self.low.exp(), high: self.high.exp(), ..self }
    }
}
