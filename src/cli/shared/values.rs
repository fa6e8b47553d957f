//! Values of options: whole numbers such as 1e6, bytes such as 4GiB, names for completions.

use std::ffi::OsStr;

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};

use contactbench_detectors::table::TABLE;
use contactbench_record::record::faults::MOST_THREADS;
use contactbench_run::plan::detectors;
use contactbench_terms::{must, number};

/// Parses a whole number: `1000000`, `1e6`, `1_000_000`.
pub fn whole<T: TryFrom<u64>>(text: &str) -> Result<T, String> {
    let value = number::whole(text).and_then(|value| T::try_from(value).ok());
    value.ok_or_else(|| "it must be a whole number, such as 1000 or 1e6".into())
}

/// Parses a number of threads, from 1 to [`MOST_THREADS`].
pub fn threads(text: &str) -> Result<usize, String> {
    let some = whole(text)?;
    must!((1..=MOST_THREADS).contains(&some), "it must be a number from 1 to {MOST_THREADS}");
    Ok(some)
}

/// Parses a number of bytes: `4294967296`, `4GiB`, `512MB`.
pub fn bytes(text: &str) -> Result<u64, String> {
    let must = "it must be a number of bytes, such as 4294967296, 4GiB or 512MB";
    number::bytes(text).ok_or_else(|| must.into())
}

/// Accepts any text. Shells complete it with the names that the function returns.
#[derive(Clone, Copy)]
pub struct Named(fn() -> Vec<&'static str>);

pub const DETECTOR: Named = Named(|| TABLE.iter().map(|entry| entry.name).collect());
pub const DETECTORS: Named = Named(|| {
    let names = TABLE.iter().map(|entry| entry.name);
    names.chain(detectors::groups()).collect()
});

impl TypedValueParser for Named {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.0)().into_iter().map(PossibleValue::new)))
    }
}
