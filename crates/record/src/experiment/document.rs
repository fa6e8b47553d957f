//! Parses the TOML text of an experiment, with line and column for every error.
//!
//! In a file, the keys of a claim or figure stand beside its `kind`. Before serde reads them, they
//! move into a table: `{ kind = { equal = { .. } } }`. Instead of a list, a file may have one
//! value: `3` means `[3]`, and `[scene]` means `[[scene]]`. `1e6` is a whole number.

use std::ops::Range;

use anyhow::anyhow;
use serde::de::{Deserialize, IntoDeserializer};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::experiment::figures::KINDS;
use crate::experiment::plain::plain;
use crate::experiment::{Experiment, REQUIRED};
use contactbench_terms::arithmetic::Arithmetic;

const FORM: &str = "docs/EXPERIMENTS.md lists all keys";
/// Keys at the top whose values are lists.
const LISTS: [&str; 7] =
    ["detectors", "arithmetics", "threads", "scene", "runner", "claim", "figure"];
/// Keys of claims and figures of all kinds.
const COMMON: [&str; 6] = ["name", "title", "where", "set", "source", "answers"];

pub struct Document<'a> {
    text: &'a str,
    keys: Vec<(String, Range<usize>)>,
    claims: Vec<Range<usize>>,
    figures: Vec<Range<usize>>,
}

impl<'a> Document<'a> {
    /// Parses an experiment. The copy in a record may ask for arithmetics and kinds of figures that
    /// this program lacks; they are left out.
    pub fn read(text: &'a str, is_copy: bool) -> anyhow::Result<(Experiment, Document<'a>)> {
        let parsed = Document::parse(text, is_copy).map_err(|error| {
            // The first line of the message states the error, the others what was expected.
            let lines = error.message().split('\n').map(str::trim).filter(|line| !line.is_empty());
            located(text, error.span(), &plain(&lines.collect::<Vec<_>>().join("; ")))
        })?;
        let missing = |key: &&&str| parsed.1.keys.iter().all(|(known, _)| known != **key);
        if let Some(missing) = REQUIRED.iter().find(missing) {
            let form = if *missing == "scene" { "give a [[scene]]" } else { "give it a value" };
            return Err(located(text, None, &format!("{missing} is missing: {form}")));
        }
        Ok(parsed)
    }

    fn parse(text: &'a str, is_copy: bool) -> Result<(Experiment, Document<'a>), toml::de::Error> {
        let mut table = DeTable::parse(text)?;
        let root = table.get_mut();
        let keys = root.keys().map(|key| (key.get_ref().to_string(), key.span())).collect();
        root.iter_mut().for_each(|(_, value)| whole(value));
        lists(root, |name| LISTS.contains(&name));
        if is_copy {
            retain(root, "figure", |figure| {
                let kind = figure.get("kind").and_then(|kind| kind.get_ref().as_str());
                kind.is_none_or(|kind| KINDS.contains(&kind))
            });
            retain(root, "arithmetics", |value| {
                value.as_str().is_none_or(|name| name.parse::<Arithmetic>().is_ok())
            });
        }
        let scenes = each(root, "scene", |scene, _| {
            lists(scene, |name| !["name", "quick"].contains(&name));
            if let Some(DeValue::Table(quick)) = scene.get_mut("quick").map(Spanned::get_mut) {
                lists(quick, |_| true);
            }
        });
        let claims = each(root, "claim", |claim, at| nest(claim, at, None));
        let figures = each(root, "figure", |figure, at| nest(figure, at, Some(KINDS[0])));
        let mut experiment = Experiment::deserialize(table.into_deserializer())?;
        for (sweep, place) in experiment.scenes.iter_mut().zip(scenes) {
            sweep.line = line(&text[..place.start]);
        }
        Ok((experiment, Document { text, keys, claims, figures }))
    }

    pub fn key(&self, key: &str, words: String) -> anyhow::Error {
        let place = self.keys.iter().find(|(known, _)| known == key);
        located(self.text, place.map(|(_, at)| at.clone()), &words)
    }

    pub fn claim(&self, k: usize, words: String) -> anyhow::Error {
        located(self.text, self.claims.get(k).cloned(), &words)
    }

    pub fn figure(&self, k: usize, words: String) -> anyhow::Error {
        located(self.text, self.figures.get(k).cloned(), &words)
    }
}

fn located(text: &str, at: Option<Range<usize>>, words: &str) -> anyhow::Error {
    let Some(before) = at.and_then(|at| text.get(..at.start)) else {
        return anyhow!("{words}; {FORM}");
    };
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    anyhow!("line {}, column {column}: {words}; {FORM}", line(before))
}

fn line(before: &str) -> usize {
    before.matches('\n').count() + 1
}

/// Changes each table of an array of tables and returns their positions. Values that are not tables
/// are left for serde to refuse.
fn each<'a>(
    root: &mut DeTable<'a>,
    name: &str,
    change: impl Fn(&mut DeTable<'a>, Range<usize>),
) -> Vec<Range<usize>> {
    let Some(DeValue::Array(tables)) = root.get_mut(name).map(Spanned::get_mut) else {
        return Vec::new();
    };
    let mut places = Vec::new();
    for table in tables.iter_mut() {
        places.push(table.span());
        let place = table.span();
        if let DeValue::Table(table) = table.get_mut() {
            change(table, place);
        }
    }
    places
}

fn retain(root: &mut DeTable<'_>, name: &str, is_known: impl Fn(&DeValue<'_>) -> bool) {
    if let Some(DeValue::Array(all)) = root.get_mut(name).map(Spanned::get_mut) {
        *all = all.iter().filter(|value| is_known(value.get_ref())).cloned().collect();
    }
}

/// Turns numbers such as `1e6` into whole ones.
fn whole(value: &mut Spanned<DeValue<'_>>) {
    match value.get_mut() {
        DeValue::Table(table) => table.iter_mut().for_each(|(_, value)| whole(value)),
        DeValue::Array(all) => all.iter_mut().for_each(whole),
        DeValue::Float(number) => {
            let exact = |x: &f64| x.fract() == 0.0 && x.abs() < (1u64 << 53) as f64;
            if let Some(number) = number.as_str().parse().ok().filter(exact) {
                // The value borrows its text; the few bytes of such a number are never freed.
                let text: &str = number.to_string().leak();
                if let Ok(whole) = DeValue::parse(text) {
                    *value.get_mut() = whole.into_inner();
                }
            }
        }
        _ => {}
    }
}

/// Makes lists of these values.
fn lists(table: &mut DeTable<'_>, is_list: impl Fn(&str) -> bool) {
    for (name, value) in table.iter_mut() {
        if is_list(name.get_ref()) && !value.get_ref().is_array() {
            let (at, nothing) = (value.span(), DeValue::Boolean(false));
            let one = Spanned::new(at, std::mem::replace(value.get_mut(), nothing));
            *value.get_mut() = DeValue::Array([one].into_iter().collect());
        }
    }
}

/// Moves the keys of a kind into a table below the name of the kind.
fn nest(table: &mut DeTable<'_>, at: Range<usize>, default: Option<&str>) {
    let kind = table.remove("kind");
    let place = kind.as_ref().map_or(at, Spanned::span);
    let name = kind.as_ref().map(|kind| kind.get_ref().as_str().unwrap_or_default()).or(default);
    let name = name.map(String::from);
    let (mut own, mut inner) = (DeTable::new(), DeTable::new());
    for (name, value) in std::mem::take(table) {
        let common = COMMON.contains(&&**name.get_ref());
        if common { &mut own } else { &mut inner }.insert(name, value);
    }
    if let Some(DeValue::Table(filter)) = own.get_mut("where").map(Spanned::get_mut) {
        lists(filter, |_| true);
    }
    if let Some(name) = name {
        let inner = Spanned::new(place.clone(), DeValue::Table(inner));
        let kind = DeTable::from_iter([(Spanned::new(place.clone(), name.into()), inner)]);
        let kind = Spanned::new(place.clone(), DeValue::Table(kind));
        own.insert(Spanned::new(place, "kind".into()), kind);
    }
    *table = own;
}
