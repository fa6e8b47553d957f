//! Detector specifications: `nbs` or `streamed-nbs:level=avx2,form=dense`.

use std::fmt;

use super::table::{self, Entry, Parameter};
use contactbench_ground::detect::Options;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::detect::any::Params;
use contactbench_ground::wide::Level;
use contactbench_terms::grammar::{self, Spec};
use contactbench_terms::nearest::hint;

const LEVEL: &str = "level";

/// A detector of the table with values for its parameters.
///
/// [`fmt::Display`] writes the normal form, which records use: the name, then the parameters with
/// values other than the default, in alphabetical order. Equivalent specifications have equal text,
/// and [`parse`] reads it back.
#[derive(Clone)]
pub struct DetectorSpec {
    /// Entry of the detector in the table.
    pub entry: &'static Entry,
    /// Parameter values that differ from the defaults.
    pub params: Params,
}

impl DetectorSpec {
    /// Creates the detector with empty buffers.
    ///
    /// If the processor lacks the requested instructions, the detector refuses every scene with
    /// [`Refusal::Instructions`](contactbench_ground::limits::refusal::Refusal::Instructions).
    pub fn make(&self, options: Options) -> Box<dyn AnyDetector> {
        (self.entry.constructor)(&self.params, options)
    }

    /// Checks that users may choose this detector, with this many threads.
    ///
    /// # Errors
    /// Fails for controls, for a number of threads that is 0 or above 1,024, and for several threads that the
    /// detector cannot use.
    pub fn usable(&self, threads: usize) -> Result<(), SpecError> {
        let Entry { name, threads: several, .. } = *self.entry;
        if self.entry.is_control() {
            return Err(SpecError::Unknown { name: name.into() });
        }
        match threads {
            0 | 1025.. => Err(SpecError::Threads { threads }),
            2.. if !several => Err(SpecError::Sequential { name, threads }),
            _ => Ok(()),
        }
    }

    /// Returns the detector with its defaults and with every other word (not number) of each
    /// parameter, and all of these for each further set of vector instructions that the processor
    /// has.
    pub fn choices(entry: &'static Entry) -> Vec<DetectorSpec> {
        let with = |spec: &DetectorSpec, name: &str, value: &str| {
            let mut params = spec.params.clone();
            params.insert(name.into(), value.into());
            DetectorSpec { entry, params }
        };
        let plain = DetectorSpec::from(entry);
        let mut choices = vec![plain.clone()];
        for parameter in entry.parameters.iter().filter(|parameter| parameter.name != LEVEL) {
            let others = parameter.values.iter().skip(1);
            let words = others.filter(|value| value.parse::<f64>().is_err());
            choices.extend(words.map(|value| with(&plain, parameter.name, value)));
        }
        if plain.level().is_some() {
            let forms = choices.clone();
            for level in &Level::all()[1..] {
                choices.extend(forms.iter().map(|form| with(form, LEVEL, level.name())));
            }
        }
        choices
    }

    /// Returns the vector instructions that the detector uses (`avx512`, `avx2` or `portable`), or
    /// `None` if it is compiled in one form for every processor.
    pub fn level(&self) -> Option<&str> {
        self.entry.parameters.iter().find(|parameter| parameter.name == LEVEL)?;
        Some(self.params.get(LEVEL).map_or_else(|| Level::best().name(), String::as_str))
    }
}

impl From<&'static Entry> for DetectorSpec {
    fn from(entry: &'static Entry) -> DetectorSpec {
        DetectorSpec { entry, params: Params::new() }
    }
}

impl PartialEq for DetectorSpec {
    fn eq(&self, other: &DetectorSpec) -> bool {
        self.entry.name == other.entry.name && self.params == other.params
    }
}

impl fmt::Debug for DetectorSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "DetectorSpec({self})")
    }
}

impl fmt::Display for DetectorSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.entry.name)?;
        for (k, (name, value)) in self.params.iter().enumerate() {
            write!(f, "{}{name}={value}", if k == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}

/// Reason why the text of a [`DetectorSpec`] is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SpecError {
    /// A name that is not in the table of detectors.
    #[error(
        "there is no detector '{name}'{}; the detectors are: {}",
        hint(name, table::all_names().filter(|known| *known != name.as_str())),
        table::names()
    )]
    Unknown {
        /// Name as given.
        name: String,
    },
    /// No thread, or too many.
    #[error("threads is {threads}; give a number from 1 to 1024")]
    Threads {
        /// Number of threads.
        threads: usize,
    },
    /// Several threads for a detector that uses one.
    #[error(
        "{name} is sequential and cannot use {threads} threads; give threads=1, or take \
         streamed-nbs, cell-grid or direct"
    )]
    Sequential {
        /// Name of the detector.
        name: &'static str,
        /// Number of threads.
        threads: usize,
    },
    /// A text that is not of the form `name:parameter=value`, or an unknown parameter or value.
    #[error(transparent)]
    Grammar(#[from] grammar::Error),
}

/// Parses a detector's name and, after a colon, values for its parameters, separated by commas, as
/// in `streamed-nbs:level=avx2,form=dense`.
///
/// # Errors
/// Fails on unknown names, parameters and values; the error lists the valid ones.
pub fn parse(spec: &str) -> Result<DetectorSpec, SpecError> {
    let given = Spec::parse(spec);
    let Some(entry) = table::find(given.name) else {
        return Err(SpecError::Unknown { name: given.name.into() });
    };
    read(entry, &given)
}

fn read(entry: &'static Entry, given: &Spec<'_>) -> Result<DetectorSpec, SpecError> {
    let names: Vec<&str> = entry.parameters.iter().map(|parameter| parameter.name).collect();
    given.keys(&names, &takes(entry))?;
    let mut params = Params::new();
    for parameter in entry.parameters {
        let Parameter { name, values, .. } = *parameter;
        let Some(value) = given.get(name) else { continue };
        if !values.contains(&value) {
            let allowed = format!("one of {}", values.join(", "));
            return Err(given.wrong(name, value, values, &allowed).into());
        }
        if value != parameter.default() {
            params.insert(name.into(), value.into());
        }
    }
    Ok(DetectorSpec { entry, params })
}

fn takes(entry: &Entry) -> String {
    if entry.parameters.is_empty() {
        return format!("{} takes no parameters", entry.name);
    }
    let parameters: Vec<String> = entry
        .parameters
        .iter()
        .map(|parameter| format!("{}={}", parameter.name, parameter.values.join("|")))
        .collect();
    format!("{} takes {}", entry.name, parameters.join(" and "))
}
