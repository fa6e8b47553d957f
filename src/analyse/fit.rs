//! How a quantity grows with N: the free exponent, and the choice among N, N log N and N².
//!
//! All in logarithms: ln y = ln c + ln f(N), one scale c per model, so that a model is judged by relative residuals. Models are
//! compared by AICc. Meant for operation counts: a cache step makes the *time* of a truly linear algorithm fit N log N.
//!
//! "Cannot tell" is an answer, given when
//! * there are fewer than five distinct N, or they span less than a factor of eight: over that range log N is nearly constant;
//! * the runner-up is within 4 of the best AICc (the usual mark of "considerably less support");
//! * the best model leaves a trend: its exponent, averaged over the same N, differs from the free exponent by more than 0.1, or by
//!   more than 0.05 over the upper half of the N. Without this the least bad of three wrong models would win: N^1.5 would be called
//!   N log N. The gap between N and N log N is about 0.13 over 10² to 10⁵, hence 0.1; the upper half is the better witness of the
//!   asymptotic law (a surface or a constant term fades with N), hence the tighter limit there. A constant term is thus
//!   forgiven when it fades: 4N + 100 is N.

use nalgebra::{DMatrix, DVector};

/// The residual, as a relative deviation, below which a fit cannot become better. Counts are deterministic, so a model can be exact;
/// without the floor its AICc would be minus infinity, and deviations of a part in 10⁶ would decide between models.
pub const FLOOR: f64 = 1e-3;
/// Fewer distinct N than this cannot tell.
pub const LEAST_POINTS: usize = 5;
/// N must span this factor.
pub const LEAST_SPAN: f64 = 8.0;
/// The runner-up must be worse by this much.
pub const LEAST_DELTA: f64 = 4.0;
/// Largest difference of the free exponent from the model's.
pub const TREND: f64 = 0.1;
/// The same, over the upper half of the N.
pub const UPPER_TREND: f64 = 0.05;

/// A law of growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Model {
    /// Proportional to N.
    Linear,
    /// Proportional to N log N.
    Linearithmic,
    /// Proportional to N².
    Quadratic,
}

impl Model {
    /// All models, slowest growth first.
    pub const ALL: [Model; 3] = [Model::Linear, Model::Linearithmic, Model::Quadratic];

    /// The name in claims and reports.
    pub fn name(self) -> &'static str {
        match self {
            Model::Linear => "N",
            Model::Linearithmic => "N log N",
            Model::Quadratic => "N²",
        }
    }

    /// Reads a model: `N`, `N log N` (or `N log2 N`), `N^2` (or `N²`).
    pub fn parse(text: &str) -> Option<Model> {
        let compact: String = text.chars().filter(|c| !c.is_whitespace() && *c != '*').collect::<String>().to_lowercase();
        match compact.as_str() {
            "n" => Some(Model::Linear),
            "nlogn" | "nlog2n" | "nlog(n)" | "nlog2(n)" => Some(Model::Linearithmic),
            "n^2" | "n²" | "nn" => Some(Model::Quadratic),
            _ => None,
        }
    }

    /// f(N), up to its scale.
    pub fn at(self, n: f64) -> f64 {
        match self {
            Model::Linear => n,
            Model::Linearithmic => n * n.log2(),
            Model::Quadratic => n * n,
        }
    }
}

/// The exponent b of y = c N^b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// The exponent.
    pub exponent: f64,
    /// Its standard error.
    pub error: f64,
    /// Lower end of the 95% interval.
    pub low: f64,
    /// Upper end of the 95% interval.
    pub high: f64,
}

/// Which law fits.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The law, or none: cannot tell.
    pub model: Option<Model>,
    /// Why it cannot tell; empty when it can.
    pub why: String,
    /// The free exponent.
    pub slope: Option<Slope>,
    /// The models by AICc, best first.
    pub scores: Vec<(Model, f64)>,
}

impl Choice {
    /// How much worse the runner-up is.
    pub fn delta(&self) -> Option<f64> {
        Some(self.scores.get(1)?.1 - self.scores.first()?.1)
    }
}

/// (ln N, ln y) for the distinct N; several y at one N are averaged in logarithms. Points that have no logarithm are dropped.
fn logs(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> =
        points.iter().filter(|(n, y)| *n >= 2.0 && *y > 0.0 && n.is_finite() && y.is_finite()).map(|(n, y)| (n.ln(), y.ln())).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points
        .chunk_by(|a, b| a.0 == b.0)
        .filter_map(|same| Some((same.first()?.0, same.iter().map(|p| p.1).sum::<f64>() / same.len() as f64)))
        .collect()
}

/// Least squares of y = a + b x: (b, its standard error).
fn line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    if points.len() < 3 {
        return None;
    }
    // centred, so that the two columns are orthogonal and the matrix well conditioned
    let mean = points.iter().map(|p| p.0).sum::<f64>() / points.len() as f64;
    let matrix = DMatrix::from_fn(points.len(), 2, |row, column| if column == 0 { 1.0 } else { points[row].0 - mean });
    let right = DVector::from_iterator(points.len(), points.iter().map(|p| p.1));
    let solution = matrix.clone().svd(true, true).solve(&right, 1e-12).ok()?;
    let residual = (&matrix * &solution - right).norm_squared();
    let spread: f64 = points.iter().map(|p| (p.0 - mean).powi(2)).sum();
    if spread <= 0.0 {
        return None;
    }
    Some((solution[1], (residual / (points.len() - 2) as f64 / spread).sqrt()))
}

/// The free exponent of y = c N^b; none with fewer than three distinct N.
pub fn slope(points: &[(f64, f64)]) -> Option<Slope> {
    let points = logs(points);
    let (exponent, error) = line(&points)?;
    let half = student(points.len() - 2) * error;
    Some(Slope { exponent, error, low: exponent - half, high: exponent + half })
}

/// The 97.5% point of Student's t: exact for 1 and 2 degrees of freedom, else by the Cornish-Fisher expansion (error < 0.1%).
fn student(freedom: usize) -> f64 {
    match freedom {
        0 | 1 => 12.7062,
        2 => 4.30265,
        _ => {
            let (z, v) = (1.959_963_985_f64, freedom as f64);
            let first = (z.powi(3) + z) / 4.0;
            let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
            let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
            let fourth = (79.0 * z.powi(9) + 776.0 * z.powi(7) + 1482.0 * z.powi(5) - 1920.0 * z.powi(3) - 945.0 * z) / 92160.0;
            z + first / v + second / v.powi(2) + third / v.powi(3) + fourth / v.powi(4)
        }
    }
}

/// Chooses among the models, or says why it cannot.
pub fn choose(points: &[(f64, f64)]) -> Choice {
    let kept = logs(points);
    let mut choice = Choice { model: None, why: String::new(), slope: slope(points), scores: scores(&kept) };
    let span = match (kept.first(), kept.last()) {
        (Some(first), Some(last)) => (last.0 - first.0).exp(),
        _ => 1.0,
    };
    if points.iter().any(|(_, y)| !(*y > 0.0 && y.is_finite())) {
        choice.why = "a value is not positive".into();
    } else if kept.len() < LEAST_POINTS {
        choice.why = format!("only {} distinct N, at least {LEAST_POINTS} are needed", kept.len());
    } else if span < LEAST_SPAN * (1.0 - 1e-9) {
        choice.why = format!("N spans only a factor of {span:.1}, at least {LEAST_SPAN} is needed");
    } else if let (Some(delta), Some(&(best, _)), Some(&(second, _))) = (choice.delta(), choice.scores.first(), choice.scores.get(1)) {
        if delta < LEAST_DELTA {
            choice.why = format!("{} and {} fit about equally well (ΔAICc {delta:.1})", best.name(), second.name());
        } else if let Some(why) = trend(&kept, best) {
            choice.why = why;
        } else {
            choice.model = Some(best);
        }
    }
    choice
}

/// AICc of every model, best first. All have two parameters (scale and variance), so with equal penalties the residual decides.
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
    let mut scores: Vec<(Model, f64)> = Model::ALL.into_iter().map(|model| (model, score(model))).collect();
    scores.sort_by(|a, b| a.1.total_cmp(&b.1));
    scores
}

/// A sentence if the residuals of `model` still grow or fall with N.
fn trend(points: &[(f64, f64)], model: Model) -> Option<String> {
    let upper = &points[points.len() / 2 - usize::from(points.len() < 6)..];
    for (part, limit, place) in [(points, TREND, ""), (upper, UPPER_TREND, " over the upper half of the N")] {
        let law: Vec<(f64, f64)> = part.iter().map(|(x, _)| (*x, model.at(x.exp()).ln())).collect();
        let (found, expected) = (line(part)?.0, line(&law)?.0);
        if (found - expected).abs() > limit {
            return Some(format!("{} fits best but leaves a trend{place}: exponent {found:.3}, not {expected:.3}", model.name()));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: [f64; 7] = [100.0, 300.0, 1e3, 3e3, 1e4, 3e4, 1e5];

    fn of(f: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        N.iter().map(|&n| (n, f(n))).collect()
    }

    /// A fixed relative wobble of about one per cent.
    fn wobble(n: f64) -> f64 {
        1.0 + 0.01 * (n.ln() * 7.3).sin()
    }

    #[test]
    fn laws_are_recognised_exact_and_with_noise() {
        for (f, expected) in [
            (Box::new(|n: f64| 4.0 * n) as Box<dyn Fn(f64) -> f64>, Model::Linear),
            (Box::new(|n: f64| 4.0 * n + 100.0), Model::Linear),
            (Box::new(|n: f64| 3.0 * n - 2.0 * n.sqrt()), Model::Linear),
            (Box::new(|n: f64| n * n.log2()), Model::Linearithmic),
            (Box::new(|n: f64| 2.0 * n * n.log2() - 2.0 * n), Model::Linearithmic),
            (Box::new(|n: f64| n * (n - 1.0) / 2.0), Model::Quadratic),
        ] {
            for noisy in [false, true] {
                let choice = choose(&of(|n| f(n) * if noisy { wobble(n) } else { 1.0 }));
                assert_eq!(choice.model, Some(expected), "{choice:?}");
                // nothing scores better than the floor allows, however exact
                assert!(choice.scores.iter().all(|s| s.1.is_finite() && s.1 >= 7.0 * (FLOOR * FLOOR).ln()));
            }
        }
    }

    #[test]
    fn it_says_when_it_cannot_tell() {
        for (points, why) in [
            (of(|n| n.powf(1.5)), "trend"),
            (of(|n| n.powf(1.2)), "trend"),
            (of(|n| n.powf(0.8)), "trend"),
            (of(|n| n * n.log2().sqrt()), ""),
            (of(|n| n)[..4].to_vec(), "distinct"),
            ((1..=7).map(|k| (100.0 * f64::from(k), 100.0 * f64::from(k))).collect(), "factor"),
            (of(|n| n - 100.0), "positive"),
            (Vec::new(), "distinct"),
        ] {
            let choice = choose(&points);
            assert!(choice.model.is_none() && !choice.why.is_empty() && choice.why.contains(why), "{why}: {choice:?}");
        }
    }

    #[test]
    fn a_surface_term_is_not_called_n_log_n() {
        // contacts of a lattice block: the surface, of order N^(2/3), has fewer
        let choice = choose(&of(|n| 6.0 * n - 9.0 * n.powf(2.0 / 3.0)));
        assert_ne!(choice.model, Some(Model::Linearithmic), "{choice:?}");
    }

    #[test]
    fn the_slope_has_the_textbook_error() {
        // x = ln N in {1, 2, 3, 4}; y = 1.2, 1.9, 3.2, 3.7: b = 0.88, residuals 0.02, -0.16, 0.26, -0.12
        let points: Vec<(f64, f64)> =
            [(1.0, 1.2), (2.0, 1.9), (3.0, 3.2), (4.0, 3.7)].iter().map(|&(x, y): &(f64, f64)| (x.exp(), y.exp())).collect();
        let found = slope(&points).unwrap();
        let error = ((0.02_f64.powi(2) + 0.16_f64.powi(2) + 0.26_f64.powi(2) + 0.12_f64.powi(2)) / 2.0 / 5.0).sqrt();
        assert!((found.exponent - 0.88).abs() < 1e-9, "{found:?}");
        assert!((found.error - error).abs() < 1e-9, "{found:?} {error}");
        assert!((found.high - 0.88 - 4.30265 * error).abs() < 1e-6);
        assert!((student(5) - 2.5706).abs() < 2e-3 && (student(13) - 2.1604).abs() < 1e-3 && (student(3) - 3.1824).abs() < 5e-3);
    }

    #[test]
    fn names_are_read_back() {
        for model in Model::ALL {
            assert_eq!(Model::parse(model.name()), Some(model));
        }
        assert_eq!(Model::parse("n log2 n"), Some(Model::Linearithmic));
        assert_eq!(Model::parse("N^3"), None);
    }
}
