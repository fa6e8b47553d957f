use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};

use serde::{Deserialize, Serialize};

/// The value of an axis: a number, a word, or a truth value; ordered and hashable. Numbers are
/// compared by value (2 equals 2.0) and come before words.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "serde_json::Value", into = "serde_json::Value")]
pub enum AxisValue {
    Bool(bool),
    Integer(i128),
    Real(f64),
    Text(String),
}

/// Whole numbers below this are exact as f64.
const EXACT: f64 = (1u64 << 53) as f64;

impl AxisValue {
    pub fn number(&self) -> Option<f64> {
        match *self {
            AxisValue::Integer(value) => Some(value as f64),
            AxisValue::Real(value) => Some(value),
            AxisValue::Bool(_) | AxisValue::Text(_) => None,
        }
    }

    pub fn parse(text: &str) -> AxisValue {
        match (text.parse(), text.parse::<f64>(), text.parse()) {
            (Ok(value), ..) => AxisValue::Integer(value),
            (_, Ok(value), _) if value.is_finite() => value.into(),
            (.., Ok(value)) => AxisValue::Bool(value),
            _ => AxisValue::Text(text.into()),
        }
    }

    fn rank(&self) -> u8 {
        match self {
            AxisValue::Bool(_) => 0,
            AxisValue::Integer(_) | AxisValue::Real(_) => 1,
            AxisValue::Text(_) => 2,
        }
    }
}

impl Ord for AxisValue {
    fn cmp(&self, other: &AxisValue) -> Ordering {
        match (self, other) {
            (AxisValue::Bool(a), AxisValue::Bool(b)) => a.cmp(b),
            (AxisValue::Integer(a), AxisValue::Integer(b)) => a.cmp(b),
            (AxisValue::Text(a), AxisValue::Text(b)) => a.cmp(b),
            (a, b) => match (a.number(), b.number()) {
                // A whole number that is not exact as f64 must not equal its rounded value.
                (Some(x), Some(y)) => {
                    let kind = |value: &AxisValue| matches!(value, AxisValue::Real(_));
                    x.total_cmp(&y).then(kind(a).cmp(&kind(b)))
                }
                _ => a.rank().cmp(&b.rank()),
            },
        }
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
        match self {
            AxisValue::Bool(value) => value.hash(state),
            AxisValue::Integer(value) => value.hash(state),
            AxisValue::Real(value) => value.to_bits().hash(state),
            AxisValue::Text(value) => value.hash(state),
        }
    }
}

impl fmt::Display for AxisValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AxisValue::Bool(value) => value.fmt(f),
            AxisValue::Integer(value) => value.fmt(f),
            AxisValue::Real(value) => value.fmt(f),
            AxisValue::Text(value) => f.write_str(value),
        }
    }
}

impl From<u64> for AxisValue {
    fn from(value: u64) -> AxisValue {
        AxisValue::Integer(value.into())
    }
}

impl From<f64> for AxisValue {
    fn from(value: f64) -> AxisValue {
        if value.fract() == 0.0 && value.abs() <= EXACT {
            AxisValue::Integer(value as i128)
        } else {
            AxisValue::Real(value)
        }
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
            serde_json::Value::Number(number) => number
                .as_i128()
                .map(AxisValue::Integer)
                .or_else(|| number.as_f64().map(AxisValue::from))
                .unwrap_or_else(|| AxisValue::Text(number.to_string())),
            other => AxisValue::Text(other.to_string()),
        }
    }
}

impl From<AxisValue> for serde_json::Value {
    fn from(value: AxisValue) -> serde_json::Value {
        match value {
            AxisValue::Bool(value) => value.into(),
            AxisValue::Integer(value) => match (u64::try_from(value), i64::try_from(value)) {
                (Ok(value), _) => value.into(),
                (_, Ok(value)) => value.into(),
                _ => (value as f64).into(),
            },
            AxisValue::Real(value) => value.into(),
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
        let mut sorted =
            ["\"b\"", "10", "1.5", "true", "-3", "\"a\"", "18446744073709551615"].map(read);
        sorted.sort();
        let sorted = sorted.map(|value| serde_json::to_string(&value).unwrap());
        assert_eq!(sorted, ["true", "-3", "1.5", "10", "18446744073709551615", "\"a\"", "\"b\""]);
        assert_eq!(
            ["7", "0.3", "false", "avx2", "inf"].map(AxisValue::parse),
            [7u64.into(), 0.3.into(), AxisValue::Bool(false), "avx2".into(), "inf".into()]
        );
    }
}
