//! Claims: what an experiment expects, checked from the record.

use std::collections::BTreeMap;

use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::experiment::expression::Expression;
use crate::experiment::{List, detectors};
use crate::stats::growth::Model;

/// Which rows: a field, parameter or variable, and the values that it may have.
pub type Where = BTreeMap<String, List<toml::Value>>;

/// An expectation.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// The sentence in the verdict table.
    pub name: String,
    /// What is checked.
    pub kind: ClaimKind,
    /// Which rows; all without.
    #[serde(rename = "where", default)]
    pub filter: Where,
    /// Where the claim comes from.
    #[serde(default)]
    pub source: String,
}

/// What is checked, in every cell or over all of them. Claims about times (`faster`, and any
/// expression with `time_ns`) are of one machine and gate nothing; all others are checked from
/// counts, bytes and digests.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub enum ClaimKind {
    /// The largest value over the smallest, less 1, is at most `within`.
    Constant {
        /// A positive quantity.
        value: Expression,
        /// Relative tolerance.
        #[serde(default, deserialize_with = "tolerance")]
        within: f64,
    },
    /// The two sides differ by at most `within`, relative to `to`, in every cell.
    Equal {
        /// One side.
        value: Expression,
        /// The other.
        to: Expression,
        /// Relative tolerance.
        #[serde(default, deserialize_with = "tolerance")]
        within: f64,
    },
    /// `value` <= `to` in every cell; with `than` that of another detector in the same scene.
    AtMost {
        /// The smaller side.
        value: Expression,
        /// The limit.
        to: Expression,
        /// Whose `to`; the cell's own without.
        #[serde(default)]
        than: Option<String>,
    },
    /// The value grows with n as `model` says.
    Model {
        /// Counts or bytes, not times.
        #[serde(deserialize_with = "timeless")]
        value: Expression,
        /// N, N log N or N^2.
        #[serde(deserialize_with = "model")]
        model: Model,
    },
    /// The ratio of times, detector over `than`, is below 1 in every cell; below 1 / `by`.
    Faster {
        /// The other detector.
        than: String,
        /// So many times as fast.
        #[serde(default = "once", deserialize_with = "times")]
        by: f64,
    },
}

fn once() -> f64 {
    1.0
}

fn times<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let by = f64::deserialize(from)?;
    if by > 0.0 && by.is_finite() {
        return Ok(by);
    }
    Err(D::Error::custom(format!("by = {by}: it must be a finite number over 0")))
}

impl ClaimKind {
    /// The other detector, where cells are compared with those of one.
    pub fn than(&self) -> Option<&str> {
        match self {
            ClaimKind::Faster { than, .. } => Some(than),
            ClaimKind::AtMost { than, .. } => than.as_deref(),
            _ => None,
        }
    }

    /// The same, to be named otherwise.
    pub(super) fn than_mut(&mut self) -> Option<&mut String> {
        match self {
            ClaimKind::Faster { than, .. } => Some(than),
            ClaimKind::AtMost { than, .. } => than.as_mut(),
            _ => None,
        }
    }
}

impl Claim {
    /// Is it about times, which are of one machine?
    pub fn uses_time(&self) -> bool {
        match &self.kind {
            ClaimKind::Faster { .. } => true,
            ClaimKind::Equal { value, to, .. } | ClaimKind::AtMost { value, to, .. } => {
                value.uses_time() || to.uses_time()
            }
            ClaimKind::Constant { value, .. } | ClaimKind::Model { value, .. } => value.uses_time(),
        }
    }
}

/// Resolves groups and parameters among the detectors of a filter.
pub(super) fn resolve(filter: &mut Where) -> Result<(), String> {
    let Some(List(values)) = filter.get_mut("detector") else { return Ok(()) };
    let mut all = Vec::new();
    for value in values.drain(..) {
        match value.as_str() {
            Some(group) if group.starts_with('@') => {
                all.extend(detectors::members(group)?.into_iter().map(toml::Value::from));
            }
            Some(name) => all.push(detectors::normal(name).into()),
            None => all.push(value),
        }
    }
    *values = all;
    Ok(())
}

fn tolerance<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let within = f64::deserialize(deserializer)?;
    if within >= 0.0 && within.is_finite() {
        return Ok(within);
    }
    Err(D::Error::custom(format!("within is {within}; it must be a finite number of at least 0")))
}

fn model<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Model, D::Error> {
    let text = String::deserialize(deserializer)?;
    Model::parse(&text).ok_or_else(|| {
        D::Error::custom(format!("unknown model '{text}'; the models are: N, N log N, N^2"))
    })
}

fn timeless<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Expression, D::Error> {
    let value = Expression::deserialize(deserializer)?;
    if value.uses_time() {
        return Err(D::Error::custom(
            "a model is fitted to counts or bytes: the memory hierarchy makes linear times look \
             like N log N",
        ));
    }
    Ok(value)
}
