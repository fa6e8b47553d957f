//! Figures of an experiment.

use serde::{Deserialize, Deserializer};

use crate::experiment::claims::Where;
use crate::experiment::expression::Expression;
use crate::record::id::variable;

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
    Map(MapAxes),
}

impl FigureKind {
    pub fn expression(&self) -> Option<&Expression> {
        match self {
            FigureKind::Lines(lines) => Some(&lines.y),
            _ => None,
        }
    }

    /// Lists the options that name an axis: key, axis, and whether it must be an axis of scenes.
    pub fn axes(&self) -> Vec<(&'static str, &str, bool)> {
        match self {
            FigureKind::Lines(lines) => vec![("x", &lines.x, false)],
            FigureKind::SpeedError(figure) if !figure.columns.is_empty() => {
                vec![("columns", &figure.columns, false)]
            }
            FigureKind::Map(map) => vec![("x", &map.x, true), ("y", &map.y, true)],
            FigureKind::SpeedError(_) | FigureKind::Bars(_) => Vec::new(),
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

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct MapAxes {
    #[serde(deserialize_with = "called")]
    pub x: String,
    #[serde(deserialize_with = "called")]
    pub y: String,
    #[serde(default)]
    pub x_label: String,
    #[serde(default)]
    pub y_label: String,
}

const CALLED: [(&str, &str); 2] =
    [("density", "packing_fraction"), ("contacts_per_particle", "coordination")];

fn called<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    String::deserialize(from).map(|name| column(&name))
}

fn column(name: &str) -> String {
    let plain = variable(name);
    let found = CALLED.iter().find(|(word, _)| *word == plain);
    found.map_or(plain, |(_, column)| column.to_string())
}

impl MapAxes {
    pub fn new(x: &str, y: &str) -> MapAxes {
        MapAxes { x: column(x), y: column(y), x_label: String::new(), y_label: String::new() }
    }

    pub fn labels(&self) -> [&str; 2] {
        [(&self.x_label, &self.x), (&self.y_label, &self.y)]
            .map(|(given, name)| if given.is_empty() { name.as_str() } else { given })
    }
}
