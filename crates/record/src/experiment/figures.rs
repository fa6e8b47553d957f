//! Figures of an experiment.

use serde::Deserialize;

use crate::experiment::claims::Where;
use crate::experiment::expression::Expression;

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    pub name: String,
    pub title: String,
    pub kind: FigureKind,
    #[serde(rename = "where", default)]
    pub filter: Where,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FigureKind {
    /// Draws y against x: one panel per scene and dimension, one line per detector.
    Lines(Lines),
    /// Draws times over those of one detector: one panel per scene and N, one bar per detector.
    Bars(Bars),
    SpeedError(SpeedError),
}

/// The names of all kinds of figures; the first is that of a figure without a kind.
pub const KINDS: [&str; 3] = ["lines", "bars", "speed-error"];

impl FigureKind {
    pub fn expression(&self) -> Option<&Expression> {
        match self {
            FigureKind::Lines(lines) => Some(&lines.y),
            _ => None,
        }
    }

    /// Returns the option that names an axis, and the axis.
    pub fn axis(&self) -> Option<(&'static str, &str)> {
        match self {
            FigureKind::Lines(lines) => Some(("x", &lines.x)),
            FigureKind::SpeedError(figure) if !figure.columns.is_empty() => {
                Some(("columns", &figure.columns))
            }
            FigureKind::SpeedError(_) | FigureKind::Bars(_) => None,
        }
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Lines {
    pub x: String,
    pub x_label: String,
    /// The values drawn: `time_ns` is the median over blocks, with its interval.
    pub y: Expression,
    pub y_label: String,
    #[serde(default = "logarithmic")]
    pub log: bool,
    #[serde(default)]
    pub slopes: bool,
    /// Whether y is divided by N, so that a cost of order N is a horizontal line.
    #[serde(default)]
    pub per_particle: bool,
    #[serde(default)]
    pub caches: bool,
}

fn logarithmic() -> bool {
    true
}

impl Lines {
    pub(super) fn problem(&self) -> Option<&'static str> {
        if self.caches && self.x != "n" {
            return Some("caches = true: its x must be n");
        }
        if self.slopes && !(self.x == "n" && self.log) {
            return Some("slopes = true: its x must be n, and its axes logarithmic");
        }
        None
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bars {
    pub to: String,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpeedError {
    pub against: Against,
    pub columns: String,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Against {
    /// Compares with exact decisions on the given scene, so errors of all causes count.
    #[default]
    Given,
    /// Compares with exact decisions on the stored scene: only predicate and search can err.
    Stored,
}
