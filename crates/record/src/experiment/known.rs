//! Checks, before a run, that its rows will have every name used in claims and figures.

use std::collections::BTreeSet;

use crate::experiment::document::Document;
use crate::experiment::expression::Expression;
use crate::experiment::{Experiment, Planned, Where};
use crate::record::column::{COLUMNS, Column};
use crate::record::id::{CellId, FIELDS, MACHINE, variable};
use crate::record::value::AxisValue;
use contactbench_terms::nearest::hint;

pub(super) fn check(experiment: &Experiment, document: &Document<'_>) -> anyhow::Result<()> {
    let known = Known::new(experiment);
    for (k, claim) in experiment.claims.iter().enumerate() {
        let problem = |words| document.claim(k, words);
        known.filter(&claim.filter).map_err(problem)?;
        claim.kind.sides().into_iter().try_for_each(|it| known.expression(it)).map_err(problem)?;
    }
    for (k, figure) in experiment.figures.iter().enumerate() {
        let problem = |words| document.figure(k, words);
        known.filter(&figure.filter).map_err(problem)?;
        figure.kind.expression().map_or(Ok(()), |it| known.expression(it)).map_err(problem)?;
        if let Some((key, name)) = figure.kind.axis() {
            known.axis(key, name).map_err(problem)?;
        }
    }
    Ok(())
}

struct Known {
    ids: Vec<CellId>,
    runners: bool,
}

fn list<'a>(names: impl IntoIterator<Item = &'a String>) -> String {
    names.into_iter().map(String::as_str).collect::<Vec<_>>().join(", ")
}

fn meant(name: &str, names: &BTreeSet<String>) -> String {
    format!("{}; there are: {}", hint(name, names.iter().map(String::as_str)), list(names))
}

impl Known {
    fn new(experiment: &Experiment) -> Known {
        let Planned { scenes, quick, subjects, .. } = &experiment.planned;
        let mut ids: Vec<CellId> = Vec::new();
        for (k, subject) in subjects.iter().enumerate() {
            let scenes = scenes.iter().chain(quick).take(if k == 0 { usize::MAX } else { 1 });
            ids.extend(scenes.map(|scene| subject.cell(scene).with_threads(1)));
        }
        Known { ids, runners: !experiment.runners.is_empty() }
    }

    fn values(&self, name: &str) -> Vec<AxisValue> {
        self.ids.iter().filter_map(|id| id.axis(name)).collect()
    }

    fn names(&self) -> BTreeSet<String> {
        self.ids.iter().flat_map(CellId::names).collect()
    }

    fn expression(&self, expression: &Expression) -> Result<(), String> {
        let is_number = |name: &String| {
            let mut values = self.values(name).into_iter();
            !FIELDS.contains(&&**name) && values.any(|value| value.number().is_some())
        };
        let columns = COLUMNS.iter().map(|column| column.name.to_string());
        let fixed = ["n", "dim", "seed", "threads"].map(String::from);
        let numbers = self.names().into_iter().filter(is_number);
        let all: BTreeSet<String> = numbers.chain(columns).chain(fixed).collect();
        let found = expression.variables().find(|(name, _)| !all.contains(*name));
        // Without a scene or a subject, names cannot be checked.
        let Some((name, column)) = found.filter(|_| !self.ids.is_empty()) else { return Ok(()) };
        let meant = meant(name, &all);
        Err(format!("there is no variable '{name}', at column {column} of '{expression}'{meant}"))
    }

    fn axis(&self, key: &str, name: &str) -> Result<(), String> {
        let plain = variable(name);
        let known = Column::find(&plain).is_some() || !self.values(&plain).is_empty();
        if known || self.ids.is_empty() {
            return Ok(());
        }
        let meant = meant(&plain, &self.names());
        Err(format!("{key} = \"{name}\" is not a field or parameter of the scenes{meant}"))
    }

    fn filter(&self, filter: &Where) -> Result<(), String> {
        for (name, wanted) in filter {
            let plain = variable(name);
            if plain == MACHINE || self.ids.is_empty() || Column::find(&plain).is_some() {
                continue;
            }
            let found = self.values(&plain);
            if found.is_empty() {
                let meant = meant(&plain, &self.names());
                return Err(format!("where names '{name}', which no row will have{meant}"));
            }
            let is_word = found.iter().all(|value| value.number().is_none());
            if !is_word || plain == "arithmetic" && self.runners {
                continue;
            }
            let words: BTreeSet<String> = found.iter().map(AxisValue::to_string).collect();
            let text = |value: &toml::Value| value.as_str().map_or(value.to_string(), String::from);
            let wanted: Vec<String> = wanted.iter().map(text).collect();
            if !wanted.iter().any(|value| words.contains(value)) {
                let wanted = list(&wanted);
                let meant = meant(&wanted, &words);
                return Err(format!("where: no row will have {name} = {wanted}{meant}"));
            }
        }
        Ok(())
    }
}
