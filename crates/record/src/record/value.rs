use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};

use serde::{Deserialize, Serialize};

/// The value of an axis: a truth value, a number, or a word, in this order. 2 equals 2.0. A whole
/// number that is not exact as f64 is a word.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "serde_json::Value", into = "serde_json::Value")]
pub enum AxisValue {
    Bool(bool),
    Number(f64),
    Text(String),
}

/// Whole numbers of a magnitude below this are exact as f64.
const EXACT: f64 = (1u64 << 53) as f64;

impl AxisValue {
    pub fn number(&self) -> Option<f64> {
        match *self {
            AxisValue::Number(value) => Some(value),
            AxisValue::Bool(_) | AxisValue::Text(_) => None,
        }
    }

    pub fn parse(text: &str) -> AxisValue {
        match (text.parse::<f64>(), text.parse::<bool>()) {
            (Ok(value), _) if value.is_finite() => {
                let whole = text.parse::<i128>().is_ok();
                if whole && value.abs() >= EXACT { text.into() } else { value.into() }
            }
            (_, Ok(value)) => AxisValue::Bool(value),
            _ => text.into(),
        }
    }

    /// Truth values and numbers by size, words by their letters.
    fn key(&self) -> (u8, i64, &str) {
        match self {
            AxisValue::Bool(value) => (0, i64::from(*value), ""),
            AxisValue::Number(value) => {
                // The order of `f64::total_cmp`.
                let bits = value.to_bits() as i64;
                (1, bits ^ (((bits >> 63) as u64) >> 1) as i64, "")
            }
            AxisValue::Text(value) => (2, 0, value),
        }
    }
}

impl Ord for AxisValue {
    fn cmp(&self, other: &AxisValue) -> Ordering {
        self.key().cmp(&other.key())
    }
}

impl PartialOrd for AxisValue {
    fn partial_cmp(&self, other: &AxisValue) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for AxisValue {
    fn eq(&self, other: &AxisValue) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for AxisValue {}

impl Hash for AxisValue {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.key().hash(state);
    }
}

impl fmt::Display for AxisValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AxisValue::Bool(value) => value.fmt(f),
            AxisValue::Number(value) => value.fmt(f),
            AxisValue::Text(value) => f.write_str(value),
        }
    }
}

impl From<u64> for AxisValue {
    fn from(value: u64) -> AxisValue {
        let number = value as f64;
        if number < EXACT { number.into() } else { AxisValue::Text(value.to_string()) }
    }
}

impl From<f64> for AxisValue {
    fn from(value: f64) -> AxisValue {
        // -0.0 becomes 0.0.
        AxisValue::Number(value + 0.0)
    }
}

impl From<&str> for AxisValue {
    fn from(value: &str) -> AxisValue {
        AxisValue::Text(value.into())
    }
}

impl From<serde_json::Value> for AxisValue {
    fn from(value: serde_json::Value) -> AxisValue {
        match value {
            serde_json::Value::Bool(value) => AxisValue::Bool(value),
            serde_json::Value::String(value) => AxisValue::Text(value),
            other => AxisValue::parse(&other.to_string()),
        }
    }
}

impl From<AxisValue> for serde_json::Value {
    fn from(value: AxisValue) -> serde_json::Value {
        match value {
            AxisValue::Bool(value) => value.into(),
            AxisValue::Number(value) if value.fract() == 0.0 && value.abs() < EXACT => {
                (value as i64).into()
            }
            AxisValue::Number(value) => value.into(),
            AxisValue::Text(value) => value.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_numbers_are_equal_and_large_ones_exact() {
        let read = |text: &str| serde_json::from_str::<AxisValue>(text).unwrap();
        assert_eq!(read("2"), read("2.0"));
        assert_eq!(read("0"), read("-0.0"));
        assert_ne!(read("2"), read("\"2\""));
        assert_ne!(read("18446744073709551615"), read("18446744073709551614"));
        // 2^53 and 2^53 + 1 are the same f64.
        let beyond =
            [1 << 53, (1 << 53) + 1].map(|seed: u64| (seed.into(), read(&seed.to_string())));
        assert!(beyond.iter().all(|(from, read): &(AxisValue, AxisValue)| from == read));
        assert_ne!(beyond[0], beyond[1]);
        let mut sorted =
            ["\"b\"", "10", "1.5", "true", "-3", "\"a\"", "18446744073709551615"].map(read);
        sorted.sort();
        let sorted = sorted.map(|value| serde_json::to_string(&value).unwrap());
        assert_eq!(
            sorted,
            ["true", "-3", "1.5", "10", "\"18446744073709551615\"", "\"a\"", "\"b\""]
        );
        assert_eq!(
            ["7", "0.3", "false", "avx2", "inf"].map(AxisValue::parse),
            [7u64.into(), 0.3.into(), AxisValue::Bool(false), "avx2".into(), "inf".into()]
        );
    }
}
