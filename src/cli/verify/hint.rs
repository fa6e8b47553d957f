//! Hints for a list that differs from the truth: a sentence, and options to add.

use crate::cli::verify::Verified;
use contactbench_run::check::verify::{Mistake, Reading};

impl Verified<'_> {
    /// Returns the options with which `verify` reads the list according to `reading`.
    pub(super) fn flags(&self, reading: &Reading) -> Vec<String> {
        // A box that the file declares needs no option.
        let said = |mistake: &Mistake| matches!(mistake, Mistake::Declared(_)) && self.repeats;
        let needed = reading.mistakes.iter().filter(|mistake| !said(mistake));
        needed.filter_map(|mistake| mistake.flags(self.scene().dim())).collect()
    }

    /// Returns a sentence: how to read the list so that it agrees better, and with which options.
    pub(super) fn sentence(&self, reading: &Reading) -> String {
        let with = reading.sentence();
        let flags = self.flags(reading);
        let input = &self.options.input;
        let boxed =
            |mistake: &Mistake| matches!(mistake, Mistake::Periods(_) | Mistake::Declared(_));
        let instead = match reading.mistakes.iter().any(boxed) {
            true if input.boundaries.open => ": leave out --open",
            true if input.boundaries.periodic.is_some() => ": leave out --periodic none",
            _ => "",
        };
        let flag = |name: &str| flags.iter().any(|flag| flag.starts_with(name));
        let there = input.boundaries.periodic.is_some() && flag("--periodic")
            || input.boundaries.edges.is_some() && (flag("--box") || flag("--open"))
            || input.boundaries.periodic.is_some() && flag("--open");
        let flags = flags.join(" ");
        let add = match (flags.is_empty(), instead.is_empty()) {
            (true, _) => String::new(),
            (_, false) => format!(", and add {flags}"),
            (_, true) if there => format!(": give {flags} instead"),
            _ => format!(": add {flags}"),
        };
        format!("{with}{instead}{add}")
    }
}
