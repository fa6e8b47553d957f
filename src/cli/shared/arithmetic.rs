//! The option `--arithmetic`.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use contactbench_ground::contact::Arithmetic;

/// Parses the name of an arithmetic, or of a rule; completions show the meanings.
pub fn arithmetic() -> impl TypedValueParser<Value = Arithmetic> {
    let value = |arithmetic: Arithmetic| {
        let value = PossibleValue::new(arithmetic.name()).help(arithmetic.summary());
        match arithmetic {
            Arithmetic::ExactOpen => value.alias("open"),
            Arithmetic::Exact => value.alias("closed"),
            _ => value,
        }
    };
    PossibleValuesParser::new(Arithmetic::ALL.map(value)).try_map(|name| match &*name {
        "open" => Ok(Arithmetic::ExactOpen),
        "closed" => Ok(Arithmetic::Exact),
        name => name.parse(),
    })
}
