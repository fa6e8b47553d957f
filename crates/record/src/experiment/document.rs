//! Parses the TOML text of an experiment, with line and column for every error.
//!
//! In a file, the keys of a claim or figure stand beside its `kind`, and parameters of a generator
//! beside the name of the scene. Before serde reads them, they move into tables: keys of a kind
//! into `{ kind = { equal = { .. } } }`, parameters into `params`. Instead of a list, a file
//! may have one value: `3` means `[3]`. `1e6` is a whole number.

use std::borrow::Cow;
use std::ops::Range;

use anyhow::anyhow;
use serde::de::{Deserialize, IntoDeserializer};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::experiment::claims::{Claim, ClaimKind};
use crate::experiment::figures::{Figure, FigureKind};
use crate::experiment::plain::plain;
use crate::experiment::sweep::{Quick, SceneSweep};
use crate::experiment::{Experiment, REQUIRED, keys};
use contactbench_terms::arithmetic::Arithmetic;
use contactbench_terms::nearest::hint;

struct Problem {
    pub at: Option<Range<usize>>,
    pub words: String,
}

impl Problem {
    pub fn new(at: Range<usize>, words: impl Into<String>) -> Problem {
        Problem { at: Some(at), words: words.into() }
    }

    pub fn located(self, text: &str) -> anyhow::Error {
        let before = self.at.and_then(|at| text.get(..at.start));
        let Some(before) = before else { return anyhow!("{}; {FORM}", self.words) };
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        anyhow!("line {}, column {column}: {}; {FORM}", line(before), self.words)
    }
}

const FORM: &str = "docs/EXPERIMENTS.md lists all keys";

fn line(before: &str) -> usize {
    before.matches('\n').count() + 1
}

impl From<toml::de::Error> for Problem {
    fn from(error: toml::de::Error) -> Problem {
        // The first line of the message states the error, the others what was expected.
        let lines = error.message().split('\n').map(str::trim).filter(|line| !line.is_empty());
        Problem { at: error.span(), words: plain(&lines.collect::<Vec<_>>().join("; ")) }
    }
}

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
        Document::parse(text, is_copy).map_err(|problem| problem.located(text))
    }

    fn parse(text: &'a str, is_copy: bool) -> Result<(Experiment, Document<'a>), Problem> {
        let mut table = DeTable::parse(text)?;
        let root = table.get_mut();
        let keys = root.keys().map(|key| (key.get_ref().to_string(), key.span())).collect();
        top_level(root)?;
        root.iter_mut().for_each(|(_, value)| whole(value));
        lists(root, |name| ["detectors", "arithmetics", "threads"].contains(&name));
        if let Some(missing) = REQUIRED.iter().find(|key| !root.contains_key(**key)) {
            let form = if *missing == "scene" { "give a [[scene]]" } else { "give it a value" };
            return Err(Problem { at: None, words: format!("{missing} is missing: {form}") });
        }
        let scenes = each(root, "scene", |scene, _| {
            gather(scene, keys::fields::<SceneSweep>());
            if let Some(DeValue::Table(quick)) = scene.get_mut("quick").map(Spanned::get_mut) {
                gather(quick, keys::fields::<Quick>());
            }
            Ok(())
        })?;
        let claims =
            each(root, "claim", |claim, at| nest::<Claim, ClaimKind>(claim, at, "claim", None))?;
        if is_copy {
            retain(root, "figure", has_kind::<FigureKind>);
            retain(root, "arithmetics", |value| {
                value.as_str().is_none_or(|name| name.parse::<Arithmetic>().is_ok())
            });
        }
        let figures = each(root, "figure", |figure, at| {
            nest::<Figure, FigureKind>(figure, at, "figure", Some("lines"))
        })?;
        let mut experiment = Experiment::deserialize(table.into_deserializer())?;
        for (sweep, place) in experiment.scenes.iter_mut().zip(scenes) {
            sweep.line = line(&text[..place.start]);
        }
        Ok((experiment, Document { text, keys, claims, figures }))
    }

    pub fn key(&self, key: &str, words: String) -> anyhow::Error {
        let place = self.keys.iter().find(|(known, _)| known == key);
        Problem { at: place.map(|(_, at)| at.clone()), words }.located(self.text)
    }

    pub fn claim(&self, k: usize, words: String) -> anyhow::Error {
        Problem { at: self.claims.get(k).cloned(), words }.located(self.text)
    }

    pub fn figure(&self, k: usize, words: String) -> anyhow::Error {
        Problem { at: self.figures.get(k).cloned(), words }.located(self.text)
    }
}

/// Refuses tables in single brackets, and unknown keys before missing keys are reported.
fn top_level(root: &DeTable<'_>) -> Result<(), Problem> {
    let known = keys::fields::<Experiment>();
    for (name, value) in root {
        let (at, name) = (name.span(), &**name.get_ref());
        if !known.contains(&name) {
            let hint = hint(name, known.iter().copied());
            let words = format!("there is no key '{name}'{hint}; there are: {}", known.join(", "));
            return Err(Problem::new(at, words));
        }
        let many = ["scene", "runner", "claim", "figure"].contains(&name);
        if many && matches!(value.get_ref(), DeValue::Table(_)) {
            let words =
                format!("write [[{name}]] instead of [{name}]: there may be several such tables");
            return Err(Problem::new(at, words));
        }
    }
    Ok(())
}

/// Changes each table of an array of tables and returns their positions. Values that are not tables
/// are left for serde to refuse.
fn each<'a>(
    root: &mut DeTable<'a>,
    name: &str,
    mut change: impl FnMut(&mut DeTable<'a>, Range<usize>) -> Result<(), Problem>,
) -> Result<Vec<Range<usize>>, Problem> {
    let mut places = Vec::new();
    let Some(DeValue::Array(tables)) = root.get_mut(name).map(Spanned::get_mut) else {
        return Ok(places);
    };
    for table in tables.iter_mut() {
        let place = table.span();
        if let DeValue::Table(table) = table.get_mut() {
            change(table, place.clone())?;
        }
        places.push(place);
    }
    Ok(places)
}

fn retain(root: &mut DeTable<'_>, name: &str, is_known: impl Fn(&DeValue<'_>) -> bool) {
    if let Some(DeValue::Array(all)) = root.get_mut(name).map(Spanned::get_mut) {
        *all = all.iter().filter(|value| is_known(value.get_ref())).cloned().collect();
    }
}

fn has_kind<'de, Kind: Deserialize<'de>>(table: &DeValue<'_>) -> bool {
    let kind = table.get("kind").and_then(|kind| kind.get_ref().as_str());
    kind.is_none_or(|kind| keys::fields::<Kind>().contains(&kind))
}

fn key(name: &'static str, at: Range<usize>) -> Spanned<Cow<'static, str>> {
    Spanned::new(at, Cow::Borrowed(name))
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

/// Moves the parameters of a generator into `params`.
fn gather(table: &mut DeTable<'_>, known: &[&str]) {
    let (mut own, mut params) = (DeTable::new(), DeTable::new());
    for (name, value) in std::mem::take(table) {
        let known = *name.get_ref() != "params" && known.contains(&&**name.get_ref());
        if known { &mut own } else { &mut params }.insert(name, value);
    }
    lists(&mut params, |_| true);
    lists(&mut own, |name| ["dim", "n", "seed", "order"].contains(&name));
    own.insert(key("params", 0..0), Spanned::new(0..0, DeValue::Table(params)));
    *table = own;
}

fn nest<'de, Common: Deserialize<'de>, Kind: Deserialize<'de>>(
    table: &mut DeTable<'_>,
    at: Range<usize>,
    what: &str,
    default: Option<&'static str>,
) -> Result<(), Problem> {
    let kinds = keys::fields::<Kind>();
    let list = kinds.join(", ");
    let given = table.remove("kind");
    let place = given.as_ref().map_or(at.clone(), Spanned::span);
    let name = given.as_ref().map(|value| value.get_ref().as_str().unwrap_or_default());
    let Some(name) = name.or(default) else {
        let words = format!("the {what} has no kind; the kinds are: {list}");
        return Err(Problem::new(at, words));
    };
    let Some(kind) = kinds.iter().copied().find(|kind| *kind == name) else {
        let hint = hint(name, kinds.iter().copied());
        let words = format!("there is no such kind of {what}{hint}; the kinds are: {list}");
        return Err(Problem::new(place, words));
    };
    let (common, takes) = (keys::fields::<Common>(), keys::variant_fields::<Kind>(kind));
    let (mut own, mut inner) = (DeTable::new(), DeTable::new());
    for (name, value) in std::mem::take(table) {
        if common.contains(&&**name.get_ref()) {
            own.insert(name, value);
        } else if takes.contains(&&**name.get_ref()) {
            inner.insert(name, value);
        } else {
            let hint = hint(name.get_ref(), takes.iter().chain(common).copied());
            let words = format!(
                "a {what} of kind {kind} has no key '{name}'{hint}; it takes {}, \
                 and like every {what} {}",
                takes.join(", "),
                common.join(", ")
            );
            return Err(Problem::new(name.span(), words));
        }
    }
    let kind = DeTable::from_iter([(
        key(kind, place.clone()),
        Spanned::new(place.clone(), DeValue::Table(inner)),
    )]);
    own.insert(key("kind", place.clone()), Spanned::new(place, DeValue::Table(kind)));
    if let Some(DeValue::Table(filter)) = own.get_mut("where").map(Spanned::get_mut) {
        lists(filter, |_| true);
    }
    *table = own;
    Ok(())
}
