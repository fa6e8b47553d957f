//! Growth of a quantity with n: the free exponent, and the choice among the laws N, N log N and N².
//!
//! Fits use logarithms: ln y = ln c + ln f(N) with one scale c per law, so that residuals are
//! relative. Laws are compared by AICc. The method is meant for operation counts: cache effects
//! make the *time* of a linear algorithm fit N log N.
//!
//! No law is chosen in these cases:
//! * Fewer than five different N, or a span below a factor of eight: there log N is nearly
//!   constant.
//! * The AICc of the runner-up is within 4 of the best (the usual mark of "considerably less
//!   support").
//! * The best law leaves a trend: its exponent, averaged over the same N, differs from the free
//!   exponent by more than 0.1, or by more than 0.05 over the upper half of the N.
//!
//! Without the last rule, N^1.5 would be called N log N. Over 10² to 10⁵, the exponents of N and N
//! log N differ by about 0.13, hence 0.1. The upper half shows the asymptotic law better, because a
//! surface or constant term fades with N, hence 0.05. A constant term that fades is accepted: 4N +
//! 100 is N.

use crate::stats::line::StraightLine;

/// Smallest relative residual that improves a fit. Exact counts can fit a law exactly; without this
/// limit, AICc would be minus infinity, and deviations of 10^-6 would decide between laws.
pub const FLOOR: f64 = 1e-3;
pub const LEAST_POINTS: usize = 5;
pub const LEAST_SPAN: f64 = 8.0;
pub const LEAST_DELTA: f64 = 4.0;
/// Largest difference between the free exponent and the law's.
pub const TREND: f64 = 0.1;
/// Like [`TREND`], over the upper half of the N.
pub const UPPER_TREND: f64 = 0.05;

/// Largest difference between the exponent over the last [`OCTAVES`] and the law's. Boundary terms
/// of order N^((D-1)/D) move exponents of detectors by up to 0.023; a factor N^0.05 moves them by
/// 0.05.
pub const LIMIT: f64 = 0.03;
/// Number of doublings of N, counted from the end of a series, over which [`Tail`] is measured.
pub const OCTAVES: i32 = 5;
/// Smallest N that [`Tail`] uses; in smaller scenes, boundaries have too much weight.
pub const LEAST_TAIL: f64 = 1000.0;

contactbench_terms::named! {
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Model {
        Linear = "N",
        Linearithmic = "N log N",
        Quadratic = "N²",
    }
}

impl Model {
    /// Parses `N`, `N log N`, `N^2` or `N²`.
    pub fn parse(text: &str) -> Option<Model> {
        let text = text.replace("^2", "²");
        Model::ALL.into_iter().find(|model| model.name() == text)
    }

    pub fn at(self, n: f64) -> f64 {
        match self {
            Model::Linear => n,
            Model::Linearithmic => n * n.log2(),
            Model::Quadratic => n * n,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    pub exponent: f64,
    pub low: f64,
    pub high: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The chosen law, or the reason why none is chosen.
    pub law: Result<Model, String>,
    pub slope: Option<Slope>,
    pub scores: Vec<(Model, f64)>,
}

impl Choice {
    pub fn delta(&self) -> Option<f64> {
        Some(self.scores.get(1)?.1 - self.scores.first()?.1)
    }
}

/// Returns (ln N, ln y) for each N. Several y at one N are averaged; values without a logarithm are
/// dropped.
fn logs(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = points
        .iter()
        .filter(|(n, y)| *n >= 2.0 && *y > 0.0 && n.is_finite() && y.is_finite())
        .map(|(n, y)| (n.ln(), y.ln()))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points
        .chunk_by(|a, b| a.0 == b.0)
        .filter_map(|same| {
            Some((same.first()?.0, same.iter().map(|p| p.1).sum::<f64>() / same.len() as f64))
        })
        .collect()
}

/// The free exponent of y = c N^b; `None` with fewer than three different N.
pub fn slope(points: &[(f64, f64)]) -> Option<Slope> {
    let points = logs(points);
    let line = StraightLine::fit(&points)?;
    let half = student(points.len() - 2) * line.error?;
    Some(Slope { exponent: line.slope, low: line.slope - half, high: line.slope + half })
}

/// Returns the 97.5% point of Student's t. It is exact for 1 and 2 degrees of freedom; for 3, the
/// Cornish-Fisher expansion is 0.13% too small, and for more it is closer.
fn student(freedom: usize) -> f64 {
    match freedom {
        0 | 1 => 12.7062,
        2 => 4.30265,
        _ => {
            let (z, v) = (1.959_963_985_f64, freedom as f64);
            let first = (z.powi(3) + z) / 4.0;
            let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
            let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
            let fourth = (79.0 * z.powi(9) + 776.0 * z.powi(7) + 1482.0 * z.powi(5)
                - 1920.0 * z.powi(3)
                - 945.0 * z)
                / 92160.0;
            z + first / v + second / v.powi(2) + third / v.powi(3) + fourth / v.powi(4)
        }
    }
}

/// The exponent measured over the last octaves of N, and that of the law over the same N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tail {
    pub sizes: [f64; 2],
    pub found: f64,
    pub law: f64,
}

/// The exponent of logarithmic points, and that of a law at the same N.
fn exponents(points: &[(f64, f64)], law: Model) -> Option<(f64, f64)> {
    let of_law: Vec<_> = points.iter().map(|(x, _)| (*x, law.at(x.exp()).ln())).collect();
    Some((StraightLine::fit(points)?.slope, StraightLine::fit(&of_law)?.slope))
}

impl Tail {
    /// Returns `None` if the last octaves have fewer than three different N, span less than
    /// [`LEAST_SPAN`], or start below [`LEAST_TAIL`].
    pub fn new(points: &[(f64, f64)], law: Model) -> Option<Tail> {
        let all = logs(points);
        let last = all.last()?.0;
        let from = last - f64::from(OCTAVES) * std::f64::consts::LN_2;
        // In a series with two N per decade, the fourth last N lies 5.06 octaves below the last.
        let there = &all[all.partition_point(|point| point.0 < from - 0.1)..];
        let first = there.first()?.0;
        let short = last - first < LEAST_SPAN.ln() * (1.0 - 1e-9);
        if there.len() < 3 || short || first < LEAST_TAIL.ln() * (1.0 - 1e-9) {
            return None;
        }
        let (found, law) = exponents(there, law)?;
        Some(Tail { sizes: [first.exp().round(), last.exp().round()], found, law })
    }

    pub fn is_off(&self) -> bool {
        (self.found - self.law).abs() > LIMIT
    }
}

pub fn choose(points: &[(f64, f64)]) -> Choice {
    let kept = logs(points);
    let scores = scores(&kept);
    let law = match points.iter().all(|(_, y)| *y > 0.0 && y.is_finite()) {
        true => law(&kept, &scores),
        false => Err("a value is not positive".into()),
    };
    Choice { law, slope: slope(points), scores }
}

/// Returns the best law, or the reason why none is chosen. Points are logarithms, sorted by N.
fn law(points: &[(f64, f64)], scores: &[(Model, f64)]) -> Result<Model, String> {
    let (Some(first), Some(last), [(best, least), (second, next), ..], LEAST_POINTS..) =
        (points.first(), points.last(), scores, points.len())
    else {
        let found = points.len();
        return Err(format!("only {found} distinct N, at least {LEAST_POINTS} are needed"));
    };
    let (span, delta) = ((last.0 - first.0).exp(), next - least);
    if span < LEAST_SPAN * (1.0 - 1e-9) {
        return Err(format!("N spans only a factor of {span:.1}, at least {LEAST_SPAN} is needed"));
    }
    let [name, other] = [best, second].map(|model| model.name());
    if delta < LEAST_DELTA {
        return Err(format!("{name} and {other} fit about equally well (ΔAICc {delta:.1})"));
    }
    match trend(points, *best) {
        None => Ok(*best),
        Some((part, found, expected)) => Err(format!(
            "{name} fits best but leaves a trend{part}: exponent {found:.3}, not {expected:.3}"
        )),
    }
}

/// AICc of every law, best first. All have two parameters (scale and variance), so only the
/// residuals decide.
fn scores(points: &[(f64, f64)]) -> Vec<(Model, f64)> {
    let n = points.len() as f64;
    if points.len() < 4 {
        return Vec::new();
    }
    let score = |model: Model| {
        let gaps: Vec<f64> = points.iter().map(|(x, y)| y - model.at(x.exp()).ln()).collect();
        let scale = gaps.iter().sum::<f64>() / n;
        let variance = gaps.iter().map(|gap| (gap - scale).powi(2)).sum::<f64>() / n;
        n * variance.max(FLOOR * FLOOR).ln() + 4.0 + 12.0 / (n - 3.0)
    };
    let mut scores: Vec<(Model, f64)> =
        Model::ALL.into_iter().map(|model| (model, score(model))).collect();
    scores.sort_by(|a, b| a.1.total_cmp(&b.1));
    scores
}

/// Whether the residuals of `best` have a trend in N: where, the exponent found, and that of
/// `best`.
fn trend(points: &[(f64, f64)], best: Model) -> Option<(&'static str, f64, f64)> {
    let half = &points[points.len() / 2 - usize::from(points.len() < 6)..];
    for (part, limit, place) in
        [(points, TREND, ""), (half, UPPER_TREND, " over the upper half of the N")]
    {
        let (found, expected) = exponents(part, best)?;
        if (found - expected).abs() > limit {
            return Some((place, found, expected));
        }
    }
    None
}

#[cfg(test)]
mod tests;
