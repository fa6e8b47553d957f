//! The option `--arithmetic`.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use contactbench_core::contact::Arithmetic;

/// Parses the name of an arithmetic; completions show the meanings.
pub fn arithmetic() -> impl TypedValueParser<Value = Arithmetic> {
    let value =
        |arithmetic: Arithmetic| PossibleValue::new(arithmetic.name()).help(arithmetic.summary());
    PossibleValuesParser::new(Arithmetic::ALL.map(value)).try_map(|name| name.parse::<Arithmetic>())
}
