//! Axes: ranges, ticks and their labels.

use plotters::coord::ranged1d::{BoldPoints, Ranged};
use plotters::coord::types::RangedCoordf64;

#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    log: bool,
    low: f64,
    high: f64,
}

pub type Tick = (f64, Option<String>);

impl Axis {
    /// Makes an axis that holds these values and a margin. A logarithmic axis ignores values that
    /// are not positive.
    pub fn new(values: impl Iterator<Item = f64>, log: bool) -> Axis {
        let usable = |value: &f64| value.is_finite() && (!log || *value > 0.0);
        // Values are clamped, so that neither the margin nor the width of the range overflows.
        let values = values
            .filter(usable)
            .map(|v| if log { v.clamp(1e-140, 1e140) } else { v.clamp(-1e140, 1e140) });
        let (low, high) = values
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return Axis { log, low: if log { 1.0 } else { 0.0 }, high: 10.0 };
        }
        if log {
            // At least two labels must fit.
            let decades = (high / low).log10();
            let room = (0.04 * decades).max(0.06).max(0.25 - decades / 2.0);
            return Axis { log, low: low * 10f64.powf(-room), high: high * 10f64.powf(room) };
        }
        // A linear axis includes zero, unless the smallest value is above 0.6 times the largest.
        let low = if low > 0.0 && low < 0.6 * high { 0.0 } else { low };
        let room = if high > low { 0.05 * (high - low) } else { 0.5 * high.abs().max(1.0) };
        Axis { log, low: if low == 0.0 { 0.0 } else { low - room }, high: high + room }
    }

    /// Returns the position of a value: 0 at the low end and 1 at the high end of the axis; `None`
    /// if it is not positive on a logarithmic axis.
    pub fn place(&self, value: f64) -> Option<f64> {
        let place = if self.log {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        place.is_finite().then_some(place)
    }

    pub fn value(&self, place: f64) -> f64 {
        if self.log {
            self.low * (self.high / self.low).powf(place)
        } else {
            self.low + place * (self.high - self.low)
        }
    }

    /// Returns ticks for an axis of this length, on which each label needs the length `room`.
    pub fn ticks(&self, length: f64, room: f64) -> Vec<Tick> {
        let most = (length / room.max(1.0)).floor().max(2.0);
        if !self.log {
            let range = RangedCoordf64::from(self.low..self.high);
            let values = range.key_points(BoldPoints(most as usize));
            return values.into_iter().map(|value| (value, Some(plain(value)))).collect();
        }
        let decades = (self.high / self.low).log10();
        let (digits, step) = match decades {
            ..0.8 => (&[1, 2, 3, 5, 7][..], 1),
            ..1.5 => (&[1, 2, 5][..], 1),
            _ => (&[1][..], (decades / most).ceil() as i32),
        };
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().floor() as i32);
        // The text is parsed, because 10^-k times a digit may be off by an ulp.
        let value = |power, digit| format!("{digit}e{power}").parse().unwrap_or(f64::NAN);
        let powers = (first..=last).flat_map(|power| digits.iter().map(move |it| (power, *it)));
        powers
            .map(|(power, digit)| (value(power, digit), power))
            .filter(|(value, _)| (self.low..=self.high).contains(value))
            .map(|(value, power)| (value, (power.rem_euclid(step) == 0).then(|| plain(value))))
            .collect()
    }
}

/// Formats 1000 as `1000` and 2e6 as `2·10⁶`.
pub fn plain(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-3..1e6).contains(&size) {
        let text = format!("{value:.6}");
        return text.trim_end_matches('0').trim_end_matches('.').to_string();
    }
    let power = (size.log10() + 1e-9).floor() as i32;
    let digits = format!("{:.3}", value / 10f64.powi(power));
    match digits.trim_end_matches('0').trim_end_matches('.') {
        "1" => power_of_ten(power),
        digits => format!("{digits}·{}", power_of_ten(power)),
    }
}

/// Formats the exponent -3 as `10⁻³`.
fn power_of_ten(power: i32) -> String {
    let raised = |c: char| match c.to_digit(10) {
        Some(digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit as usize).unwrap_or(c),
        None => '⁻',
    };
    format!("10{}", power.to_string().chars().map(raised).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: [f64; 2], log: bool, length: f64) -> Vec<String> {
        Axis::new(values.into_iter(), log)
            .ticks(length, 40.0)
            .into_iter()
            .filter_map(|tick| tick.1)
            .collect()
    }

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(labels([100.0, 1e5], true, 300.0), ["100", "1000", "10000", "100000"]);
        assert_eq!(labels([1e-3, 1e12], true, 200.0), ["1", "10000", "10⁸", "10¹²"]);
        assert_eq!(labels([2.0, 30.0], true, 300.0), ["2", "5", "10", "20"]);
        assert_eq!(labels([0.0, 10.0], false, 300.0), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels([2e6, 9e6], true, 300.0), ["2·10⁶", "3·10⁶", "5·10⁶", "7·10⁶", "10⁷"]);
        assert!(labels([5.0, 5.0], true, 300.0).len() >= 2);
        for odd in [
            [f64::NAN, 0.0],
            [0.0, 0.0],
            [-1.0, 1.0],
            [f64::MAX, f64::MIN_POSITIVE],
            [f64::MIN, f64::MAX],
        ] {
            for log in [true, false] {
                assert!(Axis::new(odd.into_iter(), log).ticks(300.0, 40.0).len() < 1000);
            }
        }
    }
}
