//! Claims: expectations of an experiment that are checked against the record.

use std::collections::BTreeMap;

use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::experiment::expression::Expression;
use crate::stats::growth::Model;

pub type Where = BTreeMap<String, Vec<toml::Value>>;

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    pub name: String,
    pub kind: ClaimKind,
    #[serde(rename = "where", default)]
    pub filter: Where,
    #[serde(default)]
    pub set: Set,
    #[serde(default)]
    pub source: String,
    /// The answer to the experiment's question if the claim holds, such as `yes`.
    #[serde(default)]
    pub answers: String,
}

/// When the limit of a claim was set. A limit chosen after seeing the data proves less.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Set {
    #[default]
    Unknown,
    Published,
    Before,
    After,
}

/// The condition of a claim. Claims about times are `faster` and those with `time_ns` in an
/// expression; they hold for one machine only.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub enum ClaimKind {
    /// The largest value divided by the smallest, minus 1, is at most `within`.
    Constant {
        value: Expression,
        #[serde(default, deserialize_with = "tolerance")]
        within: f64,
    },
    Equal {
        value: Expression,
        to: Expression,
        #[serde(default, deserialize_with = "tolerance")]
        within: f64,
    },
    AtMost {
        value: Expression,
        to: Expression,
        #[serde(default)]
        than: Option<String>,
        /// Dimension of the scenes whose `to` is the limit; `None` for the cell's own scene.
        #[serde(default, rename = "than-dim", deserialize_with = "dimension")]
        than_dim: Option<u32>,
    },
    Model {
        #[serde(deserialize_with = "timeless")]
        value: Expression,
        #[serde(deserialize_with = "model")]
        model: Model,
    },
    /// The ratio of the detector's time to that of `than` is below 1 / `by` in every cell.
    Faster {
        than: String,
        #[serde(default = "once", deserialize_with = "times")]
        by: f64,
    },
}

fn once() -> f64 {
    1.0
}

fn times<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let by = f64::deserialize(from)?;
    let words = format!("by = {by}: it must be a finite number over 0");
    if by > 0.0 && by.is_finite() { Ok(by) } else { Err(D::Error::custom(words)) }
}

impl ClaimKind {
    pub fn than(&self) -> Option<&str> {
        match self {
            ClaimKind::Faster { than, .. } => Some(than),
            ClaimKind::AtMost { than, .. } => than.as_deref(),
            _ => None,
        }
    }

    pub fn than_dim(&self) -> Option<u32> {
        match self {
            ClaimKind::AtMost { than_dim, .. } => *than_dim,
            _ => None,
        }
    }

    pub fn than_mut(&mut self) -> Option<&mut String> {
        match self {
            ClaimKind::Faster { than, .. } => Some(than),
            ClaimKind::AtMost { than, .. } => than.as_mut(),
            _ => None,
        }
    }

    pub fn sides(&self) -> Vec<&Expression> {
        match self {
            ClaimKind::Faster { .. } => Vec::new(),
            ClaimKind::Equal { value, to, .. } | ClaimKind::AtMost { value, to, .. } => {
                vec![value, to]
            }
            ClaimKind::Constant { value, .. } | ClaimKind::Model { value, .. } => vec![value],
        }
    }
}

impl Claim {
    pub fn origin(&self) -> String {
        let set = match self.set {
            Set::Unknown => "",
            Set::Published => "published",
            Set::Before => "ours, set before the data",
            Set::After => "ours, set after the data",
        };
        let parts = [set, &self.source];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(": ")
    }

    /// Whether the claim's failure changes the exit code. A published claim that fails is a result,
    /// and a claim about times may fail on another machine.
    pub fn is_check(&self) -> bool {
        self.set != Set::Published && !self.uses_time()
    }

    pub fn uses_time(&self) -> bool {
        let timed = matches!(self.kind, ClaimKind::Faster { .. });
        timed || self.kind.sides().iter().any(|side| side.uses_time())
    }
}

fn dimension<'de, D: Deserializer<'de>>(from: D) -> Result<Option<u32>, D::Error> {
    match u32::deserialize(from)? {
        dim @ (2 | 3) => Ok(Some(dim)),
        dim => Err(D::Error::custom(format!("than-dim is {dim}; it must be 2 or 3"))),
    }
}

fn tolerance<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let within = f64::deserialize(deserializer)?;
    let words = format!("within is {within}; it must be a finite number of at least 0");
    if within >= 0.0 && within.is_finite() { Ok(within) } else { Err(D::Error::custom(words)) }
}

fn model<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Model, D::Error> {
    let text = String::deserialize(deserializer)?;
    Model::parse(&text).ok_or_else(|| {
        D::Error::custom(format!("unknown model '{text}'; the models are: N, N log N, N^2"))
    })
}

fn timeless<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Expression, D::Error> {
    let value = Expression::deserialize(deserializer)?;
    let words = "a model is fitted to counts or bytes: the memory hierarchy makes linear times \
                 look like N log N";
    if value.uses_time() { Err(D::Error::custom(words)) } else { Ok(value) }
}
