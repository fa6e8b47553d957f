//! Parameters of detectors, as the table declares them.

/// A choice that a detector leaves to its user. It may change times and memory, never the contacts.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// What stands before the `=`.
    pub name: &'static str,
    /// All words that it takes, the default first.
    pub values: &'static [&'static str],
    /// What it takes beside them, if anything.
    pub beside: Option<Beside>,
    /// Another parameter, which cannot be given with it.
    pub instead_of: Option<&'static str>,
    /// What is chosen, in a phrase.
    pub meaning: &'static str,
}

/// Values of a parameter that are too many to list.
#[derive(Clone, Copy, Debug)]
pub struct Beside {
    /// The one way to write a value, or none if it is no value.
    pub normal: fn(&str) -> Option<String>,
    /// What a value looks like, with an example.
    pub form: &'static str,
}

impl Parameter {
    /// The value of a detector that is asked for without this parameter.
    pub fn default(&self) -> &'static str {
        self.values[0]
    }
}
