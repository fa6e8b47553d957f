//! The option `--arithmetic`.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use contactbench_core::contact::Arithmetic;

/// Takes the names of the arithmetics, and lists them in the help, each with its meaning.
pub fn arithmetic() -> impl TypedValueParser<Value = Arithmetic> {
    let value =
        |arithmetic: Arithmetic| PossibleValue::new(arithmetic.name()).help(arithmetic.summary());
    PossibleValuesParser::new(Arithmetic::ALL.map(value)).try_map(|name| name.parse::<Arithmetic>())
}
