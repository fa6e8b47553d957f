//! The option `--arithmetic`.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use contactbench_ground::contact::Arithmetic;

/// Parses the name of an arithmetic; completions show the meanings.
pub fn arithmetic() -> impl TypedValueParser<Value = Arithmetic> {
    let value = |it: Arithmetic| PossibleValue::new(it.name()).help(it.summary());
    PossibleValuesParser::new(Arithmetic::ALL.map(value)).try_map(|name| name.parse())
}
