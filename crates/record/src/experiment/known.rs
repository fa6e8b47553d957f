//! Names in claims and figures that no row of the run will have: said before it begins.

use std::collections::BTreeSet;

use crate::experiment::document::Document;
use crate::experiment::expression::Expression;
use crate::experiment::{ClaimKind, Experiment, FigureKind, Planned, Where};
use crate::record::column::{COLUMNS, Column};
use crate::record::id::{CellId, FIELDS, MACHINE, variable};
use crate::record::value::AxisValue;
use contactbench_terms::nearest::hint;

/// Checks all expressions and filters; the error has the place of the claim or figure.
pub(super) fn check(experiment: &Experiment, document: &Document<'_>) -> anyhow::Result<()> {
    let known = Known::new(experiment);
    for (k, claim) in experiment.claims.iter().enumerate() {
        let problem = |words| document.claim(k, words);
        known.filter(&claim.filter).map_err(problem)?;
        let expressions = match &claim.kind {
            ClaimKind::Equal { value, to, .. } | ClaimKind::AtMost { value, to, .. } => {
                vec![value, to]
            }
            ClaimKind::Constant { value, .. } | ClaimKind::Model { value, .. } => vec![value],
            ClaimKind::Faster { .. } => Vec::new(),
        };
        expressions.into_iter().try_for_each(|it| known.expression(it)).map_err(problem)?;
    }
    for (k, figure) in experiment.figures.iter().enumerate() {
        let problem = |words| document.figure(k, words);
        known.filter(&figure.filter).map_err(problem)?;
        match &figure.kind {
            FigureKind::Lines(lines) => {
                known.expression(&lines.y).map_err(problem)?;
                known.axis("x", &lines.x).map_err(problem)?;
            }
            FigureKind::SpeedError(figure) if !figure.columns.is_empty() => {
                known.axis("columns", &figure.columns).map_err(problem)?
            }
            FigureKind::Map(map) => {
                for (key, name) in [("x", &map.x), ("y", &map.y)] {
                    let column = Column::find(&variable(name));
                    if column.is_some_and(|column| column.pass.is_some()) {
                        return Err(problem(format!(
                            "{key} = \"{name}\" is measured of detectors; a map is over fields and \
                             parameters, and what is measured of scenes"
                        )));
                    }
                    known.axis(key, name).map_err(problem)?;
                }
            }
            FigureKind::SpeedError(_) | FigureKind::Bars(_) => {}
        }
    }
    Ok(())
}

/// What rows of the run will have.
struct Known {
    /// Every scene with one contender, and every contender with one scene.
    ids: Vec<CellId>,
    /// Runners say their arithmetic themselves.
    runners: bool,
}

impl Known {
    fn new(experiment: &Experiment) -> Known {
        let Planned { scenes, quick, entrants, .. } = &experiment.planned;
        let mut ids: Vec<CellId> = Vec::new();
        for (k, entrant) in entrants.iter().enumerate() {
            let scenes = scenes.iter().chain(quick).take(if k == 0 { usize::MAX } else { 1 });
            let cell = |scene| entrant.cell(scene).with_threads(1);
            ids.extend(scenes.map(cell));
        }
        Known { ids, runners: !experiment.runners.is_empty() }
    }

    fn values(&self, name: &str) -> Vec<AxisValue> {
        self.ids.iter().filter_map(|id| id.axis(name)).collect()
    }

    /// Fields and parameters.
    fn names(&self) -> BTreeSet<String> {
        self.ids.iter().flat_map(CellId::names).collect()
    }

    /// What expressions may use.
    fn variables(&self) -> BTreeSet<String> {
        let fixed = ["n", "dim", "seed", "threads"].into_iter();
        let fixed = fixed.chain(COLUMNS.iter().map(|column| &*column.name)).map(String::from);
        let parameters = self.names().into_iter().filter(|name| self.is_number(name));
        fixed.chain(parameters).collect()
    }

    fn is_number(&self, name: &str) -> bool {
        !FIELDS.contains(&name) && self.values(name).iter().any(|value| value.number().is_some())
    }

    fn expression(&self, expression: &Expression) -> Result<(), String> {
        // Without a scene or a contender there is nothing to know.
        let fixed = |name: &str| ["n", "dim", "seed", "threads"].contains(&name);
        let unknown =
            |name: &str| Column::find(name).is_none() && !fixed(name) && !self.is_number(name);
        let Some((name, column)) = expression.variables().find(|(name, _)| unknown(name)) else {
            return Ok(());
        };
        if self.ids.is_empty() {
            return Ok(());
        }
        let all = self.variables();
        let all: Vec<&str> = all.iter().map(String::as_str).collect();
        Err(format!(
            "there is no variable '{name}', at column {column} of '{expression}'{}; there are: {}",
            hint(name, all.iter().copied()),
            all.join(", ")
        ))
    }

    fn axis(&self, key: &str, name: &str) -> Result<(), String> {
        let plain = variable(name);
        let known = Column::find(&plain).is_some() || !self.values(&plain).is_empty();
        if known || self.ids.is_empty() {
            return Ok(());
        }
        let names = self.names();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        Err(format!(
            "{key} = \"{name}\" is no field or parameter of the scenes{}; there are: {}",
            hint(&plain, names.iter().copied()),
            names.join(", ")
        ))
    }

    fn filter(&self, filter: &Where) -> Result<(), String> {
        for (name, wanted) in filter {
            let plain = variable(name);
            if plain == MACHINE || self.ids.is_empty() || Column::find(&plain).is_some() {
                continue;
            }
            let found = self.values(&plain);
            if found.is_empty() {
                let names = self.names();
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                return Err(format!(
                    "where names '{name}', which no row will have{}; there are: {}",
                    hint(&plain, names.iter().copied()),
                    names.join(", ")
                ));
            }
            if plain == "arithmetic" && self.runners {
                continue;
            }
            // Words are compared as they stand; numbers may be compared otherwise.
            let words: BTreeSet<String> = found.iter().map(AxisValue::to_string).collect();
            let is_word = found.iter().all(|value| value.number().is_none());
            let text = |value: &toml::Value| match value {
                toml::Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            let wanted: Vec<String> = wanted.iter().map(text).collect();
            if is_word && !wanted.iter().any(|value| words.contains(value)) {
                let wanted = wanted.join(", ");
                return Err(format!(
                    "where: no row will have {name} = {wanted}{}; there are: {}",
                    hint(&wanted, words.iter().map(String::as_str)),
                    words.iter().map(String::as_str).collect::<Vec<_>>().join(", ")
                ));
            }
        }
        Ok(())
    }
}
