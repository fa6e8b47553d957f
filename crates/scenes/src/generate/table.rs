//! The table of generators, and the checks of their parameters.

use std::collections::BTreeMap;

use anyhow::{anyhow, bail, ensure};
use serde_json::Value;

use crate as scene;
use crate::generate::{Inputs, book, clustered, couples, file, hard, loose, packed, settled};
use contactbench_io::Given;
use contactbench_io::boxes::Axes;
use contactbench_terms::nearest::hint;

pub static GENERATORS: [Generator; 11] = [
    packed::GENERATOR,
    loose::GENERATOR,
    clustered::GENERATOR,
    settled::GENERATOR,
    couples::GENERATOR,
    book::PACK_A,
    book::PACK_B,
    book::PACK_C,
    book::PACK_D,
    file::GENERATOR,
    hard::GENERATOR,
];

pub type Make = fn(&Inputs<'_>) -> anyhow::Result<Given>;

#[derive(Clone, Copy)]
pub struct Generator {
    /// The name in experiments, in records and on the command line.
    pub name: &'static str,
    pub dims: &'static [u32],
    /// A phrase about the scene, for lists and help.
    pub summary: &'static str,
    /// True if the generator decides the number of particles, and n = 0 is accepted.
    pub own_n: bool,
    pub params: &'static [&'static [Parameter]],
    pub make: Make,
}

pub const fn parameter(
    name: &'static str,
    kind: ParameterKind,
    default: &'static str,
    meaning: &'static str,
) -> Parameter {
    Parameter { name, kind, default: [default; 2], meaning }
}

pub const fn optional(name: &'static str, kind: ParameterKind, meaning: &'static str) -> Parameter {
    parameter(name, kind, NONE, meaning)
}

#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    pub name: &'static str,
    pub kind: ParameterKind,
    /// Default value in 2D and in 3D.
    pub default: [&'static str; 2],
    /// Meaning and unit of the parameter, for lists and help.
    pub meaning: &'static str,
}

#[derive(Clone, Copy, Debug)]
pub enum ParameterKind {
    /// A finite number that passes a test, which the text describes.
    Number(&'static str, fn(f64) -> bool),
    /// A whole number that passes a test, which the text describes.
    Whole(&'static str, fn(u64) -> bool),
    Yes,
    /// Periodic axes: names such as `xy`, true for all, or false.
    Axes,
    /// One of the listed words: the first list in 2D, the second in 3D.
    Word([&'static [&'static str]; 2]),
    Text,
    /// The name of a hard case that exists in the scene's dimension.
    Case,
}

/// The default of a parameter that may be absent.
pub const NONE: &str = "none";
/// The default of a parameter that must be given.
pub const REQUIRED: &str = "required";

impl Parameter {
    /// Returns the default value; `None` for [`NONE`] and [`REQUIRED`].
    fn preset(&self, dim: u32) -> Option<Value> {
        let text = self.default[usize::from(dim == 3)];
        match (text, &self.kind) {
            (NONE | REQUIRED, _) => None,
            (_, ParameterKind::Number(..)) => text.parse::<f64>().ok().map(Value::from),
            (_, ParameterKind::Whole(..)) => text.parse::<u64>().ok().map(Value::from),
            _ => Some(text.into()),
        }
    }
}

/// Parameters that every scene has, besides those of its generator.
const COMMON: [&str; 4] = ["dim", "n", "seed", "order"];

pub fn find(name: &str) -> anyhow::Result<&'static Generator> {
    let names = || GENERATORS.map(|generator| generator.name).join(", ");
    GENERATORS.iter().find(|generator| generator.name == name).ok_or_else(|| {
        let hint = hint(name, GENERATORS.iter().map(|generator| generator.name));
        anyhow!("there is no scene '{name}'{hint}; the scenes are: {}", names())
    })
}

impl Generator {
    pub(crate) const PLAIN: Generator = Generator {
        name: "",
        dims: &[2, 3],
        summary: "",
        own_n: false,
        params: &[],
        make: |_| bail!("this generator makes nothing"),
    };

    pub fn params(&self) -> impl Iterator<Item = &'static Parameter> + use<> {
        self.params.iter().copied().flatten()
    }

    /// Returns whether this parameter takes text, which may look like a number.
    pub fn is_text(&self, name: &str) -> bool {
        let of_text =
            |kind: ParameterKind| matches!(kind, ParameterKind::Text | ParameterKind::Case);
        self.params().any(|parameter| parameter.name == name && of_text(parameter.kind))
    }

    pub fn defaults(&self, dim: u32) -> BTreeMap<String, Value> {
        let preset = |it: &Parameter| Some((it.name.to_string(), it.preset(dim)?));
        self.params().filter_map(preset).collect()
    }

    /// Checks dimension, number and parameters, and returns all parameters that have a value,
    /// including defaults.
    pub fn check(
        &self,
        dim: u32,
        n: u64,
        params: &BTreeMap<String, Value>,
    ) -> anyhow::Result<BTreeMap<String, Value>> {
        let (name, dims, most) = (self.name, self.dims, u32::MAX);
        ensure!(dims.contains(&dim), "{name}: dim = {dim}; it must be one of {dims:?}");
        ensure!(n <= most.into(), "{name}: n = {n}; at most 2^32 - 1 = {most} can be numbered");
        let known = || self.params().map(|parameter| parameter.name);
        if let Some(name) = params.keys().find(|name| known().all(|known| known != **name)) {
            bail!(
                "{}: there is no parameter '{name}'{}; the parameters are: {}",
                self.name,
                hint(name, known().chain(COMMON)),
                known().collect::<Vec<_>>().join(", ")
            );
        }
        let mut all = BTreeMap::new();
        // The dimension of a file is unknown until the file is read.
        let known = (self.name != file::NAME).then_some(dim);
        for parameter in self.params() {
            let value = match params.get(parameter.name) {
                Some(value) => parameter.kind.check(value, known).map_err(|must| {
                    anyhow!("{}: {} is {value}; it must be {must}", self.name, parameter.name)
                })?,
                None => match parameter.preset(dim) {
                    Some(value) => value,
                    None if parameter.default == [REQUIRED; 2] => bail!(
                        "{}: the parameter '{}' is missing ({})",
                        self.name,
                        parameter.name,
                        parameter.meaning
                    ),
                    None => continue,
                },
            };
            all.insert(parameter.name.to_string(), value);
        }
        Ok(all)
    }
}

impl ParameterKind {
    pub const POSITIVE: ParameterKind =
        ParameterKind::Number("a finite number over 0", |x| x > 0.0);
    pub const FINITE: ParameterKind = ParameterKind::Number("a finite number", |_| true);
    pub const NOT_NEGATIVE: ParameterKind =
        ParameterKind::Number("a finite number of at least 0", |x| x >= 0.0);
    pub const AT_LEAST_ONE: ParameterKind =
        ParameterKind::Number("a finite number of at least 1", |x| x >= 1.0);
    pub const SHARE: ParameterKind =
        ParameterKind::Number("a number from 0 to 1", |x| (0.0..=1.0).contains(&x));
    pub const COUNT: ParameterKind =
        ParameterKind::Whole("a whole number of at least 1", |k| k >= 1);
    pub const DIM: ParameterKind = ParameterKind::Whole("2 or 3", |k| k == 2 || k == 3);

    pub fn accepts(&self, dim: u32) -> String {
        match self {
            ParameterKind::Number(must, _) | ParameterKind::Whole(must, _) => (*must).into(),
            ParameterKind::Yes => "true or false".into(),
            ParameterKind::Axes => {
                let all = if dim == 2 { "x, y, xy" } else { "x, y, z, xy, xz, yz, xyz" };
                format!("true, none, or the periodic axes of the box: {all}")
            }
            ParameterKind::Word(words) => {
                format!("{} in {dim} dimensions", words[usize::from(dim == 3)].join(" or "))
            }
            ParameterKind::Text => "a text that is not empty".into(),
            ParameterKind::Case => format!(
                "the name of a hard case in {dim} dimensions: see contactbench list hard-cases"
            ),
        }
    }

    /// Returns the value in its canonical form (2 becomes 2.0 for a number), or a description of
    /// accepted values. `known` is the dimension, or `None` if it is not known yet.
    fn check(&self, value: &Value, known: Option<u32>) -> Result<Value, String> {
        let dim = known.unwrap_or(3);
        let text =
            |good: &dyn Fn(&str) -> bool| value.as_str().filter(|text| good(text)).map(Value::from);
        let good = match self {
            ParameterKind::Number(_, good) => {
                value.as_f64().filter(|&x| x.is_finite() && good(x)).map(Value::from)
            }
            // 1e3 is accepted as a whole number.
            ParameterKind::Whole(_, good) => {
                let real = || {
                    value.as_f64().and_then(|x| contactbench_terms::number::whole(&x.to_string()))
                };
                value.as_u64().or_else(real).filter(|&k| good(k)).map(Value::from)
            }
            // Records store parameters other than numbers as words.
            ParameterKind::Yes => match value.as_bool() {
                Some(yes) => Some(yes.to_string().into()),
                None => text(&|text| ["true", "false"].contains(&text)),
            },
            ParameterKind::Axes => {
                let text = match value.as_bool() {
                    Some(yes) => yes.to_string(),
                    None => value.as_str().unwrap_or_default().into(),
                };
                let axes = text.parse::<Axes>().ok().map(|axes| match known {
                    Some(dim) => Axes::These(axes.of(dim as usize)),
                    None => axes,
                });
                let fits = |axes: &Axes| dim == 3 || !axes.of(2)[2];
                axes.filter(fits).map(|axes| axes.to_string().into())
            }
            ParameterKind::Word(words) => {
                text(&|word| words[usize::from(dim == 3)].contains(&word))
            }
            ParameterKind::Text => text(&|text| !text.is_empty()),
            ParameterKind::Case => match scene::hard::find(value.as_str().unwrap_or_default()) {
                Ok(case) if case.dims.contains(&dim) => Some(case.name.into()),
                Ok(_) => None,
                Err(error) => return Err(format!("the name of a hard case: {error}")),
            },
        };
        good.ok_or_else(|| self.accepts(dim))
    }
}
